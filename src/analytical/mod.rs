//! Closed forms for a sphere pressed on a rigid plane and sheared along it, each with its source
//! and the range in which it holds.
//!
//! What the simulator is held against and what its plots show beside the computed curves. Every
//! function is plain `f64` arithmetic in one consistent system of units (or in lengths by R and
//! stresses by E); none can fail: outside the stated range the value is the formula's continuation,
//! and it is the caller's business not to trust it. Forces are those on the whole sphere,
//! compression positive.
//!
//! ```text
//!            ___________ plate: u = (delta_T, 0, -h), carries F_N down and F_T along
//!           /           \
//!          |      R      |
//!           \           /
//!   _________\__ 2a ___/__________ rigid plane z = 0
//! ```

mod contact_size;
mod sphere;

pub mod biwa_storakers;
pub mod body;
pub mod brizmer;
pub mod cattaneo_mindlin;
pub mod hertz;
pub mod jackson_green;
pub mod jaeger_ciavarella;
pub mod johnson;
pub mod kogut_etsion;
pub mod lubkin;
pub mod mesarovic_johnson;
pub mod olsson_larsson;
pub mod yielding;

pub use contact_size::predicted_contact_radius;
pub use sphere::ElasticSphere;

/// Root of an increasing function in `[low, high]` by bisection down to neighbouring numbers; an
/// end if there is no sign change.
pub(crate) fn bisect(mut low: f64, mut high: f64, increasing: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            break;
        }
        if increasing(middle) < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

//! How much of h and delta_T the bodies give way outside their contact (see
//! [`crate::analytical::body`]).

use crate::analytical::body::Held;
use crate::case::{Case, Equator, Opponent, Scaled};

/// A body by what it gives way: lengths over R, stresses over E of the sphere.
struct Share {
    held: Held,
    radius: f64,
    youngs_modulus: f64,
    poissons_ratio: f64,
}

impl Share {
    fn given_way(&self, [f_t, f_t_y, f_n]: [f64; 3], contact_radius: f64) -> [f64; 3] {
        let Self { held, radius, youngs_modulus, poissons_ratio } = *self;
        let shear = youngs_modulus / (2.0 + 2.0 * poissons_ratio);
        let along = held.tangential(contact_radius / radius) / (shear * radius);
        [along * f_t, along * f_t_y, held.normal(poissons_ratio) * f_n / (youngs_modulus * radius)]
    }
}

/// What the bodies give way beyond half-spaces along x, y and the normal, at these forces (F_T
/// along x and y, F_N) and this contact radius; scaled as the case, in which an equal pair is one
/// of its bodies.
pub fn given_way(Scaled(case): &Scaled<Case>, forces: [f64; 3], contact_radius: f64) -> [f64; 3] {
    let held = |flat: bool| if flat { Held::Dome } else { Held::Clamped };
    let own = Share {
        held: if case.sphere.equator == Equator::Free { Held::Free } else { held(case.sphere.flat) },
        radius: case.sphere.radius,
        youngs_modulus: case.material.youngs_modulus,
        poissons_ratio: case.material.poissons_ratio,
    };
    let mut sum = own.given_way(forces, contact_radius);
    if let Some(Opponent::Deforming { material, radius }) = &case.opponent {
        let other = Share {
            held: held(radius.is_none()),
            radius: radius.unwrap_or(case.sphere.radius),
            youngs_modulus: material.youngs_modulus,
            poissons_ratio: material.poissons_ratio,
        };
        sum.iter_mut().zip(other.given_way(forces, contact_radius)).for_each(|(sum, more)| *sum += more);
    }
    sum
}

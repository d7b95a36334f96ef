//! What a contact remembers, and what an increment answers.

use super::table::SLIDERS;

/// Greatest increment: the square of its force is still finite.
pub(super) const MOST: f64 = 1e140;

/// The memory of one contact; all zero before first contact. Plain data: copy it, write it to a
/// file as it is.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct ContactState {
    /// Indentation h, length; negative is a gap.
    pub h: f64,
    /// Greatest h so far, length.
    pub h_max: f64,
    /// Elastic approach, length: h less the dent; negative is the gap over it.
    pub approach: f64,
    /// Hardening: the depth of first loading that has the contact's yield force, less that of the
    /// table's first row; length.
    pub hardened: f64,
    /// Elastic approach at which the sliders are whole, length.
    pub reach: f64,
    /// Share of the yield force that releases took.
    pub softened: f64,
    /// Greatest share of F_N released since the contact last yielded.
    pub released: f64,
    /// How far it was sheared, 0 to 1, and its slip reversed, to 2.
    pub worn: f64,
    /// By what share the contact is wider than its F_N, as shear took F_N and left its radius.
    pub stiffened: f64,
    /// The vertex alpha of the yield surface, over F_N.
    pub vertex: [f64; 2],
    /// Forces of the sliders along the two axes and radial, innermost (last to slip) first.
    pub slider: [[f64; SLIDERS]; 3],
    /// How the last plastic step went; it only tells Newton's method where to begin. The share of
    /// the way to the elastic trial's ratio that it followed, along the ratio of its start and
    /// across it; its hardening over what the trial would bring, below zero after an elastic step.
    pub hint: [f64; 3],
}

/// The answer of an increment.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct ContactResponse {
    /// Normal force, compression positive.
    pub f_n: f64,
    /// Tangential force along the displacement: what drives the sphere; the plane gives the sphere
    /// the opposite.
    pub f_t: [f64; 2],
    /// d f_t\[i\]/d delta_T\[j\].
    pub df_t_ddelta: [[f64; 2]; 2],
    /// d f_n/dh at constant delta_T.
    pub df_n_dh: f64,
    /// d f_n/d delta_T at constant h.
    pub df_n_ddelta: [f64; 2],
    /// Radius of the contact, length.
    pub a: f64,
    /// d f_t/dh at constant delta_T.
    pub df_t_dh: [f64; 2],
}

impl ContactState {
    /// How many numbers it is.
    pub const NUMBERS: usize = 14 + 3 * SLIDERS;

    /// Its numbers as they lie in memory.
    pub fn to_numbers(self) -> [f64; Self::NUMBERS] {
        bytemuck::cast(self)
    }

    /// The state of such numbers.
    pub fn from_numbers(numbers: [f64; Self::NUMBERS]) -> Self {
        bytemuck::cast(numbers)
    }

    /// Whether it is a state that an update may have left: all its numbers finite, and each within
    /// its bounds.
    pub fn is_sound(&self) -> bool {
        let positive = |value: f64| value.is_finite() && value >= 0.0;
        let within = |value: f64, most: f64| (0.0..=most).contains(&value);
        let all = |values: &[f64]| values.iter().all(|value| value.is_finite() && value.abs() <= MOST);
        all(&[self.h, self.approach])
            && all(&self.vertex)
            && all(&self.hint)
            && all(self.slider.as_flattened())
            && all(&[self.h_max, self.hardened, self.reach, self.stiffened])
            && positive(self.h_max)
            && positive(self.hardened)
            && positive(self.reach)
            && self.stiffened > -1.0
            && within(self.softened, 1.0)
            && within(self.released, 1.0)
            && within(self.worn, 2.0)
    }

    /// Turns the memory into axes that are turned by the angle whose cosine and sine are given: the
    /// new components of a vector v are (c v0 + s v1, -s v0 + c v1). Call it when the tangent frame
    /// follows the contact's normal.
    pub fn rotate(&mut self, cosine: f64, sine: f64) {
        let turned = |x: f64, y: f64| [cosine * x + sine * y, -sine * x + cosine * y];
        self.vertex = turned(self.vertex[0], self.vertex[1]);
        let [along, across, _] = &mut self.slider;
        for (x, y) in along.iter_mut().zip(across) {
            [*x, *y] = turned(*x, *y);
        }
    }
}

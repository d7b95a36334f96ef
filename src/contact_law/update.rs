//! One increment of one contact: first the press, then the shear. The C and the Python twin have
//! the functions of `yielding`, `sliders`, `press`, `shear` and this file, in that order, and do
//! the same operations.

use super::press::{press, taken};
use super::shear::shear;
use super::sliders::bounded;
use super::virgin::{ContactParameters, SLIDERS};
use super::yielding::{MOST, force_at};

/// The memory of one contact; all zero before first contact. Plain data: copy it, write it to a
/// file as it is.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct ContactState {
    /// Indentation h, length; negative is a gap.
    pub h: f64,
    /// Greatest h so far, length.
    pub h_max: f64,
    /// Elastic approach, length: what is recovered until contact is lost; negative is the gap over
    /// the residual dent.
    pub approach: f64,
    /// Elastic approach from which the contact is released, length: F_N = 2 E* a reach/gamma
    /// (approach/reach)^gamma. It falls with F_N where shear takes that.
    pub reach: f64,
    /// x = delta_T/delta_T_end on the virgin curves at which the contact stands: the measure of
    /// its loss of F_N to shear. Beyond 1, up to 2, of what reversed slip costs besides.
    pub x: f64,
    /// x of the virgin curves up to which the contact has hardened in shear: 0 after a press
    /// without F_T, 1 after full slip. Below it F_T/F_N rises without yielding to shear; the edge
    /// of a contact that was not sheared slips sooner.
    pub sheared: f64,
    /// How far its slip was reversed, 0 to 1: then it turns more sharply.
    pub reversed: f64,
    /// Tangential deflections of the sliders, length, innermost (last to slip) first.
    pub deflection: [[f64; 2]; SLIDERS],
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
    /// d f_n/dh at constant delta_T, for the direction in which h last moved.
    pub df_n_dh: f64,
    /// d f_n/d delta_T at constant h, for the direction in which delta_T last moved.
    pub df_n_ddelta: [f64; 2],
    /// Radius of the contact, length.
    pub a: f64,
}

impl ContactState {
    /// Whether it is a state that an update may have left: all its numbers finite, and each within
    /// its bounds.
    pub fn is_sound(&self) -> bool {
        let positive = |value: f64| value.is_finite() && value >= 0.0;
        let within = |value: f64, most: f64| (0.0..=most).contains(&value);
        self.h.is_finite()
            && self.approach.is_finite()
            && self.deflection.iter().flatten().all(|q| q.is_finite())
            && positive(self.h_max)
            && positive(self.reach)
            && within(self.x, MOST)
            && within(self.sheared, MOST)
            && within(self.reversed, 1.0)
    }

    /// Turns the memory into axes that are turned by the angle whose cosine and sine are given: the
    /// new components of a vector v are (c v0 + s v1, -s v0 + c v1). Call it when the tangent frame
    /// follows the contact's normal.
    pub fn rotate(&mut self, cosine: f64, sine: f64) {
        for q in &mut self.deflection {
            *q = [cosine * q[0] + sine * q[1], -sine * q[0] + cosine * q[1]];
        }
    }
}

impl ContactParameters {
    /// Moves a contact to the indentation `h` and along the plane by `increment` (two components in
    /// the tangent frame), the press first. A pure function of the state before. Where `h` or the
    /// increment is not finite, or the state is not [sound](ContactState::is_sound), nothing in the
    /// answer is a number and the state stays as it was.
    pub fn update(&self, state: &ContactState, h: f64, increment: [f64; 2]) -> (ContactState, ContactResponse) {
        let mut next = *state;
        let mut out = ContactResponse::default();
        if !(h.is_finite() && increment[0].is_finite() && increment[1].is_finite() && state.is_sound()) {
            let nan = f64::NAN;
            out = ContactResponse {
                f_n: nan,
                f_t: [nan; 2],
                df_t_ddelta: [[nan; 2]; 2],
                df_n_dh: nan,
                df_n_ddelta: [nan; 2],
                a: nan,
            };
            return (next, out);
        }
        let increment = bounded(increment);
        let greatest = if h > state.h_max { h } else { state.h_max };
        if !(greatest > 0.0) {
            next.h = h;
            return (next, out);
        }
        let virgin = self.virgin_sheared(greatest, state.sheared, state.reversed);
        let pressed = press(self, &mut next, &virgin, h, increment);
        next.h = h;
        next.h_max = greatest;
        next.x = pressed.x;
        if !(pressed.f_n > 0.0) {
            next.deflection = [[0.0; 2]; SLIDERS];
            return (next, out);
        }
        out.df_n_dh = pressed.df_n_dh;
        let share = taken(pressed.flow);
        shear(self, &mut next, &mut out, &virgin, &pressed, [share * increment[0], share * increment[1]]);
        for i in 0..2 {
            out.df_t_ddelta[i] = [share * out.df_t_ddelta[i][0], share * out.df_t_ddelta[i][1]];
            out.df_n_ddelta[i] *= share;
        }
        out.a = virgin.point.a * (next.approach / next.reach).powf(virgin.gamma - 1.0);
        (next, out)
    }

    /// Elastic energy that the contact stores, force times length: no path gives back more than it.
    /// No number where the state is not [sound](ContactState::is_sound).
    pub fn stored_energy(&self, state: &ContactState) -> f64 {
        if !state.is_sound() {
            return f64::NAN;
        }
        if !(state.h_max > 0.0) || state.approach <= 0.0 {
            return 0.0;
        }
        let virgin = self.virgin(state.h_max);
        let mut sum = 0.0;
        for i in 0..SLIDERS {
            let q = state.deflection[i];
            sum += virgin.weight[i] * (q[0] * q[0] + q[1] * q[1]);
        }
        force_at(&virgin, state.reach, state.approach) * state.approach / (virgin.gamma + 1.0) + 0.5 * virgin.point.k_t * sum
    }
}

//! Universal constants of the update: the same for all materials, friction coefficients and bodies.
//!
//! `python3 benches/law/fit_element.py --fit --write` makes them of the paths in `fixtures/paths`,
//! and writes them here.

/// What the update and its table hang on beside the curves of a contact.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Constants {
    /// A = this c r^3/(r + the next): share of the yield force that a steady press loses at r =
    /// F_T/F_N.
    pub loss: f64,
    /// The r below which it loses less than with r^2.
    pub loss_small: f64,
    /// Greatest A over what the curves of the shear lose at the same r.
    pub loss_most: f64,
    /// Slip at the vertex over dh_p, of a contact that is all plastic.
    pub vertex_flow: f64,
    /// It fades with exp(-this (D/h)^2).
    pub vertex_fades: f64,
    /// dh_p over mu P/k_T in which the vertex follows r.
    pub vertex_length: f64,
    /// Distance over mu within which its direction is rounded.
    pub vertex_round: f64,
    /// Slope of its loss beyond the shear's end, over the mean slope before.
    pub beyond: f64,
    /// Its power of 1 - D/h.
    pub beyond_fades: f64,
    /// Radial slip of a press over dh_p, of a contact that is all plastic.
    pub radial: f64,
    /// Its power of 1 - D/h.
    pub radial_fades: f64,
    /// Greatest radial force of a slider over its limit.
    pub radial_most: f64,
    /// n - 1 of a first reversal over that of the curves.
    pub first: f64,
    /// The greatest such n - 1.
    pub first_most: f64,
    /// n - 1 of reversals after the first, at most, at mu = 0.3.
    pub later: f64,
    /// Its power of mu.
    pub later_mu: f64,
    /// n of a contact that is not sheared and all plastic.
    pub unsheared: f64,
    /// How fast a press takes back how far it was sheared, over dh_p/D.
    pub forgets: f64,
    /// Way over mu F_N/k_T in which how far it was sheared follows r.
    pub follows: f64,
    /// Share of the yield force that a whole release takes, of a contact that is all plastic.
    pub released: f64,
    /// How fast a press gives it back.
    pub recovers: f64,
    /// Growth of the contact radius over delta_T_end/a0 that is in the unloading of the curves.
    pub widens: f64,
    /// Power of that growth that is in their k_T.
    pub stiffens: f64,
    /// dh_p/D in which a press makes the contact as wide as F_N has it.
    pub narrows: f64,
    /// How c changes with r, over what is recovered of h.
    pub bend: f64,
    /// The recovered share at which it does not.
    pub bend_from: f64,
}

impl Constants {
    /// Those of the program.
    pub const FITTED: Self = Self {
        loss: 0.94099,
        loss_small: 0.031032,
        loss_most: 0.83703,
        vertex_flow: 0.90004,
        vertex_fades: 9.5864,
        vertex_length: 1.975,
        vertex_round: 0.36212,
        beyond: 1.9977,
        beyond_fades: 2.5387,
        radial: 0.48722,
        radial_fades: 0.47145,
        radial_most: 0.3699,
        first: 1.4283,
        first_most: 0.59668,
        later: 0.177,
        later_mu: 0.62554,
        unsheared: 3.2156,
        forgets: 0.055023,
        follows: 0.02,
        released: 0.17362,
        recovers: 356.81,
        widens: 0.19498,
        stiffens: 0.91365,
        narrows: 0.020112,
        bend: 1.0817,
        bend_from: 0.16624,
    };

    /// How many they are.
    pub const NUMBER: usize = 26;

    /// Of numbers in the order of the fields.
    pub fn from_array(values: [f64; Self::NUMBER]) -> Self {
        bytemuck::cast(values)
    }

    /// In the order of the fields.
    pub fn to_array(self) -> [f64; Self::NUMBER] {
        bytemuck::cast(self)
    }
}

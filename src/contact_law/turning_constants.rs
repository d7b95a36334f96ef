//! What twist and roll hang on, the same for all materials, friction coefficients and bodies.
//!
//! `python3 benches/law/fit_turning.py --fit --write` makes them of the paths in
//! `fixtures/paths/vector` that twist or roll, and writes them here. Levers and stiffness of a
//! twist are not fitted but closed forms.

use super::table::SLIDERS;

/// Levers of the sliders in a twist, over the contact's radius, innermost first. A slider stands
/// for punches of the radii from c to d of it (Jaeger), whose stiffness in a twist grows with the
/// third power: lever^2 goes with (d^3 - c^3)/(d - c). Together they hold 3 pi/16 mu F_N a under
/// Hertz's pressure (Lubkin 1951).
pub(super) const LEVERS: [f64; SLIDERS] = [
    0.24780519997808367,
    0.5558496021248792,
    0.7772648994669601,
    0.9681186140649315,
    1.1403177363940158,
    1.2994238383575456,
    1.4486155659200235,
];
/// The sum of their weights times their squares.
pub(super) const LEVERS_SQUARED: f64 = 0.7706342074625594;
/// Stiffness of the sliders around the normal over that along the plane: 16/3 G a^3 (Reissner &
/// Sagoci 1944) beside 8 G a/(2 - nu), at nu = 0.3.
pub(super) const TWIST_STIFF: f64 = 1.4706501766447932;
/// `M_twist` over mu F_N a where all slips, at an exponent of the sliders of 1.25: of a plastic
/// contact.
pub(super) const TWIST_LEVER: f64 = 0.6486825238410201;
/// Way over mu F_N/k_T in which the part of a twist in yield follows its moment: given.
pub(super) const TWIST_FOLLOWS: f64 = 0.1;

/// What is fitted.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct TurningConstants {
    /// What `M_twist` over its lever counts for yield, beside F_T.
    pub twist_yield: f64,
    /// What it flows with.
    pub twist_flow: f64,
    /// How much more a twist wears than a shear of as much of its limit,
    pub twist_worn: f64,
    /// up to this.
    pub twist_most: f64,
    /// Way over a in which a roll leaves what was pressed,
    pub roll_way: f64,
    /// and its tractions, of an elastic contact;
    pub roll_traction: f64,
    /// the latter's power of D/h.
    pub roll_leaves: f64,
    /// Greatest `M_roll` over F_N a, of a contact that is all plastic.
    pub roll_moment: f64,
    /// Its power of 1 - D/h.
    pub roll_fades: f64,
    /// Stiffness in a roll over that of a flat punch, of a contact that is all elastic.
    pub roll_stiff: f64,
    /// Its power of D/h.
    pub roll_softens: f64,
    /// Share of the yield force that a roll takes, of a contact that is all plastic.
    pub roll_loss: f64,
    /// Its power of 1 - D/h.
    pub roll_loss_fades: f64,
    /// Slip of a roll over its angle, over h.
    pub roll_slip: f64,
    /// How fast a press takes back what was rolled, over dh_p/h.
    pub roll_press: f64,
    /// Way over a, for a press by dh/h, on which it flows half as much as without a roll.
    pub roll_flow: f64,
}

impl TurningConstants {
    /// Those of the program.
    pub const FITTED: Self = Self {
        twist_yield: 0.8912,
        twist_flow: 0.5656,
        twist_worn: 2.694,
        twist_most: 1.806,
        roll_way: 0.1527,
        roll_traction: 0.9312,
        roll_leaves: 1.222,
        roll_moment: 0.5945,
        roll_fades: 0.4661,
        roll_stiff: 0.4491,
        roll_softens: 0.3936,
        roll_loss: 0.4158,
        roll_loss_fades: 1.487,
        roll_slip: 1.252,
        roll_press: 4.501,
        roll_flow: 0.2608,
    };

    /// How many they are.
    pub const NUMBER: usize = 16;

    /// In the order of the fields.
    pub fn to_array(self) -> [f64; Self::NUMBER] {
        bytemuck::cast(self)
    }
}

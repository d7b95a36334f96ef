//! The law as an incremental, vectorial update of one contact, the form in which a discrete-element
//! code calls it.
//!
//! [`ContactParameters`] belong to a pair of materials, [`ContactState`] to a contact;
//! [`ContactParameters::update`] takes the new indentation h and the tangential increment in two
//! directions, and answers with the forces and tangents. The model, within which the law is exact
//! on first loading:
//!
//! - *First loading* in h follows F_N0(h), and the contact radius a(h); in delta_T at constant h,
//!   with x = delta_T/delta_T_end, F_T = mu F_N_slip f_T(x) and F_N = F_N0 - (F_N0 - F_N_slip)
//!   f_N(x) (Olsson & Larsson 2014). In the plane of F_N and |F_T| this is a limit curve, from (F_N0, 0)
//!   to full slip, and x is the place on it.
//! - *Inside the curve* the contact is elastic with friction. F_N = F_N0 eta^gamma, eta the elastic
//!   approach over its greatest value D = gamma F_N0/(2 E* a): it starts with 2 E* a (a is the
//!   contact radius, or a little more where the body is stiffer than a half-space), ends at the
//!   residual dent, and is Hertz for gamma = 3/2. What shear takes of F_N leaves the contact as
//!   wide as it was, and D falls with F_N: so it unloads with 2 E* a, and turns with k_T, from any
//!   F_N. F_T is carried by [`SLIDERS`] sliders in parallel
//!   (Iwan 1967), each an annulus that leaves contact at its own eta (Jaeger 1998, Ciavarella 1998;
//!   Popov & Hess 2015): Masing's rule, nested loops, and shear while h changes (Mindlin &
//!   Deresiewicz 1953) follow without rules of their own. Sliding in any direction holds each
//!   slider to its limit; together they reach mu F_N.
//! - *On the curve* plastic flow in h and delta_T moves the contact along it: x grows with delta_T
//!   / delta_T_end, the normal part of the flow being an indentation, so that F_N is lost and does
//!   not come back on reversal.
//! - *Pressed while it is sheared* it yields where F_N (1 + s c r^2) = F_N0, r = F_T/F_N, an
//!   ellipse through the origin as in modified Cam clay (Roscoe & Burland 1968), and flows with
//!   d(delta_T)/dh = 2 c r/(1 - c r^2), which at s = 1 is normal to it. Simulated steady oblique
//!   presses do up to where they slip, all of delta_T over all of h; with r their c rises where
//!   much of the indentation is elastic, and falls where little is. The sliders take what of
//!   delta_T does not flow: so a press alone takes F_T as F_N comes back, and one along the flow
//!   keeps it. c is a table's own, of a simulated oblique press; or that of the virgin curve,
//!   F_N0/F_N = 1 + b r + c r^2.
//! - *Hardening in shear.* What mobilises F_T on the virgin curve is F_T/F_N over x, and a contact
//!   that a press has raised above the curve follows the same F_T/F_N. While it is pressed, a part
//!   of delta_T hardens nothing (what the linear part b takes, a fifth at the most). x is forgotten
//!   as the contact grows and where a press takes F_T.
//! - *Reversed at full slip* it loses a little more F_N, and turns more sharply from then on.
//!
//! So simulated contacts behave: after a reversal F_N stands still until |F_T| is back at its
//! former height, then falls on; a press of some per cent in h restores F_N and takes F_T.
//! `asperity law check` has the figures. With a table the stiffness of an unloading and the curve
//! of a reversal are simulated ones; with formulas they are 2 E* a, which is 10 to 35 % too soft,
//! and Masing's rule for the virgin contact's exponent, which turns round too slowly.
//!
//! Every flow dissipates: with [`ContactParameters::stored_energy`], no path returns more than was
//! stored.

pub mod export;
pub mod path;

mod centres;
mod curve;
mod press;
mod shapes;
mod shear;
mod sliders;
mod update;
mod virgin;
mod yielding;

pub use centres::{Centres, Frame};
pub use curve::NormalCurve;
pub use update::{ContactResponse, ContactState};
pub use virgin::{
    BY_NUMBERS, COLUMNS, ContactError, ContactParameters, KNOTS, LEVELS, PIECES, POINTS, ROUNDING, SLIDERS, SPARE, Shapes,
    Virgin, VirginPoint, unloading_exponent,
};
pub use yielding::measured_slope;

#[cfg(test)]
mod tests;

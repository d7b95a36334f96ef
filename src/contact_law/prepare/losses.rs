//! What shear costs a contact.

use super::super::constants::Constants;
use super::super::virgin::Virgin;

/// Share of F_N0 lost to shear below which a contact is elastic the more.
const HARDLY: f64 = 0.02;

/// A power of a base that rounding may have left at or below 0.
pub(super) fn power(base: f64, exponent: f64) -> f64 {
    if base > 0.0 {
        base.powf(exponent)
    } else if exponent > 0.0 {
        0.0
    } else {
        1.0
    }
}

/// 1 of a contact that shear costs F_N, 0 of an elastic one.
pub(super) fn costs(virgin: &Virgin) -> f64 {
    ((1.0 - virgin.point.f_n_slip / virgin.point.f_n0) / HARDLY).min(1.0)
}

/// Share of the yield force that a steady press loses at the ratio r, where c is the flow
/// coefficient.
pub(super) fn steady_loss(constants: &Constants, c: f64, r: f64) -> f64 {
    if r > 0.0 { constants.loss * c * r * r * r / (r + constants.loss_small) } else { 0.0 }
}

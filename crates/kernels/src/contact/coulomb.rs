//! Unilateral contact with Coulomb friction, exact at every point: a stateless semismooth Newton
//! (Alart & Curnier 1991).
//!
//! The body's internal force f on a contact point balances the plane's force on the body, so in
//! equilibrium f is that force: f_z >= 0 pushes the body up, f_t opposes the slip. With c > 0 a
//! numerical weight (it changes the way to the answer, not the answer):
//!
//! - xi_n = f_z - c g; the point is open if xi_n <= 0, and then f = 0;
//! - closed: g = 0; xi_t = f_t - c du_t; it sticks if |xi_t| <= mu max(f_z, 0), and then du_t = 0;
//! - otherwise it slips: f_t = mu max(f_z, 0) xi_t / |xi_t|.
//!
//! The status follows from the present displacement and the tangential position at the start of the
//! step alone; nothing is remembered between iterations, so the active set cannot cycle through a
//! memory of its own.

use serde::{Deserialize, Serialize};

use crate::real::Real;

/// Alart-Curnier's c = 0.1 E h_c: with c = E h_c the same run took twice the iterations. Half and
/// twice of it: `benches/constants`.
pub const CONTACT_WEIGHT: f64 = 0.1;

/// Coefficient of friction, or no slip at all.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Friction<R> {
    /// |q| <= mu p.
    Coulomb(R),
    /// A closed point never slips.
    Stick,
}

/// What a contact point does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
#[repr(u32)]
pub enum Status {
    /// Not touching.
    #[default]
    Open = 0,
    /// Touching and not sliding.
    Stick = 1,
    /// Touching and sliding.
    Slip = 2,
}

/// A contact point at a trial displacement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point<R> {
    /// Internal force of the body on the point, [x, y, z].
    pub force: [R; 3],
    /// Gap (see [`super::rigid::Rigid::gap`]).
    pub gap: R,
    /// Slip since the start of the step.
    pub slip: [R; 2],
    /// Weight c, a stiffness.
    pub weight: R,
    /// The point lies on the symmetry plane: it cannot move in y and carries no friction in y.
    pub on_symmetry_plane: bool,
}

/// Residual r of a point and its linearisation `force_rows * df + displacement_rows * du = -r`.
///
/// df is the change of the point's internal force (three rows of the tangent), du its displacement.
/// A row whose `fixed` is set reads du = -r / weight instead: the residual is stated as a force, c
/// g or c du_t, so that it can enter one merit with the others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rows<R> {
    /// Status that follows from the trial displacement.
    pub status: Status,
    /// Residual, a force.
    pub residual: [R; 3],
    /// Rows acting on df.
    pub force_rows: [[R; 3]; 3],
    /// Rows acting on du.
    pub displacement_rows: [[R; 3]; 3],
    /// Displacements that the row prescribes.
    pub fixed: [bool; 3],
    /// The weight c that the residuals of fixed rows carry.
    pub weight: R,
}

/// The contact conditions of one point.
#[inline]
pub fn contact_rows<R: Real>(friction: Friction<R>, point: &Point<R>) -> Rows<R> {
    let (zero, one) = (R::ZERO, R::ONE);
    let c = point.weight;
    let f = point.force;
    let mut rows = Rows {
        status: Status::Open,
        residual: f,
        force_rows: [[one, zero, zero], [zero, one, zero], [zero, zero, one]],
        displacement_rows: [[zero; 3]; 3],
        fixed: [false; 3],
        weight: c,
    };
    if point.on_symmetry_plane {
        fix(&mut rows, 1, c * point.slip[1]);
    }
    let xi_n = f[2] - c * point.gap;
    // A NaN closes the point. Its force is then in no residual: whoever evaluates a trial looks at
    // the forces too.
    if xi_n <= zero {
        return rows;
    }
    fix(&mut rows, 2, c * point.gap);
    let xi = [f[0] - c * point.slip[0], if point.on_symmetry_plane { zero } else { f[1] - c * point.slip[1] }];
    let norm = (xi[0] * xi[0] + xi[1] * xi[1]).sqrt();
    let (mu, sticks) = match friction {
        Friction::Stick => (zero, true),
        Friction::Coulomb(mu) => (mu, mu > zero && norm <= mu * f[2].max(zero)),
    };
    if sticks {
        rows.status = Status::Stick;
        fix(&mut rows, 0, c * point.slip[0]);
        fix(&mut rows, 1, c * point.slip[1]);
        return rows;
    }
    rows.status = Status::Slip;
    let bound = mu * f[2].max(zero);
    if !(norm > zero) || !(bound > zero) {
        // No friction to speak of: the tangential force itself must vanish, which is what the rows
        // say already.
        return rows;
    }
    let n = [xi[0] / norm, xi[1] / norm];
    let ratio = bound / norm;
    for i in 0..2 {
        if rows.fixed[i] {
            continue;
        }
        rows.residual[i] = f[i] - bound * n[i];
        for j in 0..2 {
            let across = ratio * (if i == j { one } else { zero } - n[i] * n[j]);
            rows.force_rows[i][j] -= across;
            rows.displacement_rows[i][j] = c * across;
        }
        rows.force_rows[i][2] = -(mu * n[i]);
    }
    rows
}

/// Makes row `i` prescribe its displacement; `residual` is weight times the displacement still
/// missing.
#[inline(always)]
fn fix<R: Real>(rows: &mut Rows<R>, i: usize, residual: R) {
    rows.fixed[i] = true;
    rows.residual[i] = residual;
    rows.force_rows[i] = [R::ZERO; 3];
    rows.displacement_rows[i] = [R::ZERO; 3];
    rows.displacement_rows[i][i] = R::ONE;
}

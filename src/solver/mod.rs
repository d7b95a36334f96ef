//! From one accepted state to the next: a semismooth Newton iteration with a merit line search.
//!
//! `newton` iterates one step, of which `outcome` tells how it went; `iterate` has its vectors, on
//! the host or on a device. `trial` is what is known at one displacement, `boundary` what is
//! prescribed, `system` the residual of the one under the other; `contact_rows` are the rows of the
//! matrix that contact decides on, `opponent` is all that depends on what the body is pressed
//! against; `systems` solves for the correction, with `pair` for two equal spheres and `couple` for
//! two bodies (`tied` is what these have in common), `phases` is what its parts cost, `pose` where
//! the plate stands. Choosing steps and bisecting them is the simulation's business.

pub mod boundary;
pub mod contact_rows;
pub mod iterate;
pub mod newton;
pub mod opponent;
pub mod outcome;
pub mod phases;
pub mod pose;
pub mod system;
pub mod systems;
pub mod trial;

#[cfg(test)]
mod tests;

use crate::compute::ComputeError;
use crate::linalg::LinalgError;
use crate::material::Elasticity;
pub use outcome::{Iteration, StepFailure, StepOutcome, StepReport, Worst};
use pose::Pose;

/// How a step is to be solved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// A step is accepted when the contact merit is below this share of the sum of the normal
    /// contact forces.
    pub tolerance: f64,
    /// Newton iterations before a step is given up.
    pub max_iterations: usize,
    /// Loosest relative residual to which a linear system is solved (see [`loosest_linear`]).
    pub loosest_linear: f64,
    /// The same where the normal force is held (see [`held_linear`]).
    pub held_linear: f64,
    /// Share of the sum of the normal contact forces down to which the first linear system of a
    /// step is solved (see [`first_linear`]); infinite if the loosest tolerance does.
    pub first_linear: f64,
    /// From this iteration on the line search compares with the last iterate alone (see
    /// [`monotone_from`]).
    pub monotone_from: usize,
}

/// From this Johnson parameter E a/((1 - nu^2) sigma_rep R) on a contact is fully plastic (Olsson &
/// Larsson 2016).
pub const FULLY_PLASTIC: f64 = 160.0;

/// How far the first linear system of a step is solved, for a contact whose Johnson parameter grows
/// to `lambda`.
///
/// The plate's motion first strains the elements beside it alone. Against the contact's force what
/// they resist with goes as E/sigma_Y; where that is much, a tenth of it left in the correction
/// throws points back from flow that then do not find to it again. At E/sigma_Y = 7500 a press took
/// 428 iterations with 5 cut-backs so, and takes 134 with none.
pub fn first_linear(lambda: f64) -> f64 {
    if lambda >= FULLY_PLASTIC { 0.01 } else { f64::INFINITY }
}

/// From this iteration on the line search compares with the last iterate alone, for a contact whose
/// Johnson parameter grows to `lambda`; before, with the largest merit so far, because the first
/// changes of contact status raise the merit on the way down.
///
/// In deep plasticity the merit must not rise for long: at E/sigma_Y = 5000 a press of 20 steps
/// took 375 iterations and 7 cuts from the fifth iteration on, 166 and none from the second or
/// third. At E/sigma_Y = 18,500 one took 1,170 and 19 from the third, and takes 950 and 10 from the
/// second.
pub fn monotone_from(lambda: f64) -> usize {
    if lambda >= FULLY_PLASTIC { 1 } else { 2 }
}

/// Loosest linear tolerance for a Poisson's ratio: 0.1 up to 0.3, and above less as the ratio of
/// bulk to shear modulus grows. A change of volume makes a residual that is so much greater than
/// that of a change of shape, and hides what is missing of the latter: at nu = 0.49 systems solved
/// to 0.1 made presses take five times the iterations and cut-backs, or fail; to 0.0044 none was
/// needed.
pub fn loosest_linear(poissons_ratio: f64) -> f64 {
    let bulk_to_shear = |nu: f64| {
        let moduli = Elasticity::<f64>::new(1.0, nu);
        moduli.bulk / moduli.shear
    };
    // Not below what a cycle in f32 reaches without restarts.
    (0.1 * (bulk_to_shear(0.3) / bulk_to_shear(poissons_ratio)).min(1.0)).max(1e-6)
}

/// Relative residual to which linear systems are solved, or further, where the normal force is
/// held, for a contact whose Johnson parameter grows to `lambda`.
///
/// What is missing of the solution would change the indentation, and with it which points slide: to
/// 0.1, the steps of a shear took four times the iterations. In deep plasticity it is missing of
/// what flows, which is softer than what does not as 1/Lambda; points that it throws back from flow
/// resist with all of E, and the merit rises, however short the step. At E/sigma_Y = 10,600 a shear
/// of 4 elements inside and 8 at the surface did not converge with systems solved to 0.01, nor did
/// one of two equal spheres at Lambda = 1050, nu = 0.45, on 5 and 10; to 6e-4 both do, the second
/// one in a third of the Krylov iterations.
pub fn held_linear(lambda: f64) -> f64 {
    0.01 * (FULLY_PLASTIC / lambda).min(1.0)
}

/// What drives a step: the plate's position at its end, or the force on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Control {
    /// Indentation h at the end of the step; the starting guess when `normal_force` is set.
    pub h: f64,
    /// Where the plate stands at the end of the step otherwise.
    pub pose: Pose,
    /// Normal force of the meshed half to be reached, with h free.
    pub normal_force: Option<f64>,
}

/// A failure that no smaller step cures.
#[derive(Debug, thiserror::Error)]
pub enum SolverError {
    /// The device or the mesh.
    #[error(transparent)]
    Compute(#[from] ComputeError),
    /// The linear solver.
    #[error(transparent)]
    Linalg(#[from] LinalgError),
}

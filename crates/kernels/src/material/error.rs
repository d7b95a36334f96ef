//! The one error of this room. What a single point says in the inner loops is a [`PointError`].

use super::PointError;

/// A hardening law that cannot be built, or a path that a point cannot follow.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MaterialError {
    /// A parameter is out of its range, or not finite.
    #[error("hardening law \"{law}\": {parameter} = {value}: {remedy}")]
    Parameter {
        /// The law, as in the case file.
        law: &'static str,
        /// The key in the case file.
        parameter: &'static str,
        /// What was given.
        value: f64,
        /// What is allowed.
        remedy: &'static str,
    },
    /// A table that is no function, or softens faster than the solid unloads.
    #[error("hardening law \"table\": point {index}: {remedy}")]
    Table {
        /// The point, counted from 0.
        index: usize,
        /// What is wrong with it, and what is allowed.
        remedy: &'static str,
    },
    /// The point has no answer for the step.
    #[error("step {step}: {source}")]
    Point {
        /// The step, counted from 1; of a given path also its row.
        step: usize,
        /// What the point said.
        source: PointError,
    },
    /// The deformation gradient of the path has no positive determinant.
    #[error("step {step}: det F = {determinant}: give deformation gradients with a determinant above 0")]
    Gradient {
        /// The step, counted from 1; of a given path also its row.
        step: usize,
        /// det F.
        determinant: f64,
    },
    /// No lateral stretch frees the sides of stress.
    #[error(
        "step {step}: no lateral stretch makes the lateral stress vanish (left: {residual:e} of Young's modulus): take more steps or a smaller strain"
    )]
    Lateral {
        /// The step, counted from 1.
        step: usize,
        /// Lateral Kirchhoff stress over E.
        residual: f64,
    },
}

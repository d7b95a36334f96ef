//! The errors of this room: that of a law or of a path, and the [`PointError`] that a single point
//! says in the inner loops.

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

/// Why a point has no answer for the deformation it was given. A reason to cut the step back, not
/// to stop the program.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum PointError {
    /// The relative deformation turns the material inside out.
    #[error("the relative deformation has the determinant {jacobian}, not above 0: take a smaller step")]
    Inverted {
        /// det f, dimensionless.
        jacobian: f64,
    },
    /// The deformation or the state holds a NaN, or is so large that the stress overflows.
    #[error("the deformation or the state is not finite: take a smaller step")]
    NotFinite,
}

/// [`PointError`] without its number: what an element passes on of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Refusal {
    /// See [`PointError::Inverted`].
    #[error("the relative deformation of the step turns it inside out")]
    Inverted,
    /// See [`PointError::NotFinite`].
    #[error("its stress or plastic strain is not finite")]
    NotFinite,
}

impl From<PointError> for Refusal {
    fn from(error: PointError) -> Self {
        match error {
            PointError::Inverted { .. } => Self::Inverted,
            PointError::NotFinite => Self::NotFinite,
        }
    }
}

//! How the evaluation of a trial displacement went, and why it could not be evaluated.

use crate::element::hex8::Invalid;
use crate::material::Refusal;

/// How the evaluation of a trial displacement went.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Evaluated {
    /// Evaluated.
    #[default]
    Valid,
    /// It could not be evaluated; the solver answers by backtracking.
    Invalid(Fault),
}

impl Evaluated {
    /// Nothing if it is valid.
    ///
    /// # Errors
    /// The fault.
    pub fn check(self) -> Result<(), Fault> {
        match self {
            Self::Valid => Ok(()),
            Self::Invalid(fault) => Err(fault),
        }
    }
}

/// Why a trial displacement could not be evaluated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Fault {
    /// J <= 0 at a quadrature point.
    #[error("element {element} inverts at quadrature point {point}")]
    Inverted {
        /// Element index.
        element: usize,
        /// Quadrature point.
        point: usize,
    },
    /// J is infinite or NaN there.
    #[error("the deformation of element {element} is not finite at quadrature point {point}")]
    Deformation {
        /// Element index.
        element: usize,
        /// Quadrature point.
        point: usize,
    },
    /// The material has no answer there.
    #[error("the material refuses the deformation of element {element} at quadrature point {point}: {why}")]
    Refused {
        /// Element index.
        element: usize,
        /// Quadrature point.
        point: usize,
        /// The material's reason.
        why: Refusal,
    },
    /// The residual holds a number that is infinite or NaN, or its norm is one.
    #[error("the residual is not finite{}", .at.map_or_else(String::new, on_node))]
    Residual {
        /// The first node and direction with such a number, if it is known.
        at: Option<(usize, usize)>,
    },
}

fn on_node((node, direction): (usize, usize)) -> String {
    format!(" at node {node} in {}", ["x", "y", "z"].get(direction).copied().unwrap_or("?"))
}

impl Fault {
    /// Of an element.
    pub fn of(element: usize, invalid: Invalid) -> Self {
        match invalid {
            Invalid::Inverted(point) => Self::Inverted { element, point },
            Invalid::NotFinite(point) => Self::Deformation { element, point },
            Invalid::Material(point, why) => Self::Refused { element, point, why },
        }
    }

    /// It comes from numbers that are not finite, which a deformation that is merely too large does
    /// not make.
    pub fn is_of_numbers(&self) -> bool {
        match self {
            Self::Inverted { .. } => false,
            Self::Refused { why, .. } => *why == Refusal::NotFinite,
            Self::Deformation { .. } | Self::Residual { .. } => true,
        }
    }
}

//! A law file, whichever kind it is of.

use std::borrow::Cow;
use std::path::Path;

use super::formulas::predict::over_a_plane;
use super::interpolated::{self, Interpolated};
use super::json;
pub use super::json::BUILT_IN;
use super::range::OutOfRange;
use super::table::{self, Tabulated};
use super::variables::Body;
use super::{Law, LawError};
use crate::case::{Case, Friction};
use crate::contact_law::path::{PathPoint, follow_centres};
use crate::contact_law::{Centres, ContactParameters};

/// What a `law.json` may be.
#[derive(Clone, Debug, PartialEq)]
pub enum LawFile {
    /// Formulas for all materials, as `law fit` writes them.
    Formulas(Box<Law>),
    /// Curves in h of one material and one friction, as `law tabulate` writes them.
    Table(Box<Tabulated>),
    /// A table for any material between those of a study, as `law fit --interpolate` writes it.
    Interpolated(Box<Interpolated>),
}

impl LawFile {
    /// Reads any kind.
    ///
    /// # Errors
    /// [`LawError::BadLaw`] with what the file is instead.
    pub fn read(path: &Path) -> Result<Self, LawError> {
        json::read(path, Self::of_text)
    }

    /// The same from a text in memory; `name` is what errors call it.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn parse(text: &str, name: &str) -> Result<Self, LawError> {
        Self::of_text(text).map_err(|problem| LawError::BadLaw { path: name.into(), problem })
    }

    fn of_text(text: &str) -> Result<Self, String> {
        Ok(match json::head(text)?.format.as_str() {
            table::FORMAT => Self::Table(Box::new(Tabulated::from_json(text)?)),
            interpolated::FORMAT => Self::Interpolated(Box::new(Interpolated::from_json(text)?)),
            _ => Self::Formulas(Box::new(Law::from_json(text)?)),
        })
    }

    /// The law that comes with the program, `built-in` on the command line: by interpolation, of
    /// any material, on a rigid plane or between two bodies ([`Interpolated::built_in`]).
    ///
    /// # Errors
    /// A file that was no law when the program was built.
    pub fn built_in() -> Result<Self, LawError> {
        Ok(Self::Interpolated(Box::new(Interpolated::built_in()?)))
    }

    /// Reads any kind; of the name `built-in` it is [`built_in`](Self::built_in).
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn read_or_built_in(path: &Path) -> Result<Self, LawError> {
        if path == Path::new(BUILT_IN) { Self::built_in() } else { Self::read(path) }
    }

    /// The same law where it is of one kind of contact already; the table of the case's contact
    /// where it is to be interpolated.
    ///
    /// # Errors
    /// Those of [`Interpolated::compose`]; [`LawError::NotCovered`] if there is no case to make it
    /// for.
    pub fn of_case(&self, case: Option<&Case>) -> Result<Cow<'_, Self>, LawError> {
        match (self, case) {
            (Self::Interpolated(law), Some(case)) => Ok(Cow::Owned(Self::Table(Box::new(law.compose(case)?)))),
            (Self::Interpolated(_), None) => Err(Self::without_a_case()),
            _ => Ok(Cow::Borrowed(self)),
        }
    }

    /// What is missing where a law by interpolation is to be used without a case.
    pub(super) fn without_a_case() -> LawError {
        LawError::NotCovered {
            problem: "a law by interpolation is a table for each material",
            remedy: "Give the case too, with its material, its friction and its deepest indentation",
        }
    }

    /// What the contact update needs for the sphere of a case, in the case's units.
    ///
    /// # Errors
    /// [`LawError::NotCovered`] for full stick; [`LawError::OtherMaterial`] for a case that a table
    /// is not of; no numbers for this material.
    pub fn contact_parameters(&self, case: &Case) -> Result<ContactParameters, LawError> {
        let Friction::Coefficient(friction) = case.contact.friction else {
            return Err(LawError::NotCovered {
                problem: "the case has friction = \"stick\", and the law describes slip",
                remedy: "Give contact.friction a number, or simulate the case with `asperity run`",
            });
        };
        match self {
            Self::Formulas(law) => {
                over_a_plane(case)?;
                Ok(law.contact_parameters(&Body::from_case(case)?, friction)?)
            }
            Self::Table(table) => {
                table.covers(case)?;
                table.contact_parameters(case.sphere.radius, case.material.youngs_modulus)
            }
            Self::Interpolated(law) => law.compose(case)?.contact_parameters(case.sphere.radius, case.material.youngs_modulus),
        }
    }

    /// Indentation, displacement and forces along the whole path of a case, in its units, without
    /// simulating any of it; and what of its deepest contact lies outside of the law's range. As in
    /// a simulation all is along fixed axes, also where two spheres pass each other.
    ///
    /// # Errors
    /// Those of [`LawFile::contact_parameters`].
    pub fn follow(&self, case: &Case) -> Result<(Vec<PathPoint>, Vec<OutOfRange>), LawError> {
        let points = follow_centres(&self.contact_parameters(case)?, Centres::of(case), &case.path);
        let deepest = points.iter().map(|point| point.h).fold(0.0, f64::max);
        let out_of_range = if deepest > 0.0 { self.out_of_range(case, deepest)? } else { Vec::new() };
        Ok((points, out_of_range))
    }

    /// Writes any kind.
    ///
    /// # Errors
    /// [`LawError`] with what the system says.
    pub fn write(&self, path: &Path) -> Result<(), LawError> {
        match self {
            Self::Formulas(law) => law.write(path),
            Self::Table(table) => table.write(path),
            Self::Interpolated(law) => law.write(path),
        }
    }

    /// What of a contact of the case at the indentation `h`, in the case's units, lies outside of
    /// the law's range.
    ///
    /// # Errors
    /// The hardening law of the case.
    pub fn out_of_range(&self, case: &Case, h: f64) -> Result<Vec<OutOfRange>, LawError> {
        match self {
            Self::Formulas(law) => {
                let body = Body::from_case(case)?;
                let Friction::Coefficient(friction) = case.contact.friction else { return Ok(Vec::new()) };
                Ok(law.body_out_of_range(&body, &law.inputs(&body, friction, h)))
            }
            Self::Table(table) => Ok(table.out_of_range(h / case.sphere.radius)),
            Self::Interpolated(law) => law.out_of_range(case, h),
        }
    }
}

/// Refuses a case that twists or rolls the sphere, where the moments have no place.
///
/// # Errors
/// [`LawError::NotCovered`].
pub fn refuse_turns(case: &Case) -> Result<(), LawError> {
    if !case.turns() {
        return Ok(());
    }
    Err(LawError::NotCovered {
        problem: "the case twists or rolls the sphere, which the pictures of a law do not show",
        remedy: "Leave out twist and roll, or take the moments from `asperity law predict`",
    })
}

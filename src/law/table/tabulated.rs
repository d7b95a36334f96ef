//! A table: what it is of, and what it says.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::against::{Against, equivalent};
use super::level::{Curves, Level};
use crate::case::{self, Case, Friction, Opponent};
use crate::contact_law::{ContactParameters, FirstLoading, Frame, Given, POINTS, Shapes, VirginPoint};
use crate::law::LawError;
use crate::law::json;
use crate::law::range::{Interval, OutOfRange};

/// The first key of a table, by which it is recognised.
pub const FORMAT: &str = "asperity-law-table";
/// Version of its layout.
pub const VERSION: u32 = 1;

/// Errors on a depth that the table was not made from, as shares.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DepthErrors {
    /// Indentation over R.
    pub h: f64,
    /// Error of F_N0.
    #[serde(rename = "F_N0")]
    pub f_n0: f64,
    /// Error of a0.
    pub a0: f64,
    /// Error of F_T over its peak, root mean square along the shear.
    #[serde(rename = "F_T_rms")]
    pub f_t_rms: f64,
    /// The greatest.
    #[serde(rename = "F_T_max")]
    pub f_t_max: f64,
    /// Error of F_N over F_N0 along the shear, root mean square.
    #[serde(rename = "F_N_rms")]
    pub f_n_rms: f64,
    /// The greatest.
    #[serde(rename = "F_N_max")]
    pub f_n_max: f64,
}

/// A table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tabulated {
    /// [`FORMAT`].
    pub format: String,
    /// [`VERSION`].
    pub version: u32,
    /// What the sphere meets.
    pub body: Against,
    /// Of two spheres, the frame of h, delta_T and the forces; none on a flat.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frame: Option<Frame>,
    /// The program and its version.
    pub program: String,
    /// The case that it was made of, in units in which R and E are 1: material and friction are
    /// those of the table.
    pub case: String,
    /// h/R between which it holds. Below the first the contact is Hertz's.
    pub range: Interval,
    /// Elements along the contact radius.
    pub elements_per_contact_radius: usize,
    /// The levels, increasing in h.
    pub levels: Vec<Level>,
    /// How well the levels of every other depth tell those between.
    pub errors: Vec<DepthErrors>,
}

/// Relative difference up to which two materials are the same one in other units.
const SAME: f64 = 1e-9;

impl Tabulated {
    /// Writes it, whole or not at all.
    ///
    /// # Errors
    /// The place cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), LawError> {
        json::write(path, self)
    }

    /// Reads one and checks it.
    ///
    /// # Errors
    /// [`LawError::BadLaw`]: no such file, no table, another version.
    pub fn read(path: &Path) -> Result<Self, LawError> {
        json::read(path, Self::from_json)
    }

    /// A table from the text of its file; the error is what is wrong, in words.
    pub(in crate::law) fn from_json(text: &str) -> Result<Self, String> {
        json::parse(text)
    }

    /// The case of the table, R = 1 and E = 1.
    pub(super) fn case(&self) -> Result<Case, String> {
        Case::parse(&self.case, "case", &[]).map_err(|error| format!("case is no case: {error}"))
    }

    /// mu.
    pub fn friction(&self) -> f64 {
        match self.case().map(|case| case.contact.friction) {
            Ok(Friction::Coefficient(mu)) => mu,
            _ => f64::NAN,
        }
    }

    /// The case of the table, R = 1 and E = 1.
    ///
    /// # Errors
    /// [`LawError::BadLaw`], after reading it never.
    pub(in crate::law) fn scaled_case(&self) -> Result<Case, LawError> {
        self.case().map_err(|problem| LawError::BadLaw { path: "law.json".into(), problem })
    }

    /// Refuses a case of another material, of another friction, or against something else.
    ///
    /// # Errors
    /// [`LawError::OtherMaterial`] with what differs.
    pub fn covers(&self, case: &Case) -> Result<(), LawError> {
        let own = self.scaled_case()?;
        let other = case.scaled().0;
        let refuse = |what: String| Err(LawError::OtherMaterial { what });
        let body = Against::of(case);
        if body != self.body {
            return refuse(format!("it is a contact with {body}, and the table is of one with {}", self.body));
        }
        if own.sphere.flat != other.sphere.flat {
            return refuse("which of the two bodies is flat differs".to_owned());
        }
        if own.sphere.equator != other.sphere.equator {
            return refuse("sphere.equator differs".to_owned());
        }
        if let Some(what) = difference(&own.material, &other.material) {
            return refuse(what);
        }
        let mu = self.friction();
        match case.contact.friction {
            Friction::Coefficient(friction) if !differ(friction, mu) => {}
            Friction::Coefficient(friction) => return refuse(format!("mu = {friction}, and the table is of mu = {mu}")),
            Friction::Stick => return refuse(format!("friction = \"stick\", and the table is of mu = {mu}")),
        }
        match (&own.opponent, &other.opponent) {
            (Some(Opponent::Rigid { radius: own }), Some(Opponent::Rigid { radius: other })) if differ(*own, *other) => {
                refuse(format!("the rigid sphere has {other} R, and that of the table {own} R"))
            }
            (
                Some(Opponent::Deforming { radius: own, material }),
                Some(Opponent::Deforming { radius: others, material: other }),
            ) => {
                if let (Some(own), Some(others)) = (own, others)
                    && differ(*own, *others)
                {
                    return refuse(format!("the other sphere has {others} R, and that of the table {own} R"));
                }
                if differ(material.youngs_modulus, other.youngs_modulus) {
                    return refuse(format!(
                        "the other body has {} times the sphere's E, and that of the table {}",
                        other.youngs_modulus, material.youngs_modulus
                    ));
                }
                difference(material, other).map_or(Ok(()), |what| refuse(format!("of the other body, {what}")))
            }
            _ => Ok(()),
        }
    }

    /// What the contact update needs, for a sphere of this radius and this Young's modulus,
    /// whatever their units.
    ///
    /// # Errors
    /// [`LawError::Contact`] where a number is none.
    pub fn contact_parameters(&self, radius: f64, youngs_modulus: f64) -> Result<ContactParameters, LawError> {
        Ok(self.unit_parameters()?.scaled(radius, youngs_modulus))
    }

    /// Those of a sphere with R = 1 and E = 1, from which all others follow.
    ///
    /// # Errors
    /// [`LawError::Contact`] where a number is none.
    pub fn unit_parameters(&self) -> Result<ContactParameters, LawError> {
        let curves = Curves::new(&self.levels);
        let mu = self.friction();
        let level_at = |h: f64| curves.at(h.clamp(self.range.from, self.range.to));
        let contact = |h: f64| {
            let level = level_at(h);
            let mut shapes: Shapes = [[0.0; POINTS]; 2];
            shapes[0].copy_from_slice(&level.tangential);
            shapes[1].copy_from_slice(&level.normal);
            let point = VirginPoint {
                a: level.a0,
                f_n0: level.f_n0,
                f_n_slip: level.slip_share * level.f_n0,
                delta_t_end: level.delta_t_end,
                // The sliders must not be softer than the curve of the shear at its start.
                k_t: level.k_t.max(steepest(&level.tangential) * mu * level.slip_share * level.f_n0 / level.delta_t_end),
                c: 0.0,
            };
            let coefficient = self.yield_coefficient(h);
            let unloading_radius = Some(level.unloading_radius);
            Given { point, unloading_radius, backbone: level.backbone, coefficient, shapes }
        };
        let sphere = equivalent(&self.scaled_case()?);
        let range = [self.range.from, self.range.to];
        let first_loading = FirstLoading::tabulate(sphere.radius, sphere.effective_modulus(), mu, range, contact)?;
        Ok(ContactParameters::new(first_loading))
    }

    /// c of the yield curve at an indentation, straight over ln h between the levels that have one.
    fn yield_coefficient(&self, h: f64) -> Option<f64> {
        straight(&yielding_of(&self.levels), h.ln())
    }

    /// A case of its material and friction that is pressed to its end.
    ///
    /// # Errors
    /// [`LawError::BadLaw`], after reading it never.
    pub fn deepest_case(&self) -> Result<Case, LawError> {
        Ok(self.pressed_to_its_end(self.scaled_case()?))
    }

    /// What of a contact at the indentation `h` over R lies outside of the table.
    pub fn out_of_range(&self, h: f64) -> Vec<OutOfRange> {
        let range = Interval { from: 0.0, to: self.range.to };
        if range.contains(h, 1e-9) { Vec::new() } else { vec![OutOfRange { quantity: "h/R", value: h, range }] }
    }
}

/// ln h and c of the levels that have one.
pub(super) fn yielding_of(levels: &[Level]) -> Vec<[f64; 2]> {
    levels.iter().filter_map(|level| level.yield_coefficient.map(|c| [level.h.ln(), c])).collect()
}

/// What points (x, y), increasing in x, have at `x`: straight between them, and flat beyond.
pub(in crate::law) fn straight(points: &[[f64; 2]], x: f64) -> Option<f64> {
    let after = points.partition_point(|point| point[0] <= x);
    let (Some(before), Some(after)) = (after.checked_sub(1).map(|i| points[i]), points.get(after)) else {
        return if after == 0 { points.first() } else { points.last() }.map(|point| point[1]);
    };
    Some(before[1] + (after[1] - before[1]) * (x - before[0]) / (after[0] - before[0]))
}

/// Refuses a law of two spheres along fixed axes, as they were made before: an engine has the line
/// of centres, and F_T along the axes is up to a fifth less where they pass each other.
pub(in crate::law) fn frame_of_the_centres(own: Option<Frame>, wanted: Option<Frame>, command: &str) -> Result<(), String> {
    match (own, wanted) {
        (None, Some(_)) => Err(format!(
            "is of two spheres along fixed axes, as earlier versions made it, and not in the frame of their centres, which \
             engines have: make it anew with `asperity {command}`"
        )),
        (Some(_), None) => Err("says that it is in the frame of two centres, and one of its bodies is flat".to_owned()),
        _ => Ok(()),
    }
}

/// Share of the force at full slip below which a point of f_T says nothing about its slope: there
/// the tolerance of the simulated forces counts. Half and twice of it: `benches/constants`.
const SLOPE_FROM: f64 = 0.1;

/// Slope with which f_T begins: the greatest of a line from its start to a point of it.
fn steepest(shape: &[f64]) -> f64 {
    let x = |j: usize| ((j + 1) as f64 / POINTS as f64).powi(2);
    shape.iter().enumerate().filter(|(_, f)| **f >= SLOPE_FROM).map(|(j, f)| f / x(j)).fold(0.0, f64::max)
}

/// Whether two numbers differ by more than rounding.
pub(super) fn differ(a: f64, b: f64) -> bool {
    (a - b).abs() > SAME * a.abs().max(b.abs())
}

/// In what a material is not that of the table; both over the sphere's E.
fn difference(own: &case::Material, other: &case::Material) -> Option<String> {
    if differ(own.poissons_ratio, other.poissons_ratio) {
        return Some(format!("nu = {}, and the table is of nu = {}", other.poissons_ratio, own.poissons_ratio));
    }
    match [own, other].map(|material| serde_json::to_value(&material.hardening)) {
        [Ok(ours), Ok(theirs)] if alike(&ours, &theirs) => None,
        [Ok(ours), Ok(theirs)] => Some(format!("over E, hardening is {theirs}, and that of the table is {ours}")),
        _ => Some("its hardening cannot be compared".to_owned()),
    }
}

/// Whether two values are the same but for rounding.
fn alike(a: &serde_json::Value, b: &serde_json::Value) -> bool {
    use serde_json::Value::{Array, Object};
    match (a, b) {
        (Array(a), Array(b)) => a.len() == b.len() && a.iter().zip(b).all(|(a, b)| alike(a, b)),
        (Object(a), Object(b)) => {
            a.len() == b.len() && a.iter().all(|(key, value)| b.get(key).is_some_and(|other| alike(value, other)))
        }
        (a, b) => match (a.as_f64(), b.as_f64()) {
            (Some(a), Some(b)) => (a - b).abs() <= SAME * a.abs().max(b.abs()),
            _ => a == b,
        },
    }
}

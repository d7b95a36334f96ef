//! The law: what it holds, and the table that it makes of it for a case.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::components::{COMPONENTS, Components};
use super::inputs::{FRICTION, INPUTS, LAMBDA, POISSON, SIZE, inputs};
use super::outputs::{NUMBERS, Outputs};
use super::process::{InputPoint, Process};
use super::yielding::Yielding;
use crate::analytical::ElasticSphere;
use crate::case::{Case, Friction, Opponent};
use crate::contact_law::Frame;
use crate::law::range::{Interval, MARGIN, OutOfRange, clamped};
use crate::law::report::RegionError;
use crate::law::table::{self, Against, Level, Tabulated, equivalent};
use crate::law::variables::{Body, yield_lambda};
use crate::law::{LawError, json};

/// The first key of a law by interpolation, by which it is recognised.
pub const FORMAT: &str = "asperity-law-interpolated";
/// Version of its layout.
pub const VERSION: u32 = 1;

/// How much deeper than needed the tables of the two bodies of a pair are, and are made if that
/// was not enough,
const SPARE: f64 = 1.1;
/// up to so many times.
const DEEPEST: f64 = 3.0;

/// Number of functions.
pub(super) const PROCESSES: usize = NUMBERS + 2 * COMPONENTS;

/// An input over the samples.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Input {
    /// What it is.
    pub name: String,
    /// Its mean.
    pub mean: f64,
    /// Its deviation.
    pub deviation: f64,
    /// From the least to the greatest.
    pub range: Interval,
}

/// What a law by interpolation was made from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Source {
    /// The program and its version.
    pub program: String,
    /// Name of the study's directory.
    pub study: String,
    /// Cases used.
    pub cases: usize,
    /// Different materials.
    pub materials: usize,
    /// Study of the law that reversals and unloadings are taken from where cases have none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reversal: Option<String>,
    /// Cases left out, with the reasons.
    pub left_out: Vec<(String, String)>,
    /// Cases used whose curve is that of its mesh, and not the limit of fine meshes.
    #[serde(default)]
    pub raw: usize,
    /// Most elements along the contact radius.
    pub elements_per_contact_radius: usize,
}

/// Errors over a number of cases, as shares: rms and greatest.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NormalErrors {
    /// rms and greatest error of F_N0.
    #[serde(rename = "F_N0")]
    pub f_n0: [f64; 2],
    /// rms and greatest error of a0.
    pub a0: [f64; 2],
}

/// A law by interpolation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Interpolated {
    /// [`FORMAT`].
    pub format: String,
    /// [`VERSION`].
    pub version: u32,
    /// What the sphere meets: a rigid plane, or an equal sphere.
    pub body: Against,
    /// Of two spheres, the frame of h, delta_T and the forces; none on a plane.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frame: Option<Frame>,
    /// Where it comes from.
    pub source: Source,
    /// Errors of F_T and F_N along the shear, from h alone, of materials that were left out.
    pub errors: Vec<RegionError>,
    /// Those of F_N0 and a0.
    pub normal_errors: NormalErrors,
    /// The inputs.
    pub inputs: Vec<Input>,
    /// F_T/F_N over mu as a curve.
    pub ratio: Components,
    /// F_N/F_N0 as a curve.
    pub normal: Components,
    /// The functions: the numbers, the components of F_T/F_N, those of F_N.
    pub processes: Vec<Process>,
    /// The samples' inputs, less their mean, over their deviation.
    pub samples: Vec<InputPoint>,
    /// c of the oblique press; without it the update takes that of the shear at constant h.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub yielding: Option<Yielding>,
    /// The law of two equal spheres, for any two bodies of one material and for the press of any
    /// others; without it all are put in series from spheres on a plane.
    #[serde(skip)]
    pub pair: Option<Box<Interpolated>>,
}

/// The sphere of a case by itself, and the one that makes the same elastic contact on a rigid
/// plane; in units of its radius and its E.
pub(super) fn bodies(case: &Case) -> Result<(Body, ElasticSphere), LawError> {
    let scaled = case.scaled().0;
    Ok((Body::new(1.0, &scaled.material)?, equivalent(&scaled)))
}

/// Whether a shear takes none of F_N, whatever the samples make of it: two equal elastic spheres
/// exert no friction on each other in a press. A sphere on a plane does, and at low nu a shear lets
/// go of up to a tenth of F_N that this has added.
pub(super) fn keeps_its_force(body: &Body, against: Against) -> bool {
    body.is_elastic() && against == Against::EqualSphere
}

/// The laws that come with the program: of spheres on a rigid plane, and of two equal spheres.
const BUILT_IN: [(&str, &str); 2] = [
    ("fixtures/law/interpolated/plane.json", include_str!("../../../fixtures/law/interpolated/plane.json")),
    ("fixtures/law/interpolated/pair.json", include_str!("../../../fixtures/law/interpolated/pair.json")),
];

impl Interpolated {
    /// The law that comes with the program: of spheres on a rigid plane, and with it that of two
    /// equal spheres.
    ///
    /// # Errors
    /// A file that was no law when the program was built.
    pub fn built_in() -> Result<Self, LawError> {
        let [plane, pair] =
            BUILT_IN.map(|(path, text)| Self::from_json(text).map_err(|problem| LawError::BadLaw { path: path.into(), problem }));
        Ok(Self { pair: Some(Box::new(pair?)), ..plane? })
    }

    /// The law of two equal spheres, if there is one, for a case of them and for any two bodies of
    /// one material: these are in series as two of their equals are, which a plane, that rubs on
    /// them while they are pressed, is not (`benches/pairs/unlike.py`).
    pub(crate) fn of_equal_spheres(&self, case: &Case) -> Option<&Self> {
        self.pair.as_deref().filter(|law| is_of_one_material(case) || law.body == Against::of(case))
    }

    /// Reads one and checks it.
    ///
    /// # Errors
    /// [`LawError::BadLaw`]: no such file, another kind or version.
    pub fn read(path: &Path) -> Result<Self, LawError> {
        json::read(path, Self::from_json)
    }

    /// One from the text of its file; the error is what is wrong, in words.
    pub(in crate::law) fn from_json(text: &str) -> Result<Self, String> {
        json::parse(text)
    }

    /// Writes it, whole or not at all.
    ///
    /// # Errors
    /// The place cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), LawError> {
        json::write_compact(path, self)
    }

    /// What it tells of a contact.
    pub(super) fn outputs(&self, contact: &[f64; INPUTS]) -> Outputs {
        let place = self.place(contact);
        let values: Vec<f64> = self.processes.iter().map(|process| process.at(&self.samples, &place)).collect();
        self.outputs_of(&values)
    }

    /// The inputs of a contact less their mean, over their deviation.
    pub(super) fn place(&self, contact: &[f64; INPUTS]) -> InputPoint {
        std::array::from_fn(|i| (contact[i] - self.inputs[i].mean) / self.inputs[i].deviation)
    }

    /// The outputs that belong to the values of the functions.
    pub(super) fn outputs_of(&self, values: &[f64]) -> Outputs {
        let scores = |first: usize| std::array::from_fn(|k| values[first + k]);
        Outputs {
            numbers: std::array::from_fn(|i| values[i]),
            ratio: self.ratio.curve(&scores(NUMBERS)),
            normal: self.normal.curve(&scores(NUMBERS + COMPONENTS)),
        }
    }

    /// The table of a case's material and friction, down to its indentation, without a simulation.
    ///
    /// # Errors
    /// Full stick; another opponent than that of the law; no numbers for this material.
    pub fn table(&self, case: &Case) -> Result<Tabulated, LawError> {
        clamped(case)?;
        let against = Against::of(case);
        if against != self.body || case.sphere.flat {
            return Err(LawError::OtherOpponent { case: against, law: self.body });
        }
        let (body, sphere) = bodies(case)?;
        let levels = table::depths(case)?
            .into_iter()
            .map(|h| {
                let contact = inputs(&body, &sphere, friction(case), h);
                let level = self.outputs(&contact).level(&sphere, friction(case), h, keeps_its_force(&body, self.body));
                let yielding = self.yielding.as_ref().filter(|_| !body.is_elastic() && friction(case) > 0.0);
                Level { yield_coefficient: yielding.map(|yielding| yielding.at(&self.place(&contact))), ..level }
            })
            .collect();
        Tabulated::interpolated(case, levels, self.source.elements_per_contact_radius)
    }

    /// The table of a case's contact, of two bodies that deform too: these are put in series from
    /// a table of each by itself.
    ///
    /// # Errors
    /// Those of [`table`](Self::table) and of [`compose`](table::compose).
    pub fn compose(&self, case: &Case) -> Result<Tabulated, LawError> {
        clamped(case)?;
        if let Some(law) = self.of_equal_spheres(case) {
            return law.compose(case);
        }
        if Against::of(case) == Against::EqualSphere && self.body == Against::Plane {
            return self.compose(&like_itself(case)).map(|table| table.of_an_equal_pair(case));
        }
        let mut spare = SPARE;
        loop {
            let of = |law: &Self| {
                let Some([sphere, other]) = table::bodies_alone(case, law.body, spare) else { return Ok(None) };
                Ok::<_, LawError>(Some([law.table(&sphere)?, law.table(&other)?]))
            };
            let Some([sphere, other]) = of(self)? else { return self.table(case) };
            // Pressed by its equal a body is held by no friction, as it nearly is by another body.
            let pressed = self.pair.as_deref().map(of).transpose()?.flatten();
            let [first, second] = pressed.as_ref().map_or([&sphere, &other], |[first, second]| [first, second]);
            match table::compose_from(case, [first, second], [&sphere, &other]) {
                Err(LawError::Shallow { .. }) if spare < DEEPEST => spare *= SPARE,
                composed => return composed,
            }
        }
    }

    /// What of a contact of the case at the indentation `h`, in the case's units, lies outside of
    /// the samples.
    ///
    /// # Errors
    /// The hardening law of the case.
    pub fn out_of_range(&self, case: &Case, h: f64) -> Result<Vec<OutOfRange>, LawError> {
        if let Some(law) = self.of_equal_spheres(case) {
            return law.out_of_range(case, h);
        }
        // Of two bodies that are put in series each is asked by itself.
        let equal = Against::of(case) == Against::EqualSphere && self.body == Against::Plane;
        let pair = if equal { &like_itself(case) } else { case };
        if let Some(bodies) = table::bodies_alone(pair, self.body, 1.0) {
            let place = h / case.effective_radius();
            if is_of_one_material(pair) {
                // Each is of the radius 2 R*, and gives way by half of h.
                return self.out_of_range(&bodies[0], place * if bodies[0].opponent.is_some() { 0.5 } else { 0.25 });
            }
            let depth = |body: &Case| place * if body.opponent.is_some() { 2.0 } else { 1.0 };
            let mut found = Vec::new();
            for body in &bodies {
                found.extend(self.out_of_range(body, depth(body))?);
            }
            // Of the law that they are pressed by; how deep each goes the other has told.
            if let Some(law) = &self.pair {
                let more = law.out_of_range(case, h)?.into_iter().filter(|one| one.quantity != "a/R");
                found.extend(more.filter(|one| !found.iter().any(|known| known.quantity == one.quantity)).collect::<Vec<_>>());
            }
            return Ok(found);
        }
        let (body, sphere) = bodies(case)?;
        let contact = inputs(&body, &sphere, friction(case), h / case.sphere.radius);
        let range = |i: usize| self.inputs[i].range;
        let (mu, lambda) = (range(FRICTION), range(LAMBDA));
        let first = yield_lambda(body.sphere.poissons_ratio);
        // The numbers of a small contact, of one before first yield, and of little friction are
        // those of contacts that are similar.
        let checks = [
            ("a/R", contact[SIZE], Interval { from: 0.0, ..range(SIZE) }),
            ("nu", contact[POISSON], range(POISSON)),
            ("Lambda", first * contact[LAMBDA].exp(), Interval { from: 0.0, to: first * lambda.to.exp() }),
            ("mu", friction(case), Interval { from: 0.0, to: mu.to.exp() }),
        ];
        let hardening = (1..FRICTION).map(|i| ("hardening", contact[i], self.inputs[i].range));
        Ok(checks
            .into_iter()
            .chain(hardening)
            .filter(|(_, value, range)| (value - value.clamp(range.from, range.to)).abs() > MARGIN * (range.to - range.from))
            .map(|(quantity, value, range)| OutOfRange { quantity, value, range })
            .collect())
    }
}

/// The case of an equal pair as one of two bodies.
fn like_itself(case: &Case) -> Case {
    let opponent = Opponent::Deforming { radius: Some(case.sphere.radius), material: case.material.clone() };
    Case { opponent: Some(opponent), ..case.clone() }
}

/// Whether a case is of two bodies that deform and are of one material.
fn is_of_one_material(case: &Case) -> bool {
    matches!(&case.opponent, Some(Opponent::Deforming { material, .. }) if *material == case.material)
}

/// mu; full stick is refused before anything is asked.
pub(super) fn friction(case: &Case) -> f64 {
    match case.contact.friction {
        Friction::Coefficient(mu) => mu,
        Friction::Stick => f64::NAN,
    }
}

#[cfg(test)]
mod tests;

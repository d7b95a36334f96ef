//! The law of formulas: constants, where they come from, where they hold and how well, as
//! `law.json` has them.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::family;
use super::normal::{NormalModel, NormalState};
use super::shear::{self, Plasticity, ShearConstants};
use crate::analytical::{ElasticSphere, cattaneo_mindlin, johnson};
use crate::law::LawError;
use crate::law::bounds::{Checked, TOLD, ValueBounds};
use crate::law::json::{self, LawKind};
use crate::law::range::{Interval, MARGIN, OutOfRange};
use crate::law::report::{Candidate, FittedCase, NormalCandidate, RegionError};
use crate::law::variables::{Body, c_squared, yield_lambda};

/// The first key of a law file, by which it is recognised.
pub const FORMAT: &str = "asperity-law";
/// Version of the file's layout.
pub const VERSION: u32 = 2;

/// What a contact is before it is sheared: all that the law needs. Any one consistent system of
/// units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Axisymmetric {
    /// E, stress.
    pub youngs_modulus: f64,
    /// nu.
    pub poissons_ratio: f64,
    /// R, length.
    pub radius: f64,
    /// mu.
    pub friction: f64,
    /// sigma_rep, the flow stress at the representative strain 0.2 a/R and never below sigma_Y;
    /// infinite for an elastic sphere.
    pub sigma_rep: f64,
    /// Indentation h, length.
    pub h: f64,
    /// Contact radius a, length.
    pub a: f64,
    /// Normal force F_N, compression positive.
    pub f_n: f64,
}

impl Axisymmetric {
    /// That of a body at the indentation `h`, with Coulomb's coefficient `friction`.
    pub fn of(body: &Body, friction: f64, h: f64, NormalState { a, f_n }: NormalState) -> Self {
        let ElasticSphere { youngs_modulus, poissons_ratio, radius } = body.sphere;
        let sigma_rep = body.representative_stress(a);
        Self { youngs_modulus, poissons_ratio, radius, friction, sigma_rep, h, a, f_n }
    }

    /// The elastic sphere.
    pub fn sphere(&self) -> ElasticSphere {
        ElasticSphere { radius: self.radius, youngs_modulus: self.youngs_modulus, poissons_ratio: self.poissons_ratio }
    }

    /// Lambda.
    pub fn lambda(&self) -> f64 {
        johnson::lambda(&self.sphere(), self.sigma_rep, self.a)
    }

    /// c^2 = a^2/(2 R h).
    pub fn c_squared(&self) -> f64 {
        c_squared(self.radius, self.h, self.a)
    }
}

/// The law of one contact, in the units of its [`Axisymmetric`] data:
/// F_T = mu F_N_slip f_T(x), F_N = F_N0 - (F_N0 - F_N_slip) f_N(x), x = delta_T/delta_T_end.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Parameters {
    /// F_N0 before the shear.
    pub f_n0: f64,
    /// F_N at full slip.
    pub f_n_slip: f64,
    /// delta_T at x = 1, where the curves end and everything slips, length.
    pub delta_t_end: f64,
    /// Initial tangential stiffness, n mu F_N_slip/delta_T_end, force per length.
    pub k_t0: f64,
    /// n of f_T = 1 - (1 - x)^n.
    pub n: f64,
    /// M of f_N.
    pub m_exponent: f64,
    /// N of f_N.
    pub n_exponent: f64,
}

/// The data that the law was fitted to: where it holds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Validity {
    /// Lambda. Below first yield the law is Cattaneo and Mindlin's with the compliance of the body,
    /// and holds without data.
    pub lambda: Interval,
    /// mu.
    pub friction: Interval,
    /// a/R.
    pub relative_radius: Interval,
    /// c^2.
    pub c_squared: Interval,
    /// nu.
    pub poissons_ratio: Interval,
    /// Hardening exponent d ln sigma/d ln eps_p at the representative strain, which the law does
    /// not take but `law predict` checks: a study of ideally plastic spheres says nothing of
    /// hardening ones.
    pub hardening_exponent: Interval,
}

/// Where the constants come from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Provenance {
    /// The program and its version.
    pub program: String,
    /// Name of the study's directory.
    pub study: String,
    /// Cases used.
    pub cases: usize,
    /// Cases left out, with the reasons.
    pub left_out: Vec<(String, String)>,
    /// Cases used whose curve is that of its mesh, and not the limit of fine meshes.
    #[serde(default)]
    pub raw: usize,
    /// Different materials.
    pub materials: usize,
    /// Fewest and most elements per contact radius.
    pub elements_per_contact_radius: (usize, usize),
    /// Folds of the cross-validation, by material.
    pub folds: usize,
    /// Seed of the folds.
    pub seed: u64,
    /// Study of the law whose constants the fit started from and was drawn to; `None` if it knew of
    /// none, or did better without.
    pub prior: Option<PriorUse>,
}

/// How far a fit was drawn to the constants of another law.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PriorUse {
    /// Name of that law's study.
    pub study: String,
    /// Weight for the constants of the shear; `None`: they were fitted without.
    pub shear: Option<f64>,
    /// Weights for the constants of a0 and of F_N0, likewise.
    pub normal: Option<[f64; 2]>,
}

/// A fitted law.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Law {
    /// [`FORMAT`].
    pub format: String,
    /// [`VERSION`].
    pub version: u32,
    /// The constants of the shear.
    pub constants: ShearConstants,
    /// F_N0 and a0 from h.
    pub normal: NormalModel,
    /// Where it holds.
    pub validity: Validity,
    /// Where it comes from.
    pub provenance: Provenance,
    /// Cross-validated errors by region, F_N0 and a0 being known.
    pub errors: Vec<RegionError>,
    /// Cross-validated errors by region, F_N0 and a0 being predicted as well.
    pub errors_predicted: Vec<RegionError>,
    /// The fits that were compared, best first, and the baselines.
    pub candidates: Vec<Candidate>,
    /// The fits of the normal problem that were compared, best first.
    pub normal_candidates: Vec<NormalCandidate>,
    /// Every case with its own best parameters.
    pub cases: Vec<FittedCase>,
}

impl Law {
    /// The law of one contact. Below first yield it is Cattaneo and Mindlin's, exactly as a/R goes
    /// to 0; a contact without force has no slip force.
    pub fn contact(&self, inputs: &Axisymmetric) -> Parameters {
        contact(&self.constants, inputs)
    }

    /// F_T and F_N at the displacement `delta_t` of a shear in one direction, constant from
    /// delta_T_end on; F_T is odd and F_N even in `delta_t`.
    pub fn forces(&self, parameters: &Parameters, friction: f64, delta_t: f64) -> (f64, f64) {
        forces(parameters, friction, delta_t)
    }

    /// The contact of a body at the indentation `h`, with F_N0 and a0 of the law's own formulas.
    pub fn inputs(&self, body: &Body, friction: f64, h: f64) -> Axisymmetric {
        Axisymmetric::of(body, friction, h, self.normal.state(body, friction, h))
    }

    /// [`out_of_range`](Self::out_of_range), and the hardening exponent of a body that has yielded,
    /// where it is not one that the law was fitted to.
    pub fn body_out_of_range(&self, body: &Body, inputs: &Axisymmetric) -> Vec<OutOfRange> {
        let mut outside = self.out_of_range(inputs);
        let (value, range) = (body.hardening_exponent(inputs.a), self.validity.hardening_exponent);
        let yielded = inputs.lambda() > yield_lambda(inputs.poissons_ratio);
        if yielded && !range.contains(value, MARGIN) {
            outside.push(OutOfRange { quantity: "hardening exponent", value, range });
        }
        outside
    }

    /// What of the contact lies outside of the range of the fit; empty if nothing does.
    pub fn out_of_range(&self, inputs: &Axisymmetric) -> Vec<OutOfRange> {
        let Validity { lambda, friction, relative_radius, c_squared, poissons_ratio, .. } = self.validity;
        let elastic = inputs.lambda() <= yield_lambda(inputs.poissons_ratio);
        let size = inputs.a / inputs.radius;
        // Cattaneo and Mindlin need a small contact, and no fit.
        let mut checks = vec![("a/R", size, if elastic { Interval { from: 0.0, ..relative_radius } } else { relative_radius })];
        if !elastic {
            checks.push(("nu", inputs.poissons_ratio, poissons_ratio));
            checks.push((
                "Lambda",
                inputs.lambda(),
                Interval { from: lambda.from.min(yield_lambda(inputs.poissons_ratio)), ..lambda },
            ));
            checks.push(("mu", inputs.friction, Interval { from: 0.0, ..friction }));
            checks.push(("c^2", inputs.c_squared(), Interval { from: c_squared.from.min(0.5), ..c_squared }));
        }
        checks
            .into_iter()
            .filter(|(_, value, range)| !range.contains(*value, MARGIN))
            .map(|(quantity, value, range)| OutOfRange { quantity, value, range })
            .collect()
    }

    /// Writes `law.json`, whole or not at all.
    ///
    /// # Errors
    /// The place cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), LawError> {
        json::write(path, self)
    }

    /// Reads a `law.json` and checks it.
    ///
    /// # Errors
    /// [`LawError::BadLaw`]: no such file, not a law, another version, constants that are none.
    pub fn read(path: &Path) -> Result<Self, LawError> {
        json::read(path, Self::from_json)
    }

    /// A law from the text of its file; the error is what is wrong, in words.
    pub(in crate::law) fn from_json(text: &str) -> Result<Self, String> {
        json::parse(&family::without_names(text)?)
    }
}

/// What the constants of the forms may be, which are of order one: positive, since the search has
/// their logarithms.
const CONSTANT: ValueBounds = ValueBounds { least: 1e-9, most: 1e9 };
/// Ends of the ranges of what a law was fitted to.
const RANGE: ValueBounds = ValueBounds { least: 0.0, most: 1e9 };
/// Of Poisson's ratio: what an isotropic solid can have.
const POISSON: ValueBounds = ValueBounds { least: -1.0, most: 0.5 };

impl LawKind for Law {
    const NAME: &'static str = "law of formulas";
    const FORMAT: &'static str = FORMAT;
    const VERSION: u32 = VERSION;

    fn check(&self) -> Checked {
        let Self { constants, normal, validity, .. } = self;
        for (key, values) in [
            ("constants.fall", &constants.fall[..]),
            ("constants.exponent", &constants.exponent),
            ("constants.slip", &constants.slip),
            ("constants.curve", &constants.curve),
            ("normal.radius", &normal.radius),
            ("normal.force", &normal.force),
        ] {
            CONSTANT.hold(key, values)?;
        }
        for (key, range) in [
            ("validity.lambda", validity.lambda),
            ("validity.friction", validity.friction),
            ("validity.relative_radius", validity.relative_radius),
            ("validity.c_squared", validity.c_squared),
            ("validity.hardening_exponent", validity.hardening_exponent),
        ] {
            RANGE.hold_interval(key, range)?;
        }
        POISSON.hold_interval("validity.poissons_ratio", validity.poissons_ratio)?;
        TOLD.hold_all("errors", &self.errors)?;
        TOLD.hold_all("errors_predicted", &self.errors_predicted)?;
        TOLD.hold_all("candidates", &self.candidates)?;
        TOLD.hold_all("normal_candidates", &self.normal_candidates)?;
        TOLD.hold_all("cases", &self.cases)
    }
}

/// The law of one contact for given constants: see [`Law::contact`].
pub fn contact(constants: &ShearConstants, inputs: &Axisymmetric) -> Parameters {
    let sphere = inputs.sphere();
    let state = Plasticity::new(
        inputs.friction,
        inputs.a / inputs.radius,
        inputs.lambda(),
        yield_lambda(inputs.poissons_ratio),
        inputs.c_squared(),
    );
    let n = shear::exponent(&constants.exponent, &state);
    let share = 1.0 - shear::fall(&constants.fall, &state);
    let factor = shear::slip_factor(&constants.slip, &state, n, share);
    let (m_exponent, n_exponent) = shear::curve_exponents(&constants.curve, inputs.friction, n);
    let mindlin = cattaneo_mindlin::initial_stiffness(&sphere, inputs.a);
    let elastic_slip = if mindlin > 0.0 { 1.5 * inputs.friction * inputs.f_n / mindlin } else { 0.0 };
    Parameters {
        f_n0: inputs.f_n,
        f_n_slip: share * inputs.f_n,
        delta_t_end: factor * elastic_slip,
        k_t0: mindlin * n / 1.5 * share / factor,
        n,
        m_exponent,
        n_exponent,
    }
}

/// F_T and F_N at the displacement `delta_t`: see [`Law::forces`].
pub fn forces(parameters: &Parameters, friction: f64, delta_t: f64) -> (f64, f64) {
    let p = parameters;
    let x = if p.delta_t_end > 0.0 { (delta_t.abs() / p.delta_t_end).min(1.0) } else { 1.0 };
    let f_t = friction * p.f_n_slip * shear::f_t(x, p.n);
    let f_n = p.f_n0 - (p.f_n0 - p.f_n_slip) * shear::f_n(x, p.m_exponent, p.n_exponent);
    (if delta_t == 0.0 { 0.0 } else { f_t.copysign(delta_t) }, f_n)
}

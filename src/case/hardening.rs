//! Hardening laws: the yield stress sigma_y as a function of the equivalent plastic strain alpha.

use serde::Serialize;

use super::error::CaseError;
use super::reader::Reader;
use crate::material::{FlowStress, HardeningLaw, MaterialError, hollomon_yield_stress};
use crate::real::Real;

/// Yield stress sigma_y(alpha) over the equivalent plastic strain alpha >= 0. Every law but
/// `Elastic` is isotropic J2 hardening that never softens.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "law", rename_all = "kebab-case")]
pub enum Hardening {
    /// Never yields.
    Elastic,
    /// sigma_y = sigma_Y.
    Ideal {
        /// sigma_Y > 0, a stress.
        yield_stress: f64,
    },
    /// sigma_y = sigma_Y + H alpha.
    Linear {
        /// sigma_Y > 0, a stress.
        yield_stress: f64,
        /// H >= 0, a stress.
        modulus: f64,
    },
    /// sigma_y = sigma_Y + K alpha^n.
    Power {
        /// sigma_Y > 0, a stress.
        yield_stress: f64,
        /// K >= 0, a stress.
        coefficient: f64,
        /// n in (0, 1].
        exponent: f64,
    },
    /// Total-strain power law sigma = sigma_0 eps^(1/m), with eps = sigma/E + alpha, from the point
    /// where it meets Hooke's line (Olsson and Larsson, IJSS 81, 2016, two-parameter hardening).
    Hollomon {
        /// sigma_0 > 0, a stress.
        coefficient: f64,
        /// m > 1.
        exponent: f64,
    },
    /// sigma_y = sigma_Y + (sigma_inf - sigma_Y) (1 - exp(-k alpha)).
    Voce {
        /// sigma_Y > 0, a stress.
        yield_stress: f64,
        /// The stress sigma_inf >= sigma_Y that is approached.
        saturation_stress: f64,
        /// k > 0, per unit of plastic strain.
        rate: f64,
    },
    /// Straight lines between points, constant after the last.
    Table {
        /// Pairs (alpha, stress), alpha strictly increasing from 0, stress > 0 and never falling.
        points: Vec<[f64; 2]>,
    },
}

/// Largest yield stress over Young's modulus that is taken for a material: beyond it the first
/// yield is at strains where the elastic law itself is in doubt.
const MAX_YIELD_STRAIN: f64 = 0.2;
/// Smallest one: an indentation is then a million times that of first yield, and forces are lost in
/// rounding.
const MIN_YIELD_STRAIN: f64 = 1e-7;

impl Hardening {
    /// The stress at first yield, a stress > 0; `None` for a law that never yields.
    ///
    /// For Hollomon's law it is where sigma_0 eps^(1/m) meets E eps (Olsson and Larsson 2016).
    pub fn yield_stress(&self, youngs_modulus: f64) -> Option<f64> {
        match self {
            Hardening::Elastic => None,
            Hardening::Ideal { yield_stress }
            | Hardening::Linear { yield_stress, .. }
            | Hardening::Power { yield_stress, .. }
            | Hardening::Voce { yield_stress, .. } => Some(*yield_stress),
            Hardening::Hollomon { coefficient, exponent } => Some(hollomon_yield_stress(*coefficient, *exponent, youngs_modulus)),
            Hardening::Table { points } => points.first().map(|point| point[1]),
        }
    }

    /// Which law it is.
    pub fn kind(&self) -> HardeningLaw {
        match self {
            Hardening::Elastic => HardeningLaw::Elastic,
            Hardening::Ideal { .. } => HardeningLaw::Ideal,
            Hardening::Linear { .. } => HardeningLaw::Linear,
            Hardening::Power { .. } => HardeningLaw::Power,
            Hardening::Hollomon { .. } => HardeningLaw::Hollomon,
            Hardening::Voce { .. } => HardeningLaw::Voce,
            Hardening::Table { .. } => HardeningLaw::Table,
        }
    }

    /// Its numbers, in the order of [`HardeningLaw::parameters`]; a table has none.
    pub fn numbers(&self) -> Vec<f64> {
        self.clone().numbers_mut().into_iter().map(|number| *number).collect()
    }

    fn numbers_mut(&mut self) -> Vec<&mut f64> {
        match self {
            Hardening::Elastic | Hardening::Table { .. } => Vec::new(),
            Hardening::Ideal { yield_stress } => vec![yield_stress],
            Hardening::Linear { yield_stress, modulus } => vec![yield_stress, modulus],
            Hardening::Power { yield_stress, coefficient, exponent } => vec![yield_stress, coefficient, exponent],
            Hardening::Hollomon { coefficient, exponent } => vec![coefficient, exponent],
            Hardening::Voce { yield_stress, saturation_stress, rate } => vec![yield_stress, saturation_stress, rate],
        }
    }

    /// The law with stresses divided by `stress` (Young's modulus makes E = 1).
    #[must_use]
    pub fn scaled(&self, stress: f64) -> Self {
        let mut scaled = self.clone();
        for (number, parameter) in scaled.numbers_mut().into_iter().zip(self.kind().parameters()) {
            if parameter.is_stress {
                *number /= stress;
            }
        }
        if let Hardening::Table { points } = &mut scaled {
            points.iter_mut().for_each(|[_, value]| *value /= stress);
        }
        scaled
    }

    /// Its flow stress; `youngs_modulus` in the unit of its stresses.
    ///
    /// # Errors
    /// [`MaterialError`] for parameters that no law has.
    pub fn law<R: Real>(&self, youngs_modulus: f64) -> Result<FlowStress<R>, MaterialError> {
        match *self {
            Hardening::Elastic => Ok(FlowStress::Elastic),
            Hardening::Ideal { yield_stress } => FlowStress::ideal(yield_stress),
            Hardening::Linear { yield_stress, modulus } => FlowStress::linear(yield_stress, modulus),
            Hardening::Power { yield_stress, coefficient, exponent } => FlowStress::power(yield_stress, coefficient, exponent),
            Hardening::Hollomon { coefficient, exponent } => FlowStress::hollomon(coefficient, exponent, youngs_modulus),
            Hardening::Voce { yield_stress, saturation_stress, rate } => FlowStress::voce(yield_stress, saturation_stress, rate),
            Hardening::Table { ref points } => FlowStress::table(points),
        }
    }

    /// The key by which it says where it yields first.
    pub(super) fn yield_key(&self) -> &'static str {
        match self {
            Hardening::Hollomon { .. } => "coefficient",
            Hardening::Table { .. } => "points",
            _ => "yield_stress",
        }
    }

    /// What it comes to at a plastic strain of 1, or at its end, from first yield on, and the key
    /// that says so; `None` of one that does not harden.
    pub(super) fn strength(&self, yield_stress: f64) -> Option<(&'static str, f64)> {
        Some(match self {
            Hardening::Elastic | Hardening::Ideal { .. } => return None,
            Hardening::Linear { modulus, .. } => ("modulus", yield_stress + modulus),
            Hardening::Power { coefficient, .. } => ("coefficient", yield_stress + coefficient),
            Hardening::Hollomon { coefficient, .. } => ("coefficient", *coefficient),
            Hardening::Voce { saturation_stress, .. } => ("saturation_stress", *saturation_stress),
            Hardening::Table { points } => ("points", points.last().map_or(yield_stress, |point| point[1])),
        })
    }

    /// Reads `[material.hardening]`.
    pub(super) fn read(table: &Reader<'_>, youngs_modulus: f64) -> Result<Self, CaseError> {
        let laws = HardeningLaw::ALL.map(|law| (law.word(), law));
        let law = table.require("law", &laws.map(|(word, _)| format!("{word:?}")).join(", "))?.choice(&laws)?;
        table.only(&keys(law))?;
        let number =
            |name: &str, allowed: &str, accept: &dyn Fn(f64) -> bool| table.require(name, allowed)?.number(allowed, accept);
        let yield_stress = || number("yield_stress", &yield_range(youngs_modulus), &|stress| yields(stress, youngs_modulus));
        let no_softening = "a stress >= 0 (no softening)";
        Ok(match law {
            HardeningLaw::Elastic => Hardening::Elastic,
            HardeningLaw::Ideal => Hardening::Ideal { yield_stress: yield_stress()? },
            HardeningLaw::Linear => {
                Hardening::Linear { yield_stress: yield_stress()?, modulus: number("modulus", no_softening, &|x| x >= 0.0)? }
            }
            HardeningLaw::Power => Hardening::Power {
                yield_stress: yield_stress()?,
                coefficient: number("coefficient", no_softening, &|x| x >= 0.0)?,
                exponent: number("exponent", "n in (0, 1], in sigma_Y + K alpha^n", &|n| n > 0.0 && n <= 1.0)?,
            },
            HardeningLaw::Hollomon => {
                let coefficient = number("coefficient", "a stress > 0", &|x| x > 0.0)?;
                let exponent = number("exponent", "m > 1, in sigma_0 eps^(1/m)", &|m| m > 1.0)?;
                let law = Hardening::Hollomon { coefficient, exponent };
                let meets = law.yield_stress(youngs_modulus).unwrap_or(f64::NAN);
                if !yields(meets, youngs_modulus) {
                    let what = format!("is {coefficient:?} and puts the yield stress (sigma_0^m/E)^(1/(m-1)) at {meets:.4e}");
                    let allowed = format!("a coefficient that puts it at {}", yield_range(youngs_modulus));
                    return Err(table.require("coefficient", &allowed)?.refuse(&what, &allowed));
                }
                law
            }
            HardeningLaw::Voce => {
                let yield_stress = yield_stress()?;
                let allowed = format!("a stress >= yield_stress = {yield_stress:?} (no softening)");
                Hardening::Voce {
                    yield_stress,
                    saturation_stress: number("saturation_stress", &allowed, &|stress| stress >= yield_stress)?,
                    rate: number("rate", "a number > 0", &|rate| rate > 0.0)?,
                }
            }
            HardeningLaw::Table => Hardening::Table { points: read_points(table, youngs_modulus)? },
        })
    }
}

/// The keys of `[material.hardening]` under a law.
fn keys(law: HardeningLaw) -> Vec<&'static str> {
    let others: &[&str] = if law == HardeningLaw::Table { &["yield_stress", "points"] } else { &[] };
    ["law"].into_iter().chain(law.parameters().iter().map(|parameter| parameter.key)).chain(others.iter().copied()).collect()
}

fn yields(stress: f64, youngs_modulus: f64) -> bool {
    let strain = stress / youngs_modulus;
    (MIN_YIELD_STRAIN..MAX_YIELD_STRAIN).contains(&strain)
}

fn yield_range(youngs_modulus: f64) -> String {
    let [least, most] = [MIN_YIELD_STRAIN, MAX_YIELD_STRAIN].map(|strain| strain * youngs_modulus);
    format!("a stress > 0, from {MIN_YIELD_STRAIN:e} E = {least:e} and < {MAX_YIELD_STRAIN} E = {most:?}")
}

/// `points`, completed by (0, yield_stress) when they do not begin at alpha = 0.
fn read_points(table: &Reader<'_>, youngs_modulus: f64) -> Result<Vec<[f64; 2]>, CaseError> {
    const POINTS: &str = "[[alpha, stress], ...], alpha strictly increasing from >= 0, stress > 0 and never falling";
    let field = table.require("points", POINTS)?;
    let mut points: Vec<[f64; 2]> = Vec::new();
    for row in field.array(POINTS)? {
        let pair = row.array(POINTS)?;
        let [alpha, stress] = pair.as_slice() else {
            let commas = if pair.len() == 4 { " (a number has a decimal point, no comma)" } else { "" };
            return Err(row.refuse(&format!("has {} numbers{commas}", pair.len()), POINTS));
        };
        points.push(match points.last() {
            None => [alpha.number("alpha >= 0", |x| x >= 0.0)?, stress.number("a stress > 0", |x| x > 0.0)?],
            Some([before, below]) => [
                alpha.number(&format!("alpha > {before:?}, strictly increasing"), |x| x > *before)?,
                stress.number(&format!("a stress >= {below:?} (no softening)"), |x| x >= *below)?,
            ],
        });
    }
    let Some([alpha, stress]) = points.first().copied() else {
        return Err(field.refuse("has no points", POINTS));
    };
    let at_zero = alpha == 0.0;
    match table.get("yield_stress") {
        Some(given) => {
            let allowed = if at_zero {
                format!("the stress {stress:?} of the point at alpha = 0, or no yield_stress")
            } else {
                format!("a stress > 0, at most {stress:?}, that of the first point (no softening)")
            };
            let first = given.number(&allowed, |x| if at_zero { x == stress } else { x > 0.0 && x <= stress })?;
            if !at_zero {
                points.insert(0, [0.0, first]);
            }
        }
        None if !at_zero => return Err(table.missing("yield_stress", "a stress > 0, or a first point at alpha = 0")),
        None => {}
    }
    let first = points[0][1];
    if !yields(first, youngs_modulus) {
        return Err(table
            .get("yield_stress")
            .unwrap_or(field)
            .refuse(&format!("yields first at {first:?}"), &yield_range(youngs_modulus)));
    }
    Ok(points)
}

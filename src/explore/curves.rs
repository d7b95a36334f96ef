//! What a law says of one case, with the closed forms beside it.

use crate::analytical::{ElasticSphere, cattaneo_mindlin::CattaneoMindlin, hertz};
use crate::case::{Case, Friction, Hold, Material, Opponent, Segment, ShearTarget};
use crate::contact_law::path::follow_centres;
use crate::contact_law::{Centres, ContactParameters, ContactState};
use crate::law::plots::as_step;
use crate::law::range::OutOfRange;
use crate::law::report::LAMBDA_BOUNDS;
use crate::law::table::{equivalent, indentation_at_first_yield};
use crate::law::variables::{Body, Variables, yield_lambda};
use crate::law::{LawError, LawFile};
use crate::output::{StepRecord, Summary, SummaryInputs};

use super::trust::Trust;

/// A law at one case, in the case's units.
#[derive(Clone, Debug, PartialEq)]
pub struct LawCurves {
    /// The case.
    pub case: Case,
    /// The greatest indentation.
    pub h: f64,
    /// mu.
    pub friction: f64,
    /// Pressed to `h` and sheared to full slip.
    pub shear: Vec<StepRecord>,
    /// Along the cycle: the path of the case, where that goes back, else to full slip and back.
    pub cycle: Vec<StepRecord>,
    /// Both in some numbers, as a run's.
    pub summary: Summary,
    /// The sphere on a plane that makes the same elastic contact.
    pub elastic: ElasticSphere,
    /// h at first yield; `None` where nothing yields.
    pub first_yield: Option<f64>,
    /// Contact radius at `h`.
    pub a: f64,
    /// Stiffness of a shear without slip at `h`.
    pub k_t: f64,
    /// Lambda, that of first yield, and the normalised hardness.
    pub lambda: f64,
    /// See `lambda`.
    pub yield_lambda: f64,
    /// See `lambda`.
    pub hardness: f64,
    /// What of the contact lies outside of the law's range.
    pub out_of_range: Vec<OutOfRange>,
    /// Where the law comes from, and its errors.
    pub trust: Trust,
}

/// The path of a press and a shear to full slip.
pub(super) fn to_slip(h: f64) -> Vec<Segment> {
    vec![Segment::Indentation { indentation: h }, Segment::Shear { shear: ShearTarget::FullSlip, hold: Hold::Indentation }]
}

/// Lambda, H and Lambda at first yield of the body that is nearer to plastic: each body with the
/// radius with which it alone has the contact's E*/R*, as a sphere on a plane and an equal pair do.
fn nearest_to_plastic(case: &Case, h: f64, a: f64, f_n0: f64) -> Result<(Variables, f64), LawError> {
    let elastic = equivalent(case);
    let of = |material: &Material| -> Result<(Variables, f64), LawError> {
        let (youngs_modulus, poissons_ratio) = (material.youngs_modulus, material.poissons_ratio);
        let own = ElasticSphere { radius: 1.0, youngs_modulus, poissons_ratio }.effective_modulus();
        let body = Body::new(elastic.radius * own / elastic.effective_modulus(), material)?;
        Ok((body.variables(h / case.bodies(), a, f_n0), yield_lambda(poissons_ratio)))
    };
    let sphere = of(&case.material)?;
    let Some(Opponent::Deforming { material, .. }) = &case.opponent else { return Ok(sphere) };
    let other = of(material)?;
    Ok(if other.0.lambda / other.1 > sphere.0.lambda / sphere.1 { other } else { sphere })
}

impl LawCurves {
    /// Follows the paths with parameters that belong to the case.
    ///
    /// # Errors
    /// What the law says of the case.
    pub fn new(law: &LawFile, case: Case, parameters: &ContactParameters) -> Result<Self, LawError> {
        let Friction::Coefficient(friction) = case.contact.friction else {
            return Err(LawError::NotCovered {
                problem: "friction is \"stick\", and the law describes slip",
                remedy: "Give a number, or simulate the case",
            });
        };
        let (h, centres) = (case.greatest_indentation(), Centres::of(&case));
        let along =
            |path: &[Segment]| -> Vec<StepRecord> { follow_centres(parameters, centres, path).iter().map(as_step).collect() };
        let shear = along(&to_slip(h));
        let cycle = along(&cycle_of(&case, h));
        let a = parameters.update(&ContactState::default(), h, [0.0; 2]).1.a;
        // Of the path that is followed here, not of the case's.
        let inputs = SummaryInputs { oblique: Vec::new(), ..SummaryInputs::of(&case) };
        let summary = Summary::from_history(&shear, &inputs);
        let f_n0 = summary.f_n0.unwrap_or(0.0);
        let (variables, first) = nearest_to_plastic(&case, h, a, f_n0)?;
        Ok(Self {
            h,
            friction,
            elastic: equivalent(&case),
            first_yield: indentation_at_first_yield(&case)?,
            a,
            k_t: parameters.virgin(h).point.k_t,
            lambda: variables.lambda,
            yield_lambda: first,
            hardness: variables.hardness,
            out_of_range: law.out_of_range(&case, h)?,
            trust: Trust::of(law, &case, [variables.lambda, first], friction)?,
            shear,
            cycle,
            summary,
            case,
        })
    }

    /// The part of the shear's path that presses.
    pub fn press(&self) -> &[StepRecord] {
        let end = self.shear.iter().take_while(|record| record.segment == 0).count();
        &self.shear[..end]
    }

    /// The part that shears.
    pub fn slip(&self) -> &[StepRecord] {
        &self.shear[self.press().len()..]
    }

    /// Cattaneo and Mindlin's contact at the indentation.
    pub fn mindlin(&self) -> CattaneoMindlin {
        CattaneoMindlin::at_indentation(self.elastic, self.friction, self.h)
    }

    /// F_N at first yield, by Hertz.
    pub fn yield_force(&self) -> Option<f64> {
        self.first_yield.map(|h| hertz::force(&self.elastic, h))
    }

    /// Whether anything has yielded.
    pub fn yields(&self) -> bool {
        self.first_yield.is_some_and(|first| self.h > first)
    }

    /// Whether the contact is elastic, elastic-plastic or fully plastic (Johnson's levels).
    pub fn regime(&self) -> &'static str {
        match self.lambda {
            _ if !self.yields() => "elastic: nothing has yielded (Johnson's level I)",
            lambda if lambda <= LAMBDA_BOUNDS[1] => "elastic-plastic: between first yield and Λ = 160 (Johnson's level II)",
            _ => "fully plastic: Λ above 160 (Johnson's level III)",
        }
    }
}

/// The cycle: the case's own path, if a law can follow it and it goes back somewhere; else to full
/// slip and back.
fn cycle_of(case: &Case, h: f64) -> Vec<Segment> {
    let along_x = case.moves_along_x() && !case.path.iter().any(|segment| matches!(segment, Segment::Slip { .. }));
    if along_x && case.path.len() > 2 {
        return case.path.clone();
    }
    let back = Segment::Shear { shear: ShearTarget::Displacement(0.0), hold: Hold::Indentation };
    to_slip(h).into_iter().chain([back, Segment::Release { share: 0.0 }]).collect()
}

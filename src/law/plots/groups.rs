//! What the pictures of a study have in common: groups of cases with their colours and marks,
//! ranges of Lambda, the law for a reference sphere.

use crate::case::{Hardening, Material};
use crate::law::Law;
use crate::law::data::Sample;
use crate::law::formulas::model::{Axisymmetric, Parameters};
use crate::law::variables::{Body, Variables};
use crate::output::plots::canvas::Colour;
use crate::output::plots::chart::{Axis, ColourBar, Mark, Series};
use crate::output::plots::style::{GROUPS, tick};

/// The label of Lambda's axis.
pub const LAMBDA_AXIS: &str = "Λ = E a / [(1 − ν²) σ_rep R]";

/// A logarithmic axis of Lambda over some values; those of elastic spheres, zero, are off it.
pub fn lambda_axis(values: impl IntoIterator<Item = f64>) -> Axis {
    let (low, high) = positive_range(values);
    Axis::logarithmic(LAMBDA_AXIS, 0.8 * low, 1.25 * high)
}

/// Colours over the range of Lambda.
pub fn lambda_bar(samples: &[Sample]) -> ColourBar {
    let (low, high) = positive_range(samples.iter().map(|sample| sample.variables.lambda));
    ColourBar { axis: Axis::logarithmic("Λ", low, high) }
}

/// Least and greatest of the positive values; (1, 10) if there are none.
fn positive_range(values: impl IntoIterator<Item = f64>) -> (f64, f64) {
    let (low, high) = values
        .into_iter()
        .filter(|value| *value > 0.0 && value.is_finite())
        .fold((f64::INFINITY, 0.0_f64), |(low, high), value| (low.min(value), high.max(value)));
    if high > 0.0 { (low, high) } else { (1.0, 10.0) }
}

/// Colour and mark of the `i`-th group.
pub fn look(i: usize) -> (Colour, Mark) {
    (GROUPS[i % GROUPS.len()], Mark::ALL[i % Mark::ALL.len()])
}

/// The different values of mu, increasing.
pub fn frictions(samples: &[Sample]) -> Vec<f64> {
    let mut all: Vec<f64> = samples.iter().map(|sample| sample.friction).collect();
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}

/// A series of marks a value of mu, (Lambda, `value`) of its samples.
pub fn by_friction(samples: &[Sample], value: impl Fn(&Sample) -> f64) -> Vec<Series> {
    let series = |(i, mu): (usize, f64)| {
        let (colour, mark) = look(i);
        let points = samples.iter().filter(|s| s.friction == mu).map(|s| (s.variables.lambda, value(s))).collect();
        Series { opacity: 0.85, ..Series::marks(format!("μ = {}", tick(mu)), colour, mark, points) }
    };
    frictions(samples).into_iter().enumerate().map(series).collect()
}

/// The normal problem of a law for ideally plastic spheres of falling yield stress, all at one h/R:
/// what its curves over Lambda are drawn for.
pub struct Reference {
    h: f64,
    nu: f64,
    states: Vec<(Axisymmetric, Variables)>,
}

impl Reference {
    /// At the median of some h/R. The curve covers what the law was fitted to and the elastic range
    /// below.
    pub fn new(law: &Law, nu: f64, indentations: impl IntoIterator<Item = f64>) -> Self {
        let mut all: Vec<f64> = indentations.into_iter().collect();
        all.sort_by(f64::total_cmp);
        let h = all.get(all.len() / 2).copied().unwrap_or(0.01);
        let states = (0..=240).filter_map(|i| Self::state(law, nu, h, 5.0 * 1e5_f64.powf(f64::from(i) / 240.0)));
        let states = states.filter(|(_, v)| v.lambda <= law.validity.lambda.to).collect();
        Self { h, nu, states }
    }

    /// One sphere; `stiffness` is E/sigma_Y.
    fn state(law: &Law, nu: f64, h: f64, stiffness: f64) -> Option<(Axisymmetric, Variables)> {
        let hardening = Hardening::Ideal { yield_stress: 1.0 / stiffness };
        let body = Body::new(1.0, &Material { youngs_modulus: 1.0, poissons_ratio: nu, hardening }).ok()?;
        let inputs = law.inputs(&body, 0.0, h);
        Some((inputs, body.variables(h, inputs.a, inputs.f_n)))
    }

    /// What it is, for a legend.
    pub fn label(&self) -> String {
        format!("law, no hardening, h/R = {}", tick(self.h))
    }

    /// nu of the spheres.
    pub fn poissons_ratio(&self) -> f64 {
        self.nu
    }

    /// A quantity of the normal problem over Lambda.
    pub fn normal(&self, value: impl Fn(&Variables) -> f64) -> Vec<(f64, f64)> {
        self.states.iter().map(|(_, variables)| (variables.lambda, value(variables))).collect()
    }

    /// A quantity of the law over Lambda for each mu, dashed in the colours of [`by_friction`]; the
    /// first one has the label.
    pub fn by_friction(&self, law: &Law, frictions: &[f64], value: impl Fn(&Parameters, &Axisymmetric) -> f64) -> Vec<Series> {
        let series = |(i, &friction): (usize, &f64)| {
            let at = |(inputs, variables): &(Axisymmetric, Variables)| {
                let inputs = Axisymmetric { friction, ..*inputs };
                (variables.lambda, value(&law.contact(&inputs), &inputs))
            };
            let label = if i == 0 { self.label() } else { String::new() };
            Series::dashed(label, look(i).0, 7.0, self.states.iter().map(at).collect())
        };
        frictions.iter().enumerate().map(series).collect()
    }
}

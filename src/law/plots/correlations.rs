//! What the law correlates, over Lambda and mu: the fall of F_N, n and delta_T_end.

use super::groups::{Reference, by_friction, frictions, lambda_axis};
use crate::analytical::cattaneo_mindlin;
use crate::law::data::Sample;
use crate::law::formulas::fit::inputs;
use crate::law::formulas::model::Axisymmetric;
use crate::law::formulas::own_fit::own_fit;
use crate::law::{Law, LawError};
use crate::output::plots::chart::{Axis, Chart, draw_chart, draw_charts, extent};
use crate::output::plots::{Picture, Sheet};

/// The law's reference sphere at the samples' median h/R.
fn reference(samples: &[Sample], law: &Law) -> Reference {
    let nu = samples.first().map_or(0.3, |sample| sample.body.sphere.poissons_ratio);
    Reference::new(law, nu, samples.iter().map(|sample| sample.h0 / sample.body.sphere.radius))
}

/// F_N_slip/F_N0 over Lambda.
pub fn fall(samples: &[Sample], law: Option<&Law>, sheet: Sheet) -> Result<Picture, LawError> {
    let mut series = by_friction(samples, |sample| sample.f_n_slip / sample.f_n0);
    if let Some(law) = law {
        series.extend(reference(samples, law).by_friction(law, &frictions(samples), |p, _| p.f_n_slip / p.f_n0));
    }
    let chart = Chart {
        title: "Normal force left at full slip".into(),
        x: lambda_axis(samples.iter().map(|sample| sample.variables.lambda)),
        y: Axis::linear("F_{N,slip} / F_N0", 0.0, 1.06),
        series,
        bar: None,
    };
    let caption = "Normal force at full slip over that before the shear, h being held: nothing is lost where the contact is elastic. The law \
                   has hardening and a/R in it as well, so that its curves, of one reference sphere, need not meet every mark.";
    Ok(Picture::draw("fall", caption, sheet.chart((860, 560)), |root| draw_chart(root, &chart))?)
}

/// n and delta_T_end over its elastic value: each case's own best ones, and the law's.
pub fn parameters(samples: &[Sample], law: &Law, sheet: Sheet) -> Result<Picture, LawError> {
    let own = own_fit;
    let reference = reference(samples, law);
    let frictions = frictions(samples);
    let x = || lambda_axis(samples.iter().map(|sample| sample.variables.lambda));
    let elastic = |inputs: &Axisymmetric| {
        1.5 * inputs.friction * inputs.f_n / cattaneo_mindlin::initial_stiffness(&inputs.sphere(), inputs.a)
    };
    // A curve without an optimum has no mark.
    let mut n = by_friction(samples, |sample| own(sample).map_or(f64::NAN, |own| own.n));
    let mut factor = by_friction(samples, |sample| own(sample).map_or(f64::NAN, |own| own.slip_factor));
    // Single curves may have a far larger optimum; the law's own range and most of the marks are
    // what is shown.
    let most = |sample: &Sample| law.contact(&inputs(sample)).delta_t_end / elastic(&inputs(sample));
    let highest = 1.6 * extent(samples.iter().map(most)).1;
    n.extend(reference.by_friction(law, &frictions, |p, _| p.n));
    factor.extend(reference.by_friction(law, &frictions, |p, inputs| p.delta_t_end / elastic(inputs)));
    let charts = [
        Chart { title: "Exponent of f_T".into(), x: x(), y: Axis::linear("n", 0.0, 10.5), series: n, bar: None },
        Chart {
            title: "Displacement at which the curves end".into(),
            x: x(),
            y: Axis::linear("δ_{T,end} / elastic δ_{T,end}", 0.0, highest.max(2.0)),
            series: factor,
            bar: None,
        },
    ];
    let caption = "Marks: n and δ_T_end of each case by least squares of its own F_T curve; the two go together, \
                   so that single curves leave \
                   them loosely determined. Lines: the law for a reference sphere. Both start from Cattaneo and Mindlin's 3/2 and 1.";
    let (size, columns) = sheet.charts((1180, 520), 2);
    Ok(Picture::draw("parameters", caption, size, |root| draw_charts(root, columns, &charts))?)
}

//! Hbar and c^2 over Lambda: the simulations among the published curves.

use std::f64::consts::PI;

use super::NormalContact;
use super::groups::{Reference, lambda_axis, look};
use crate::analytical::jackson_green::JacksonGreen;
use crate::analytical::kogut_etsion::KogutEtsion;
use crate::analytical::olsson_larsson::{c_squared, normalized_hardness, plastic_c_squared};
use crate::analytical::{ElasticSphere, johnson};
use crate::law::Law;
use crate::law::variables::{Variables, yield_lambda};
use crate::output::OutputError;
use crate::output::plots::chart::{Axis, Chart, Line, Mark, Series, draw_chart, extent};
use crate::output::plots::style::{GREY, INK, TEAL, VIOLET};
use crate::output::plots::{Picture, Sheet};

const SIZE: (u32, u32) = (860, 600);
/// Upper ends of the groups of hardening exponents, and their names.
const HARDENING: [(f64, &str); 4] =
    [(1e-3, "no hardening"), (0.15, "e < 0.15"), (0.3, "e 0.15 to 0.3"), (f64::INFINITY, "e > 0.3")];
/// a/R from which a contact is large: the published curves are for small ones.
const LARGE: f64 = 0.15;
/// E/sigma_Y for which the curves of Kogut & Etsion and Jackson & Green are drawn; only the latter
/// depend on it, and weakly.
const STIFFNESS: f64 = 1000.0;

/// Johnson's map: Hbar over Lambda.
pub fn johnson(contacts: &[NormalContact], law: Option<&Law>, sheet: Sheet) -> Result<Picture, OutputError> {
    let x = lambda_axis(contacts.iter().map(|contact| contact.variables.lambda));
    let over = |curve: &dyn Fn(f64) -> f64| along(&x, curve);
    let mut series = vec![
        Series::solid("Hertz, 4Λ/(3π)", GREY, over(&johnson::elastic_hardness)),
        Series::dashed("Olsson & Larsson 2016", INK, 9.0, over(&|lambda| normalized_hardness(lambda, 3.0))),
    ];
    let nu = contacts.first().map_or(0.3, |contact| contact.poissons_ratio);
    series.extend(published(nu, |v| v.hardness));
    series.extend(ours(contacts, |v| v.hardness));
    series.extend(reference(contacts, law, |v| v.hardness));
    let greatest = extent(contacts.iter().map(|contact| contact.variables.hardness)).1.max(3.0);
    let y = Axis::linear("H̄ = F_N / (π a² σ_rep)", 0.0, 1.12 * greatest);
    let chart = Chart { title: "Johnson's map".into(), x, y, series, bar: None };
    let caption = "Normalised hardness H̄ over Johnson's Λ, of every case before its shear. e is the local hardening exponent \
                   d ln σ/d ln ε_p at the representative strain; hollow marks are large contacts, a/R > 0.15, for which the published \
                   curves, of small deformation, are too high.";
    Picture::draw("johnson", caption, sheet.chart(SIZE), |root| draw_chart(root, &chart))
}

/// c^2 over Lambda.
pub fn area(contacts: &[NormalContact], law: Option<&Law>, sheet: Sheet) -> Result<Picture, OutputError> {
    let x = lambda_axis(contacts.iter().map(|contact| contact.variables.lambda));
    let mut series = vec![Series::solid("Hertz", GREY, vec![(x.range.0, 0.5), (x.range.1, 0.5)])];
    for (exponent, line, name) in [
        (0.0, Line::Dashed(9.0), "Olsson & Larsson 2016, e = 0"),
        (0.2, Line::Dashed(5.0), "e = 0.2"),
        (0.4, Line::Dashed(2.0), "e = 0.4"),
    ] {
        let points = along(&x, &|lambda| c_squared(lambda, plastic_c_squared(exponent)));
        series.push(Series { line: Some(line), ..Series::solid(name, INK, points) });
    }
    let nu = contacts.first().map_or(0.3, |contact| contact.poissons_ratio);
    series.extend(published(nu, |v| v.c_squared));
    series.extend(ours(contacts, |v| v.c_squared));
    series.extend(reference(contacts, law, |v| v.c_squared));
    let greatest = extent(contacts.iter().map(|contact| contact.variables.c_squared)).1.max(1.43);
    let chart = Chart {
        title: "Size of the contact".into(),
        x,
        y: Axis::linear("c² = a² / (2 R h)", 0.0, 1.12 * greatest),
        series,
        bar: None,
    };
    let caption = "Contact area over that of a sphere cut at h: 1/2 for Hertz, where the surface sinks in, above 1 where material piles up. \
                   e as in Johnson's map; hollow marks are large contacts, a/R > 0.15.";
    Picture::draw("area", caption, sheet.chart(SIZE), |root| draw_chart(root, &chart))
}

/// A function of Lambda over the whole axis.
fn along(x: &Axis, curve: &dyn Fn(f64) -> f64) -> Vec<(f64, f64)> {
    let (low, high) = x.range;
    (0..=200).map(|i| low * (high / low).powf(f64::from(i) / 200.0)).map(|lambda| (lambda, curve(lambda))).collect()
}

/// The models without hardening, each over the range for which it was made.
fn published(nu: f64, value: impl Fn(&Variables) -> f64) -> Vec<Series> {
    let sphere = ElasticSphere { radius: 1.0, youngs_modulus: 1.0, poissons_ratio: nu };
    let yield_stress = 1.0 / STIFFNESS;
    let at = |h: f64, a: f64, force: f64| Variables {
        sigma_rep: yield_stress,
        lambda: johnson::lambda(&sphere, yield_stress, a),
        hardness: force / (PI * a * a * yield_stress),
        c_squared: a * a / (2.0 * h),
    };
    let interferences = |last: f64| (0..=120).map(move |i| last.powf(f64::from(i) / 120.0));
    let kogut_etsion = KogutEtsion { sphere, yield_stress };
    let jackson_green = JacksonGreen { sphere, yield_stress };
    let (first, second) = (1.0 / kogut_etsion.interference(1.0), 1.0 / jackson_green.interference(1.0));
    let points = |states: &mut dyn Iterator<Item = Variables>| states.map(|v| (v.lambda, value(&v))).collect::<Vec<_>>();
    let kogut_etsion = points(
        &mut interferences(110.0).map(|w| w * first).map(|h| at(h, kogut_etsion.contact_radius(h), kogut_etsion.force(h))),
    );
    let jackson_green = points(
        &mut interferences(1000.0)
            .map(|w| w * second)
            .map(|h| (h, jackson_green.contact_radius(h)))
            .filter(|(_, a)| *a <= 0.41)
            .map(|(h, a)| at(h, a, jackson_green.force(h))),
    );
    vec![
        Series::dashed("Kogut & Etsion 2002", TEAL, 5.0, kogut_etsion),
        Series::dashed("Jackson & Green 2005, E/σ_Y = 1000", VIOLET, 3.0, jackson_green),
    ]
}

/// Our cases, by hardening, large contacts hollow.
fn ours(contacts: &[NormalContact], value: impl Fn(&Variables) -> f64) -> Vec<Series> {
    let mut series = Vec::new();
    let mut from = f64::NEG_INFINITY;
    for (i, (to, name)) in HARDENING.into_iter().enumerate() {
        let (colour, mark) = look(i);
        let group = |large: bool| -> Vec<(f64, f64)> {
            let inside = contacts.iter().filter(|c| c.hardening_exponent > from && c.hardening_exponent <= to);
            let inside = inside.filter(|c| (c.relative_radius > LARGE) == large);
            inside.map(|c| (c.variables.lambda, value(&c.variables))).collect()
        };
        let (small, large) = (group(false), group(true));
        if !small.is_empty() || !large.is_empty() {
            series.push(Series::marks("", colour, Mark::Ring, large));
            series.push(Series { opacity: 0.85, ..Series::marks(name, colour, mark, small) });
        }
        from = to;
    }
    if contacts.iter().any(|contact| contact.relative_radius > LARGE) {
        series.push(Series::marks(format!("hollow: a/R > {LARGE}"), GREY, Mark::Ring, Vec::new()));
    }
    series
}

/// The law's own curve.
fn reference(contacts: &[NormalContact], law: Option<&Law>, value: impl Fn(&Variables) -> f64) -> Option<Series> {
    let law = law?;
    let reference = Reference::new(law, contacts.first()?.poissons_ratio, contacts.iter().map(|c| c.relative_indentation));
    let first = yield_lambda(reference.poissons_ratio());
    let points = reference.normal(value).into_iter().filter(|point| point.0 >= first).collect();
    Some(Series::solid(reference.label(), look(0).0, points))
}

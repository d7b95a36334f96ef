//! From the simulated depths to a table.

use std::path::Path;

use super::against::{Against, equivalent, indentation_at_first_yield};
use super::cases::case_of;
use super::checked::check_levels;
use super::level::{BACKBONE, Level, columns_of, level_of};
use super::measure::{Measured, MeasuredStudy, Missing, measured, unloading_radius};
use super::spline::{Spline, smooth};
use super::tabulated::{DepthErrors, FORMAT, Tabulated, VERSION, straight};
use crate::analytical::cattaneo_mindlin::{self, CattaneoMindlin};
use crate::analytical::{ElasticSphere, hertz};
use crate::case::{Case, Friction};
use crate::contact_law::KEPT;
use crate::contact_law::path::drive;
use crate::contact_law::{Centres, POINTS, measured_slope};
use crate::law::LawError;
use crate::law::range::Interval;
use crate::output::SLIP_DISPLACEMENT_RATIO;

/// Least depth of one body that is simulated, unless the greatest is less than ten times as deep.
/// Half and twice of this and of the numbers below (of a ratio or a number of times, of what is
/// over 1): `benches/constants`.
const SHALLOWEST: f64 = 2e-5;
/// Where an elastic contact is one on a half-space still.
const HALF_SPACE: f64 = 1e-3;
/// The shallowest depth is at most this share of the greatest.
const SPAN: f64 = 0.1;
/// Greatest ratio of one depth to the next; the depths between are simulated to check it, and then
/// serve the table too.
const RATIO: f64 = 2.2;
/// Fewest depths without those between.
const FEWEST: usize = 5;
/// The curves of the shear end at so many times the displacement at which F_T/F_N is 0.99 mu.
pub(super) const LENGTH: f64 = 2.0;
/// F_T/F_N there over mu.
pub(super) const NEARLY_SLIPPING: f64 = SLIP_DISPLACEMENT_RATIO;
/// A depth nearer than this share of its size to first yield needs no Hertz contact below it.
const NEAR: f64 = 1.3;

/// Elements along the contact radius of an oblique press over those of the other cases: its F_T
/// has more to go to the limit of fine meshes than that of a shear. On 5 elements c is up to 51 %
/// off, on 8 up to 9 % (benches/law/element.md, "c of an oblique press").
const OBLIQUE_FINER: f64 = 1.6;
/// The shallower press is deeper than so many times the depth at first yield.
const YIELDS: f64 = 4.0;
/// Depths of the oblique presses over the greatest; each tells of those down to its fourth part.
const OBLIQUE_DEPTHS: [f64; 2] = [0.125, 1.0];

/// A table and what it was made from.
#[derive(Clone, Debug, PartialEq)]
pub struct Built {
    /// The table.
    pub table: Tabulated,
    /// That of every other depth, which was checked.
    pub coarse: Tabulated,
    /// The simulated depths.
    pub(in crate::law) measured: Vec<Measured>,
    /// Depths that were not reached.
    pub missing: Vec<Missing>,
}

/// The depths, over R, that a table up to the depth of `case` needs: every other one, the first and
/// the last among them, makes it, and those between check it.
///
/// # Errors
/// [`LawError::NotCovered`] for a case that presses into nothing, or next to nothing, or sticks; a
/// hardening law that is none.
pub fn depths(case: &Case) -> Result<Vec<f64>, LawError> {
    if case.contact.friction == Friction::Stick {
        return Err(LawError::NotCovered {
            problem: "the case has friction = \"stick\", and the law describes slip",
            remedy: "Give contact.friction a number",
        });
    }
    let radius = case.sphere.radius;
    let deepest = case.greatest_indentation() / radius;
    if SPAN * deepest * radius < case.least_indentation() {
        return Err(LawError::NotCovered {
            problem: "the path presses less than ten times as deep as the shallowest contact that is meshed for",
            remedy: "Press deeper: what is shallower is Hertz's contact",
        });
    }
    // The limits are those of a sphere on a plane, in which R is R*.
    let [shallowest, half_space] = [SHALLOWEST, HALF_SPACE].map(|h| h * radius / case.effective_radius());
    let yielding = indentation_at_first_yield(case)?.map_or(half_space, |h| h / radius);
    let first = yielding.clamp(shallowest, half_space).min(SPAN * deepest);
    let count = (((deepest / first).ln() / RATIO.ln()).ceil() as usize + 1).max(FEWEST);
    let last = 2 * count - 2;
    Ok((0..=last).map(|i| first * (deepest / first).powf(i as f64 / last as f64)).collect())
}

/// h and delta_T, over R, of the oblique presses up to `deepest` that tell how the contact yields
/// under F_T. None where nothing slips or yields.
fn oblique_presses(case: &Case, deepest: f64) -> Vec<[f64; 2]> {
    let Friction::Coefficient(mu) = case.contact.friction else { return Vec::new() };
    match indentation_at_first_yield(case) {
        Ok(Some(first)) if mu > 0.0 => OBLIQUE_DEPTHS
            .map(|share| share * deepest)
            .into_iter()
            .filter(|&h| h == deepest || h * case.sphere.radius > YIELDS * first)
            .map(|h| [h, measured_slope(mu) * h])
            .collect(),
        _ => Vec::new(),
    }
}

/// The study that [`build`] makes a table of, as a study file: [`case_of`] with the depths, over R,
/// as its list, and at its end oblique presses up to the last of them, on finer meshes.
pub fn study_text(case: &Case, elements: usize, depths: &[f64]) -> String {
    let radius = case.sphere.radius;
    let base = toml::Value::String(String::new());
    let base = toml::Table::try_from(case_of(case, elements)).map_or(base, toml::Value::Table);
    let one = |key: &str, value: toml::Value| toml::Value::Table([(key.to_owned(), value)].into_iter().collect());
    let mut list: Vec<toml::Value> = depths.iter().map(|h| one("path.0.indentation", toml::Value::Float(h * radius))).collect();
    let elements = (OBLIQUE_FINER * elements as f64).ceil() as i64;
    for [h, shear] in depths.last().map_or_else(Vec::new, |&deepest| oblique_presses(case, deepest)) {
        let both = [("indentation", h * radius), ("shear", shear * radius)];
        let both = both.into_iter().map(|(key, value)| (key.to_owned(), toml::Value::Float(value))).collect();
        let table = [
            ("path".to_owned(), toml::Value::Array(vec![toml::Value::Table(both)])),
            ("mesh.elements_per_contact_radius".to_owned(), toml::Value::Integer(elements)),
            ("mesh.surface_elements_per_contact_radius".to_owned(), toml::Value::Integer(2 * elements)),
        ];
        list.push(toml::Value::Table(table.into_iter().collect()));
    }
    let mut study = toml::Table::new();
    study.insert("base".to_owned(), base);
    study.insert("list".to_owned(), toml::Value::Array(list));
    study.to_string()
}

/// Makes the table of the study in `dir`, which has the depths of [`depths`] for `case`.
///
/// # Errors
/// Results that cannot be read; [`LawError::TooFewDepths`].
pub fn build(dir: &Path, case: &Case, elements: usize) -> Result<Built, LawError> {
    let wanted = depths(case)?;
    let MeasuredStudy { depths: all, yielding, missing } = measured(dir)?;
    let is = |h: f64, wanted: f64| (h / wanted - 1.0).abs() < 1e-6;
    let all: Vec<Measured> = all.into_iter().filter(|one| wanted.iter().any(|&h| is(one.h, h))).collect();
    let even: Vec<Measured> = all.iter().filter(|one| wanted.iter().step_by(2).any(|&h| is(one.h, h))).cloned().collect();
    if even.len() < 4 {
        let reason = missing.first().map_or_else(String::new, |Missing { id, reason }| format!("; {id} ended with: {reason}"));
        return Err(LawError::TooFewDepths { path: dir.to_owned(), done: all.len(), of: wanted.len(), reason });
    }
    let mut coarse = table(case, &even, elements)?;
    for one in all.iter().filter(|one| one.h < coarse.range.to && !even.contains(one)) {
        coarse.errors.push(errors(&coarse, one)?);
    }
    let mut table = table(case, &all, elements)?;
    table.errors.clone_from(&coarse.errors);
    // Where the deep press did not end, the shallow one says nothing of most depths.
    let deepest = table.levels.last().map_or(0.0, |level| level.h).ln();
    if yielding.last().is_some_and(|[at, _]| *at > deepest - std::f64::consts::LN_2) {
        for level in &mut table.levels {
            level.yield_coefficient = straight(&yielding, level.h.ln());
        }
    }
    Ok(Built { table, coarse, measured: all, missing })
}

impl Tabulated {
    /// The table of levels that come from elsewhere than from simulated depths of `case`.
    ///
    /// # Errors
    /// A hardening law whose numbers make no law; [`LawError::NoTable`] for levels that are none.
    pub(in crate::law) fn interpolated(case: &Case, levels: Vec<Level>, elements: usize) -> Result<Self, LawError> {
        of_levels(case.scaled().0, levels, elements)
    }

    /// The table of two bodies that are alike as that of an equal pair, which `case` is of.
    pub(in crate::law) fn of_an_equal_pair(self, case: &Case) -> Self {
        let case = case_of(&case.scaled().0, self.elements_per_contact_radius);
        Self { body: Against::of(&case), frame: Centres::of(&case).frame(), case: case.to_toml(), ..self }
    }
}

pub(super) fn table(case: &Case, depths: &[Measured], elements: usize) -> Result<Tabulated, LawError> {
    let scaled = case_of(&case.scaled().0, elements);
    let sphere = equivalent(&scaled);
    let mut levels: Vec<Level> = depths.iter().map(|one| level(&sphere, friction_of(&scaled), one)).collect();
    smoothed(&mut levels);
    of_levels(scaled, levels, elements)
}

/// The table of a case in units of R and E, from its levels.
pub(super) fn of_levels(scaled: Case, mut levels: Vec<Level>, elements: usize) -> Result<Tabulated, LawError> {
    let scaled = case_of(&scaled, elements);
    if let Some(yielding) = indentation_at_first_yield(&scaled)?.filter(|&h| NEAR * h < levels[0].h) {
        levels.insert(0, hertzian(&equivalent(&scaled), friction_of(&scaled), yielding));
    }
    check_levels(&levels).map_err(|problem| LawError::NoTable { problem })?;
    let (from, to) = (levels[0].h, levels[levels.len() - 1].h);
    Ok(Tabulated {
        format: FORMAT.to_owned(),
        version: VERSION,
        body: Against::of(&scaled),
        frame: Centres::of(&scaled).frame(),
        program: format!("asperity {}", env!("CARGO_PKG_VERSION")),
        case: scaled.to_toml(),
        range: Interval { from, to },
        elements_per_contact_radius: elements,
        levels,
        errors: Vec::new(),
    })
}

fn friction_of(case: &Case) -> f64 {
    match case.contact.friction {
        Friction::Coefficient(mu) => mu,
        Friction::Stick => f64::NAN,
    }
}

/// Takes the ripple of the mesh out of the levels.
fn smoothed(levels: &mut [Level]) {
    let x: Vec<f64> = levels.iter().map(|level| level.h.ln()).collect();
    let rows: Vec<Vec<f64>> = levels.iter().map(columns_of).collect();
    let columns: Vec<Vec<f64>> = (0..rows[0].len()).map(|c| rows.iter().map(|row| row[c]).collect()).collect();
    let smooth = smooth(&x, &columns);
    for (i, level) in levels.iter_mut().enumerate() {
        *level = level_of(level.h, &smooth.iter().map(|column| column[i]).collect::<Vec<f64>>());
    }
}

/// x at the points of the shapes.
pub(super) fn points() -> impl Iterator<Item = f64> {
    (1..=POINTS).map(|j| (j as f64 / POINTS as f64).powi(2))
}

/// The level of a simulated depth.
fn level(sphere: &ElasticSphere, friction: f64, one: &Measured) -> Level {
    let points_of_curve = one.curve.len();
    if friction <= 0.0 || points_of_curve < 4 {
        let elastic = hertzian(sphere, friction, one.h);
        let mindlin = cattaneo_mindlin::initial_stiffness(sphere, one.a0);
        let delta_t_end = 1.5 * friction.max(1e-6) * one.f_n0 / mindlin * LENGTH * NEARLY_MINDLIN;
        let unloading_radius = unloading_radius(sphere, one);
        return Level { f_n0: one.f_n0, a0: one.a0, delta_t_end, unloading_radius, k_t: mindlin, ..elastic };
    }
    let slipping = one.curve.iter().position(|point| point.f_t >= NEARLY_SLIPPING * friction * point.f_n);
    let at_99 = match slipping {
        Some(i) if i > 0 => {
            let ratio = |i: usize| one.curve[i].f_t / (friction * one.curve[i].f_n);
            let (before, after) = (ratio(i - 1), ratio(i));
            let (from, to) = (one.curve[i - 1].delta_t, one.curve[i].delta_t);
            from + (to - from) * (NEARLY_SLIPPING - before) / (after - before)
        }
        _ => one.curve[points_of_curve - 1].delta_t / LENGTH,
    };
    let end = LENGTH * at_99;
    // Over the square root of delta_T the points of the curve are about even.
    let root: Vec<f64> = one.curve.iter().map(|point| point.delta_t.sqrt()).collect();
    let last = one.curve[points_of_curve - 1];
    let curve = |value: fn(&crate::law::data::ShearPoint) -> f64| {
        let spline = Spline::through(&root, &one.curve.iter().map(value).collect::<Vec<f64>>());
        move |x: f64| if x * end >= last.delta_t { value(&last) } else { spline.at((x * end).sqrt()) }
    };
    let (f_t, f_n) = (curve(|point| point.f_t), curve(|point| point.f_n));
    let (f_n_slip, lost) = (f_n(1.0).min(one.f_n0), one.f_n0 - f_n(1.0));
    // Of a loss within the tolerance of a step there is no shape.
    let shape = |x: f64| if lost > 1e-3 * one.f_n0 { ((one.f_n0 - f_n(x)) / lost).clamp(0.0, 1.0) } else { x };
    let [k_t, backbone] = if lost > ELASTIC * one.f_n0 {
        reversal(sphere, friction, one)
    } else {
        // An elastic contact follows its sliders from the start, and Masing's rule later.
        let curve = one.curve.iter().skip(1).map(|point| [point.delta_t, point.f_t]);
        backbone_of(curve, friction * one.f_n0, cattaneo_mindlin::initial_stiffness(sphere, one.a0))
    };
    Level {
        h: one.h,
        f_n0: one.f_n0,
        a0: one.a0,
        slip_share: f_n_slip / one.f_n0,
        delta_t_end: end,
        unloading_radius: unloading_radius(sphere, one),
        k_t,
        backbone,
        yield_coefficient: None,
        tangential: points().map(|x| f_t(x) / (friction * f_n_slip)).collect(),
        normal: points().map(shape).collect(),
    }
}

/// k_T and the exponent b with which F_T = F - 2 F_s [1 - (1 - k_T delta/(2 b F_s))^b], Masing's
/// rule, is nearest to the simulated reversal, F and F_s = mu F_N being those where it begins.
pub fn reversal(sphere: &ElasticSphere, friction: f64, one: &Measured) -> [f64; 2] {
    let mindlin = cattaneo_mindlin::initial_stiffness(sphere, one.a0);
    let Some(start) = one.back.first().filter(|_| one.back.len() > 4) else { return [mindlin, 1.5] };
    let falls = one.back.iter().skip(1).map(|point| [start.delta_t - point.delta_t, start.f_t - point.f_t]);
    let [k_t, backbone] = backbone_of(falls, 2.0 * friction * start.f_n, mindlin);
    // A first reversal also loses what F_N shear has left to lose: more so where it has lost much.
    let again = AGAIN * (start.f_n / one.f_n0 / KEPT).min(1.0);
    [k_t, 1.0 + again * (backbone - 1.0)]
}

/// k and b with which way [1 - (1 - k delta/(b way))^b] is nearest to a curve of (delta, F), whose
/// k is near `stiffness`, up to most of the way.
pub fn backbone_of(curve: impl Iterator<Item = [f64; 2]>, way: f64, stiffness: f64) -> [f64; 2] {
    // Beyond, what it loses of F_N shows.
    let rows: Vec<[f64; 2]> = curve.take_while(|row| row[1] < MOST_OF_THE_WAY * way).collect();
    let misfit = |k: f64, b: f64| -> f64 {
        let force = |d: f64| way * (1.0 - (1.0 - (k * d / (b * way)).min(1.0)).powf(b));
        rows.iter().map(|row| (force(row[0]) - row[1]).powi(2)).sum()
    };
    let mut best = [f64::INFINITY, stiffness, 1.5];
    for i in 0..=40 {
        let b = BACKBONE[0] + (1.5 - BACKBONE[0]) * f64::from(i) / 40.0;
        for j in 0..=120 {
            let k = stiffness * (0.4 + 0.01 * f64::from(j));
            let found = misfit(k, b);
            if found < best[0] {
                best = [found, k, b];
            }
        }
    }
    [best[1], best[2]]
}

/// Share of the exponent's excess over 1 that a reversal has which is not the first: then it turns
/// more sharply. Between that of the first and those after it, which a contact that goes to and fro
/// has. Half and twice of it: `benches/constants`.
const AGAIN: f64 = 0.65;
/// Share of F_N0 below which a loss is none: the update takes such a contact for elastic.
const ELASTIC: f64 = 1e-6;
/// Share of the way to slip up to which a reversal is fitted. Half and twice of what is missing of
/// it: `benches/constants`.
const MOST_OF_THE_WAY: f64 = 0.95;

/// Share of Mindlin's slip displacement at which F_T/F_N is 0.99 mu: (1 - y)^(3/2) = 0.01.
const NEARLY_MINDLIN: f64 = 0.953_584_1;

/// The level of an elastic contact on a half-space, Hertz's sheared as Cattaneo and Mindlin have
/// it.
pub(super) fn hertzian(sphere: &ElasticSphere, friction: f64, h: f64) -> Level {
    // Without friction there is no displacement at full slip, and none is asked for.
    let contact = CattaneoMindlin::at_indentation(*sphere, friction.max(1e-6), h);
    let end = LENGTH * NEARLY_MINDLIN * contact.slip_displacement();
    let share = |x: f64| contact.force(x * end) / (contact.friction * contact.normal_force);
    Level {
        h,
        f_n0: hertz::force(sphere, h),
        a0: contact.contact_radius,
        slip_share: 1.0,
        delta_t_end: end,
        unloading_radius: contact.contact_radius,
        k_t: cattaneo_mindlin::initial_stiffness(sphere, contact.contact_radius),
        backbone: 1.5,
        yield_coefficient: None,
        tangential: points().map(share).collect(),
        normal: points().collect(),
    }
}

/// What a table says of a depth, against its simulation.
fn errors(table: &Tabulated, one: &Measured) -> Result<DepthErrors, LawError> {
    let parameters = table.contact_parameters(1.0, 1.0)?;
    let virgin = parameters.virgin(one.h).point;
    let mut places = vec![[one.h, 0.0]];
    places.extend(one.curve.iter().map(|point| [one.h, point.delta_t]));
    let forces = &drive(&parameters, &places, 4)[1..];
    let peak = one.peak();
    let mut sums = [0.0f64; 2];
    let mut most = [0.0f64; 2];
    for (ours, point) in forces.iter().zip(&one.curve) {
        let errors = [if peak > 0.0 { (ours[1] - point.f_t).abs() / peak } else { 0.0 }, (ours[0] - point.f_n).abs() / one.f_n0];
        for i in 0..2 {
            sums[i] += errors[i] * errors[i];
            most[i] = most[i].max(errors[i]);
        }
    }
    let rms = sums.map(|sum| (sum / one.curve.len() as f64).sqrt());
    Ok(DepthErrors {
        h: one.h,
        f_n0: virgin.f_n0 / one.f_n0 - 1.0,
        a0: virgin.a / one.a0 - 1.0,
        f_t_rms: rms[0],
        f_t_max: most[0],
        f_n_rms: rms[1],
        f_n_max: most[1],
    })
}

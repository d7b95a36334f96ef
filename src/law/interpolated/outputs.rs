//! What the interpolation tells of a contact: six numbers and the two curves of its shear, in
//! units in which they change little from contact to contact.

use crate::analytical::{ElasticSphere, cattaneo_mindlin, hertz};
use crate::contact_law::POINTS;
use crate::law::data::ShearPoint;
use crate::law::table::spline::Spline;
use crate::law::table::{Against, Level, Measured, backbone_of, cleaned, reversal, unloading_radius};
use crate::output::SLIP_DISPLACEMENT_RATIO;

/// Number of outputs that are no curves.
pub const NUMBERS: usize = 6;
/// Their names in files.
pub const NAMES: [&str; NUMBERS] = ["F_N0", "a0", "delta_T", "unloading radius", "k_T", "backbone"];

/// Place of the unloading radius among the numbers, and the first of those of a reversal.
const UNLOADING: usize = 3;
const REVERSAL: usize = 4;

/// The curves end where the square root of delta_T over the length of the slip is this: full slip
/// is reached from 0.9 to 1.75.
const END: f64 = 1.75;
/// F_T/F_N over mu from which a contact with a plane has come to full slip,
const SLIPPED: f64 = SLIP_DISPLACEMENT_RATIO;
/// and one of two spheres: elastic ones whose points all slide have up to 3 % less at mu above 0.6,
/// since not all of them slide in one direction.
const SLIPPED_PAIR: f64 = 0.95;
/// What it may fall from there to the end: the ratio passes a peak where a contact has slipped.
const FALL: f64 = 0.01;
/// Share of F_N0 below which the loss of a whole shear is that of an elastic contact, none.
const NOTHING: f64 = 5e-3;
/// Intervals of the integral that gives the length of the slip.
const INTERVALS: usize = 400;
/// Cattaneo and Mindlin's displacement at full slip is 5/2 of that integral; three keep the curves
/// of plastic contacts, whose slip is more gradual, within END.
const LENGTH: f64 = 3.0;

/// The outputs of one contact.
#[derive(Clone, Debug, PartialEq)]
pub struct Outputs {
    /// Logarithms of F_N0, a0, the length of the slip, the unloading radius and k_T over those of
    /// the elastic contact at the same h; the backbone's exponent.
    pub numbers: [f64; NUMBERS],
    /// F_T/F_N over mu, at points that are even over the square root of delta_T.
    pub ratio: [f64; POINTS],
    /// F_N/F_N0 there.
    pub normal: [f64; POINTS],
}

/// What the elastic contact at the indentation `h` has: F_N, a, and the stiffness of a shear.
fn elastic(sphere: &ElasticSphere, h: f64) -> [f64; 3] {
    let a = (sphere.radius * h).sqrt();
    [hertz::force(sphere, h), a, cattaneo_mindlin::initial_stiffness(sphere, a)]
}

/// The outputs of a simulated contact; `None` if it was not sheared to full slip.
pub fn outputs(sphere: &ElasticSphere, friction: f64, one: &Measured, body: Against) -> Option<Outputs> {
    let last = one.curve.last()?;
    let slip = |point: &ShearPoint| if point.delta_t > 0.0 { (point.f_t / (friction * point.f_n)).min(1.0) } else { 0.0 };
    let slipped = if body == Against::Plane { SLIPPED } else { SLIPPED_PAIR };
    let most = one.curve.iter().map(slip).fold(0.0, f64::max);
    if one.curve.len() < 5 || most < slipped || slip(last) < slipped - FALL {
        return None;
    }
    // Over the square root of delta_T the points of the curve are about even.
    let root: Vec<f64> = one.curve.iter().map(|point| point.delta_t.sqrt()).collect();
    let spline = |of: &dyn Fn(&ShearPoint) -> f64| Spline::through(&root, &one.curve.iter().map(of).collect::<Vec<f64>>());
    let (ratio, normal) = (spline(&slip), spline(&|point| point.f_n / one.f_n0));
    let end = root[root.len() - 1];
    let integral: f64 = (0..INTERVALS)
        .map(|i| {
            let at = end * (i as f64 + 0.5) / INTERVALS as f64;
            (1.0 - ratio.at(at)).max(0.0) * 2.0 * at * end / INTERVALS as f64
        })
        .sum();
    let length = LENGTH * integral;
    let [f_n, a, stiffness] = elastic(sphere, one.h);
    let [k_t, backbone] = reversal(sphere, friction, one);
    let places = std::array::from_fn::<f64, POINTS, _>(|j| (END * (j + 1) as f64 / POINTS as f64 * length.sqrt()).min(end));
    let numbers = [
        (one.f_n0 / f_n).ln(),
        (one.a0 / a).ln(),
        (length * stiffness / (friction * one.f_n0)).ln(),
        (unloading_radius(sphere, one) / a).ln(),
        (k_t / stiffness).ln(),
        backbone,
    ];
    let outputs = Outputs {
        numbers,
        ratio: places.map(|at| ratio.at(at).clamp(0.0, 1.0)),
        normal: places.map(|at| normal.at(at).clamp(0.0, 1.0)),
    };
    outputs.numbers.iter().all(|x| x.is_finite()).then_some(outputs)
}

impl Outputs {
    /// Takes the stiffness and the exponent of a reversal from another contact.
    pub fn reverse_as(&mut self, other: &Self) {
        self.numbers[REVERSAL..].copy_from_slice(&other.numbers[REVERSAL..]);
    }

    /// Takes the stiffness of an unloading from another contact.
    pub fn unload_as(&mut self, other: &Self) {
        self.numbers[UNLOADING] = other.numbers[UNLOADING];
    }

    /// The level of a table that has these at the indentation `h`. Where a shear takes none of F_N
    /// (it is known to, `keeps`, or next to none is predicted) the update follows the sliders from
    /// the start; so they are those of the first shear.
    pub fn level(&self, sphere: &ElasticSphere, friction: f64, h: f64, keeps: bool) -> Level {
        let [f_n, a, stiffness] = elastic(sphere, h);
        let [f_n0, a0, length, unloading, k_t, backbone] = self.numbers;
        let f_n0 = f_n * f_n0.exp();
        // Without friction there is no displacement at full slip, and none is asked for.
        let slip_force = friction.max(1e-6) * f_n0;
        let length = length.exp() * slip_force / stiffness;
        // F_N falls.
        let mut kept = 1.0f64;
        let mut normal = self.normal.map(|share| {
            kept = share.clamp(0.01, kept);
            kept
        });
        let [mut k_t, mut backbone] = [stiffness * k_t.exp(), backbone];
        if keeps || kept > 1.0 - NOTHING {
            (kept, normal) = (1.0, [1.0; POINTS]);
            let at = |j: usize| (END * (j + 1) as f64 / POINTS as f64).powi(2) * length;
            let curve = self.ratio.iter().enumerate().map(|(j, ratio)| [at(j), ratio.clamp(0.0, 1.0) * slip_force]);
            [k_t, backbone] = backbone_of(curve, slip_force, stiffness);
        }
        cleaned(Level {
            h,
            f_n0,
            a0: a * a0.exp(),
            slip_share: kept,
            delta_t_end: END * END * length,
            unloading_radius: a * unloading.exp(),
            k_t,
            backbone,
            yield_coefficient: None,
            tangential: self.ratio.iter().zip(&normal).map(|(ratio, share)| ratio.clamp(0.0, 1.0) * share / kept).collect(),
            normal: normal.iter().map(|share| if kept < 1.0 { (1.0 - share) / (1.0 - kept) } else { 0.0 }).collect(),
        })
    }
}

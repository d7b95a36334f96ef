//! The material point: return mapping, tangent, volumetric half, energies, for every hardening law.

use crate::compute::gpu::layout::{ANSWER, RELATIVE, STATE, TANGENT};
use crate::compute::gpu::material::{Answers, PointStatus, return_mapping};
use crate::compute::gpu::{DeviceReal, GpuContext};
use crate::material::{self, Elasticity, FlowStress, Material, PointError, PointState, j2};
use crate::random::Seeded;
use crate::real::Real;
use std::sync::Arc;

/// Who maps the points: arrays are `[case][component][point]`.
pub trait PointBackend<R> {
    /// Answers of all points.
    fn map(&self, materials: &[Material<R>], points: usize, relative: &[R], committed: &[R]) -> Answers<R>;
}

/// The CPU.
pub struct CpuPoints;
/// A device.
pub struct GpuPoints(pub Arc<GpuContext>);

/// How far from the reference a backend may be.
pub struct Bounds {
    /// Largest difference, relative to the quantity's own scale.
    agreement: f64,
    /// Largest relative violation of the yield condition and of det b_e_bar = 1.
    equations: f64,
}

impl Bounds {
    /// For a backend in f64.
    pub const F64: Self = Self { agreement: 1e-13, equations: 1e-13 };
    /// For one in f32.
    pub const F32: Self = Self { agreement: 1e-5, equations: 1e-5 };
}

impl<R: DeviceReal> PointBackend<R> for GpuPoints {
    fn map(&self, materials: &[Material<R>], points: usize, relative: &[R], committed: &[R]) -> Answers<R> {
        return_mapping(&self.0, materials, points, relative, committed).unwrap()
    }
}

impl<R: Real> PointBackend<R> for CpuPoints {
    fn map(&self, materials: &[Material<R>], points: usize, relative: &[R], committed: &[R]) -> Answers<R> {
        let cases = materials.len();
        let mut all = Answers {
            answer: vec![R::ZERO; cases * ANSWER * points],
            tangent: vec![R::ZERO; cases * TANGENT * points],
            status: Vec::new(),
        };
        for (case, material) in materials.iter().enumerate() {
            for point in 0..points {
                let d = gather::<R, RELATIVE>(relative, case, point, points);
                let d = [[d[0], d[1], d[2]], [d[3], d[4], d[5]], [d[6], d[7], d[8]]];
                let [b0, b1, b2, b3, b4, b5, alpha] = gather::<R, STATE>(committed, case, point, points);
                let state = PointState { be: [b0, b1, b2, b3, b4, b5], alpha };
                let r = match material::return_mapping(material, &d, &state) {
                    Ok(r) => r,
                    Err(PointError::Inverted { .. }) => {
                        all.status.push(PointStatus::Inverted);
                        continue;
                    }
                    Err(PointError::NotFinite) => {
                        all.status.push(PointStatus::NotFinite);
                        continue;
                    }
                };
                all.status.push(if r.yielding { PointStatus::Yielding } else { PointStatus::Elastic });
                let j = j2::determinant_minus_one(&d);
                let e = &material.elasticity;
                let (u1, u2) = material::pressure(e, j);
                let mut row: Vec<R> = Vec::with_capacity(ANSWER);
                row.extend(r.stress);
                row.extend(r.state.be);
                row.extend([r.state.alpha, r.mu_bar, r.norm]);
                row.extend(r.normal);
                row.extend([r.beta_1, r.beta_3, r.beta_4, r.delta_gamma, r.plastic_work, u1, u2]);
                row.push(material::elastic_energy_volumetric(e, j));
                row.push(material::elastic_energy_deviatoric(e, &r.state.be));
                for (k, value) in row.into_iter().enumerate() {
                    all.answer[(case * ANSWER + k) * points + point] = value;
                }
                for (k, value) in material::deviatoric_tangent(&r).iter().flatten().enumerate() {
                    all.tangent[(case * TANGENT + k) * points + point] = *value;
                }
            }
        }
        all
    }
}

fn gather<R: Real, const N: usize>(data: &[R], case: usize, point: usize, points: usize) -> [R; N] {
    std::array::from_fn(|k| data[(case * N + k) * points + point])
}

/// One material of every law (E = 1), soft enough for strains of a percent to be plastic, and their
/// hard extremes.
fn materials<R: Real>() -> Vec<Material<R>> {
    let laws = [
        Ok(FlowStress::Elastic),
        FlowStress::ideal(2e-3),
        FlowStress::linear(2e-3, 0.05),
        FlowStress::linear(2e-3, 0.0),
        FlowStress::power(2e-3, 0.01, 0.3),
        FlowStress::power(2e-3, 0.01, 1.0),
        FlowStress::power(2e-3, 0.05, 0.05),
        FlowStress::power(2e-3, 0.0, 0.5),
        FlowStress::hollomon(0.01, 5.0, 1.0),
        FlowStress::hollomon(0.02, 1.6, 1.0),
        FlowStress::voce(2e-3, 6e-3, 20.0),
        FlowStress::voce(2e-3, 2e-3, 5.0),
        FlowStress::table(&[[0.0, 2e-3], [0.01, 3e-3], [0.03, 3.5e-3], [0.2, 5e-3]]),
        FlowStress::table(&[[0.0, 1e-3]]),
    ];
    let ratio = |i: usize| [0.3, 0.0, 0.45, 0.49][i % 4];
    let elastic = laws.into_iter().enumerate();
    elastic.map(|(i, law)| Material { elasticity: Elasticity::new(1.0, ratio(i)), hardening: law.unwrap() }).collect()
}

/// Size of the relative displacement gradient of a kind of point.
const KINDS: [(&str, f64, f64); 5] = [
    ("near zero", -12.0, -7.0),
    ("elastic", -6.0, -3.5),
    ("yielding", -3.0, -1.5),
    ("reversal", -3.0, -1.5),
    ("large", -1.0, -0.3),
];
const POINTS: usize = 60;

fn random_gradient(rng: &mut Seeded, low: f64, high: f64) -> [f64; 9] {
    let size = 10f64.powf(rng.between(low, high));
    let d: [f64; 9] = std::array::from_fn(|_| size * rng.between(-0.7, 0.7));
    d
}

/// Inputs for `materials`, rounded to R: the committed state of a kind is what a first random step
/// left, in f64.
fn inputs<R: Real>(materials: &[Material<f64>], seed: u64) -> (Vec<R>, Vec<R>) {
    let mut rng = Seeded::new(seed);
    let cases = materials.len();
    let mut relative = vec![R::ZERO; cases * RELATIVE * POINTS];
    let mut committed = vec![R::ZERO; cases * STATE * POINTS];
    for (case, material) in materials.iter().enumerate() {
        for point in 0..POINTS {
            let (kind, low, high) = KINDS[point % KINDS.len()];
            let (mut state, mut d) = (PointState::default(), random_gradient(&mut rng, low, high));
            if point % 2 == 1 || kind == "reversal" {
                let first = random_gradient(&mut rng, -4.0, -1.5);
                let [a, b, c] = [0, 3, 6].map(|i| [first[i], first[i + 1], first[i + 2]]);
                state = material::return_mapping(material, &[a, b, c], &state).unwrap().state;
                if kind == "reversal" {
                    d = first.map(|x| -1.5 * x);
                }
            }
            for (k, value) in d.into_iter().enumerate() {
                relative[(case * RELATIVE + k) * POINTS + point] = R::of(value);
            }
            for (k, value) in state.be.into_iter().chain([state.alpha]).enumerate() {
                committed[(case * STATE + k) * POINTS + point] = R::of(value);
            }
        }
    }
    (relative, committed)
}

fn widen<R: Real>(data: &[R]) -> Vec<f64> {
    data.iter().map(|x| x.to_f64()).collect()
}

/// The scale on which each component of an answer is judged: what its rounding errors are
/// proportional to.
fn scales(answer: &[f64; ANSWER], d: &[f64; RELATIVE], material: &Material<f64>) -> [f64; ANSWER] {
    let size = |values: &[f64]| values.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    let be = size(&answer[6..12]).max(size(d)).max(f64::MIN_POSITIVE);
    let (alpha, mu_bar, norm, delta_gamma) = (answer[12], answer[13], answer[14], answer[24]);
    let (mu, kappa) = (material.elasticity.shear, material.elasticity.bulk);
    let flow = material.hardening.flow_stress(alpha);
    // the deviator is what is left of b_e_bar - I, and the increment what is left of the trial
    // stress
    let direction = mu * be / norm.max(mu * 1e-3 * be);
    let increment = delta_gamma + norm / mu_bar;
    let mut scale = [1.0; ANSWER];
    scale[..6].fill(mu * be);
    scale[6..12].fill(be);
    scale[12] = alpha + increment;
    scale[13] = mu_bar;
    scale[14] = mu * be;
    scale[15..24].fill(direction);
    scale[24] = increment * direction;
    scale[25] = if flow.is_finite() { flow * (alpha + increment) * direction } else { 1.0 };
    scale[26] = kappa * size(d);
    scale[27] = kappa;
    scale[28] = kappa * size(d) * size(d);
    scale[29] = mu * be * be;
    scale
}

/// Agreement with the CPU in f64 on seeded random points of every law and kind.
pub fn agrees_with_the_reference<R: Real, B: PointBackend<R>>(backend: &B, bounds: &Bounds) {
    let reference_materials = materials::<f64>();
    let (relative, committed) = inputs::<R>(&reference_materials, 5);
    let ours = backend.map(&materials::<R>(), POINTS, &relative, &committed);
    let reference = CpuPoints.map(&reference_materials, POINTS, &widen(&relative), &widen(&committed));
    let (answer, tangent) = (widen(&ours.answer), widen(&ours.tangent));
    let (mut worst, mut yielding) = ((0.0, String::new()), 0);
    for (case, material) in reference_materials.iter().enumerate() {
        for point in 0..POINTS {
            let at = case * POINTS + point;
            let expected: [f64; ANSWER] = gather(&reference.answer, case, point, POINTS);
            let scale = scales(&expected, &gather(&widen(&relative), case, point, POINTS), material);
            let name = |k: String| format!("{k} of point {point} ({}), {:?}", KINDS[point % KINDS.len()].0, material.hardening);
            if ours.status[at] != reference.status[at] {
                // only a point on the yield surface may fall to either side of it
                let beta_1 = expected[21];
                assert!(beta_1 / scale[21] < bounds.agreement, "{}: {beta_1}", name(format!("status {:?}", ours.status[at])));
                continue;
            }
            yielding += usize::from(reference.status[at] == PointStatus::Yielding);
            let mut compare = |k: String, ours: f64, expected: f64, scale: f64| {
                let error = (ours - expected).abs() / scale;
                if !(error <= worst.0) {
                    worst = (error, name(format!("{k} = {ours:e}, not {expected:e}")));
                }
            };
            for k in 0..ANSWER {
                compare(format!("component {k}"), answer[(case * ANSWER + k) * POINTS + point], expected[k], scale[k]);
            }
            let tangent_scale = material.elasticity.shear * scale[15];
            for k in 0..TANGENT {
                let i = (case * TANGENT + k) * POINTS + point;
                compare(format!("tangent {k}"), tangent[i], reference.tangent[i], tangent_scale);
            }
        }
    }
    log::debug!("{}: worst {:.2e}, {}", R::NAME, worst.0, worst.1);
    assert!(yielding > reference.status.len() / 3, "only {yielding} points yield: the test tests nothing");
    assert!(worst.0 <= bounds.agreement, "{:e}: {}", worst.0, worst.1);
}

/// Every answer obeys the yield condition, plastic incompressibility, and the signs of
/// thermodynamics, by itself.
pub fn obeys_its_equations<R: Real, B: PointBackend<R>>(backend: &B, bounds: &Bounds) {
    let reference_materials = materials::<f64>();
    let (relative, committed) = inputs::<R>(&reference_materials, 6);
    let ours = backend.map(&materials::<R>(), POINTS, &relative, &committed);
    let answer = widen(&ours.answer);
    for (case, material) in reference_materials.iter().enumerate() {
        for point in 0..POINTS {
            let a: [f64; ANSWER] = gather(&answer, case, point, POINTS);
            let before: [f64; STATE] = gather(&widen(&committed), case, point, POINTS);
            let status = ours.status[case * POINTS + point];
            let place = format!("point {point} of {:?}: {status:?}", material.hardening);
            let [xx, yy, zz, xy, yz, zx] = [0, 1, 2, 3, 4, 5].map(|k| a[k]);
            let von_mises = (1.5 * (xx * xx + yy * yy + zz * zz + 2.0 * (xy * xy + yz * yz + zx * zx))).sqrt();
            let flow = material.hardening.flow_stress(a[12]);
            let overstress = von_mises / flow - 1.0;
            // sigma_Y + K alpha^n with a small n hardens visibly over strains that single precision
            // does not have
            let underflows = a[12] < 4.0 * R::MIN_POSITIVE.to_f64();
            match status {
                PointStatus::Yielding if underflows => assert!(matches!(material.hardening, FlowStress::Power { .. }), "{place}"),
                PointStatus::Yielding => {
                    assert!(overstress.abs() < bounds.equations, "{place}: overstress {overstress:e}");
                    assert!(a[12] > before[6] && a[24] > 0.0 && a[25] > 0.0, "{place}: {a:?}");
                }
                PointStatus::Elastic => {
                    assert!(overstress < bounds.equations, "{place}: overstress {overstress:e}");
                    assert!(a[12] == before[6] && a[24] == 0.0 && a[25] == 0.0, "{place}: {a:?}");
                }
                _ => panic!("{place}"),
            }
            assert!((xx + yy + zz).abs() <= bounds.equations * von_mises, "{place}: trace {:e}", xx + yy + zz);
            let be = |i: usize, k: usize| a[6 + [[0, 3, 5], [3, 1, 4], [5, 4, 2]][i][k]];
            let volume = j2::determinant_minus_one(&std::array::from_fn(|i| std::array::from_fn(|k| be(i, k))));
            let strain = a[6..12].iter().fold(0.0f64, |m, x| m.max(x.abs()));
            assert!(volume.abs() <= bounds.equations * strain, "{place}: det b_e_bar - 1 = {volume:e} at {strain:e}");
            assert!(a[28] >= 0.0 && a[29] >= 0.0, "{place}: energies {:?}", &a[28..]);
        }
    }
}

/// No deformation, no answer but zero; and points without an answer say so without touching their
/// neighbours.
pub fn reports_what_has_no_answer<R: Real, B: PointBackend<R>>(backend: &B, _: &Bounds) {
    use PointStatus::{Elastic, Inverted, NotFinite};
    let (nan, inf) = (f64::NAN, f64::INFINITY);
    let zero = [0.0; RELATIVE];
    let with = |i: usize, value: f64| {
        let mut d = zero;
        d[i] = value;
        d
    };
    let rows = [
        (zero, 0.0, Elastic),
        (with(0, -1.0), 0.0, Inverted),
        (with(0, -2.0), 0.0, Inverted),
        (zero, 0.0, Elastic),
        (with(4, -inf), 0.0, NotFinite),
        (with(3, nan), 0.0, NotFinite),
        (with(8, nan), 0.0, NotFinite),
        (zero, nan, NotFinite),
        (zero, 0.0, Elastic),
        ([1e200; RELATIVE], 0.0, NotFinite),
        (zero, 1e200, NotFinite),
    ];
    let points = rows.len();
    let materials = materials::<R>();
    let mut relative = vec![R::ZERO; materials.len() * RELATIVE * points];
    let mut committed = vec![R::ZERO; materials.len() * STATE * points];
    for case in 0..materials.len() {
        for (point, (d, be, _)) in rows.iter().enumerate() {
            for k in 0..RELATIVE {
                relative[(case * RELATIVE + k) * points + point] = R::of(d[k]);
            }
            committed[(case * STATE + 3) * points + point] = R::of(*be);
        }
    }
    let ours = backend.map(&materials, points, &relative, &committed);
    for (case, material) in materials.iter().enumerate() {
        for (point, (d, _, expected)) in rows.iter().enumerate() {
            let status = ours.status[case * points + point];
            let answered = matches!(status, Elastic | PointStatus::Yielding);
            let place = format!("{d:?}, {:?}: {status:?}", material.hardening);
            // what overflows may be called either
            let same = status == *expected
                || (*expected == NotFinite && status == Inverted && !d[0].is_nan() && d.iter().any(|x| x.abs() > 1e3));
            assert!(same && answered == (*expected == Elastic), "{place}");
            if *expected == Elastic {
                let a: [R; ANSWER] = gather(&ours.answer, case, point, points);
                for k in (0..13).chain(15..27).chain(28..30) {
                    assert!(a[k].to_f64() == if k == 22 { a[k].to_f64() } else { 0.0 }, "{place}: component {k} is {}", a[k]);
                }
            }
        }
    }
}

/// The same input gives the same bits.
pub fn is_deterministic<R: Real, B: PointBackend<R>>(backend: &B, _: &Bounds) {
    let materials = materials::<R>();
    let (relative, committed) = inputs::<R>(&self::materials::<f64>(), 7);
    let first = backend.map(&materials, POINTS, &relative, &committed);
    let second = backend.map(&materials, POINTS, &relative, &committed);
    assert!(first == second);
    // a case does not depend on the company it keeps
    let (last, n) = (materials.len() - 1, POINTS);
    let alone = backend.map(&materials[last..], n, &relative[last * RELATIVE * n..], &committed[last * STATE * n..]);
    assert_eq!(alone.answer, first.answer[last * ANSWER * n..]);
}

/// Forty steps of a closed strain cycle, the state handed on by the backend: errors must not pile
/// up.
pub fn follows_a_cycle<R: Real, B: PointBackend<R>>(backend: &B, bounds: &Bounds) {
    let (ours, reference) = (cycle(backend, &materials::<R>()), cycle(&CpuPoints, &materials::<f64>()));
    for (case, material) in materials::<f64>().iter().enumerate() {
        let (ours, reference) = (&ours[case], &reference[case]);
        let scale = reference.iter().fold(0.0f64, |m, x| m.max(x.abs()));
        for (ours, reference) in ours.iter().zip(reference) {
            let error = (ours - reference).abs() / scale;
            assert!(error <= 40.0 * bounds.agreement, "{:?}: {error:e}", material.hardening);
        }
        assert!(
            matches!(material.hardening, FlowStress::Elastic) || reference[6] > 0.1,
            "{:?}: {reference:?}",
            material.hardening
        );
    }
}

/// b_e_bar - I and alpha after the cycle, for each material.
fn cycle<R: Real, B: PointBackend<R>>(backend: &B, materials: &[Material<R>]) -> Vec<[f64; STATE]> {
    let cases = materials.len();
    let mut committed = vec![R::ZERO; cases * STATE];
    for step in 0..40 {
        let size = if (10..30).contains(&step) { -0.01 } else { 0.01 };
        let d = [size, 0.3 * size, 0.0, -0.2 * size, -0.4 * size, 0.1 * size, 0.0, 0.5 * size, -0.6 * size];
        let relative: Vec<R> = (0..cases).flat_map(|_| d).map(R::of).collect();
        let mapped = backend.map(materials, 1, &relative, &committed);
        assert!(mapped.status.iter().all(|s| matches!(s, PointStatus::Elastic | PointStatus::Yielding)));
        for case in 0..cases {
            committed[case * STATE..][..STATE].copy_from_slice(&mapped.answer[case * ANSWER + 6..][..STATE]);
        }
    }
    (0..cases).map(|case| std::array::from_fn(|k| committed[case * STATE + k].to_f64())).collect()
}

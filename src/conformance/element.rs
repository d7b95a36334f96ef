//! The element on small distorted meshes: forces, tangents, commits and energies of every law
//! against the CPU in f64.

use crate::compute::handle::CaseHandle;
use crate::compute::{CaseModel, CaseState, Compute, Evaluated};
use crate::conformance::batch::{
    Backend, OnCpu, commits, couples, difference, displaced, forces, models, most_meshes, random, tangents, two_levels,
};
use crate::mesh::Mesh;
use crate::real::Real;
use crate::solver::pose::{Rotation, rotation};

/// How far from the reference a backend may be, relative to the largest number of the answer.
pub struct Bounds {
    force: f64,
    tangent: f64,
    state: f64,
    /// Of the tangent from differences of the force; none where rounding hides them.
    differences: Option<f64>,
    /// Of a displacement, by which a point is moved over its yield surface.
    rounding: f64,
}

impl Bounds {
    /// For a backend in f64.
    pub const F64: Self = Self { force: 1e-12, tangent: 1e-12, state: 1e-12, differences: Some(1e-6), rounding: 1e-14 };
    /// For one in f32.
    pub const F32: Self = Self { force: 2e-5, tangent: 1e-4, state: 2e-5, differences: None, rounding: 2e-6 };
}

/// Strain of a first, committed step and of the trial step after it; the third number reverses the
/// first step by that factor.
const KINDS: [(&str, f64, f64, f64); 6] = [
    ("near zero", 0.0, 1e-9, 0.0),
    ("elastic", 0.0, 3e-4, 0.0),
    ("yielding", 0.0, 2e-2, 0.0),
    ("yielding on", 2e-2, 2e-2, 0.0),
    ("reversal", 1e-2, 1e-4, -1.5),
    ("large strain", 1e-2, 4e-1, 0.0),
];
const CELLS: [usize; 3] = [2, 2, 1];
/// Change of a block, by the largest number, that rounding makes only where a point begins to
/// yield.
const JUMP: f64 = 5e-5;
/// So many times what one displacement is rounded by are the forces of elements at a node.
const ROUNDED: f64 = 4.0;

fn state(backend: &mut Box<dyn Compute>, case: usize) -> CaseState {
    CaseHandle { backend: backend.as_mut(), case }.state().unwrap()
}

struct Pair {
    ours: Box<dyn Compute>,
    reference: Box<dyn Compute>,
    trials: Vec<(usize, Vec<f64>)>,
}

/// The backend and the reference after the first step of a kind, and the displacements of its
/// second.
fn prepare<R: Real, B: Backend<R>>(backend: &B, models: &[CaseModel], kind: (&str, f64, f64, f64), seed: u64) -> Pair {
    let (mut ours, mut reference) = (backend.start(models), <OnCpu as Backend<f64>>::start(&OnCpu, models));
    let mut rng = random(seed);
    let (_, first, second, back) = kind;
    let start = vec![0.0; 3 * models[0].mesh.nodes.len()];
    let committed: Vec<_> = (0..models.len()).map(|case| (case, displaced::<R>(&start, first, &mut rng))).collect();
    if first > 0.0 {
        assert!(commits(ours.as_mut(), &committed).iter().all(|(outcome, _)| *outcome == Evaluated::Valid));
        commits(reference.as_mut(), &committed);
    }
    let trials = committed
        .iter()
        .map(|(case, u)| {
            let next = displaced::<R>(u, second, &mut rng);
            (*case, next.iter().zip(u).map(|(n, u)| n + R::of(back * u).to_f64()).collect())
        })
        .collect();
    Pair { ours, reference, trials }
}

/// Displacements times a number.
fn scaled(trials: &[(usize, Vec<f64>)], by: f64) -> Vec<(usize, Vec<f64>)> {
    trials.iter().map(|(case, u)| (*case, u.iter().map(|u| by * u).collect())).collect()
}

/// For each of our blocks the nearest of three: a tangent jumps where a point is within rounding of
/// yielding, and is then that of a displacement which differs by rounding. Few points are.
fn nearest(ours: &[[f64; 9]], references: [&[[f64; 9]]; 3]) -> Vec<[f64; 9]> {
    let away = |a: &[f64; 9], b: &[f64; 9]| a.iter().zip(b).fold(0.0f64, |most, (a, b)| most.max((a - b).abs()));
    let largest = references[0].iter().flatten().fold(0.0f64, |most, x| most.max(x.abs()));
    let mut jumps = 0;
    let blocks = ours.iter().enumerate().map(|(i, block)| {
        let first = references[0][i];
        let others = references.map(|blocks| blocks[i]);
        let best =
            others.into_iter().fold(first, |best, other| if away(block, &other) < away(block, &best) { other } else { best });
        jumps += usize::from(away(&best, &first) > JUMP * largest);
        best
    });
    let blocks = blocks.collect();
    assert!(jumps <= 8 * 8, "{jumps} of {} blocks jump: more than an element", ours.len());
    blocks
}

/// How far the tangents of trials are from the reference's, a case each. What jumps by rounding is
/// asked for only where the first comparison does not hold: there the nearest of three counts.
fn from_reference(
    ours: &[(Evaluated, Vec<[f64; 9]>)],
    reference: &mut dyn Compute,
    trials: &[(usize, Vec<f64>)],
    bounds: &Bounds,
) -> Vec<f64> {
    let expected = tangents(reference, trials);
    let away = |ours: &[[f64; 9]], theirs: &[[f64; 9]]| difference(ours.as_flattened(), theirs.as_flattened());
    let first: Vec<f64> = ours.iter().zip(&expected).map(|(ours, theirs)| away(&ours.1, &theirs.1)).collect();
    if first.iter().all(|away| *away <= bounds.tangent) {
        return first;
    }
    let [below, above] = [-1.0, 1.0].map(|side| tangents(reference, &scaled(trials, 1.0 + side * bounds.rounding)));
    let of_case = |case: usize| {
        let nearest = nearest(&ours[case].1, [&expected[case].1, &below[case].1, &above[case].1]);
        away(&ours[case].1, &nearest)
    };
    (0..trials.len()).map(of_case).collect()
}

/// Element forces and tangents are those of the reference.
pub fn forces_and_tangents_agree<R: Real, B: Backend<R>>(backend: &B, bounds: &Bounds) {
    most_meshes(CELLS).iter().for_each(|models| forces_and_tangents_agree_on::<R, B>(backend, bounds, models));
}

/// The same where elements are halved twice.
pub fn forces_and_tangents_agree_on_two_levels<R: Real, B: Backend<R>>(backend: &B, bounds: &Bounds) {
    forces_and_tangents_agree_on::<R, B>(backend, bounds, &two_levels());
}

fn forces_and_tangents_agree_on<R: Real, B: Backend<R>>(backend: &B, bounds: &Bounds, models: &[CaseModel]) {
    let (mut worst_force, mut worst_tangent) = (0.0f64, 0.0f64);
    for (seed, kind) in (10..).zip(KINDS) {
        let Pair { mut ours, mut reference, trials } = prepare(backend, models, kind, seed);
        let (f, g) = (forces(ours.as_mut(), &trials), forces(reference.as_mut(), &trials));
        let k = tangents(ours.as_mut(), &trials);
        let away = from_reference(&k, reference.as_mut(), &trials, bounds);
        for case in 0..trials.len() {
            assert_eq!((f[case].0, g[case].0, k[case].0), (Evaluated::Valid, Evaluated::Valid, Evaluated::Valid), "{}", kind.0);
            let (force, tangent) = (difference(&f[case].1, &g[case].1), away[case]);
            assert!(force <= bounds.force, "{} {}, case {case}: force {force:e}", R::NAME, kind.0);
            assert!(tangent <= bounds.tangent, "{} {}, case {case}: tangent {tangent:e}", R::NAME, kind.0);
            (worst_force, worst_tangent) = (worst_force.max(force), worst_tangent.max(tangent));
        }
    }
    let elements = models[0].mesh.elements.len();
    log::debug!("{}, {elements} elements: worst force {worst_force:.1e}, tangent {worst_tangent:.1e}", R::NAME);
}

fn distance(ours: &CaseState, reference: &CaseState) -> f64 {
    let flat = |s: &CaseState| s.points.iter().flatten().flat_map(|p| p.be.into_iter().chain([p.alpha])).collect::<Vec<_>>();
    assert_eq!(ours.displacement, reference.displacement);
    difference(&flat(ours), &flat(reference)).max(difference(&ours.plastic_work, &reference.plastic_work))
}

/// What a step commits and its energies are those of the reference.
pub fn commits_and_energies_agree<R: Real, B: Backend<R>>(backend: &B, bounds: &Bounds) {
    most_meshes(CELLS).iter().for_each(|models| commits_and_energies_agree_on::<R, B>(backend, bounds, models));
}

/// The same where elements are halved twice.
pub fn commits_and_energies_agree_on_two_levels<R: Real, B: Backend<R>>(backend: &B, bounds: &Bounds) {
    commits_and_energies_agree_on::<R, B>(backend, bounds, &two_levels());
}

fn commits_and_energies_agree_on<R: Real, B: Backend<R>>(backend: &B, bounds: &Bounds, models: &[CaseModel]) {
    let mut worst = 0.0f64;
    for (seed, kind) in (30..).zip(KINDS) {
        let Pair { mut ours, mut reference, trials } = prepare(backend, models, kind, seed);
        let (e, f) = (commits(ours.as_mut(), &trials), commits(reference.as_mut(), &trials));
        for case in 0..trials.len() {
            assert_eq!((e[case].0, f[case].0), (Evaluated::Valid, Evaluated::Valid), "{}", kind.0);
            let (e, f) = (e[case].1, f[case].1);
            let state = distance(&state(&mut ours, case), &state(&mut reference, case));
            let error = [[e.elastic, f.elastic], [e.plastic, f.plastic], [e.max_alpha, f.max_alpha]]
                .iter()
                .fold(state, |worst, [ours, reference]| worst.max(difference([ours], [reference])));
            assert!(error <= bounds.state, "{} {}, case {case}: {error:e}, {e:?}, {f:?}", R::NAME, kind.0);
            assert!(case == 0 || kind.2 < 1e-2 || (e.plastic > 0.0 && e.max_alpha > 0.0), "{}, case {case}: {e:?}", kind.0);
            let fields =
                [&mut ours, &mut reference].map(|backend| CaseHandle { backend: backend.as_mut(), case }.fields().unwrap());
            let [stress, expected] = fields.map(|f| f.stress.into_iter().flatten().collect::<Vec<_>>());
            assert!(difference(&stress, &expected) <= bounds.force, "{} {}, case {case}: fields", R::NAME, kind.0);
            worst = worst.max(error);
        }
    }
    log::debug!("{}: worst state and energies {worst:.1e}", R::NAME);
}

/// A restored state is the one that was taken: the answers that follow have the same bits.
pub fn a_state_survives_being_taken_and_restored<R: Real, B: Backend<R>>(backend: &B, _: &Bounds) {
    let models = models(CELLS);
    let Pair { mut ours, trials, .. } = prepare(backend, &models, KINDS[3], 50);
    let expected = forces(ours.as_mut(), &trials);
    let mut other = backend.start(&models);
    for case in 0..trials.len() {
        CaseHandle { backend: other.as_mut(), case }.restore(state(&mut ours, case)).unwrap();
        assert_eq!(state(&mut other, case), state(&mut ours, case));
    }
    assert!(forces(other.as_mut(), &trials) == expected);
}

/// What a displacement becomes if the displaced body is turned as well, in numbers of precision R.
fn turned<R: Real>(mesh: &Mesh, turn: &Rotation, u: &[f64]) -> Vec<f64> {
    let of_node = |(x, u): (&[f64; 3], &[f64])| {
        let turned = product_with(turn, std::array::from_fn(|i| x[i] + u[i]));
        std::array::from_fn::<f64, 3, _>(|i| R::of(turned[i] - x[i]).to_f64())
    };
    mesh.nodes.iter().zip(u.chunks_exact(3)).flat_map(of_node).collect()
}

fn product_with(q: &Rotation, v: [f64; 3]) -> [f64; 3] {
    q.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

/// What rounding makes of the forces of a displaced body (E = 1): a displacement is known to so
/// much of itself, which is a strain over an edge, and a force on a face.
fn rounding<R: Real>(mesh: &Mesh, u: &[f64]) -> f64 {
    let length = |a: [f64; 3], b: [f64; 3]| (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt();
    let edges = (0..mesh.elements.len()).map(|e| mesh.corners(e)).flat_map(|x| [1, 3, 4].map(|b| length(x[0], x[b])));
    let size = u.iter().fold(0.0f64, |most, u| most.max(u.abs()));
    R::EPSILON.to_f64() * size * edges.fold(0.0, f64::max)
}

/// A turn by any angle makes no force in a body without one, and takes along what there is.
fn turns_take_forces_along<R: Real, B: Backend<R>>(backend: &B, bounds: &Bounds, models: &[CaseModel]) {
    let Pair { mut ours, trials, .. } = prepare(backend, models, KINDS[3], 60);
    let mut virgin = backend.start(models);
    let still = forces(ours.as_mut(), &trials);
    for angles in [[0.0, 0.0, 2.0], [0.02, -0.01, 0.0], [0.3, 0.4, -0.2], [-0.5, 0.4, 3.0]] {
        let turn = rotation(angles);
        let of = |case: usize, u: &[f64]| (case, turned::<R>(&models[case].mesh, &turn, u));
        let unloaded: Vec<_> = trials.iter().map(|(case, u)| of(*case, &vec![0.0; u.len()])).collect();
        let loaded: Vec<_> = trials.iter().map(|(case, u)| of(*case, u)).collect();
        let (nothing, found) = (forces(virgin.as_mut(), &unloaded), forces(ours.as_mut(), &loaded));
        for (case, (_, f)) in still.iter().enumerate() {
            assert_eq!((nothing[case].0, found[case].0), (Evaluated::Valid, Evaluated::Valid), "{angles:?}, case {case}");
            let scale = f.iter().fold(0.0f64, |m, f| m.max(f.abs()));
            let most = nothing[case].1.iter().fold(0.0f64, |m, f| m.max(f.abs()));
            let rounding = rounding::<R>(&models[case].mesh, &unloaded[case].1);
            let allowed = 10.0 * bounds.force * scale + ROUNDED * rounding;
            assert!(most <= allowed, "{}, {angles:?}, case {case}: {most:e} of {scale:e}, rounding {rounding:e}", R::NAME);
            let expected: Vec<f64> = f.chunks_exact(3).flat_map(|f| product_with(&turn, [f[0], f[1], f[2]])).collect();
            let off = difference(&found[case].1, &expected);
            let (made, moved) = (most / rounding, off * scale / rounding);
            log::debug!("{}, {angles:?}, case {case}: {made:.1} and {moved:.1} times the rounding", R::NAME);
            assert!(off * scale <= allowed, "{}, {angles:?}, case {case}: turned {off:e}, rounding {rounding:e}", R::NAME);
        }
    }
}

/// Newton's third law, no force from a shift of the whole body or a turn, and a tangent that is the
/// derivative of the force.
pub fn obeys_its_equations<R: Real, B: Backend<R>>(backend: &B, bounds: &Bounds) {
    most_meshes(CELLS).iter().for_each(|models| obeys_all_equations_on::<R, B>(backend, bounds, models));
}

/// The same where elements are halved twice.
pub fn obeys_its_equations_on_two_levels<R: Real, B: Backend<R>>(backend: &B, bounds: &Bounds) {
    obeys_all_equations_on::<R, B>(backend, bounds, &two_levels());
}

fn obeys_all_equations_on<R: Real, B: Backend<R>>(backend: &B, bounds: &Bounds, models: &[CaseModel]) {
    obeys_its_equations_on::<R, B>(backend, bounds, models);
    turns_take_forces_along::<R, B>(backend, bounds, models);
}

fn obeys_its_equations_on<R: Real, B: Backend<R>>(backend: &B, bounds: &Bounds, models: &[CaseModel]) {
    let Pair { mut ours, trials, .. } = prepare(backend, models, KINDS[3], 60);
    let moved: Vec<_> = trials.iter().map(|(case, u)| (*case, u.iter().map(|u| u + 0.25).collect())).collect();
    let (still, shifted) = (forces(ours.as_mut(), &trials), forces(ours.as_mut(), &moved));
    for (case, ((_, f), (_, g))) in still.iter().zip(&shifted).enumerate() {
        assert!(difference(g, f) <= 10.0 * bounds.force, "{}, case {case}: shifted {:e}", R::NAME, difference(g, f));
        let scale = f.iter().fold(0.0f64, |m, f| m.max(f.abs()));
        for i in 0..3 {
            let sum: f64 = f.iter().skip(i).step_by(3).sum();
            assert!(sum.abs() <= 10.0 * bounds.force * scale, "{}, case {case}: sum {sum:e}", R::NAME);
        }
    }
    let Some(bound) = bounds.differences else { return };
    let mesh = ours.models()[0].mesh.clone();
    let pattern = crate::mesh::pattern::Pattern::from_elements(mesh.nodes.len(), &mesh.elements);
    // The moduli of plastic flow are the symmetrised ones: their part of the tangent is exact only
    // where the flow is radial.
    let elastic = vec![trials[0].clone()];
    let blocks = tangents(ours.as_mut(), &elastic).remove(0).1;
    let direction = displaced::<R>(&vec![0.0; elastic[0].1.len()], 1.0, &mut random(61));
    let at = |step: f64| vec![(0, elastic[0].1.iter().zip(&direction).map(|(u, d)| u + step * d).collect())];
    let step = 1e-5;
    let (after, before) = (forces(ours.as_mut(), &at(step)).remove(0).1, forces(ours.as_mut(), &at(-step)).remove(0).1);
    let expected: Vec<f64> = after.iter().zip(&before).map(|(a, b)| (a - b) / (2.0 * step)).collect();
    let mut product = vec![0.0; expected.len()];
    for node in 0..pattern.rows() {
        for k in pattern.row(node) {
            for (i, j) in (0..9).map(|c| (c / 3, c % 3)) {
                product[3 * node + i] += blocks[k][3 * i + j] * direction[3 * pattern.column[k] as usize + j];
            }
        }
    }
    assert!(difference(&product, &expected) <= bound, "{:e}", difference(&product, &expected));
}

/// J <= 0 and NaN are named by element and point, and spoil neither the other cases nor the calls
/// after them.
pub fn bad_displacements_are_refused<R: Real, B: Backend<R>>(backend: &B, _: &Bounds) {
    let Pair { mut ours, mut reference, trials } = prepare(backend, &models(CELLS), KINDS[3], 70);
    let good = forces(ours.as_mut(), &trials);
    let mut bad = trials.clone();
    bad[1].1[3 * 4 + 2] += 2.0;
    bad[3].1[5] = f64::NAN;
    bad[5].1[7] = f64::INFINITY;
    let (f, g) = (forces(ours.as_mut(), &bad), forces(reference.as_mut(), &bad));
    let (k, c) = (tangents(ours.as_mut(), &bad), commits(ours.as_mut(), &bad));
    for case in 0..bad.len() {
        let refused = case % 2 == 1;
        assert_eq!(f[case].0 == Evaluated::Valid, !refused, "case {case}");
        assert_eq!([f[case].0, k[case].0, c[case].0], [g[case].0; 3], "case {case}");
        if !refused {
            assert!(f[case].1 == good[case].1, "case {case}");
        } else {
            // not committed: the state and the answers are those of before
            assert!(state(&mut ours, case).displacement != bad[case].1);
            assert!(forces(ours.as_mut(), &trials[case..=case])[0] == good[case], "case {case}");
        }
    }
}

/// Two bodies in one mesh answer as each by itself, to the bit: forces, tangents, energies, and
/// which part of the plastic work is the opponent's.
pub fn two_bodies_answer_as_each_by_itself<R: Real, B: Backend<R>>(backend: &B, bounds: &Bounds) {
    let meshes = most_meshes(CELLS).into_iter().chain([two_levels()]);
    meshes.for_each(|models| two_bodies_answer_on::<R, B>(backend, bounds, models));
}

fn two_bodies_answer_on<R: Real, B: Backend<R>>(backend: &B, bounds: &Bounds, own: Vec<CaseModel>) {
    let (both, alone) = couples(own);
    let nodes = alone[0][0].mesh.nodes.len();
    let mut ours = backend.start(&both);
    let mut reference = <OnCpu as Backend<f64>>::start(&OnCpu, &both);
    let mut bodies = alone.map(|models| backend.start(&models));
    let mut rng = random(80);
    let mut at: Vec<_> = (0..both.len()).map(|case| (case, vec![0.0; 6 * nodes])).collect();
    for strain in [2e-3, 2e-2, 5e-3] {
        at = at.iter().map(|(case, u)| (*case, displaced::<R>(u, strain, &mut rng))).collect();
        let part = |body: usize| -> Vec<_> {
            at.iter().map(|(case, u)| (*case, u[3 * nodes * body..3 * nodes * (body + 1)].to_vec())).collect()
        };
        let (f, k) = (forces(ours.as_mut(), &at), tangents(ours.as_mut(), &at));
        let g = forces(reference.as_mut(), &at);
        let away = from_reference(&k, reference.as_mut(), &at, bounds);
        let (e, d) = (commits(ours.as_mut(), &at), commits(reference.as_mut(), &at));
        let answers = [0, 1].map(|body| {
            let (backend, part) = (bodies[body].as_mut(), part(body));
            (forces(backend, &part), tangents(backend, &part), commits(backend, &part))
        });
        for case in 0..both.len() {
            assert_eq!([f[case].0, k[case].0, e[case].0], [Evaluated::Valid; 3], "case {case}");
            assert!(difference(&f[case].1, &g[case].1) <= bounds.force, "case {case}: force");
            let tangent = away[case];
            assert!(tangent <= bounds.tangent, "case {case}, strain {strain}: tangent {tangent:e}");
            let [(f0, k0, e0), (f1, k1, e1)] = &answers;
            assert!(f[case].1 == [&f0[case].1[..], &f1[case].1].concat(), "case {case}: other forces than alone");
            assert!(k[case].1 == [&k0[case].1[..], &k1[case].1].concat(), "case {case}: other tangents than alone");
            let (e, d, own, opponent) = (e[case].1, d[case].1, e0[case].1, e1[case].1);
            let sums = [e.elastic, e.plastic, e.opponent_plastic, e.max_alpha];
            let alone = [
                own.elastic + opponent.elastic,
                own.plastic + opponent.plastic,
                opponent.plastic,
                own.max_alpha.max(opponent.max_alpha),
            ];
            let on_cpu = [d.elastic, d.plastic, d.opponent_plastic, d.max_alpha];
            for (sum, (alone, on_cpu)) in sums.iter().zip(alone.iter().zip(&on_cpu)) {
                assert!(difference([sum], [alone]) <= 1e-12, "case {case}: {sums:?}, alone {alone:?}");
                assert!(difference([sum], [on_cpu]) <= bounds.state, "case {case}: {sums:?}, in f64 {on_cpu:?}");
            }
            assert!(state(&mut ours, case).plastic_work.len() == 2 * state(&mut bodies[0], case).plastic_work.len());
        }
        let bits = bodies.each_mut().map(|body| (0..both.len()).map(|case| state(body, case)).collect::<Vec<_>>());
        for case in 0..both.len() {
            let state = state(&mut ours, case);
            let [own, opponent] = bits.each_ref().map(|states| &states[case]);
            assert!(state.points == [&own.points[..], &opponent.points].concat(), "case {case}: other states than alone");
        }
    }
}

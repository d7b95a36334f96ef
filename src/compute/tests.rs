//! What every backend owes its cases, held on the CPU in both precisions: the bodies take the
//! backend as an argument.

mod hanging;

use std::sync::Arc;

use super::call::{Answer, Call, TangentBlocks};
use super::cpu::Cpu;
use super::handle::{CaseHandle, at};
use super::{CaseModel, Compute, ComputeError, Energies, Evaluated, Fault};
use crate::contact::coulomb::{Friction, Point, Rows, contact_rows};
use crate::contact::rigid::Rigid;
use crate::material::hardening::FlowStress;
use crate::material::{Elasticity, Material};
use crate::mesh::pattern::Pattern;
use crate::mesh::{Mesh, brick};

type Make = fn(Vec<CaseModel>) -> Result<Box<dyn Compute>, ComputeError>;

const BACKENDS: [Make; 3] = [
    |m| Ok(Box::new(Cpu::<f64>::new(m)?)),
    |m| Ok(Box::new(Cpu::<f32>::new(m)?)),
    |m| Ok(Box::new(Cpu::<f64, f32>::with_tangents(m)?)),
];

/// 300 elements: more than the chunk that one thread takes at a time.
fn mesh(stretch: f64) -> Arc<Mesh> {
    let mut mesh = brick(10, 6, 5, [1.0, 0.7, 0.5]).unwrap();
    for x in &mut mesh.nodes {
        *x = [x[0] * stretch, x[1] + 0.02 * (3.0 * x[0]).sin(), x[2] * (1.0 + 0.1 * x[0])];
    }
    Arc::new(mesh)
}

/// Three cases that differ in shape, material and friction.
fn models() -> Vec<CaseModel> {
    let material = |hardening| Material { elasticity: Elasticity::new(1.0, 0.3), hardening };
    vec![
        CaseModel {
            mesh: mesh(1.0),
            material: material(FlowStress::ideal(2e-3).unwrap()),
            friction: Friction::Coulomb(0.3),
            opponent: None,
            image: None,
            surface: Rigid::default(),
        },
        CaseModel {
            mesh: mesh(1.1),
            material: material(FlowStress::Elastic),
            friction: Friction::Coulomb(0.0),
            opponent: None,
            image: None,
            surface: Rigid::default(),
        },
        CaseModel {
            mesh: mesh(0.9),
            material: material(FlowStress::power(1e-3, 5e-3, 0.3).unwrap()),
            friction: Friction::Stick,
            opponent: None,
            image: None,
            surface: Rigid::default(),
        },
    ]
}

/// A displacement that bends, squeezes and shears; plastic in the cases that can be.
fn displacement(mesh: &Mesh, size: f64) -> Vec<f64> {
    mesh.nodes
        .iter()
        .flat_map(|x| {
            [
                size * (x[2] + 0.3 * (5.0 * x[1]).sin()),
                size * 0.2 * (4.0 * x[0] + x[2]).sin() * x[1],
                -size * x[2] * (1.0 + 0.5 * (3.0 * x[0]).cos()),
            ]
        })
        .collect()
}

/// Everything that a backend says of one case at one displacement, as bits.
#[derive(Clone, Debug, PartialEq)]
struct Said {
    force: Vec<u64>,
    blocks: Vec<u64>,
    rows: Vec<(u32, Vec<u64>)>,
}

fn bits<'a>(x: impl IntoIterator<Item = &'a f64>) -> Vec<u64> {
    x.into_iter().map(|v| v.to_bits()).collect()
}

fn no_rows(mesh: &Mesh) -> Vec<Rows<f64>> {
    let open = Point { force: [0.0; 3], gap: 1.0, slip: [0.0; 2], weight: 1.0, on_symmetry_plane: false };
    vec![contact_rows(Friction::Stick, &open); mesh.contact_nodes.len()]
}

fn answer(backend: &mut dyn Compute, case: usize, u: &[f64]) -> Said {
    let mut handle = at(backend, case);
    let mesh = handle.model().mesh.clone();
    let mut force = vec![0.0; u.len()];
    let mut blocks = vec![[0.0_f64; 9]; Pattern::from_elements(mesh.nodes.len(), &mesh.elements).entries()];
    let mut rows = no_rows(&mesh);
    assert_eq!(handle.internal_force(u, &mut force).unwrap(), Evaluated::Valid);
    assert_eq!(handle.tangent(u, &mut blocks).unwrap(), Evaluated::Valid);
    handle.contact(u, &force, &mut rows).unwrap();
    let row = |r: &Rows<f64>| {
        let numbers =
            r.residual.iter().chain(r.force_rows.as_flattened()).chain(r.displacement_rows.as_flattened()).chain([&r.weight]);
        (r.status as u32, bits(numbers))
    };
    Said { force: bits(&force), blocks: bits(blocks.as_flattened()), rows: rows.iter().map(row).collect() }
}

fn commit(backend: &mut dyn Compute, case: usize, u: &[f64]) -> Energies {
    let (energies, outcome) = at(backend, case).commit(u).unwrap();
    assert_eq!(outcome, Evaluated::Valid);
    energies
}

/// Two committed steps and what is seen at a third displacement.
fn run(backend: &mut dyn Compute, case: usize) -> (Vec<Said>, Energies) {
    let mesh = backend.models()[case].mesh.clone();
    let mut answers = vec![answer(backend, case, &displacement(&mesh, 1e-3))];
    commit(backend, case, &displacement(&mesh, 5e-3));
    answers.push(answer(backend, case, &displacement(&mesh, 7e-3)));
    let energies = commit(backend, case, &displacement(&mesh, 8e-3));
    answers.push(answer(backend, case, &displacement(&mesh, 7.5e-3)));
    (answers, energies)
}

#[test]
fn one_thread_and_two_give_the_same_bits() {
    for make in BACKENDS {
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let mut backend = make(models()).unwrap();
                let answers: Vec<_> = (0..3).map(|case| run(backend.as_mut(), case)).collect();
                (answers, at(backend.as_mut(), 0).state().unwrap(), at(backend.as_mut(), 2).fields().unwrap())
            })
        };
        let (one, two, three) = (on(1), on(2), on(3));
        assert!(one.0[0].1.plastic > 0.0 && one.0[1].1.plastic == 0.0, "the cases are not what they should be");
        assert!(one == two, "two threads");
        assert!(one == three, "three threads");
    }
}

fn tangent(backend: &mut dyn Compute, case: usize, u: &[f64]) -> Vec<[f32; 9]> {
    let mut handle = at(backend, case);
    let mesh = handle.model().mesh.clone();
    let mut blocks = vec![[0.0_f32; 9]; Pattern::from_elements(mesh.nodes.len(), &mesh.elements).entries()];
    assert_eq!(handle.tangent(u, &mut blocks).unwrap(), Evaluated::Valid);
    blocks
}

/// Largest difference of two tangents, of their largest number.
fn difference(a: &[[f32; 9]], b: &[[f32; 9]]) -> f32 {
    let largest = a.as_flattened().iter().fold(0.0_f32, |m, x| m.max(x.abs()));
    a.as_flattened().iter().zip(b.as_flattened()).fold(0.0_f32, |m, (a, b)| m.max((a - b).abs())) / largest
}

#[test]
fn a_tangent_in_single_precision_is_taken_again_within_a_step_and_close_by() {
    let fresh = || Cpu::<f64, f32>::with_tangents(models()).unwrap();
    let at = |size: f64| displacement(&models()[1].mesh, size);
    // The elastic case: as it was, close by; anew, farther off.
    let mut backend = fresh();
    let first = tangent(&mut backend, 1, &at(1e-3));
    assert!(first == tangent(&mut fresh(), 1, &at(1e-3)), "a first tangent is exact");
    assert!(first == tangent(&mut backend, 1, &at(1.002e-3)), "hardly moved");
    let exact = tangent(&mut fresh(), 1, &at(1.002e-3));
    assert!(first != exact && difference(&exact, &first) < 1e-3, "what that costs: {}", difference(&exact, &first));
    let far = tangent(&mut backend, 1, &at(5e-3));
    assert!(difference(&tangent(&mut fresh(), 1, &at(5e-3)), &far) < 1e-3, "moved");
    assert!(difference(&exact, &far) > 1e-3, "it is another");
    // In another step, and from another state, it is formed anew.
    CaseHandle { backend: &mut backend, case: 1 }.begin_step(0.0).unwrap();
    assert!(exact == tangent(&mut backend, 1, &at(1.002e-3)), "another step");
    let state = CaseHandle { backend: &mut backend, case: 1 }.state().unwrap();
    CaseHandle { backend: &mut backend, case: 1 }.restore(state).unwrap();
    assert!(first == tangent(&mut backend, 1, &at(1e-3)), "restored");
    let mut other = fresh();
    for backend in [&mut backend, &mut other] {
        commit(backend, 1, &at(1.001e-3));
    }
    assert!(tangent(&mut other, 1, &at(1.002e-3)) == tangent(&mut backend, 1, &at(1.002e-3)), "committed");

    // Where it flows or is about to, whatever its distance. What is elastic is 1e-3 off at most.
    let at = |size: f64| displacement(&models()[0].mesh, size);
    for size in [6e-4, 1e-3, 2e-3, 5e-3] {
        let mut backend = fresh();
        tangent(&mut backend, 0, &at(size));
        let again = tangent(&mut backend, 0, &at(1.05 * size));
        let exact = tangent(&mut fresh(), 0, &at(1.05 * size));
        assert!(difference(&exact, &again) < 1e-3, "{size}: {}", difference(&exact, &again));
    }
    // A failure in between is not remembered.
    let mut backend = fresh();
    tangent(&mut backend, 1, &at(1e-3));
    let mut torn = at(1e-3);
    torn[7] = f64::NAN;
    let mut blocks = vec![[0.0_f32; 9]; exact.len()];
    let outcome = CaseHandle { backend: &mut backend, case: 1 }.tangent(&torn, &mut blocks).unwrap();
    assert_ne!(outcome, Evaluated::Valid);
    assert!(tangent(&mut backend, 1, &at(1e-3)) == tangent(&mut fresh(), 1, &at(1e-3)), "after a failure");
}

#[test]
fn a_batch_gives_each_case_what_it_gets_alone() {
    for make in BACKENDS {
        let mut together = make(models()).unwrap();
        let alone: Vec<_> = models().into_iter().map(|m| run(make(vec![m]).unwrap().as_mut(), 0)).collect();
        // Interleaved and backwards, so that a shared buffer would show.
        let mut batch: Vec<_> = [2, 0, 1].map(|case| (case, run(together.as_mut(), case))).into();
        batch.sort_by_key(|b| b.0);
        for ((case, got), alone) in batch.iter().zip(&alone) {
            assert!(got == alone, "case {case}");
        }
        assert!(alone[0] != alone[1] && alone[1] != alone[2]);

        // All in one call.
        let mut together = make(models()).unwrap();
        let meshes: Vec<_> = models().into_iter().map(|m| m.mesh).collect();
        let u: Vec<_> = meshes.iter().map(|m| displacement(m, 1e-3)).collect();
        let all = |call: fn(&[f64]) -> Call| u.iter().enumerate().map(|(case, u)| (case, call(u))).collect();
        let forces = together.call(all(|u| Call::Force { displacement: u.into() })).unwrap();
        let tangents =
            together.call(all(|u| Call::Tangent { displacement: u.into(), blocks: TangentBlocks::Double(vec![]) })).unwrap();
        for (case, answers) in forces.iter().zip(&tangents).enumerate() {
            let (Answer::Force { force, .. }, Answer::Tangent { blocks: TangentBlocks::Double(blocks), .. }) = answers else {
                panic!("{answers:?}");
            };
            assert!(bits(force) == alone[case].0[0].force, "force of case {case}");
            assert!(bits(blocks.as_flattened()) == alone[case].0[0].blocks, "tangent of case {case}");
        }
    }
}

#[test]
fn the_assembled_tangent_is_symmetric_and_the_derivative_of_the_force() {
    let mut backend = Cpu::<f64>::new(models()).unwrap();
    let mesh = backend.models()[1].mesh.clone();
    let pattern = Pattern::from_elements(mesh.nodes.len(), &mesh.elements);
    let u = displacement(&mesh, 0.02);
    let mut blocks = vec![[0.0_f64; 9]; pattern.entries()];
    at(&mut backend, 1).tangent(&u, &mut blocks).unwrap();
    let scale = blocks.iter().flatten().fold(0.0_f64, |m, x| m.max(x.abs()));
    for a in 0..pattern.rows() {
        for k in pattern.row(a) {
            let b = pattern.column[k] as usize;
            let t = blocks[pattern.position(b, a).unwrap()];
            for i in 0..3 {
                for j in 0..3 {
                    let (x, y) = (blocks[k][3 * i + j], t[3 * j + i]);
                    // Both triangles add the same numbers in the same order; a diagonal block is
                    // symmetric to rounding.
                    assert!(if a == b { (x - y).abs() < 1e-15 * scale } else { x == y }, "{a} {b} {i} {j}: {x:e} {y:e}");
                }
            }
        }
    }
    // K v against the difference of the forces along v.
    let v = displacement(&mesh, 1.0);
    let e = 1e-6;
    let mut force = |s: f64| {
        let moved: Vec<f64> = u.iter().zip(&v).map(|(u, v)| u + s * v).collect();
        let mut f = vec![0.0; u.len()];
        at(&mut backend, 1).internal_force(&moved, &mut f).unwrap();
        f
    };
    let (up, down) = (force(e), force(-e));
    let mut matrix = vec![0.0; v.len()];
    for a in 0..pattern.rows() {
        for k in pattern.row(a) {
            let b = pattern.column[k] as usize;
            for i in 0..9 {
                matrix[3 * a + i / 3] += blocks[k][i] * v[3 * b + i % 3];
            }
        }
    }
    let largest = matrix.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    for n in 0..u.len() {
        assert!(((up[n] - down[n]) / (2.0 * e) - matrix[n]).abs() < 1e-8 * largest, "unknown {n}");
    }
}

#[test]
fn a_state_survives_being_copied_out_and_back() {
    for make in BACKENDS {
        let mut first = make(models()).unwrap();
        let mesh = first.models()[0].mesh.clone();
        commit(first.as_mut(), 0, &displacement(&mesh, 5e-3));
        let saved = at(first.as_mut(), 0).state().unwrap();
        assert!(saved.plastic_work.iter().any(|w| *w > 0.0) && saved.points.iter().flatten().any(|p| p.alpha > 0.0));
        let expected = run(first.as_mut(), 0);

        // Into a fresh backend, into another slot's neighbour, and back into one that has gone on.
        let mut second = make(models()).unwrap();
        at(second.as_mut(), 0).restore(saved.clone()).unwrap();
        assert_eq!(at(second.as_mut(), 0).state().unwrap(), saved);
        assert!(run(second.as_mut(), 0) == expected, "a fresh backend");
        assert!(
            at(second.as_mut(), 1).state().unwrap() == at(make(models()).unwrap().as_mut(), 1).state().unwrap(),
            "a neighbour was touched"
        );
        at(first.as_mut(), 0).restore(saved).unwrap();
        assert!(run(first.as_mut(), 0) == expected, "the same backend");
    }
}

#[test]
fn what_is_not_committed_leaves_no_trace() {
    for make in BACKENDS {
        let mut clean = make(models()).unwrap();
        let mut disturbed = make(models()).unwrap();
        let mesh = clean.models()[0].mesh.clone();
        commit(clean.as_mut(), 0, &displacement(&mesh, 4e-3));
        commit(disturbed.as_mut(), 0, &displacement(&mesh, 4e-3));
        let before = at(disturbed.as_mut(), 0).state().unwrap();
        // Trials far away, trials that invert elements, and a commit that is refused.
        answer(disturbed.as_mut(), 0, &displacement(&mesh, 0.05));
        let mut inverted = displacement(&mesh, 4e-3);
        let node = mesh.nodes.len() / 2;
        inverted[3 * node] += 10.0;
        let mut force = vec![0.0; inverted.len()];
        let mut handle = at(disturbed.as_mut(), 0);
        let bad = handle.internal_force(&inverted, &mut force).unwrap();
        assert!(matches!(bad, Evaluated::Invalid(Fault::Inverted { .. })), "{bad:?}");
        assert_eq!(handle.commit(&inverted).unwrap().1, bad);
        let mut meaningless = displacement(&mesh, 4e-3);
        meaningless[7] = f64::NAN;
        let refused = handle.commit(&meaningless).unwrap().1;
        assert!(matches!(refused, Evaluated::Invalid(Fault::Deformation { .. })), "{refused:?}");
        assert_eq!(at(disturbed.as_mut(), 0).state().unwrap(), before);
        assert!(run(clean.as_mut(), 0) == run(disturbed.as_mut(), 0));
    }
}

#[test]
fn the_first_inverted_element_is_named_at_any_thread_count() {
    for threads in [1, 2] {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(|| {
            let mut backend = Cpu::<f64>::new(models()).unwrap();
            let mesh = backend.models()[0].mesh.clone();
            let mut u = vec![0.0; 3 * mesh.nodes.len()];
            // Two nodes of elements that are chunks apart.
            for n in [*mesh.elements[290].last().unwrap(), mesh.elements[70][6]] {
                u[3 * n as usize] = -5.0;
            }
            let mut force = vec![0.0; u.len()];
            let outcome = at(&mut backend, 0).internal_force(&u, &mut force).unwrap();
            let first = mesh.elements.iter().position(|e| e.contains(&mesh.elements[70][6])).unwrap();
            let named = matches!(outcome, Evaluated::Invalid(Fault::Inverted { element, .. }) if element == first);
            assert!(named, "{outcome:?}, {first} expected");
        });
    }
}

#[test]
fn energies_and_fields_of_a_uniform_squeeze() {
    // u = (F - I) X with F = diag(1.02, 1, 0.97) and no yielding: the energy is W times the volume,
    // everywhere the same stress.
    for (make, digits) in BACKENDS.into_iter().zip([1e-12, 1e-5]) {
        let mut backend = make(models()).unwrap();
        let mesh = backend.models()[1].mesh.clone();
        let u: Vec<f64> = mesh.nodes.iter().flat_map(|x| [0.02 * x[0], 0.0, -0.03 * x[2]]).collect();
        let energies = commit(backend.as_mut(), 1, &u);
        let e: Elasticity<f64> = Elasticity::new(1.0, 0.3);
        let (trace, j) = (1.02_f64.powi(2) + 1.0 + 0.97_f64.powi(2), 1.02 * 0.97_f64);
        let density = 0.5 * e.bulk * (0.5 * (j * j - 1.0) - j.ln()) + 0.5 * e.shear * (trace * j.powf(-2.0 / 3.0) - 3.0);
        let volume = crate::mesh::quality::volume(&mesh);
        assert!((energies.elastic / (density * volume) - 1.0).abs() < digits, "{} {}", energies.elastic, density * volume);
        assert_eq!((energies.plastic, energies.max_alpha), (0.0, 0.0));
        let fields = at(backend.as_mut(), 1).fields().unwrap();
        let expected = |b: f64| 0.5 * e.bulk * (j - 1.0 / j) + e.shear * j.powf(-5.0 / 3.0) * (b - trace / 3.0);
        for stress in &fields.stress {
            for (s, b) in stress.iter().zip([1.02_f64.powi(2), 1.0, 0.97_f64.powi(2)]) {
                assert!((s - expected(b)).abs() < digits * 0.05, "{s} {}", expected(b));
            }
            assert!(stress[3..].iter().all(|s| s.abs() < digits * 0.05));
        }
    }
}

#[test]
fn batches_that_cannot_be_are_refused() {
    for make in BACKENDS {
        assert!(make(vec![]).unwrap().models().is_empty());
        let mut other = models();
        other[1].mesh = Arc::new(brick(6, 10, 5, [1.0; 3]).unwrap());
        assert!(matches!(make(other), Err(ComputeError::Connectivity { case: 1 })));
        let mut inverted = models();
        let mut bad = (*inverted[2].mesh).clone();
        let node = bad.elements[42][0] as usize;
        bad.nodes[node][0] += 5.0;
        inverted[2].mesh = Arc::new(bad);
        assert!(matches!(make(inverted), Err(ComputeError::InvertedMesh { .. })));
    }
}

#[test]
fn a_refused_commit_keeps_its_neighbours_in_the_same_call() {
    let mut backend = Cpu::<f64>::new(models()).unwrap();
    let meshes: Vec<_> = models().into_iter().map(|m| m.mesh).collect();
    let good = displacement(&meshes[0], 4e-3);
    let mut bad = displacement(&meshes[1], 4e-3);
    bad[0] = f64::NAN;
    let calls = [&good, &bad].map(|u| Call::Commit { displacement: u.as_slice().into() });
    let answers = backend.call(calls.into_iter().enumerate().collect()).unwrap();
    let [Answer::Commit { energies, outcome }, Answer::Commit { outcome: refused, .. }] = answers[..] else {
        panic!("{answers:?}");
    };
    assert_eq!(outcome, Evaluated::Valid);
    assert!(energies.plastic > 0.0);
    assert!(matches!(refused, Evaluated::Invalid(Fault::Deformation { .. })));
    assert_eq!(at(&mut backend, 0).state().unwrap().displacement, good);
    assert!(at(&mut backend, 1).state().unwrap().displacement.iter().all(|x| *x == 0.0));
}

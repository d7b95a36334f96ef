//! Each kernel of the linear solver by itself. Matrices, diagonal blocks and what a V-cycle takes
//! and leaves on every level are the CPU's, which are in f32 too; the vectors of FGMRES, which the
//! CPU makes in another way, are held to the equations that define them, in f64.

use super::linear::{Numbers, TestSystem, down_to_one_element, mesh, models, own_numbers, solve, system, whole_mesh};
use crate::compute::CaseModel;
use crate::compute::gpu::linear::inspect::OnLevel;
use crate::compute::gpu::{Gpu, GpuContext};
use crate::linalg::{BlockMatrix, Hierarchy};
use crate::mesh::{Mesh, SphereSpec, sphere_mesh, whole};
use std::sync::Arc;

/// Of the largest number of an array.
const BOUND: f32 = 1e-5;

/// Two of even elements, two with smaller ones at the surface, whose levels are the first steps of
/// the hierarchy, and both halves of one of either kind.
fn meshes() -> [Arc<Mesh>; 6] {
    let half = |elements_per_contact_radius, skin_levels| {
        sphere_mesh(&SphereSpec {
            contact_radius: 0.2,
            elements_per_contact_radius,
            fine_zone: 1.3,
            skin_levels,
            first_layer: 1.0,
        })
        .unwrap()
    };
    let halves = [half(4, 0), half(8, 0), half(4, 1), half(4, 2)];
    let wholes = [0, 2].map(|i| whole(&halves[i]));
    let [a, b, c, d] = halves;
    let [e, f] = wholes;
    [a, b, c, d, e, f].map(Arc::new)
}

/// The largest difference over the largest number.
fn gap(pairs: impl Iterator<Item = (f32, f32)>) -> f32 {
    let (mut most, mut largest) = (0.0f32, f32::MIN_POSITIVE);
    for (ours, reference) in pairs {
        assert!(ours.is_finite() && reference.is_finite());
        most = most.max((ours - reference).abs());
        largest = largest.max(reference.abs());
    }
    most / largest
}

/// The gap between the matrices of a level. Fixed unknowns are left out: the device masks them, the
/// CPU has the identity there.
fn matrix_gap(device: &OnLevel, hierarchy: &Hierarchy, l: usize, is_fixed: &dyn Fn(usize, usize) -> bool) -> f32 {
    let host = hierarchy.on_level(l).unwrap();
    let nodes = host.matrix.rows();
    let pattern = &host.matrix.pattern;
    let width = device.width;
    let mut blocks = Vec::new();
    for node in 0..nodes {
        for (k, at) in pattern.row(node).enumerate() {
            let column = pattern.column[at] as usize;
            for m in (0..9).filter(|m| !is_fixed(node, m / 3) && !is_fixed(column, m % 3)) {
                blocks.push((device.matrix[(m * width + k) * nodes + node], host.matrix.blocks[at][m]));
            }
        }
        // Rows with fewer blocks end in zeros.
        for k in pattern.row(node).len()..width {
            assert!((0..9).all(|m| device.matrix[(m * width + k) * nodes + node] == 0.0));
        }
    }
    gap(blocks.into_iter())
}

/// Alike those of what else is compared: inverses of diagonal blocks, right-hand side, solution.
fn gaps(device: &OnLevel, hierarchy: &Hierarchy, l: usize, is_fixed: &dyn Fn(usize, usize) -> bool) -> [f32; 3] {
    let host = hierarchy.on_level(l).unwrap();
    let nodes = host.matrix.rows();
    let free: Vec<(usize, usize)> =
        (0..3).flat_map(|c| (0..nodes).map(move |node| (c, node))).filter(|&(c, node)| !is_fixed(node, c)).collect();
    // A diagonal block by itself: inverses of large and of small elements differ by far.
    let inverse = (0..nodes)
        .map(|node| {
            let both = (0..9).filter(|m| !is_fixed(node, m / 3) && !is_fixed(node, m % 3));
            gap(both.map(|m| (device.inverse[m * nodes + node], host.inverse[node][m % 3][m / 3])))
        })
        .fold(0.0, f32::max);
    let vector = |ours: &[f32], theirs: &[[f32; 4]]| gap(free.iter().map(|&(c, node)| (ours[c * nodes + node], theirs[node][c])));
    [inverse, vector(&device.b, host.b), vector(&device.x, host.x)]
}

/// Gives a level of the host's the matrix of the device's, which differs by rounding. A number in
/// the middle of two of bf16 may be rounded to either by that, and the V-cycle's solution moves by
/// up to 3e-5; with the same matrix it does not.
fn take_matrix(hierarchy: &mut Hierarchy, device: &OnLevel, l: usize, is_fixed: &dyn Fn(usize, usize) -> bool) {
    hierarchy.alter_level(l, |matrix| {
        let nodes = matrix.rows();
        for node in 0..nodes {
            for (k, at) in matrix.pattern.row(node).enumerate() {
                let column = matrix.pattern.column[at] as usize;
                for m in (0..9).filter(|m| !is_fixed(node, m / 3) && !is_fixed(column, m % 3)) {
                    matrix.blocks[at][m] = device.matrix[(m * device.width + k) * nodes + node];
                }
            }
        }
    });
}

/// Every level has the CPU's matrix, and with it takes and leaves the same in a V-cycle. `between`
/// draws numbers from -1 to 1 for a seed.
pub fn every_level_has_the_cpus_matrix_and_its_v_cycle(
    context: &Arc<GpuContext>,
    numbers: Numbers,
    between: fn(u64) -> Box<dyn FnMut() -> f32>,
) {
    for mesh in meshes().into_iter().chain([down_to_one_element()]) {
        let models = models(&mesh);
        for masked in [false, true] {
            for case in 0..models.len() {
                let system = system(numbers, case, &models, masked);
                let mut gpu = Gpu::<f64>::new(context.clone(), vec![models[case].clone()]).unwrap();
                solve(&mut gpu, &[(0, &system)], 0.1);
                let solver = gpu.solver().unwrap();
                let hierarchy = Hierarchy::new(&system.matrix.pattern, &mesh.hierarchy).unwrap();
                let mut hierarchy = hierarchy.with_rounded_smoothers();
                hierarchy.update(&system.matrix, &system.fixed).unwrap();
                let nodes = mesh.nodes.len();
                let mut between = between(7 + case as u64);
                let v: Vec<f32> = system.fixed.iter().map(|&f| if f { 0.0 } else { between() }).collect();
                let by_component: Vec<f32> = (0..3).flat_map(|c| (0..nodes).map(move |n| 3 * n + c)).map(|i| v[i]).collect();
                solver.v_cycle(context, &by_component).unwrap();
                let on_device: Vec<OnLevel> = (0..solver.depth()).map(|l| solver.on_level(context, l).unwrap()).collect();
                let is_fixed = |l: usize, node: usize, c: usize| l == 0 && system.fixed[3 * node + c];
                let matrices: Vec<f32> = (0..)
                    .zip(&on_device)
                    .map(|(l, device)| matrix_gap(device, &hierarchy, l, &|n, c| is_fixed(l, n, c)))
                    .collect();
                (0..).zip(&on_device).for_each(|(l, device)| take_matrix(&mut hierarchy, device, l, &|n, c| is_fixed(l, n, c)));
                hierarchy.v_cycle(&v, &mut vec![0.0; v.len()]);
                for (l, device) in on_device.iter().enumerate() {
                    let [inverse, b, x] = gaps(device, &hierarchy, l, &|node, c| is_fixed(l, node, c));
                    let found = [matrices[l], inverse, b, x];
                    log::debug!("{nodes} nodes, case {case}, masked {masked}, level {l}: matrix, inverse, b, x {found:?}");
                    assert!(found.iter().all(|gap| *gap <= BOUND), "case {case}, masked {masked}, level {l}: {found:?}");
                }
                assert!(hierarchy.on_level(solver.depth()).is_none());
            }
        }
    }
}

/// A vector `[component][node]` as three components a node, in f64.
fn by_node(v: &[f32]) -> Vec<f64> {
    let nodes = v.len() / 3;
    (0..v.len()).map(|i| f64::from(v[(i % 3) * nodes + i / 3])).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// A x, nothing at fixed unknowns.
fn product(matrix: &BlockMatrix<f64>, fixed: &[bool], x: &[f64]) -> Vec<f64> {
    let mut y = vec![0.0; x.len()];
    matrix.multiply(x, &mut y);
    y.iter_mut().zip(fixed).filter(|(_, fixed)| **fixed).for_each(|(y, _)| *y = 0.0);
    y
}

/// The basis is orthonormal and begins with the residual; A z_j lies in the span of the first j + 2
/// vectors; the answer is the combination of the z_j that leaves the least, and as much is left as
/// the recurrence says. On half a sphere and on all of it.
pub fn a_krylov_cycle_obeys_its_equations(context: &Arc<GpuContext>) {
    for models in [mesh(), whole_mesh()].map(|mesh| models(&mesh)) {
        (0..models.len()).for_each(|case| the_cycle_of_a_case_obeys_its_equations(context, &models, case));
    }
}

fn the_cycle_of_a_case_obeys_its_equations(context: &Arc<GpuContext>, models: &[CaseModel], case: usize) {
    let system = system(own_numbers, case, models, true);
    let TestSystem { fixed, rhs, matrix, .. } = &system;
    let mut gpu = Gpu::<f64>::new(context.clone(), vec![models[case].clone()]).unwrap();
    let (_, report) = solve(&mut gpu, &[(0, &system)], 1e-4).remove(0);
    let cycle = gpu.solver().unwrap().last_cycle(context).unwrap();
    let steps = cycle.steps;
    assert!(steps == report.iterations && steps > 2, "{steps} of {}", report.iterations);
    let n = rhs.len();
    // Sides go to the device in units of a power of two near their largest number.
    let unit = rhs.iter().fold(0.0f64, |m, b| m.max(b.abs())).log2().floor().exp2();
    let rhs: Vec<f64> = rhs.iter().map(|b| b / unit).collect();
    let vectors = |all: &[f32]| all.chunks_exact(n).map(by_node).collect::<Vec<_>>();
    let (basis, preconditioned) = (vectors(&cycle.basis), vectors(&cycle.preconditioned));
    for (i, a) in basis.iter().enumerate() {
        for (j, b) in basis[..=i].iter().enumerate() {
            let expected = if i == j { 1.0 } else { 0.0 };
            assert!((dot(a, b) - expected).abs() <= 1e-5, "vectors {i} and {j}: {}", dot(a, b));
        }
    }
    let solution = by_node(&cycle.solution);
    let taken_over = product(matrix, fixed, &solution);
    let start: Vec<f64> = (0..n).map(|i| if fixed[i] { 0.0 } else { rhs[i] - taken_over[i] }).collect();
    let norm = dot(&start, &start).sqrt();
    let first = start.iter().zip(&basis[0]).fold(0.0f64, |m, (r, v)| m.max((r / norm - v).abs()));
    assert!(first <= 1e-5, "the first vector is {first:e} off");
    let images: Vec<Vec<f64>> = preconditioned.iter().map(|z| product(matrix, fixed, z)).collect();
    for (j, image) in images.iter().enumerate().take(steps - 1) {
        let mut left = image.clone();
        for v in &basis[..j + 2] {
            let share = dot(&left, v);
            left.iter_mut().zip(v).for_each(|(l, v)| *l -= share * v);
        }
        let share = (dot(&left, &left) / dot(image, image)).sqrt();
        assert!(share <= 1e-5, "A z of step {j} has {share:e} outside of the basis");
    }
    // The residual is orthogonal to what could still be taken from it.
    let mut answer = solution.clone();
    for (z, &c) in preconditioned.iter().zip(&cycle.combination) {
        answer.iter_mut().zip(z).for_each(|(x, z)| *x += f64::from(c) * z);
    }
    let size = answer.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    let told = by_node(&cycle.answer);
    assert!(answer.iter().zip(&told).all(|(a, b)| (a - b).abs() <= 1e-5 * size), "the combination");
    let image = product(matrix, fixed, &told);
    let left: Vec<f64> = (0..n).map(|i| if fixed[i] { 0.0 } else { rhs[i] - image[i] }).collect();
    let what_is_left = dot(&left, &left).sqrt();
    for (j, image) in images.iter().enumerate() {
        let share = dot(&left, image) / (norm * dot(image, image).sqrt());
        assert!(share.abs() <= 1e-5, "{share:e} of the first residual could still be taken along A z of step {j}");
    }
    let missing = (what_is_left - f64::from(cycle.residual)).abs() / norm;
    log::debug!("case {case}: {steps} steps, left {what_is_left:.3e} of {norm:.3e}, recurrence {:.3e}", cycle.residual);
    assert!(missing <= 1e-5, "left {what_is_left:e}, and {:e} by the recurrence, of {norm:e}", cycle.residual);
}

//! The linear solver at the default size: product, update, V-cycle, whole solves. `cargo
//! bench --bench linalg`.

#![allow(missing_docs)]

use asperity::internals::linalg::{BlockMatrix, Hierarchy, LinearSolver, Pattern, SolverKind};
use asperity::internals::mesh::quality::CORNERS;
use asperity::internals::mesh::sphere::{SphereSpec, sphere_mesh};
use asperity::internals::mesh::{Mesh, Prolongation};
use criterion::{Criterion, criterion_group, criterion_main};

// The tests use more of it.
#[allow(dead_code)]
#[path = "../crates/kernels/src/linalg/tests/problem.rs"]
mod problem;

fn linalg(criterion: &mut Criterion) {
    let spec =
        SphereSpec { contact_radius: 0.2, elements_per_contact_radius: 16, fine_zone: 1.5, skin_levels: 0, first_layer: 1.0 };
    let problem = problem::Brick::slipping(24).on(&sphere_mesh(&spec).unwrap());
    let n = problem.rhs.len();
    let mut group = criterion.benchmark_group(format!("linalg {n} unknowns, {} threads", rayon::current_num_threads()));
    group.sample_size(20);

    let wide: Vec<f64> = (0..n).map(|i| (i as f64).sin()).collect();
    let narrow: Vec<f32> = wide.iter().map(|&x| x as f32).collect();
    let single = BlockMatrix {
        pattern: problem.matrix.pattern.clone(),
        blocks: problem.matrix.blocks.iter().map(|b| b.map(|a| a as f32)).collect(),
    };
    let (mut y, mut y32) = (vec![0.0; n], vec![0.0f32; n]);
    group.bench_function("product f64", |b| b.iter(|| problem.matrix.multiply(&wide, &mut y)));
    group.bench_function("product f32", |b| b.iter(|| single.multiply(&narrow, &mut y32)));
    group.bench_function("product f32 matrix, f64 sums", |b| b.iter(|| single.multiply(&narrow, &mut y)));

    let mut hierarchy = Hierarchy::new(&problem.matrix.pattern, &problem.prolongations).unwrap();
    hierarchy.update(&problem.matrix, &problem.fixed).unwrap();
    group.bench_function("V-cycle", |b| b.iter(|| hierarchy.v_cycle(&wide, &mut y32)));

    let mut solver = LinearSolver::new(SolverKind::Multigrid, &problem.matrix.pattern, &problem.prolongations).unwrap();
    group.bench_function("update", |b| b.iter(|| solver.update(&problem.matrix, &problem.fixed).unwrap()));
    for tolerance in [1e-2, 1e-3] {
        let mut x = vec![0.0; n];
        group.bench_function(format!("solve to {tolerance}"), |b| {
            b.iter(|| {
                x.fill(0.0);
                solver.solve(&problem.rhs, tolerance, &mut x).unwrap()
            })
        });
    }
    group.finish();
}

criterion_group!(benches, linalg);
criterion_main!(benches);

//! CPU times of the kernels on this thread (they are what counts where cases run side by side). Printed, not judged.

use super::problem::Brick;
use super::*;
use crate::mesh::sphere::{SphereSpec, sphere_mesh};

/// CPU seconds of this thread so far.
pub fn cpu_seconds() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    text.split(' ').next().and_then(|ns| ns.parse::<f64>().ok()).unwrap_or(0.0) * 1e-9
}

/// The least mean CPU time of `count` calls in three attempts (the clock ticks every 4 ms).
fn least(count: usize, mut call: impl FnMut()) -> f64 {
    let mut attempt = || {
        let start = cpu_seconds();
        (0..count).for_each(|_| call());
        (cpu_seconds() - start) / count as f64
    };
    attempt().min(attempt()).min(attempt())
}

#[test]
#[ignore = "prints times"]
fn kernels() {
    let spec = SphereSpec { contact_radius: 0.2, elements_per_contact_radius: 16, fine_zone: 1.5 };
    let problem = Brick::slipping(1).on(&sphere_mesh(&spec).unwrap());
    let n = problem.rhs.len();
    let wide: Vec<f64> = (0..n).map(|i| (i as f64).sin()).collect();
    let narrow: Vec<f32> = wide.iter().map(|&x| x as f32).collect();
    let pattern = problem.matrix.pattern.clone();
    println!("{n} unknowns, {} blocks", pattern.entries());
    let single =
        BlockMatrix { pattern: pattern.clone(), blocks: problem.matrix.blocks.iter().map(|b| b.map(|a| a as f32)).collect() };
    let (mut y, mut y32) = (vec![0.0; n], vec![0.0f32; n]);
    println!("product f64      {:.2} ms", 1e3 * least(60, || problem.matrix.multiply(&wide, &mut y)));
    println!("product f64*f32  {:.2} ms", 1e3 * least(60, || problem.matrix.multiply(&narrow, &mut y)));
    println!("product f32      {:.2} ms", 1e3 * least(60, || single.multiply(&narrow, &mut y32)));
    println!("product f32>f64  {:.2} ms", 1e3 * least(60, || single.multiply(&narrow, &mut y)));
    let mut copy = problem.matrix.clone();
    println!("copy             {:.2} ms", 1e3 * least(10, || copy.blocks.copy_from_slice(&problem.matrix.blocks)));
    {
        let start = cpu_seconds();
        let mut hierarchy = Hierarchy::new(&pattern, &problem.prolongations).unwrap();
        println!("set-up {:.1} ms, levels {:?}", 1e3 * (cpu_seconds() - start), hierarchy.sizes());
        println!("  update         {:.2} ms", 1e3 * least(10, || hierarchy.update(&problem.matrix, &problem.fixed).unwrap()));
        println!("  V-cycle        {:.2} ms", 1e3 * least(30, || hierarchy.v_cycle(&wide, &mut y32)));
        let mut solver = LinearSolver::new(SolverKind::Multigrid, &pattern, &problem.prolongations).unwrap();
        solver.update(&problem.matrix, &problem.fixed).unwrap();
        for tolerance in [1e-2, 1e-3] {
            let mut iterations = 0;
            let time = least(5, || iterations = solver.solve(&problem.rhs, tolerance, &mut vec![0.0; n]).unwrap().iterations);
            println!(
                "  solve to {tolerance:.0e} {:.1} ms, {iterations} iterations, {:.2} ms each",
                1e3 * time,
                1e3 * time / iterations as f64
            );
        }
    }
}

#[test]
#[ignore = "prints times"]
fn direct() {
    for per_radius in [8, 12, 16] {
        let spec = SphereSpec { contact_radius: 0.2, elements_per_contact_radius: per_radius, fine_zone: 1.5 };
        let problem = Brick::slipping(1).on(&sphere_mesh(&spec).unwrap());
        let start = cpu_seconds();
        let memory = super::super::DirectSolver::new(&problem.matrix.pattern).memory();
        let order = cpu_seconds() - start;
        let mut solver = LinearSolver::new(SolverKind::Direct, &problem.matrix.pattern, &[]).unwrap();
        let start = cpu_seconds();
        solver.update(&problem.matrix, &problem.fixed).unwrap();
        let update = cpu_seconds() - start - order;
        let start = cpu_seconds();
        let report = solver.solve(&problem.rhs, 1e-10, &mut vec![0.0; problem.rhs.len()]).unwrap();
        println!(
            "{} unknowns: {} MB, order {order:.2} s, factors {update:.2} s, solve {:.3} s {report:?}",
            problem.rhs.len(),
            memory >> 20,
            cpu_seconds() - start
        );
    }
}

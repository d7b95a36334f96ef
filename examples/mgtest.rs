use asperity::compute::{cpu::Cpu, handle::*, *};
use asperity::linalg::{bsr::*, *};
use asperity::material::*;
use asperity::mesh::sphere::*;
use std::sync::Arc;
fn main() {
    let epr: usize = std::env::args().nth(1).unwrap().parse().unwrap();
    for a in [0.3, 0.2, 0.1, 0.05, 0.02, 0.01] {
        let mesh =
            Arc::new(sphere_mesh(&SphereSpec { contact_radius: a, elements_per_contact_radius: epr, fine_zone: 1.3 }).unwrap());
        let mut maxaspect = 0.0f64;
        for e in &mesh.elements {
            let x: Vec<[f64; 3]> = e.iter().map(|&n| mesh.nodes[n as usize]).collect();
            let d = |a: usize, b: usize| {
                ((x[a][0] - x[b][0]).powi(2) + (x[a][1] - x[b][1]).powi(2) + (x[a][2] - x[b][2]).powi(2)).sqrt()
            };
            let l = [d(0, 1), d(0, 3), d(0, 4)];
            let mx = l.iter().fold(0.0f64, |m, v| m.max(*v));
            let mn = l.iter().fold(1e9f64, |m, v| m.min(*v));
            maxaspect = maxaspect.max(mx / mn);
        }
        let model = CaseModel {
            mesh: mesh.clone(),
            material: Material { elasticity: Elasticity::new(1.0, 0.3), hardening: Hardening::Elastic },
            friction: asperity::contact::coulomb::Friction::Stick,
        };
        let mut cpu: Cpu<f64> = Cpu::new(vec![model]).unwrap();
        let n = 3 * mesh.nodes.len();
        let pattern = Pattern::from_elements(mesh.nodes.len(), &mesh.elements);
        let mut k = BlockMatrix::zeros(pattern.clone());
        let mut h = CaseHandle { backend: &mut cpu, case: 0 };
        h.tangent(&vec![0.0; n], &mut k.blocks).unwrap();
        let mut fixed = vec![false; n];
        for &i in &mesh.plate_nodes {
            for c in 0..3 {
                fixed[3 * i as usize + c] = true;
            }
        }
        for &i in &mesh.symmetry_nodes {
            fixed[3 * i as usize + 1] = true;
        }
        for (free, name) in [(true, "free"), (false, "contact")] {
            if !free {
                for &i in &mesh.contact_nodes {
                    let x = mesh.nodes[i as usize];
                    if x[0].hypot(x[1]) < a {
                        fixed[3 * i as usize + 2] = true;
                    }
                }
            }
            let mut rhs = vec![0.0; n];
            if free {
                for (i, &c) in mesh.contact_nodes.iter().enumerate() {
                    rhs[3 * c as usize + 2] = mesh.contact_area[i];
                }
            } else {
                for &i in &mesh.plate_nodes {
                    rhs[3 * i as usize + 2] = -1.0;
                }
            }
            let mut s = LinearSolver::new(SolverKind::Multigrid, &pattern, &mesh.hierarchy).unwrap();
            let t = std::time::Instant::now();
            s.update(&k, &fixed).unwrap();
            let tu = t.elapsed().as_secs_f64();
            for tol in [1e-1, 1e-2, 1e-3] {
                let mut x = vec![0.0; n];
                let t = std::time::Instant::now();
                let r = s.solve(&rhs, tol, &mut x);
                println!(
                    "a {a} n {n} aspect {maxaspect:.1} {name} tol {tol} update {tu:.3} solve {:.3} {r:?}",
                    t.elapsed().as_secs_f64()
                );
            }
        }
    }
}

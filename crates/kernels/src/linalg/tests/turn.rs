//! Bodies folded by a half turn.

use super::problem::Brick;
use super::{BlockMatrix, Hierarchy, Mesh, Pattern};
use crate::linalg::fold::{Folding, Parity};
use crate::linalg::turn::Turn;
use crate::mesh::{SphereSpec, sphere_mesh, whole};

/// All of the lower hemisphere, and where the half turn takes each of its nodes.
fn hemisphere(skin_levels: usize) -> (Mesh, Vec<u32>) {
    let spec = SphereSpec { contact_radius: 0.2, elements_per_contact_radius: 3, fine_zone: 1.3, skin_levels, first_layer: 1.0 };
    let mesh = whole(&sphere_mesh(&spec).unwrap());
    let place = |x: [f64; 3]| mesh.nodes.iter().position(|y| *y == [0.0 - x[0], 0.0 - x[1], x[2]]).unwrap() as u32;
    let turned = mesh.nodes.iter().map(|&x| place(x)).collect();
    (mesh, turned)
}

/// Numbers between -1 and 1 that have no pattern.
fn scattered(i: usize) -> f64 {
    (1.7 * i as f64 + 0.3).sin() * 43758.5453 % 1.0
}

/// Sign that a component has after the half turn.
fn sign(parity: Parity, component: usize) -> f64 {
    if (component == 2) == (parity == Parity::Even) { 1.0 } else { -1.0 }
}

/// The part of a vector that is even or odd.
fn part(parity: Parity, v: &[f64], turned: &[u32]) -> Vec<f64> {
    (0..v.len()).map(|i| 0.5 * (v[i] + sign(parity, i % 3) * v[3 * turned[i / 3] as usize + i % 3])).collect()
}

#[test]
fn a_matrix_that_is_folded_gives_what_is_even_or_odd_of_the_whole_ones_forces() {
    let (mesh, turned) = hemisphere(0);
    let half = mesh.half.as_ref().unwrap();
    let pattern = Pattern::from_elements(mesh.nodes.len(), &mesh.elements);
    let mut whole = BlockMatrix::<f32>::zeros(pattern);
    whole.blocks.as_flattened_mut().iter_mut().enumerate().for_each(|(i, a)| *a = scattered(i) as f32);
    let mut turn = Turn::new(&whole.pattern, &half.node, &turned).unwrap();
    // Twice: nothing is left of the matrix before.
    for _ in 0..2 {
        turn.update(&whole);
    }
    let place: std::collections::HashMap<u32, usize> = half.node.iter().enumerate().map(|(a, &n)| (n, a)).collect();
    for parity in Parity::ALL {
        let u = part(parity, &(0..whole.unknowns()).map(|i| scattered(7 * i)).collect::<Vec<_>>(), &turned);
        let z: Vec<f32> = (0..3 * half.node.len()).map(|i| u[3 * half.node[i / 3] as usize + i % 3] as f32).collect();
        let mut unfolded = vec![0.0; u.len()];
        turn.unfold_add(parity, &z, &mut unfolded);
        assert!(unfolded.iter().zip(&u).all(|(a, b)| (a - b).abs() < 1e-7), "{parity:?}: the field is that of its half");
        let mut f = vec![0.0; u.len()];
        whole.multiply(&u, &mut f);
        let (mut expected, mut got) = (vec![0.0f32; z.len()], vec![0.0f64; z.len()]);
        turn.fold(parity, &f, &mut expected);
        turn.matrix().multiply(&z, &mut got);
        for (a, &[own, other]) in turn.nodes().iter().enumerate() {
            // Of two nodes that are tied the sum is what counts.
            let tied = place.get(&other).copied();
            for c in (0..3).filter(|&c| turn.is_free(parity, a, c)) {
                let sum = |f: &dyn Fn(usize) -> f64| match tied {
                    Some(b) => f(3 * a + c) + sign(parity, c) * f(3 * b + c),
                    None => f(3 * a + c),
                };
                let [got, expected] = [sum(&|i| got[i]), sum(&|i| f64::from(expected[i]))];
                assert!((got - expected).abs() < 2e-5, "{parity:?} node {own}: {got} {expected}");
            }
        }
    }
}

/// What is even or odd of an elastic body's displacements is found by V-cycles on half of it, as
/// fast as others are.
#[test]
fn cycles_on_half_of_a_body_solve_for_what_is_even_and_what_is_odd() {
    for skin_levels in [0, 1] {
        let (mesh, turned) = hemisphere(skin_levels);
        let half = mesh.half.as_ref().unwrap();
        let problem = Brick::elastic(1).on(&mesh);
        let mut whole = BlockMatrix::<f32>::zeros(problem.matrix.pattern.clone());
        whole.blocks.iter_mut().zip(&problem.matrix.blocks).for_each(|(to, from)| *to = from.map(|a| a as f32));
        let mut turn = Turn::new(&whole.pattern, &half.node, &turned).unwrap();
        turn.update(&whole);
        for parity in Parity::ALL {
            let free = |i: usize| turn.is_free(parity, i / 3, i % 3) && !problem.fixed[3 * half.node[i / 3] as usize + i % 3];
            let fixed: Vec<bool> = (0..3 * half.node.len()).map(|i| !free(i)).collect();
            let hierarchy = Hierarchy::new(&turn.matrix().pattern, &half.hierarchy).unwrap();
            let mut hierarchy = hierarchy.with_ties(turn.ties(parity), &half.hierarchy);
            hierarchy.update(turn.matrix(), &fixed).unwrap();
            let scattered = (0..whole.unknowns()).map(|i| if problem.fixed[i] { 0.0 } else { scattered(i) });
            let b = part(parity, &scattered.collect::<Vec<_>>(), &turned);
            let (mut u, mut r) = (vec![0.0; b.len()], b.clone());
            let norm = |r: &[f64]| r.iter().map(|r| r * r).sum::<f64>().sqrt();
            let mut before = norm(&r);
            for cycle in 0..12 {
                let (mut load, mut z) = (vec![0.0f32; fixed.len()], vec![0.0f32; fixed.len()]);
                turn.fold(parity, &r, &mut load);
                load.iter_mut().zip(&fixed).filter(|(_, fixed)| **fixed).for_each(|(load, _)| *load = 0.0);
                hierarchy.v_cycle(&load, &mut z);
                turn.unfold_add(parity, &z, &mut u);
                problem.matrix.residual(&u, &b, &mut r);
                r.iter_mut().zip(&problem.fixed).filter(|(_, fixed)| **fixed).for_each(|(r, _)| *r = 0.0);
                let now = norm(&r);
                assert!(now < 0.6 * before, "{parity:?}, {skin_levels} levels of skin, cycle {cycle}: {}", now / before);
                before = now;
            }
            assert!(before < 1e-4 * norm(&b), "{parity:?}, {skin_levels}: {}", before / norm(&b));
        }
    }
}

#[test]
fn sides_that_touch_cannot_be_folded() {
    let (mesh, turned) = hemisphere(0);
    let half = mesh.half.as_ref().unwrap();
    let pattern = Pattern::from_elements(mesh.nodes.len(), &mesh.elements);
    let mut rows: Vec<Vec<u32>> = (0..mesh.nodes.len()).map(|i| pattern.column[pattern.row(i)].to_vec()).collect();
    let right = (0..turned.len()).find(|&n| mesh.nodes[n][0] > 0.0).unwrap();
    rows[right].push(turned[right]);
    rows[right].sort_unstable();
    assert!(Turn::new(&Pattern::from_rows(rows.into_iter()), &half.node, &turned).is_none());
}

//! Deformations that no element can have are reported, not computed with.

use super::*;
use crate::element::hex8::{Invalid, PAIRS, fields, tangent};

/// Every entry point must refuse this displacement.
fn refused(g: &ElementGeometry<f64>, m: &Material<f64>, u: &Nodal<f64>) -> Vec<Option<Invalid>> {
    let s = ElementState::default();
    let mut k = [[0.0; 9]; PAIRS];
    vec![
        internal_force(g, m, &s.points, &ZERO, u).err(),
        tangent(g, m, &s.points, &ZERO, u, &mut k).err(),
        update(g, m, &s, &s.points, &ZERO, u).err(),
        fields(g, m, &s.points, u).err(),
    ]
}

#[test]
fn inverted_collapsed_and_meaningless_deformations_are_refused() {
    let (nodes, g) = (irregular(), geometry());
    let mirrored = nodes.map(|x| [0.0, 0.0, -2.0 * x[2]]);
    let flat = nodes.map(|x| [0.0, 0.0, -x[2]]);
    // One corner pushed through the element to the opposite side: some points only.
    let mut pushed = ZERO;
    pushed[6] = [-1.6, -1.9, -1.4];
    let mut bad: Vec<(&str, Nodal<f64>)> = vec![("mirrored", mirrored), ("flat", flat), ("pushed", pushed)];
    for (name, x) in [("NaN", f64::NAN), ("infinite", f64::INFINITY)] {
        let mut u = ZERO;
        u[3][1] = x;
        bad.push((name, u));
    }
    for material in [elastic(), hardening()] {
        for (name, u) in &bad {
            let got = refused(&g, &material, u);
            assert!(got.iter().all(Option::is_some), "{name}: {got:?}");
        }
    }
    // The first of the inverted points is named.
    assert_eq!(refused(&g, &elastic(), &pushed), vec![Some(Invalid::Inverted(2)); 4]);
    assert_eq!(refused(&g, &elastic(), &wild(1, 0.2)), vec![None; 4], "a decent deformation is not");
}

#[test]
fn the_same_in_single_precision() {
    let g = ElementGeometry::<f32>::new(&irregular()).unwrap();
    let m = hardening().cast::<f32>();
    let zero = [[0.0_f32; 3]; NODES];
    for x in [f32::NAN, f32::INFINITY, 1e30, -3.0] {
        let mut u = zero;
        u[6] = [x; 3];
        assert!(internal_force(&g, &m, &ElementState::default().points, &zero, &u).is_err(), "{x}");
    }
}

#[test]
fn an_inverted_reference_shape_is_refused_where_it_is_inverted() {
    let mut nodes = irregular();
    assert!(ElementGeometry::<f64>::new(&nodes).is_ok());
    nodes.swap(0, 6);
    assert!(ElementGeometry::<f64>::new(&nodes).is_err());
    let mut nodes = irregular();
    nodes[2][0] = f64::NAN;
    assert!(ElementGeometry::<f64>::new(&nodes).is_err());
    let flat = irregular().map(|x| [x[0], x[1], 0.0]);
    assert_eq!(ElementGeometry::<f64>::new(&flat).err(), Some(Invalid::Inverted(0)));
}

//! The kernels in f32 against themselves in f64: only the rounding of f32 may lie between them, at
//! small strains too.

use super::*;
use crate::element::hex8::{PAIRS, tangent};

fn single(u: &Nodal<f64>) -> Nodal<f32> {
    u.map(|x| x.map(|v| v as f32))
}

fn double(u: &Nodal<f32>) -> Nodal<f64> {
    u.map(|x| x.map(f64::from))
}

#[test]
fn forces_and_tangents_keep_their_digits_in_f32() {
    let (g64, g32) = (geometry(), ElementGeometry::<f32>::new(&irregular()).unwrap());
    for material in [elastic(), hardening()] {
        let m32 = material.cast::<f32>();
        for amplitude in [1e-5, 1e-3, 0.1] {
            let (state, committed) =
                if material.hardening == FlowStress::Elastic { (ElementState::default(), ZERO) } else { loaded(&g64, &material) };
            // The inputs are the rounded ones for both, so that the difference is that of the
            // arithmetic.
            let (state32, committed32) = (cast_state::<f32>(&state), single(&committed));
            let state64 = ElementState {
                points: state32
                    .points
                    .map(|p| crate::material::PointState { be: p.be.map(f64::from), alpha: f64::from(p.alpha) }),
                ..ElementState::default()
            };
            let committed64 = double(&committed32);
            let increment32 = single(&wild(8, amplitude));
            let increment64 = double(&increment32);
            let f64_ = force(&g64, &material, &state64, &committed64, &increment64);
            let f32_ = double(&internal_force(&g32, &m32, &state32.points, &committed32, &increment32).unwrap());
            let error = largest(&plus(&f32_, &f64_, -1.0)) / largest(&f64_);
            assert!(error < 5e-6, "force at amplitude {amplitude}: {error:e}");
            let (mut k64, mut k32) = ([[0.0; 9]; PAIRS], [[0.0_f32; 9]; PAIRS]);
            tangent(&g64, &material, &state64.points, &committed64, &increment64, &mut k64).unwrap();
            tangent(&g32, &m32, &state32.points, &committed32, &increment32, &mut k32).unwrap();
            let scale = k64.iter().flatten().fold(0.0_f64, |m, x| m.max(x.abs()));
            let error =
                k64.iter().flatten().zip(k32.iter().flatten()).fold(0.0_f64, |m, (a, b)| m.max((a - f64::from(*b)).abs()))
                    / scale;
            // A point within rounding of yielding may take the other branch: none does here.
            assert!(error < 5e-6, "tangent at amplitude {amplitude}: {error:e}");
        }
    }
}

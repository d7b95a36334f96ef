//! A batch as a whole: what a case gets depends neither on the others, nor on the run, nor on how
//! scratch memory cuts the batch up.

use crate::compute::handle::CaseHandle;
use crate::compute::{CaseModel, Compute};
use crate::conformance::batch::{Backend, commits, displaced, forces, models, models_of_whole, random, tangents};
use crate::real::Real;

/// Nothing is bounded: bits are compared.
pub struct Bounds;

impl Bounds {
    /// For a backend in f64.
    pub const F64: Self = Self;
    /// For one in f32.
    pub const F32: Self = Self;
}

/// Elements of the boxes.
pub const CELLS: [usize; 3] = [3, 2, 2];

/// The bits of everything that two steps leave.
pub fn bits(backend: &mut dyn Compute, steps: &[Vec<(usize, Vec<f64>)>]) -> Vec<Vec<u64>> {
    let mut out = vec![Vec::new(); steps[0].len()];
    let mut push = |case: usize, values: &[f64]| out[case].extend(values.iter().map(|v| v.to_bits()));
    for step in steps {
        let (f, k, e) = (forces(backend, step), tangents(backend, step), commits(backend, step));
        for (i, (case, _)) in step.iter().enumerate() {
            push(i, &f[i].1);
            push(i, k[i].1.as_flattened());
            push(i, &[e[i].1.elastic, e[i].1.plastic, e[i].1.max_alpha]);
            let state = CaseHandle { backend, case: *case }.state().unwrap();
            push(i, &state.plastic_work);
            state.points.iter().flatten().for_each(|p| push(i, &[p.be[0], p.be[1], p.be[3], p.alpha]));
        }
    }
    out
}

/// Two steps of every case of a batch.
pub fn steps<R: Real>(models: &[CaseModel]) -> Vec<Vec<(usize, Vec<f64>)>> {
    let nodes = models[0].mesh.nodes.len();
    let mut rng = random(100);
    let first: Vec<_> = (0..models.len()).map(|case| (case, displaced::<R>(&vec![0.0; 3 * nodes], 1e-2, &mut rng))).collect();
    let second = first.iter().map(|(case, u)| (*case, displaced::<R>(u, 1e-2, &mut rng))).collect();
    vec![first, second]
}

/// On boxes, and on both halves of a body.
pub fn a_batch_has_the_bits_of_its_cases_alone<R: Real, B: Backend<R>>(backend: &B, _: &Bounds) {
    [models(CELLS), models_of_whole()].iter().for_each(|models| has_the_bits_of_its_cases_alone::<R, B>(backend, models));
}

fn has_the_bits_of_its_cases_alone<R: Real, B: Backend<R>>(backend: &B, models: &[CaseModel]) {
    let steps = steps::<R>(models);
    let together = bits(backend.start(models).as_mut(), &steps);
    let again = bits(backend.start(models).as_mut(), &steps);
    assert!(together == again, "another run, other bits");
    for case in [0, 3, 6] {
        let own: Vec<_> = steps.iter().map(|step| vec![(0, step[case].1.clone())]).collect();
        let alone = bits(backend.start(&models[case..=case]).as_mut(), &own);
        assert!(alone[0] == together[case], "case {case} alone has other bits");
    }
    // some of the cases, in another order
    let part: Vec<_> = steps.iter().map(|step| [5, 1].map(|case: usize| step[case].clone()).to_vec()).collect();
    let some = bits(backend.start(models).as_mut(), &part);
    assert!(some[0] == together[5] && some[1] == together[1]);
}

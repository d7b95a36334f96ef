//! The contact conditions of points that are open, stick, slip, or sit on an edge between them,
//! against the CPU in f64.

use crate::compute::{CaseModel, Evaluated};
use crate::conformance::batch::{
    Backend, OnCpu, commits, contacts, difference, displaced, models, most_meshes, random, two_levels,
};
use crate::contact::coulomb::Status;
use crate::contact::frame::to_frame;
use crate::contact::rigid::Rigid;
use crate::real::Real;

/// How far from the reference a backend may be.
pub struct Bounds(f64);

impl Bounds {
    /// For a backend in f64.
    pub const F64: Self = Self(1e-13);
    /// For one in f32.
    pub const F32: Self = Self(1e-5);
}

const CELLS: [usize; 3] = [6, 4, 1];

/// What every third case is pressed against. Bodies are up to some twenty lengths wide, and points
/// are to come to its surface by moves of which f32 keeps the digits.
const SPHERE: Rigid = Rigid { curvature: 2e-5 };

/// The z at which a point has this gap.
fn height(surface: &Rigid, [x, y]: [f64; 2], gap: f64) -> f64 {
    let k = surface.curvature;
    // (1 + k z)^2 = (1 + k g)^2 - k^2 (x^2 + y^2)
    let change = 2.0 * gap + k * (gap * gap - x * x - y * y);
    change / (1.0 + (1.0 + k * change).sqrt())
}

/// Displacements and forces that put the contact points of a mesh into every status.
fn trials<R: Real>(model: &CaseModel, committed: &[f64], seed: u64) -> (Vec<f64>, Vec<f64>) {
    let (mesh, surface) = (&model.mesh, &model.surface);
    let mut rng = random(seed);
    let mut u = displaced::<R>(committed, 1e-3, &mut rng);
    let mut force = vec![0.0; u.len()];
    for (i, &node) in mesh.contact_nodes.iter().enumerate() {
        let base = 3 * node as usize;
        // close to the surface, on either side of it
        let gap = if i % 5 == 0 { 0.0 } else { rng.between(-1e-3, 1e-3) };
        let [x, y] = [0, 1].map(|c| mesh.nodes[node as usize][c] + u[base + c]);
        let z = mesh.nodes[node as usize][2] + committed[base + 2];
        u[base + 2] = committed[base + 2] + R::of(height(surface, [x, y], gap) - z).to_f64();
        let size = 10f64.powf(rng.between(-5.0, -3.0));
        for f in &mut force[base..base + 3] {
            *f = R::of(size * rng.between(-0.3, 1.0)).to_f64();
        }
        match i % 7 {
            0 => force[base..base + 3].fill(0.0),
            1 => (force[base], force[base + 1]) = (0.0, 0.0),
            2 => u[base..base + 2].copy_from_slice(&committed[base..base + 2]),
            _ => {}
        }
    }
    (u, force)
}

/// Rows of contact points are those of the reference, on every mesh, over a plane and a sphere.
pub fn rows_agree<R: Real, B: Backend<R>>(backend: &B, bounds: &Bounds) {
    most_meshes(CELLS).into_iter().chain([two_levels()]).for_each(|mut models| {
        models.iter_mut().skip(2).step_by(3).for_each(|model| model.surface = SPHERE);
        rows_agree_on::<R, B>(backend, bounds, &models);
    });
}

fn rows_agree_on<R: Real, B: Backend<R>>(backend: &B, bounds: &Bounds, models: &[CaseModel]) {
    let (mut ours, mut reference) = (backend.start(models), <OnCpu as Backend<f64>>::start(&OnCpu, models));
    let start = vec![0.0; 3 * models[0].mesh.nodes.len()];
    let committed: Vec<_> = (0..models.len()).map(|c| (c, displaced::<R>(&start, 1e-3, &mut random(80 + c as u64)))).collect();
    assert!(commits(ours.as_mut(), &committed).iter().all(|(outcome, _)| *outcome == Evaluated::Valid));
    commits(reference.as_mut(), &committed);
    let mut requests: Vec<_> = committed
        .iter()
        .map(|(case, start)| {
            let (u, force) = trials::<R>(&models[*case], start, 90 + *case as u64);
            (*case, u, force)
        })
        .collect();
    // one case after another, and one of them twice in a call
    requests.push(requests[2].clone());
    let (rows, expected) = (contacts(ours.as_mut(), &requests), contacts(reference.as_mut(), &requests));
    assert!(rows[2] == *rows.last().unwrap());
    let (mut counts, mut ties) = ([0; 3], 0);
    for (case, (rows, expected)) in rows.iter().zip(&expected).enumerate() {
        for (i, (a, b)) in rows.iter().zip(expected).enumerate() {
            let place = format!("{}, case {case}, point {i}: {a:?}, not {b:?}", R::NAME);
            let node = models[0].mesh.contact_nodes[i] as usize;
            let (case_index, u, force) = &requests[case];
            let force = &force[3 * node..3 * node + 3];
            // only a point that neither presses nor gapes may fall to either side
            let model = &models[*case_index];
            let x = std::array::from_fn(|c| model.mesh.nodes[node][c] + u[3 * node + c]);
            let [_, _, normal] = to_frame(&model.surface.frame(&x), &[force[0], force[1], force[2]]);
            let xi_n = normal - b.weight * model.surface.gap(&x);
            if a.status != b.status && xi_n.abs() <= bounds.0 * b.weight * 1e-3 {
                ties += 1;
                continue;
            }
            assert_eq!((a.status, a.fixed), (b.status, b.fixed), "{place}");
            let scale = force.iter().fold(b.weight * 1e-3, |m, f| m.max(f.abs()));
            for k in 0..3 {
                assert!((a.residual[k] - b.residual[k]).abs() <= bounds.0 * scale, "{place}");
                // next to a tip of the friction cone the direction of slip is ill-defined: the rows
                // there carry its error
                let slack = if b.status == Status::Slip { 1e-3 } else { 1.0 };
                assert!(difference(&a.force_rows[k], &b.force_rows[k]) <= bounds.0 / slack, "{place}");
                assert!(difference(&a.displacement_rows[k], &b.displacement_rows[k]) <= bounds.0 / slack, "{place}");
            }
            assert!((a.weight / b.weight - 1.0).abs() <= bounds.0, "{place}");
            counts[a.status as usize] += 1;
        }
    }
    // Every 35th point has neither force nor gap.
    let few = 28 * ties < rows.iter().flatten().count();
    assert!(counts.iter().all(|&n| n > 20) && few, "{counts:?}, {ties} ties: the test tests nothing");
}

/// A force that is not a number must not pass for a point at rest.
pub fn nan_is_not_swallowed<R: Real, B: Backend<R>>(backend: &B, _: &Bounds) {
    let models = models(CELLS);
    let mut ours = backend.start(&models);
    let mesh = &models[0].mesh;
    let u = vec![0.0; 3 * mesh.nodes.len()];
    let mut force = vec![1e-4; u.len()];
    let node = 3 * mesh.contact_nodes[3] as usize;
    force[node + 2] = f64::NAN;
    force[3 * mesh.contact_nodes[8] as usize] = f64::NAN;
    let rows = contacts(ours.as_mut(), &[(0, u, force)]).remove(0);
    for i in [3, 8] {
        let numbers = rows[i].residual.iter().chain(rows[i].force_rows.iter().flatten());
        assert!(rows[i].status == Status::Open || numbers.clone().any(|x| x.is_nan()) || rows[i].fixed[2], "{:?}", rows[i]);
    }
    assert!(rows[8].residual.iter().any(|r| r.is_nan()), "{:?}", rows[8]);
}

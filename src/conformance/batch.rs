//! Batches of cases for the conformance bodies, and who evaluates them.

use crate::compute::cpu::Cpu;
use crate::compute::gpu::{DeviceReal, Gpu, GpuContext};
use crate::compute::handle::at_contact;
use crate::compute::{Answer, Call, CaseModel, Compute, Energies, Evaluated, TangentBlocks};
use crate::contact::coulomb::{Friction, Rows};
use crate::contact::rigid::Rigid;
use crate::material::{Elasticity, FlowStress, Material};
use crate::mesh::brick::brick;
use crate::mesh::couple::{couple, scaled};
use crate::mesh::{Mesh, SphereSpec, flat_mesh, whole};
use crate::random::Seeded;
use crate::real::Real;
use std::sync::Arc;

/// Who evaluates a batch.
pub trait Backend<R> {
    /// A batch of cases in their virgin state.
    fn start(&self, models: &[CaseModel]) -> Box<dyn Compute>;
}

/// The CPU.
pub struct OnCpu;
/// A device.
pub struct OnGpu(pub Arc<GpuContext>);

impl<R: Real> Backend<R> for OnCpu {
    fn start(&self, models: &[CaseModel]) -> Box<dyn Compute> {
        Box::new(Cpu::<R>::new(models.to_vec()).unwrap())
    }
}

impl<R: DeviceReal> Backend<R> for OnGpu {
    fn start(&self, models: &[CaseModel]) -> Box<dyn Compute> {
        Box::new(Gpu::<R>::new(self.0.clone(), models.to_vec()).unwrap())
    }
}

/// Numbers of a seed.
pub fn random(seed: u64) -> Seeded {
    Seeded::new(seed)
}

/// A box of distorted elements, each about 0.3 wide.
pub fn distorted(cells: [usize; 3], seed: u64) -> Arc<Mesh> {
    let mut rng = random(seed);
    let mut mesh = brick(cells[0], cells[1], cells[2], cells.map(|n| 0.3 * n as f64)).unwrap();
    for x in &mut mesh.nodes {
        x.iter_mut().for_each(|x| *x += rng.between(-0.04, 0.04));
    }
    Arc::new(mesh)
}

/// Half a flat whose elements at the surface are halved so many times again, with corners that hang
/// where sizes meet; the smallest elements are about 0.3 wide and all are distorted.
pub fn with_skin(levels: usize, seed: u64) -> Arc<Mesh> {
    distorted_flat(half_flat(levels), seed)
}

fn half_flat(skin_levels: usize) -> Mesh {
    flat_mesh(&SphereSpec { contact_radius: 0.3, elements_per_contact_radius: 3, fine_zone: 1.1, skin_levels, first_layer: 1.0 })
        .unwrap()
}

fn distorted_flat(mesh: Mesh, seed: u64) -> Arc<Mesh> {
    let edge = |a: [f64; 3], b: [f64; 3]| (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt();
    let edges = (0..mesh.elements.len()).map(|e| mesh.corners(e)).flat_map(|x| [1, 3, 4].map(|b| edge(x[0], x[b])));
    let shortest = edges.fold(f64::INFINITY, f64::min);
    let mut mesh = scaled(mesh, 0.3 / shortest);
    let mut rng = random(seed);
    for x in &mut mesh.nodes {
        x.iter_mut().for_each(|x| *x += rng.between(-0.02, 0.02));
    }
    assert!(mesh.hanging.iter().any(|hanging| !hanging.is_none()));
    Arc::new(mesh)
}

/// The batches of every test of the element, but for [`two_levels`]: on boxes, where corners hang
/// by one level, and on both halves of a body, where they hang too.
pub fn most_meshes(cells: [usize; 3]) -> [Vec<CaseModel>; 3] {
    [models(cells), models_on([1, 2].map(|seed| with_skin(1, seed))), models_of_whole()]
}

/// The batch where corners hang by two levels: most of a test's time on a software driver.
pub fn two_levels() -> Vec<CaseModel> {
    models_on([1, 2].map(|seed| with_skin(2, seed)))
}

/// One law of every kind on both halves of a body, without a plane of symmetry.
pub fn models_of_whole() -> Vec<CaseModel> {
    models_on([1, 2].map(|seed| distorted_flat(whole(&half_flat(1)), seed)))
}

/// One law of every kind on boxes.
pub fn models(cells: [usize; 3]) -> Vec<CaseModel> {
    models_on([1, 2].map(|seed| distorted(cells, seed)))
}

/// One law of every kind (E = 1), on meshes of one connectivity; the first and third share theirs.
pub fn models_on(meshes: [Arc<Mesh>; 2]) -> Vec<CaseModel> {
    let laws = [
        Ok(FlowStress::Elastic),
        FlowStress::ideal(2e-3),
        FlowStress::linear(2e-3, 0.05),
        FlowStress::power(2e-3, 0.01, 0.3),
        FlowStress::hollomon(0.01, 5.0, 1.0),
        FlowStress::voce(2e-3, 6e-3, 20.0),
        FlowStress::table(&[[0.0, 2e-3], [0.01, 3e-3], [0.03, 3.5e-3], [0.2, 5e-3]]),
    ];
    let frictions = [Friction::Coulomb(0.3), Friction::Stick, Friction::Coulomb(0.0), Friction::Coulomb(0.6)];
    let model = |(i, law): (usize, Result<_, _>)| CaseModel {
        mesh: meshes[i % 2].clone(),
        material: Material { elasticity: Elasticity::new(1.0, [0.3, 0.0, 0.45][i % 3]), hardening: law.unwrap() },
        friction: frictions[i % 4],
        opponent: None,
        image: None,
        surface: Rigid::default(),
    };
    laws.into_iter().enumerate().map(model).collect()
}

/// Two bodies that deform, of unlike materials, on meshes of one connectivity; and the models of
/// each body by itself.
pub fn couples(own: Vec<CaseModel>) -> (Vec<CaseModel>, [Vec<CaseModel>; 2]) {
    let opponents: Vec<_> = own.iter().cycle().skip(2).take(own.len()).cloned().collect();
    let couple = |(own, opponent): (&CaseModel, &CaseModel)| CaseModel {
        mesh: Arc::new(couple((*own.mesh).clone(), scaled((*opponent.mesh).clone(), 2.0))),
        opponent: Some(opponent.material.clone()),
        ..own.clone()
    };
    let both = own.iter().zip(&opponents).map(couple).collect();
    let larger = |model: CaseModel| CaseModel { mesh: Arc::new(scaled((*model.mesh).clone(), 2.0)), ..model };
    (both, [own, opponents.into_iter().map(larger).collect()])
}

/// A random displacement whose gradients are about `strain`, after `from`; the difference is a
/// number of precision R.
pub fn displaced<R: Real>(from: &[f64], strain: f64, rng: &mut Seeded) -> Vec<f64> {
    from.iter().map(|u| u + R::of(strain * rng.between(-0.1, 0.1)).to_f64()).collect()
}

type Displacements = [(usize, Vec<f64>)];

/// One call at displacements.
fn call(backend: &mut dyn Compute, displacements: &Displacements, call: fn(Arc<[f64]>) -> Call) -> Vec<Answer> {
    backend.call(displacements.iter().map(|(case, u)| (*case, call(u.as_slice().into()))).collect()).unwrap()
}

/// Internal forces at displacements, one answer a case.
pub fn forces(backend: &mut dyn Compute, displacements: &Displacements) -> Vec<(Evaluated, Vec<f64>)> {
    let answers = call(backend, displacements, |displacement| Call::Force { displacement });
    let force = |answer| if let Answer::Force { force, outcome } = answer { (outcome, force) } else { panic!("{answer:?}") };
    answers.into_iter().map(force).collect()
}

/// Their tangents, in f64.
pub fn tangents(backend: &mut dyn Compute, displacements: &Displacements) -> Vec<(Evaluated, Vec<[f64; 9]>)> {
    let answers =
        call(backend, displacements, |displacement| Call::Tangent { displacement, blocks: TangentBlocks::Double(Vec::new()) });
    let tangent = |answer| match answer {
        Answer::Tangent { blocks: TangentBlocks::Double(blocks), outcome } => (outcome, blocks),
        other => panic!("{other:?}"),
    };
    answers.into_iter().map(tangent).collect()
}

/// Commits them; energies of the cases.
pub fn commits(backend: &mut dyn Compute, displacements: &Displacements) -> Vec<(Evaluated, Energies)> {
    let answers = call(backend, displacements, |displacement| Call::Commit { displacement });
    let commit = |answer| match answer {
        Answer::Commit { energies, outcome } => (outcome, energies),
        other => panic!("{other:?}"),
    };
    answers.into_iter().map(commit).collect()
}

/// Contact rows at displacements with given forces.
pub fn contacts(backend: &mut dyn Compute, trials: &[(usize, Vec<f64>, Vec<f64>)]) -> Vec<Vec<Rows<f64>>> {
    let mesh = backend.models()[0].mesh.clone();
    let call = |(case, u, force): &(usize, Vec<f64>, Vec<f64>)| {
        (*case, Call::Contact { displacement: at_contact(&mesh, u), force: at_contact(&mesh, force) })
    };
    let answers = backend.call(trials.iter().map(call).collect()).unwrap();
    answers.into_iter().map(|answer| if let Answer::Contact(rows) = answer { rows } else { panic!("{answer:?}") }).collect()
}

/// Largest difference by the largest number of the reference; infinite where one is not finite.
pub fn difference<'a>(ours: impl IntoIterator<Item = &'a f64>, reference: impl IntoIterator<Item = &'a f64>) -> f64 {
    let (mut worst, mut scale) = (0.0f64, f64::MIN_POSITIVE);
    for (a, b) in ours.into_iter().zip(reference) {
        let error = (a - b).abs();
        worst = if error.is_finite() { worst.max(error) } else { f64::INFINITY };
        scale = scale.max(b.abs());
    }
    worst / scale
}

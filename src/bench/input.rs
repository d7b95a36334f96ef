//! What is evaluated: seeded, the same in every run and on every machine.

use std::sync::Arc;

use super::BenchError;
use crate::compute::CaseModel;
use crate::contact::coulomb::Friction;
use crate::contact::rigid::Rigid;
use crate::lanes::Lanes;
use crate::material::{Elasticity, FlowStress, Material, MaterialError, PointState, return_mapping};
use crate::mesh::sphere::{SphereSpec, sphere_mesh};
use crate::mesh::{Mesh, MeshError};
use crate::random::Seeded;
use crate::real::Real;

/// The hardening laws by name, at stresses of metals over E.
///
/// # Errors
/// None, unless the constants here are no law.
pub fn laws<R: Real>() -> Result<Vec<(&'static str, Material<R>)>, MaterialError> {
    let laws = [
        FlowStress::Elastic,
        FlowStress::ideal(2e-3)?,
        FlowStress::linear(2e-3, 0.05)?,
        FlowStress::power(2e-3, 5e-3, 0.3)?,
        FlowStress::hollomon(0.02, 3.0, 1.0)?,
        FlowStress::voce(2e-3, 5e-3, 20.0)?,
        FlowStress::table(&[[0.0, 2e-3], [0.01, 3e-3], [0.05, 3.5e-3], [0.3, 5e-3]])?,
    ];
    Ok(laws.map(|hardening| (hardening.law().word(), Material { elasticity: Elasticity::new(1.0, 0.3), hardening })).into())
}

/// A material point before a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BenchPoint<R> {
    /// f - I of the step, rows first.
    pub relative: [[R; 3]; 3],
    /// The committed state.
    pub state: PointState<R>,
}

/// Committed states after a random step of 1 %, and the next step of 1 % along the same direction:
/// every point yields in both, unless the law never yields.
pub fn material_points<R: Real>(material: &Material<R>, count: usize) -> Vec<BenchPoint<R>> {
    let mut random = Seeded::new(1);
    let mut points = Vec::with_capacity(count);
    let never = matches!(material.hardening, FlowStress::Elastic);
    // A step that does not yield twice is drawn again; so few are not that this ends.
    while points.len() < count {
        let relative = std::array::from_fn(|_| std::array::from_fn(|_| R::of(0.01 * random.between(-1.0, 1.0))));
        let Ok(first) = return_mapping(material, &relative, &PointState::default()) else { continue };
        let yields = |state| return_mapping(material, &relative, state).is_ok_and(|r| r.yielding);
        if never || (first.yielding && yields(&first.state)) {
            points.push(BenchPoint { relative, state: first.state });
        }
    }
    points
}

/// Eight [`BenchPoint`]s side by side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EightPoints<R> {
    /// f - I of the step, rows first.
    pub relative: [[Lanes<R>; 3]; 3],
    /// The committed state.
    pub state: PointState<Lanes<R>>,
}

/// Points in groups of eight; what is left over is left out.
pub fn side_by_side<R: Real>(points: &[BenchPoint<R>]) -> Vec<EightPoints<R>> {
    let (groups, _) = points.as_chunks::<8>();
    let eight = |p: &[BenchPoint<R>; 8]| EightPoints {
        relative: std::array::from_fn(|i| std::array::from_fn(|k| Lanes::from_fn(|q| p[q].relative[i][k]))),
        state: PointState::of_eight(&p.map(|p| p.state)),
    };
    groups.iter().map(eight).collect()
}

/// The bench's sphere: the default mesh of a contact of a fifth of the radius.
///
/// # Errors
/// [`MeshError::ElementsPerContactRadius`].
pub fn mesh(elements_per_contact_radius: usize) -> Result<Mesh, MeshError> {
    sphere_mesh(&SphereSpec {
        contact_radius: 0.2,
        elements_per_contact_radius,
        fine_zone: 1.3,
        skin_levels: 0,
        first_layer: 1.0,
    })
}

/// A batch on one connectivity, as a study has it: every case has a size, a power law and a
/// friction of its own.
///
/// # Errors
/// As [`laws`].
pub fn models(mesh: &Mesh, count: usize) -> Result<Vec<CaseModel>, BenchError> {
    let mut random = Seeded::new(2);
    let case = |_| {
        let mut mesh = mesh.clone();
        let size = random.between(0.9, 1.1);
        mesh.nodes.iter_mut().flatten().for_each(|x| *x *= size);
        let hardening = FlowStress::power(random.between(1e-3, 3e-3), random.between(3e-3, 6e-3), random.between(0.2, 0.5))?;
        let material = Material { elasticity: Elasticity::new(1.0, 0.3), hardening };
        Ok(CaseModel {
            mesh: Arc::new(mesh),
            material,
            friction: Friction::Coulomb(random.between(0.1, 0.5)),
            opponent: None,
            image: None,
            surface: Rigid::default(),
        })
    };
    (0..count).map(case).collect()
}

/// Squeezed against the plane by a strain of `strain`, and sheared by a tenth of it: from 1 % on
/// every point of [`models`] yields.
pub fn squeezed(mesh: &Mesh, strain: f64) -> Vec<f64> {
    mesh.nodes.iter().flat_map(|x| [0.1 * strain * x[2], 0.0, -strain * x[2]]).collect()
}

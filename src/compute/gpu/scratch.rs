//! What dispatches of a batch make, slot by slot, and the kernels that make it.

use super::buffers::{DeviceReal, StorageBuffer};
use super::context::GpuContext;
use super::error::GpuError;
use super::moves::Argument;
use super::pipelines::Bound;
use super::pools::{PoolBytes, Pools};
use super::resident::{Connectivity, HISTORY, Resident, Sizes};
use super::shader_sources::{
    CONTACT_POINTS, GATHER_NODE_FORCE, HEX8_BEGIN_STEP, HEX8_ENERGIES, HEX8_INTERNAL_FORCE, HEX8_JACOBIAN, HEX8_UPDATE, Kernel,
};

/// Numbers of an element's tangent in `tangent.wgsl`.
pub const ELEMENT_BLOCKS: usize = 9 * crate::element::hex8::PAIRS;
/// Components of the stresses that a force is gathered from.
pub const STRESS: usize = 9;
/// Numbers that go to a contact point: force, increment.
pub const CONTACT_TRIAL: usize = 6;
/// Numbers that come from it: residual, force rows, displacement rows.
pub const CONTACT_ANSWER: usize = 21;

/// The block that `batch.wgsl` calls Dimensions.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Dimensions {
    pub(super) cases: u32,
    pub(super) in_dispatch: u32,
    pub(super) nodes: u32,
    pub(super) elements: u32,
    pub(super) contact_points: u32,
    pub(super) blocks: u32,
    pub(super) own_elements: u32,
    pub(super) materials: u32,
}

/// What dispatches make, slot by slot.
#[derive(Debug)]
pub struct Scratch<R> {
    pub dimensions: StorageBuffer<Dimensions>,
    pub active: StorageBuffer<[u32; 2]>,
    pub increment: StorageBuffer<R>,
    pub jacobian: StorageBuffer<R>,
    pub first_invalid: StorageBuffer<u32>,
    /// Memory of what is not needed at the same time.
    pub pools: Pools,
    pub(super) stress: StorageBuffer<R>,
    pub force: StorageBuffer<R>,
    pub(super) next_history: StorageBuffer<R>,
    pub(super) point_work: StorageBuffer<R>,
    pub energies: StorageBuffer<R>,
    pub(super) contact_trial: StorageBuffer<R>,
    pub(super) contact_answer: StorageBuffer<R>,
    pub(super) contact_status: StorageBuffer<u32>,
}

impl<R: DeviceReal> Scratch<R> {
    pub fn new(context: &GpuContext, sizes: Sizes, (slots, pools): (usize, PoolBytes)) -> Result<Self, GpuError> {
        let points = sizes.points();
        let pools = Pools::new(context, pools, slots)?;
        let zeros = |what: &str, per_slot: usize| Ok::<_, GpuError>(context.zeros(what, slots * per_slot)?.each(slots));
        Ok(Self {
            dimensions: context.block("dimensions")?,
            active: context.zeros("active cases", slots)?,
            first_invalid: context.zeros("status", slots)?,
            increment: zeros("increments", 3 * sizes.nodes)?,
            jacobian: zeros("Jacobians", points)?,
            stress: pools.blocks.view("stresses", slots * STRESS * points)?.each(slots),
            force: zeros("internal forces", 3 * sizes.nodes)?,
            next_history: pools.vectors.view("new states", slots * HISTORY * points)?.each(slots),
            pools,
            point_work: zeros("energies of points", 2 * points)?,
            energies: zeros("energies of elements", 3 * sizes.elements)?,
            contact_trial: zeros("contact points", CONTACT_TRIAL * sizes.contact_points)?,
            contact_answer: zeros("contact rows", CONTACT_ANSWER * sizes.contact_points)?,
            contact_status: context.zeros("contact status", slots * sizes.contact_points)?.each(slots),
        })
    }

    /// Bytes of a slot, but for the pools.
    pub fn bytes(sizes: Sizes) -> u64 {
        let points = sizes.points();
        let all = (1 + 2) * points + 6 * sizes.nodes + 3 * sizes.elements;
        let contact = (CONTACT_TRIAL + CONTACT_ANSWER + 1) * sizes.contact_points;
        ((all + contact + 16) * size_of::<R>()) as u64
    }
}

/// The kernels bound to a group of cases.
#[derive(Debug)]
pub struct Kernels {
    pub(super) jacobian: Bound,
    pub(super) internal_force: Bound,
    pub(super) node_force: Bound,
    pub(super) begin_step: Bound,
    pub(super) update: Bound,
    pub(super) energies: Bound,
    pub(super) contact: Bound,
}

impl Kernels {
    pub fn new<R: DeviceReal>(c: &GpuContext, mesh: &Connectivity, r: &Resident<R>, s: &Scratch<R>) -> Result<Self, GpuError> {
        let shape = [s.dimensions.binding(), s.active.binding()];
        let element = [
            mesh.element_nodes.binding(),
            r.coordinates.binding(),
            r.volume.binding(),
            r.committed.binding(),
            s.increment.binding(),
        ];
        let material = [r.parameters.binding(), r.table.binding()];
        let at_points = [r.state.binding(), s.jacobian.binding(), s.first_invalid.binding()];
        let bind = |kernel: &'static Kernel, parts: &[&[Argument<'_>]]| {
            let pipeline = c.pipeline(kernel, R::PRECISION)?;
            c.bind(&pipeline, parts.concat())
        };
        let gather = [mesh.node_start.binding(), mesh.node_entry.binding(), s.stress.binding(), s.force.binding()];
        let energies = [
            s.jacobian.binding(),
            s.next_history.binding(),
            s.point_work.binding(),
            r.plastic_work.binding(),
            s.energies.binding(),
        ];
        let contact = [
            r.weight.binding(),
            mesh.on_symmetry_plane.binding(),
            r.friction.binding(),
            r.gap.binding(),
            s.contact_trial.binding(),
            s.contact_answer.binding(),
            s.contact_status.binding(),
        ];
        let at = |kernel, outputs: &[Argument<'_>]| bind(kernel, &[&shape, &element, &material, &at_points, outputs]);
        Ok(Self {
            jacobian: bind(&HEX8_JACOBIAN, &[&shape, &element, &[s.jacobian.binding()]])?,
            internal_force: at(&HEX8_INTERNAL_FORCE, &[s.stress.binding()])?,
            node_force: bind(&GATHER_NODE_FORCE, &[&shape, &element, &gather])?,
            begin_step: bind(&HEX8_BEGIN_STEP, &[&shape, &[r.history.binding(), r.anticipated.binding(), r.state.binding()]])?,
            update: at(&HEX8_UPDATE, &[r.history.binding(), s.next_history.binding(), s.point_work.binding()])?,
            energies: bind(&HEX8_ENERGIES, &[&shape, &element, &material, &energies])?,
            contact: bind(&CONTACT_POINTS, &[&shape, &contact])?,
        })
    }
}

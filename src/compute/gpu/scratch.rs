//! What dispatches of a batch make, slot by slot, and the kernels that make it.

use super::arguments::{Argument, args};
use super::buffers::{DeviceReal, StorageBuffer};
use super::context::GpuContext;
use super::error::GpuError;
use super::kernel::Kernel;
use super::layout::{COORDINATES, FACED, MOST_SLOTS, NEXT_HISTORY, ROWS, STATE, STRESS, TRIAL};
use super::pipelines::Bound;
use super::pools::{PoolBytes, Pools};
use super::resident::{BatchSizes, Connectivity, Resident};
use super::shader_sources::{
    CONTACT_POINTS, GATHER_NODE_FORCE, HEX8_BEGIN_STEP, HEX8_ENERGIES, HEX8_INTERNAL_FORCE, HEX8_JACOBIAN, HEX8_UPDATE,
};

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
    pub(super) start_numbers: u32,
    pub(super) trial_numbers: u32,
    pub(super) reserved: [u32; 2],
}

/// What dispatches make, slot by slot.
#[derive(Debug)]
pub struct Scratch<R> {
    pub dimensions: StorageBuffer<Dimensions>,
    pub active: StorageBuffer<[u32; 4]>,
    /// Increments and Jacobians.
    pub trial: StorageBuffer<R>,
    pub first_invalid: StorageBuffer<u32>,
    /// Memory of what is not needed at the same time.
    pub pools: Pools,
    pub(super) stress: StorageBuffer<R>,
    pub force: StorageBuffer<R>,
    pub(super) next_history: StorageBuffer<R>,
    pub energies: StorageBuffer<R>,
    pub(super) contact_trial: StorageBuffer<R>,
    pub(super) contact_rows: StorageBuffer<R>,
    pub(super) contact_codes: StorageBuffer<u32>,
}

impl<R: DeviceReal> Scratch<R> {
    pub fn new(context: &GpuContext, sizes: BatchSizes, (slots, pools): (usize, PoolBytes)) -> Result<Self, GpuError> {
        let points = sizes.points();
        let pools = Pools::new(context, pools, slots)?;
        let zeros = |what: &str, per_slot: usize| Ok::<_, GpuError>(context.zeros(what, slots * per_slot)?.each(slots));
        Ok(Self {
            dimensions: context.block("dimensions")?,
            active: context.blocks("active cases", MOST_SLOTS)?,
            first_invalid: context.zeros("status", slots)?,
            trial: zeros("increments and Jacobians", sizes.trial_numbers())?,
            stress: pools.blocks.view("stresses", slots * STRESS * points)?.each(slots),
            force: zeros("internal forces", 3 * sizes.nodes)?,
            next_history: pools.vectors.view("new states", slots * NEXT_HISTORY * points)?.each(slots),
            pools,
            energies: zeros("energies of elements", 3 * sizes.elements)?,
            contact_trial: zeros("contact points", TRIAL * sizes.contact_points)?,
            contact_rows: zeros("contact rows", ROWS * sizes.contact_points)?,
            contact_codes: context.zeros("contact status", slots * sizes.contact_points)?.each(slots),
        })
    }

    /// Bytes of a slot, but for the pools.
    pub fn bytes(sizes: BatchSizes) -> u64 {
        let all = sizes.trial_numbers() + 3 * sizes.nodes + 3 * sizes.elements;
        let contact = (TRIAL + ROWS + 1) * sizes.contact_points;
        ((all + contact + 16) * size_of::<R>()) as u64
    }
}

/// The kernels bound to a group of cases.
#[derive(Debug)]
pub struct EvaluationKernels {
    pub(super) jacobian: Bound,
    pub(super) internal_force: Bound,
    pub(super) node_force: Bound,
    pub(super) begin_step: Bound,
    pub(super) update: Bound,
    pub(super) energies: Bound,
    pub(super) contact: Bound,
}

impl EvaluationKernels {
    pub fn new<R: DeviceReal>(c: &GpuContext, mesh: &Connectivity, r: &Resident<R>, s: &Scratch<R>) -> Result<Self, GpuError> {
        let shape = args! { dimensions: s.dimensions, active_cases: s.active };
        let (unknowns, points) = (3 * mesh.sizes.nodes, mesh.sizes.points());
        let element = args! {
            element_nodes: mesh.element_nodes,
            geometries: r.geometries,
            starts: r.start,
            trials: s.trial,
            materials: r.materials,
            first_invalid: s.first_invalid,
        };
        let bind = |kernel: &'static Kernel, parts: &[&[Argument<'_>]]| c.bind(kernel, R::PRECISION, &parts.concat());
        let at = |kernel, outputs: &[Argument<'_>]| bind(kernel, &[&shape, &element, outputs]);
        let jacobian = args! {
            element_nodes: mesh.element_nodes,
            geometries: r.geometries.partly(COORDINATES * mesh.sizes.elements),
            starts: r.start.partly(unknowns),
            trials: s.trial,
        };
        let gather = args! {
            element_nodes: mesh.element_nodes,
            node_start: mesh.node_start,
            node_entry: mesh.node_entry,
            stress: s.stress,
            force: s.force,
        };
        let begin_step = args! { history: r.history, anticipated: r.anticipated, starts: r.start.partly(STATE * points) };
        let update = args! { history: r.history, next_history: s.next_history };
        let energies = args! {
            geometries: r.geometries.partly(points),
            trials: s.trial.partly(points),
            materials: r.materials,
            // Both energies, and alpha.
            next_history: s.next_history.partly(3 * points),
            work_at_start: r.plastic_work,
            energies: s.energies,
        };
        let contact = args! {
            weight: r.weight,
            surface: mesh.surface.partly(mesh.sizes.contact_points),
            friction: r.friction,
            facing: r.facing.partly(FACED * mesh.sizes.contact_points),
            trial: s.contact_trial,
            rows: s.contact_rows,
            codes: s.contact_codes,
        };
        Ok(Self {
            jacobian: bind(&HEX8_JACOBIAN, &[&shape, &jacobian])?,
            internal_force: at(&HEX8_INTERNAL_FORCE, &args! { stress: s.stress })?,
            node_force: bind(&GATHER_NODE_FORCE, &[&shape, &gather])?,
            begin_step: bind(&HEX8_BEGIN_STEP, &[&shape, &begin_step])?,
            update: at(&HEX8_UPDATE, &update)?,
            energies: bind(&HEX8_ENERGIES, &[&shape, &energies])?,
            contact: bind(&CONTACT_POINTS, &[&shape, &contact])?,
        })
    }
}

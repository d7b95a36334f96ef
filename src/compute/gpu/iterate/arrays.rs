//! The arrays of Newton's iterates.

use super::super::buffers::{DeviceReal, StorageBuffer};
use super::super::context::GpuContext;
use super::super::error::GpuError;
use super::super::layout::{AT_POINT, CONDITIONS, MOST_SLOTS};
use super::super::linear::records::Record;
use super::super::linear::sizes::THREADS;
use super::super::resident::{BatchSizes, Resident};
use crate::compute::CaseModel;
use crate::compute::iterate::{missing_weight, prescribed};
use crate::mesh::Mesh;

/// Numbers that go to a slot, as `told.wgsl` names them.
pub const NUMBERS: usize = 9;
/// Numbers that come back, as `read.wgsl` orders them.
pub const READINGS: usize = 10;
/// Partial sums of `parts.wgsl`.
pub(in super::super) const PARTS: usize = 4;

/// `node_info.wgsl`.
pub(in super::super) const IS_PLATE: u32 = 8;
pub(in super::super) const FIRST_POINT: u32 = 16;

/// Bits of `let_go`.
pub(in super::super) const SLIDES: u32 = 1;
pub(in super::super) const CAME_OFF: u32 = 2;

/// What stays on the device of each case of a group.
#[derive(Debug)]
pub struct Kept<R> {
    /// Increments since the start of the step, and internal forces,
    /// `[case][iterate][increment, force][3 node + i]`.
    pub iterates: StorageBuffer<R>,
    /// `[case][3 node + i]`.
    pub correction: StorageBuffer<R>,
    pub(super) by_residual: StorageBuffer<R>,
    /// Displacement one step before the committed one, `[case][3 node + i]`.
    pub before: StorageBuffer<R>,
    /// Contact points that slide without friction in this step, or came off, `[case][point]`.
    pub let_go: StorageBuffer<u32>,
    pub(super) rows: StorageBuffer<R>,
    pub(super) response: StorageBuffer<f32>,
    pub(super) node_info: StorageBuffer<u32>,
    pub(super) plate_weight: StorageBuffer<R>,
}

impl<R: DeviceReal> Kept<R> {
    /// The arrays of a group of cases, `models`, in their virgin state.
    ///
    /// # Errors
    /// As [`GpuContext::zeros`].
    pub fn new(context: &GpuContext, sizes: BatchSizes, resident: &Resident<R>, models: &[CaseModel]) -> Result<Self, GpuError> {
        let (cases, n, points) = (models.len(), 3 * sizes.nodes, sizes.contact_points);
        let geometries = resident.geometry_of.iter().max().map_or(1, |last| *last as usize + 1);
        let of = |geometry: usize| resident.geometry_of.iter().position(|&g| g as usize == geometry).unwrap_or(0);
        let meshes: Vec<&Mesh> = (0..geometries).map(|geometry| &*models[of(geometry)].mesh).collect();
        let weights: Vec<R> = meshes.iter().map(|mesh| R::of(missing_weight(mesh))).collect();
        Ok(Self {
            iterates: context.zeros("iterates and their forces", cases * 4 * n)?.each(2 * cases),
            correction: context.zeros("corrections", cases * n)?.each(cases),
            by_residual: context.zeros("corrections at constant h", cases * n)?.each(cases),
            before: context.zeros("earlier displacements", cases * n)?.each(cases),
            let_go: context.zeros("points that slide or came off", cases * points)?.each(cases),
            rows: context.zeros("contact conditions of iterates", cases * 2 * CONDITIONS * points)?.each(2 * cases),
            response: context.zeros("responses to a unit indentation", cases * n)?.each(cases),
            node_info: context.array("what nodes are", &node_info(meshes[0]))?.whole(),
            plate_weight: context.array("weights of missing displacements", &weights)?,
        })
    }

    /// After [`Resident::replace`]: puts the arrays of the group's case `index` in their virgin
    /// state, on `mesh`, which has the number `geometry`.
    ///
    /// # Errors
    /// The device's fault.
    pub fn replace(
        &self,
        context: &GpuContext,
        sizes: BatchSizes,
        index: usize,
        (geometry, mesh): (usize, &Mesh),
    ) -> Result<(), GpuError> {
        let (n, points) = (3 * sizes.nodes, sizes.contact_points);
        context.upload_at(&self.plate_weight, geometry, &[R::of(missing_weight(mesh))])?;
        let mut list = context.record();
        for (array, of_case) in [
            (&self.iterates, 4 * n),
            (&self.correction, n),
            (&self.by_residual, n),
            (&self.before, n),
            (&self.rows, 2 * CONDITIONS * points),
        ] {
            list.clear(array, index * of_case, of_case)?;
        }
        list.clear(&self.let_go, index * points, points)?;
        list.clear(&self.response, index * n, n)?;
        list.submit()
    }

    /// Bytes of a case.
    pub fn bytes(sizes: BatchSizes) -> u64 {
        let (n, points) = (3 * sizes.nodes, sizes.contact_points);
        (size_of::<R>() * (7 * n + 2 * CONDITIONS * points) + size_of::<u32>() * (n + points)) as u64
    }
}

/// What each node is, as `node_info.wgsl` has it.
fn node_info(mesh: &Mesh) -> Vec<u32> {
    let bits = |p: &[bool; 3]| u32::from(p[0]) | u32::from(p[1]) << 1 | u32::from(p[2]) << 2;
    let mut info: Vec<u32> = prescribed(mesh).as_chunks::<3>().0.iter().map(bits).collect();
    for &n in &mesh.plate_nodes {
        info[n as usize] |= IS_PLATE;
    }
    for (point, &n) in mesh.contact_nodes.iter().enumerate() {
        info[n as usize] += FIRST_POINT * (point as u32 + 1);
    }
    info
}

/// What a dispatch is told and leaves, slot by slot.
#[derive(Debug)]
pub struct Told<R> {
    /// `[slot]`: current iterate, trial, flags, source of the trial.
    pub marks: StorageBuffer<[u32; 4]>,
    /// `[slot][NUMBERS]`.
    pub numbers: StorageBuffer<R>,
    /// `[slot][READINGS]`.
    pub readings: StorageBuffer<R>,
    /// `[slot]`: status changed, come down again, closed, slipping.
    pub counts: StorageBuffer<[u32; 4]>,
    /// `[slot]`: as the status of an evaluation before it begins.
    pub all_valid: StorageBuffer<u32>,
    /// `[slot]`: that of the tangent.
    pub of_tangent: StorageBuffer<u32>,
    /// `[slot][AT_POINT][point]`.
    pub at_points: StorageBuffer<R>,
    /// `[slot][point]`.
    pub status: StorageBuffer<u32>,
    /// `[slot][elastic, plastic, largest alpha]`.
    pub energies: StorageBuffer<R>,
    pub(super) partial_sums: StorageBuffer<R>,
    /// `[slot]`: how the systems of corrections begin that hold a force, and how they end.
    pub corrections: StorageBuffer<Record>,
    /// `[slot]`: the same of the responses to a unit indentation.
    pub units: StorageBuffer<Record>,
}

impl<R: DeviceReal> Told<R> {
    /// The arrays of so many slots.
    ///
    /// # Errors
    /// As [`GpuContext::zeros`].
    pub fn new(context: &GpuContext, sizes: BatchSizes, slots: usize) -> Result<Self, GpuError> {
        let zeros = |what: &str, numbers: usize| context.zeros(what, slots * numbers);
        Ok(Self {
            marks: context.blocks("marks", MOST_SLOTS)?,
            numbers: zeros("numbers", NUMBERS)?,
            readings: zeros("readings", READINGS)?,
            counts: context.zeros("counts", slots)?,
            all_valid: context.array("status before", &vec![u32::MAX; slots])?,
            of_tangent: context.zeros("status of the tangent", slots)?,
            at_points: zeros("recorded points", AT_POINT * sizes.contact_points)?.each(slots),
            status: context.zeros("recorded status", slots * sizes.contact_points)?.each(slots),
            energies: zeros("energies of bodies", 3)?,
            partial_sums: zeros("partial sums of trials", PARTS * sizes.nodes.div_ceil(THREADS))?,
            corrections: context.zeros("solves of corrections", slots)?,
            units: context.zeros("solves of responses", slots)?,
        })
    }

    /// Bytes of a slot.
    pub fn bytes(sizes: BatchSizes) -> u64 {
        let numbers = NUMBERS + READINGS + 3 + AT_POINT * sizes.contact_points + PARTS * sizes.nodes.div_ceil(THREADS);
        let words = 6 + sizes.contact_points;
        (size_of::<R>() * numbers + size_of::<u32>() * words + 2 * size_of::<Record>()) as u64
    }
}

//! The arrays of Newton's iterates, and the kernels that are bound to them.

use super::super::buffers::{DeviceReal, StorageBuffer};
use super::super::context::GpuContext;
use super::super::error::GpuError;
use super::super::linear::{Linear, POINT_ROWS, Record};
use super::super::moves::Argument;
use super::super::pipelines::Bound;
use super::super::resident::{Connectivity, Resident, Sizes};
use super::super::scratch::Scratch;
use super::super::shader_sources::Kernel;
use super::sources;
use crate::compute::CaseModel;
use crate::compute::iterate::{missing_weight, prescribed};
use crate::mesh::Mesh;

/// Numbers that go to a slot, as `told.wgsl` names them.
pub const NUMBERS: usize = 9;
/// Numbers that come back, as `read.wgsl` orders them.
pub const READINGS: usize = 10;
/// Partial sums of `parts.wgsl`.
const PARTS: usize = 4;
/// Threads of the kernels that sum over nodes.
const SUMMING: usize = 256;
/// Components of a contact point's rows: residual, force rows, displacement rows.
const ROWS: usize = POINT_ROWS + 2;
/// Numbers of a contact point that are recorded: displacement, force.
pub const AT_POINT: usize = 6;

/// `node_info.wgsl`.
const IS_PLATE: u32 = 8;
const FIRST_POINT: u32 = 16;

/// What stays on the device of each case of a group.
#[derive(Debug)]
pub struct Kept<R> {
    /// Increments since the start of the step, `[case][iterate][3 node + i]`.
    pub increments: StorageBuffer<R>,
    /// Internal forces, alike.
    pub forces: StorageBuffer<R>,
    /// `[case][3 node + i]`.
    pub correction: StorageBuffer<R>,
    by_residual: StorageBuffer<R>,
    /// Displacement one step before the committed one, `[case][3 node + i]`.
    pub before: StorageBuffer<R>,
    /// Contact points that slide without friction in this step, `[case][point]`.
    pub slides: StorageBuffer<u32>,
    /// Contact points that came off in this step, `[case][point]`.
    pub came_off: StorageBuffer<u32>,
    rows: StorageBuffer<R>,
    codes: StorageBuffer<u32>,
    response: StorageBuffer<f32>,
    largest: StorageBuffer<R>,
    node_info: StorageBuffer<u32>,
    plate: StorageBuffer<u32>,
    plate_weight: StorageBuffer<R>,
    height: StorageBuffer<R>,
}

impl<R: DeviceReal> Kept<R> {
    /// The arrays of a group of cases, `models`, in their virgin state.
    ///
    /// # Errors
    /// As [`GpuContext::zeros`].
    pub fn new(context: &GpuContext, sizes: Sizes, resident: &Resident<R>, models: &[CaseModel]) -> Result<Self, GpuError> {
        let (cases, n, points) = (models.len(), 3 * sizes.nodes, sizes.contact_points);
        let geometries = resident.geometry_of.iter().max().map_or(1, |last| *last as usize + 1);
        let of = |geometry: usize| resident.geometry_of.iter().position(|&g| g as usize == geometry).unwrap_or(0);
        let meshes: Vec<&Mesh> = (0..geometries).map(|geometry| &*models[of(geometry)].mesh).collect();
        let weights: Vec<R> = meshes.iter().map(|mesh| R::of(missing_weight(mesh))).collect();
        let heights: Vec<R> = meshes.iter().flat_map(|mesh| heights(mesh)).collect();
        let plate: Vec<u32> =
            std::iter::once(meshes[0].plate_nodes.len() as u32).chain(meshes[0].plate_nodes.iter().copied()).collect();
        Ok(Self {
            increments: context.zeros("iterates", cases * 2 * n)?.each(2 * cases),
            forces: context.zeros("forces of iterates", cases * 2 * n)?.each(2 * cases),
            correction: context.zeros("corrections", cases * n)?.each(cases),
            by_residual: context.zeros("corrections at constant h", cases * n)?.each(cases),
            before: context.zeros("earlier displacements", cases * n)?.each(cases),
            slides: context.zeros("sliding points", cases * points)?.each(cases),
            came_off: context.zeros("points that came off", cases * points)?.each(cases),
            rows: context.zeros("contact rows of iterates", cases * 2 * ROWS * points)?.each(2 * cases),
            codes: context.zeros("contact status of iterates", cases * 2 * points)?.each(2 * cases),
            response: context.zeros("responses to a unit indentation", cases * n)?.each(cases),
            largest: context.zeros("largest right-hand sides", cases * 2)?,
            node_info: context.array("what nodes are", &node_info(meshes[0]))?.whole(),
            plate: context.array("plate nodes", &plate)?,
            plate_weight: context.array("weights of missing displacements", &weights)?,
            height: context.array("heights of contact points", &heights)?.each(geometries),
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
        sizes: Sizes,
        index: usize,
        (geometry, mesh): (usize, &Mesh),
    ) -> Result<(), GpuError> {
        let (n, points) = (3 * sizes.nodes, sizes.contact_points);
        context.upload_at(&self.plate_weight, geometry, &[R::of(missing_weight(mesh))])?;
        context.upload_at(&self.height, geometry * points, &heights::<R>(mesh))?;
        let mut list = context.record();
        for (array, of_case) in [
            (&self.increments, 2 * n),
            (&self.forces, 2 * n),
            (&self.correction, n),
            (&self.by_residual, n),
            (&self.before, n),
            (&self.rows, 2 * ROWS * points),
            (&self.largest, 2),
        ] {
            list.clear(array, index * of_case, of_case)?;
        }
        for (array, of_case) in [(&self.slides, points), (&self.came_off, points), (&self.codes, 2 * points)] {
            list.clear(array, index * of_case, of_case)?;
        }
        list.clear(&self.response, index * n, n)?;
        list.submit()
    }

    /// Bytes of a case.
    pub fn bytes(sizes: Sizes) -> u64 {
        let (n, points) = (3 * sizes.nodes, sizes.contact_points);
        (size_of::<R>() * (7 * n + 2 * ROWS * points) + size_of::<u32>() * (n + 4 * points)) as u64
    }
}

/// Heights of a mesh's contact points.
fn heights<R: DeviceReal>(mesh: &Mesh) -> Vec<R> {
    mesh.contact_nodes.iter().map(|&n| R::of(mesh.nodes[n as usize][2])).collect()
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
    partial_sums: StorageBuffer<R>,
    /// `[slot]`: how the systems of corrections begin that hold a force, and how they end.
    pub corrections: StorageBuffer<Record>,
    /// `[slot]`: the same of the responses to a unit indentation.
    pub units: StorageBuffer<Record>,
    /// `[slot]`: change of h along such a correction.
    depth_changes: StorageBuffer<R>,
}

impl<R: DeviceReal> Told<R> {
    /// The arrays of so many slots.
    ///
    /// # Errors
    /// As [`GpuContext::zeros`].
    pub fn new(context: &GpuContext, sizes: Sizes, slots: usize) -> Result<Self, GpuError> {
        let zeros = |what: &str, numbers: usize| context.zeros(what, slots * numbers);
        Ok(Self {
            marks: context.zeros("marks", slots)?,
            numbers: zeros("numbers", NUMBERS)?,
            readings: zeros("readings", READINGS)?,
            counts: context.zeros("counts", slots)?,
            all_valid: context.array("status before", &vec![u32::MAX; slots])?,
            of_tangent: context.zeros("status of the tangent", slots)?,
            at_points: zeros("recorded points", AT_POINT * sizes.contact_points)?.each(slots),
            status: context.zeros("recorded status", slots * sizes.contact_points)?.each(slots),
            energies: zeros("energies of bodies", 3)?,
            partial_sums: zeros("partial sums of trials", PARTS * sizes.nodes.div_ceil(SUMMING))?,
            corrections: context.zeros("solves of corrections", slots)?,
            units: context.zeros("solves of responses", slots)?,
            depth_changes: zeros("changes of h", 1)?,
        })
    }

    /// Bytes of a slot.
    pub fn bytes(sizes: Sizes) -> u64 {
        let numbers = NUMBERS + READINGS + 4 + AT_POINT * sizes.contact_points + PARTS * sizes.nodes.div_ceil(SUMMING);
        let words = 10 + sizes.contact_points;
        (size_of::<R>() * numbers + size_of::<u32>() * words + 2 * size_of::<Record>()) as u64
    }
}

/// The kernels bound to a group of cases.
#[derive(Debug)]
pub struct Kernels {
    pub(super) place: Bound,
    pub(super) current: Bound,
    pub(super) save: Bound,
    pub(super) contact: Bound,
    pub(super) measure: Bound,
    pub(super) read: Bound,
    pub(super) system: Bound,
    pub(super) expand: Bound,
    pub(super) unit: Bound,
    pub(super) respond: Bound,
    pub(super) depth: Bound,
    pub(super) press: Bound,
    pub(super) land: Bound,
    pub(super) commit: Bound,
    pub(super) energies: Bound,
}

impl Kernels {
    /// Binds them.
    ///
    /// # Errors
    /// What the device says.
    pub fn new<R: DeviceReal>(
        context: &GpuContext,
        mesh: &Connectivity,
        resident: &Resident<R>,
        scratch: &Scratch<R>,
        linear: &Linear,
        (kept, told): (&Kept<R>, &Told<R>),
    ) -> Result<Self, GpuError> {
        let solver = linear.of_iterates();
        let told_alone = [scratch.dimensions.binding(), scratch.active.binding(), told.marks.binding(), told.numbers.binding()];
        let shape = [&told_alone[..], &[told.depth_changes.binding()]].concat();
        let residual = [
            resident.committed.binding(),
            kept.node_info.binding(),
            resident.weight.binding(),
            kept.increments.binding(),
            kept.forces.binding(),
            kept.rows.binding(),
            kept.codes.binding(),
        ];
        let bind = |kernel: &'static Kernel, parts: &[&[Argument<'_>]]| {
            let pipeline = context.pipeline(kernel, R::PRECISION)?;
            context.bind(&pipeline, [&shape[..], &parts.concat()].concat())
        };
        let place = [
            resident.committed.binding(),
            kept.before.binding(),
            kept.correction.binding(),
            kept.node_info.binding(),
            resident.gap.binding(),
            kept.increments.binding(),
            scratch.increment.binding(),
        ];
        let contact = [
            mesh.contact_node.binding(),
            resident.weight.binding(),
            mesh.on_symmetry_plane.binding(),
            resident.friction.binding(),
            kept.slides.binding(),
            resident.gap.binding(),
            kept.increments.binding(),
            kept.forces.binding(),
            kept.rows.binding(),
            kept.codes.binding(),
        ];
        let measure = [kept.correction.binding(), kept.plate_weight.binding(), told.partial_sums.binding()];
        let read = [
            kept.plate.binding(),
            mesh.contact_node.binding(),
            kept.forces.binding(),
            kept.rows.binding(),
            kept.codes.binding(),
            kept.slides.binding(),
            kept.came_off.binding(),
            told.partial_sums.binding(),
            kept.largest.binding(),
            told.readings.binding(),
            told.counts.binding(),
        ];
        let system = [kept.largest.binding(), solver.rhs.binding(), solver.fixed.binding(), solver.rows.binding()];
        let expand = [kept.largest.binding(), solver.answer.binding(), kept.correction.binding(), kept.by_residual.binding()];
        let unit = [
            kept.node_info.binding(),
            solver.fixed.binding(),
            kept.response.binding(),
            solver.rhs.binding(),
            solver.guess.binding(),
        ];
        let respond = [solver.answer.binding(), solver.rhs.binding(), solver.fixed.binding(), kept.response.binding()];
        let press = [kept.response.binding(), kept.by_residual.binding(), kept.correction.binding()];
        let depth = [told.corrections.binding(), told.units.binding(), told.depth_changes.binding()];
        let depth_kernel = context.pipeline(&sources::DEPTH, R::PRECISION)?;
        let commit = [
            kept.node_info.binding(),
            kept.height.binding(),
            kept.increments.binding(),
            kept.forces.binding(),
            kept.rows.binding(),
            kept.codes.binding(),
            resident.committed.binding(),
            kept.before.binding(),
            resident.gap.binding(),
            told.at_points.binding(),
            told.status.binding(),
        ];
        Ok(Self {
            place: bind(&sources::PLACE, &[&place])?,
            current: bind(&sources::CURRENT, &[&[kept.increments.binding(), scratch.increment.binding()]])?,
            save: bind(&sources::SAVE, &[&[scratch.force.binding(), kept.forces.binding()]])?,
            contact: bind(&sources::CONTACT, &[&contact])?,
            measure: bind(&sources::MEASURE, &[&residual, &measure])?,
            read: bind(&sources::READ, &[&read])?,
            system: bind(&sources::SYSTEM, &[&residual, &system])?,
            expand: bind(&sources::EXPAND, &[&residual, &expand])?,
            unit: bind(&sources::UNIT, &[&unit])?,
            respond: bind(&sources::RESPOND, &[&respond])?,
            depth: context.bind(&depth_kernel, [&told_alone[..], &depth].concat())?,
            press: bind(&sources::PRESS, &[&press])?,
            land: bind(&sources::LAND, &[&[kept.codes.binding(), kept.slides.binding(), kept.came_off.binding()]])?,
            commit: bind(&sources::COMMIT, &[&commit])?,
            energies: bind(&sources::ENERGIES, &[&[scratch.energies.binding(), told.energies.binding()]])?,
        })
    }
}

//! The arrays of Newton's iterates, and the kernels that are bound to them.

use super::super::arguments::{Argument, args};
use super::super::buffers::{DeviceReal, StorageBuffer};
use super::super::context::GpuContext;
use super::super::error::GpuError;
use super::super::kernel::Kernel;
use super::super::linear::{Linear, POINT_ROWS, Record};
use super::super::pipelines::Bound;
use super::super::resident::{Connectivity, Resident, Sizes};
use super::super::scratch::Scratch;
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
        let told_alone = args! {
            dimensions: scratch.dimensions,
            active_cases: scratch.active,
            marks: told.marks,
            numbers: told.numbers,
        };
        let depth_changes = args! { depth_changes: told.depth_changes };
        let trial = args! { increments: kept.increments, forces: kept.forces, rows: kept.rows, codes: kept.codes };
        let residual = args! { committed: resident.committed, node_info: kept.node_info, weight: resident.weight };
        let bind = |kernel: &'static Kernel, parts: &[&[Argument<'_>]]| {
            context.bind(kernel, R::PRECISION, &[&told_alone[..], &depth_changes, &parts.concat()].concat())
        };
        let place = args! {
            committed: resident.committed,
            before: kept.before,
            correction: kept.correction,
            node_info: kept.node_info,
            gap_at_start: resident.gap,
            increments: kept.increments,
            increment: scratch.increment,
        };
        let contact = args! {
            contact_node: mesh.contact_node,
            weight: resident.weight,
            on_symmetry_plane: mesh.on_symmetry_plane,
            friction: resident.friction,
            slides: kept.slides,
            gap_at_start: resident.gap,
        };
        let measure = args! {
            correction: kept.correction,
            plate_weight: kept.plate_weight,
            partial_sums: told.partial_sums,
        };
        let read = args! {
            plate: kept.plate,
            contact_node: mesh.contact_node,
            forces: kept.forces,
            rows: kept.rows,
            codes: kept.codes,
            slides: kept.slides,
            came_off: kept.came_off,
            partial_sums: told.partial_sums,
            largest: kept.largest,
            readings: told.readings,
            counts: told.counts,
        };
        let system = args! { largest: kept.largest, rhs: solver.rhs, is_fixed: solver.fixed, sliding: solver.rows };
        let expand = args! {
            largest: kept.largest,
            answer: solver.answer,
            correction: kept.correction,
            by_residual: kept.by_residual,
        };
        let unit = args! {
            node_info: kept.node_info,
            is_fixed: solver.fixed,
            response: kept.response,
            rhs: solver.rhs,
            guess: solver.guess,
        };
        let respond = args! { answer: solver.answer, rhs: solver.rhs, is_fixed: solver.fixed, response: kept.response };
        let press = args! { response: kept.response, by_residual: kept.by_residual, correction: kept.correction };
        let depth = args! { corrections: told.corrections, units: told.units };
        let land = args! { codes: kept.codes, slides: kept.slides, came_off: kept.came_off };
        let commit = args! {
            node_info: kept.node_info,
            height: kept.height,
            committed: resident.committed,
            before: kept.before,
            gap_at_start: resident.gap,
            at_points: told.at_points,
            status: told.status,
        };
        let energies = args! { energies: scratch.energies, totals: told.energies };
        Ok(Self {
            place: bind(&sources::PLACE, &[&place])?,
            current: bind(&sources::CURRENT, &[&args! { increments: kept.increments, increment: scratch.increment }])?,
            save: bind(&sources::SAVE, &[&args! { force: scratch.force, forces: kept.forces }])?,
            contact: bind(&sources::CONTACT, &[&trial, &contact])?,
            measure: bind(&sources::MEASURE, &[&trial, &residual, &measure])?,
            read: bind(&sources::READ, &[&read])?,
            system: bind(&sources::SYSTEM, &[&trial, &residual, &system])?,
            expand: bind(&sources::EXPAND, &[&trial, &residual, &expand])?,
            unit: bind(&sources::UNIT, &[&unit])?,
            respond: bind(&sources::RESPOND, &[&respond])?,
            depth: bind(&sources::DEPTH, &[&depth])?,
            press: bind(&sources::PRESS, &[&press])?,
            land: bind(&sources::LAND, &[&land])?,
            commit: bind(&sources::COMMIT, &[&trial, &commit])?,
            energies: bind(&sources::ENERGIES, &[&energies])?,
        })
    }
}

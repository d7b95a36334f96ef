//! The kernels of Newton's iterates, bound to the arrays of a group of cases.

use super::super::arguments::{Argument, args};
use super::super::buffers::{DeviceReal, Partly};
use super::super::context::GpuContext;
use super::super::error::GpuError;
use super::super::kernel::Kernel;
use super::super::layout::FACED;
use super::super::linear::solver::{OfIterates, SlotSolver};
use super::super::pipelines::Bound;
use super::super::resident::{Connectivity, Resident};
use super::super::scratch::Scratch;
use super::arrays::{Kept, Told};
use super::sources;

/// The kernels bound to a group of cases.
#[derive(Debug)]
pub struct IterateKernels {
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

/// What they are bound to.
struct BoundTo<'a, R> {
    context: &'a GpuContext,
    mesh: &'a Connectivity,
    resident: &'a Resident<R>,
    scratch: &'a Scratch<R>,
    solver: OfIterates<'a>,
    kept: &'a Kept<R>,
    told: &'a Told<R>,
}

impl<R: DeviceReal> BoundTo<'_, R> {
    fn bind(&self, kernel: &'static Kernel, parts: &[&[Argument<'_>]]) -> Result<Bound, GpuError> {
        let Self { scratch, told, .. } = self;
        let shape = args! {
            dimensions: scratch.dimensions,
            active_cases: scratch.active,
            marks: told.marks,
            numbers: told.numbers,
        };
        self.context.bind(kernel, R::PRECISION, &[&shape[..], &parts.concat()].concat())
    }

    /// The increments or the forces of iterates: one of the two vectors of each.
    fn iterates(&self) -> Partly<'_, R> {
        self.kept.iterates.partly(self.unknowns())
    }

    /// The increments of slots, as the elements read them.
    fn trial(&self) -> Partly<'_, R> {
        self.scratch.trial.partly(self.unknowns())
    }

    fn unknowns(&self) -> usize {
        3 * self.mesh.sizes.nodes
    }

    /// As `residual.wgsl` has them.
    fn residual(&self) -> [Argument<'_>; 4] {
        let Self { resident, kept, .. } = self;
        args! {
            starts: resident.start.partly(self.unknowns()),
            node_info: kept.node_info,
            iterates: self.iterates(),
            rows: kept.rows,
        }
    }

    fn kernels(&self) -> Result<IterateKernels, GpuError> {
        let [place, save, contact, measure, read] = self.of_trials()?;
        let [current, system, expand, unit, respond, depth, press] = self.of_systems()?;
        let [land, commit, energies] = self.of_steps()?;
        Ok(IterateKernels {
            place,
            current,
            save,
            contact,
            measure,
            read,
            system,
            expand,
            unit,
            respond,
            depth,
            press,
            land,
            commit,
            energies,
        })
    }

    fn of_trials(&self) -> Result<[Bound; 5], GpuError> {
        let Self { mesh, resident, scratch, kept, told, .. } = self;
        let points = mesh.sizes.contact_points;
        let place = args! {
            starts: resident.start,
            before: kept.before,
            correction: kept.correction,
            node_info: kept.node_info,
            facing: resident.facing,
            iterates: self.iterates(),
            trials: self.trial(),
        };
        let contact = args! {
            surface: mesh.surface.partly(points),
            weight: resident.weight,
            friction: resident.friction,
            let_go: kept.let_go,
            facing: resident.facing.partly(FACED * points),
            iterates: kept.iterates,
            rows: kept.rows,
        };
        let measure = args! {
            correction: kept.correction,
            plate_weight: kept.plate_weight,
            partial_sums: told.partial_sums,
        };
        let read = args! {
            surface: mesh.surface,
            iterates: kept.iterates,
            rows: kept.rows,
            let_go: kept.let_go,
            partial_sums: told.partial_sums,
            readings: told.readings,
            counts: told.counts,
        };
        Ok([
            self.bind(&sources::PLACE, &[&place])?,
            self.bind(&sources::SAVE, &[&args! { force: scratch.force, iterates: self.iterates() }])?,
            self.bind(&sources::CONTACT, &[&contact])?,
            self.bind(&sources::MEASURE, &[&self.residual(), &measure])?,
            self.bind(&sources::READ, &[&read])?,
        ])
    }

    fn of_systems(&self) -> Result<[Bound; 7], GpuError> {
        let Self { solver, kept, told, .. } = self;
        let OfIterates { rhs, fixed, rows: sliding, guess, answer } = *solver;
        let current = args! { iterates: self.iterates(), trials: self.trial() };
        let system = args! { rhs, is_fixed: fixed, sliding };
        let expand = args! { answer, correction: kept.correction, by_residual: kept.by_residual };
        let frames = args! { node_info: kept.node_info, rows: kept.rows };
        let unit = args! { is_fixed: fixed, response: kept.response, rhs, guess };
        let respond = args! { answer, rhs, is_fixed: fixed, response: kept.response };
        let press = args! { response: kept.response, by_residual: kept.by_residual, correction: kept.correction };
        Ok([
            self.bind(&sources::CURRENT, &[&current])?,
            self.bind(&sources::SYSTEM, &[&self.residual(), &system])?,
            self.bind(&sources::EXPAND, &[&self.residual(), &expand])?,
            self.bind(&sources::UNIT, &[&frames, &unit])?,
            self.bind(&sources::RESPOND, &[&respond])?,
            self.bind(&sources::DEPTH, &[&args! { corrections: told.corrections, units: told.units }])?,
            self.bind(&sources::PRESS, &[&frames, &press])?,
        ])
    }

    fn of_steps(&self) -> Result<[Bound; 3], GpuError> {
        let Self { resident, scratch, kept, told, .. } = self;
        let land = args! { rows: kept.rows, let_go: kept.let_go };
        let commit = args! {
            node_info: kept.node_info,
            iterates: self.iterates(),
            starts: resident.start.partly(self.unknowns()),
            rows: kept.rows,
            before: kept.before,
            facing: resident.facing.partly(FACED * self.mesh.sizes.contact_points),
            at_points: told.at_points,
            status: told.status,
        };
        Ok([
            self.bind(&sources::LAND, &[&land])?,
            self.bind(&sources::COMMIT, &[&commit])?,
            self.bind(&sources::ENERGIES, &[&args! { energies: scratch.energies, totals: told.energies }])?,
        ])
    }
}

/// The iterates of a batch: a part for each of its groups.
#[derive(Debug)]
pub struct Iterates<R> {
    /// Arrays and kernels of each group.
    pub groups: Vec<(Kept<R>, IterateKernels)>,
    /// What all dispatches are told and leave.
    pub told: Told<R>,
}

impl<R: DeviceReal> Iterates<R> {
    /// What so many slots are told, and the kernels of each group, whose arrays are there.
    ///
    /// # Errors
    /// What the device says.
    pub fn new<'a>(
        context: &GpuContext,
        mesh: &Connectivity,
        scratch: &Scratch<R>,
        linear: &SlotSolver,
        (slots, kept): (usize, Vec<Kept<R>>),
        residents: impl Iterator<Item = &'a Resident<R>>,
    ) -> Result<Self, GpuError>
    where
        R: 'a,
    {
        let told = Told::new(context, mesh.sizes, slots)?;
        let bound = |(kept, resident): (Kept<R>, &Resident<R>)| {
            let arrays = BoundTo { context, mesh, resident, scratch, solver: linear.of_iterates(), kept: &kept, told: &told };
            let kernels = arrays.kernels()?;
            Ok((kept, kernels))
        };
        let groups = kept.into_iter().zip(residents).map(bound).collect::<Result<_, GpuError>>()?;
        Ok(Self { groups, told })
    }
}

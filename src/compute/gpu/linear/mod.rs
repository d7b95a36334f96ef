//! Linear systems on the device: the tangent as a matrix of the multigrid hierarchy, and FGMRES
//! preconditioned by its V-cycle, for every slot of a dispatch at once.
//!
//! All of it is in single precision, as the preconditioner is on the CPU ([`crate::linalg`], whose
//! algorithm this is but for three things: a cycle has up to 30 vectors, two passes of classical
//! Gram-Schmidt stand for the modified one, and that the tolerance is met is taken from the
//! recurrence). Newton's residual decides what is a solution, the linear system only how fast it is
//! found. The list of a solve has as many Krylov iterations as whoever asks expects it to take, and
//! one more. After each of them the device lists the slots that go on, and writes for how many the
//! next kernels are dispatched; where some have not finished at the end of the list, more is sent.

mod calls;
pub mod inspect;
mod levels;
pub mod pack;
pub mod parts;
pub mod sources;

use super::arguments::{Argument, args};
use super::buffers::{DeviceReal, Read, StorageBuffer};
use super::context::GpuContext;
use super::error::GpuError;
use super::pipelines::Recorder;
use super::pools::Pools;
use crate::compute::linear::{Ended, SideReport};
use crate::linalg::layout::{Layout, NOWHERE};
use crate::mesh::Mesh;
use calls::{Call, Running};
pub use levels::Record;
use levels::{Levels, product_numbers, row_threads, shared_numbers, slot_numbers};
use sources::{
    ASSEMBLE, KRYLOV_ADVANCE, KRYLOV_BEGIN, KRYLOV_COMBINE, KRYLOV_DOTS, KRYLOV_LEAST_SQUARES, KRYLOV_MEASURE, KRYLOV_NORMALISE,
    KRYLOV_ORTHOGONALISE, KRYLOV_PRODUCT, PLATE_FORCE, PRESCRIBE, RESIDUAL,
};

/// Krylov vectors after which a cycle starts over.
const RESTART: usize = 30;
/// Iterations after which a system is given up.
const MOST: usize = 120;
/// Krylov iterations of a list that goes on with those that have not finished.
const MORE: usize = 4;
/// Entries of a vector that one workgroup sums.
const CHUNK: usize = 1024;
/// Threads of the kernels that sum.
const SUMMING: usize = 256;
/// Numbers that a contact point has in `assemble.wgsl`: whether it slides, its rows.
pub const POINT_ROWS: usize = 19;

/// What `record.wgsl` calls them.
const CONVERGED: u32 = 1;
const FULL: u32 = 2;
const NOT_FINITE: u32 = 4;

/// What the linear solver of a connectivity needs to know, before anything is allocated.
#[derive(Debug)]
pub struct Plan {
    layout: Layout,
    /// Per block of the finest level: where it is in the tangent's upper triangle.
    source: Vec<u32>,
    point_of: Vec<u32>,
    plate: Vec<u32>,
    contact_points: usize,
    upper_blocks: usize,
}

impl Plan {
    /// The plan of a mesh; none if it has no hierarchy. `source` says for each block of the pattern
    /// which block of the upper triangle it is.
    pub fn new(mesh: &Mesh, pattern: &crate::linalg::Pattern, source: &[u32], upper_blocks: usize) -> Option<Self> {
        if mesh.hierarchy.is_empty() || mesh.couple.is_some() {
            return None;
        }
        let layout = Layout::new(pattern, &mesh.hierarchy).ok()?;
        let finest = &layout.levels[0];
        let of_block = |&at: &u32| if at == NOWHERE { NOWHERE } else { source[at as usize] };
        let mut point_of = vec![NOWHERE; mesh.nodes.len()];
        for (point, &node) in mesh.contact_nodes.iter().enumerate() {
            point_of[node as usize] = point as u32;
        }
        Some(Self {
            source: finest.source.iter().map(of_block).collect(),
            point_of,
            plate: mesh.plate_nodes.clone(),
            contact_points: mesh.contact_nodes.len(),
            upper_blocks,
            layout,
        })
    }

    /// Bytes of a slot's Krylov vectors.
    pub fn krylov_bytes(&self) -> u64 {
        ((2 * RESTART + 1) * 3 * self.layout.levels[0].nodes * size_of::<f32>()) as u64
    }

    /// Bytes of a slot's A P of the finest level.
    pub fn product_bytes(&self) -> u64 {
        (product_numbers(&self.layout.levels[0]) * size_of::<f32>()) as u64
    }

    /// Bytes of a slot but for these: the widest array, and all together.
    pub fn bytes(&self) -> (u64, u64) {
        let n = 3 * self.layout.levels[0].nodes;
        let (mut widest, mut all) = (n, 4 * n + small_numbers() + (RESTART + 3) * n.div_ceil(CHUNK));
        for (l, level) in self.layout.levels.iter().enumerate() {
            let (array, sum) = slot_numbers(level);
            let product = if l == 0 { 0 } else { product_numbers(level) };
            (widest, all) = (widest.max(array).max(product), all + sum + product);
        }
        let rows = POINT_ROWS * self.contact_points * size_of::<f32>();
        ((widest * size_of::<f32>()) as u64, (all * size_of::<f32>() + rows + size_of::<Record>()) as u64)
    }

    /// Bytes of what the slots share: columns, lists, prolongations.
    pub fn shared_bytes(&self) -> u64 {
        let levels: usize = self.layout.levels.iter().map(shared_numbers).sum();
        let own = self.source.len() + self.point_of.len() + self.plate.len();
        ((levels + own) * size_of::<u32>()) as u64 + SMALL_ARRAYS
    }
}

/// Bytes that uniform blocks and the padding of all shared arrays take at the most.
const SMALL_ARRAYS: u64 = 4096;

/// Numbers of a slot's small arrays, as `krylov.wgsl` lays them out.
fn small_numbers() -> usize {
    5 * RESTART + 2 + RESTART * (RESTART + 1) / 2
}

/// One right-hand side of every slot, `[slot][component][node]`.
#[derive(Debug, Default)]
pub struct Right {
    /// Right-hand sides; at fixed unknowns their values.
    pub rhs: Vec<f32>,
    /// Guesses, the values of fixed unknowns in them; none if all are zero.
    pub guess: Option<Vec<f32>>,
    /// Relative residual to be reached, by slot.
    pub tolerance: Vec<f32>,
    /// Whether it is relative to the residual at the guess, by slot.
    pub relative_to_guess: Vec<bool>,
    /// Krylov iterations that the slot that takes most will probably take.
    pub expected: usize,
}

/// What a cycle of FGMRES makes.
#[derive(Debug)]
struct Vectors {
    basis: StorageBuffer<f32>,
    preconditioned: StorageBuffer<f32>,
    /// See `krylov.wgsl`.
    small: StorageBuffer<f32>,
}

/// The linear solver of a batch's slots.
#[derive(Debug)]
pub struct Linear {
    levels: Levels,
    records: StorageBuffer<Record>,
    rows: StorageBuffer<f32>,
    rhs: StorageBuffer<f32>,
    solution: StorageBuffer<f32>,
    guess: StorageBuffer<f32>,
    answer: StorageBuffer<f32>,
    /// Forms the finest level's matrix.
    assemble: Call,
    /// Writes what is fixed into `solution`.
    prescribe: Call,
    /// The residual there, and its square.
    residual: Vec<Call>,
    /// What tolerances are measured by.
    measure: Call,
    /// The first basis vector.
    begin: Vec<Call>,
    /// A Krylov iteration after the V-cycle, up to the decision which slots go on.
    iteration: Vec<Call>,
    /// Which those are.
    running: Running,
    /// The next basis vector of those.
    next: Call,
    /// The answer, from the vectors of a cycle.
    finish: Vec<Call>,
    unknowns: usize,
    /// Numbers of the tangent's upper blocks.
    upper_numbers: usize,
    vectors: Vectors,
    /// Arrays that only kernels name: they stay in the memory account as long as the kernels do.
    _sums: [StorageBuffer<f32>; 2],
    _lists: [StorageBuffer<u32>; 3],
    _counts: StorageBuffer<[u32; 4]>,
}

impl Linear {
    /// The arrays and kernels for so many slots, some in memory that they share with others;
    /// `blocks` are the tangents that the gathering kernels leave.
    ///
    /// # Errors
    /// What the device says.
    pub fn new<T: DeviceReal>(
        context: &GpuContext,
        plan: &Plan,
        (slots, pools): (usize, &Pools),
        blocks: &StorageBuffer<T>,
    ) -> Result<Self, GpuError> {
        let finest = &plan.layout.levels[0];
        let unknowns = 3 * finest.nodes;
        let chunks = unknowns.div_ceil(CHUNK);
        let zeros = |what: &str, numbers: usize| Ok::<_, GpuError>(context.zeros::<f32>(what, slots * numbers)?.each(slots));
        let records = context.zeros("linear solves", slots)?;
        let levels = Levels::new(context, &plan.layout, (slots, pools), plan.plate.len(), &records)?;
        let level = &levels.levels[0];
        let rows = context.zeros("contact rows of the matrix", slots * POINT_ROWS * plan.contact_points)?.each(slots);
        let source = context.array("blocks of the matrix", &plan.source)?.whole();
        let point_of = context.array("contact points by node", &plan.point_of)?.whole();
        let plate = context.array("plate nodes", &plan.plate)?;
        let counts = context.block("sizes of the tangent")?;
        context.upload(&counts, &[[plan.upper_blocks as u32, plan.contact_points as u32, 0, 0]])?;
        let (rhs, solution) = (zeros("right-hand sides", unknowns)?, zeros("solutions", unknowns)?);
        let (guess, answer) = (zeros("guesses", unknowns)?, zeros("answers", unknowns)?);
        let vectors = slots * (RESTART + 1);
        let basis = pools.vectors.view("Krylov vectors", vectors * unknowns)?.each(vectors);
        let vectors = slots * RESTART;
        let preconditioned = pools.vectors.view_after(Some(&basis), "preconditioned vectors", vectors * unknowns)?.each(vectors);
        let sums = context.zeros("partial sums", slots * (RESTART + 2) * chunks)?;
        let squares = context.zeros("partial squares", slots * chunks)?;
        let small = context.zeros("least-squares problems", slots * small_numbers())?;

        let arguments = args! {
            level: level.block,
            source,
            diagonal: level.diagonal,
            point_of,
            blocks,
            rows,
            matrix: level.matrix,
            counts,
        };
        let assemble = Call::of(context.bind(&ASSEMBLE, T::PRECISION, &arguments)?, finest.blocks() / 2);
        let call = |kernel, threads, arguments: &[Argument<'_>]| {
            Call::new(context, kernel, threads, &[&args! { level: level.block }, arguments].concat())
        };
        let with_product = |kernel, threads, x, arguments: &[Argument<'_>]| {
            Call::new(context, kernel, threads, &[&level.product(x), arguments].concat())
        };
        let w = &level.b;
        let by_rows = row_threads(finest.nodes);
        let dots = || call(&KRYLOV_DOTS, chunks * SUMMING, &args! { records, basis, w, partial_sums: sums });
        let orthogonalise = || {
            let arguments = args! { records, basis, partial_sums: sums, w, small, squares };
            call(&KRYLOV_ORTHOGONALISE, chunks * SUMMING, &arguments)
        };
        let normalise = || call(&KRYLOV_NORMALISE, unknowns, &args! { records, w, basis });
        // Twice is enough (Giraud, Langou & Rozloznik, Comput. Math. Appl. 50, 2005).
        let product = args! { is_fixed: level.fixed, records, w, preconditioned };
        let iteration = vec![
            with_product(&KRYLOV_PRODUCT, by_rows, &level.x, &product)?,
            dots()?,
            orthogonalise()?,
            dots()?,
            orthogonalise()?,
            call(&KRYLOV_ADVANCE, 1, &args! { records, squares, small })?,
        ];
        let next = normalise()?;
        let kernels = levels.cycle.iter().chain(&iteration).chain([&next]);
        let running = Running::new(context, kernels.map(Call::groups), &level.block, &records)?;
        let finish = vec![
            call(&KRYLOV_LEAST_SQUARES, 1, &args! { records, small })?,
            call(&KRYLOV_COMBINE, unknowns, &args! { records, small, preconditioned, solution, answer })?,
            with_product(&PLATE_FORCE, 1, &answer, &args! { plate, records })?,
        ];
        let begin = vec![call(&KRYLOV_BEGIN, 1, &args! { records, partial_sums: sums, small })?, normalise()?];
        let prescribe = call(&PRESCRIBE, by_rows, &args! { rhs, is_fixed: level.fixed, solution })?;
        let measure = call(&KRYLOV_MEASURE, 1, &args! { records, partial_sums: sums })?;
        let residual = args! { b: rhs, is_fixed: level.fixed, r: w, records };
        let residual = vec![with_product(&RESIDUAL, by_rows, &solution, &residual)?, dots()?];
        Ok(Self {
            assemble,
            prescribe,
            residual,
            measure,
            begin,
            iteration,
            running,
            next,
            finish,
            levels,
            records,
            rows,
            rhs,
            solution,
            guess,
            answer,
            unknowns,
            upper_numbers: 9 * plan.upper_blocks,
            vectors: Vectors { basis, preconditioned, small },
            _sums: [sums, squares],
            _lists: [source, point_of, plate],
            _counts: counts,
        })
    }

    /// Appends what makes the hierarchy's matrices from the tangents that are on the device.
    /// `rows` are the contact rows `[slot][slides, force rows, displacement rows][point]`, `fixed`
    /// the fixed components `[slot][node]`, a bit each.
    ///
    /// # Errors
    /// The device's fault.
    pub fn update(
        &self,
        context: &GpuContext,
        list: &mut Recorder<'_>,
        rows: &[f32],
        fixed: &[u32],
        slots: usize,
    ) -> Result<(), GpuError> {
        context.upload_at(&self.rows, 0, rows)?;
        context.upload_at(&self.levels.levels[0].fixed, 0, fixed)?;
        self.append_update(list, slots)
    }

    /// The same with rows and fixed components that are on the device.
    ///
    /// # Errors
    /// The device's fault.
    pub fn append_update(&self, list: &mut Recorder<'_>, slots: usize) -> Result<(), GpuError> {
        self.assemble.append(list, slots)?;
        append(&self.levels.update, list, slots)
    }

    /// Solves with a right-hand side of each slot after the kernels of `list`; returns the
    /// solutions `[slot][component][node]`. `and` are other arrays to be read at the first chance.
    ///
    /// # Errors
    /// The device's fault.
    pub fn solve(
        &self,
        context: &GpuContext,
        mut list: Recorder<'_>,
        right: &Right,
        and: (&StorageBuffer<u32>, &mut [u32]),
    ) -> Result<(Vec<f32>, Vec<SideReport>), GpuError> {
        let slots = right.tolerance.len();
        let mut solves = Solves::new(&right.tolerance, &right.relative_to_guess, right.expected);
        context.upload_at(&self.rhs, 0, &right.rhs)?;
        if let Some(guess) = &right.guess {
            context.upload_at(&self.guess, 0, guess)?;
        }
        self.set_out(context, &mut list, &solves, right.guess.is_some())?;
        let mut answer = vec![0.0; slots * self.unknowns];
        self.iterate(&mut list, solves.first_list(), slots)?;
        list.submit_and_read(&mut [self.read(&mut solves)?, self.answer.read(0, &mut answer)?, and.0.read(0, and.1)?])?;
        self.count(context, &mut solves);
        while solves.go_on() {
            let mut list = context.record();
            self.take_up(context, &mut list, &mut solves)?;
            list.submit_and_read(&mut [self.read(&mut solves)?, self.answer.read(0, &mut answer)?])?;
            self.count(context, &mut solves);
        }
        Ok((answer, solves.reports()))
    }

    /// Appends what begins solutions with the right-hand sides that are on the device, and with the
    /// guesses that are if they count.
    ///
    /// # Errors
    /// The device's fault.
    pub fn set_out(&self, context: &GpuContext, list: &mut Recorder<'_>, solves: &Solves, guess: bool) -> Result<(), GpuError> {
        context.upload_at(&self.records, 0, &solves.records)?;
        self.append_begin(list, solves.slots(), guess)
    }

    /// The same after other solutions of the list: `records`, to which it was told how these begin,
    /// are on the device.
    ///
    /// # Errors
    /// The device's fault.
    pub fn set_out_after(
        &self,
        list: &mut Recorder<'_>,
        records: &StorageBuffer<Record>,
        slots: usize,
        guess: bool,
    ) -> Result<(), GpuError> {
        list.copy(records, 0, &self.records, 0, slots)?;
        self.append_begin(list, slots, guess)
    }

    /// Appends a copy of how the present solutions stand.
    ///
    /// # Errors
    /// The device's fault.
    pub fn append_keep(&self, list: &mut Recorder<'_>, records: &StorageBuffer<Record>, slots: usize) -> Result<(), GpuError> {
        list.copy(&self.records, 0, records, 0, slots)
    }

    fn append_begin(&self, list: &mut Recorder<'_>, slots: usize, guess: bool) -> Result<(), GpuError> {
        self.prescribe.append(list, slots)?;
        append(&self.residual, list, slots)?;
        self.measure.append(list, slots)?;
        if guess {
            list.copy(&self.guess, 0, &self.solution, 0, slots * self.unknowns)?;
            append(&self.residual, list, slots)?;
        }
        append(&self.begin, list, slots)
    }

    /// Appends more of solutions that have not finished.
    ///
    /// # Errors
    /// The device's fault.
    pub fn take_up(&self, context: &GpuContext, list: &mut Recorder<'_>, solves: &mut Solves) -> Result<(), GpuError> {
        let slots = solves.slots();
        // All slots are in the same step of their cycles: those that go on are all full, or none.
        let records = &mut solves.records;
        let full: Vec<usize> = (0..slots).filter(|&slot| records[slot].done == FULL && records[slot].goes_on()).collect();
        for &slot in &full {
            // The next cycle begins at the answer of this one.
            list.copy(&self.answer, slot * self.unknowns, &self.solution, slot * self.unknowns, self.unknowns)?;
            (records[slot].done, records[slot].vectors, records[slot].steps) = (0, 0, 0);
            context.upload_at(&self.records, slot, &[records[slot]])?;
        }
        if !full.is_empty() {
            list.count_for(Some(full.len()));
            append(&self.residual, list, slots)?;
            append(&self.begin, list, slots)?;
        }
        self.iterate(list, MORE, slots)
    }

    /// What is to be read back of solutions.
    ///
    /// # Errors
    /// [`GpuError::Length`] for more slots than there are.
    pub fn read<'a>(&'a self, solves: &'a mut Solves) -> Result<Read<'a>, GpuError> {
        self.records.read(0, &mut solves.records)
    }

    /// Has a profile count what the Krylov iterations moved that came back in `solves`, which are
    /// those of one list, and the answers after them.
    pub fn count(&self, context: &GpuContext, solves: &mut Solves) {
        if !context.is_profiled() {
            return;
        }
        let new = solves.records.iter().zip(&solves.counted).map(|(r, counted)| r.iterations.saturating_sub(*counted));
        let new: Vec<u32> = new.collect();
        for i in 0..new.iter().copied().max().unwrap_or(0) {
            let running = || solves.records.iter().zip(&new).filter(|(_, new)| i < **new);
            // Those that run are all in the same step, which takes one vector more than the last.
            let vectors = running().map(|(r, new)| (r.steps + i).saturating_sub(*new) + 1).max().unwrap_or(0);
            for call in self.levels.cycle.iter().chain(&self.iteration).chain([&self.next]) {
                context.credit(call.bound.moved.as_ref(), running().count(), vectors as usize);
            }
        }
        for record in &solves.records {
            for call in &self.finish {
                context.credit(call.bound.moved.as_ref(), 1, record.steps as usize);
            }
        }
        solves.counted = solves.records.iter().map(|record| record.iterations).collect();
    }

    /// The arrays that Newton's iterates fill and read.
    pub fn of_iterates(&self) -> OfIterates<'_> {
        OfIterates {
            rhs: &self.rhs,
            fixed: &self.levels.levels[0].fixed,
            rows: &self.rows,
            guess: &self.guess,
            answer: &self.answer,
        }
    }

    /// Appends Krylov iterations, and the answers after them.
    ///
    /// # Errors
    /// The device's fault.
    pub fn iterate(&self, list: &mut Recorder<'_>, times: usize, slots: usize) -> Result<(), GpuError> {
        // Which slots leave them out is known when they have run: see `count`.
        list.count_for(Some(0));
        let running = &self.running;
        running.list.append(list, slots)?;
        for _ in 0..times {
            running.append(&self.levels.cycle, list, slots)?;
            running.append(&self.iteration, list, slots)?;
            running.list.append(list, slots)?;
            running.append(std::slice::from_ref(&self.next), list, slots)?;
        }
        append(&self.finish, list, slots)?;
        list.count_for(None);
        Ok(())
    }
}

/// How solutions stand, a slot each.
#[derive(Clone, Debug)]
pub struct Solves {
    records: Vec<Record>,
    expected: usize,
    /// Krylov iterations whose bytes a profile has, by slot.
    counted: Vec<u32>,
}

impl Solves {
    /// Solutions to these relative residuals, of the right-hand side or of the residual at the
    /// guess; that which takes most will probably take `expected` Krylov iterations.
    pub fn new(tolerance: &[f32], relative_to_guess: &[bool], expected: usize) -> Self {
        let mut records = Record::of_slots(tolerance.len());
        for ((record, &tolerance), &relative) in records.iter_mut().zip(tolerance).zip(relative_to_guess) {
            (record.tolerance, record.relative_to_start) = (tolerance, relative.into());
        }
        Self { records, expected, counted: vec![0; tolerance.len()] }
    }

    /// The same with `more` Krylov iterations in the first list.
    pub fn with_more(&self, more: usize) -> Self {
        Self { expected: self.expected + more, ..self.clone() }
    }

    /// How they begin, to be copied to where they are solved.
    ///
    /// # Errors
    /// The device's fault.
    pub fn send(&self, context: &GpuContext, to: &StorageBuffer<Record>) -> Result<(), GpuError> {
        context.upload_at(to, 0, &self.records)
    }

    /// What is to be read back of a copy of how they stand.
    ///
    /// # Errors
    /// [`GpuError::Length`] for more slots than there are.
    pub fn read_kept<'a>(&'a mut self, kept: &'a StorageBuffer<Record>) -> Result<Read<'a>, GpuError> {
        kept.read(0, &mut self.records)
    }

    /// Number of slots.
    pub fn slots(&self) -> usize {
        self.records.len()
    }

    /// Krylov iterations of the first list.
    pub fn first_list(&self) -> usize {
        (self.expected + 1).min(RESTART)
    }

    /// Some have not finished.
    pub fn go_on(&self) -> bool {
        self.records.iter().any(Record::goes_on)
    }

    /// How they went.
    pub fn reports(&self) -> Vec<SideReport> {
        self.records.iter().map(Record::report).collect()
    }
}

/// Arrays of the solver by which Newton's iterates reach it.
#[derive(Debug)]
pub struct OfIterates<'a> {
    /// Right-hand sides.
    pub rhs: &'a StorageBuffer<f32>,
    /// Fixed components.
    pub fixed: &'a StorageBuffer<u32>,
    /// Rows of points that slide.
    pub rows: &'a StorageBuffer<f32>,
    /// Guesses.
    pub guess: &'a StorageBuffer<f32>,
    /// Solutions.
    pub answer: &'a StorageBuffer<f32>,
}

impl Record {
    fn goes_on(&self) -> bool {
        (self.done == 0 || self.done == FULL) && (self.iterations as usize) < MOST
    }

    fn report(&self) -> SideReport {
        SideReport {
            ended: match self.done {
                CONVERGED => Ended::Converged,
                NOT_FINITE => Ended::NotFinite,
                _ => Ended::Stalled,
            },
            iterations: self.iterations as usize,
            rhs_norm: self.rhs_norm.into(),
            start_norm: self.start_norm.into(),
            residual: self.residual.into(),
            along: self.along.into(),
        }
    }
}

fn append(calls: &[Call], list: &mut Recorder<'_>, slots: usize) -> Result<(), GpuError> {
    calls.iter().try_for_each(|call| call.append(list, slots))
}

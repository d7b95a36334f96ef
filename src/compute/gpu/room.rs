//! What a batch takes of a device's memory, and how many slots there is room for.

use super::buffers::DeviceReal;
use super::context::GpuContext;
use super::error::GpuError;
use super::iterate::arrays::{Kept, Told};
use super::layout::{BLOCKS_OF_SLOTS, MOST_SLOTS, NEXT_HISTORY, ROWS, STRESS};
use super::linear::plan::Plan;
use super::pools::PoolBytes;
use super::resident::BatchSizes;
use super::scratch::Scratch;
use super::source::Precision;
use super::tangents::{Bytes, Tangents};

/// Bytes of a batch, and what it has for that.
pub struct DeviceRoom<'a> {
    context: &'a GpuContext,
    cases: usize,
    in_f32: bool,
    tangents: Bytes,
    /// Of a slot: the stresses and the new states that pools have in turn.
    stresses: u64,
    states: u64,
    /// Of a slot, but for the pools: arrays of evaluations, of iterates, what a trial finds.
    own: u64,
    told: u64,
    answers: u64,
    /// The widest array of a case, and what it keeps of iterates.
    widest: u64,
    kept: u64,
    /// How linear systems are solved, where there is room for it.
    pub linear: Option<Plan>,
    /// Whether there is room for iterates.
    pub keeps: bool,
    /// What the user should know.
    pub notes: Vec<String>,
}

impl<'a> DeviceRoom<'a> {
    /// That of so many cases, without linear systems and iterates.
    pub fn new<R: DeviceReal>(context: &'a GpuContext, sizes: BatchSizes, cases: usize, in_single: bool) -> Self {
        let numbers = |numbers: usize| (numbers * size_of::<R>()) as u64;
        let tangents = Tangents::<R>::bytes(sizes, in_single);
        Self {
            context,
            cases,
            in_f32: R::PRECISION == Precision::F32,
            stresses: numbers(STRESS * sizes.points()),
            states: numbers(NEXT_HISTORY * sizes.points()),
            own: Scratch::<R>::bytes(sizes) + tangents.of_slot,
            told: Told::<R>::bytes(sizes),
            answers: numbers(3 * sizes.nodes + ROWS * sizes.contact_points),
            widest: sizes.resident_bytes::<R>().0,
            kept: Kept::<R>::bytes(sizes),
            tangents,
            linear: None,
            keeps: false,
            notes: Vec::new(),
        }
    }

    /// The pools of a slot.
    pub fn pools(&self) -> PoolBytes {
        self.pools_with(self.linear.as_ref())
    }

    fn pools_with(&self, linear: Option<&Plan>) -> PoolBytes {
        PoolBytes {
            vectors: self.tangents.elements.max(self.states).max(linear.map_or(0, Plan::krylov_bytes)),
            blocks: self.tangents.blocks.max(self.stresses).max(linear.map_or(0, Plan::product_bytes)),
        }
    }

    /// What all cases have besides their residents, what comes down of one case: its state, and its
    /// tangent after a linear solve that stalled; and blocks of parameters by slot.
    fn besides(&self) -> u64 {
        self.tangents.of_case * self.cases as u64 + self.states.max(self.tangents.blocks) + BLOCKS_OF_SLOTS
    }

    /// The widest array of a slot, and all of it with what comes down: what a trial finds, and its
    /// tangent where the host solves.
    fn of_slot(&self, linear: Option<&Plan>) -> (u64, u64) {
        let (widest, pools) = self.pools_with(linear).widest_and_all();
        let (array, sum) = linear.map_or((0, 0), Plan::bytes);
        let down = if linear.is_some() { self.answers } else { self.answers.max(self.tangents.blocks) };
        (widest.max(array), self.own + pools + sum + down)
    }

    fn note(&mut self, note: String) {
        log::info!("{note}");
        self.notes.push(note);
    }

    /// Takes a linear solver, if there is room for it.
    ///
    /// # Errors
    /// [`GpuError::OutOfBudget`] or [`GpuError::TooLarge`], where fewer cases may have it.
    pub fn place_linear(&mut self, plan: Option<Plan>) -> Result<(), GpuError> {
        let Some(plan) = plan else { return Ok(()) };
        let ((widest, all), lists) = (self.of_slot(Some(&plan)), plan.shared_bytes());
        let what = "the linear solver of one case";
        let fits = self.context.has_room(what, all + self.besides() + lists);
        match fits.and_then(|()| self.context.chunks(what, 1, widest, 0)) {
            Ok(_) => self.linear = Some(plan),
            Err(error) if self.cases == 1 => self.note(format!("the linear systems are solved on the CPU: {error}")),
            Err(error) => return Err(error),
        }
        Ok(())
    }

    /// Takes iterates, if they are wanted, linear systems are solved and there is room for them.
    ///
    /// # Errors
    /// [`GpuError::OutOfBudget`] where there is none for an evaluation.
    pub fn place_iterates(&mut self, wanted: bool) -> Result<(), GpuError> {
        let all = self.of_slot(self.linear.as_ref()).1 + self.besides();
        self.keeps = wanted && self.linear.is_some();
        if self.keeps && self.cases == 1 && self.in_f32 {
            // What is missing here costs speed alone.
            if let Err(error) = self.context.has_room("the steps of one case", all + self.kept + self.told) {
                self.note(format!("steps are made on the CPU, with tangents from the device: {error}"));
                self.keeps = false;
            }
        }
        let of_iterates = if self.keeps { self.told + self.kept * self.cases as u64 } else { 0 };
        self.context.has_room("an evaluation of one case", all + of_iterates)
    }

    /// How many slots there is room for, of which no more than `most` are needed, and no more than
    /// [`MOST_SLOTS`] can be.
    ///
    /// # Errors
    /// [`GpuError::OutOfBudget`] or [`GpuError::TooLarge`] if there is none for one.
    pub fn slots(&mut self, most: usize) -> Result<usize, GpuError> {
        let (widest, mut all) = self.of_slot(self.linear.as_ref());
        all += if self.keeps { self.told } else { 0 };
        // What the slots share is set aside while their number is found.
        let lists = self.linear.as_ref().map_or(0, Plan::shared_bytes);
        let set_aside = self.context.budget.reserve("lists of the linear solver", lists + self.besides())?;
        let slots =
            self.context.chunks("an evaluation", most.min(MOST_SLOTS), widest, all)?.iter().map(|c| c.count).max().unwrap_or(1);
        drop(set_aside);
        self.note_cut(widest.max(self.widest))?;
        Ok(slots)
    }

    /// Notes where an array in a kernel holds fewer cases than there are, of which the widest takes
    /// so many bytes each.
    fn note_cut(&mut self, widest: u64) -> Result<(), GpuError> {
        let (adapter, cases) = (self.context.adapter(), self.cases);
        let chunks = self.context.chunks_of_bindings("an evaluation", cases, widest)?;
        let most = chunks.iter().map(|chunk| chunk.count).max().unwrap_or(cases);
        if most < cases {
            let mib = adapter.max_binding.min(adapter.max_buffer) as f64 / f64::from(1 << 20);
            let name = &adapter.name;
            self.note(format!(
                "a kernel of {name} sees {mib} MiB of an array: of {cases} cases of a batch no more than {most} go at a time"
            ));
        }
        Ok(())
    }
}

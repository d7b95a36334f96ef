//! The linear systems of an equal pair, in the unknowns of its interface: T^T K T is applied, K
//! being the finest level's matrix of the whole body, and each half of it, folded at x = 0, has a
//! V-cycle for what is even and one for what is odd (see `solver::systems::pair`).

use std::sync::{Arc, Mutex, PoisonError};

use super::super::arguments::{Argument, args};
use super::super::buffers::{DeviceReal, StorageBuffer};
use super::super::context::GpuContext;
use super::super::error::GpuError;
use super::super::kernel::Kernel;
use super::super::pipelines::KernelList;
use super::super::pools::Pools;
use super::arrays::Arrays;
use super::calls::{RunningSlots, SizedKernel, append, count};
use super::kernels::{LinearKernels, VectorKernels};
use super::levels::{LevelArrays, Levels};
use super::records::{Record, Solves};
use super::sources::{FOLD, FOLD_MATRIX, PLATE_FORCE, TIE_MAP, TIE_MEET, TIE_PRODUCT, TIE_RESIDUAL, TIE_RUNNING, UNFOLD};
use super::tied_plan::{TIE_BLOCK, TiedPlan};
use crate::compute::linear::PairTie;
use crate::contact::maps::{NodeMap, PairMaps};

/// The number of each map (see [`PairMaps::all`]).
const HALVES: u32 = 0;
const NODAL: u32 = 1;
const CONTRACT: u32 = 2;
const EXPAND: u32 = 3;
const REDUCE: u32 = 4;
/// As `tie_map.wgsl` has them.
pub(in super::super) const TIE_CLEARS: u32 = 1;
pub(in super::super) const TIE_KEEPS_FREE: u32 = 2;
pub(in super::super) const TIE_OF_ALL: u32 = 4;

/// What ties the pairs of a dispatch, slot by slot.
pub type Ties<'a> = [&'a PairTie];

/// The systems of pairs in a batch's slots.
#[derive(Debug)]
pub struct TiedSolver {
    half: Levels,
    maps: StorageBuffer<u32>,
    words: usize,
    points: usize,
    /// What each slot has of interfaces.
    known: Mutex<Vec<Option<Arc<PairMaps>>>>,
    fold_matrix: SizedKernel,
    /// The residual at `solution`, and its square.
    pub(super) residual: Vec<SizedKernel>,
    /// Which slots run, by kernels of the whole body and of its halves.
    running: RunningSlots,
    half_running: RunningSlots,
    before: Vec<SizedKernel>,
    after: Vec<SizedKernel>,
    /// The answer, and the plate's force along it.
    finish: Vec<SizedKernel>,
    _small: Vec<StorageBuffer<[u32; 4]>>,
    _folded: FoldedBody,
    _records: StorageBuffer<Record>,
}

/// What the slots share of a folded body.
#[derive(Debug)]
struct FoldedBody {
    sides: StorageBuffer<u32>,
    nodes_of: StorageBuffer<u32>,
    half_of: StorageBuffer<u32>,
    whole_nodes: StorageBuffer<[u32; 4]>,
    half_nodes: StorageBuffer<[u32; 4]>,
}

impl FoldedBody {
    fn new(context: &GpuContext, plan: &TiedPlan) -> Result<Self, GpuError> {
        let list = |list: &[u32]| Ok::<_, GpuError>(context.array("a folded body", list)?.whole());
        let count = |nodes: usize| {
            let block = context.block("nodes of a body")?;
            context.upload(&block, &[[nodes as u32, 0, 0, 0]])?;
            Ok::<_, GpuError>(block)
        };
        Ok(Self {
            sides: list(&plan.sides)?,
            nodes_of: list(&plan.nodes_of)?,
            half_of: list(&plan.half_of)?,
            whole_nodes: count(plan.half_of.len())?,
            half_nodes: count(plan.layout.levels[0].nodes)?,
        })
    }
}

/// Binds the kernels that take vectors of the whole body. They pass through arrays that the finest
/// level has for a V-cycle of its own: `other` has the unknowns y, `residual` loads and then
/// displacements, `last_step` K u, `x` what the V-cycles make and then the forces of y.
struct Binder<'a> {
    context: &'a GpuContext,
    level: &'a LevelArrays,
    finest: &'a LevelArrays,
    arrays: &'a Arrays,
    folded: &'a FoldedBody,
    maps: &'a StorageBuffer<u32>,
    /// Words of a slot's maps, and contact points.
    shape: [u32; 2],
    /// Blocks of parameters.
    small: Vec<StorageBuffer<[u32; 4]>>,
}

impl Binder<'_> {
    fn call(&self, kernel: &'static Kernel, arguments: &[&[Argument<'_>]]) -> Result<SizedKernel, GpuError> {
        SizedKernel::new(self.context, kernel, self.level.threads(), &arguments.concat())
    }

    /// A vector through map number `map`.
    fn map(
        &mut self,
        (map, flags): (u32, u32),
        given: &StorageBuffer<f32>,
        to: &StorageBuffer<f32>,
    ) -> Result<SizedKernel, GpuError> {
        let tie = self.context.block("a map of an interface")?;
        let [words, points] = self.shape;
        self.context.upload(&tie, &[[words, points, map, flags]])?;
        let (level, arrays) = (self.level, self.arrays);
        let arguments = args! {
            level: level.block,
            tie,
            maps: self.maps,
            point_of: arrays.point_of,
            is_fixed: level.fixed,
            records: arrays.records,
            given,
            to,
        };
        let call = self.call(&TIE_MAP, &[&arguments])?;
        self.small.push(tie);
        Ok(call)
    }

    /// f = K x.
    fn product(&self, x: &StorageBuffer<f32>) -> Result<SizedKernel, GpuError> {
        let arguments = args! { records: self.arrays.records, f: self.level.last_step };
        self.call(&TIE_PRODUCT, &[&self.level.product(x), &arguments])
    }

    /// What `tie_met.wgsl` takes.
    fn met<'a>(&'a self, y: &'a StorageBuffer<f32>) -> [Argument<'a>; 8] {
        let (level, arrays) = (self.level, self.arrays);
        args! {
            level: level.block,
            point_of: arrays.point_of,
            is_fixed: level.fixed,
            records: arrays.records,
            force: level.x,
            y,
            rows: arrays.rows,
            counts: arrays.counts,
        }
    }

    /// T^T K T of the unknowns in an array, up to the conditions of contact.
    fn forces(&mut self, y: &StorageBuffer<f32>) -> Result<[SizedKernel; 3], GpuError> {
        let level = self.level;
        Ok([
            self.map((EXPAND, 0), y, &level.residual)?,
            self.product(&level.residual)?,
            self.map((REDUCE, 0), &level.last_step, &level.x)?,
        ])
    }

    /// From a basis vector to the right-hand sides of the V-cycles.
    fn before(&mut self) -> Result<Vec<SizedKernel>, GpuError> {
        let (level, finest, records) = (self.level, self.finest, &self.arrays.records);
        let FoldedBody { nodes_of, whole_nodes, .. } = self.folded;
        let folds = args! { level: finest.block, nodes_of, is_fixed: finest.fixed, records, whole_nodes };
        let folds = [&folds[..], &args! { given: level.residual, to: finest.b }].concat();
        Ok(vec![
            self.map((HALVES, TIE_KEEPS_FREE), &level.b, &level.other)?,
            self.map((NODAL, 0), &level.other, &level.residual)?,
            SizedKernel::new(self.context, &FOLD, finest.threads(), &folds)?,
        ])
    }

    /// From their solutions to the next vector.
    fn after(&mut self) -> Result<Vec<SizedKernel>, GpuError> {
        let (level, arrays, records) = (self.level, self.arrays, &self.arrays.records);
        let FoldedBody { half_of, half_nodes, .. } = self.folded;
        let unfolds = args! { level: level.block, half_of, records, given: self.finest.x, to: level.x, half_nodes };
        let mut out = vec![self.call(&UNFOLD, &[&unfolds])?, self.map((CONTRACT, TIE_CLEARS), &level.x, &level.other)?];
        out.extend(self.forces(&level.other)?);
        let kept = args! { w: level.b, preconditioned: arrays.preconditioned };
        out.push(self.call(&TIE_MEET, &[&self.met(&level.other), &kept])?);
        out.extend(self.vectors().orthogonalisation()?);
        Ok(out)
    }

    fn vectors(&self) -> VectorKernels<'_> {
        VectorKernels { context: self.context, level: self.level, arrays: self.arrays }
    }

    /// The residual at `solution`, and its square.
    fn residual(&mut self) -> Result<Vec<SizedKernel>, GpuError> {
        let (level, arrays) = (self.level, self.arrays);
        let mut out = Vec::from(self.forces(&arrays.solution)?);
        let left = args! { b: arrays.rhs, r: level.b };
        out.push(self.call(&TIE_RESIDUAL, &[&self.met(&arrays.solution), &left])?);
        out.push(self.vectors().dots()?);
        Ok(out)
    }

    /// The answer, and the plate's force along it.
    fn finish(&mut self) -> Result<Vec<SizedKernel>, GpuError> {
        let (level, arrays) = (self.level, self.arrays);
        let mut out = self.vectors().answer()?;
        out.push(self.map((EXPAND, TIE_OF_ALL), &arrays.answer, &level.residual)?);
        let along = args! { plate: arrays.plate, records: arrays.records };
        out.push(SizedKernel::new(self.context, &PLATE_FORCE, 1, &[&level.product(&level.residual)[..], &along].concat())?);
        Ok(out)
    }
}

impl TiedSolver {
    /// The arrays and kernels for so many slots; the others are those of one body.
    ///
    /// # Errors
    /// What the device says.
    pub fn new<T: DeviceReal>(
        context: &GpuContext,
        tied: &TiedPlan,
        (slots, pools): (usize, &Pools),
        (level, arrays, kernels): (&LevelArrays, &Arrays, &LinearKernels),
        blocks: &StorageBuffer<T>,
    ) -> Result<Self, GpuError> {
        let records = context.array("linear solves of halves", &Record::of_slots(2 * slots))?;
        let half = Levels::new(context, &tied.layout, (2 * slots, pools), 0, &records)?;
        let words = tied.words();
        let maps = context.zeros("maps of interfaces", slots * words)?.each(slots);
        let (folded, finest) = (FoldedBody::new(context, tied)?, &half.levels[0]);
        let shape = [words as u32, tied.contact_points as u32];
        let mut bind = Binder { context, level, finest, arrays, folded: &folded, maps: &maps, shape, small: Vec::new() };
        let (before, after) = (bind.before()?, bind.after()?);
        let (residual, finish) = (bind.residual()?, bind.finish()?);
        let small = bind.small;
        let groups = before.iter().chain(&after).chain([&kernels.next]).map(SizedKernel::groups);
        let running = RunningSlots::new(context, groups, &level.block, &arrays.records)?;
        let half_running = RunningSlots::of(context, half.cycle.iter().map(SizedKernel::groups), |calls| {
            let arguments = args! { records: arrays.records, halves: records, calls };
            SizedKernel::new(context, &TIE_RUNNING, 1, &arguments)
        })?;
        let of_matrix = args! { level: finest.block, blocks, sides: folded.sides, matrix: finest.matrix, counts: arrays.counts };
        let fold_matrix = context.bind(&FOLD_MATRIX, T::PRECISION, &of_matrix)?;
        let fold_matrix = SizedKernel::of(fold_matrix, tied.layout.levels[0].blocks() / 2);
        let (known, points) = (Mutex::new(vec![None; slots]), tied.contact_points);
        Ok(Self {
            half,
            maps,
            words,
            points,
            known,
            fold_matrix,
            residual,
            running,
            half_running,
            before,
            after,
            finish,
            _small: small,
            _folded: folded,
            _records: records,
        })
    }

    /// Sends what ties the pairs of a dispatch, as far as the slots have not got it; for which of
    /// them there is room. The others keep what was there, and nobody reads their solutions.
    ///
    /// # Errors
    /// The device's fault.
    pub fn send(&self, context: &GpuContext, ties: &Ties<'_>) -> Result<Vec<bool>, GpuError> {
        let mut has_room = vec![true; ties.len()];
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        for (slot, tie) in ties.iter().enumerate() {
            if known[slot].as_ref().is_some_and(|known| Arc::ptr_eq(known, &tie.maps)) {
                continue;
            }
            let words = packed(&tie.maps);
            if words.len() > self.words || tie.maps.all().iter().any(|map| map.start.len() != self.points + 1) {
                log::debug!("the maps of an interface take {} words where there are {}", words.len(), self.words);
                has_room[slot] = false;
                continue;
            }
            context.upload_at(&self.maps, slot * self.words, &words)?;
            known[slot] = Some(tie.maps.clone());
        }
        let bits = |f: &[bool; 3]| u32::from(f[0]) | u32::from(f[1]) << 1 | u32::from(f[2]) << 2;
        let halves = ties.iter().flat_map(|tie| &tie.halves);
        let fixed: Vec<u32> = halves.flat_map(|half| half.as_chunks::<3>().0.iter().map(bits)).collect();
        context.upload_at(&self.half.levels[0].fixed, 0, &fixed)?;
        Ok(has_room)
    }

    /// Appends what makes the halves' hierarchies from the tangents.
    ///
    /// # Errors
    /// The device's fault.
    pub fn append_update(&self, list: &mut KernelList<'_>, slots: usize) -> Result<(), GpuError> {
        self.fold_matrix.append(list, slots)?;
        append(&self.half.update, list, 2 * slots)
    }

    /// As [`super::solver::SlotSolver::iterate`].
    ///
    /// # Errors
    /// The device's fault.
    pub fn iterate(&self, list: &mut KernelList<'_>, next: &SizedKernel, times: usize, slots: usize) -> Result<(), GpuError> {
        list.count_for(Some(0));
        let lists = |list: &mut KernelList<'_>| {
            self.running.list.append(list, slots)?;
            self.half_running.list.append(list, slots)
        };
        lists(list)?;
        for _ in 0..times {
            self.running.append(&self.before, list, slots)?;
            self.half_running.append(&self.half.cycle, list, 2 * slots)?;
            self.running.append(&self.after, list, slots)?;
            lists(list)?;
            self.running.append(std::slice::from_ref(next), list, slots)?;
        }
        append(&self.finish, list, slots)?;
        list.count_for(None);
        Ok(())
    }

    /// As [`super::solver::SlotSolver::count`].
    pub fn count(&self, context: &GpuContext, next: &SizedKernel, solves: &mut Solves) {
        let half = self.half.cycle.iter().map(|call| (call, 2));
        let whole = self.before.iter().chain(&self.after).chain([next]).map(|call| (call, 1));
        count(context, solves, &half.chain(whole).collect::<Vec<_>>(), &self.finish);
    }
}

/// The words of a slot, as `tie.wgsl` has them.
fn packed(maps: &PairMaps) -> Vec<u32> {
    let maps = maps.all();
    let mut first: usize = maps.iter().map(|map| map.start.len()).sum();
    let mut words = Vec::with_capacity(first);
    for map in maps {
        words.extend(map.start.iter().map(|start| (first + TIE_BLOCK * *start as usize) as u32));
        first += TIE_BLOCK * map.column.len();
    }
    let of_map = |map: &NodeMap| -> Vec<u32> {
        let blocks = map.column.iter().zip(&map.block);
        blocks.flat_map(|(&node, block)| std::iter::once(node).chain(block.map(|x| (x as f32).to_bits()))).collect()
    };
    maps.iter().for_each(|map| words.extend(of_map(map)));
    words
}

#[cfg(test)]
mod tests {
    use super::super::tied_plan::words;
    use super::*;
    use crate::contact::pair::{Image, PairInterface};
    use crate::mesh::{SphereSpec, sphere_mesh, whole};

    #[test]
    fn there_is_room_for_the_maps_of_every_slide() {
        let half = |elements_per_contact_radius| {
            let skin =
                SphereSpec { contact_radius: 0.2, elements_per_contact_radius, fine_zone: 1.6, skin_levels: 0, first_layer: 1.0 };
            sphere_mesh(&skin).unwrap()
        };
        for mesh in [half(4), half(12), whole(&half(4)), whole(&half(8))] {
            let size = 0.2 / 12.0;
            for by in [0.0, 0.1, 0.25, 0.5, 0.75, 1.0, 2.3, 5.4, 9.5].map(|share: f64| share * size) {
                let u: Vec<f64> = mesh.nodes.iter().flat_map(|x| [by, 0.0, -0.01 - 0.003 * x[0]]).collect();
                let taken = packed(&PairInterface::new(&mesh, &u, Image::HalfTurn).maps()).len();
                let room = words(mesh.contact_nodes.len());
                assert!(taken <= room, "{} points slid by {by}: {taken} words of {room}", mesh.contact_nodes.len());
            }
        }
    }
}

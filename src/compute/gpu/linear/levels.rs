//! The levels of the multigrid hierarchy on a device, and the kernels that are bound to them.

use super::super::arguments::{Argument, args};
use super::super::buffers::StorageBuffer;
use super::super::context::GpuContext;
use super::super::error::GpuError;
use super::super::kernel::Kernel;
use super::super::pools::Pools;
use super::calls::SizedKernel;
use super::records::Record;
use super::sizes::{Cost, LevelShape, MOST_STEPS, RESTART, SMALL_NODES, row_threads};
use super::sources::{
    CYCLE_RESIDUAL, GALERKIN_COARSE, GALERKIN_PRODUCT, INVERT_DIAGONAL, PROLONG, RESTRICT, SMALL_DOWN, SMALL_UP, SMOOTH_START,
    SMOOTH_STEP, SOLVE_COARSEST,
};
use crate::linalg::layout::{HierarchyLayout, LevelLayout, Lists, SparseRows, TransferLayout};

/// What all levels share.
#[derive(Clone, Copy, Debug)]
pub struct Common<'a> {
    slots: usize,
    /// Memory for A P, of the finest level alone.
    pool: Option<&'a StorageBuffer<u32>>,
    plate_nodes: usize,
    coarsest_steps: usize,
    smoothing_steps: usize,
}

/// One level's arrays.
#[derive(Debug)]
pub struct LevelArrays {
    /// Its sizes.
    pub block: StorageBuffer<LevelShape>,
    /// Columns `[k][node]`.
    pub column: StorageBuffer<u32>,
    /// k of each diagonal block.
    pub diagonal: StorageBuffer<u32>,
    /// The matrix, in halves of its numbers: see `halves.wgsl`.
    pub matrix: StorageBuffer<u32>,
    /// Fixed components `[slot][node]`; nothing is fixed but on the finest level.
    pub fixed: StorageBuffer<u32>,
    /// Right-hand side.
    pub b: StorageBuffer<f32>,
    /// Where the cycle leaves its solution.
    pub x: StorageBuffer<f32>,
    /// Inverses of the diagonal blocks, and what rounding takes from the rows,
    /// `[slot][inverse, lost][3 i + j][node]`.
    pub inverse: StorageBuffer<f32>,
    pub(super) other: StorageBuffer<f32>,
    pub(super) last_step: StorageBuffer<f32>,
    pub(super) residual: StorageBuffer<f32>,
    transfer: Option<TransferArrays>,
    nodes: usize,
    width: usize,
}

#[derive(Debug)]
struct TransferArrays {
    product_lists: DeviceLists,
    coarse_lists: DeviceLists,
    /// As `transfer.wgsl` has them.
    prolongation: StorageBuffer<u32>,
    restriction: StorageBuffer<u32>,
    product: StorageBuffer<f32>,
    products: usize,
    coarse_blocks: usize,
    coarse_nodes: usize,
}

#[derive(Debug)]
struct DeviceLists {
    start: StorageBuffer<u32>,
    entry: StorageBuffer<u32>,
    weight: StorageBuffer<f32>,
}

impl DeviceLists {
    fn new(context: &GpuContext, what: &str, start: &[u32], entry: &[u32], weight: &[f32]) -> Result<Self, GpuError> {
        Ok(Self {
            start: context.array(&format!("{what}: starts"), start)?.whole(),
            entry: context.array(what, entry)?.whole(),
            weight: context.array(&format!("{what}: weights"), weight)?.whole(),
        })
    }

    fn of_lists(context: &GpuContext, what: &str, lists: &Lists) -> Result<Self, GpuError> {
        Self::new(context, what, &lists.start, &lists.entry, &lists.weight)
    }

    /// As `galerkin.wgsl` has them.
    fn as_lists(&self) -> [Argument<'_>; 3] {
        args! { list_start: self.start, list_entry: self.entry, list_weight: self.weight }
    }
}

/// A matrix as `transfer.wgsl` has it: where each row begins, then columns with their weights.
fn transfer_rows(rows: &SparseRows) -> Vec<u32> {
    let first = rows.start.len() as u32;
    let entries = rows.column.iter().zip(&rows.weight).flat_map(|(&column, weight)| [column, weight.to_bits()]);
    rows.start.iter().map(|start| first + 2 * start).chain(entries).collect()
}

/// Numbers that a slot takes on a level: the widest array, and all.
pub fn slot_numbers(level: &LevelLayout) -> (usize, usize) {
    (9 * level.blocks(), 9 * level.blocks() + (2 * 9 + 1 + 5 * 3) * level.nodes)
}

/// Numbers of a level's A P.
pub fn product_numbers(level: &LevelLayout) -> usize {
    level.transfer.as_ref().map_or(0, |t| 9 * (t.product.start.len() - 1))
}

/// Numbers of a level that all slots share.
pub fn shared_numbers(level: &LevelLayout) -> usize {
    let transfer = level.transfer.as_ref().map_or(0, |t| {
        let lists = |lists: &Lists| lists.start.len() + lists.entry.len() + lists.weight.len();
        let rows = |rows: &SparseRows| rows.start.len() + rows.column.len() + rows.weight.len();
        lists(&t.product) + lists(&t.coarse) + rows(&t.prolongation) + rows(&t.restriction)
    });
    level.column.len() + level.diagonal.len() + transfer
}

impl LevelArrays {
    /// The arrays of a level for so many slots.
    ///
    /// # Errors
    /// What the device says.
    pub fn new(
        context: &GpuContext,
        layout: &LevelLayout,
        next: Option<&LevelLayout>,
        common: Common<'_>,
    ) -> Result<Self, GpuError> {
        let slots = common.slots;
        let zeros = |what: &str, numbers: usize| Ok::<_, GpuError>(context.zeros(what, slots * numbers)?.each(slots));
        let transfer = match (&layout.transfer, next) {
            (Some(transfer), Some(next)) => {
                let numbers = slots * product_numbers(layout);
                let product = match common.pool {
                    Some(pool) => pool.view("products A P", numbers)?,
                    None => context.zeros("products A P", numbers)?,
                };
                Some(TransferArrays::new(context, transfer, next, product.each(slots))?)
            }
            _ => None,
        };
        let shape = LevelShape {
            nodes: layout.nodes as u32,
            width: layout.width as u32,
            coarse_nodes: next.map_or(0, |next| next.nodes as u32),
            products: transfer.as_ref().map_or(0, |t| t.products as u32),
            coarse_width: next.map_or(0, |next| next.width as u32),
            restart: RESTART as u32,
            plate_nodes: common.plate_nodes as u32,
            coarsest_steps: common.coarsest_steps as u32,
            smoothing_steps: common.smoothing_steps as u32,
            reserved: [0; 3],
        };
        let block = context.block("a level")?;
        context.upload(&block, &[shape])?;
        let vector = 3 * layout.nodes;
        Ok(Self {
            block,
            column: context.array("columns of a level", &layout.column)?.whole(),
            diagonal: context.array("diagonals of a level", &layout.diagonal)?.whole(),
            matrix: context.zeros("matrices of a level", slots * 9 * layout.blocks())?.each(slots),
            fixed: context.zeros("fixed unknowns", slots * layout.nodes)?.each(slots),
            b: zeros("right-hand sides of a level", vector)?,
            x: zeros("solutions of a level", vector)?,
            inverse: zeros("diagonal blocks of a level", 2 * 9 * layout.nodes)?,
            other: zeros("iterates of a level", vector)?,
            last_step: zeros("steps of a level", vector)?,
            residual: zeros("residuals of a level", vector)?,
            transfer,
            nodes: layout.nodes,
            width: layout.width,
        })
    }

    /// Its nodes, and blocks in a row.
    pub fn size(&self) -> (usize, usize) {
        (self.nodes, self.width)
    }

    /// A product with its matrix, and what the result takes and gives.
    pub fn product_account(&self) -> Cost {
        let (nodes, blocks) = (self.nodes, self.width * self.nodes);
        Cost { numbers: 9 * blocks + (3 * 3 + 1) * nodes, shared: blocks, operations: 18 * blocks }
    }

    /// The same with the rounded matrix, whose numbers take half the bytes, and what it lacks.
    fn rounded_account(&self) -> Cost {
        let product = self.product_account();
        let (nodes, blocks) = (self.nodes, self.width * self.nodes);
        Cost { numbers: product.numbers - 9 * blocks / 2 + 9 * nodes, operations: product.operations + 18 * nodes, ..product }
    }

    /// A step of its smoother: such a product, D^-1, right-hand side, last step and iterate.
    pub fn step_account(&self) -> Cost {
        let product = self.rounded_account();
        let nodes = self.nodes;
        Cost { numbers: product.numbers + (9 + 3 * 3) * nodes, operations: product.operations + 30 * nodes, ..product }
    }

    /// A P of it, and the next level's matrix of that.
    pub fn galerkin_account(&self) -> Cost {
        let Some(transfer) = &self.transfer else { return Cost::default() };
        let (products, coarse) = (9 * transfer.products, 9 * transfer.coarse_blocks);
        let lists = [&transfer.product_lists, &transfer.coarse_lists];
        Cost {
            numbers: 9 * self.width * self.nodes + 2 * products + coarse + self.nodes,
            shared: lists.iter().map(|list| list.start.len() + 2 * list.entry.len()).sum(),
            operations: lists.iter().map(|list| 18 * list.entry.len()).sum(),
        }
    }

    /// Threads for its rows.
    pub fn threads(&self) -> usize {
        row_threads(self.nodes)
    }

    /// Its sizes, columns and matrix, and a vector to be multiplied.
    pub fn product<'a>(&'a self, x: &'a StorageBuffer<f32>) -> [Argument<'a>; 4] {
        args! { level: self.block, column: self.column, matrix: self.matrix, x }
    }
}

impl TransferArrays {
    fn new(
        context: &GpuContext,
        layout: &TransferLayout,
        next: &LevelLayout,
        product: StorageBuffer<f32>,
    ) -> Result<Self, GpuError> {
        let products = layout.product.start.len() - 1;
        Ok(Self {
            product_lists: DeviceLists::of_lists(context, "blocks of A P", &layout.product)?,
            coarse_lists: DeviceLists::of_lists(context, "blocks of the next level", &layout.coarse)?,
            prolongation: context.array("prolongation", &transfer_rows(&layout.prolongation))?.whole(),
            restriction: context.array("restriction", &transfer_rows(&layout.restriction))?.whole(),
            product,
            products,
            coarse_blocks: next.blocks(),
            coarse_nodes: next.nodes,
        })
    }
}

/// The hierarchy.
#[derive(Debug)]
pub struct Levels {
    /// Finest first.
    pub levels: Vec<LevelArrays>,
    /// After the finest matrix has changed.
    pub update: Vec<SizedKernel>,
    /// One V-cycle on the finest level's b.
    pub cycle: Vec<SizedKernel>,
    smoothing_steps: usize,
    _shares: Vec<StorageBuffer<[f32; 4]>>,
    _all_shares: StorageBuffer<[f32; 4]>,
    _coarsest: StorageBuffer<[f32; 2]>,
}

impl Levels {
    /// The arrays of all levels for so many slots, and their kernels, which leave out slots that
    /// `records` has as done.
    ///
    /// # Errors
    /// What the device says.
    pub fn new(
        context: &GpuContext,
        layout: &HierarchyLayout,
        (slots, pools): (usize, &Pools),
        plate_nodes: usize,
        records: &StorageBuffer<Record>,
    ) -> Result<Self, GpuError> {
        let layouts = &layout.levels;
        let (coarsest_steps, smoothing_steps) = (layout.coarsest.len(), layout.smoother.len());
        let pool = |l: usize| (l == 0).then_some(&pools.blocks);
        let common = |l| Common { slots, pool: pool(l), plate_nodes, coarsest_steps, smoothing_steps };
        let levels = (0..layouts.len())
            .map(|l| LevelArrays::new(context, &layouts[l], layouts.get(l + 1), common(l)))
            .collect::<Result<Vec<_>, _>>()?;
        let shares = layout
            .smoother
            .iter()
            .map(|&[keep, add]| {
                let block = context.block("shares of a smoothing step")?;
                context.upload(&block, &[[keep, add, 0.0, 0.0]])?;
                Ok(block)
            })
            .collect::<Result<Vec<_>, GpuError>>()?;
        let coarsest = context.array("shares of the coarsest level's steps", &layout.coarsest)?;
        let all_shares = context.blocks("shares of all smoothing steps", MOST_STEPS)?;
        let padded: Vec<[f32; 4]> = layout.smoother.iter().map(|&[keep, add]| [keep, add, 0.0, 0.0]).collect();
        context.upload_at(&all_shares, 0, &padded)?;
        let bind = Binder { context, records, shares: &shares, all_shares: &all_shares };
        let mut update = Vec::new();
        let mut cycle = Vec::new();
        for (l, level) in levels.iter().enumerate() {
            update.push(bind.inverse(level)?);
            match (&level.transfer, levels.get(l + 1)) {
                (Some(transfer), Some(next)) => {
                    update.extend(bind.galerkin(level, transfer, next)?);
                    if is_small(l, level) {
                        cycle.extend(bind.small_down(level, transfer, next)?);
                    } else {
                        cycle.extend(bind.down(level, transfer, next)?);
                    }
                }
                _ => cycle.push(bind.coarsest(level, &coarsest)?),
            }
        }
        for (l, level) in levels.iter().enumerate().rev() {
            if let (Some(transfer), Some(next)) = (&level.transfer, levels.get(l + 1)) {
                if is_small(l, level) {
                    cycle.push(bind.small_up(level, transfer, next)?);
                } else {
                    cycle.extend(bind.up(level, transfer, next)?);
                }
            }
        }
        Ok(Self { levels, update, cycle, smoothing_steps, _shares: shares, _all_shares: all_shares, _coarsest: coarsest })
    }
}

impl Levels {
    /// The kernels of the finest level's Galerkin product; none where it is the only level.
    pub fn galerkin(&self) -> &[SizedKernel] {
        if self.levels.len() > 1 { &self.update[1..3] } else { &[] }
    }

    /// A step of the smoother on the finest level; none where it is the only level.
    pub fn smoother_step(&self) -> &[SizedKernel] {
        if self.levels.len() > 1 && self.smoothing_steps > 1 { &self.cycle[1..2] } else { &[] }
    }

    /// A V-cycle. Levels that one workgroup smooths read their matrix as often as the others, from
    /// caches.
    pub fn cycle_account(&self) -> Cost {
        let mut all = Cost::default();
        for level in &self.levels {
            let (product, step) = (level.rounded_account(), level.step_account());
            // From zero the first step needs no product; on the way up all do.
            let (products, steps) = match level.transfer {
                Some(_) => (1, 2 * self.smoothing_steps - 1),
                None => (0, 1),
            };
            all.numbers += products * product.numbers + steps * step.numbers;
            all.shared += products * product.shared + steps * step.shared;
            all.operations += products * product.operations + steps * step.operations;
        }
        all
    }
}

/// A level so small that one workgroup smooths it whole: its dispatches are saved. Not the finest,
/// where some unknowns are fixed.
fn is_small(l: usize, level: &LevelArrays) -> bool {
    l > 0 && level.nodes <= SMALL_NODES
}

struct Binder<'a> {
    context: &'a GpuContext,
    records: &'a StorageBuffer<Record>,
    shares: &'a [StorageBuffer<[f32; 4]>],
    all_shares: &'a StorageBuffer<[f32; 4]>,
}

impl Binder<'_> {
    fn call(&self, kernel: &'static Kernel, threads: usize, arguments: &[&[Argument<'_>]]) -> Result<SizedKernel, GpuError> {
        SizedKernel::new(self.context, kernel, threads, &arguments.concat())
    }

    fn inverse(&self, level: &LevelArrays) -> Result<SizedKernel, GpuError> {
        let arguments = args! {
            level: level.block,
            matrix: level.matrix,
            diagonal: level.diagonal,
            is_fixed: level.fixed,
            inverse: level.inverse,
            column: level.column,
        };
        self.call(&INVERT_DIAGONAL, level.nodes, &[&arguments])
    }

    fn galerkin(&self, level: &LevelArrays, transfer: &TransferArrays, next: &LevelArrays) -> Result<[SizedKernel; 2], GpuError> {
        let block = &args! { level: level.block };
        let product = args! { given: level.matrix, to: transfer.product, column: level.column, is_fixed: level.fixed };
        let coarse = args! { given: transfer.product, matrix: next.matrix };
        let (product_lists, coarse_lists) = (transfer.product_lists.as_lists(), transfer.coarse_lists.as_lists());
        Ok([
            self.call(&GALERKIN_PRODUCT, transfer.products, &[block, &product_lists, &product])?,
            self.call(&GALERKIN_COARSE, transfer.coarse_blocks / 2, &[block, &coarse_lists, &coarse])?,
        ])
    }

    /// A step of the smoother from `x` to `next`.
    fn smooth(
        &self,
        level: &LevelArrays,
        step: usize,
        x: &StorageBuffer<f32>,
        next: &StorageBuffer<f32>,
    ) -> Result<SizedKernel, GpuError> {
        let arguments = args! {
            inverse: level.inverse,
            b: level.b,
            last_step: level.last_step,
            next,
            recurrence: self.shares[step],
            records: self.records,
        };
        self.call(&SMOOTH_STEP, level.threads(), &[&level.product(x), &arguments])
    }

    /// Smoothing from zero, which leaves `other` where the number of steps is odd, and what is left
    /// to the next level.
    fn down(&self, level: &LevelArrays, transfer: &TransferArrays, next: &LevelArrays) -> Result<Vec<SizedKernel>, GpuError> {
        let start = args! {
            level: level.block,
            inverse: level.inverse,
            b: level.b,
            last_step: level.last_step,
            next: level.other,
            recurrence: self.shares[0],
            records: self.records,
        };
        let mut out = vec![self.call(&SMOOTH_START, level.threads(), &[&start])?];
        let (mut x, mut free) = (&level.other, &level.x);
        for step in 1..self.shares.len() {
            out.push(self.smooth(level, step, x, free)?);
            std::mem::swap(&mut x, &mut free);
        }
        let residual = args! {
            inverse: level.inverse,
            b: level.b,
            is_fixed: level.fixed,
            r: level.residual,
            records: self.records,
        };
        out.push(self.call(&CYCLE_RESIDUAL, level.threads(), &[&level.product(x), &residual])?);
        out.push(self.restrict(level, transfer, next)?);
        Ok(out)
    }

    fn restrict(&self, level: &LevelArrays, transfer: &TransferArrays, next: &LevelArrays) -> Result<SizedKernel, GpuError> {
        let arguments = args! {
            level: level.block,
            transfer: transfer.restriction,
            given: level.residual,
            to: next.b,
            records: self.records,
        };
        self.call(&RESTRICT, row_threads(transfer.coarse_nodes), &[&arguments])
    }

    fn small<'a>(&'a self, level: &'a LevelArrays) -> [Argument<'a>; 8] {
        args! {
            level: level.block,
            column: level.column,
            matrix: level.matrix,
            inverse: level.inverse,
            b: level.b,
            x: level.x,
            recurrence: self.all_shares,
            records: self.records,
        }
    }

    /// As [`Binder::down`], by one workgroup a slot; it leaves `x`.
    fn small_down(
        &self,
        level: &LevelArrays,
        transfer: &TransferArrays,
        next: &LevelArrays,
    ) -> Result<[SizedKernel; 2], GpuError> {
        let residual = args! { residual: level.residual };
        Ok([self.call(&SMALL_DOWN, 1, &[&self.small(level), &residual])?, self.restrict(level, transfer, next)?])
    }

    /// As [`Binder::up`], by one workgroup a slot.
    fn small_up(&self, level: &LevelArrays, transfer: &TransferArrays, next: &LevelArrays) -> Result<SizedKernel, GpuError> {
        self.call(&SMALL_UP, 1, &[&self.small(level), &args! { transfer: transfer.prolongation, coarse: next.x }])
    }

    /// The next level's correction, and smoothing, which ends in `x`.
    fn up(&self, level: &LevelArrays, transfer: &TransferArrays, next: &LevelArrays) -> Result<Vec<SizedKernel>, GpuError> {
        let odd = self.shares.len() % 2 == 1;
        let (mut x, mut free) = if odd { (&level.other, &level.x) } else { (&level.x, &level.other) };
        let arguments = args! {
            level: level.block,
            transfer: transfer.prolongation,
            given: next.x,
            to: x,
            records: self.records,
            is_fixed: level.fixed,
        };
        let mut out = vec![self.call(&PROLONG, level.threads(), &[&arguments])?];
        for step in 0..self.shares.len() {
            out.push(self.smooth(level, step, x, free)?);
            std::mem::swap(&mut x, &mut free);
        }
        Ok(out)
    }

    fn coarsest(&self, level: &LevelArrays, shares: &StorageBuffer<[f32; 2]>) -> Result<SizedKernel, GpuError> {
        let arguments = args! {
            inverse: level.inverse,
            b: level.b,
            last_step: level.last_step,
            recurrence: shares,
            records: self.records,
        };
        self.call(&SOLVE_COARSEST, 1, &[&level.product(&level.x), &arguments])
    }
}

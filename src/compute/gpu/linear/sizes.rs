//! Sizes of the linear solver that host and kernels both know.

/// Krylov vectors after which a cycle starts over.
pub const RESTART: usize = 30;
/// Entries of a vector that one workgroup sums.
pub const CHUNK: usize = 1024;
/// Threads of the kernels that sum.
pub const THREADS: usize = 256;
/// Nodes of which one workgroup has the rows.
pub const NODES_IN_GROUP: usize = 64;
/// Threads of such a workgroup.
pub const ROWS_IN_GROUP: usize = 192;
/// Nodes of the largest level that one workgroup smooths.
pub const SMALL_NODES: usize = 400;
/// Steps of its smoother at the most.
pub const MOST_STEPS: usize = 8;

/// Numbers of a slot's small arrays, as `krylov.wgsl` lays them out.
pub fn small_numbers() -> usize {
    5 * RESTART + 2 + RESTART * (RESTART + 1) / 2
}

/// Threads of the kernels with a thread for each row of so many nodes.
pub fn row_threads(nodes: usize) -> usize {
    nodes.div_ceil(NODES_IN_GROUP) * ROWS_IN_GROUP
}

/// The block that `level.wgsl` calls Level.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct LevelShape {
    pub(in super::super) nodes: u32,
    pub(in super::super) width: u32,
    pub(in super::super) coarse_nodes: u32,
    pub(in super::super) products: u32,
    pub(in super::super) coarse_width: u32,
    pub(in super::super) restart: u32,
    pub(in super::super) plate_nodes: u32,
    pub(in super::super) coarsest_steps: u32,
    pub(in super::super) smoothing_steps: u32,
    pub(in super::super) reserved: [u32; 3],
}

/// Memory traffic and work of a part of a solve: what it is for one slot, and what all slots share.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cost {
    /// Numbers of four bytes that are read or written, each once a kernel.
    pub numbers: usize,
    /// Alike, of lists that all slots share.
    pub shared: usize,
    /// Additions and multiplications.
    pub operations: usize,
}

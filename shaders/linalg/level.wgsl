// One level of the multigrid hierarchy: its matrix, and what every kernel on it knows. A dispatch
// has a thread for each node and component, 64 nodes a workgroup, and runs along y over the slots.
// Vectors are [slot][component][node]; all rows of a matrix have room for the same number of blocks,
// so that neighbouring threads read neighbouring numbers. Those that are missing are zero, and end a
// product: it takes two blocks at a time, and of two that are missing the column is NO_COLUMN.
struct Level {
    nodes: u32,
    width: u32,             // blocks in a row
    coarse_nodes: u32,      // of the next level
    products: u32,          // blocks of A P
    coarse_width: u32,
    restart: u32,           // most Krylov vectors kept
    plate_nodes: u32,       // nodes of the plate
    coarsest_steps: u32,    // of the coarsest level's polynomial
    smoothing_steps: u32,
    reserved_0: u32,
    reserved_1: u32,
    reserved_2: u32,
}

// A workgroup of rows: its nodes, three components of each.
const NODES_IN_GROUP: u32 = 64;
const ROWS_IN_GROUP: u32 = 192;
const NO_COLUMN: u32 = 0xffffffffu;

@group(0) @binding(0) var<uniform> level: Level;

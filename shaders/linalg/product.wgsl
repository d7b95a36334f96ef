// Rows of a level's matrix times a vector.

@group(0) @binding(1) var<storage, read> column: array<u32>;    // [k][node]
@group(0) @binding(2) var<storage, read> matrix: array<u32>;    // see halves.wgsl
@group(0) @binding(3) var<storage, read> x: array<real>;        // [slot][component][node]

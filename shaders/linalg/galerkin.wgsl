// The products A P and P^T (A P), a thread a block: it sums along a list made once, so that each
// block has one writer and one order.

@group(0) @binding(1) var<storage, read> list_start: array<u32>;    // starts of the blocks' lists
@group(0) @binding(2) var<storage, read> list_entry: array<u32>;    // a block of the other factor
@group(0) @binding(3) var<storage, read> list_weight: array<real>;  // its weight

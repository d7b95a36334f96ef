// The tangent's upper block triangle: a thread a block d f_i/d u_j gathers from the elements that
// hold both nodes, in the order of a list made once.

@group(0) @binding(2) var<storage, read> block_start: array<u32>;       // starts of the blocks' lists
@group(0) @binding(3) var<storage, read> block_entry: array<u32>;       // 64 element + 8 a + b
@group(0) @binding(4) var<storage, read> element_blocks: array<real>;   // [slot][element][pair][3 i + j]
@group(0) @binding(5) var<storage, read_write> blocks: array<real>;     // [slot][3 i + j][block]

@compute @workgroup_size(64)
fn gather_tangent_blocks(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= dimensions.blocks || id.y >= dimensions.in_dispatch {
        return;
    }
    let block = id.x;
    let slot = id.y;
    // columns of the block
    var sum = mat3x3<real>();
    for (var e = block_start[block]; e < block_start[block + 1u]; e++) {
        let entry = block_entry[e];
        let a = (entry / 8u) % 8u;
        let b = entry % 8u;
        let offset = (a - b) % 8u;
        let is_there = offset < 4u || (offset == 4u && b < 4u);
        let pair = select(pair_place(a, (b - a) % 8u), pair_place(b, offset), is_there);
        let at = ELEMENT_BLOCKS * (slot * dimensions.elements + entry / 64u) + 9u * pair;
        // The other way round it is transposed.
        let next_column = select(3u, 1u, is_there);
        let next_row = 4u - next_column;
        for (var j = 0u; j < 3u; j++) {
            let top = at + j * next_column;
            sum[j] += vec3<real>(element_blocks[top], element_blocks[top + next_row], element_blocks[top + 2u * next_row]);
        }
    }
    let count = dimensions.blocks;
    for (var j = 0u; j < 3u; j++) {
        for (var i = 0u; i < 3u; i++) {
            blocks[(9u * slot + 3u * i + j) * count + block] = sum[j][i];
        }
    }
}

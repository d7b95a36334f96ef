// P^T (A P), the matrix of the next level; a thread two blocks of a row, whose halves share words.

@group(0) @binding(4) var<storage, read> given: array<real>;        // A P: [slot][3 i + j][block]
@group(0) @binding(5) var<storage, read_write> matrix: array<u32>;  // see halves.wgsl

@compute @workgroup_size(64)
fn galerkin_coarse(@builtin(global_invocation_id) id: vec3<u32>) {
    let count = level.coarse_width / 2u * level.coarse_nodes;
    if id.x >= count {
        return;
    }
    let slot = id.y;
    let block = 2u * id.x - id.x % level.coarse_nodes;
    let first = coarse_block(slot, block);
    let second = coarse_block(slot, block + level.coarse_nodes);
    keep_halves(18u * slot * count + id.x, count, first, second);
}

fn coarse_block(slot: u32, block: u32) -> mat3x3<real> {
    var sum = mat3x3<real>();
    for (var e = list_start[block]; e < list_start[block + 1u]; e++) {
        let at = 9u * slot * level.products + list_entry[e];
        for (var j = 0u; j < 3u; j++) {
            for (var i = 0u; i < 3u; i++) {
                sum[j][i] += given[at + (3u * i + j) * level.products] * list_weight[e];
            }
        }
    }
    return sum;
}

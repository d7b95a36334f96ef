// P^T (A P), the matrix of the next level.

@compute @workgroup_size(64)
fn galerkin_coarse(@builtin(global_invocation_id) id: vec3<u32>) {
    let count = level.coarse_width * level.coarse_nodes;
    if id.x >= count {
        return;
    }
    let slot = id.y;
    var sum = mat3x3<real>();
    for (var e = list_start[id.x]; e < list_start[id.x + 1u]; e++) {
        sum += load_block(9u * slot * level.products + list_entry[e], level.products) * list_weight[e];
    }
    store_block(9u * slot * count + id.x, count, sum);
}

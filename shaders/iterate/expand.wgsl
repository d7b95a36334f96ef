// The correction from the solution of the linear system: at fixed unknowns their values, in full
// precision, and displacements where unknowns are none; a thread a node.

// [slot][component][node], scaled, bits of single precision
@group(0) @binding(9) var<storage, read> answer: array<u32>;
@group(0) @binding(10) var<storage, read_write> correction: array<real>;    // [case][3 node + i]
@group(0) @binding(11) var<storage, read_write> by_residual: array<real>;   // [case][3 node + i]: unknowns, h as it is

@compute @workgroup_size(64)
fn iterate_expand(@builtin(global_invocation_id) id: vec3<u32>) {
    let nodes = dimensions.nodes;
    if id.x >= nodes || id.y >= dimensions.in_dispatch {
        return;
    }
    let slot = id.y;
    let case_index = active_cases[slot].x;
    let now = node_residual(slot, marks[slot].x, id.x, number(slot, DEPTH));
    let back = number(slot, BACK);
    var found = now.rhs;
    for (var i = 0u; i < 3u; i++) {
        if ((now.fixed >> i) & 1u) == 0u {
            found[i] = back * real_of_single(answer[(3u * slot + i) * nodes + id.x]);
        }
    }
    let along = expanded(case_index, marks[slot].x, node_info[id.x], found);
    let at = (case_index * nodes + id.x) * 3u;
    for (var i = 0u; i < 3u; i++) {
        by_residual[at + i] = found[i];
        correction[at + i] = along[i];
    }
}

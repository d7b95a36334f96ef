// Moves the plate so that it has the force that is to be held: adds the response to a unit
// indentation, times the change of h, to the correction; a thread a node.

@group(0) @binding(5) var<storage, read> node_info: array<u32>;             // [node]
@group(0) @binding(6) var<storage, read> response: array<u32>;              // [case][component][node], bits of single precision
@group(0) @binding(7) var<storage, read> by_residual: array<real>;          // [case][3 node + i]: unknowns, h as it is
@group(0) @binding(9) var<storage, read_write> correction: array<real>;     // [case][3 node + i]

@compute @workgroup_size(64)
fn iterate_press(@builtin(global_invocation_id) id: vec3<u32>) {
    let nodes = dimensions.nodes;
    if id.x >= nodes || id.y >= dimensions.in_dispatch {
        return;
    }
    let slot = id.y;
    let case_index = active_cases[slot].x;
    let change = number(slot, DEPTH_CHANGE);
    let at = (case_index * nodes + id.x) * 3u;
    var found = vec3<real>();
    for (var i = 0u; i < 3u; i++) {
        found[i] = by_residual[at + i] + change * real_of_single(response[(3u * case_index + i) * nodes + id.x]);
    }
    let along = expanded(case_index, marks[slot].x, node_info[id.x], found);
    for (var i = 0u; i < 3u; i++) {
        correction[at + i] = along[i];
    }
}

// The increments of the current iterates, as the elements read them; a thread a node.

@group(0) @binding(5) var<storage, read> iterates: array<real>;         // [case][iterate][increment, force][3 node + i]
@group(0) @binding(6) var<storage, read_write> trials: array<real>;     // [slot]: increment [3 node + i], det F - 1

@compute @workgroup_size(64)
fn iterate_current(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= dimensions.nodes || id.y >= dimensions.in_dispatch {
        return;
    }
    let at = increment_place(active_cases[id.y].x, marks[id.y].x, id.x);
    let out = id.y * dimensions.trial_numbers + 3u * id.x;
    for (var i = 0u; i < 3u; i++) {
        trials[out + i] = iterates[at + i];
    }
}

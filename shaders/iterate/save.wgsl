// Keeps the internal forces of a trial, a thread a node.

@group(0) @binding(5) var<storage, read> force: array<real>;            // [slot][3 node + i]
@group(0) @binding(6) var<storage, read_write> iterates: array<real>;   // [case][iterate][increment, force][3 node + i]

@compute @workgroup_size(64)
fn iterate_save(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= dimensions.nodes || id.y >= dimensions.in_dispatch {
        return;
    }
    let n = 3u * dimensions.nodes;
    let to = force_place(active_cases[id.y].x, marks[id.y].y, id.x);
    for (var i = 0u; i < 3u; i++) {
        iterates[to + i] = force[id.y * n + 3u * id.x + i];
    }
}

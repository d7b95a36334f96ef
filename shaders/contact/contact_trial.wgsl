// What the contact conditions take of a trial displacement and its internal forces, a thread a
// point: the forces that were gathered before, and the increments.

@group(0) @binding(2) var<storage, read> contact_node: array<u32>;      // [point]
@group(0) @binding(3) var<storage, read> force: array<real>;            // [slot][3 node + i]
@group(0) @binding(4) var<storage, read> increment: array<real>;        // [slot][3 node + i]
@group(0) @binding(5) var<storage, read_write> trial: array<real>;      // [slot][force, increment][point]

@compute @workgroup_size(64)
fn contact_trial(@builtin(global_invocation_id) id: vec3<u32>) {
    let points = dimensions.contact_points;
    if id.x >= points || id.y >= dimensions.in_dispatch {
        return;
    }
    let first = 3u * (id.y * dimensions.nodes + contact_node[id.x]);
    let out = 6u * id.y * points + id.x;
    for (var i = 0u; i < 3u; i++) {
        trial[out + i * points] = force[first + i];
        trial[out + (3u + i) * points] = increment[first + i];
    }
}

// The forces of half of the body, of what is even in x and of what is odd; a thread a number of
// both.

@group(0) @binding(1) var<storage, read> nodes_of: array<u32>;      // [half's node]: its own, the opposite one
@group(0) @binding(2) var<storage, read> is_fixed: array<u32>;      // [slot][parity][half's node]: a bit a component
@group(0) @binding(3) var<storage, read> records: array<Record>;
@group(0) @binding(4) var<storage, read> given: array<real>;        // [slot][component][node]
@group(0) @binding(5) var<storage, read_write> to: array<real>;     // [slot][parity][component][half's node]
@group(0) @binding(6) var<uniform> whole_nodes: vec4<u32>;          // nodes of all of the body

@compute @workgroup_size(192)
fn fold(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let slot = records[group.y].running;
    let node = NODES_IN_GROUP * group.x + local % NODES_IN_GROUP;
    if records[slot].done != RUNNING || node >= level.nodes {
        return;
    }
    let component = local / NODES_IN_GROUP;
    let first = (3u * slot + component) * whole_nodes.x;
    let own = nodes_of[2u * node];
    let opposite = nodes_of[2u * node + 1u];
    for (var parity = 0u; parity < 2u; parity++) {
        let half = 2u * slot + parity;
        var value = given[first + own];
        if own != opposite {
            // The sign on the other side: - along x of what is even, and elsewhere of what is odd.
            let there = given[first + opposite];
            value += select(there, -there, (component == 0u) == (parity == 0u));
        }
        if (is_fixed[half * level.nodes + node] >> component) % 2u == 1u {
            value = 0.0;
        }
        to[(3u * half + component) * level.nodes + node] = value;
    }
}

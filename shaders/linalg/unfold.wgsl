// The displacements of all of the body from those of half of it, of what is even in x and of what
// is odd, which are 0 where they are fixed; a thread a number.

@group(0) @binding(1) var<storage, read> half_of: array<u32>;       // [node]: 2 times the half's node, + 1 if opposite
@group(0) @binding(2) var<storage, read> records: array<Record>;
@group(0) @binding(3) var<storage, read> given: array<real>;        // [slot][parity][component][half's node]
@group(0) @binding(4) var<storage, read_write> to: array<real>;     // [slot][component][node]
@group(0) @binding(5) var<uniform> half_nodes: vec4<u32>;           // nodes of half of the body

@compute @workgroup_size(192)
fn unfold(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let slot = records[group.y].running;
    let node = NODES_IN_GROUP * group.x + local % NODES_IN_GROUP;
    if records[slot].done != RUNNING || node >= level.nodes {
        return;
    }
    let component = local / NODES_IN_GROUP;
    let at = (6u * slot + component) * half_nodes.x + half_of[node] / 2u;
    var even = given[at];
    var odd = given[at + 3u * half_nodes.x];
    if half_of[node] % 2u == 1u {
        even = select(even, -even, component == 0u);
        odd = select(-odd, odd, component == 0u);
    }
    to[(3u * slot + component) * level.nodes + node] = even + odd;
}

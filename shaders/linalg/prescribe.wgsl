// solution = the right-hand side at fixed unknowns, nothing elsewhere.

@group(0) @binding(1) var<storage, read> rhs: array<real>;              // [slot][component][node]
@group(0) @binding(2) var<storage, read> is_fixed: array<u32>;          // [slot][node]: a bit a component
@group(0) @binding(3) var<storage, read_write> solution: array<real>;   // [slot][component][node]

@compute @workgroup_size(192)
fn prescribe(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let slot = group.y;
    let node = NODES_IN_GROUP * group.x + local % NODES_IN_GROUP;
    if node >= level.nodes {
        return;
    }
    let component = local / NODES_IN_GROUP;
    let at = (3u * slot + component) * level.nodes + node;
    var value: real = 0.0;
    if (is_fixed[slot * level.nodes + node] >> component) % 2u == 1u {
        value = rhs[at];
    }
    solution[at] = value;
}

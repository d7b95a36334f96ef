// Keeps the response to a unit indentation; a thread a node. Vectors of the solver are bits of
// single precision.

@group(0) @binding(5) var<storage, read> answer: array<u32>;                // [slot][component][node]
@group(0) @binding(6) var<storage, read> rhs: array<u32>;                   // [slot][component][node]
@group(0) @binding(7) var<storage, read> is_fixed: array<u32>;              // [slot][node]: a bit a component
@group(0) @binding(8) var<storage, read_write> response: array<u32>;        // [case][component][node]

@compute @workgroup_size(64)
fn iterate_respond(@builtin(global_invocation_id) id: vec3<u32>) {
    let nodes = dimensions.nodes;
    if id.x >= nodes || id.y >= dimensions.in_dispatch {
        return;
    }
    let slot = id.y;
    for (var i = 0u; i < 3u; i++) {
        let at = (3u * slot + i) * nodes + id.x;
        let is_free = ((is_fixed[slot * nodes + id.x] >> i) & 1u) == 0u;
        response[(3u * active_cases[slot].x + i) * nodes + id.x] = select(rhs[at], answer[at], is_free);
    }
}

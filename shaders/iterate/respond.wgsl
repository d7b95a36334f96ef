// Moves the plate so that it has the force that is to be held: adds the response to a unit
// indentation to the correction, as often as h changes, and keeps it; a thread a node. Vectors of
// the solver are bits of single precision.

@group(0) @binding(5) var<storage, read> answer: array<u32>;                // [slot][component][node]
@group(0) @binding(6) var<storage, read> rhs: array<u32>;                   // [slot][component][node]
@group(0) @binding(7) var<storage, read> is_fixed: array<u32>;              // [slot][node]: a bit a component
@group(0) @binding(8) var<storage, read_write> response: array<u32>;        // [case][component][node]
@group(0) @binding(9) var<storage, read_write> correction: array<real>;     // [case][3 node + i]
@group(0) @binding(10) var<storage, read> by_residual: array<real>;         // [case][3 node + i]: without a change of h

@compute @workgroup_size(64)
fn iterate_respond(@builtin(global_invocation_id) id: vec3<u32>) {
    let nodes = dimensions.nodes;
    if id.x >= nodes || id.y >= dimensions.in_dispatch {
        return;
    }
    let slot = id.y;
    let case_index = active_cases[slot].x;
    let change = depth_change(slot);
    for (var i = 0u; i < 3u; i++) {
        let at = (3u * slot + i) * nodes + id.x;
        let is_free = ((is_fixed[slot * nodes + id.x] >> i) & 1u) == 0u;
        let value = select(rhs[at], answer[at], is_free);
        response[(3u * case_index + i) * nodes + id.x] = value;
        let of_case = (case_index * nodes + id.x) * 3u + i;
        correction[of_case] = by_residual[of_case] + change * real_of_single(value);
    }
}

// The correction from the solution of the linear system: at fixed unknowns their values, in full
// precision; a thread a node.

@group(0) @binding(12) var<storage, read> largest: array<real>;         // [case][iterate]: of the right-hand side
// [slot][component][node], scaled, bits of single precision
@group(0) @binding(13) var<storage, read> answer: array<u32>;
@group(0) @binding(14) var<storage, read_write> correction: array<real>;    // [case][3 node + i]
@group(0) @binding(15) var<storage, read_write> by_residual: array<real>;   // [case][3 node + i]: without a change of h

@compute @workgroup_size(64)
fn iterate_expand(@builtin(global_invocation_id) id: vec3<u32>) {
    let nodes = dimensions.nodes;
    if id.x >= nodes || id.y >= dimensions.in_dispatch {
        return;
    }
    let slot = id.y;
    let case_index = active_cases[slot].x;
    let current = marks[slot].x;
    let now = node_residual(slot, current, id.x, number(slot, DEPTH));
    let back = ldexp(real(1.0), -scale_exponent(largest[2u * case_index + current]));
    for (var i = 0u; i < 3u; i++) {
        let at = (case_index * nodes + id.x) * 3u + i;
        if ((now.fixed >> i) & 1u) != 0u {
            correction[at] = now.rhs[i];
        } else {
            correction[at] = back * real_of_single(answer[(3u * slot + i) * nodes + id.x]);
        }
        by_residual[at] = correction[at];
    }
}

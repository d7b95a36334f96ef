// The system of the response to a unit indentation, which has the matrix of the correction's: its
// right-hand side, and as the guess the response of the iteration before, or at first a body that
// moves as one; a thread a node. Vectors of the solver are bits of single precision.

@group(0) @binding(5) var<storage, read> node_info: array<u32>;         // [node]
@group(0) @binding(6) var<storage, read> is_fixed: array<u32>;          // [slot][node]: a bit a component
@group(0) @binding(7) var<storage, read> response: array<u32>;          // [case][component][node]
@group(0) @binding(9) var<storage, read_write> rhs: array<u32>;         // [slot][component][node]
@group(0) @binding(10) var<storage, read_write> guess: array<u32>;      // [slot][component][node]

@compute @workgroup_size(64)
fn iterate_unit(@builtin(global_invocation_id) id: vec3<u32>) {
    let nodes = dimensions.nodes;
    if id.x >= nodes || id.y >= dimensions.in_dispatch {
        return;
    }
    let slot = id.y;
    let as_one = contracted(active_cases[slot].x, marks[slot].x, node_info[id.x], vec3<real>(0.0, 0.0, -1.0));
    for (var i = 0u; i < 3u; i++) {
        let at = (3u * slot + i) * nodes + id.x;
        var value = 0u;
        if i == 2u && (node_info[id.x] & IS_PLATE) != 0u {
            value = single_bits(-1.0);
        }
        rhs[at] = value;
        if ((is_fixed[slot * nodes + id.x] >> i) & 1u) == 0u {
            if !has(slot, IS_FIRST) {
                value = response[(3u * active_cases[slot].x + i) * nodes + id.x];
            } else {
                value = single_bits(as_one[i]);
            }
        }
        guess[at] = value;
    }
}

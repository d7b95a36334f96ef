// The linear system at the current iterate, but for the tangent; a thread a node: right-hand side,
// fixed unknowns, and the conditions of points that slide, which replace the rows of their nodes.

@group(0) @binding(12) var<storage, read> largest: array<real>;         // [case][iterate]: of the right-hand side
// [slot][component][node], scaled, bits of single precision
@group(0) @binding(13) var<storage, read_write> rhs: array<u32>;
@group(0) @binding(14) var<storage, read_write> is_fixed: array<u32>;   // [slot][node]: a bit a component
// [slot][slides, force rows, displacement rows][point], alike
@group(0) @binding(15) var<storage, read_write> sliding: array<u32>;

// Numbers of a point that slides.
const POINT_ROWS: u32 = 19u;

@compute @workgroup_size(64)
fn iterate_system(@builtin(global_invocation_id) id: vec3<u32>) {
    let nodes = dimensions.nodes;
    if id.x >= nodes || id.y >= dimensions.in_dispatch {
        return;
    }
    let slot = id.y;
    let case_index = active_cases[slot].x;
    let current = marks[slot].x;
    let now = node_residual(slot, current, id.x, number(slot, DEPTH));
    let scale = ldexp(real(1.0), scale_exponent(largest[2u * case_index + current]));
    for (var i = 0u; i < 3u; i++) {
        rhs[(3u * slot + i) * nodes + id.x] = single_bits(scale * now.rhs[i]);
    }
    is_fixed[slot * nodes + id.x] = now.fixed;
    if node_info[id.x] < FIRST_POINT {
        return;
    }
    let points = dimensions.contact_points;
    let point = node_info[id.x] / FIRST_POINT - 1u;
    let out = POINT_ROWS * slot * points + point;
    sliding[out] = single_bits(0.0);
    if codes[iterate_place_of(case_index, current, points) + point] % 4u == SLIP {
        sliding[out] = single_bits(1.0);
    }
    let first = iterate_place_of(case_index, current, ROWS * points) + point;
    for (var c = 1u; c < POINT_ROWS; c++) {
        sliding[out + c * points] = single_bits(rows[first + (c + 2u) * points]);
    }
}

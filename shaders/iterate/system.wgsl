// The linear system at the current iterate, but for the tangent; a thread a node: right-hand side,
// fixed unknowns, and of contact points the frames, into which the rows and columns of their nodes
// are turned, and the conditions of those that slide, which replace the rows.

// [slot][component][node], scaled, bits of single precision
@group(0) @binding(9) var<storage, read_write> rhs: array<u32>;
@group(0) @binding(10) var<storage, read_write> is_fixed: array<u32>;   // [slot][node]: a bit a component
// [slot][slides, force rows, displacement rows, frame][point], alike
@group(0) @binding(11) var<storage, read_write> sliding: array<u32>;

// Numbers of a point, and where its frame begins.
const POINT_ROWS: u32 = 28u;
const POINT_FRAME: u32 = 19u;

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
    // By a power of two that the host has chosen, numbers come near to 1: systems are solved in
    // single precision, whose squares must not leave its range.
    let scale = ldexp(real(1.0), -exponent(number(slot, BACK)));
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
    if status_of(case_index, current, point) == SLIP {
        sliding[out] = single_bits(1.0);
    }
    let first = conditions_place(case_index, current, point);
    for (var c = 1u; c < POINT_FRAME; c++) {
        sliding[out + c * points] = single_bits(rows[first + (c + 2u) * points]);
    }
    for (var c = 0u; c < POINT_ROWS - POINT_FRAME; c++) {
        sliding[out + (POINT_FRAME + c) * points] = single_bits(rows[first + (FRAME + c) * points]);
    }
}

// Makes the current iterate the committed displacement, a thread a node; of contact points also
// what is recorded of them.

@group(0) @binding(5) var<storage, read> node_info: array<u32>;         // [node]
@group(0) @binding(6) var<storage, read> iterates: array<real>;         // [case][iterate][increment, force][3 node + i]
@group(0) @binding(7) var<storage, read_write> starts: array<real>;     // [case]: displacement [3 node + i], states
@group(0) @binding(9) var<storage, read_write> before: array<real>;     // [case][3 node + i]: one step earlier
@group(0) @binding(10) var<storage, read_write> facing: array<real>;    // [case][FACING][point]
// [slot][displacement, force of the opponent][point]
@group(0) @binding(11) var<storage, read_write> at_points: array<real>;
@group(0) @binding(12) var<storage, read_write> status: array<u32>;     // [slot][point]

// Numbers of a point that are recorded.
const AT_POINT: u32 = 6u;

@compute @workgroup_size(64)
fn iterate_commit(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= dimensions.nodes || id.y >= dimensions.in_dispatch {
        return;
    }
    let slot = id.y;
    let case_index = active_cases[slot].x;
    let of_case = 3u * (case_index * dimensions.nodes + id.x);
    let of_start = case_index * dimensions.start_numbers + 3u * id.x;
    let current = marks[slot].x;
    let at = increment_place(case_index, current, id.x);
    var u = vec3<real>();
    for (var i = 0u; i < 3u; i++) {
        let at_start = starts[of_start + i];
        u[i] = at_start + iterates[at + i];
        before[of_case + i] = at_start;
        starts[of_start + i] = u[i];
    }
    if node_info[id.x] < FIRST_POINT {
        return;
    }
    let points = dimensions.contact_points;
    let point = node_info[id.x] / FIRST_POINT - 1u;
    let undeformed = facing_since(case_index, point, FROM_REFERENCE);
    let of_point = facing_place(case_index, point);
    facing[of_point] = rigid_gap(undeformed, u);
    for (var i = 0u; i < 3u; i++) {
        facing[of_point + (1u + i) * points] = undeformed.position[i] + u[i];
    }
    let now = status_of(case_index, current, point);
    status[slot * points + point] = now;
    let first = conditions_place(case_index, current, point);
    let force = force_place(case_index, current, id.x);
    var exerted = vec3<real>();
    if now != OPEN {
        exerted = contact_force(
            frame_of(case_index, current, point),
            vec3<real>(iterates[force], iterates[force + 1u], iterates[force + 2u]),
            vec2<real>(rows[first], rows[first + points]),
            ((node_info[id.x] >> 1u) & 1u) != 0u,
        );
    }
    for (var i = 0u; i < 3u; i++) {
        at_points[(AT_POINT * slot + i) * points + point] = u[i];
        at_points[(AT_POINT * slot + 3u + i) * points + point] = exerted[i];
    }
}

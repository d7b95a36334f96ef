// Makes the current iterate the committed displacement, a thread a node; of contact points also
// what is recorded of them.

@group(0) @binding(5) var<storage, read> node_info: array<u32>;         // [node]
// [geometry][point]: of the undeformed body over the plane
@group(0) @binding(6) var<storage, read> height: array<real>;
@group(0) @binding(7) var<storage, read> increments: array<real>;       // [case][iterate][3 node + i]
@group(0) @binding(8) var<storage, read> forces: array<real>;           // [case][iterate][3 node + i]
// [case][iterate][residual, force rows, displacement rows][point]
@group(0) @binding(9) var<storage, read> rows: array<real>;
@group(0) @binding(10) var<storage, read> codes: array<u32>;            // [case][iterate][point]
@group(0) @binding(11) var<storage, read_write> committed: array<real>; // [case][3 node + i]: displacement
@group(0) @binding(12) var<storage, read_write> before: array<real>;    // [case][3 node + i]: one step earlier
@group(0) @binding(13) var<storage, read_write> gap_at_start: array<real>;  // [case][point]
// [slot][displacement, force of the plane][point]
@group(0) @binding(14) var<storage, read_write> at_points: array<real>;
@group(0) @binding(15) var<storage, read_write> status: array<u32>;     // [slot][point]

// Numbers of a point that are recorded.
const AT_POINT: u32 = 6u;

@compute @workgroup_size(64)
fn iterate_commit(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= dimensions.nodes || id.y >= dimensions.in_dispatch {
        return;
    }
    let slot = id.y;
    let case_index = active_cases[slot].x;
    let n = 3u * dimensions.nodes;
    let of_case = case_index * n + 3u * id.x;
    let at = iterate_place_of(case_index, marks[slot].x, n) + 3u * id.x;
    var u = vec3<real>();
    for (var i = 0u; i < 3u; i++) {
        let start = committed[of_case + i];
        u[i] = start + increments[at + i];
        before[of_case + i] = start;
        committed[of_case + i] = u[i];
    }
    if node_info[id.x] < FIRST_POINT {
        return;
    }
    let points = dimensions.contact_points;
    let point = node_info[id.x] / FIRST_POINT - 1u;
    gap_at_start[case_index * points + point] = gap(height[active_cases[slot].y * points + point], u.z);
    let now = codes[iterate_place_of(case_index, marks[slot].x, points) + point] % 4u;
    status[slot * points + point] = now;
    let first = iterate_place_of(case_index, marks[slot].x, ROWS * points) + point;
    // Along the plane what Coulomb's bound allows, normal to it the internal force.
    var exerted = vec3<real>();
    if now != OPEN {
        exerted = vec3<real>(
            forces[at] - rows[first],
            forces[at + 1u] - rows[first + points],
            max(forces[at + 2u], real(0.0)),
        );
    }
    for (var i = 0u; i < 3u; i++) {
        at_points[(AT_POINT * slot + i) * points + point] = u[i];
        at_points[(AT_POINT * slot + 3u + i) * points + point] = exerted[i];
    }
}

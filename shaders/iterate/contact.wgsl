// The contact conditions of a trial, a thread a point.

@group(0) @binding(5) var<storage, read> contact_node: array<u32>;      // [point]
@group(0) @binding(6) var<storage, read> weight: array<real>;           // [geometry][point]: c of Alart and Curnier
@group(0) @binding(7) var<storage, read> on_symmetry_plane: array<u32>; // [point]
@group(0) @binding(8) var<storage, read> friction: array<real>;         // [case]
@group(0) @binding(9) var<storage, read> slides: array<u32>;            // [case][point]: without friction in this step
@group(0) @binding(10) var<storage, read> gap_at_start: array<real>;    // [case][point]
@group(0) @binding(11) var<storage, read> increments: array<real>;      // [case][iterate][3 node + i]
@group(0) @binding(12) var<storage, read> forces: array<real>;          // [case][iterate][3 node + i]
// [case][iterate][residual, force rows, displacement rows][point]
@group(0) @binding(13) var<storage, read_write> rows: array<real>;
// [case][iterate][point]: status + 4, 8, 16 for fixed x, y, z
@group(0) @binding(14) var<storage, read_write> codes: array<u32>;

@compute @workgroup_size(64)
fn iterate_contact(@builtin(global_invocation_id) id: vec3<u32>) {
    let points = dimensions.contact_points;
    if id.x >= points || id.y >= dimensions.in_dispatch {
        return;
    }
    let case_index = active_cases[id.y].x;
    let trial = marks[id.y].y;
    let at = iterate_place_of(case_index, trial, 3u * dimensions.nodes) + 3u * contact_node[id.x];
    let increment = vec3<real>(increments[at], increments[at + 1u], increments[at + 2u]);
    let point = ContactPoint(
        vec3<real>(forces[at], forces[at + 1u], forces[at + 2u]),
        gap(gap_at_start[case_index * points + id.x], increment.z),
        slip(increment),
        weight[active_cases[id.y].y * points + id.x],
        on_symmetry_plane[id.x] != 0u,
    );
    var coefficient = friction[case_index];
    if slides[case_index * points + id.x] != 0u {
        coefficient = 0.0;
    }
    let found = contact_rows(coefficient, point);
    store_rows(iterate_place_of(case_index, trial, ROWS * points) + id.x, found);
    codes[iterate_place_of(case_index, trial, points) + id.x] = status_code(found);
}

// The contact conditions of a trial, in the frame of the opponent's surface where each point is; a
// thread a point.

@group(0) @binding(5) var<storage, read> surface: array<u32>;           // [point]: node, and whether on the symmetry plane
@group(0) @binding(6) var<storage, read> weight: array<real>;           // [geometry][point]: c of Alart and Curnier
@group(0) @binding(7) var<storage, read> friction: array<real>;         // [case]
@group(0) @binding(8) var<storage, read> let_go: array<u32>;            // [case][point]: SLIDES, CAME_OFF
@group(0) @binding(9) var<storage, read> facing: array<real>;           // [case][FACING][point]
@group(0) @binding(10) var<storage, read> iterates: array<real>;        // [case][iterate][increment, force][3 node + i]
@group(0) @binding(11) var<storage, read_write> rows: array<real>;      // [case][iterate][CONDITIONS][point]

@compute @workgroup_size(64)
fn iterate_contact(@builtin(global_invocation_id) id: vec3<u32>) {
    let points = dimensions.contact_points;
    if id.x >= points || id.y >= dimensions.in_dispatch {
        return;
    }
    let case_index = active_cases[id.y].x;
    let trial = marks[id.y].y;
    let node = surface[id.x] & ~ON_SYMMETRY_PLANE;
    let at = increment_place(case_index, trial, node);
    let force = force_place(case_index, trial, node);
    let increment = vec3<real>(iterates[at], iterates[at + 1u], iterates[at + 2u]);
    let since_start = facing_since(case_index, id.x, FROM_START);
    let axes = rigid_frame(since_start, increment);
    let c = weight[active_cases[id.y].y * points + id.x];
    let point = ContactPoint(
        to_frame(axes, vec3<real>(iterates[force], iterates[force + 1u], iterates[force + 2u])),
        rigid_gap(since_start, increment),
        to_frame(axes, increment).xy,
        c,
        (surface[id.x] & ON_SYMMETRY_PLANE) != 0u,
    );
    var coefficient = friction[case_index];
    if (let_go[case_index * points + id.x] & SLIDES) != 0u {
        coefficient = 0.0;
    }
    let found = contact_rows(coefficient, point);
    let first = conditions_place(case_index, trial, id.x);
    store_rows(first, found);
    rows[first + CODE * points] = real(status_code(found));
    rows[first + WEIGHT * points] = c;
    store(first, FRAME, axes.t1);
    store(first, FRAME + 3u, axes.t2);
    store(first, FRAME + 6u, axes.n);
}

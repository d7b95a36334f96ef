// The contact conditions of every point that can touch: a thread a point.

@group(0) @binding(2) var<storage, read> weight: array<real>;           // [geometry][point]: c of Alart and Curnier
@group(0) @binding(3) var<storage, read> surface: array<u32>;           // [point]: node, and whether on the symmetry plane
@group(0) @binding(4) var<storage, read> friction: array<real>;         // [case]
@group(0) @binding(5) var<storage, read> facing: array<real>;           // [case][FACING][point]
@group(0) @binding(6) var<storage, read> trial: array<real>;            // [slot][force, increment][point]
@group(0) @binding(7) var<storage, read_write> rows: array<real>;     // [slot][residual, force rows, displacement rows][point]
@group(0) @binding(8) var<storage, read_write> codes: array<u32>;   // [slot][point]: status + 4, 8, 16 for fixed x, y, z

// Numbers of a point's trial.
const TRIAL: u32 = 6u;

@compute @workgroup_size(64)
fn contact_points(@builtin(global_invocation_id) id: vec3<u32>) {
    let points = dimensions.contact_points;
    if id.x >= points || id.y >= dimensions.in_dispatch {
        return;
    }
    let slot = id.y;
    let case_index = active_cases[slot].x;
    let t = TRIAL * slot * points + id.x;
    let increment = vec3<real>(trial[t + 3u * points], trial[t + 4u * points], trial[t + 5u * points]);
    let since_start = facing_since(case_index, id.x, FROM_START);
    let axes = rigid_frame(since_start, increment);
    let point = ContactPoint(
        to_frame(axes, vec3<real>(trial[t], trial[t + points], trial[t + 2u * points])),
        rigid_gap(since_start, increment),
        to_frame(axes, increment).xy,
        weight[active_cases[slot].y * points + id.x],
        (surface[id.x] & ON_SYMMETRY_PLANE) != 0u,
    );
    let found = contact_rows(friction[case_index], point);
    store_rows(ROWS * slot * points + id.x, found);
    codes[slot * points + id.x] = status_code(found);
}

// Under full stick, after the trial has become the current iterate: a point that came off within
// the step and comes down again has let go of its tangential force, and slides up to the step's
// end; a thread a point.

@group(0) @binding(5) var<storage, read> codes: array<u32>;             // [case][iterate][point]
@group(0) @binding(6) var<storage, read_write> slides: array<u32>;      // [case][point]
@group(0) @binding(7) var<storage, read_write> came_off: array<u32>;    // [case][point]

@compute @workgroup_size(64)
fn iterate_land(@builtin(global_invocation_id) id: vec3<u32>) {
    let points = dimensions.contact_points;
    if id.x >= points || id.y >= dimensions.in_dispatch {
        return;
    }
    let case_index = active_cases[id.y].x;
    let at = case_index * points + id.x;
    let current = marks[id.y].x;
    let after = codes[iterate_place_of(case_index, current, points) + id.x] % 4u;
    let earlier = codes[iterate_place_of(case_index, 1u - current, points) + id.x] % 4u;
    if !has(id.y, LANDS) || slides[at] != 0u {
        return;
    }
    if earlier == STICK && after == OPEN {
        came_off[at] = 1u;
    }
    if came_off[at] != 0u && after == STICK {
        slides[at] = 1u;
    }
}

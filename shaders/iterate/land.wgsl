// Under full stick, after the trial has become the current iterate: a point that came off within
// the step and comes down again has let go of its tangential force, and slides up to the step's
// end; a thread a point.

@group(0) @binding(9) var<storage, read_write> let_go: array<u32>;      // [case][point]: SLIDES, CAME_OFF

@compute @workgroup_size(64)
fn iterate_land(@builtin(global_invocation_id) id: vec3<u32>) {
    let points = dimensions.contact_points;
    if id.x >= points || id.y >= dimensions.in_dispatch {
        return;
    }
    let case_index = active_cases[id.y].x;
    let at = case_index * points + id.x;
    let current = marks[id.y].x;
    let after = status_of(case_index, current, id.x);
    let earlier = status_of(case_index, 1u - current, id.x);
    var bits = let_go[at];
    if !has(id.y, LANDS) || (bits & SLIDES) != 0u {
        return;
    }
    if earlier == STICK && after == OPEN {
        bits |= CAME_OFF;
    }
    if (bits & CAME_OFF) != 0u && after == STICK {
        bits |= SLIDES;
    }
    let_go[at] = bits;
}

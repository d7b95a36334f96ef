// What is known of a contact point before it moves, as `facing` has it.

// Numbers of a point: gap and position at the start of the step, the same of the undeformed body,
// curvature of the opponent.
const FACING: u32 = 9u;
const FROM_START: u32 = 0u;
const FROM_REFERENCE: u32 = 4u;
const CURVATURE: u32 = 8u;

// Where a point has its first number; each is contact_points after the last.
fn facing_place(case_index: u32, point: u32) -> u32 {
    return FACING * case_index * dimensions.contact_points + point;
}

// A point since the start of the step or since there was no load.
fn facing_since(case_index: u32, point: u32, since: u32) -> Facing {
    let points = dimensions.contact_points;
    let at = facing_place(case_index, point);
    let first = at + since * points;
    let position = vec3<real>(facing[first + points], facing[first + 2u * points], facing[first + 3u * points]);
    return Facing(facing[first], position, facing[at + CURVATURE * points]);
}

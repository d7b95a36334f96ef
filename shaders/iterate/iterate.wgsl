// What a trial's kernels know beside their marks, and where the numbers of an iterate are.

@group(0) @binding(3) var<storage, read> numbers: array<real>;  // [slot][NUMBERS]: see told.wgsl

// Bits of a contact point, for the present step.
const SLIDES: u32 = 1;          // without friction
const CAME_OFF: u32 = 2;        // under full stick

// Numbers of an iterate's contact point: residual, force rows, displacement rows (ROWS in all),
// status + 4, 8, 16 for fixed x, y, z, c of Alart and Curnier, and the frame in which all that is.
const CONDITIONS: u32 = 32;
const CODE: u32 = 21;
const WEIGHT: u32 = 22;
const FRAME: u32 = 23;

fn trial_depth(slot: u32) -> real {
    return number(slot, DEPTH) + number(slot, STEP) * number(slot, DEPTH_CHANGE);
}

// Where the numbers of an iterate begin, so many of them each.
fn iterate_place_of(case_index: u32, iterate: u32, count: u32) -> u32 {
    return (2u * case_index + iterate) * count;
}

// Where an iterate has its increment at a node, and the internal force there.
fn increment_place(case_index: u32, iterate: u32, node: u32) -> u32 {
    return iterate_place_of(case_index, iterate, 6u * dimensions.nodes) + 3u * node;
}

fn force_place(case_index: u32, iterate: u32, node: u32) -> u32 {
    return increment_place(case_index, iterate, node) + 3u * dimensions.nodes;
}

// Where an iterate has the conditions of a contact point; each is contact_points after the last.
fn conditions_place(case_index: u32, iterate: u32, point: u32) -> u32 {
    return iterate_place_of(case_index, iterate, CONDITIONS * dimensions.contact_points) + point;
}

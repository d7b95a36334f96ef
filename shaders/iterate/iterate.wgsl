// What a trial's kernels know beside their marks.

@group(0) @binding(4) var<storage, read> depth_changes: array<real>;    // [slot]: see depth.wgsl

// Change of h along the whole correction.
fn depth_change(slot: u32) -> real {
    if has(slot, RESPONDS) {
        return depth_changes[slot];
    }
    return number(slot, DEPTH_CHANGE);
}

fn trial_depth(slot: u32) -> real {
    return number(slot, DEPTH) + number(slot, STEP) * depth_change(slot);
}

// Where the numbers of an iterate begin, so many of them each.
fn iterate_place_of(case_index: u32, iterate: u32, count: u32) -> u32 {
    return (2u * case_index + iterate) * count;
}

// The iterates of Newton's method, which stay on the device: each case has two, the current one and
// the trial, and a correction from the one to the other. The host says what is to be done by marks
// and numbers of each slot.

// [slot]: current iterate, trial, flags, source of the trial
@group(0) @binding(2) var<storage, read> marks: array<vec4<u32>>;
@group(0) @binding(3) var<storage, read> numbers: array<real>;      // [slot][NUMBERS]
@group(0) @binding(4) var<storage, read> records: array<u32>;       // [slot][RECORD]: see linalg/record.wgsl, its bits

const NUMBERS: u32 = 8;
const STEP: u32 = 0;            // step length along the correction
const DEPTH: u32 = 1;           // h of the current iterate
const SHEAR: u32 = 2;           // delta_T at the end of the step
const DEPTH_CHANGE: u32 = 3;    // of h along the whole correction
const HELD_FORCE: u32 = 4;
const RATIO: u32 = 5;           // of an extrapolation to the last step; of a shift its x
const SHIFT_Z: u32 = 6;
const MISSING: u32 = 7;         // of the plate's force, that along the correction taken off

const PLACES_PLATE: u32 = 1;
const HOLDS_FORCE: u32 = 2;
const RESPONDS: u32 = 4;        // h changes by what is missing over the response to a unit indentation
const LIFTS: u32 = 8;           // points below the plane are put on it
const IS_FIRST: u32 = 16;       // of its step
const LANDS: u32 = 32;          // the last trial was kept, under full stick

const RECORD: u32 = 12;
const ALONG: u32 = 11;

fn number(slot: u32, which: u32) -> real {
    return numbers[NUMBERS * slot + which];
}

fn has(slot: u32, flag: u32) -> bool {
    return (marks[slot].z & flag) != 0u;
}

// Change of h along the whole correction.
fn depth_change(slot: u32) -> real {
    if has(slot, RESPONDS) {
        return number(slot, MISSING) / -real_of_single(records[RECORD * slot + ALONG]);
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

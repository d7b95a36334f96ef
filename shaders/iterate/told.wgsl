// The iterates of Newton's method, which stay on the device: each case has two, the current one and
// the trial, and a correction from the one to the other. The host says what is to be done by marks
// and numbers of each slot.

// [slot]: current iterate, trial, flags, source of the trial
@group(0) @binding(2) var<uniform> marks: array<vec4<u32>, MOST_SLOTS>;

// Of [slot][NUMBERS]: see iterate.wgsl, and depth.wgsl, which writes one of them.
const NUMBERS: u32 = 9;
const STEP: u32 = 0;            // step length along the correction
const DEPTH: u32 = 1;           // h of the current iterate
const SHEAR: u32 = 2;           // delta_T at the end of the step
const DEPTH_CHANGE: u32 = 3;    // of h along the whole correction; where a force is held, see depth.wgsl
const HELD_FORCE: u32 = 4;
const RATIO: u32 = 5;           // of an extrapolation to the last step; of a shift its x
const SHIFT_Z: u32 = 6;
const MISSING: u32 = 7;         // of the plate's force, at the current iterate
const BACK: u32 = 8;            // by which the solutions of the slot's scaled systems are multiplied

const PLACES_PLATE: u32 = 1;
const HOLDS_FORCE: u32 = 2;
const LIFTS: u32 = 8;           // points below the plane are put on it
const IS_FIRST: u32 = 16;       // of its step
const LANDS: u32 = 32;          // the last trial was kept, under full stick

fn number(slot: u32, which: u32) -> real {
    return numbers[NUMBERS * slot + which];
}

fn has(slot: u32, flag: u32) -> bool {
    return (marks[slot].z & flag) != 0u;
}

// DEPTH_CHANGE, of h along the whole correction, where a force is held: what is missing of the
// plate's force at the end of the correction at constant h, over what a unit indentation adds to
// it; a thread a slot.

// [slot][RECORD]: see linalg/record.wgsl, its bits; of the correction's systems, of the responses'
@group(0) @binding(4) var<storage, read> corrections: array<u32>;
@group(0) @binding(5) var<storage, read> units: array<u32>;
@group(0) @binding(3) var<storage, read_write> numbers: array<real>;        // [slot][NUMBERS]

const RECORD: u32 = 13;
const ALONG: u32 = 11;

@compute @workgroup_size(64)
fn iterate_depth(@builtin(global_invocation_id) id: vec3<u32>) {
    let slot = id.y;
    if id.x > 0u || slot >= dimensions.in_dispatch {
        return;
    }
    let along = number(slot, BACK) * real_of_single(corrections[RECORD * slot + ALONG]);
    numbers[NUMBERS * slot + DEPTH_CHANGE] = (number(slot, MISSING) + along) / -real_of_single(units[RECORD * slot + ALONG]);
}

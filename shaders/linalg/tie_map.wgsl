// A vector through a map of a pair's interface; a thread a number.

@group(0) @binding(3) var<storage, read> point_of: array<u32>;      // [node]: its contact point
@group(0) @binding(4) var<storage, read> is_fixed: array<u32>;      // [slot][node]: a bit a component
@group(0) @binding(5) var<storage, read> records: array<Record>;
@group(0) @binding(6) var<storage, read> given: array<real>;        // [slot][component][node]
@group(0) @binding(7) var<storage, read_write> to: array<real>;     // [slot][component][node]

const NOWHERE: u32 = 0xffffffffu;

// What else is done, a bit each: fixed unknowns become nothing; free ones stay as they are; slots
// that are done are not left out.
const TIE_CLEARS: u32 = 1u;
const TIE_KEEPS_FREE: u32 = 2u;
const TIE_OF_ALL: u32 = 4u;

@compute @workgroup_size(192)
fn tie_map(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let slot = records[group.y].running;
    let node = NODES_IN_GROUP * group.x + local % NODES_IN_GROUP;
    if ((tie.w & TIE_OF_ALL) == 0u && records[slot].done != RUNNING) || node >= level.nodes {
        return;
    }
    let component = local / NODES_IN_GROUP;
    let at = (3u * slot + component) * level.nodes + node;
    let fixed = (is_fixed[slot * level.nodes + node] >> component) % 2u == 1u;
    var value = given[at];
    if point_of[node] != NOWHERE && ((tie.w & TIE_KEEPS_FREE) == 0u || fixed) {
        value = tied(slot, component, point_of[node]);
    }
    if (tie.w & TIE_CLEARS) != 0u && fixed {
        value = 0.0;
    }
    to[at] = value;
}

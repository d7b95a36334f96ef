// The increments of a trial since the start of the step, a thread a node.

@group(0) @binding(5) var<storage, read> starts: array<real>;           // [case]: displacement [3 node + i], states
@group(0) @binding(6) var<storage, read> before: array<real>;           // [case][3 node + i]: one step earlier
@group(0) @binding(7) var<storage, read> correction: array<real>;       // [case][3 node + i]
@group(0) @binding(8) var<storage, read> node_info: array<u32>;         // [node]: see residual.wgsl
@group(0) @binding(9) var<storage, read> facing: array<real>;           // [case][FACING][point]
@group(0) @binding(10) var<storage, read_write> iterates: array<real>;  // [case][iterate][increment, force][3 node + i]
@group(0) @binding(11) var<storage, read_write> trials: array<real>;    // [slot]: increment [3 node + i], det F - 1

const ALONG_CORRECTION: u32 = 0;
const EXTRAPOLATED: u32 = 1;
const AT_START: u32 = 2;
const SHIFTED: u32 = 3;

@compute @workgroup_size(64)
fn iterate_place(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= dimensions.nodes || id.y >= dimensions.in_dispatch {
        return;
    }
    let slot = id.y;
    let case_index = active_cases[slot].x;
    let mark = marks[slot];
    let n = 3u * dimensions.nodes;
    let of_case = case_index * n + 3u * id.x;
    let of_start = case_index * dimensions.start_numbers + 3u * id.x;
    let base = increment_place(case_index, mark.x, id.x);
    let info = node_info[id.x];
    var d = vec3<real>();
    for (var i = 0u; i < 3u; i++) {
        switch mark.w {
            case ALONG_CORRECTION: {
                d[i] = iterates[base + i] + number(slot, STEP) * correction[of_case + i];
            }
            case EXTRAPOLATED: {
                d[i] = number(slot, RATIO) * (starts[of_start + i] - before[of_case + i]);
            }
            case SHIFTED: {
                d[i] = iterates[base + i];
            }
            default: {}
        }
    }
    if mark.w == SHIFTED {
        d += vec3<real>(number(slot, RATIO), 0.0, number(slot, SHIFT_Z));
    }
    if has(slot, LIFTS) && info >= FIRST_POINT {
        d += rigid_push_out(facing_since(case_index, info / FIRST_POINT - 1u, FROM_START), d);
    }
    if has(slot, PLACES_PLATE) && (info & IS_PLATE) != 0u {
        d = vec3<real>(
            number(slot, SHEAR) - starts[of_start],
            -starts[of_start + 1u],
            -trial_depth(slot) - starts[of_start + 2u],
        );
    }
    let to = increment_place(case_index, mark.y, id.x);
    let out = slot * dimensions.trial_numbers + 3u * id.x;
    for (var i = 0u; i < 3u; i++) {
        iterates[to + i] = d[i];
        trials[out + i] = d[i];
    }
}

// The increments of a trial since the start of the step, a thread a node.

@group(0) @binding(5) var<storage, read> committed: array<real>;        // [case][3 node + i]: displacement
@group(0) @binding(6) var<storage, read> before: array<real>;           // [case][3 node + i]: one step earlier
@group(0) @binding(7) var<storage, read> correction: array<real>;       // [case][3 node + i]
@group(0) @binding(8) var<storage, read> node_info: array<u32>;         // [node]: see residual.wgsl
@group(0) @binding(9) var<storage, read> gap_at_start: array<real>;     // [case][point]
@group(0) @binding(10) var<storage, read_write> increments: array<real>;    // [case][iterate][3 node + i]
@group(0) @binding(11) var<storage, read_write> increment: array<real>; // [slot][3 node + i], as the elements read it

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
    let base = iterate_place_of(case_index, mark.x, n) + 3u * id.x;
    let info = node_info[id.x];
    var d = vec3<real>();
    for (var i = 0u; i < 3u; i++) {
        switch mark.w {
            case ALONG_CORRECTION: {
                d[i] = increments[base + i] + number(slot, STEP) * correction[of_case + i];
            }
            case EXTRAPOLATED: {
                d[i] = number(slot, RATIO) * (committed[of_case + i] - before[of_case + i]);
            }
            case SHIFTED: {
                d[i] = increments[base + i];
            }
            default: {}
        }
    }
    if mark.w == SHIFTED {
        d += vec3<real>(number(slot, RATIO), 0.0, number(slot, SHIFT_Z));
    }
    if has(slot, LIFTS) && info >= FIRST_POINT {
        let height = gap(gap_at_start[case_index * dimensions.contact_points + info / FIRST_POINT - 1u], d.z);
        d.z -= min(height, real(0.0));
    }
    if has(slot, PLACES_PLATE) && (info & IS_PLATE) != 0u {
        d = vec3<real>(
            number(slot, SHEAR) - committed[of_case],
            -committed[of_case + 1u],
            -trial_depth(slot) - committed[of_case + 2u],
        );
    }
    let to = iterate_place_of(case_index, mark.y, n) + 3u * id.x;
    let out = slot * n + 3u * id.x;
    for (var i = 0u; i < 3u; i++) {
        increments[to + i] = d[i];
        increment[out + i] = d[i];
    }
}

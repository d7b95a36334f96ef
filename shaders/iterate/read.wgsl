// What the host decides by: sums over a trial's nodes, plate and contact points; a workgroup a slot.

// [point]: its node, and whether it is on the symmetry plane; then the number of the plate's nodes,
// and they
@group(0) @binding(5) var<storage, read> surface: array<u32>;
@group(0) @binding(6) var<storage, read> iterates: array<real>;         // [case][iterate][increment, force][3 node + i]
@group(0) @binding(7) var<storage, read> let_go: array<u32>;            // [case][point]: SLIDES, CAME_OFF
@group(0) @binding(9) var<storage, read> partial_sums: array<real>;     // [slot][PARTS][workgroup]
@group(0) @binding(10) var<storage, read_write> readings: array<real>;  // [slot][READINGS]
// [slot]: status changed, come down again, closed, slipping
@group(0) @binding(11) var<storage, read_write> counts: array<vec4<u32>>;

const READINGS: u32 = 10;

// What a point, or all of them, add to a reading.
struct Part {
    scale: real,
    normal: real,
    tangential: real,
    released: real,
    counts: vec4<u32>,
}

// Adds contact point k of the iterate `mark.y`; before the step it was as in `mark.x`.
fn add_point(sum: ptr<function, Part>, case_index: u32, mark: vec4<u32>, k: u32) {
    let points = dimensions.contact_points;
    let code = code_of(case_index, mark.y, k);
    let status = code % 4u;
    let status_before = status_of(case_index, mark.x, k);
    let force = force_place(case_index, mark.y, surface[k] & ~ON_SYMMETRY_PLANE);
    let exerted = vec3<real>(iterates[force], iterates[force + 1u], iterates[force + 2u]);
    let axes = frame_of(case_index, mark.y, k);
    let f_n = dot(axes.n, exerted);
    let row = conditions_place(case_index, mark.y, k);
    let along = rows[row] * rows[row];
    let across = rows[row + points] * rows[row + points];
    let bits = let_go[case_index * points + k];
    let sticks = (bits & SLIDES) == 0u;
    if status != OPEN {
        // Forces at what contact prescribes are in no residual: what is not finite is not to be lost.
        for (var i = 0u; i < 3u; i++) {
            if !is_finite(exerted[i]) {
                (*sum).scale += exerted[i];
            }
        }
        (*sum).scale += abs(f_n);
        let is_halved = (surface[k] & ON_SYMMETRY_PLANE) != 0u;
        (*sum).normal += contact_force(axes, exerted, vec2<real>(rows[row], rows[row + points]), is_halved).z;
        (*sum).tangential += along + across;
        (*sum).counts.z += 1u;
    } else if status_before == STICK && sticks {
        (*sum).released += along;
        if (code & 8u) == 0u {
            (*sum).released += across;
        }
    }
    if status == SLIP {
        (*sum).counts.w += 1u;
    }
    if status != status_before {
        (*sum).counts.x += 1u;
    }
    if sticks && status == STICK && (bits & CAME_OFF) != 0u {
        (*sum).counts.y += 1u;
    }
}

@compute @workgroup_size(256)
fn iterate_read(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let slot = group.y;
    if slot >= dimensions.in_dispatch {
        return;
    }
    let case_index = active_cases[slot].x;
    let mark = marks[slot];
    let out = READINGS * slot;
    let groups = (dimensions.nodes + THREADS - 1u) / THREADS;
    let first = PARTS * slot * groups;
    var square: real = 0.0;
    var work: real = 0.0;
    var work_before: real = 0.0;
    var most: real = 0.0;
    for (var g = local; g < groups; g += THREADS) {
        square += partial_sums[first + g];
        work += partial_sums[first + groups + g];
        work_before += partial_sums[first + 2u * groups + g];
        most = max(most, partial_sums[first + 3u * groups + g]);
    }
    square = add_up(local, square);
    work = add_up(local, work);
    work_before = add_up(local, work_before);
    most = largest_of(local, most);
    let points = dimensions.contact_points;
    var plate_force: real = 0.0;
    for (var i = local; i < surface[points]; i += THREADS) {
        plate_force -= iterates[force_place(case_index, mark.y, surface[points + 1u + i]) + 2u];
    }
    plate_force = add_up(local, plate_force);

    var part: Part;
    for (var k = local; k < points; k += THREADS) {
        add_point(&part, case_index, mark, k);
    }
    let scale = add_up(local, part.scale);
    let normal = add_up(local, part.normal);
    let tangential = add_up(local, part.tangential);
    let released = add_up(local, part.released);
    let counted = vec4<u32>(
        count_up(local, part.counts.x),
        count_up(local, part.counts.y),
        count_up(local, part.counts.z),
        count_up(local, part.counts.w),
    );
    if local == 0u {
        var missing: real = 0.0;
        if has(slot, HOLDS_FORCE) {
            missing = number(slot, HELD_FORCE) - plate_force;
        }
        readings[out] = sqrt(square + missing * missing);
        readings[out + 1u] = scale;
        readings[out + 2u] = plate_force;
        readings[out + 3u] = sqrt(tangential);
        readings[out + 4u] = normal;
        readings[out + 5u] = work;
        readings[out + 6u] = work_before;
        readings[out + 7u] = released;
        readings[out + 8u] = number(slot, DEPTH_CHANGE);
        readings[out + 9u] = most;
        counts[slot] = counted;
    }
}

fn count_up(local: u32, count: u32) -> u32 {
    return u32(add_up(local, real(count)));
}

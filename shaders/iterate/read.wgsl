// What the host decides by: sums over a trial's nodes, plate and contact points; a workgroup a slot.

@group(0) @binding(5) var<storage, read> plate: array<u32>;             // number of its nodes, and they
@group(0) @binding(6) var<storage, read> contact_node: array<u32>;      // [point]
@group(0) @binding(7) var<storage, read> forces: array<real>;           // [case][iterate][3 node + i]
// [case][iterate][residual, force rows, displacement rows][point]
@group(0) @binding(8) var<storage, read> rows: array<real>;
@group(0) @binding(9) var<storage, read> codes: array<u32>;             // [case][iterate][point]
@group(0) @binding(10) var<storage, read> slides: array<u32>;           // [case][point]: without friction in this step
@group(0) @binding(11) var<storage, read> came_off: array<u32>;         // [case][point]: under full stick, in this step
@group(0) @binding(12) var<storage, read> partial_sums: array<real>;    // [slot][PARTS][workgroup]
@group(0) @binding(13) var<storage, read_write> largest: array<real>;   // [case][iterate]: of the right-hand side
@group(0) @binding(14) var<storage, read_write> readings: array<real>;  // [slot][READINGS]
// [slot]: status changed, come down again, closed, slipping
@group(0) @binding(15) var<storage, read_write> counts: array<vec4<u32>>;

const READINGS: u32 = 10;

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
    let of_forces = iterate_place_of(case_index, mark.y, 3u * dimensions.nodes);
    var plate_force: real = 0.0;
    for (var i = local; i < plate[0]; i += THREADS) {
        plate_force -= forces[of_forces + 3u * plate[1u + i] + 2u];
    }
    plate_force = add_up(local, plate_force);

    let points = dimensions.contact_points;
    var scale: real = 0.0;
    var normal: real = 0.0;
    var tangential: real = 0.0;
    var released: real = 0.0;
    var count = vec4<u32>();
    for (var k = local; k < points; k += THREADS) {
        let code = codes[iterate_place_of(case_index, mark.y, points) + k];
        let status = code % 4u;
        let status_before = codes[iterate_place_of(case_index, mark.x, points) + k] % 4u;
        let f_z = forces[of_forces + 3u * contact_node[k] + 2u];
        let row = iterate_place_of(case_index, mark.y, ROWS * points) + k;
        let along = rows[row] * rows[row];
        let across = rows[row + points] * rows[row + points];
        let sticks = slides[case_index * points + k] == 0u;
        if status != OPEN {
            // Forces at what contact prescribes are in no residual: what is not finite is not to be lost.
            for (var i = 0u; i < 2u; i++) {
                let along_plane = forces[of_forces + 3u * contact_node[k] + i];
                if !is_finite(along_plane) {
                    scale += along_plane;
                }
            }
            scale += abs(f_z);
            normal += max(f_z, real(0.0));
            tangential += along + across;
            count.z += 1u;
        } else if status_before == STICK && sticks {
            released += along;
            if (code & 8u) == 0u {
                released += across;
            }
        }
        if status == SLIP {
            count.w += 1u;
        }
        if status != status_before {
            count.x += 1u;
        }
        if sticks && status == STICK && came_off[case_index * points + k] != 0u {
            count.y += 1u;
        }
    }
    scale = add_up(local, scale);
    normal = add_up(local, normal);
    tangential = add_up(local, tangential);
    released = add_up(local, released);
    let counted = vec4<u32>(
        count_up(local, count.x),
        count_up(local, count.y),
        count_up(local, count.z),
        count_up(local, count.w),
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
        readings[out + 8u] = depth_change(slot);
        readings[out + 9u] = most;
        largest[2u * case_index + mark.y] = most;
        counts[slot] = counted;
    }
}

fn count_up(local: u32, count: u32) -> u32 {
    return u32(add_up(local, real(count)));
}

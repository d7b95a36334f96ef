// Lists the slots that run, and after them the others, each in increasing order, and says for how
// many the next kernels are dispatched; a thread a slot.

@group(0) @binding(1) var<storage, read_write> records: array<Record>;
@group(0) @binding(2) var<storage, read_write> calls: array<u32>;      // workgroups along x, y and z

@compute @workgroup_size(64)
fn krylov_running(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    if id.x > 0u {
        return;
    }
    let slot = id.y;
    var before = 0u;
    var count = 0u;
    for (var other = 0u; other < groups.y; other++) {
        if records[other].done == RUNNING {
            count += 1u;
            if other < slot {
                before += 1u;
            }
        }
    }
    var place = before;
    if records[slot].done != RUNNING {
        place = count + slot - before;
    }
    records[place].running = slot;
    if slot == 0u {
        for (var call = 0u; call < arrayLength(&calls) / 3u; call++) {
            calls[3u * call + 1u] = count;
        }
    }
}

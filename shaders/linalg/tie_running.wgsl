// Has the V-cycles on half of the body follow the slots: slot s has the even half in 2 s and the
// odd one in 2 s + 1; a thread a slot.

@group(0) @binding(1) var<storage, read> records: array<Record>;
@group(0) @binding(2) var<storage, read_write> halves: array<Record>;
@group(0) @binding(3) var<storage, read_write> calls: array<u32>;      // workgroups along x, y and z

@compute @workgroup_size(64)
fn tie_running(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    if id.x > 0u {
        return;
    }
    let place = id.y;
    let slot = records[place].running;
    for (var parity = 0u; parity < 2u; parity++) {
        halves[2u * place + parity].running = 2u * slot + parity;
        halves[2u * slot + parity].done = records[slot].done;
    }
    if place > 0u {
        return;
    }
    var count = 0u;
    for (var other = 0u; other < groups.y; other++) {
        count += u32(records[other].done == RUNNING);
    }
    for (var call = 0u; call < arrayLength(&calls) / 3u; call++) {
        calls[3u * call + 1u] = 2u * count;
    }
}

// Smooths a small level from x = 0, and leaves its residual to the next one; a workgroup a slot.

@group(0) @binding(8) var<storage, read_write> residual: array<real>;   // [slot][component][node]

@compute @workgroup_size(256)
fn small_down(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let slot = records[group.y].running;
    if records[slot].done != RUNNING {
        return;
    }
    for (var step = 0u; step < level.smoothing_steps; step++) {
        smooth_once(slot, local, step, step == 0u);
    }
    leave(slot, local, false);
    for (var i = local; i < 3u * level.nodes; i += SMALL_THREADS) {
        residual[3u * slot * level.nodes + i] = left[i];
    }
}

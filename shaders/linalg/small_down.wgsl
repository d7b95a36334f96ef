// Smooths a small level from x = 0, and leaves its residual to the next one; a workgroup a slot.

@compute @workgroup_size(256)
fn small_down(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    if records[group.y].done != RUNNING {
        return;
    }
    for (var step = 0u; step < level.smoothing_steps; step++) {
        smooth_once(group.y, local, step, step == 0u);
    }
    leave(group.y, local, false);
}

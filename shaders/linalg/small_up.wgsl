// Adds the next level's correction to a small level and smooths it; a workgroup a slot.

@group(0) @binding(8) var<storage, read> transfer: array<u32>;      // see transfer.wgsl
@group(0) @binding(9) var<storage, read> coarse: array<real>;       // [slot][component][node of the next level]

@compute @workgroup_size(256)
fn small_up(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let slot = records[group.y].running;
    if records[slot].done != RUNNING {
        return;
    }
    for (var i = local; i < 3u * level.nodes; i += SMALL_THREADS) {
        let node = i % level.nodes;
        let source_at = (3u * slot + i / level.nodes) * level.coarse_nodes;
        var sum: real = 0.0;
        for (var e = transfer[node]; e < transfer[node + 1u]; e += 2u) {
            sum += real_of_single(transfer[e + 1u]) * coarse[source_at + transfer[e]];
        }
        x[3u * slot * level.nodes + i] += sum;
    }
    storageBarrier();
    for (var step = 0u; step < level.smoothing_steps; step++) {
        smooth_once(slot, local, step, false);
    }
}

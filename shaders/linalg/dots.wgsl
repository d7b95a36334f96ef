// Products of w with each basis vector and, last, with itself: the partial sums of a chunk.

@group(0) @binding(1) var<storage, read> records: array<Record>;
@group(0) @binding(2) var<storage, read> basis: array<real>;            // [slot][vector][component][node]
@group(0) @binding(3) var<storage, read> w: array<real>;                // [slot][component][node]
@group(0) @binding(4) var<storage, read_write> partial_sums: array<real>;   // [slot][vector][chunk]

@compute @workgroup_size(256)
fn krylov_dots(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let slot = records[group.y].running;
    if records[slot].done != RUNNING {
        return;
    }
    let n = 3u * level.nodes;
    let vectors = records[slot].vectors;
    for (var i = 0u; i <= vectors; i++) {
        let first = (slot * (level.restart + 1u) + i) * n;
        var sum: real = 0.0;
        for (var k = CHUNK * group.x + local; k < min(n, CHUNK * (group.x + 1u)); k += THREADS) {
            let entry = w[slot * n + k];
            if i < vectors {
                sum += basis[first + k] * entry;
            } else {
                sum += entry * entry;
            }
        }
        let product = add_up(local, sum);
        if local == 0u {
            partial_sums[partial_place(slot, i) + group.x] = product;
        }
    }
}

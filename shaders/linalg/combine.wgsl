// answer = solution + the combination of the preconditioned vectors.

@group(0) @binding(1) var<storage, read> records: array<Record>;
@group(0) @binding(2) var<storage, read> small: array<real>;            // see krylov.wgsl
@group(0) @binding(3) var<storage, read> preconditioned: array<real>;   // [slot][step][component][node]
@group(0) @binding(4) var<storage, read> solution: array<real>;         // [slot][component][node], before the cycle
@group(0) @binding(5) var<storage, read_write> answer: array<real>;     // [slot][component][node]

@compute @workgroup_size(256)
fn krylov_combine(@builtin(global_invocation_id) id: vec3<u32>) {
    let n = 3u * level.nodes;
    if id.x >= n {
        return;
    }
    let slot = id.y;
    var sum = solution[slot * n + id.x];
    for (var j = 0u; j < records[slot].steps; j++) {
        sum += small[combination_place(slot) + j] * preconditioned[(slot * level.restart + j) * n + id.x];
    }
    answer[slot * n + id.x] = sum;
}

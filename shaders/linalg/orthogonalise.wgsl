// One pass of classical Gram-Schmidt: takes w's components along the basis out of w, and adds them
// to the column of the Hessenberg matrix.

@group(0) @binding(1) var<storage, read> records: array<Record>;
@group(0) @binding(2) var<storage, read> basis: array<real>;            // [slot][vector][component][node]
@group(0) @binding(3) var<storage, read> partial_sums: array<real>;     // [slot][vector][chunk]
@group(0) @binding(4) var<storage, read_write> w: array<real>;          // [slot][component][node]
@group(0) @binding(5) var<storage, read_write> small: array<real>;      // see krylov.wgsl
@group(0) @binding(6) var<storage, read_write> squares: array<real>;    // [slot][chunk], of what is left of w

var<workgroup> coefficients: array<real, THREADS>;

@compute @workgroup_size(256)
fn krylov_orthogonalise(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let slot = records[group.y].running;
    if records[slot].done != RUNNING {
        return;
    }
    let n = 3u * level.nodes;
    let vectors = records[slot].vectors;
    if local < vectors {
        var sum: real = 0.0;
        for (var c = 0u; c < chunks(); c++) {
            sum += partial_sums[partial_place(slot, local) + c];
        }
        coefficients[local] = sum;
        if group.x == 0u {
            small[small_place(slot) + local] += sum;
        }
    }
    workgroupBarrier();
    var square: real = 0.0;
    for (var k = CHUNK * group.x + local; k < min(n, CHUNK * (group.x + 1u)); k += THREADS) {
        var left = w[slot * n + k];
        for (var i = 0u; i < vectors; i++) {
            left -= coefficients[i] * basis[(slot * (level.restart + 1u) + i) * n + k];
        }
        w[slot * n + k] = left;
        square += left * left;
    }
    let left_over = add_up(local, square);
    if local == 0u {
        squares[slot * chunks() + group.x] = left_over;
    }
}

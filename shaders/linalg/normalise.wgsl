// w to unit length: the basis vector that is next.

@group(0) @binding(1) var<storage, read> records: array<Record>;
@group(0) @binding(2) var<storage, read_write> w: array<real>;          // [slot][component][node]
@group(0) @binding(3) var<storage, read_write> basis: array<real>;      // [slot][vector][component][node]

@compute @workgroup_size(256)
fn krylov_normalise(@builtin(global_invocation_id) id: vec3<u32>) {
    let slot = records[id.y].running;
    let n = 3u * level.nodes;
    if records[slot].done != RUNNING || id.x >= n {
        return;
    }
    let unit = records[slot].scale * w[slot * n + id.x];
    w[slot * n + id.x] = unit;
    basis[(slot * (level.restart + 1u) + records[slot].vectors - 1u) * n + id.x] = unit;
}

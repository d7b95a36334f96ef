// A P: what is fixed contributes nothing, neither by its rows nor by its columns.

@group(0) @binding(4) var<storage, read> given: array<u32>;         // the matrix: see halves.wgsl
@group(0) @binding(5) var<storage, read_write> to: array<real>;     // [slot][3 i + j][block]
@group(0) @binding(6) var<storage, read> column: array<u32>;        // [k][node]
@group(0) @binding(7) var<storage, read> is_fixed: array<u32>;      // [slot][node]: a bit a component

@compute @workgroup_size(64)
fn galerkin_product(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= level.products {
        return;
    }
    let slot = id.y;
    var sum = mat3x3<real>();
    for (var e = list_start[id.x]; e < list_start[id.x + 1u]; e++) {
        let block = list_entry[e];
        var a = load_block(slot, block);
        let rows = is_fixed[slot * level.nodes + block % level.nodes];
        let columns = is_fixed[slot * level.nodes + column[block]];
        if (rows | columns) != 0u {
            for (var j = 0u; j < 3u; j++) {
                for (var i = 0u; i < 3u; i++) {
                    if ((rows >> i) | (columns >> j)) % 2u == 1u {
                        a[j][i] = 0.0;
                    }
                }
            }
        }
        sum += a * list_weight[e];
    }
    let out = 9u * slot * level.products + id.x;
    for (var j = 0u; j < 3u; j++) {
        for (var i = 0u; i < 3u; i++) {
            to[out + (3u * i + j) * level.products] = sum[j][i];
        }
    }
}

// Block k of a node's row, which is number k nodes + node.
fn load_block(slot: u32, block: u32) -> mat3x3<real> {
    let words = words();
    let k = block / level.nodes;
    let at = 18u * slot * words + k / 2u * level.nodes + block % level.nodes;
    let shift = 16u * (1u - k % 2u);
    var a = mat3x3<real>();
    for (var j = 0u; j < 3u; j++) {
        for (var i = 0u; i < 3u; i++) {
            let m = at + (3u * i + j) * words;
            a[j][i] = whole(given[m] << shift, given[m + 9u * words] << shift);
        }
    }
    return a;
}

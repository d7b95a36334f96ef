// A P: what is fixed contributes nothing, neither by its rows nor by its columns.

@group(0) @binding(6) var<storage, read> column: array<u32>;        // [k][node]
@group(0) @binding(7) var<storage, read> is_fixed: array<u32>;      // [slot][node]: a bit a component

@compute @workgroup_size(64)
fn galerkin_product(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= level.products {
        return;
    }
    let slot = id.y;
    let count = level.width * level.nodes;
    var sum = mat3x3<real>();
    for (var e = list_start[id.x]; e < list_start[id.x + 1u]; e++) {
        let block = list_entry[e];
        var a = load_block(9u * slot * count + block, count);
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
    store_block(9u * slot * level.products + id.x, level.products, sum);
}

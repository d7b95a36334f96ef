// The coarsest level: the whole polynomial from x = 0, one workgroup a slot.

@group(0) @binding(1) var<storage, read> column: array<u32>;        // [k][node]
@group(0) @binding(2) var<storage, read> matrix: array<real>;       // [slot][3 i + j][k][node]
@group(0) @binding(3) var<storage, read_write> x: array<real>;      // [slot][component][node]
@group(0) @binding(4) var<storage, read> inverse: array<real>;      // [slot][3 i + j][node]
@group(0) @binding(5) var<storage, read> b: array<real>;            // [slot][component][node]
@group(0) @binding(6) var<storage, read_write> last_step: array<real>;   // [slot][component][node]
@group(0) @binding(7) var<storage, read> recurrence: array<vec2<real>>;     // shares of the last step and of D^-1 r
@group(0) @binding(8) var<storage, read> records: array<Record>;

@compute @workgroup_size(256)
fn solve_coarsest(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let slot = group.y;
    if records[slot].done != RUNNING {
        return;
    }
    let first = 3u * slot * level.nodes;
    for (var k = 0u; k < level.coarsest_steps; k++) {
        let shares = recurrence[k];
        for (var node = local; node < level.nodes; node += 256u) {
            var r = vec3<real>(b[first + node], b[first + level.nodes + node], b[first + 2u * level.nodes + node]);
            if k > 0u {
                r -= block_row_times(slot, node);
            }
            let at = 9u * slot * level.nodes + node;
            for (var i = 0u; i < 3u; i++) {
                let of_row = at + 3u * i * level.nodes;
                let of_inverse =
                    vec3<real>(inverse[of_row], inverse[of_row + level.nodes], inverse[of_row + 2u * level.nodes]);
                var change = shares.y * dot(of_inverse, r);
                if k > 0u {
                    change += shares.x * last_step[first + i * level.nodes + node];
                }
                last_step[first + i * level.nodes + node] = change;
            }
        }
        storageBarrier();
        for (var i = local; i < 3u * level.nodes; i += 256u) {
            x[first + i] = select(x[first + i], real(0.0), k == 0u) + last_step[first + i];
        }
        storageBarrier();
    }
}

fn block_row_times(slot: u32, node: u32) -> vec3<real> {
    let blocks = level.width * level.nodes;
    var at = 9u * slot * blocks + node;
    var sum = vec3<real>();
    for (var k = 0u; k < level.width; k++) {
        let j = 3u * slot * level.nodes + column[k * level.nodes + node];
        let v = vec3<real>(x[j], x[j + level.nodes], x[j + 2u * level.nodes]);
        sum += vec3<real>(
            dot(vec3<real>(matrix[at], matrix[at + blocks], matrix[at + 2u * blocks]), v),
            dot(vec3<real>(matrix[at + 3u * blocks], matrix[at + 4u * blocks], matrix[at + 5u * blocks]), v),
            dot(vec3<real>(matrix[at + 6u * blocks], matrix[at + 7u * blocks], matrix[at + 8u * blocks]), v),
        );
        at += level.nodes;
    }
    return sum;
}

// The coarsest level: the whole polynomial from x = 0, one workgroup a slot.

@group(0) @binding(1) var<storage, read> column: array<u32>;        // [k][node]
@group(0) @binding(2) var<storage, read> matrix: array<u32>;        // see halves.wgsl
@group(0) @binding(3) var<storage, read_write> x: array<real>;      // [slot][component][node]
@group(0) @binding(4) var<storage, read> inverse: array<real>;      // see diagonal.wgsl
@group(0) @binding(5) var<storage, read> b: array<real>;            // [slot][component][node]
@group(0) @binding(6) var<storage, read_write> last_step: array<real>;   // [slot][component][node]
@group(0) @binding(7) var<storage, read> recurrence: array<vec2<real>>;     // shares of the last step and of D^-1 r
@group(0) @binding(8) var<storage, read> records: array<Record>;

@compute @workgroup_size(256)
fn solve_coarsest(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let slot = records[group.y].running;
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
            let at = 18u * slot * level.nodes + node;
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

// As in rounded_row_times.wgsl, three rows at once.
fn block_row_times(slot: u32, node: u32) -> vec3<real> {
    let words = words();
    let lost = (18u * slot + 9u) * level.nodes + node;
    let own = of_node(slot, node);
    var at = 18u * slot * words + node;
    var sum = vec3<real>();
    for (var i = 0u; i < 3u; i++) {
        let row = lost + 3u * i * level.nodes;
        sum[i] = dot(vec3<real>(inverse[row], inverse[row + level.nodes], inverse[row + 2u * level.nodes]), own);
    }
    for (var k = 0u; k < level.width; k += 2u) {
        let to = column[k * level.nodes + node];
        if to == NO_COLUMN {
            break;
        }
        let first = of_node(slot, to);
        let second = of_node(slot, column[(k + 1u) * level.nodes + node]);
        for (var i = 0u; i < 3u; i++) {
            let row = at + 3u * i * words;
            let upper = vec3<u32>(matrix[row], matrix[row + words], matrix[row + 2u * words]);
            sum[i] += dot(vec3<real>(rounded(upper.x << 16u), rounded(upper.y << 16u), rounded(upper.z << 16u)), first)
                + dot(vec3<real>(rounded(upper.x), rounded(upper.y), rounded(upper.z)), second);
        }
        at += level.nodes;
    }
    return sum;
}

fn of_node(slot: u32, node: u32) -> vec3<real> {
    let j = 3u * slot * level.nodes + node;
    return vec3<real>(x[j], x[j + level.nodes], x[j + 2u * level.nodes]);
}

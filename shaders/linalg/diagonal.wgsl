// Inverses of a level's diagonal blocks, and what rounding takes from each row (see
// rounded_row_times.wgsl); a thread a node. Components that are fixed, or whose row
// and column vanish, have none (it is 0: they receive no correction); a block that is singular to
// rounding is shifted first.

@group(0) @binding(1) var<storage, read> matrix: array<u32>;            // see halves.wgsl
@group(0) @binding(2) var<storage, read> diagonal: array<u32>;          // [node]: k of its diagonal block
@group(0) @binding(3) var<storage, read> is_fixed: array<u32>;          // [slot][node]: a bit a component
@group(0) @binding(4) var<storage, read_write> inverse: array<real>;    // [slot][inverse, lost][3 i + j][node]
@group(0) @binding(5) var<storage, read> column: array<u32>;            // [k][node]

@compute @workgroup_size(64)
fn invert_diagonal(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= level.nodes {
        return;
    }
    let node = id.x;
    let slot = id.y;
    let words = words();
    let k = diagonal[node];
    let at = 18u * slot * words + k / 2u * level.nodes + node;
    let shift = 16u * (1u - k % 2u);
    let bits = is_fixed[slot * level.nodes + node];
    var a = mat3x3<real>();
    var scale: real = 0.0;
    for (var j = 0u; j < 3u; j++) {
        for (var i = 0u; i < 3u; i++) {
            if ((bits >> i) | (bits >> j)) % 2u == 0u {
                let m = at + (3u * i + j) * words;
                a[j][i] = whole(matrix[m] << shift, matrix[m + 9u * words] << shift);
                scale = max(scale, abs(a[j][i]));
            }
        }
    }
    let out = 18u * slot * level.nodes + node;
    var b = mat3x3<real>();
    if scale > 0.0 && is_finite(scale) {
        var empty = vec3<bool>();
        for (var c = 0u; c < 3u; c++) {
            var largest: real = 0.0;
            for (var k = 0u; k < 3u; k++) {
                largest = max(largest, max(abs(a[c][k]), abs(a[k][c])));
            }
            empty[c] = largest <= 1e-12 * scale;
        }
        // In units of its largest entry: its determinant is of the order of 1.
        a = a * (1.0 / scale);
        for (var c = 0u; c < 3u; c++) {
            if empty[c] {
                a[c][c] = 1.0;
            }
        }
        // Rounding leaves a few 1e-7 of a determinant that is zero.
        if abs(determinant(a)) < 1e-6 {
            for (var c = 0u; c < 3u; c++) {
                if a[c][c] >= 0.0 {
                    a[c][c] += 0.01;
                } else {
                    a[c][c] -= 0.01;
                }
            }
        }
        let factor = 1.0 / (determinant(a) * scale);
        let regular = is_finite(factor);
        b = mat3x3<real>(
            vec3<real>(cross(a[1], a[2]).x, cross(a[2], a[0]).x, cross(a[0], a[1]).x) * factor,
            vec3<real>(cross(a[1], a[2]).y, cross(a[2], a[0]).y, cross(a[0], a[1]).y) * factor,
            vec3<real>(cross(a[1], a[2]).z, cross(a[2], a[0]).z, cross(a[0], a[1]).z) * factor,
        );
        for (var c = 0u; c < 3u; c++) {
            for (var k = 0u; k < 3u; k++) {
                if empty[c] || empty[k] {
                    b[c][k] = 0.0;
                } else if !regular {
                    b[c][k] = select(real(0.0), 1.0 / scale, c == k);
                }
            }
        }
    }
    for (var j = 0u; j < 3u; j++) {
        for (var i = 0u; i < 3u; i++) {
            inverse[out + (3u * i + j) * level.nodes] = b[j][i];
        }
    }
    let lost = lost_of_row(slot, node);
    for (var j = 0u; j < 3u; j++) {
        for (var i = 0u; i < 3u; i++) {
            inverse[out + (9u + 3u * i + j) * level.nodes] = lost[j][i];
        }
    }
}

// The sum of what rounding takes from the blocks of a row. Fixed columns have no part in products.
fn lost_of_row(slot: u32, node: u32) -> mat3x3<real> {
    let words = words();
    var at = 18u * slot * words + node;
    var sum = mat3x3<real>();
    for (var k = 0u; k < level.width; k += 2u) {
        let to = column[k * level.nodes + node];
        if to == NO_COLUMN {
            break;
        }
        let first = is_fixed[slot * level.nodes + to];
        let second = is_fixed[slot * level.nodes + column[(k + 1u) * level.nodes + node]];
        for (var j = 0u; j < 3u; j++) {
            for (var i = 0u; i < 3u; i++) {
                let upper = matrix[at + (3u * i + j) * words];
                let lower = matrix[at + (9u + 3u * i + j) * words];
                if (first >> j) % 2u == 0u {
                    sum[j][i] += whole(upper << 16u, lower << 16u) - rounded(upper << 16u);
                }
                if (second >> j) % 2u == 0u {
                    sum[j][i] += whole(upper, lower) - rounded(upper);
                }
            }
        }
        at += level.nodes;
    }
    return sum;
}

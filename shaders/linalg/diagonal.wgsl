// Inverses of a level's diagonal blocks, a thread a node. Components that are fixed, or whose row
// and column vanish, have none (it is 0: they receive no correction); a block that is singular to
// rounding is shifted first.

@group(0) @binding(1) var<storage, read> matrix: array<real>;           // [slot][3 i + j][k][node]
@group(0) @binding(2) var<storage, read> diagonal: array<u32>;          // [node]: k of its diagonal block
@group(0) @binding(3) var<storage, read> is_fixed: array<u32>;          // [slot][node]: a bit a component
@group(0) @binding(4) var<storage, read_write> inverse: array<real>;    // [slot][3 i + j][node]

@compute @workgroup_size(64)
fn invert_diagonal(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= level.nodes {
        return;
    }
    let node = id.x;
    let slot = id.y;
    let count = level.width * level.nodes;
    let at = 9u * slot * count + diagonal[node] * level.nodes + node;
    let bits = is_fixed[slot * level.nodes + node];
    var a = mat3x3<real>();
    var scale: real = 0.0;
    for (var j = 0u; j < 3u; j++) {
        for (var i = 0u; i < 3u; i++) {
            if ((bits >> i) | (bits >> j)) % 2u == 0u {
                a[j][i] = matrix[at + (3u * i + j) * count];
                scale = max(scale, abs(a[j][i]));
            }
        }
    }
    let out = 9u * slot * level.nodes + node;
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
}

// The tangent's upper block triangle: a thread a block d f_i/d u_j gathers from the elements that
// hold both nodes, in the order of a list made once. The moduli are applied and never formed:
//   g_a . c . g_b = m/2 (g_a.g_b 1 + g_b (x) g_a) - m/3 g_a (x) g_b
//                   + (n g_a) (x) (x g_b) + (x g_a) (x) (n g_b).

@group(0) @binding(7) var<storage, read> block_start: array<u32>;       // starts of the blocks' lists
@group(0) @binding(8) var<storage, read> block_entry: array<u32>;       // 64 element + 8 a + b
@group(0) @binding(9) var<storage, read> moduli: array<real>;           // [slot][component][point], 31 components
@group(0) @binding(10) var<storage, read_write> blocks: array<real>;    // [slot][3 i + j][block]

fn load_vector(at: u32) -> vec3<real> {
    let points = point_count();
    return vec3<real>(moduli[at], moduli[at + points], moduli[at + 2u * points]);
}

fn load_sym(at: u32) -> mat3x3<real> {
    return sym_matrix(Sym(load_vector(at), load_vector(at + 3u * point_count())));
}

@compute @workgroup_size(64)
fn gather_tangent_blocks(@builtin(global_invocation_id) id: vec3<u32>) {
    if is_outside(id, dimensions.blocks) {
        return;
    }
    let block = id.x;
    let slot = id.y;
    let points = point_count();
    // columns of the block
    var x_column = vec3<real>();
    var y_column = vec3<real>();
    var z_column = vec3<real>();
    for (var e = block_start[block]; e < block_start[block + 1u]; e++) {
        let entry = block_entry[e];
        let element = entry / 64u;
        let a = (entry / 8u) % 8u;
        let b = entry % 8u;
        // derivatives of the element's volume
        var volume_a = vec3<real>();
        var volume_b = vec3<real>();
        for (var q = 0u; q < 8u; q++) {
            let point = 8u * element + q;
            let at = 31u * slot * points + point;
            let natural = mat3x3<real>(load_vector(at), load_vector(at + 3u * points), load_vector(at + 6u * points));
            let g_a = shape_derivative(a, q) * natural;
            let g_b = shape_derivative(b, q) * natural;
            let normal = load_sym(at + 15u * points);
            let x = load_sym(at + 21u * points);
            let modulus = moduli[at + 27u * points];
            let p_j = moduli[at + 28u * points];
            let v_j = moduli[at + 29u * points];
            volume_a += v_j * g_a;
            volume_b += v_j * g_b;
            let n_a = normal * g_a;
            let n_b = normal * g_b;
            let x_a = x * g_a;
            let x_b = x * g_b;
            let tau_b = load_sym(at + 9u * points) * g_b;
            let half = 0.5 * modulus - p_j;
            let third = p_j - modulus * (1.0 / 3.0);
            let diagonal = dot(g_a, tau_b) + half * dot(g_a, g_b);
            x_column += third * g_b.x * g_a + half * g_a.x * g_b + x_b.x * n_a + n_b.x * x_a + vec3<real>(diagonal, 0.0, 0.0);
            y_column += third * g_b.y * g_a + half * g_a.y * g_b + x_b.y * n_a + n_b.y * x_a + vec3<real>(0.0, diagonal, 0.0);
            z_column += third * g_b.z * g_a + half * g_a.z * g_b + x_b.z * n_a + n_b.z * x_a + vec3<real>(0.0, 0.0, diagonal);
        }
        let bulk = moduli[(31u * slot + 30u) * points + 8u * element];
        x_column += (bulk * volume_b.x) * volume_a;
        y_column += (bulk * volume_b.y) * volume_a;
        z_column += (bulk * volume_b.z) * volume_a;
    }
    let count = dimensions.blocks;
    let out = 9u * slot * count + block;
    blocks[out] = x_column.x;
    blocks[out + count] = y_column.x;
    blocks[out + 2u * count] = z_column.x;
    blocks[out + 3u * count] = x_column.y;
    blocks[out + 4u * count] = y_column.y;
    blocks[out + 5u * count] = z_column.y;
    blocks[out + 6u * count] = x_column.z;
    blocks[out + 7u * count] = y_column.z;
    blocks[out + 8u * count] = z_column.z;
}

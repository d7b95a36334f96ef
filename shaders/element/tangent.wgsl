// The blocks of the elements' tangents, d f_a/d u_b of each pair of the nodes that they name, once.
// A workgroup has eight elements: first each thread makes the moduli of a quadrature point, in the
// form in which they are applied, then it has a node b and the pairs of it with b, b + 1, b + 2,
// b + 3 and, for the first four nodes, b + 4 (modulo 8):
//   g_a . c . g_b = m/2 (g_a.g_b 1 + g_b (x) g_a) - m/3 g_a (x) g_b
//                   + (n g_a) (x) (x g_b) + (x g_a) (x) (n g_b).

@group(0) @binding(8) var<storage, read_write> element_blocks: array<real>;    // [slot][element][pair][3 i + j]

const POINTS_IN_GROUP: u32 = 64u;

// dxi/dx, the stress of the geometric term, n, x, m, J p, J, all but the first times the reference
// volume, and the modulus of the dilatation: [component][point]
var<workgroup> moduli: array<real, 1984>;

fn store(at: u32, value: real) -> u32 {
    moduli[at] = value;
    return at + POINTS_IN_GROUP;
}

fn store_vector(at: u32, v: vec3<real>) -> u32 {
    return store(store(store(at, v.x), v.y), v.z);
}

fn store_moduli(id: vec3<u32>, local: u32) {
    let at = point_place(id);
    let material = material_of(at.case_index, at.element);
    let a = evaluate_point(at, material);
    if !a.valid {
        return;
    }
    let p = pressure(material.elasticity, a.k.theta_minus_1);
    let v = point_volume(at.geometry, at.point);
    let tau = sym_scale(v, kirchhoff_stress(a, p.x));
    let c = deviatoric_tangent(a.response);
    let v_j = v * (1.0 + a.k.j_minus_1);
    var next = local;
    for (var k = 0u; k < 3u; k++) {
        next = store_vector(next, a.k.natural[k]);
    }
    next = store_vector(next, tau.diagonal);
    next = store_vector(next, tau.shear);
    next = store_vector(next, c.normal.diagonal);
    next = store_vector(next, c.normal.shear);
    next = store_vector(next, v * c.x.diagonal);
    next = store_vector(next, v * c.x.shear);
    next = store(next, v * c.modulus);
    next = store(next, p.x * v_j);
    next = store(next, v_j);
    next = store(next, p.y / a.k.total_volume);
}

fn component(at: u32, number: u32) -> real {
    return moduli[at + number * POINTS_IN_GROUP];
}

fn load_vector(at: u32, number: u32) -> vec3<real> {
    return vec3<real>(component(at, number), component(at, number + 1u), component(at, number + 2u));
}

fn load_sym(at: u32, number: u32) -> mat3x3<real> {
    return sym_matrix(Sym(load_vector(at, number), load_vector(at, number + 3u)));
}

// What a point has of a node.
struct AtNode {
    g: vec3<real>,          // gradient of its shape function
    n: vec3<real>,
    x: vec3<real>,
}

fn at_node(natural: mat3x3<real>, normal: mat3x3<real>, x: mat3x3<real>, derivative: vec3<real>) -> AtNode {
    let g = derivative * natural;
    return AtNode(g, normal * g, x * g);
}

// Columns of a block, and the derivative of the element's volume by its row's node.
struct Block {
    x: vec3<real>,
    y: vec3<real>,
    z: vec3<real>,
    volume: vec3<real>,
}

fn with_point(block: Block, at: u32, a: AtNode, b: AtNode, tau_b: vec3<real>) -> Block {
    let modulus = component(at, 27u);
    let p_j = component(at, 28u);
    let half = 0.5 * modulus - p_j;
    let third = p_j - modulus * (1.0 / 3.0);
    let diagonal = dot(a.g, tau_b) + half * dot(a.g, b.g);
    return Block(
        block.x + (third * b.g.x * a.g + half * a.g.x * b.g + b.x.x * a.n + b.n.x * a.x + vec3<real>(diagonal, 0.0, 0.0)),
        block.y + (third * b.g.y * a.g + half * a.g.y * b.g + b.x.y * a.n + b.n.y * a.x + vec3<real>(0.0, diagonal, 0.0)),
        block.z + (third * b.g.z * a.g + half * a.g.z * b.g + b.x.z * a.n + b.n.z * a.x + vec3<real>(0.0, 0.0, diagonal)),
        block.volume + component(at, 29u) * a.g,
    );
}

// Two pairs, which share what a point has of b; the second one only where it is `both`.
fn make_pairs(slot: u32, element: u32, first_point: u32, b: u32, offset: u32, both: bool) {
    let a = vec2<u32>(b + offset, b + offset + 1u) % 8u;
    let hanging = hanging_of(element);
    var first: Block;
    var second: Block;
    var volume_b = vec3<real>();
    for (var q = 0u; q < 8u; q++) {
        let at = first_point + q;
        // Before all else, while few registers are taken.
        let derivative_b = named_derivative(hanging, b, q);
        let derivative_first = named_derivative(hanging, a.x, q);
        let natural = mat3x3<real>(load_vector(at, 0u), load_vector(at, 3u), load_vector(at, 6u));
        let normal = load_sym(at, 15u);
        let x = load_sym(at, 21u);
        let of_b = at_node(natural, normal, x, derivative_b);
        let tau_b = load_sym(at, 9u) * of_b.g;
        volume_b += component(at, 29u) * of_b.g;
        let of_first = at_node(natural, normal, x, derivative_first);
        first = with_point(first, at, of_first, of_b, tau_b);
        if both {
            let of_second = at_node(natural, normal, x, named_derivative(hanging, a.y, q));
            second = with_point(second, at, of_second, of_b, tau_b);
        }
    }
    let bulk_b = component(first_point, 30u) * volume_b;
    let out = ELEMENT_BLOCKS * (slot * dimensions.elements + element);
    store_block(out + 9u * pair_place(b, offset), first, bulk_b);
    if both {
        store_block(out + 9u * pair_place(b, offset + 1u), second, bulk_b);
    }
}

fn store_block(out: u32, block: Block, bulk_b: vec3<real>) {
    let x = block.x + bulk_b.x * block.volume;
    let y = block.y + bulk_b.y * block.volume;
    let z = block.z + bulk_b.z * block.volume;
    for (var i = 0u; i < 3u; i++) {
        element_blocks[out + 3u * i] = x[i];
        element_blocks[out + 3u * i + 1u] = y[i];
        element_blocks[out + 3u * i + 2u] = z[i];
    }
}

@compute @workgroup_size(64)
fn hex8_tangent(@builtin(global_invocation_id) id: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let is_inside = !is_outside(id, point_count());
    if is_inside {
        store_moduli(id, local);
    }
    workgroupBarrier();
    if !is_inside {
        return;
    }
    let b = id.x % 8u;
    // Two pairs in double precision take too many registers.
    let step = select(1u, 2u, REAL_IS_SINGLE);
    for (var offset = 0u; offset < 5u; offset += step) {
        if offset < 4u || b < 4u {
            make_pairs(id.y, id.x / 8u, local - b, b, offset, REAL_IS_SINGLE && offset < 4u);
        }
    }
}

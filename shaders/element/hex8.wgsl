// Eight-node hexahedron with mean dilatation: the twin of crates/kernels/src/element/hex8.rs, where
// the formulation and its sources are. A thread has one quadrature point; point q of element e is 8
// e + q.

@group(0) @binding(2) var<storage, read> element_nodes: array<u32>;     // [element][corner]: see hanging.wgsl
// [geometry]: reference positions of an element's corners, relative to the first one
// [3 a + i][element], and volumes [point]
@group(0) @binding(3) var<storage, read> geometries: array<real>;
// [case]: what a step starts from; displacement [3 node + i], then b_e_bar - I (6) and alpha
// [component][point]
@group(0) @binding(4) var<storage, read> starts: array<real>;

// Where a thread works.
struct Place {
    slot: u32,
    case_index: u32,
    geometry: u32,
    element: u32,
    point: u32,
}

fn point_count() -> u32 {
    return 8u * dimensions.elements;
}

fn is_outside(id: vec3<u32>, items: u32) -> bool {
    return id.x >= items || id.y >= dimensions.in_dispatch;
}

fn point_place(id: vec3<u32>) -> Place {
    let slot = active_cases[id.y];
    return Place(id.y, slot.x, slot.y, id.x / 8u, id.x);
}

// Natural coordinates of the quadrature points, 1/sqrt 3 from the middle, and the factor (1 + xi_a
// xi)/2 of a shape function where node and point are on the same side of it.
const POINT_AT: real = 0.5773502691896258;
const SAME_SIDE: real = 0.7886751345948129;

// On which side of the middle a node is, or the quadrature point of the same number: 1 for positive
// natural coordinates.
fn sides(a: u32) -> vec3<u32> {
    return vec3<u32>((a ^ (a >> 1u)) & 1u, (a >> 1u) & 1u, a >> 2u);
}

// dN_a/dxi at quadrature point q.
fn shape_derivative(a: u32, q: u32) -> vec3<real> {
    let side = sides(a);
    let factor = vec3<real>(SAME_SIDE) - POINT_AT * vec3<real>(side ^ sides(q));
    let half = vec3<real>(side) - vec3<real>(0.5);
    return half * vec3<real>(factor.y * factor.z, factor.x * factor.z, factor.x * factor.y);
}

// Numbers of a geometry: 24 coordinates and eight volumes an element.
fn geometry_place(geometry: u32) -> u32 {
    return 32u * geometry * dimensions.elements;
}

fn point_volume(geometry: u32, point: u32) -> real {
    return geometries[geometry_place(geometry) + 24u * dimensions.elements + point];
}

// Inverse by cofactors.
fn invert(m: mat3x3<real>) -> mat3x3<real> {
    let c0 = cross(m[1], m[2]);
    let s = 1.0 / dot(m[0], c0);
    return transpose(mat3x3<real>(s * c0, s * cross(m[2], m[0]), s * cross(m[0], m[1])));
}

// det(I + h) - 1, expanded so that small h keep their digits. Matrices are columns: h[k][i] is d
// u_i/d X_k.
fn jacobian_minus_one(h: mat3x3<real>) -> real {
    let minors = (h[0].x * h[1].y - h[0].y * h[1].x) + (h[1].y * h[2].z - h[1].z * h[2].y) + (h[0].x * h[2].z - h[0].z * h[2].x);
    return (h[0].x + h[1].y + h[2].z) + minors + dot(h[0], cross(h[1], h[2]));
}

fn identity_plus(h: mat3x3<real>) -> mat3x3<real> {
    return mat3x3<real>(
        h[0] + vec3<real>(1.0, 0.0, 0.0),
        h[1] + vec3<real>(0.0, 1.0, 0.0),
        h[2] + vec3<real>(0.0, 0.0, 1.0),
    );
}

// Gradients with respect to the reference position: of the committed displacement, of the increment
// and of the natural coordinates.
struct DisplacementGradients {
    committed: mat3x3<real>,
    increment: mat3x3<real>,
    natural: mat3x3<real>,
}

fn displacement_gradients(at: Place) -> DisplacementGradients {
    let stride = dimensions.elements;
    let hanging = hanging_of(at.element);
    var position: mat3x3<real>;
    var of_committed: mat3x3<real>;
    var of_increment: mat3x3<real>;
    for (var a = 0u; a < 8u; a++) {
        let node = node_at(at.element, a);
        let of_case = at.case_index * dimensions.start_numbers + 3u * node;
        let of_slot = at.slot * dimensions.trial_numbers + 3u * node;
        let u = vec3<real>(starts[of_case], starts[of_case + 1u], starts[of_case + 2u]);
        let d = vec3<real>(trials[of_slot], trials[of_slot + 1u], trials[of_slot + 2u]);
        let of_element = geometry_place(at.geometry) + 3u * a * stride + at.element;
        let x = vec3<real>(geometries[of_element], geometries[of_element + stride], geometries[of_element + 2u * stride]);
        var n = shape_derivative(a, at.point % 8u);
        position[0] += n.x * x;
        position[1] += n.y * x;
        position[2] += n.z * x;
        if hanging != 0u {
            n = named_derivative(hanging, a, at.point % 8u);
        }
        of_committed[0] += n.x * u;
        of_committed[1] += n.y * u;
        of_committed[2] += n.z * u;
        of_increment[0] += n.x * d;
        of_increment[1] += n.y * d;
        of_increment[2] += n.z * d;
    }
    let natural = invert(position);
    return DisplacementGradients(of_committed * natural, of_increment * natural, natural);
}

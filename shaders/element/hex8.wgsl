// Eight-node hexahedron with mean dilatation: the twin of crates/kernels/src/element/hex8.rs, where
// the formulation and its sources are. A thread has one quadrature point; point q of element e is 8
// e + q.

@group(0) @binding(2) var<storage, read> element_nodes: array<u32>;     // [element][local node]
@group(0) @binding(3) var<storage, read> gradient: array<real>;         // [geometry][3 a + j][point]: dN_a/dX_j
@group(0) @binding(4) var<storage, read> volume: array<real>;           // [geometry][point]
@group(0) @binding(5) var<storage, read> committed: array<real>;        // [case][3 node + i]: displacement
@group(0) @binding(6) var<storage, read> increment: array<real>;        // [slot][3 node + i]

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

// dN_a/dX at a point of a geometry.
fn reference_gradient(geometry: u32, a: u32, point: u32) -> vec3<real> {
    let points = point_count();
    let at = (24u * geometry + 3u * a) * points + point;
    return vec3<real>(gradient[at], gradient[at + points], gradient[at + 2u * points]);
}

fn point_volume(geometry: u32, point: u32) -> real {
    return volume[geometry * point_count() + point];
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

// Gradients with respect to the reference position: of the committed displacement and of the
// increment.
struct DisplacementGradients {
    committed: mat3x3<real>,
    increment: mat3x3<real>,
}

fn displacement_gradients(at: Place) -> DisplacementGradients {
    var g: DisplacementGradients;
    for (var a = 0u; a < 8u; a++) {
        let node = element_nodes[8u * at.element + a];
        let of_case = 3u * (at.case_index * dimensions.nodes + node);
        let of_slot = 3u * (at.slot * dimensions.nodes + node);
        let u = vec3<real>(committed[of_case], committed[of_case + 1u], committed[of_case + 2u]);
        let d = vec3<real>(increment[of_slot], increment[of_slot + 1u], increment[of_slot + 2u]);
        let n = reference_gradient(at.geometry, a, at.point);
        g.committed[0] += n.x * u;
        g.committed[1] += n.y * u;
        g.committed[2] += n.z * u;
        g.increment[0] += n.x * d;
        g.increment[1] += n.y * d;
        g.increment[2] += n.z * d;
    }
    return g;
}

// The residual of an iterate at a node: internal forces, the contact's conditions where it can
// touch, and what is missing of prescribed displacements.

@group(0) @binding(5) var<storage, read> committed: array<real>;    // [case][3 node + i]: displacement
@group(0) @binding(6) var<storage, read> node_info: array<u32>;     // [node]
@group(0) @binding(7) var<storage, read> weight: array<real>;       // [geometry][point]: c of Alart and Curnier
@group(0) @binding(8) var<storage, read> increments: array<real>;   // [case][iterate][3 node + i]
@group(0) @binding(9) var<storage, read> forces: array<real>;       // [case][iterate][3 node + i]
// [case][iterate][residual, force rows, displacement rows][point]
@group(0) @binding(10) var<storage, read> rows: array<real>;
// [case][iterate][point]: status + 4, 8, 16 for fixed x, y, z
@group(0) @binding(11) var<storage, read> codes: array<u32>;

struct NodeResidual {
    residual: vec3<real>,
    rhs: vec3<real>,        // of the linear system: at fixed unknowns their values
    prescribed: u32,        // a bit a component
    fixed: u32,             // the same, with those that contact prescribes
}

// Of an iterate whose plate is at depth h.
fn node_residual(slot: u32, iterate: u32, node: u32, h: real) -> NodeResidual {
    let case_index = active_cases[slot].x;
    let points = dimensions.contact_points;
    let info = node_info[node];
    let at = iterate_place_of(case_index, iterate, 3u * dimensions.nodes) + 3u * node;
    var out: NodeResidual;
    out.prescribed = info & IS_PRESCRIBED;
    out.fixed = out.prescribed;
    out.residual = vec3<real>(forces[at], forces[at + 1u], forces[at + 2u]);
    out.rhs = -out.residual;
    if info >= FIRST_POINT {
        let point = info / FIRST_POINT - 1u;
        let first = iterate_place_of(case_index, iterate, ROWS * points) + point;
        out.residual = vec3<real>(rows[first], rows[first + points], rows[first + 2u * points]);
        out.rhs = -out.residual;
        let by_contact = codes[iterate_place_of(case_index, iterate, points) + point] / 4u;
        out.fixed |= by_contact;
        // Residuals of what contact prescribes are stated as forces c g; as displacements they are
        // g.
        for (var i = 0u; i < 3u; i++) {
            if ((by_contact >> i) & 1u) != 0u {
                out.rhs[i] /= weight[active_cases[slot].y * points + point];
            }
        }
    }
    if out.prescribed != 0u {
        var wanted = vec3<real>();
        if (info & IS_PLATE) != 0u {
            wanted = vec3<real>(number(slot, SHEAR), 0.0, -h);
        }
        let of_case = case_index * 3u * dimensions.nodes + 3u * node;
        for (var i = 0u; i < 3u; i++) {
            if ((out.prescribed >> i) & 1u) != 0u {
                out.residual[i] = committed[of_case + i] + increments[at + i] - wanted[i];
                out.rhs[i] = -out.residual[i];
            }
        }
    }
    return out;
}

// The power of two by which numbers as large as this come near to 1: systems are solved in single
// precision, whose squares must not leave its range.
fn scale_exponent(largest: real) -> i32 {
    if !(largest > 0.0) || !is_finite(largest) {
        return 0i;
    }
    return -exponent(largest);
}

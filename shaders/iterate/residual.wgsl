// The residual of an iterate at a node: internal forces, the contact's conditions where it can
// touch, and what is missing of prescribed displacements.

@group(0) @binding(5) var<storage, read> starts: array<real>;       // [case]: displacement [3 node + i], states
@group(0) @binding(6) var<storage, read> node_info: array<u32>;     // [node]
@group(0) @binding(7) var<storage, read> iterates: array<real>;     // [case][iterate][increment, force][3 node + i]

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
    let force = force_place(case_index, iterate, node);
    var out: NodeResidual;
    out.prescribed = info & IS_PRESCRIBED;
    out.fixed = out.prescribed;
    out.residual = vec3<real>(iterates[force], iterates[force + 1u], iterates[force + 2u]);
    out.rhs = -out.residual;
    if info >= FIRST_POINT {
        let point = info / FIRST_POINT - 1u;
        let first = conditions_place(case_index, iterate, point);
        out.residual = vec3<real>(rows[first], rows[first + points], rows[first + 2u * points]);
        out.rhs = -out.residual;
        let by_contact = code_of(case_index, iterate, point) / 4u;
        out.fixed |= by_contact;
        // Residuals of what contact prescribes are stated as forces c g; as displacements they are
        // g.
        for (var i = 0u; i < 3u; i++) {
            if ((by_contact >> i) & 1u) != 0u {
                out.rhs[i] /= rows[first + WEIGHT * points];
            }
        }
    }
    if out.prescribed != 0u {
        var wanted = vec3<real>();
        if (info & IS_PLATE) != 0u {
            wanted = vec3<real>(number(slot, SHEAR), 0.0, -h);
        }
        let of_start = case_index * dimensions.start_numbers + 3u * node;
        let at = increment_place(case_index, iterate, node);
        for (var i = 0u; i < 3u; i++) {
            if ((out.prescribed >> i) & 1u) != 0u {
                out.residual[i] = starts[of_start + i] + iterates[at + i] - wanted[i];
                out.rhs[i] = -out.residual[i];
            }
        }
    }
    return out;
}

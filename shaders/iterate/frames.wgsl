// The frames of an iterate's contact points.

fn frame_of(case_index: u32, iterate: u32, point: u32) -> Frame {
    let first = conditions_place(case_index, iterate, point) + FRAME * dimensions.contact_points;
    return Frame(axis_at(first, 0u), axis_at(first, 3u), axis_at(first, 6u));
}

fn axis_at(first: u32, component: u32) -> vec3<real> {
    let points = dimensions.contact_points;
    let at = first + component * points;
    return vec3<real>(rows[at], rows[at + points], rows[at + 2u * points]);
}

// What the opponent exerts on a point in contact at which the internal force is f: along its surface
// what Coulomb's bound allows, that is f less the residual of the rows, normal to it f. The symmetry
// plane's force is not the contact's.
fn contact_force(axes: Frame, f: vec3<real>, residual: vec2<real>, on_symmetry_plane: bool) -> vec3<real> {
    let in_frame = to_frame(axes, f);
    var across = in_frame.y - residual.y;
    if on_symmetry_plane {
        across = 0.0;
    }
    return from_frame(axes, vec3<real>(in_frame.x - residual.x, across, max(in_frame.z, real(0.0))));
}

// What displacements of a node are in the unknowns of the linear system.
fn contracted(case_index: u32, iterate: u32, info: u32, v: vec3<real>) -> vec3<real> {
    if info < FIRST_POINT {
        return v;
    }
    return to_frame(frame_of(case_index, iterate, info / FIRST_POINT - 1u), v);
}

// What these unknowns are as displacements.
fn expanded(case_index: u32, iterate: u32, info: u32, v: vec3<real>) -> vec3<real> {
    if info < FIRST_POINT {
        return v;
    }
    return from_frame(frame_of(case_index, iterate, info / FIRST_POINT - 1u), v);
}

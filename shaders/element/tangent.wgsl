// What the tangent needs of every quadrature point, ready to be gathered into block rows: the
// moduli in the form in which they are applied, the stress of the geometric term, all times the
// reference volume, and dxi/dx.

@group(0) @binding(12) var<storage, read_write> moduli: array<real>;    // [slot][component][point], 31 components

fn store(at: u32, value: real) -> u32 {
    moduli[at] = value;
    return at + point_count();
}

fn store_vector(at: u32, v: vec3<real>) -> u32 {
    return store(store(store(at, v.x), v.y), v.z);
}

@compute @workgroup_size(64)
fn hex8_moduli(@builtin(global_invocation_id) id: vec3<u32>) {
    if is_outside(id, point_count()) {
        return;
    }
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
    var next = 31u * at.slot * point_count() + at.point;
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

// The stress of every quadrature point, ready to be gathered into nodal forces: V tau (dxi/dx)^T, so
// that the force on node a is its product with dN_a/dxi, summed over the points around the node.

@group(0) @binding(8) var<storage, read_write> stress: array<real>;    // [slot][3 k + i][point]: component (i, k)

@compute @workgroup_size(64)
fn hex8_internal_force(@builtin(global_invocation_id) id: vec3<u32>) {
    if is_outside(id, point_count()) {
        return;
    }
    let at = point_place(id);
    let material = material_of(at.case_index, at.element);
    let a = evaluate_point(at, material);
    if !a.valid {
        return;
    }
    let p = pressure(material.elasticity, a.k.theta_minus_1).x;
    let tau = sym_scale(point_volume(at.geometry, at.point), kirchhoff_stress(a, p));
    let natural = sym_matrix(tau) * transpose(a.k.natural);
    let points = point_count();
    let first = STRESS * at.slot * points + at.point;
    for (var k = 0u; k < 3u; k++) {
        let column = first + 3u * k * points;
        stress[column] = natural[k].x;
        stress[column + points] = natural[k].y;
        stress[column + 2u * points] = natural[k].z;
    }
}

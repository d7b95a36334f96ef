// The state of every quadrature point at the end of a step, with its elastic energy and its plastic work in the step.

@group(0) @binding(12) var<storage, read_write> next_state: array<real>;    // [slot][component][point], as state
@group(0) @binding(13) var<storage, read_write> point_work: array<real>;    // [slot][elastic energy, plastic work][point]

@compute @workgroup_size(64)
fn hex8_update(@builtin(global_invocation_id) id: vec3<u32>) {
    if is_outside(id, point_count()) {
        return;
    }
    let at = point_place(id);
    let material = load_material(at.case_index, dimensions.cases);
    let a = evaluate_point(at, material);
    if !a.valid {
        return;
    }
    let points = point_count();
    let s = a.response.state;
    let first = 7u * at.slot * points + at.point;
    next_state[first] = s.be.diagonal.x;
    next_state[first + points] = s.be.diagonal.y;
    next_state[first + 2u * points] = s.be.diagonal.z;
    next_state[first + 3u * points] = s.be.shear.x;
    next_state[first + 4u * points] = s.be.shear.y;
    next_state[first + 5u * points] = s.be.shear.z;
    next_state[first + 6u * points] = s.alpha;
    let v = point_volume(at.geometry, at.point);
    let w = 2u * at.slot * points + at.point;
    point_work[w] = v * elastic_energy_deviatoric(material.elasticity, s.be);
    point_work[w + points] = v * a.response.plastic_work;
}

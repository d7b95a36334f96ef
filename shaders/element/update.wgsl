// The state of every quadrature point at the end of a step and what flowed, with its elastic energy
// and its plastic work in the step.

@group(0) @binding(8) var<storage, read> history: array<real>;          // [case][component][point]: committed state, last flow
// [slot][component][point]: as history, then elastic energy and plastic work
@group(0) @binding(9) var<storage, read_write> next_history: array<real>;

@compute @workgroup_size(64)
fn hex8_update(@builtin(global_invocation_id) id: vec3<u32>) {
    if is_outside(id, point_count()) {
        return;
    }
    let at = point_place(id);
    let material = material_of(at.case_index, at.element);
    let a = evaluate_point(at, material);
    if !a.valid {
        return;
    }
    let points = point_count();
    let h = HISTORY * at.case_index * points + at.point;
    let committed = PointState(
        Sym(
            vec3<real>(history[h], history[h + points], history[h + 2u * points]),
            vec3<real>(history[h + 3u * points], history[h + 4u * points], history[h + 5u * points]),
        ),
        history[h + 6u * points],
    );
    let done = complete(material, a.k.relative, committed, load_state(at.case_index, at.point), a.response);
    if done.response.status >= STATUS_INVERTED {
        refuse(at, REFUSED_BY_MATERIAL, done.response.status == STATUS_NOT_FINITE);
        return;
    }
    let s = done.response.state;
    let first = NEXT_HISTORY * at.slot * points + at.point;
    next_history[first] = s.be.diagonal.x;
    next_history[first + points] = s.be.diagonal.y;
    next_history[first + 2u * points] = s.be.diagonal.z;
    next_history[first + 3u * points] = s.be.shear.x;
    next_history[first + 4u * points] = s.be.shear.y;
    next_history[first + 5u * points] = s.be.shear.z;
    next_history[first + 6u * points] = s.alpha;
    next_history[first + 7u * points] = done.flow.strain.diagonal.x;
    next_history[first + 8u * points] = done.flow.strain.diagonal.y;
    next_history[first + 9u * points] = done.flow.strain.diagonal.z;
    next_history[first + 10u * points] = done.flow.strain.shear.x;
    next_history[first + 11u * points] = done.flow.strain.shear.y;
    next_history[first + 12u * points] = done.flow.strain.shear.z;
    next_history[first + 13u * points] = done.flow.alpha;
    let v = point_volume(at.geometry, at.point);
    next_history[first + HISTORY * points] = v * elastic_energy_deviatoric(material.elasticity, s.be);
    next_history[first + (HISTORY + 1u) * points] = v * done.response.plastic_work;
}

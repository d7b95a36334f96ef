// Elastic energy, plastic work since the start and largest equivalent plastic strain of every
// element at the end of a step: a thread an element, its points in order.

@group(0) @binding(8) var<storage, read> next_history: array<real>;     // [slot][component][point], as hex8_update wrote it
@group(0) @binding(9) var<storage, read> work_at_start: array<real>;    // [case][element], at the start of the step
@group(0) @binding(10) var<storage, read_write> energies: array<real>;  // [slot][elastic, plastic, largest alpha][element]

@compute @workgroup_size(64)
fn hex8_energies(@builtin(global_invocation_id) id: vec3<u32>) {
    let elements = dimensions.elements;
    if is_outside(id, elements) {
        return;
    }
    let slot = id.y;
    let element = id.x;
    let case_index = active_cases[slot].x;
    let geometry = active_cases[slot].y;
    let points = point_count();
    var elastic: real = 0.0;
    var plastic: real = 0.0;
    var alpha: real = 0.0;
    var change: real = 0.0;
    var total: real = 0.0;
    for (var q = 0u; q < 8u; q++) {
        let point = 8u * element + q;
        let v = point_volume(geometry, point);
        change += v * jacobian_of(slot, point);
        total += v;
        let end = NEXT_HISTORY * slot * points + point;
        elastic += next_history[end + HISTORY * points];
        plastic += next_history[end + (HISTORY + 1u) * points];
        alpha = max(alpha, next_history[end + 6u * points]);
    }
    let material = material_of(case_index, element);
    let first = 3u * slot * elements + element;
    energies[first] = elastic + total * elastic_energy_volumetric(material.elasticity, change / total);
    energies[first + elements] = work_at_start[case_index * elements + element] + plastic;
    energies[first + 2u * elements] = alpha;
}

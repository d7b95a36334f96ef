// det F - 1 at every quadrature point: the mean dilatation of an element needs those of all eight.

@group(0) @binding(5) var<storage, read_write> trials: array<real>;     // [slot]: increment [3 node + i], det F - 1 [point]

@compute @workgroup_size(64)
fn hex8_jacobian(@builtin(global_invocation_id) id: vec3<u32>) {
    if is_outside(id, point_count()) {
        return;
    }
    let at = point_place(id);
    let g = displacement_gradients(at);
    let h = mat3x3<real>(
        g.committed[0] + g.increment[0],
        g.committed[1] + g.increment[1],
        g.committed[2] + g.increment[2],
    );
    trials[at.slot * dimensions.trial_numbers + 3u * dimensions.nodes + at.point] = jacobian_minus_one(h);
}

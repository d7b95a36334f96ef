// The state from which every quadrature point starts a step.

@group(0) @binding(2) var<storage, read> history: array<real>;          // [case][component][point]: committed state, last flow
@group(0) @binding(3) var<storage, read> anticipated: array<real>;      // [case]: weight of the last flow
@group(0) @binding(4) var<storage, read_write> starts: array<real>;     // [case]: displacement, states [component][point]

@compute @workgroup_size(64)
fn hex8_begin_step(@builtin(global_invocation_id) id: vec3<u32>) {
    let points = 8u * dimensions.elements;
    if id.x >= points || id.y >= dimensions.in_dispatch {
        return;
    }
    let case_index = active_cases[id.y].x;
    let h = HISTORY * case_index * points + id.x;
    let committed = PointState(
        Sym(
            vec3<real>(history[h], history[h + points], history[h + 2u * points]),
            vec3<real>(history[h + 3u * points], history[h + 4u * points], history[h + 5u * points]),
        ),
        history[h + 6u * points],
    );
    let flow = Flow(
        Sym(
            vec3<real>(history[h + 7u * points], history[h + 8u * points], history[h + 9u * points]),
            vec3<real>(history[h + 10u * points], history[h + 11u * points], history[h + 12u * points]),
        ),
        history[h + 13u * points],
    );
    let begun = anticipate(committed, flow, anticipated[case_index]);
    let s = case_index * dimensions.start_numbers + 3u * dimensions.nodes + id.x;
    starts[s] = begun.be.diagonal.x;
    starts[s + points] = begun.be.diagonal.y;
    starts[s + 2u * points] = begun.be.diagonal.z;
    starts[s + 3u * points] = begun.be.shear.x;
    starts[s + 4u * points] = begun.be.shear.y;
    starts[s + 5u * points] = begun.be.shear.z;
    starts[s + 6u * points] = begun.alpha;
}

// A copy in single precision, of numbers by case or by slot: the tangent is computed of it, which
// needs no more; a thread a number.

// Numbers that are copied of a case or slot, 1 if by slot, all that it has.
@group(0) @binding(2) var<uniform> shape: vec4<u32>;
@group(0) @binding(3) var<storage, read> wide: array<real>;
@group(0) @binding(4) var<storage, read_write> copy: array<u32>;    // bits of single precision

@compute @workgroup_size(64)
fn narrow(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= shape.x || id.y >= dimensions.in_dispatch {
        return;
    }
    var first = id.y;
    if shape.y == 0u {
        first = active_cases[id.y].x;
    }
    let at = first * shape.z + id.x;
    copy[at] = single_bits(wide[at]);
}

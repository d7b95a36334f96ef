// The combination of the preconditioned vectors that leaves the least residual; a thread a slot.

@group(0) @binding(1) var<storage, read> records: array<Record>;
@group(0) @binding(2) var<storage, read_write> small: array<real>;      // see krylov.wgsl

@compute @workgroup_size(64)
fn krylov_least_squares(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x > 0u {
        return;
    }
    let slot = id.y;
    let steps = records[slot].steps;
    let combination = combination_place(slot);
    for (var k = 0u; k < steps; k++) {
        let i = steps - 1u - k;
        var y = small[target_place(slot) + i];
        for (var j = i + 1u; j < steps; j++) {
            y -= small[triangle_place(slot) + j * (j + 1u) / 2u + i] * small[combination + j];
        }
        small[combination + i] = y / small[triangle_place(slot) + i * (i + 1u) / 2u + i];
    }
}

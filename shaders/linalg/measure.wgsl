// The norm of the right-hand side, what is fixed taken over, by which tolerances are measured; a
// thread a slot.

@group(0) @binding(1) var<storage, read_write> records: array<Record>;
@group(0) @binding(2) var<storage, read> partial_sums: array<real>;     // [slot][vector][chunk]

@compute @workgroup_size(64)
fn krylov_measure(@builtin(global_invocation_id) id: vec3<u32>) {
    let slot = id.y;
    if id.x > 0u || records[slot].done != RUNNING {
        return;
    }
    var square: real = 0.0;
    for (var c = 0u; c < chunks(); c++) {
        square += partial_sums[partial_place(slot, 0u) + c];
    }
    records[slot].rhs_norm = sqrt(square);
}

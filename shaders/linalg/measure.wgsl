// The norm of the right-hand side, what is fixed taken over, by which tolerances are measured; a
// thread a slot.

@group(0) @binding(1) var<storage, read_write> records: array<Record>;

@compute @workgroup_size(64)
fn krylov_measure(@builtin(global_invocation_id) id: vec3<u32>) {
    let slot = id.y;
    if id.x > 0u || records[slot].done != RUNNING {
        return;
    }
    records[slot].rhs_norm = norm_of_sums(slot);
}

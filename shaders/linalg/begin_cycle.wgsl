// Begins a cycle of FGMRES from the residual in w, whose square the partial sums hold; a thread a
// slot.

@group(0) @binding(1) var<storage, read_write> records: array<Record>;
@group(0) @binding(3) var<storage, read_write> small: array<real>;      // see krylov.wgsl

// A cycle in f32 takes its residual down to this share of the first one and no further: a lower
// tolerance ends there.
const REACH: real = 1.2e-5;

@compute @workgroup_size(64)
fn krylov_begin(@builtin(global_invocation_id) id: vec3<u32>) {
    let slot = id.y;
    if id.x > 0u || records[slot].done != RUNNING {
        return;
    }
    let norm = norm_of_sums(slot);
    if records[slot].iterations == 0u {
        records[slot].start_norm = norm;
    }
    var measure = records[slot].rhs_norm;
    if records[slot].relative_to_start != 0u {
        measure = records[slot].start_norm;
    }
    // A little lower than asked: what the recurrence says is not quite what is left.
    records[slot].goal = max(0.98 * records[slot].tolerance * measure, REACH * norm);
    records[slot].residual = norm;
    records[slot].steps = 0u;
    records[slot].vectors = 1u;
    if !is_finite(norm) {
        records[slot].done = NOT_FINITE;
    } else if norm <= records[slot].tolerance * measure || norm == 0.0 {
        records[slot].done = CONVERGED;
    } else {
        records[slot].scale = 1.0 / norm;
    }
    for (var i = 0u; i <= level.restart; i++) {
        small[small_place(slot) + i] = 0.0;
    }
    small[target_place(slot)] = norm;
}

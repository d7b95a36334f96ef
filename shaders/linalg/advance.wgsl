// Closes a step of FGMRES: the new column of the Hessenberg matrix goes into the least-squares
// problem by Givens rotations, whose right-hand side says what is left of the residual (Saad,
// SIAM J. Sci. Comput. 14, 1993); a thread a slot.

@group(0) @binding(1) var<storage, read_write> records: array<Record>;
@group(0) @binding(2) var<storage, read> squares: array<real>;          // [slot][chunk]
@group(0) @binding(3) var<storage, read_write> small: array<real>;      // see krylov.wgsl

@compute @workgroup_size(64)
fn krylov_advance(@builtin(global_invocation_id) id: vec3<u32>) {
    let slot = records[id.y].running;
    if id.x > 0u || records[slot].done != RUNNING {
        return;
    }
    var left: real = 0.0;
    for (var c = 0u; c < chunks(); c++) {
        left += squares[slot * chunks() + c];
    }
    let j = records[slot].steps;
    let column_at = small_place(slot);
    var whole = left;
    for (var i = 0u; i <= j; i++) {
        whole += small[column_at + i] * small[column_at + i];
    }
    let next = sqrt(left);
    if !is_finite(whole) {
        records[slot].done = NOT_FINITE;
        return;
    }
    let is_independent = next > 10.0 * REAL_EPSILON * sqrt(whole);
    small[column_at + j + 1u] = next;
    if !is_independent {
        small[column_at + j + 1u] = 0.0;
    }
    let rotations = rotation_place(slot);
    for (var i = 0u; i < j; i++) {
        let c = small[rotations + 2u * i];
        let s = small[rotations + 2u * i + 1u];
        let upper = small[column_at + i];
        let lower = small[column_at + i + 1u];
        small[column_at + i] = c * upper + s * lower;
        small[column_at + i + 1u] = c * lower - s * upper;
    }
    let upper = small[column_at + j];
    let lower = small[column_at + j + 1u];
    let length = sqrt(upper * upper + lower * lower);
    if !(length > 0.0) {
        // A z = 0 to rounding: this direction is of no use.
        records[slot].done = STALLED;
        return;
    }
    small[rotations + 2u * j] = upper / length;
    small[rotations + 2u * j + 1u] = lower / length;
    let triangle = triangle_place(slot) + j * (j + 1u) / 2u;
    for (var i = 0u; i < j; i++) {
        small[triangle + i] = small[column_at + i];
    }
    small[triangle + j] = length;
    for (var i = 0u; i <= j + 1u; i++) {
        small[column_at + i] = 0.0;
    }
    let rhs = target_place(slot) + j;
    small[rhs + 1u] = -(lower / length) * small[rhs];
    small[rhs] = upper / length * small[rhs];
    let residual = abs(small[rhs + 1u]);
    records[slot].residual = residual;
    records[slot].steps = j + 1u;
    records[slot].iterations += 1u;
    records[slot].scale = 1.0 / next;
    // Without a new direction the recurrence says 0, whatever is left: the host has to decide.
    if !is_independent {
        records[slot].done = STALLED;
    } else if residual <= records[slot].goal {
        records[slot].done = CONVERGED;
    } else if j + 1u == level.restart {
        records[slot].done = FULL;
    } else {
        records[slot].vectors = j + 2u;
    }
}

// The rigid plane z = 0: the twin of crates/kernels/src/contact/plane.rs. Both are taken from the
// start of the step, where the host has formed them in double precision: at a touching point the
// gap there is next to nothing, and the sum keeps its digits.

// Gap: height over the plane.
fn gap(gap_at_start: real, increment_z: real) -> real {
    return gap_at_start + increment_z;
}

// Slip: tangential displacement since the start of the step.
fn slip(increment: vec3<real>) -> vec2<real> {
    return increment.xy;
}

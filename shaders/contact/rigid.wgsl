// A rigid sphere, or the plane, which is one of no curvature: the twin of
// crates/kernels/src/contact/rigid.rs. All is taken from where a contact point was before it moved
// by d, at the start of the step, say, where the host has formed gap and position in double
// precision: at a touching point the gap there is next to nothing, and the sum keeps its digits.

// A contact point before it moves.
struct Facing {
    gap: real,
    position: vec3<real>,
    curvature: real,        // of the opponent
}

// Distance from the surface, g: of s = kappa (2 z + kappa |x|^2) the change is formed, and
// (1 + kappa g)^2 = 1 + s.
fn rigid_gap(at: Facing, d: vec3<real>) -> real {
    let k = at.curvature;
    let change = 2.0 * (d.z + k * dot(at.position, d)) + k * dot(d, d);
    let before = 1.0 + k * at.gap;
    return at.gap + change / (before + sqrt(max(before * before + k * change, real(0.0))));
}

// The frame there: t1 along x as far as it can be, t2 along y exactly on the symmetry plane.
fn rigid_frame(at: Facing, d: vec3<real>) -> Frame {
    let x = at.position + d;
    let k = at.curvature;
    var found = frame(vec3<real>(k * x.x, k * x.y, 1.0 + k * x.z));
    if x.y == 0.0 {
        found.t2 = vec3<real>(0.0, 1.0, 0.0);
    }
    return found;
}

// What brings a point that has passed the surface back onto it, along its normal.
fn rigid_push_out(at: Facing, d: vec3<real>) -> vec3<real> {
    return -min(rigid_gap(at, d), real(0.0)) * rigid_frame(at, d).n;
}

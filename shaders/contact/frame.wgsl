// Frames of a surface, two tangents and a normal: the twin of crates/kernels/src/contact/frame.rs.

struct Frame {
    t1: vec3<real>,
    t2: vec3<real>,
    n: vec3<real>,          // into the body
}

// A vector of length one; upward where there is no direction.
fn unit(v: vec3<real>) -> vec3<real> {
    let length = sqrt(dot(v, v));
    if length > 0.0 {
        return vec3<real>(v.x / length, v.y / length, v.z / length);
    }
    return vec3<real>(0.0, 0.0, 1.0);
}

// The frame of a normal: the first tangent along x as far as it can be.
fn frame(normal: vec3<real>) -> Frame {
    let n = unit(normal);
    let t1 = unit(vec3<real>(1.0 - n.x * n.x, -n.x * n.y, -n.x * n.z));
    return Frame(t1, cross(n, t1), n);
}

// Components of a vector in a frame.
fn to_frame(axes: Frame, v: vec3<real>) -> vec3<real> {
    return vec3<real>(dot(axes.t1, v), dot(axes.t2, v), dot(axes.n, v));
}

// The vector that has these components in a frame.
fn from_frame(axes: Frame, v: vec3<real>) -> vec3<real> {
    return axes.t1 * v.x + axes.t2 * v.y + axes.n * v.z;
}

//! Frames of a surface: two tangents and a normal.

/// Two unit tangents and the unit normal, which points into the body.
pub type ContactFrame = [[f64; 3]; 3];

/// The frame of the axes.
pub const AXES: ContactFrame = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// A vector of length one; upward where there is no direction.
pub fn unit(v: [f64; 3]) -> [f64; 3] {
    let length = v.iter().map(|v| v * v).sum::<f64>().sqrt();
    if length > 0.0 { v.map(|v| v / length) } else { [0.0, 0.0, 1.0] }
}

/// The frame of a normal: the first tangent along x as far as it can be.
pub fn frame(normal: [f64; 3]) -> ContactFrame {
    let n = unit(normal);
    let t1 = unit(std::array::from_fn(|i| if i == 0 { 1.0 } else { 0.0 } - n[0] * n[i]));
    let t2 = [n[1] * t1[2] - n[2] * t1[1], n[2] * t1[0] - n[0] * t1[2], n[0] * t1[1] - n[1] * t1[0]];
    [t1, t2, n]
}

/// Components of a vector in a frame.
pub fn to_frame(frame: &ContactFrame, v: &[f64; 3]) -> [f64; 3] {
    frame.map(|axis| axis[0] * v[0] + axis[1] * v[1] + axis[2] * v[2])
}

/// The vector that has these components in a frame.
pub fn from_frame(frame: &ContactFrame, v: &[f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| frame[0][i] * v[0] + frame[1][i] * v[1] + frame[2][i] * v[2])
}

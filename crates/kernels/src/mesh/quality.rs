//! Element quality: Jacobians and volume.

use super::Mesh;

/// Natural coordinates of the corners of a VTK_HEXAHEDRON, in its order.
pub const CORNERS: [[f64; 3]; 8] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
];

/// Columns dX/dxi, dX/deta, dX/dzeta of an element's map at the natural coordinates `at`.
fn tangents(corners: &[[f64; 3]; 8], at: [f64; 3]) -> [[f64; 3]; 3] {
    let mut columns = [[0.0; 3]; 3];
    for (x, c) in corners.iter().zip(CORNERS) {
        let f = [0, 1, 2].map(|k| 1.0 + c[k] * at[k]);
        let gradient = [c[0] * f[1] * f[2] / 8.0, c[1] * f[0] * f[2] / 8.0, c[2] * f[0] * f[1] / 8.0];
        for (column, g) in columns.iter_mut().zip(gradient) {
            for (entry, x) in column.iter_mut().zip(x) {
                *entry += g * x;
            }
        }
    }
    columns
}

fn determinant(c: [[f64; 3]; 3]) -> f64 {
    c[0][0] * (c[1][1] * c[2][2] - c[1][2] * c[2][1]) - c[0][1] * (c[1][0] * c[2][2] - c[1][2] * c[2][0])
        + c[0][2] * (c[1][0] * c[2][1] - c[1][1] * c[2][0])
}

/// Jacobian determinant of an element's map at the natural coordinates `at`; its integral over [-1,
/// 1]^3 is the volume.
pub fn jacobian(corners: &[[f64; 3]; 8], at: [f64; 3]) -> f64 {
    determinant(tangents(corners, at))
}

/// Smallest Jacobian over the eight corners and the eight Gauss points.
pub fn smallest_jacobian(corners: &[[f64; 3]; 8]) -> f64 {
    let g = 1.0 / 3f64.sqrt();
    CORNERS.iter().flat_map(|c| [jacobian(corners, *c), jacobian(corners, c.map(|x| g * x))]).fold(f64::INFINITY, f64::min)
}

/// Smallest corner Jacobian with unit edges, 1 for a brick, 0 for a flat corner (Knupp 2000, the
/// scaled Jacobian of a hexahedron).
pub fn scaled_jacobian(corners: &[[f64; 3]; 8]) -> f64 {
    CORNERS
        .iter()
        .map(|c| {
            let t = tangents(corners, *c);
            let lengths: f64 = t.iter().map(|v| (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt()).product();
            determinant(t) / lengths
        })
        .fold(f64::INFINITY, f64::min)
}

/// Volume of the mesh, exact for trilinear elements (2 x 2 x 2 Gauss points).
pub fn volume(mesh: &Mesh) -> f64 {
    let g = 1.0 / 3f64.sqrt();
    (0..mesh.elements.len())
        .map(|e| {
            let x = mesh.corners(e);
            CORNERS.iter().map(|c| jacobian(&x, c.map(|v| g * v))).sum::<f64>()
        })
        .sum()
}

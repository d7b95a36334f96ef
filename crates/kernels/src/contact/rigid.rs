//! A rigid opponent of any curvature: a sphere of radius 1/kappa below the body, its pole at the
//! origin; for kappa = 0 the plane z = 0, with the plane's bits.
//!
//! It has no mesh, so nothing of it need be held within a step: gap and frame are those of the
//! point where it is, in every iteration. The gap is the distance from the sphere, along its normal
//! n,
//!
//!   s = 2 kappa z + kappa^2 |x|^2,   g = (2 z + kappa |x|^2)/(1 + sqrt(1 + s)),   n = (kappa x, kappa y, 1 + kappa z)/sqrt(1 + s),
//!
//! which for small kappa loses no digits to the far centre. The rows of [`super::coulomb`] are
//! stated in the frame (t1, t2, n): with f the internal force there, g that gap, and the slip t .
//! (x - x_n) since the start of the step. Their linearisation takes the frame as fixed. What that
//! leaves out is the turning of the force with the normal, kappa f_n beside a stiffness of the
//! element E h_c: p/E times kappa h_c, 1e-4 and less, and without a trace in the number of
//! iterations.

use super::frame::{ContactFrame, frame};

/// A rigid sphere, or a plane, which is the default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rigid {
    /// Curvature kappa: one over the radius.
    pub curvature: f64,
}

impl Rigid {
    /// Whether it is the plane: its frame is that of the axes everywhere, and its gap z.
    pub fn is_plane(&self) -> bool {
        self.curvature == 0.0
    }

    fn root(&self, x: &[f64; 3]) -> f64 {
        let k = self.curvature;
        // The distance from the centre, times kappa; nothing is near the centre.
        (1.0 + k * (2.0 * x[2] + k * (x[0] * x[0] + x[1] * x[1] + x[2] * x[2]))).max(0.0).sqrt()
    }

    /// Distance of a point from the surface; negative inside the opponent.
    pub fn gap(&self, x: &[f64; 3]) -> f64 {
        let square = x[0] * x[0] + x[1] * x[1] + x[2] * x[2];
        (2.0 * x[2] + self.curvature * square) / (1.0 + self.root(x))
    }

    /// The frame at a point: t1 along x as far as it can be, t2 along y exactly on the symmetry
    /// plane.
    pub fn frame(&self, x: &[f64; 3]) -> ContactFrame {
        let k = self.curvature;
        let [t1, t2, n] = frame([k * x[0], k * x[1], 1.0 + k * x[2]]);
        [t1, if x[1] == 0.0 { [0.0, 1.0, 0.0] } else { t2 }, n]
    }

    /// What brings a point that has passed the surface back onto it, along its normal.
    pub fn push_out(&self, x: &[f64; 3]) -> [f64; 3] {
        let gap = self.gap(x).min(0.0);
        let [_, _, n] = self.frame(x);
        n.map(|n| 0.0 - gap * n)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::frame::{from_frame, to_frame};

    const POINTS: [[f64; 3]; 4] = [[0.3, 0.2, -0.05], [-0.2, 0.0, 0.4], [0.0, 0.0, -0.1], [1e-4, 2e-4, 3e-9]];

    #[test]
    fn the_gap_is_the_distance_from_the_sphere_and_grows_along_the_normal() {
        for curvature in [0.1, 1.0, 3.0] {
            let rigid = Rigid { curvature };
            for x in POINTS {
                let r = 1.0 / curvature;
                let distance = (x[0] * x[0] + x[1] * x[1] + (x[2] + r) * (x[2] + r)).sqrt() - r;
                assert!((rigid.gap(&x) - distance).abs() < 1e-14 * (1.0 + r), "{curvature} {x:?}");
                let frame = rigid.frame(&x);
                for (i, a) in frame.iter().enumerate() {
                    for (j, b) in frame.iter().enumerate() {
                        let dot: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
                        assert!((dot - f64::from(u8::from(i == j))).abs() < 1e-14);
                    }
                }
                let moved = |by: [f64; 3]| rigid.gap(&std::array::from_fn(|i| x[i] + 1e-6 * from_frame(&frame, &by)[i]));
                assert!((moved([0.0, 0.0, 1.0]) - rigid.gap(&x) - 1e-6).abs() < 1e-12);
                assert!(
                    (moved([1.0, 0.0, 0.0]) - rigid.gap(&x)).abs() < 1e-11
                        && (moved([0.0, 1.0, 0.0]) - rigid.gap(&x)).abs() < 1e-11
                );
                let out = rigid.push_out(&x);
                assert!((rigid.gap(&std::array::from_fn(|i| x[i] + out[i])) - rigid.gap(&x).max(0.0)).abs() < 1e-14);
                let back = from_frame(&frame, &to_frame(&frame, &x));
                assert!(back.iter().zip(&x).all(|(a, b)| (a - b).abs() < 1e-15));
            }
        }
    }

    #[test]
    fn a_sphere_of_great_radius_is_the_plane() {
        for x in POINTS {
            let (plane, far) = (Rigid { curvature: 0.0 }, Rigid { curvature: 1e-9 });
            assert_eq!((plane.gap(&x), plane.frame(&x)), (x[2], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]));
            assert!((far.gap(&x) - x[2]).abs() < 1e-9, "no digits are lost");
        }
    }
}

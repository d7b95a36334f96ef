//! Where the rigid plate stands: how far its centre has moved, and how it has turned.

use serde::{Deserialize, Serialize};

/// A rotation matrix, row by row.
pub type Rotation = [[f64; 3]; 3];

/// Centre of the undeformed sphere.
pub const CENTRE: [f64; 3] = [0.0, 0.0, 1.0];

/// A plate that is not rigid widens: a node at the distance r from its centre moves outwards by r
/// times a polynomial in r^2 with so many coefficients.
pub const MODES: usize = 2;

/// r^2 to the powers of the modes of a node of the plate.
pub fn modes([x, y, _]: &[f64; 3]) -> [f64; MODES] {
    [1.0, x * x + y * y]
}

/// Where the plate stands, but for its indentation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Pose {
    /// How far its centre has moved along x and y.
    pub shift: [f64; 2],
    /// How it has turned about its centre; `None` as long as it has not.
    pub turn: Option<Rotation>,
    /// How it has widened before it turned; zeros of a rigid plate.
    pub stretch: [f64; MODES],
}

impl Pose {
    /// A plate that has moved by `delta_t` along x.
    pub const fn along_x(delta_t: f64) -> Self {
        Self { shift: [delta_t, 0.0], turn: None, stretch: [0.0; MODES] }
    }

    /// By which share of its distance from the axis a node has moved outwards.
    fn widening(&self, from_centre: &[f64; 3]) -> f64 {
        modes(from_centre).iter().zip(self.stretch).map(|(mode, share)| mode * share).sum()
    }

    /// The outward force of what acts on a node along each of the modes.
    pub fn outward(&self, from_centre: &[f64; 3], force: &[f64; 3]) -> [f64; MODES] {
        let [x, y, _] = from_centre;
        let out = [*x, *y, 0.0];
        let out = self.turn.map_or(out, |turn| applied(&turn, &out));
        let along = out[0] * force[0] + out[1] * force[1] + out[2] * force[2];
        modes(from_centre).map(|mode| mode * along)
    }

    /// Displacement of a node of the plate that lies at `from_centre` in the undeformed sphere, at
    /// the indentation `h`.
    pub fn displacement(&self, h: f64, from_centre: &[f64; 3]) -> [f64; 3] {
        let [x, y] = self.shift;
        if self.stretch == [0.0; MODES] {
            return self.rigid([x, y], h, from_centre, from_centre);
        }
        let share = 1.0 + self.widening(from_centre);
        self.rigid([x, y], h, from_centre, &[share * from_centre[0], share * from_centre[1], from_centre[2]])
    }

    /// The same of a node that has moved to `widened` before the plate is turned and moved as one.
    fn rigid(&self, [x, y]: [f64; 2], h: f64, from_centre: &[f64; 3], widened: &[f64; 3]) -> [f64; 3] {
        let Some(turn) = &self.turn else {
            return [x + (widened[0] - from_centre[0]), y + (widened[1] - from_centre[1]), -h];
        };
        let turned = applied(turn, widened);
        [x + (turned[0] - from_centre[0]), y + (turned[1] - from_centre[1]), (turned[2] - from_centre[2]) - h]
    }

    /// Where the centre is.
    pub fn centre(&self, h: f64) -> [f64; 3] {
        [CENTRE[0] + self.shift[0], CENTRE[1] + self.shift[1], CENTRE[2] - h]
    }

    /// The motion of a rigid body from this pose at `h` to another one at `to_h`.
    pub fn motion_to(&self, h: f64, to: &Self, to_h: f64) -> RigidMotion {
        RigidMotion { turn: product(&to.rotation(), &transposed(&self.rotation())), from: self.centre(h), to: to.centre(to_h) }
    }

    fn rotation(&self) -> Rotation {
        self.turn.unwrap_or(IDENTITY)
    }
}

/// A motion of a body as one: what was at `from` is at `to`, and all has turned about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidMotion {
    turn: Rotation,
    from: [f64; 3],
    to: [f64; 3],
}

impl RigidMotion {
    /// Where a point goes.
    pub fn moved(&self, x: [f64; 3]) -> [f64; 3] {
        let turned = self.turned([x[0] - self.from[0], x[1] - self.from[1], x[2] - self.from[2]]);
        [self.to[0] + turned[0], self.to[1] + turned[1], self.to[2] + turned[2]]
    }

    /// A vector that turns with the body.
    pub fn turned(&self, v: [f64; 3]) -> [f64; 3] {
        applied(&self.turn, &v)
    }
}

const IDENTITY: Rotation = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

fn applied(q: &Rotation, v: &[f64; 3]) -> [f64; 3] {
    q.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

fn transposed(q: &Rotation) -> Rotation {
    std::array::from_fn(|i| std::array::from_fn(|j| q[j][i]))
}

/// The rotation `b` and after it `a`.
pub fn product(a: &Rotation, b: &Rotation) -> Rotation {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
}

/// The rotation about the axis of `angles` by its length, in rad (Rodrigues).
pub fn rotation(angles: [f64; 3]) -> Rotation {
    let [x, y, z] = angles;
    let square = x * x + y * y + z * z;
    let angle = square.sqrt();
    // sin(t)/t and (1 - cos(t))/t^2.
    let (s, c) = if angle < 1e-4 {
        (1.0 - square / 6.0, 0.5 - square / 24.0)
    } else {
        (angle.sin() / angle, 2.0 * (0.5 * angle).sin().powi(2) / square)
    };
    let w = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]];
    let ww = product(&w, &w);
    std::array::from_fn(|i| std::array::from_fn(|j| IDENTITY[i][j] + s * w[i][j] + c * ww[i][j]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
        a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
    }

    #[test]
    fn rotations_keep_lengths_and_turn_the_right_way_round() {
        for angles in [[0.0, 0.0, 0.5], [0.3, -1.2, 2.0], [1e-5, 2e-5, -1e-5], [1e-4, 0.0, 0.0]] {
            let q = rotation(angles);
            let unit = product(&q, &transposed(&q));
            assert!(unit.iter().flatten().zip(IDENTITY.iter().flatten()).all(|(a, b)| (a - b).abs() < 1e-15), "{unit:?}");
            let half = rotation(angles.map(|a| 0.5 * a));
            let twice = product(&half, &half);
            assert!(twice.iter().flatten().zip(q.iter().flatten()).all(|(a, b)| (a - b).abs() < 1e-15));
        }
        // A quarter about z takes x to y.
        let quarter = rotation([0.0, 0.0, std::f64::consts::FRAC_PI_2]);
        assert!(distance(applied(&quarter, &[1.0, 0.0, 0.0]), [0.0, 1.0, 0.0]) < 1e-15);
    }

    #[test]
    fn a_motion_takes_the_plate_from_one_pose_to_the_other() {
        let from = Pose { shift: [0.1, -0.2], turn: Some(rotation([0.1, 0.2, -0.3])), ..Pose::default() };
        let to =
            Pose { shift: [0.3, 0.1], turn: Some(product(&rotation([-0.2, 0.4, 0.5]), &rotation([0.1, 0.2, -0.3]))), ..from };
        let motion = from.motion_to(0.02, &to, 0.05);
        for offset in [[0.7, 0.1, 0.0], [-0.2, 0.9, 0.0]] {
            let at = |pose: &Pose, h: f64| {
                let u = pose.displacement(h, &offset);
                std::array::from_fn(|k| CENTRE[k] + offset[k] + u[k])
            };
            assert!(distance(motion.moved(at(&from, 0.02)), at(&to, 0.05)) < 1e-15);
        }
        assert_eq!(Pose::along_x(0.25).displacement(0.02, &[0.3, 0.4, 0.0]), [0.25, 0.0, -0.02]);
    }
}

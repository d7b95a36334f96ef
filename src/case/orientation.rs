//! How the mesh of a whole sphere lies about the normal: with its x axis along the first shear of
//! the path.
//!
//! Sphere and opponent are alike in all directions along the surface, the mesh is not. So a path
//! that is turned about the normal has a mesh that is turned with it, and the same forces; what the
//! mesh adds of its own is met by a path only where it leaves its first direction.

use super::{Case, Hold, Motion, Segment, ShearTarget, unit};
use crate::contact::pair::Image;

/// The mesh's axes in the user's: both have the same z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orientation {
    /// The mesh's x axis, a unit vector in the user's x and y.
    x_axis: [f64; 2],
}

impl Orientation {
    /// The mesh's axes are the user's.
    pub const ALONG_X: Self = Self { x_axis: [1.0, 0.0] };

    /// The mesh's x axis along a vector; `None` of one that has no direction.
    fn along([x, y]: [f64; 2]) -> Option<Self> {
        let length = x.hypot(y);
        (length > 0.0).then(|| Self { x_axis: [x / length, y / length] })
    }

    /// A vector of the user's axes, x and y, in the mesh's.
    pub fn to_mesh(self, [x, y]: [f64; 2]) -> [f64; 2] {
        if self == Self::ALONG_X {
            return [x, y];
        }
        let [cos, sin] = self.x_axis;
        [x * cos + y * sin, y * cos - x * sin]
    }

    /// A vector of the mesh's axes in the user's; what rounding leaves across an axis is none.
    pub fn to_user(self, [x, y]: [f64; 2]) -> [f64; 2] {
        if self == Self::ALONG_X {
            return [x, y];
        }
        let [cos, sin] = self.x_axis;
        let size = x.hypot(y);
        [x * cos - y * sin, y * cos + x * sin].map(|part| if part.abs() <= 4.0 * f64::EPSILON * size { 0.0 } else { part })
    }

    /// A symmetric tensor xx, yy, zz, xy, yz, zx of the mesh's axes in the user's.
    pub fn tensor_to_user(self, [xx, yy, zz, xy, yz, zx]: [f64; 6]) -> [f64; 6] {
        if self == Self::ALONG_X {
            return [xx, yy, zz, xy, yz, zx];
        }
        let [cos, sin] = self.x_axis;
        let (cc, ss, cs) = (cos * cos, sin * sin, cos * sin);
        let [zx, yz] = self.to_user([zx, yz]);
        [cc * xx - 2.0 * cs * xy + ss * yy, ss * xx + 2.0 * cs * xy + cc * yy, zz, cs * (xx - yy) + (cc - ss) * xy, yz, zx]
    }

    /// A segment of the user's axes in the mesh's.
    pub fn segment_to_mesh(self, segment: Segment) -> Segment {
        if self == Self::ALONG_X {
            return segment;
        }
        // What says nothing of y stands where y is 0.
        let to = |indentation, shear: f64| Motion { indentation, shear: Some(self.to_mesh([shear, 0.0])), ..Motion::default() };
        match segment {
            Segment::Shear { shear: ShearTarget::Displacement(shear), hold } => Segment::Motion { to: to(None, shear), hold },
            Segment::Oblique { indentation, shear } => {
                Segment::Motion { to: to(Some(indentation), shear), hold: Hold::default() }
            }
            Segment::Motion { to, hold } => Segment::Motion {
                to: Motion {
                    shear: to.shear.map(|shear| self.to_mesh(shear)),
                    roll: to.roll.map(|roll| self.to_mesh(roll)),
                    ..to
                },
                hold,
            },
            Segment::Slip { direction, hold } => {
                let [x, y] = self.to_mesh(unit(direction));
                // Along itself exactly.
                let direction = if y.abs() < f64::EPSILON && x > 0.0 { 0.0 } else { y.atan2(x).to_degrees() };
                Segment::Slip { direction, hold }
            }
            Segment::Indentation { .. } | Segment::Release { .. } | Segment::Shear { shear: ShearTarget::FullSlip, .. } => {
                segment
            }
        }
    }
}

impl Case {
    /// How the mesh lies. A path that begins along the x axis has its mesh along it, as has one of
    /// which half of the sphere is meshed, or half of a pair that is its own image turned about y;
    /// and one with a shear to full slip that does not say where to.
    pub fn orientation(&self) -> Orientation {
        let goes_on = |segment: &Segment| matches!(segment, Segment::Shear { shear: ShearTarget::FullSlip, .. });
        if self.is_even() || self.image() == Some(Image::HalfTurn) || self.path.iter().any(goes_on) {
            return Orientation::ALONG_X;
        }
        self.path.iter().find_map(first_way).unwrap_or(Orientation::ALONG_X)
    }
}

/// The direction of a shear where nothing was sheared before; `None` of other segments.
fn first_way(segment: &Segment) -> Option<Orientation> {
    let way = match *segment {
        Segment::Shear { shear: ShearTarget::Displacement(shear), .. } | Segment::Oblique { shear, .. } => [shear, 0.0],
        Segment::Slip { direction, .. } => unit(direction),
        Segment::Motion { to, .. } => to.shear?,
        Segment::Indentation { .. } | Segment::Release { .. } | Segment::Shear { .. } => return None,
    };
    // To and fro along x the mesh is the same.
    if way[1] == 0.0 && way[0] != 0.0 { Some(Orientation::ALONG_X) } else { Orientation::along(way) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn case(path: &str, opponent: &str) -> Case {
        let text = format!(
            "[sphere]\nradius = 2.0\n[material]\nyoungs_modulus = 1e5\npoissons_ratio = 0.3\n\
             [material.hardening]\nlaw = \"elastic\"\n[contact]\nfriction = 0.3\n{opponent}[[path]]\nindentation = 0.02\n{path}"
        );
        Case::parse(&text, "case.toml", &[]).expect("a case")
    }

    fn close(a: &[f64], b: &[f64]) -> bool {
        a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-15)
    }

    #[test]
    fn the_mesh_lies_along_the_first_shear() {
        let lies = |path: &str| case(path, "").orientation().x_axis;
        assert!(close(&lies("[[path]]\nshear = [0.003, 0.004]\n[[path]]\nshear = [0.0, 0.001]\n"), &[0.6, 0.8]));
        assert!(close(&lies("[[path]]\nshear = \"full-slip\"\nshear_direction = 90\n"), &[0.0, 1.0]));
        assert!(close(&lies("[[path]]\ntwist = 0.1\n[[path]]\nshear = 0.001\nshear_direction = 30\n"), &unit(30.0)));
        assert!(close(&lies("[[path]]\nroll = [0.3, 0.4]\nshear = [0.0, 0.01]\n"), &[0.0, 1.0]));
        // Along x, and where nothing else would do.
        for path in [
            "[[path]]\nshear = 0.001\n[[path]]\nshear = [0.0, 0.001]\n",
            "[[path]]\nshear = [-0.001, 0.0]\n[[path]]\nshear = [0.0, 0.001]\n",
            "[[path]]\ntwist = 0.1\n",
            "[[path]]\nroll = [0.1, 0.0]\n",
            "[[path]]\nshear = [0.001, 0.001]\n[[path]]\nshear = [0.001, 0.0]\n[[path]]\nshear = \"full-slip\"\n",
        ] {
            assert_eq!(lies(path), [1.0, 0.0], "{path}");
        }
        let pair = |path: &str| case(path, "[opponent]\nequal = true\n").orientation().x_axis;
        assert!(close(&pair("[[path]]\nshear = [0.003, 0.004]\n"), &[0.6, 0.8]));
        assert_eq!(pair("[[path]]\nroll = [0.1, 0.0]\n"), [1.0, 0.0]);
    }

    #[test]
    fn a_path_along_its_first_shear_is_one_along_x() {
        let found = case("[[path]]\nshear = [0.003, 0.004]\n[[path]]\nshear = [-0.003, -0.004]\nindentation = 0.01\n", "");
        let turned = found.path.iter().map(|&segment| found.orientation().segment_to_mesh(segment));
        let shears: Vec<[f64; 2]> = turned
            .filter_map(|segment| match segment {
                Segment::Motion { to, .. } => to.shear,
                _ => None,
            })
            .collect();
        assert!(shears.len() == 2 && close(&shears[0], &[0.005, 0.0]) && close(&shears[1], &[-0.005, 0.0]), "{shears:?}");
        let slip = case("[[path]]\nshear = \"full-slip\"\nshear_direction = 37\n", "");
        let turned = slip.orientation().segment_to_mesh(slip.path[1]);
        assert_eq!(turned, Segment::Slip { direction: 0.0, hold: Hold::Indentation });
    }

    #[test]
    fn there_and_back_is_where_it_was() {
        let orientation = Orientation::along([0.3, -0.7]).expect("a direction");
        assert!(close(&orientation.to_user(orientation.to_mesh([0.2, 0.5])), &[0.2, 0.5]));
        assert!(close(&orientation.to_user([1.0, 0.0]), &orientation.x_axis));
        assert_eq!(orientation.to_user(orientation.to_mesh([0.0, -0.003]))[0], 0.0);
        // A uniaxial stress along the mesh's x axis, and one with all components, whose products
        // with vectors turn with them.
        let [cos, sin] = orientation.x_axis;
        let uniaxial = orientation.tensor_to_user([2.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        assert!(close(&uniaxial, &[2.0 * cos * cos, 2.0 * sin * sin, 0.0, 2.0 * cos * sin, 0.0, 0.0]));
        let times = |[xx, yy, zz, xy, yz, zx]: [f64; 6], [x, y, z]: [f64; 3]| {
            [xx * x + xy * y + zx * z, xy * x + yy * y + yz * z, zx * x + yz * y + zz * z]
        };
        let turned = |[x, y, z]: [f64; 3]| {
            let [x, y] = orientation.to_user([x, y]);
            [x, y, z]
        };
        let (stress, normal) = ([1.0, -2.0, 0.5, 0.7, -0.3, 0.9], [0.2, -0.4, 0.6]);
        assert!(close(&turned(times(stress, normal)), &times(orientation.tensor_to_user(stress), turned(normal))));
    }
}

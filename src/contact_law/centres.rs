//! The frame of the centres, in which an engine moves two spheres.
//!
//! A simulation moves the equators of two spheres along fixed axes: with D = R_1 + R_2 the centre
//! of the one is at (delta_T, D - h) from that of the other, and F_T and F_N are the components of
//! the force along these axes. An engine has the line of centres, which turns by theta = atan
//! (delta_T/(D - h)) as the spheres pass each other. With L^2 = delta_T^2 + (D - h)^2
//!
//! - its overlap is D - L, which is less than h by delta_T^2/2D nearly,
//! - its tangential displacement is the integral of the relative velocity across the line, d =
//!   cos(theta) d delta_T + sin(theta) dh = L d theta; at constant h it is (D - h)
//!   asinh(delta_T/(D - h)),
//! - its forces are N = F_N cos(theta) - F_T sin(theta) and T = F_T cos(theta) + F_N sin(theta).
//!
//! F_N dh + F_T d delta_T is N d(overlap) + T dd: the work stays what it is. On a flat nothing
//! turns.
//!
//! Two elastic spheres that slide have T = mu N to 1 % (at mu above 0.6 up to 3 % less, since not
//! all of their points slide in one direction). A plastic dent stays with its material, so that the
//! plane of the contact turns less than the line of centres, and T exceeds mu N: by 0.7 % in the
//! mean of simulated contacts with mu below 0.4, by 3.8 % of those with mu above 0.7, and by a half
//! where spheres pass each other by R/2. A law keeps to Coulomb's bound and falls short of that.

use serde::{Deserialize, Serialize};

use crate::case::Case;

/// How a table of two spheres says that its h, delta_T and forces are those of the frame of the
/// centres.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Frame {
    /// The line of centres and the plane across it.
    #[serde(rename = "line of centres")]
    LineOfCentres,
}

/// The two centres of a contact; of one with a flat the fixed axes are the frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Centres {
    /// D = R_1 + R_2, or none on a flat.
    distance: Option<f64>,
}

impl Centres {
    /// Those of a case, in its units.
    pub fn of(case: &Case) -> Self {
        let radius = case.sphere.radius;
        let distance = case.opponent_radius().map(|other| radius + other);
        Self { distance: distance.filter(|_| !case.sphere.flat) }
    }

    /// What a table of these two says of its frame.
    pub fn frame(self) -> Option<Frame> {
        self.distance.map(|_| Frame::LineOfCentres)
    }

    /// The overlap at the place (h, delta_T).
    pub fn overlap(self, [h, delta_t]: [f64; 2]) -> f64 {
        match self.distance {
            // D - L without the difference of two lengths that are nearly the same.
            Some(distance) => h - delta_t * delta_t / ((distance - h).hypot(delta_t) + (distance - h)),
            None => h,
        }
    }

    /// The h at which the overlap is `overlap` at this delta_T; without end beyond the last.
    pub fn indentation(self, overlap: f64, delta_t: f64) -> f64 {
        match self.distance {
            Some(distance) => {
                let length = distance - overlap;
                overlap + delta_t * delta_t / (length + (length * length - delta_t * delta_t).max(0.0).sqrt())
            }
            None => overlap,
        }
    }

    /// The tangential displacement on the straight way from one place (h, delta_T) to another: the
    /// integral of L over theta, by Simpson's rule, to 1e-9 in steps of theta below 0.1.
    pub fn displacement(self, [h0, d0]: [f64; 2], [h1, d1]: [f64; 2]) -> f64 {
        let Some(distance) = self.distance else { return d1 - d0 };
        let (z0, z1) = (distance - h0, distance - h1);
        let angle = (z0 * (d1 - d0) + d0 * (h1 - h0)).atan2(z0 * z1 + d0 * d1);
        let (first, last) = (z0.hypot(d0), z1.hypot(d1));
        let middle = 2.0 * first * last * (0.5 * angle).cos() / (first + last);
        angle * (first + 4.0 * middle + last) / 6.0
    }

    /// \[cos, sin\] of theta.
    fn direction(self, [h, delta_t]: [f64; 2]) -> [f64; 2] {
        match self.distance {
            Some(distance) => {
                let length = (distance - h).hypot(delta_t);
                [(distance - h) / length, delta_t / length]
            }
            None => [1.0, 0.0],
        }
    }

    /// N and T of the frame of the centres from F_N and F_T along the fixed axes, at a place.
    pub fn turned(self, place: [f64; 2], [f_n, f_t]: [f64; 2]) -> [f64; 2] {
        let [cosine, sine] = self.direction(place);
        [f_n * cosine - f_t * sine, f_t * cosine + f_n * sine]
    }

    /// F_N and F_T along the fixed axes from N and T, at a place.
    pub fn along_axes(self, place: [f64; 2], [n, t]: [f64; 2]) -> [f64; 2] {
        let [cosine, sine] = self.direction(place);
        [n * cosine + t * sine, t * cosine - n * sine]
    }

    /// The overlap where delta_T has a part along y too: at (h, delta_T along x, along y).
    pub fn overlap_at(self, [h, x, y]: [f64; 3]) -> f64 {
        self.overlap([h, if y == 0.0 { x } else { x.hypot(y) }])
    }

    /// The tangential displacement on the straight way from one place (h, delta_T along x, along y)
    /// to another, along the axes that the line of centres has at the middle, to the second order
    /// of the step.
    pub fn slid(self, from: [f64; 3], to: [f64; 3]) -> [f64; 2] {
        let ([h0, x0, y0], [h1, x1, y1]) = (from, to);
        if y0 == 0.0 && y1 == 0.0 {
            return [self.displacement([h0, x0], [h1, x1]), 0.0];
        }
        let step = [h0 - h1, x1 - x0, y1 - y0];
        let middle = [0.5 * (h0 + h1), 0.5 * (x0 + x1), 0.5 * (y0 + y1)];
        self.axes(middle).map(|axis| dot(axis, step))
    }

    /// F_N and F_T along the fixed axes from N and T along x and y of the frame, at a place (h,
    /// delta_T along x, along y).
    pub fn along_fixed_axes(self, place: [f64; 3], [n, t, across]: [f64; 3]) -> [f64; 3] {
        let [h, x, y] = place;
        if y == 0.0 {
            let [f_n, f_t] = self.along_axes([h, x], [n, t]);
            return [f_n, f_t, across];
        }
        let (line, [along, other]) = (self.line(place), self.axes(place));
        // A force on the one sphere is against the line to the other: F_N is against z.
        let sum = |k: usize| t * along[k] + across * other[k];
        [n * line[0] - sum(0), sum(1) - n * line[1], sum(2) - n * line[2]]
    }

    /// Unit vector from one centre to the other: along z, x, y.
    fn line(self, [h, x, y]: [f64; 3]) -> [f64; 3] {
        match self.distance {
            Some(distance) => {
                let length = (distance - h).hypot(x.hypot(y));
                [(distance - h) / length, x / length, y / length]
            }
            None => [1.0, 0.0, 0.0],
        }
    }

    /// What x and y become as z is turned into the line of centres: the axes of T. An engine
    /// carries its axes along the path; on a closed one they turn by the solid angle of the line,
    /// pi delta_T^2/D^2 at most, which is left out.
    fn axes(self, place: [f64; 3]) -> [[f64; 3]; 2] {
        let [z, x, y] = self.line(place);
        let less = 1.0 / (1.0 + z);
        [[-x, 1.0 - x * x * less, -x * y * less], [-y, -x * y * less, 1.0 - y * y * less]]
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn centres(opponent: &str) -> Centres {
        let text = format!(
            "[sphere]\nradius = 2.0\n[material]\nyoungs_modulus = 200e3\npoissons_ratio = 0.3\nhardening = {{ law = \"elastic\" }}\n\
             [contact]\nfriction = 0.3\n{opponent}\n[[path]]\nindentation = 0.02\n"
        );
        Centres::of(&Case::parse(&text, "case.toml", &[]).unwrap())
    }

    #[test]
    fn spheres_turn_and_flats_do_not() {
        let material = "[opponent.material]\nyoungs_modulus = 1e5\npoissons_ratio = 0.3\nhardening = { law = \"elastic\" }";
        for (opponent, distance) in [
            (String::new(), None),
            ("[opponent]\nequal = true".to_owned(), Some(4.0)),
            ("[opponent]\nrigid = true\nradius = 3.0".to_owned(), Some(5.0)),
            (format!("[opponent]\nradius = 1.0\n{material}"), Some(3.0)),
            (format!("[opponent]\nflat = true\n{material}"), None),
        ] {
            assert_eq!(centres(&opponent).distance, distance, "{opponent}");
        }
        let flat = centres("");
        assert_eq!(flat.frame(), None);
        assert_eq!([flat.overlap([0.1, 0.5]), flat.displacement([0.1, 0.5], [0.2, 0.75])], [0.1, 0.25]);
        assert_eq!([flat.turned([0.1, 0.5], [3.0, 1.0]), flat.along_axes([0.1, 0.5], [3.0, 1.0])], [[3.0, 1.0]; 2]);
    }

    #[test]
    fn at_constant_h_the_integral_is_known() {
        let pair = centres("[opponent]\nequal = true");
        let (h, mut sum, mut at) = (0.1, 0.0, 0.0);
        for i in 1..=20 {
            let next = 0.06 * f64::from(i);
            sum += pair.displacement([h, at], [h, next]);
            at = next;
            let exact = (4.0 - h) * (at / (4.0 - h)).asinh();
            assert!((sum / exact - 1.0).abs() < 1e-9, "{at}: {sum} {exact}");
            assert!((pair.overlap([h, at]) - (4.0 - (4.0 - h).hypot(at))).abs() < 1e-14);
            assert!((pair.indentation(pair.overlap([h, at]), at) - h).abs() < 1e-14);
        }
        // Along the line of centres nothing slides; back on the same way all of it comes back.
        assert!(pair.displacement([0.0, 0.0], [0.3, 0.0]) == 0.0);
        let along = |share: f64| [4.0 - share * (4.0 - h), share * at];
        assert!(pair.displacement(along(1.0), along(0.95)).abs() < 1e-15);
        let (there, back) = (pair.displacement([h, at], [0.2, 0.1]), pair.displacement([0.2, 0.1], [h, at]));
        assert!((there + back).abs() < 1e-14 && there < 0.0);
    }

    #[test]
    fn work_is_the_same_in_both_frames() {
        let pair = centres("[opponent]\nrigid = true\nradius = 1.5");
        let at = |i: i32| {
            let t = f64::from(i) / 400.0;
            [0.1 + 0.2 * t * t, 0.7 * (2.0 * t).sin()]
        };
        let (mut fixed, mut turned) = (0.0, 0.0);
        for i in 0..400 {
            let (from, to) = (at(i), at(i + 1));
            let middle = [0.5 * (from[0] + to[0]), 0.5 * (from[1] + to[1])];
            let force = [2.0 + (9.0 * middle[1]).cos(), 0.4 - middle[0]];
            fixed += force[0] * (to[0] - from[0]) + force[1] * (to[1] - from[1]);
            let [n, t] = pair.turned(middle, force);
            turned += n * (pair.overlap(to) - pair.overlap(from)) + t * pair.displacement(from, to);
            let again = pair.along_axes(middle, [n, t]);
            assert!((again[0] - force[0]).abs() < 1e-14 && (again[1] - force[1]).abs() < 1e-14);
        }
        assert!((turned / fixed - 1.0).abs() < 1e-5, "{turned} {fixed}");
    }

    #[test]
    fn a_force_on_the_line_of_centres_has_no_tangential_part() {
        let pair = centres("[opponent]\nequal = true");
        for delta_t in [-0.4f64, 0.01, 0.3] {
            // Two spheres without friction, seen along the fixed axes.
            let theta = delta_t.atan2(4.0 - 0.2);
            let [n, t] = pair.turned([0.2, delta_t], [7.0 * theta.cos(), -7.0 * theta.sin()]);
            assert!((n - 7.0).abs() < 1e-14 && t.abs() < 1e-14, "{n} {t}");
        }
    }

    #[test]
    fn a_path_in_another_direction_is_that_along_x_turned() {
        let pair = centres("[opponent]\nequal = true");
        let flat = centres("");
        let (cosine, sine) = (28.0 / 53.0, 45.0 / 53.0);
        let across = |[h, d]: [f64; 2]| [h, cosine * d, sine * d];
        for centres in [pair, flat] {
            let (mut along, mut turned) = (0.0, [0.0; 2]);
            for i in 0..1000 {
                let at = |i: i32| [0.1 + 1e-4 * f64::from(i), 1e-3 * f64::from(i)];
                let (from, to) = (at(i), at(i + 1));
                along += centres.displacement(from, to);
                let step = centres.slid(across(from), across(to));
                turned = [turned[0] + step[0], turned[1] + step[1]];
                assert!((centres.overlap(to) - centres.overlap_at(across(to))).abs() < 1e-15);
                let [f_n, f_t] = centres.along_axes(to, [2.0, 0.4]);
                let found = centres.along_fixed_axes(across(to), [2.0, 0.4 * cosine, 0.4 * sine]);
                let wanted = [f_n, cosine * f_t, sine * f_t];
                assert!((0..3).all(|k| (found[k] - wanted[k]).abs() < 1e-14), "{found:?} {wanted:?}");
            }
            assert!((turned[0] - cosine * along).abs() < 1e-7 && (turned[1] - sine * along).abs() < 1e-7, "{turned:?} {along}");
        }
        // Along x it is the same to the bit.
        assert_eq!(pair.slid([0.1, 0.2, 0.0], [0.2, 0.3, 0.0]), [pair.displacement([0.1, 0.2], [0.2, 0.3]), 0.0]);
    }
}

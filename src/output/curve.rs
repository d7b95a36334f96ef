//! A smooth curve through points of a history, to read it between its steps.

/// The cubic of Hermite through points whose abscissas increase, with the slopes of Fritsch and
/// Butland (SIAM J. Sci. Stat. Comput. 5, 1984): it rises and falls only where the points do. Half
/// as many steps have chords that lie visibly below a concave curve, and would pass for an error of
/// the mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curve {
    points: Vec<[f64; 2]>,
    slopes: Vec<f64>,
}

impl Curve {
    /// Through the points (x, y); one that does not lie beyond all before it is left out.
    pub fn through(points: impl IntoIterator<Item = [f64; 2]>) -> Self {
        let mut kept: Vec<[f64; 2]> = Vec::new();
        for point in points {
            if kept.last().is_none_or(|last| point[0] > last[0]) {
                kept.push(point);
            }
        }
        Self { slopes: slopes(&kept), points: kept }
    }

    /// Where the curve ends, and how long its last stretch is; `None` for fewer than two points.
    pub fn end(&self) -> Option<[f64; 2]> {
        let [.., before, last] = self.points.as_slice() else { return None };
        Some([last[0], last[0] - before[0]])
    }

    /// Where it first comes to y: at its first point if that is no lower. `None` where none of its
    /// points is as high.
    pub fn reaches(&self, y: f64) -> Option<f64> {
        let right = self.points.iter().position(|point| point[1] >= y)?;
        let Some(left) = right.checked_sub(1) else { return Some(self.points[0][0]) };
        let (mut below, mut above) = (self.points[left][0], self.points[right][0]);
        // Between two points it rises or falls, and does not do both.
        for _ in 0..f64::MANTISSA_DIGITS {
            let between = 0.5 * (below + above);
            if self.at(between)? < y {
                below = between;
            } else {
                above = between;
            }
        }
        Some(above)
    }

    /// Its value at x. Outside of its points it goes on straight; a single point is constant.
    /// `None` if there is none.
    pub fn at(&self, x: f64) -> Option<f64> {
        let (&[first, at_first], &[last, at_last]) = (self.points.first()?, self.points.last()?);
        if x <= first {
            return Some(at_first + self.slopes.first()? * (x - first));
        }
        if x >= last {
            return Some(at_last + self.slopes.last()? * (x - last));
        }
        let right = self.points.partition_point(|point| point[0] <= x);
        let ([from, y_from], [to, y_to]) = (self.points[right - 1], self.points[right]);
        let (length, t) = (to - from, (x - from) / (to - from));
        let s = 1.0 - t;
        let ends = (1.0 + 2.0 * t) * s * s * y_from + t * t * (3.0 - 2.0 * t) * y_to;
        Some(ends + length * t * s * (s * self.slopes[right - 1] - t * self.slopes[right]))
    }
}

/// Slopes at the points: between two chords of one sign the weighted harmonic mean of theirs, at a
/// turn none, at the ends those of the parabola through three points, as far as it stays monotone.
fn slopes(points: &[[f64; 2]]) -> Vec<f64> {
    let lengths: Vec<f64> = points.windows(2).map(|pair| pair[1][0] - pair[0][0]).collect();
    let chords: Vec<f64> = points.windows(2).zip(&lengths).map(|(pair, length)| (pair[1][1] - pair[0][1]) / length).collect();
    match chords.len() {
        0 => vec![0.0; points.len()],
        1 => vec![chords[0]; 2],
        last => {
            let inner = (1..last).map(|i| {
                let ([before, after], [short, long]) = ([chords[i - 1], chords[i]], [lengths[i - 1], lengths[i]]);
                if before * after <= 0.0 {
                    return 0.0;
                }
                let (w_before, w_after) = (2.0 * long + short, long + 2.0 * short);
                (w_before + w_after) / (w_before / before + w_after / after)
            });
            let at_start = end_slope([lengths[0], lengths[1]], [chords[0], chords[1]]);
            let at_end = end_slope([lengths[last - 1], lengths[last - 2]], [chords[last - 1], chords[last - 2]]);
            std::iter::once(at_start).chain(inner).chain([at_end]).collect()
        }
    }
}

/// Slope at an end from the stretch there and the next one.
fn end_slope([here, next]: [f64; 2], [chord, other]: [f64; 2]) -> f64 {
    let slope = ((2.0 * here + next) * chord - here * other) / (here + next);
    if slope * chord <= 0.0 {
        0.0
    } else if chord * other < 0.0 && slope.abs() > 3.0 * chord.abs() {
        3.0 * chord
    } else {
        slope
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_is_followed_closely_and_a_line_exactly() {
        let curve = Curve::through((0..=8).map(|i| [0.1 * f64::from(i * i), 3.0 + 0.2 * f64::from(i * i)]));
        for i in 0..64 {
            let x = 0.1 * f64::from(i);
            assert!((curve.at(x).unwrap() - (3.0 + 2.0 * x)).abs() < 1e-12, "{x}");
        }
        // Half as many steps: 0.4 % of the height between them, where chords lack 3 %.
        let arc = |x: f64| x * (2.0 - x);
        let curve = Curve::through((0..=4).map(|i| 0.25 * f64::from(i)).map(|x| [x, arc(x)]));
        let worst = (0..=100).map(|i| 0.01 * f64::from(i)).map(|x| (curve.at(x).unwrap() - arc(x)).abs()).fold(0.0, f64::max);
        assert!(worst < 0.006, "{worst}");
    }

    #[test]
    fn it_comes_first_to_a_value_where_a_rise_passes_it() {
        let arc = |x: f64| x * (2.0 - x);
        let curve = Curve::through((0..=8).map(|i| 0.25 * f64::from(i)).map(|x| [x, arc(x)]));
        for wanted in [0.1, 0.5, 0.9375, 0.99] {
            let x = curve.reaches(wanted).unwrap();
            assert!(
                (curve.at(x).unwrap() - wanted).abs() < 1e-12 && (x - (1.0 - (1.0 - wanted).sqrt())).abs() < 0.02,
                "{wanted}: {x}"
            );
        }
        assert_eq!((curve.reaches(0.0), curve.reaches(1.01)), (Some(0.0), None));
        // The summit is flat: within rounding a place before it is as high.
        assert!((curve.reaches(1.0).unwrap() - 1.0).abs() < 1e-7);
        let twice = Curve::through([[0.0, 0.0], [1.0, 2.0], [2.0, -1.0], [3.0, 2.0]]);
        assert!(twice.reaches(1.0).is_some_and(|x| x < 1.0 && (twice.at(x).unwrap() - 1.0).abs() < 1e-12));
        assert_eq!(Curve::default().reaches(0.0), None);
    }

    #[test]
    fn it_turns_where_the_points_do_and_goes_on_straight() {
        let points = [[0.0, 0.0], [1.0, 1.0], [2.0, 1.0], [3.0, 0.5], [2.5, 9.0], [4.0, 0.4]];
        let curve = Curve::through(points);
        for i in 0..=100 {
            let x = 1.0 + 0.01 * f64::from(i);
            assert!((curve.at(x).unwrap() - 1.0).abs() < 1e-12);
        }
        assert_eq!(curve.end(), Some([4.0, 1.0]));
        let slope = curve.at(5.0).unwrap() - curve.at(4.0).unwrap();
        assert!((curve.at(6.0).unwrap() - curve.at(5.0).unwrap() - slope).abs() < 1e-12);
        assert_eq!(Curve::through([[1.0, 7.0]]).at(4.0), Some(7.0));
        assert_eq!((Curve::default().at(1.0), Curve::default().end()), (None, None));
    }
}

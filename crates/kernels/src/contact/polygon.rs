//! Convex polygons in the plane in which surfaces meet: clipping (Sutherland & Hodgman, Commun. ACM
//! 17, 1974) and the points of quadrature rules over them.

/// A point of the plane in which surfaces meet.
pub(super) type PlanePoint = [f64; 2];

/// Points of the largest rule along an edge.
pub(super) const MOST_POINTS: usize = 16;
/// Degree 5 rule on the triangle (Radon 1948): barycentric coordinates and weight.
const RULE: [([f64; 3], f64); 7] = {
    const A: f64 = 0.059_715_871_789_769_82;
    const B: f64 = 0.470_142_064_105_115_1;
    const C: f64 = 0.797_426_985_353_087_3;
    const D: f64 = 0.101_286_507_323_456_34;
    const U: f64 = 0.132_394_152_788_506_18;
    const V: f64 = 0.125_939_180_544_827_15;
    const T: f64 = 1.0 / 3.0;
    [([T, T, T], 0.225), ([A, B, B], U), ([B, A, B], U), ([B, B, A], U), ([C, D, D], V), ([D, C, D], V), ([D, D, C], V)]
};

/// Positive where the corners go round counter-clockwise.
pub(super) fn area(polygon: &[PlanePoint]) -> f64 {
    let n = polygon.len();
    0.5 * (0..n).map(|i| polygon[i][0] * polygon[(i + 1) % n][1] - polygon[(i + 1) % n][0] * polygon[i][1]).sum::<f64>()
}

/// The part of a polygon left of the line from `from` to `to`.
fn cut(polygon: &[PlanePoint], from: PlanePoint, to: PlanePoint) -> Vec<PlanePoint> {
    let side = |p: &PlanePoint| (to[0] - from[0]) * (p[1] - from[1]) - (to[1] - from[1]) * (p[0] - from[0]);
    let mut out = Vec::with_capacity(polygon.len() + 1);
    for (i, p) in polygon.iter().enumerate() {
        let q = &polygon[(i + 1) % polygon.len()];
        let (a, b) = (side(p), side(q));
        if a >= 0.0 {
            out.push(*p);
        }
        if (a > 0.0 && b < 0.0) || (a < 0.0 && b > 0.0) {
            let t = a / (a - b);
            out.push([p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])]);
        }
    }
    out
}

/// The part of a quadrilateral within another one, both counter-clockwise; empty if there is none.
pub(super) fn clip(subject: &[PlanePoint; 4], window: &[PlanePoint; 4]) -> Vec<PlanePoint> {
    let mut polygon = subject.to_vec();
    for e in 0..4 {
        polygon = cut(&polygon, window[e], window[(e + 1) % 4]);
        if polygon.len() < 3 {
            return Vec::new();
        }
    }
    polygon
}

/// The part of a polygon at x >= 0.
pub(super) fn clip_at_seam(polygon: Vec<PlanePoint>) -> Vec<PlanePoint> {
    if polygon.iter().all(|p| p[0] >= 0.0) { polygon } else { cut(&polygon, [0.0, 1.0], [0.0, 0.0]) }
}

/// Calls `f` with the points and weights of a rule over a convex polygon. Its triangles meet in its
/// centroid: from one of its corners they would jump where rounding decides which one is the first,
/// and what is integrated are no polynomials.
pub(super) fn each_point(polygon: &[PlanePoint], smallest: f64, mut f: impl FnMut(PlanePoint, f64)) {
    if polygon.len() < 3 || area(polygon) <= smallest {
        return;
    }
    let middle = centroid(polygon);
    for (i, &corner) in polygon.iter().enumerate() {
        let corners = [middle, corner, polygon[(i + 1) % polygon.len()]];
        let size = area(&corners);
        for (l, w) in RULE {
            f([0, 1].map(|c| (0..3).map(|k| l[k] * corners[k][c]).sum()), w * size);
        }
    }
}

/// The centroid of a convex polygon.
fn centroid(polygon: &[PlanePoint]) -> PlanePoint {
    let [o, ref rest @ ..] = *polygon else { return [0.0; 2] };
    let (mut whole, mut moment) = (0.0, [0.0; 2]);
    for pair in rest.windows(2) {
        let size = area(&[o, pair[0], pair[1]]);
        whole += size;
        (0..2).for_each(|c| moment[c] += size / 3.0 * (pair[0][c] - o[c] + pair[1][c] - o[c]));
    }
    [0, 1].map(|c| o[c] + moment[c] / whole)
}

/// Gauss's rules on (0, 1) by their number of points: place and weight.
pub(super) fn gauss_rules() -> &'static [Vec<(f64, f64)>] {
    static RULES: std::sync::OnceLock<Vec<Vec<(f64, f64)>>> = std::sync::OnceLock::new();
    RULES.get_or_init(|| (0..=MOST_POINTS).map(gauss_rule).collect())
}

/// Legendre's polynomial of degree n has its zeros near cos(pi (i + 3/4)/(n + 1/2)).
fn gauss_rule(n: usize) -> Vec<(f64, f64)> {
    let point = |i: usize| {
        let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..20 {
            let (mut p, mut before) = (1.0, 0.0);
            for k in 1..=n {
                let k = k as f64;
                (p, before) = (((2.0 * k - 1.0) * x * p - (k - 1.0) * before) / k, p);
            }
            slope = n as f64 * (x * p - before) / (x * x - 1.0);
            x -= p / slope;
        }
        (0.5 * (1.0 + x), 1.0 / ((1.0 - x * x) * slope * slope))
    };
    (0..n).map(point).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whichever corner is named first, and where one stands twice but for rounding: the same sum
    /// of what no rule integrates exactly.
    #[test]
    fn a_rule_knows_no_first_corner() {
        let polygon = [[0.0, 0.0], [1.0, 0.1], [1.2, 0.9], [0.3, 1.1]];
        let sum = |polygon: &[PlanePoint]| {
            let mut sum = 0.0;
            each_point(polygon, 0.0, |[x, y], weight| sum += weight / (0.3 + x * y));
            sum
        };
        let from_first = sum(&polygon);
        for first in 1..4 {
            let mut turned = polygon;
            turned.rotate_left(first);
            assert!((sum(&turned) - from_first).abs() < 1e-14);
        }
        assert!((sum(&[[1e-15, 1e-16], [1.0, 0.1], [1.2, 0.9], [0.3, 1.1], [0.0, 0.0]]) - from_first).abs() < 1e-13);
        // Moments up to the second degree are exact.
        let mut whole = [0.0; 2];
        each_point(&[[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]], 0.0, |[x, y], weight| {
            whole[0] += weight;
            whole[1] += weight * x * y;
        });
        assert!((whole[0] - 2.0).abs() < 1e-14 && (whole[1] - 1.0).abs() < 1e-14, "{whole:?}");
    }
}

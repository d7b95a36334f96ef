//! A quantity between scattered points: linear in Delaunay's triangles, drawn as the areas above
//! its levels.

use std::collections::BTreeSet;

use delaunator::{Point, triangulate};

use super::canvas::Pixel;

/// A corner of an area: point `i` as (i, i), or the place between points i < j as (i, j).
type Corner = (usize, usize);

/// Points and the triangles between them.
#[derive(Clone, Debug)]
pub struct TriangleMesh {
    places: Vec<Pixel>,
    triangles: Vec<[usize; 3]>,
}

impl TriangleMesh {
    /// Of points in the plane; without triangles if there are none.
    pub fn new(places: Vec<Pixel>) -> Self {
        let points: Vec<Point> = places.iter().map(|&(x, y)| Point { x, y }).collect();
        let corners = if points.len() < 3 { Vec::new() } else { triangulate(&points).triangles };
        let triangles = corners.chunks_exact(3).map(|three| [three[0], three[1], three[2]]).collect();
        Self { places, triangles }
    }

    /// The borders of where a quantity is at least `level`. Between a point above it and a point
    /// below it the border is where the quantity, linear between the two, has that level; towards a
    /// point without a value (not a number) it is halfway.
    pub fn at_least(&self, values: &[f64], level: f64) -> Vec<Vec<Pixel>> {
        let above = |i: usize| values[i] >= level;
        // Each triangle's part of the area, counterclockwise or clockwise as all of them; where two
        // parts meet, their edges cancel.
        let mut edges: BTreeSet<(Corner, Corner)> = BTreeSet::new();
        for triangle in &self.triangles {
            let mut corners: Vec<Corner> = Vec::with_capacity(4);
            for (&from, &to) in triangle.iter().zip(triangle.iter().cycle().skip(1)) {
                if above(from) {
                    corners.push((from, from));
                }
                if above(from) != above(to) {
                    corners.push((from.min(to), from.max(to)));
                }
            }
            for (&from, &to) in corners.iter().zip(corners.iter().cycle().skip(1)) {
                if from != to && !edges.remove(&(to, from)) {
                    edges.insert((from, to));
                }
            }
        }
        let mut loops = Vec::new();
        while let Some((first, mut next)) = edges.pop_first() {
            let mut corners = vec![first];
            while next != first {
                corners.push(next);
                let follows = edges.range((next, (0, 0))..=(next, (usize::MAX, usize::MAX))).next().copied();
                let Some(edge) = follows else { break };
                edges.remove(&edge);
                next = edge.1;
            }
            loops.push(corners.into_iter().map(|corner| self.place(values, level, corner)).collect());
        }
        loops
    }

    fn place(&self, values: &[f64], level: f64, (i, j): Corner) -> Pixel {
        if i == j {
            return self.places[i];
        }
        let share = (level - values[i]) / (values[j] - values[i]);
        let share = if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.5 };
        let (a, b) = (self.places[i], self.places[j]);
        (a.0 + share * (b.0 - a.0), a.1 + share * (b.1 - a.1))
    }
}

/// The part of a closed line inside of a rectangle (Sutherland & Hodgman 1974).
pub fn clipped(points: &[Pixel], [low, high]: [Pixel; 2]) -> Vec<Pixel> {
    let mut points = points.to_vec();
    type ClipSide = (fn(Pixel) -> f64, f64, f64);
    let sides: [ClipSide; 4] = [(|p| p.0, low.0, 1.0), (|p| p.0, high.0, -1.0), (|p| p.1, low.1, 1.0), (|p| p.1, high.1, -1.0)];
    for (of, limit, sign) in sides {
        let inside = |p: Pixel| sign * (of(p) - limit);
        let mut kept = Vec::with_capacity(points.len());
        for (i, &to) in points.iter().enumerate() {
            let from = points[(i + points.len() - 1) % points.len()];
            let (before, after) = (inside(from), inside(to));
            if (before < 0.0) != (after < 0.0) {
                let share = before / (before - after);
                kept.push((from.0 + share * (to.0 - from.0), from.1 + share * (to.1 - from.1)));
            }
            if after >= 0.0 {
                kept.push(to);
            }
        }
        points = kept;
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(points: &[Pixel]) -> f64 {
        let cross = |(a, b): (&Pixel, &Pixel)| a.0 * b.1 - b.0 * a.1;
        0.5 * points.iter().zip(points.iter().cycle().skip(1)).map(cross).sum::<f64>()
    }

    /// A grid of n by n points over the unit square.
    fn grid(n: usize) -> Vec<Pixel> {
        let at = |i: usize| i as f64 / (n - 1) as f64;
        (0..n * n).map(|i| (at(i % n), at(i / n))).collect()
    }

    #[test]
    fn a_linear_field_has_straight_levels_and_exact_areas() {
        let places = grid(7);
        let values: Vec<f64> = places.iter().map(|p| p.0 + 0.5 * p.1).collect();
        let field = TriangleMesh::new(places);
        // x + y/2 >= 0.6 leaves a trapezium below it of width 0.6 to 0.1.
        let loops = field.at_least(&values, 0.6);
        assert_eq!(loops.len(), 1);
        assert!((area(&loops[0]).abs() - 0.65).abs() < 1e-12, "{loops:?}");
        assert!((area(&field.at_least(&values, -1.0)[0]).abs() - 1.0).abs() < 1e-12);
        assert!(field.at_least(&values, 2.0).is_empty());
    }

    #[test]
    fn an_area_may_have_holes_and_end_halfway_to_what_has_no_value() {
        let places = grid(5);
        let mut values = vec![1.0; 25];
        values[12] = f64::NAN;
        let loops = TriangleMesh::new(places).at_least(&values, 0.5);
        assert_eq!(loops.len(), 2);
        let areas: Vec<f64> = loops.iter().map(|points| area(points)).collect();
        // The hole runs the other way round, and lies within half a spacing of its point.
        assert!(areas[0] * areas[1] < 0.0, "{areas:?}");
        let hole = areas.iter().map(|area| area.abs()).fold(f64::INFINITY, f64::min);
        assert!(hole > 0.5 * 0.125 * 0.25 && hole < 0.25 * 0.25, "{hole}");
    }

    #[test]
    fn too_few_points_have_no_area_and_lines_end_at_the_rectangle() {
        for places in [vec![], vec![(0.0, 0.0)], vec![(0.0, 0.0), (1.0, 1.0), (2.0, 2.0)]] {
            let values = vec![1.0; places.len()];
            assert!(TriangleMesh::new(places).at_least(&values, 0.5).is_empty());
        }
        let square = clipped(&[(-1.0, -1.0), (3.0, -1.0), (3.0, 3.0), (-1.0, 3.0)], [(0.0, 0.0), (2.0, 1.0)]);
        assert!((area(&square).abs() - 2.0).abs() < 1e-12, "{square:?}");
        assert!(clipped(&[(5.0, 5.0), (6.0, 5.0), (6.0, 6.0)], [(0.0, 0.0), (2.0, 1.0)]).is_empty());
    }
}

//! Mortar integrals between a surface and its own image, inverted in the origin: seen along z, (x,
//! y) goes to (-x, -y).
//!
//! Unlike under the half turn (see [`super::mortar`]) no line is its own image: across x = 0 the
//! interface goes on at -y. Which nodes are slaves is therefore chosen so that slaves and images of
//! slaves together are spread over the interface as the nodes of one surface are. Where slaves face
//! nothing but masters their functions are dual (Wohlmuth, SIAM J. Numer. Anal. 38, 2000). Between
//! slaves and images of slaves each side has its share of the interface, by the shape functions of
//! its slaves there, and functions that are dual on that share; those of nodes that are no slaves
//! go to the images of slaves that they face. All functions add up to one everywhere.

use super::mortar::{COVERED, Face, FaceGrid, GapWeights, SLIVER, add, dual_functions};
use super::polygon::{PlanePoint, area, clip, each_point, gauss_rules};

/// A node is a slave only so far from the images of others, in elements. Meshes that lie half an
/// element beside their image along the seam would else have twice the slaves there. Half and twice
/// of this and of the numbers below, on pairs sheared along both axes: `benches/constants`.
const SEPARATION: f64 = 0.6;
/// Beyond x = 0 by so many elements there are slaves still, and up to there, on the other side,
/// nodes that are none.
const BEYOND: f64 = 0.75;
const WITHIN: f64 = 1.5;
/// Of two nodes that are each other's image, the one further along y is the slave.
const TILT: f64 = 0.01;
/// Least sum of the shape functions of slaves and images of slaves at a point.
const THIN: f64 = 0.2;
/// Points along an edge of a triangle where functions are quotients: a sum that falls to a third
/// over it leaves 3^-12.
const OF_QUOTIENTS: usize = 6;

/// Calls `f` with the points and weights of a product of Gauss's rules over a convex polygon.
fn finely(polygon: &[PlanePoint], smallest: f64, mut f: impl FnMut(PlanePoint, f64)) {
    if polygon.len() < 3 || area(polygon) <= smallest {
        return;
    }
    for i in 1..polygon.len() - 1 {
        let corners = [polygon[0], polygon[i], polygon[i + 1]];
        let size = area(&corners);
        for &(u, wu) in &gauss_rules()[OF_QUOTIENTS] {
            for &(v, wv) in &gauss_rules()[OF_QUOTIENTS] {
                let l = [1.0 - u, u * (1.0 - v), u * v];
                f([0, 1].map(|c| (0..3).map(|k| l[k] * corners[k][c]).sum()), 2.0 * size * u * wu * wv);
            }
        }
    }
}

/// Which nodes are slaves, from their positions in the plane and their sizes: those at x > 0, and
/// near x = 0 one of each two that face each other.
fn slaves(points: &[PlanePoint], size: &[f64]) -> Vec<bool> {
    let key = |n: usize| points[n][0] + TILT * points[n][1];
    let mut near: Vec<usize> = (0..points.len()).filter(|&n| key(n).abs() < WITHIN * size[n]).collect();
    near.sort_by(|&i, &j| key(j).total_cmp(&key(i)).then(i.cmp(&j)));
    let mut is_slave: Vec<bool> = (0..points.len()).map(|n| key(n) >= WITHIN * size[n]).collect();
    // Of those further in, the ones whose images lie near.
    let mut taken: Vec<usize> = (0..points.len()).filter(|&n| is_slave[n] && key(n) < 3.0 * WITHIN * size[n]).collect();
    for n in near {
        let faces = |&m: &usize| {
            let apart = (points[n][0] + points[m][0]).hypot(points[n][1] + points[m][1]);
            apart < SEPARATION * size[n].min(size[m])
        };
        if key(n) >= -BEYOND * size[n] && !taken.iter().any(faces) {
            is_slave[n] = true;
            taken.push(n);
        }
    }
    is_slave
}

/// The images of slaves around a place and their shares of it, which add up to one; none if there
/// are none among the images `near`.
fn heirs(place: PlanePoint, near: &[usize], images: &[Face], is_slave: &[bool]) -> Vec<(usize, f64)> {
    for &m in near {
        let shape = images[m].shape(place);
        if shape.iter().any(|n| *n < -1e-6) {
            continue;
        }
        let slaves = || shape.into_iter().zip(images[m].nodes).filter(|(n, node)| is_slave[*node] && *n > 0.0);
        let sum: f64 = slaves().map(|(n, _)| n).sum();
        if sum > 0.0 {
            return slaves().map(|(n, node)| (node, n / sum)).collect();
        }
    }
    Vec::new()
}

/// The weights of all slave nodes whose faces meet the image; arguments as of
/// [`super::mortar::self_image_weights`].
pub fn inverted_image_weights(points: &[PlanePoint], faces: &[[usize; 4]], size: &[f64]) -> Vec<GapWeights> {
    let is_slave = slaves(points, size);
    let images: Vec<Face> = faces.iter().map(|f| Face::new(f.map(|n| points[n].map(|x| -x)), *f)).collect();
    let grid = FaceGrid::new(&images);
    let mut own: Vec<Vec<(usize, f64)>> = vec![Vec::new(); points.len()];
    let mut image = own.clone();
    for nodes in faces.iter().filter(|nodes| nodes.iter().any(|&n| is_slave[n])) {
        let face = Face::new(nodes.map(|n| points[n]), *nodes);
        let taken = face.nodes.map(|n| is_slave[n]);
        let near = grid.near(&face);
        let parts: Vec<(usize, Vec<PlanePoint>)> = near.iter().map(|&m| (m, clip(&face.corners, &images[m].corners))).collect();
        let is_met = |part: &(usize, Vec<PlanePoint>)| part.1.len() > 2 && area(&part.1) > SLIVER * face.area;
        let meets_slaves = parts.iter().filter(|part| is_met(part)).any(|part| images[part.0].nodes.iter().any(|&n| is_slave[n]));
        let is_plain = taken == [true; 4] && !meets_slaves;
        // Every point of the rule: weight, shape functions of the face and of the image, the
        // image's index.
        let mut rule: Vec<(f64, [f64; 4], [f64; 4], usize)> = Vec::new();
        for (m, polygon) in &parts {
            if is_plain {
                each_point(polygon, SLIVER * face.area, |x, weight| rule.push((weight, face.shape(x), images[*m].shape(x), *m)));
                continue;
            }
            let of_slaves = |shape: &[f64; 4], nodes: &[usize; 4]| -> f64 {
                shape.iter().zip(nodes).filter(|(_, n)| is_slave[**n]).map(|(shape, _)| shape).sum()
            };
            finely(polygon, SLIVER * face.area, |x, weight| {
                let (shape, other) = (face.shape(x), images[*m].shape(x));
                let share = of_slaves(&shape, &face.nodes);
                let all = share + of_slaves(&other, &images[*m].nodes);
                rule.push((weight * share / all.max(THIN), shape, other, *m));
            });
        }
        let is_covered = rule.iter().map(|p| p.0).sum::<f64>() > COVERED * face.area;
        if rule.is_empty() {
            continue;
        }
        // By the same points, so that orthogonality holds as they integrate it.
        let by_rule = is_covered || !is_plain;
        let psi = if by_rule {
            dual_functions(|f| rule.iter().for_each(|p| f(p.1, p.0)))
        } else {
            dual_functions(|f| face.integrate(f))
        };
        let integrals: [f64; 4] =
            if by_rule { std::array::from_fn(|a| rule.iter().map(|p| p.0 * p.1[a]).sum()) } else { face.shape_integrals() };
        for (a, &node) in face.nodes.iter().enumerate() {
            let mut opposite: Vec<(usize, f64)> = Vec::new();
            for (weight, n, other, m) in &rule {
                let value = weight * (0..4).map(|b| psi[a][b] * n[b]).sum::<f64>();
                (0..4).for_each(|b| add(&mut opposite, images[*m].nodes[b], value * other[b]));
            }
            if is_slave[node] {
                add(&mut own[node], node, integrals[a]);
                opposite.iter().for_each(|&(m, w)| add(&mut image[node], m, w));
                continue;
            }
            // Seen from the heirs, this face is the image.
            for (heir, share) in heirs(points[node], &near, &images, &is_slave) {
                add(&mut image[heir], node, share * integrals[a]);
                opposite.iter().for_each(|&(m, w)| add(&mut own[heir], m, share * w));
            }
        }
    }
    let rows = (0..points.len()).filter(|&n| is_slave[n]).filter_map(|n| {
        let sum = |entries: &[(usize, f64)]| entries.iter().map(|e| e.1).sum::<f64>();
        let (area, faced) = (sum(&own[n]), sum(&image[n]));
        let normalised = |entries: &[(usize, f64)], by: f64| -> Vec<(usize, f64)> {
            entries.iter().map(|&(m, w)| (m, w / by)).filter(|(_, w)| w.abs() > 1e-12).collect()
        };
        let (own, image) = (normalised(&own[n], area), normalised(&image[n], faced));
        (area > 0.0 && faced > 0.0).then_some(GapWeights { slave: n, own, image, area, at_seam: false })
    });
    rows.collect()
}

#[cfg(test)]
mod tests {
    use super::super::mortar::under_pressure;
    use super::*;

    /// A patch that is its own mirror image in x and in y, its lines bent, moved by `shift`.
    fn patch(shift: PlanePoint) -> (Vec<PlanePoint>, Vec<[usize; 4]>) {
        let n = 12;
        let at = |i: usize, j: usize| i + (n + 1) * j;
        let place = |i: usize, j: usize| {
            let (x, y) = (i as f64 / 4.0 - 1.5, j as f64 / 4.0 - 1.5);
            [x * (1.0 + 0.1 * (1.5 * y).cos()) + shift[0], y * (1.0 + 0.08 * (2.0 * x).cos()) + shift[1]]
        };
        let points = (0..=n).flat_map(|j| (0..=n).map(move |i| place(i, j))).collect();
        let faces = (0..n).flat_map(|j| (0..n).map(move |i| [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)]));
        (points, faces.collect())
    }

    const SHIFTS: [PlanePoint; 9] = [
        [0.0, 0.0],
        [0.0375, 0.0],
        [0.0, 0.0625],
        [0.07, 0.07],
        [0.06, -0.03],
        [0.125, 0.01],
        [0.19, 0.125],
        [0.25, 0.04],
        [0.21, -0.2],
    ];

    #[test]
    fn without_slip_half_of_the_nodes_face_their_images_alone() {
        let (points, faces) = patch([0.0; 2]);
        let rows = inverted_image_weights(&points, &faces, &vec![0.25; points.len()]);
        // The middle faces itself.
        assert_eq!(rows.len(), points.len().div_ceil(2));
        for row in rows.iter() {
            let facing = |m: usize| (points[m][0] + points[row.slave][0]).hypot(points[m][1] + points[row.slave][1]) < 1e-12;
            let is_own = |m: usize| f64::from(u8::from(m == row.slave));
            assert!(row.own.iter().all(|&(m, w)| (w - is_own(m)).abs() < 1e-10), "{row:?}");
            assert!(row.image.iter().all(|&(m, w)| (w - f64::from(u8::from(facing(m)))).abs() < 1e-10), "{row:?}");
        }
    }

    #[test]
    fn uniform_pressure_goes_through_the_interface() {
        for shift in SHIFTS {
            let (points, faces) = patch(shift);
            let rows = inverted_image_weights(&points, &faces, &vec![0.25; points.len()]);
            let (force, area) = under_pressure(&points, &faces, &rows);
            // Near the rim there are faces without an image.
            let inner = |p: &PlanePoint| p[0].abs() < 0.85 - shift[0].abs() && p[1].abs() < 0.85 - shift[1].abs();
            assert!(points.iter().filter(|p| inner(p)).count() > 15);
            for (n, p) in points.iter().enumerate().filter(|(_, p)| inner(p)) {
                let off = (force[n] - area[n]) / area[n];
                // What quotients are integrated to.
                assert!(off.abs() < 5e-4, "shift {shift:?}, node {n} at {p:?}: {off:.2e}");
            }
        }
    }
}

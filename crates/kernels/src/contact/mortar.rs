//! Mortar integrals between two surfaces: those of two bodies, or a surface and its own image,
//! turned half round the y axis: (x, y, z) goes to (-x, y, -z).
//!
//! Of an equal pair one body is meshed; the other is its image. The interface, seen along z, is
//! halved at x = 0: on x >= 0 the body's own surface is the slave and the image of its surface at x
//! <= 0 the master. For every slave node i the gap is weighted with a dual function psi_i
//! (Wohlmuth, SIAM J. Numer. Anal. 38, 2000): on a face wholly at x >= 0 psi_i is orthogonal to the
//! shape functions of the other nodes. A face that the seam x = 0 cuts has shape functions for psi,
//! those of its nodes that are no slaves added to those that are, so that the psi of all slaves add
//! up to one everywhere. Faces are clipped against the image's faces (Sutherland & Hodgman, Commun.
//! ACM 17, 1974; see `polygon`) and integrated triangle by triangle.

use super::polygon::{MOST_POINTS, PlanePoint, area, clip, clip_at_seam, each_point, gauss_rules};

/// What the nodes of both sides contribute to the weighted gap of one slave node. The weights of
/// each side add up to one.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GapWeights {
    /// The slave node.
    pub slave: usize,
    /// Nodes of the surface itself, and their weights.
    pub own: Vec<(usize, f64)>,
    /// Nodes whose images face it, and their weights.
    pub image: Vec<(usize, f64)>,
    /// Area of the interface that belongs to it.
    pub area: f64,
    /// The node is closer to the seam than half an element, or faces its own image.
    pub at_seam: bool,
}

/// A face is covered by the image, but for the mesh's rim, from this share of its area on. Half and
/// twice of this and of the numbers below, on pairs that slide past the seam: `benches/constants`.
pub(super) const COVERED: f64 = 0.99;
/// A face of which the seam leaves less than this share has no dual functions of its own.
const NARROW: f64 = 0.6;
/// A node that is so much of its size beyond the seam is still a slave: its faces reach far enough
/// to this side.
const MARGIN: f64 = 0.25;
/// Triangles and faces of less than this share of a face's area count as nothing.
pub(super) const SLIVER: f64 = 1e-9;
/// A node that faces its own image with more than this weight lies on the seam.
const OWN_IMAGE: f64 = 0.25;

/// The weights of all slave nodes: those at x >= 0, or not far beyond the seam for their `size`,
/// whose faces meet the image. `points` are the positions of the surface's nodes in the plane,
/// `faces` its quadrilaterals (either sense of rotation), `tolerance` the distance to the seam that
/// counts as none.
pub fn self_image_weights(points: &[PlanePoint], faces: &[[usize; 4]], size: &[f64], tolerance: f64) -> Vec<GapWeights> {
    let is_slave = |n: usize| points[n][0] >= -MARGIN * size[n];
    let images: Vec<Face> = faces.iter().map(|f| Face::new(f.map(|n| [-points[n][0], points[n][1]]), *f)).collect();
    let grid = FaceGrid::new(&images);
    let mut own: Vec<Vec<(usize, f64)>> = vec![Vec::new(); points.len()];
    let mut image = own.clone();
    for nodes in faces {
        if !nodes.iter().any(|&n| points[n][0] > tolerance) {
            continue;
        }
        let cut = nodes.iter().any(|&n| points[n][0] < -tolerance);
        let face = Face::new(nodes.map(|n| points[n]), *nodes);
        // Every point of the rule: weight, shape functions of the face and of the image, the
        // image's index.
        let mut rule: Vec<(f64, [f64; 4], [f64; 4], usize)> = Vec::new();
        for &m in &grid.near(&face) {
            let polygon = clip_at_seam(clip(&face.corners, &images[m].corners));
            each_point(&polygon, SLIVER * face.area, |x, weight| rule.push((weight, face.shape(x), images[m].shape(x), m)));
        }
        let share = rule.iter().map(|p| p.0).sum::<f64>() / face.area;
        // What the seam leaves of a face of slaves has dual functions too, as long as it is not too
        // narrow for them.
        let by_rule = if cut { share > NARROW && nodes.iter().all(|&n| is_slave(n)) } else { share > COVERED };
        let psi = match (by_rule, cut) {
            // By the same points, so that orthogonality holds as they integrate it.
            (true, _) => dual_functions(|f| rule.iter().for_each(|p| f(p.1, p.0))),
            (false, true) => seam_functions(&face, &is_slave),
            (false, false) => dual_functions(|f| face.integrate(f)),
        };
        for (weight, n, other, m) in &rule {
            for a in 0..4 {
                let value = weight * (0..4).map(|b| psi[a][b] * n[b]).sum::<f64>();
                if value == 0.0 {
                    continue;
                }
                for b in 0..4 {
                    add(&mut image[face.nodes[a]], images[*m].nodes[b], value * other[b]);
                    if cut && !by_rule {
                        add(&mut own[face.nodes[a]], face.nodes[b], value * n[b]);
                    }
                }
            }
        }
        if by_rule || !cut {
            // Biorthogonal: the integral of psi_i times any shape function but its own is zero.
            for a in 0..4 {
                let integral = if by_rule { rule.iter().map(|p| p.0 * p.1[a]).sum() } else { face.shape_integrals()[a] };
                add(&mut own[face.nodes[a]], face.nodes[a], integral);
            }
        }
    }
    let mut rows = Vec::new();
    for n in (0..points.len()).filter(|&n| is_slave(n)) {
        let sum = |entries: &[(usize, f64)]| entries.iter().map(|e| e.1).sum::<f64>();
        let (area, faced) = (sum(&own[n]), sum(&image[n]));
        if !(area > 0.0) || !(faced > 0.0) {
            continue;
        }
        let normalised = |entries: &[(usize, f64)], by: f64| -> Vec<(usize, f64)> {
            entries.iter().map(|&(m, w)| (m, w / by)).filter(|(_, w)| w.abs() > 1e-12).collect()
        };
        let (own, image) = (normalised(&own[n], area), normalised(&image[n], faced));
        let itself = image.iter().find(|e| e.0 == n).map_or(0.0, |e| e.1);
        rows.push(GapWeights { slave: n, own, image, area, at_seam: points[n][0] < 0.5 * size[n] || itself > OWN_IMAGE });
    }
    rows
}

/// A surface seen in the plane: positions of its nodes, and its quadrilaterals (either sense of
/// rotation).
#[derive(Clone, Copy, Debug)]
pub struct Surface<'a> {
    /// Positions of the nodes.
    pub points: &'a [PlanePoint],
    /// Nodes of each face.
    pub faces: &'a [[usize; 4]],
}

/// The weights of the slave nodes of one surface against another one: of those whose faces are all
/// covered by it. `own` is the node itself with the weight one, `image` are nodes of the master.
pub fn weights_between(slave: Surface<'_>, master: Surface<'_>) -> Vec<GapWeights> {
    let facing = |s: Surface<'_>| -> Vec<Face> { s.faces.iter().map(|f| Face::new(f.map(|n| s.points[n]), *f)).collect() };
    let others = facing(master);
    let grid = FaceGrid::new(&others);
    let mut area = vec![0.0; slave.points.len()];
    let mut covered = vec![true; slave.points.len()];
    let mut touched = vec![false; slave.points.len()];
    let mut faced: Vec<Vec<(usize, f64)>> = vec![Vec::new(); slave.points.len()];
    for face in facing(slave) {
        face.nodes.iter().for_each(|&n| touched[n] = true);
        // Integrals of the shape functions by each other: of this face, and with those of each
        // that it meets.
        let mut mass = [[0.0; 4]; 4];
        let mut mixed: Vec<(usize, [[f64; 4]; 4])> = Vec::new();
        for &m in &grid.near(&face) {
            let polygon = clip(&face.corners, &others[m].corners);
            let mut with = [[0.0; 4]; 4];
            let mut met = false;
            exactly(&polygon, SLIVER * face.area, [&face, &others[m]], |weight, [own, other]| {
                met = true;
                for a in 0..4 {
                    let value = weight * own[a];
                    for b in 0..4 {
                        mass[a][b] += value * own[b];
                        with[a][b] += value * other[b];
                    }
                }
            });
            if met {
                mixed.push((m, with));
            }
        }
        // Shape functions add up to one.
        let integrals = mass.map(|row| row.iter().sum::<f64>());
        if !(integrals.iter().sum::<f64>() > COVERED * face.area) {
            face.nodes.iter().for_each(|&n| covered[n] = false);
            continue;
        }
        let psi = dual_of(mass);
        for a in 0..4 {
            area[face.nodes[a]] += integrals[a];
            for (m, with) in &mixed {
                for b in 0..4 {
                    let value = (0..4).map(|c| psi[a][c] * with[c][b]).sum();
                    add(&mut faced[face.nodes[a]], others[*m].nodes[b], value);
                }
            }
        }
    }
    let rows = (0..slave.points.len()).filter(|&n| touched[n] && covered[n] && area[n] > 0.0).map(|n| {
        let image = faced[n].iter().map(|&(m, w)| (m, w / area[n])).filter(|(_, w)| w.abs() > 1e-12).collect();
        GapWeights { slave: n, own: vec![(n, 1.0)], image, area: area[n], at_seam: false }
    });
    rows.collect()
}

pub(super) fn add(entries: &mut Vec<(usize, f64)>, node: usize, value: f64) {
    match entries.iter_mut().find(|e| e.0 == node) {
        Some(entry) => entry.1 += value,
        None => entries.push((node, value)),
    }
}

/// The functions of a face that the seam cuts, as rows of coefficients of its shape functions: a
/// node that is no slave leaves its own to the slaves next to it, or to all of them.
fn seam_functions(face: &Face, is_slave: &impl Fn(usize) -> bool) -> [[f64; 4]; 4] {
    let slave = face.nodes.map(is_slave);
    let mut psi = [[0.0; 4]; 4];
    for b in 0..4 {
        if slave[b] {
            psi[b][b] = 1.0;
            continue;
        }
        let next: Vec<usize> = [(b + 1) % 4, (b + 3) % 4].into_iter().filter(|&a| slave[a]).collect();
        let heirs = if next.is_empty() { (0..4).filter(|&a| slave[a]).collect() } else { next };
        for &a in &heirs {
            psi[a][b] = 1.0 / heirs.len() as f64;
        }
    }
    psi
}

/// A quadrilateral of the surface, its corners counter-clockwise.
pub(super) struct Face {
    pub corners: [PlanePoint; 4],
    pub nodes: [usize; 4],
    pub area: f64,
}

impl Face {
    pub fn new(mut corners: [PlanePoint; 4], mut nodes: [usize; 4]) -> Self {
        if area(&corners) < 0.0 {
            corners.swap(1, 3);
            nodes.swap(1, 3);
        }
        Self { area: area(&corners), corners, nodes }
    }

    fn at(&self, [xi, eta]: PlanePoint) -> ([f64; 4], [PlanePoint; 2]) {
        let n = [(1.0 - xi) * (1.0 - eta), (1.0 + xi) * (1.0 - eta), (1.0 + xi) * (1.0 + eta), (1.0 - xi) * (1.0 + eta)]
            .map(|n| 0.25 * n);
        let by = |d: [f64; 4]| [0, 1].map(|i| (0..4).map(|a| 0.25 * d[a] * self.corners[a][i]).sum());
        (n, [by([eta - 1.0, 1.0 - eta, 1.0 + eta, -1.0 - eta]), by([xi - 1.0, -1.0 - xi, 1.0 + xi, 1.0 - xi])])
    }

    /// Shape functions at a point of the plane.
    pub fn shape(&self, x: PlanePoint) -> [f64; 4] {
        self.at(self.local(x, [0.0; 2])).0
    }

    /// Coordinates on the face of a point of the plane, from -1 to 1: the bilinear map inverted by
    /// Newton's iteration from a guess.
    fn local(&self, x: PlanePoint, mut local: PlanePoint) -> PlanePoint {
        for _ in 0..20 {
            let (n, [a, b]) = self.at(local);
            let r = [0, 1].map(|i| x[i] - (0..4).map(|c| n[c] * self.corners[c][i]).sum::<f64>());
            let det = a[0] * b[1] - a[1] * b[0];
            let step = [(r[0] * b[1] - r[1] * b[0]) / det, (a[0] * r[1] - a[1] * r[0]) / det];
            if !(step[0].is_finite() && step[1].is_finite()) {
                break;
            }
            local = [local[0] + step[0], local[1] + step[1]];
            if step[0].abs() + step[1].abs() < 1e-14 {
                break;
            }
        }
        local
    }

    /// The bilinear map from [-1, 1]^2 by its coefficients of 1, xi, eta and xi eta.
    fn map(&self) -> FaceMap {
        let signs = [[1.0; 4], [-1.0, 1.0, 1.0, -1.0], [-1.0, -1.0, 1.0, 1.0], [1.0, -1.0, 1.0, -1.0]];
        FaceMap(signs.map(|by| [0, 1].map(|i| (0..4).map(|a| 0.25 * by[a] * self.corners[a][i]).sum())))
    }

    /// How many times larger the bilinear map is at one place than at another.
    fn stretch(&self, local: PlanePoint) -> f64 {
        let (_, [a, b]) = self.at(local);
        a[0] * b[1] - a[1] * b[0]
    }

    /// Integrates over the face by Gauss's 3 x 3 rule.
    pub fn integrate(&self, f: &mut dyn FnMut([f64; 4], f64)) {
        let g = 0.6_f64.sqrt();
        for (xi, wx) in [(-g, 5.0 / 9.0), (0.0, 8.0 / 9.0), (g, 5.0 / 9.0)] {
            for (eta, wy) in [(-g, 5.0 / 9.0), (0.0, 8.0 / 9.0), (g, 5.0 / 9.0)] {
                let (n, [a, b]) = self.at([xi, eta]);
                f(n, wx * wy * (a[0] * b[1] - a[1] * b[0]));
            }
        }
    }

    pub fn shape_integrals(&self) -> [f64; 4] {
        let mut sum = [0.0; 4];
        self.integrate(&mut |n, w| (0..4).for_each(|a| sum[a] += w * n[a]));
        sum
    }

    fn bounds(&self) -> [PlanePoint; 2] {
        let fold =
            |f: fn(f64, f64) -> f64| self.corners.iter().skip(1).fold(self.corners[0], |m, c| [f(m[0], c[0]), f(m[1], c[1])]);
        [fold(f64::min), fold(f64::max)]
    }
}

/// See [`Face::map`].
struct FaceMap([PlanePoint; 4]);

impl FaceMap {
    /// Shape functions at a point of the plane, from a guess of its coordinates on the face. Of
    /// Newton's steps each is off by the square of the one before.
    #[inline]
    fn shape(&self, x: PlanePoint, [mut xi, mut eta]: PlanePoint) -> [f64; 4] {
        let Self([middle, along, across, twist]) = self;
        for _ in 0..20 {
            let a = [along[0] + twist[0] * eta, along[1] + twist[1] * eta];
            let b = [across[0] + twist[0] * xi, across[1] + twist[1] * xi];
            let r = [x[0] - middle[0] - a[0] * xi - across[0] * eta, x[1] - middle[1] - a[1] * xi - across[1] * eta];
            let inverse = 1.0 / (a[0] * b[1] - a[1] * b[0]);
            let step = [inverse * (r[0] * b[1] - r[1] * b[0]), inverse * (a[0] * r[1] - a[1] * r[0])];
            if !(step[0].is_finite() && step[1].is_finite()) {
                break;
            }
            xi += step[0];
            eta += step[1];
            if step[0].abs() + step[1].abs() < NEARLY {
                break;
            }
        }
        let (p, q) = ([0.5 * (1.0 - xi), 0.5 * (1.0 + xi)], [0.5 * (1.0 - eta), 0.5 * (1.0 + eta)]);
        [p[0] * q[0], p[1] * q[0], p[1] * q[1], p[0] * q[1]]
    }
}

/// Coefficients A of the dual functions psi_a = sum_b A_ab N_b of a face: A = D M^-1 with M the
/// mass matrix that `integrate` gives and D its row sums.
pub(super) fn dual_functions(integrate: impl FnOnce(&mut dyn FnMut([f64; 4], f64))) -> [[f64; 4]; 4] {
    let mut mass = [[0.0; 4]; 4];
    integrate(&mut |n, w| {
        for a in 0..4 {
            (0..4).for_each(|b| mass[a][b] += w * n[a] * n[b]);
        }
    });
    dual_of(mass)
}

/// The same of a mass matrix.
fn dual_of(mass: [[f64; 4]; 4]) -> [[f64; 4]; 4] {
    let mut m = [[0.0; 8]; 4];
    m.iter_mut().zip(mass).for_each(|(row, of)| row[..4].copy_from_slice(&of));
    let d: [f64; 4] = std::array::from_fn(|a| m[a][..4].iter().sum());
    (0..4).for_each(|a| m[a][4 + a] = 1.0);
    // Gauss and Jordan; a mass matrix needs no pivoting.
    for p in 0..4 {
        let pivot = m[p][p];
        m[p].iter_mut().for_each(|v| *v /= pivot);
        for r in (0..4).filter(|&r| r != p) {
            let factor = m[r][p];
            let row = m[p];
            m[r].iter_mut().zip(row).for_each(|(v, q)| *v -= factor * q);
        }
    }
    std::array::from_fn(|a| std::array::from_fn(|b| d[a] * m[a][4 + b]))
}

/// What integrals over a polygon may be off by, of their value.
const EXACT: f64 = 1e-12;
/// A step of Newton's iteration after which the next would be rounding.
const NEARLY: f64 = 1e-7;

/// Calls `f` with weights and shape functions on both faces at the points of a rule over a convex
/// polygon that lies on them.
///
/// Bilinear shape functions are no polynomials of the position. Gauss's rule with n points is off
/// by rho^-2n where they are analytic in an ellipse of half axes that sum to rho: as large as the
/// unevenness q of the map over a triangle lets it be, 1/rho + rho = 2/q. So each triangle has as
/// many points as its faces' unevenness asks for.
fn exactly(polygon: &[PlanePoint], smallest: f64, faces: [&Face; 2], mut f: impl FnMut(f64, [[f64; 4]; 2])) {
    if polygon.len() < 3 || area(polygon) <= smallest {
        return;
    }
    let maps = faces.map(Face::map);
    let locals: Vec<[PlanePoint; 2]> = polygon.iter().map(|&x| faces.map(|face| face.local(x, [0.0; 2]))).collect();
    for i in 1..polygon.len() - 1 {
        let triangle = [0, i, i + 1];
        let corners = triangle.map(|k| polygon[k]);
        let size = area(&corners);
        if !(size > 0.0) {
            continue;
        }
        let uneven = (0..2).map(|side| {
            let stretch = triangle.map(|k| faces[side].stretch(locals[k][side]));
            let (low, high) = stretch.iter().fold((f64::INFINITY, 0.0_f64), |(l, h), s| (l.min(*s), h.max(*s)));
            ((high - low) / (high + low)).clamp(1e-6, 0.9)
        });
        let q = uneven.fold(0.0, f64::max);
        let rho = (1.0 + (1.0 - q * q).sqrt()) / q;
        // One more for the polynomials that are multiplied with them.
        let n = (-0.5 * EXACT.ln() / rho.ln()).ceil() as usize + 2;
        let rule = &gauss_rules()[n.min(MOST_POINTS)];
        let guesses = [0, 1].map(|side| triangle.map(|k| locals[k][side]));
        for &(u, wu) in rule {
            for &(v, wv) in rule {
                let l = [1.0 - u, u * (1.0 - v), u * v];
                let mean = |p: &[PlanePoint; 3]| [0, 1].map(|c| l[0] * p[0][c] + l[1] * p[1][c] + l[2] * p[2][c]);
                let x = mean(&corners);
                let shapes = [maps[0].shape(x, mean(&guesses[0])), maps[1].shape(x, mean(&guesses[1]))];
                f(2.0 * size * u * wu * wv, shapes);
            }
        }
    }
}

/// Faces by the cells of a regular grid that their bounds touch.
pub(super) struct FaceGrid {
    origin: PlanePoint,
    cell: f64,
    size: [usize; 2],
    faces: Vec<Vec<usize>>,
}

impl FaceGrid {
    pub fn new(faces: &[Face]) -> Self {
        let bounds: Vec<[PlanePoint; 2]> = faces.iter().map(Face::bounds).collect();
        let low = bounds.iter().fold([f64::INFINITY; 2], |m, b| [m[0].min(b[0][0]), m[1].min(b[0][1])]);
        let high = bounds.iter().fold([f64::NEG_INFINITY; 2], |m, b| [m[0].max(b[1][0]), m[1].max(b[1][1])]);
        let extent = (high[0] - low[0]).max(high[1] - low[1]).max(f64::MIN_POSITIVE);
        let cell = extent / (faces.len() as f64).sqrt().max(1.0);
        let size = [0, 1].map(|c| ((high[c] - low[c]) / cell) as usize + 1);
        let mut grid = Self { origin: low, cell, size, faces: vec![Vec::new(); size[0] * size[1]] };
        for (f, b) in bounds.iter().enumerate() {
            for c in grid.cells(b) {
                grid.faces[c].push(f);
            }
        }
        grid
    }

    fn cells(&self, [low, high]: &[PlanePoint; 2]) -> Vec<usize> {
        let index = |x: f64, c: usize| (((x - self.origin[c]) / self.cell).max(0.0) as usize).min(self.size[c] - 1);
        let [i0, i1] = [index(low[0], 0), index(high[0], 0)];
        let [j0, j1] = [index(low[1], 1), index(high[1], 1)];
        (j0..=j1).flat_map(|j| (i0..=i1).map(move |i| i + self.size[0] * j)).collect()
    }

    /// Faces whose cells the bounds of `face` touch, in increasing order.
    pub fn near(&self, face: &Face) -> Vec<usize> {
        let mut found: Vec<usize> = self.cells(&face.bounds()).into_iter().flat_map(|c| self.faces[c].iter().copied()).collect();
        found.sort_unstable();
        found.dedup();
        found
    }
}

/// What each node gets of a uniform pressure, as slave and as master, and its share of the area.
#[cfg(test)]
pub(super) fn under_pressure(points: &[PlanePoint], faces: &[[usize; 4]], rows: &[GapWeights]) -> (Vec<f64>, Vec<f64>) {
    let (mut force, mut area) = (vec![0.0; points.len()], vec![0.0; points.len()]);
    for row in rows {
        row.own.iter().for_each(|&(m, w)| force[m] += row.area * w);
        row.image.iter().for_each(|&(m, w)| force[m] += row.area * w);
    }
    for nodes in faces {
        let face = Face::new(nodes.map(|n| points[n]), *nodes);
        face.shape_integrals().into_iter().zip(face.nodes).for_each(|(s, n)| area[n] += s);
    }
    (force, area)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A patch symmetric in x, its lines bent, moved by `shift` along x.
    fn patch(shift: f64) -> (Vec<PlanePoint>, Vec<[usize; 4]>) {
        let (nx, ny) = (8, 4);
        let mut points = Vec::new();
        for j in 0..=ny {
            for i in 0..=nx {
                let (x, y) = (i as f64 / 4.0 - 1.0, j as f64 / 4.0);
                points.push([x * (1.0 + 0.1 * (3.0 * y).sin()) + shift, y * (1.0 + 0.08 * (2.0 * x).cos())]);
            }
        }
        let at = |i: usize, j: usize| i + (nx + 1) * j;
        let faces = (0..ny)
            .flat_map(|j| (0..nx).map(move |i| (i, j)))
            .map(|(i, j)| [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)]);
        (points, faces.collect())
    }

    #[test]
    fn a_surface_gives_another_one_its_own_share_of_a_uniform_pressure() {
        // The other one is bent otherwise, and finer.
        let (slave, faces) = patch(0.0);
        let (nx, ny) = (15, 7);
        let bent = |x: f64, y: f64| [x * (1.0 + 0.06 * (2.0 * y).cos()), y * (1.0 + 0.1 * (1.5 * x).sin())];
        let at = |i: usize, j: usize| i + (nx + 1) * j;
        let cells: Vec<[usize; 4]> = (0..ny)
            .flat_map(|j| (0..nx).map(move |i| (i, j)))
            .map(|(i, j)| [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)])
            .collect();
        for shift in [0.0, 0.0375, 0.12, -0.3] {
            let master: Vec<PlanePoint> = (0..=ny)
                .flat_map(|j| (0..=nx).map(move |i| bent(2.4 * i as f64 / nx as f64 - 1.2, 1.2 * j as f64 / ny as f64)))
                .map(|[x, y]| [x + shift, y])
                .collect();
            let rows = weights_between(Surface { points: &slave, faces: &faces }, Surface { points: &master, faces: &cells });
            let mut force = vec![0.0; master.len()];
            for row in &rows {
                assert!((row.image.iter().map(|e| e.1).sum::<f64>() - 1.0).abs() < 1e-12, "{}", row.slave);
                row.image.iter().for_each(|&(m, w)| force[m] += row.area * w);
            }
            let mut area = vec![0.0; master.len()];
            for nodes in &cells {
                let face = Face::new(nodes.map(|n| master[n]), *nodes);
                face.shape_integrals().into_iter().zip(face.nodes).for_each(|(s, n)| area[n] += s);
            }
            let inner = |p: &PlanePoint| p[0].abs() < 0.55 - shift.abs() && p[1] < 0.5;
            assert!(master.iter().any(inner));
            for (n, p) in master.iter().enumerate().filter(|(_, p)| inner(p)) {
                let off = (force[n] - area[n]) / area[n];
                assert!(off.abs() < 1e-8, "shift {shift}, node {n} at {p:?}: {off:.2e}");
            }
        }
    }

    #[test]
    fn without_slip_a_node_faces_its_mirror_image_alone() {
        let (points, faces) = patch(0.0);
        let rows = self_image_weights(&points, &faces, &vec![0.25; points.len()], 1e-9);
        assert_eq!(rows.len(), 5 * 5);
        for row in rows {
            let mirror = (0..points.len())
                .find(|&m| (points[m][0] + points[row.slave][0]).abs() < 1e-12 && points[m][1] == points[row.slave][1])
                .unwrap();
            assert_eq!(row.own, [(row.slave, 1.0)]);
            for (m, w) in &row.image {
                assert!((w - f64::from(u8::from(*m == mirror))).abs() < 1e-10, "{}: {m} {w}", row.slave);
            }
            assert_eq!(row.at_seam, mirror == row.slave);
        }
    }

    #[test]
    fn uniform_pressure_goes_through_the_interface() {
        // What each node gets, as slave and as master, is its own share of the area, wherever the
        // image lies.
        for shift in [0.0375, 0.12, 0.13, -0.07, 0.25] {
            let (points, faces) = patch(shift);
            let rows = self_image_weights(&points, &faces, &vec![0.25; points.len()], 1e-9);
            let (force, area) = under_pressure(&points, &faces, &rows);
            // Near the rim there are faces without an image.
            for (n, p) in points.iter().enumerate().filter(|(_, p)| p[0].abs() < 0.45 - shift.abs() && p[1] < 0.4) {
                let off = (force[n] - area[n]) / area[n];
                assert!(off.abs() < 1e-8, "shift {shift}, node {n} at {p:?}: {off:.2e}");
            }
        }
    }
}

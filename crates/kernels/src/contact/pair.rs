//! How an equal pair meets itself: what the displacements of one body have to do with the gap and
//! the slip between it and its image, turned half round y or inverted in the origin.
//!
//! With R the matrix of that (see [`Image`]) the relative position of slave node i is `w_i = sum_k
//! S_ik x_k - R sum_j M_ij x_j` with the mortar weights S of the body itself and M of its image
//! (see [`super::mortar`] and [`super::inversion`]). Its conditions are those of a point over a
//! plane, in a frame of its own: tangents t_1 (in the plane of x and the normal) and t_2, and the
//! normal n, the mean of the two surfaces'. So the unknowns y of a step are w in these frames at
//! slave nodes and u elsewhere: `u = T y`. The forces that belong to y are `T^T f`: at a slave node
//! the force that the interface carries there, at a master node the body's own and what the image
//! exerts on it, which is nothing together in equilibrium.

use super::frame::{ContactFrame, frame, from_frame, to_frame};
use super::interface::{Interface, inward_normals};
use super::inversion::inverted_image_weights;
use super::maps::PairMaps;
use super::mortar::{GapWeights, self_image_weights};
use crate::mesh::Mesh;
use std::sync::{Arc, OnceLock};

/// Where the other of two equal bodies is: at R x, for every point x of the one that is meshed.
///
/// It moves by R t where that one moves by t, and turns by det(R) R w where that one turns by w. So
/// the two move by t - R t and turn by w - det(R) R w relative to each other: twice what each does
/// in some degrees of freedom, and not at all in the others.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Image {
    /// Turned half round y, R = diag(-1, 1, -1): a press, a shear along x, a roll about x and a
    /// twist.
    #[default]
    HalfTurn,
    /// Inverted in the origin, R = diag(-1, -1, -1): a press and a shear in any direction.
    Inversion,
}

impl Image {
    /// The diagonal of R.
    pub const fn signs(self) -> [f64; 3] {
        match self {
            Self::HalfTurn => [-1.0, 1.0, -1.0],
            Self::Inversion => [-1.0; 3],
        }
    }
}

/// The interface of one step: fixed while it is solved, made anew for the next.
#[derive(Clone, Debug, Default)]
pub struct PairInterface {
    /// Where the other body is.
    pub(super) image: Image,
    /// Slave nodes, by their index among the contact nodes.
    pub slaves: Vec<usize>,
    /// Per contact node: the slave that it is, if it is one.
    pub slave_of: Vec<Option<usize>>,
    /// Per slave: frame [t_1, t_2, n].
    pub frames: Vec<ContactFrame>,
    /// Per contact node: the slave that it has most to do with.
    pub facing: Vec<Option<usize>>,
    /// Nodes of the contact nodes.
    pub(super) nodes: Vec<usize>,
    /// Per slave: coefficients of master nodes (indices among the contact nodes), by component.
    pub(super) masters: Vec<Vec<(usize, [f64; 3])>>,
    /// Per slave: the share of each master's load that is its own; the shares of a master add up to
    /// one.
    pub(super) shares: Vec<Vec<(usize, f64)>>,
    pub(super) seam: Seam,
    /// Per slave: y is not coupled. It is so on the symmetry plane, and on the seam, where there is
    /// no slip along y.
    free_y: Vec<bool>,
    /// Made when they are asked for (see `pair_maps`).
    pub(super) maps: OnceLock<Arc<PairMaps>>,
}

/// Slaves that have to do with other slaves or their own image.
#[derive(Clone, Debug, Default)]
pub(super) struct Seam {
    pub(super) slaves: Vec<usize>,
    /// Their matrices by component, row after row: E, and its inverse.
    pub(super) direct: [Vec<f64>; 3],
    pub(super) inverse: [Vec<f64>; 3],
    /// Per slave of the interface: its position in `slaves`.
    pub(super) position: Vec<Option<usize>>,
}

impl Seam {
    /// From the coefficients of w, row by row, and the slave that each node is.
    fn of(coefficients: &[Vec<(usize, [f64; 3])>], slave_of: &[Option<usize>]) -> Self {
        let plain = |k: usize, row: &[(usize, [f64; 3])]| {
            row.iter().all(|&(j, c)| slave_of[j].is_none_or(|other| other == k && c == [1.0; 3]))
        };
        let mut is_in = vec![false; coefficients.len()];
        for (k, row) in coefficients.iter().enumerate().filter(|(k, row)| !plain(*k, row)) {
            is_in[k] = true;
            row.iter().filter_map(|e| slave_of[e.0]).for_each(|other| is_in[other] = true);
        }
        let slaves: Vec<usize> = (0..is_in.len()).filter(|&k| is_in[k]).collect();
        let mut position = vec![None; is_in.len()];
        slaves.iter().enumerate().for_each(|(g, &k)| position[k] = Some(g));
        let n = slaves.len();
        let direct: [Vec<f64>; 3] = std::array::from_fn(|c| {
            let mut e = vec![0.0; n * n];
            for (g, &k) in slaves.iter().enumerate() {
                for &(j, w) in &coefficients[k] {
                    if let Some(other) = slave_of[j].and_then(|other| position[other]) {
                        e[g * n + other] += w[c];
                    }
                }
            }
            e
        });
        let inverse = std::array::from_fn(|c| invert(&direct[c], n));
        Self { slaves, direct, inverse, position }
    }

    /// The inverse of E, or its transpose, at the seam's slaves.
    fn solve(&self, w: &mut [[f64; 3]], entry: impl Fn(&[f64], usize, usize, usize) -> f64) {
        let n = self.slaves.len();
        let before: Vec<[f64; 3]> = self.slaves.iter().map(|&k| w[k]).collect();
        for (g, &k) in self.slaves.iter().enumerate() {
            w[k] = std::array::from_fn(|c| (0..n).map(|other| entry(&self.inverse[c], n, g, other) * before[other][c]).sum());
        }
    }
}

/// Share of an element that the seam may be off a node. Half and twice of it: `benches/constants`.
const SEAM: f64 = 1e-2;
/// What the plate has moved by less, over the radius, has not moved: a twist alone has a mean of
/// rounding.
const STILL: f64 = 1e-12;

impl PairInterface {
    /// The interface between a body with displacement `u` (three a node) and its image.
    pub fn new(mesh: &Mesh, u: &[f64], image: Image) -> Self {
        let signs = image.signs();
        let nodes: Vec<usize> = mesh.contact_nodes.iter().map(|&n| n as usize).collect();
        let index = |n: u32| mesh.contact_nodes.partition_point(|&c| c < n);
        let faces: Vec<[usize; 4]> = mesh.contact_faces.iter().map(|f| f.map(index)).collect();
        let position = |i: usize| -> [f64; 3] {
            let n = nodes[i];
            std::array::from_fn(|c| mesh.nodes[n][c] + u[3 * n + c])
        };
        let positions: Vec<[f64; 3]> = (0..nodes.len()).map(position).collect();
        let rows = weights(mesh, u, image, &positions, &faces);
        let on_symmetry = |i: usize| mesh.is_on_symmetry_plane(mesh.contact_nodes[i]);
        let up = inward_normals(&positions, &faces);

        let mut slave_of = vec![None; nodes.len()];
        rows.iter().enumerate().for_each(|(k, row)| slave_of[row.slave] = Some(k));
        let free_y: Vec<bool> = rows.iter().map(|row| row.at_seam || on_symmetry(row.slave)).collect();
        let coefficients: Vec<Vec<(usize, [f64; 3])>> =
            rows.iter().zip(&free_y).map(|(row, &free)| combine(row, signs, free)).collect();
        let seam = Seam::of(&coefficients, &slave_of);
        let masters = coefficients.into_iter().map(|row| row.into_iter().filter(|e| slave_of[e.0].is_none()).collect()).collect();
        Self {
            image,
            slaves: rows.iter().map(|row| row.slave).collect(),
            frames: rows.iter().zip(&free_y).map(|(row, &free)| frame(mean_normal(row, &up, signs, free))).collect(),
            facing: facing(&rows, nodes.len()),
            shares: shares(&rows, &slave_of),
            slave_of,
            nodes,
            masters,
            seam,
            free_y,
            maps: OnceLock::new(),
        }
    }

    /// Nodal loads f with T^T f = `v` at all unknowns that are not `fixed`. Where a slave's unknown
    /// is fixed, and so its force any, it takes half of the load that its masters have.
    pub fn loads(&self, v: &[f64], fixed: &[bool], loads: &mut [f64]) {
        let signs = self.image.signs();
        loads.copy_from_slice(v);
        let forces: Vec<[f64; 3]> = (0..self.slaves.len())
            .map(|k| {
                let base = self.base(k);
                let mut half = [0.0; 3];
                for &(j, share) in &self.shares[k] {
                    (0..3).for_each(|c| half[c] += 0.5 * share * signs[c] * v[3 * self.nodes[j] + c]);
                }
                let half = to_frame(&self.frames[k], &half);
                std::array::from_fn(|c| match (fixed[base + c], c == 1 && self.free_y[k]) {
                    (false, _) => v[base + c],
                    (true, true) => 0.0,
                    (true, false) => half[c],
                })
            })
            .collect();
        for &slave in &self.slaves {
            loads[3 * self.nodes[slave]..][..3].fill(0.0);
        }
        for (force, &node) in self.nodal(&forces).iter().zip(&self.nodes) {
            (0..3).for_each(|c| loads[3 * node + c] += force[c]);
        }
    }
}

impl Interface for PairInterface {
    fn slaves(&self) -> &[usize] {
        &self.slaves
    }

    fn facing(&self) -> &[Option<usize>] {
        &self.facing
    }

    fn frames(&self) -> &[ContactFrame] {
        &self.frames
    }

    fn base(&self, k: usize) -> usize {
        3 * self.nodes[self.slaves[k]]
    }

    /// The symmetry plane or the seam sees to it.
    fn is_free_along_y(&self, k: usize) -> bool {
        self.free_y[k]
    }

    fn relative_along_axes(&self, k: usize, x: &[f64]) -> [f64; 3] {
        let at = |node: usize| &x[3 * node..3 * node + 3];
        let mut w = [0.0; 3];
        match self.seam.position[k] {
            None => w.copy_from_slice(at(self.nodes[self.slaves[k]])),
            Some(g) => {
                let n = self.seam.slaves.len();
                for (other, &slave) in self.seam.slaves.iter().enumerate() {
                    let x = at(self.nodes[self.slaves[slave]]);
                    (0..3).for_each(|c| w[c] += self.seam.direct[c][g * n + other] * x[c]);
                }
            }
        }
        for &(j, f) in &self.masters[k] {
            let x = at(self.nodes[j]);
            (0..3).for_each(|c| w[c] += f[c] * x[c]);
        }
        w
    }

    fn expand(&self, y: &mut [f64]) {
        let mut rest: Vec<[f64; 3]> = Vec::with_capacity(self.slaves.len());
        for k in 0..self.slaves.len() {
            let base = self.base(k);
            let mut w = from_frame(&self.frames[k], &[y[base], y[base + 1], y[base + 2]]);
            for &(j, f) in &self.masters[k] {
                let x = 3 * self.nodes[j];
                (0..3).for_each(|c| w[c] -= f[c] * y[x + c]);
            }
            rest.push(w);
        }
        self.seam.solve(&mut rest, |m, n, row, column| m[row * n + column]);
        for (k, w) in rest.into_iter().enumerate() {
            let base = self.base(k);
            y[base..base + 3].copy_from_slice(&w);
        }
    }

    fn reduce(&self, f: &mut [f64]) {
        let mut forces: Vec<[f64; 3]> = (0..self.slaves.len())
            .map(|k| {
                let base = self.base(k);
                [f[base], f[base + 1], f[base + 2]]
            })
            .collect();
        self.seam.solve(&mut forces, |m, n, row, column| m[column * n + row]);
        for (k, force) in forces.into_iter().enumerate() {
            for &(j, w) in &self.masters[k] {
                let x = 3 * self.nodes[j];
                (0..3).for_each(|c| f[x + c] -= w[c] * force[c]);
            }
            let base = self.base(k);
            f[base..base + 3].copy_from_slice(&to_frame(&self.frames[k], &force));
        }
    }

    fn nodal(&self, forces: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let mut nodal = vec![[0.0; 3]; self.nodes.len()];
        let n = self.seam.slaves.len();
        for (k, force) in forces.iter().enumerate() {
            let force = from_frame(&self.frames[k], force);
            match self.seam.position[k] {
                None => (0..3).for_each(|c| nodal[self.slaves[k]][c] += force[c]),
                Some(g) => {
                    for (other, &slave) in self.seam.slaves.iter().enumerate() {
                        (0..3).for_each(|c| nodal[self.slaves[slave]][c] += self.seam.direct[c][g * n + other] * force[c]);
                    }
                }
            }
            for &(j, w) in &self.masters[k] {
                (0..3).for_each(|c| nodal[j][c] += w[c] * force[c]);
            }
        }
        nodal
    }
}

/// The weights of the mortar between a surface, whose contact nodes are at `positions`, and its
/// image.
fn weights(mesh: &Mesh, u: &[f64], image: Image, positions: &[[f64; 3]], faces: &[[usize; 4]]) -> Vec<GapWeights> {
    // The slaves are on the side that trails: contact is lost there node by node, and its edge is
    // found best where nodes are slaves.
    let trailing = |shift: f64| if shift > STILL { -1.0 } else { 1.0 };
    let [along, across] = [0, 1].map(|c| {
        let sum: f64 = mesh.plate_nodes.iter().map(|&n| u[3 * n as usize + c]).sum();
        sum / mesh.plate_nodes.len().max(1) as f64
    });
    match image {
        Image::HalfTurn => {
            let side = trailing(along);
            let plane: Vec<[f64; 2]> = positions.iter().map(|x| [side * x[0], x[1]]).collect();
            let spacing = mesh.contact_size.iter().copied().fold(f64::INFINITY, f64::min);
            self_image_weights(&plane, faces, &mesh.contact_size, SEAM * spacing)
        }
        // The seam is that of the mesh's middle lines which is the more upright on the way: of two
        // that are as upright always the same, whatever the last bits are.
        Image::Inversion if across.abs() > (1.0 + 1e-9) * along.abs() => {
            let side = trailing(across);
            let plane: Vec<[f64; 2]> = positions.iter().map(|x| [side * x[1], x[0]]).collect();
            inverted_image_weights(&plane, faces, &mesh.contact_size)
        }
        Image::Inversion => {
            let side = trailing(along);
            let plane: Vec<[f64; 2]> = positions.iter().map(|x| [side * x[0], x[1]]).collect();
            inverted_image_weights(&plane, faces, &mesh.contact_size)
        }
    }
}

/// The coefficients of w = S x - R M x by node and component. Where y is not coupled it is the
/// slave's own.
fn combine(row: &GapWeights, signs: [f64; 3], free_y: bool) -> Vec<(usize, [f64; 3])> {
    let mut out: Vec<(usize, [f64; 3])> = Vec::new();
    let mut add = |j: usize, by: [f64; 3]| match out.iter_mut().find(|e| e.0 == j) {
        Some(e) => (0..3).for_each(|c| e.1[c] += by[c]),
        None => out.push((j, by)),
    };
    let coupled = if free_y { 0.0 } else { 1.0 };
    for &(j, w) in &row.own {
        add(j, [w, coupled * w, w]);
    }
    for &(j, w) in &row.image {
        add(j, [-signs[0] * w, -signs[1] * coupled * w, -signs[2] * w]);
    }
    if free_y {
        add(row.slave, [0.0, 1.0, 0.0]);
    }
    out.sort_by_key(|e| e.0);
    out
}

/// The slave that each of so many nodes is, or the one in whose image it has the most weight.
fn facing(rows: &[GapWeights], nodes: usize) -> Vec<Option<usize>> {
    let mut facing: Vec<Option<(usize, f64)>> = vec![None; nodes];
    for (k, row) in rows.iter().enumerate() {
        facing[row.slave] = Some((k, f64::INFINITY));
        for &(j, w) in &row.image {
            if facing[j].is_none_or(|(_, most)| w > most) {
                facing[j] = Some((k, w));
            }
        }
    }
    facing.into_iter().map(|f| f.map(|(k, _)| k)).collect()
}

/// The mean of the two surfaces' normals at a slave, of `up` at each node; without a part along y
/// where y is not coupled.
fn mean_normal(row: &GapWeights, up: &[[f64; 3]], signs: [f64; 3], free_y: bool) -> [f64; 3] {
    let mut normal = [0.0; 3];
    for &(j, w) in &row.own {
        (0..3).for_each(|c| normal[c] += w * up[j][c]);
    }
    for &(j, w) in &row.image {
        (0..3).for_each(|c| normal[c] -= w * signs[c] * up[j][c]);
    }
    if free_y {
        normal[1] = 0.0;
    }
    normal
}

/// Per slave: the share of each master's load that is its own.
fn shares(rows: &[GapWeights], slave_of: &[Option<usize>]) -> Vec<Vec<(usize, f64)>> {
    let mut carried = vec![0.0; slave_of.len()];
    for row in rows {
        row.image.iter().for_each(|&(j, w)| carried[j] += row.area * w);
    }
    let of = |row: &GapWeights| {
        let to_masters = row.image.iter().filter(|e| slave_of[e.0].is_none() && carried[e.0] > 0.0);
        to_masters.map(|&(j, w)| (j, row.area * w / carried[j])).collect()
    };
    rows.iter().map(of).collect()
}

/// The inverse of a small dense matrix, with partial pivoting.
fn invert(matrix: &[f64], n: usize) -> Vec<f64> {
    let mut a = matrix.to_vec();
    let mut inverse = vec![0.0; n * n];
    (0..n).for_each(|i| inverse[i * n + i] = 1.0);
    for p in 0..n {
        let best = (p..n).max_by(|&i, &j| a[i * n + p].abs().total_cmp(&a[j * n + p].abs())).unwrap_or(p);
        for c in 0..n {
            a.swap(p * n + c, best * n + c);
            inverse.swap(p * n + c, best * n + c);
        }
        let pivot = a[p * n + p];
        for c in 0..n {
            a[p * n + c] /= pivot;
            inverse[p * n + c] /= pivot;
        }
        for r in (0..n).filter(|&r| r != p) {
            let factor = a[r * n + p];
            if factor != 0.0 {
                for c in 0..n {
                    a[r * n + c] -= factor * a[p * n + c];
                    inverse[r * n + c] -= factor * inverse[p * n + c];
                }
            }
        }
    }
    inverse
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{SphereSpec, sphere_mesh, whole::whole};

    fn half() -> Mesh {
        let spec =
            SphereSpec { contact_radius: 0.2, elements_per_contact_radius: 4, fine_zone: 1.3, skin_levels: 0, first_layer: 1.0 };
        sphere_mesh(&spec).unwrap()
    }

    /// Every image, with the meshes that it is used on.
    fn all() -> [(Mesh, Image); 3] {
        [(half(), Image::HalfTurn), (whole(&half()), Image::HalfTurn), (whole(&half()), Image::Inversion)]
    }

    /// Moved along x and, where nothing is symmetric in y, along y.
    fn slid(mesh: &Mesh, by: f64) -> Vec<f64> {
        let across = if mesh.copies == 1 { -0.6 * by } else { 0.0 };
        let at = |x: &[f64; 3]| [by, across + 0.01 * x[1] * x[0], -0.01 - 0.003 * x[0] + 0.001 * x[1]];
        mesh.nodes.iter().flat_map(at).collect()
    }

    #[test]
    fn forces_and_displacements_are_dual() {
        let shifts = [0.0, 0.007, 0.0125, 0.02, 0.025, 0.06, -0.03];
        for (mesh, image, by) in all().iter().flat_map(|(mesh, image)| shifts.map(|by| (mesh, *image, by))) {
            let interface = PairInterface::new(mesh, &slid(mesh, by), image);
            assert!(interface.slaves.len() > 20);
            let n = 3 * mesh.nodes.len();
            let y: Vec<f64> = (0..n).map(|i| (0.37 * i as f64).sin()).collect();
            let f: Vec<f64> = (0..n).map(|i| (0.11 * i as f64 + 0.4).cos()).collect();
            let (mut u, mut g) = (y.clone(), f.clone());
            interface.expand(&mut u);
            interface.reduce(&mut g);
            let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            assert!((dot(&u, &f) - dot(&y, &g)).abs() < 1e-10 * dot(&u, &u).sqrt() * dot(&f, &f).sqrt(), "slid by {by}");
            interface.contract(&mut u);
            assert!(u.iter().zip(&y).all(|(a, b)| (a - b).abs() < 1e-9), "slid by {by}");
            // The work of interface forces on relative displacements is that of the nodal forces.
            let forces: Vec<[f64; 3]> = (0..interface.slaves.len()).map(|k| [(k as f64).sin(), 0.1, 1.0]).collect();
            let nodal = interface.nodal(&forces);
            let relative = interface.relative(&f);
            let work: f64 = forces.iter().zip(&relative).map(|(a, b)| dot(a, b)).sum();
            let at_nodes: f64 = nodal.iter().zip(&mesh.contact_nodes).map(|(p, &n)| dot(p, &f[3 * n as usize..][..3])).sum();
            assert!((work - at_nodes).abs() < 1e-9 * work.abs().max(1.0), "slid by {by}: {work} {at_nodes}");
        }
    }

    #[test]
    fn bodies_that_have_not_slid_meet_in_the_plane() {
        for (mesh, image) in all() {
            let interface = PairInterface::new(&mesh, &vec![0.0; 3 * mesh.nodes.len()], image);
            let positions: Vec<f64> = mesh.nodes.as_flattened().to_vec();
            let mut exact = 0;
            for (k, w) in interface.relative(&positions).iter().enumerate() {
                let [t1, _, normal] = interface.frames[k];
                // Near its seam an inverted surface faces a mean of nodes, which is not as steep as
                // their middle.
                let [x, y, z] = mesh.nodes[interface.nodes[interface.slaves[k]]];
                let size = mesh.contact_size[interface.slaves[k]];
                if image == Image::Inversion && x < 2.0 * size {
                    assert!(
                        normal[0].abs() < size && normal[1].abs() < size && w[0].abs() < 1e-2 * size,
                        "{k}: {normal:?} {w:?}"
                    );
                    continue;
                }
                exact += 1;
                assert!(normal[0].abs() < 1e-9 && normal[1].abs() < 1e-9, "slave {k}: {normal:?}");
                assert!((t1[0] - 1.0).abs() < 1e-9);
                let off =
                    (w[2] - 2.0 * z).abs().max(w[0].abs()).max(if interface.free_y[k] { 0.0 } else { w[1].abs() - y.abs() });
                assert!(off < 1e-9, "slave {k}: {w:?}");
            }
            assert!(exact > 20, "{exact}");
        }
    }
}

//! How two bodies meet that both deform: what their displacements have to do with the gap and the
//! slip between them.
//!
//! The body that is softer is the slave. With the mortar weights M (see [`super::mortar`]), R =
//! diag(1, 1, -1) and each body in its own coordinates (see [`mod@crate::mesh::couple`]), the
//! relative position of slave node i is `w_i = x_i - R sum_j M_ij x_j`, in the slave's coordinates.
//! Its conditions are those of a point over a plane, in a frame of its own: tangents t_1 (in the
//! plane of x and the normal) and t_2, and the normal n, a mean of the two surfaces' in which the
//! stiffer one, which bends less, counts for more. So the unknowns y of a step are w in these
//! frames at slave nodes and u elsewhere: `u = T y`. The forces that belong to y are `T^T f`: at a
//! slave node the force that the interface carries there, at a master node the body's own and what
//! the slave exerts on it, which is nothing together in equilibrium.

use super::frame::{ContactFrame, frame, from_frame, to_frame};
use super::interface::{Interface, inward_normals};
use super::mortar::{Surface, weights_between};
use crate::mesh::Mesh;

/// The interface of one step: fixed while it is solved, made anew for the next.
#[derive(Clone, Debug, Default)]
pub struct CoupleInterface {
    /// Slave nodes, by their index among the contact nodes.
    pub slaves: Vec<usize>,
    /// Per contact node: the slave that it is, or of a master the one that it has most to do with.
    pub facing: Vec<Option<usize>>,
    /// Per slave: frame [t_1, t_2, n], in the slave's coordinates.
    pub frames: Vec<ContactFrame>,
    /// Area of the interface that belongs to each slave.
    pub area: Vec<f64>,
    /// Per slave: y is not coupled, for the symmetry plane sees to it.
    on_symmetry: Vec<bool>,
    /// Node of each slave.
    nodes: Vec<usize>,
    /// Number of contact nodes.
    contacts: usize,
    /// Per slave: index among the contact nodes, node and weight of each master.
    masters: Vec<Vec<(usize, usize, f64)>>,
}

/// From the coordinates of one body to those of the other.
fn across(v: [f64; 3]) -> [f64; 3] {
    [v[0], v[1], -v[2]]
}

fn at(x: &[f64], node: usize) -> [f64; 3] {
    [x[3 * node], x[3 * node + 1], x[3 * node + 2]]
}

impl CoupleInterface {
    /// The interface between the two bodies of a mesh with displacement `u` (three a node), of
    /// which body `slave` (0 the sphere, 1 the opponent) is the slave and the master's normal has
    /// the weight `of_master` (0 to 1); none if the mesh is of one body.
    pub fn new(mesh: &Mesh, u: &[f64], slave: usize, of_master: f64) -> Self {
        let Some(couple) = &mesh.couple else { return Self::default() };
        let split = |body: usize, first: usize, end: usize| if body == 0 { 0..first } else { first..end };
        let surface = |body: usize| {
            let contacts = split(body, couple.contact, mesh.contact_nodes.len());
            let nodes = &mesh.contact_nodes[contacts.clone()];
            let index = |n: u32| nodes.partition_point(|&c| c < n);
            let faces = &mesh.contact_faces[split(body, couple.contact_face, mesh.contact_faces.len())];
            let faces: Vec<[usize; 4]> = faces.iter().map(|f| f.map(index)).collect();
            let position = |&n: &u32| -> [f64; 3] { std::array::from_fn(|c| mesh.nodes[n as usize][c] + u[3 * n as usize + c]) };
            let positions: Vec<[f64; 3]> = nodes.iter().map(position).collect();
            let plane: Vec<[f64; 2]> = positions.iter().map(|x| [x[0], x[1]]).collect();
            let normals = inward_normals(&positions, &faces);
            (contacts.start, plane, faces, normals)
        };
        let (first, plane, faces, up) = surface(slave);
        let (first_master, other_plane, other_faces, other_up) = surface(1 - slave);
        let rows =
            weights_between(Surface { points: &plane, faces: &faces }, Surface { points: &other_plane, faces: &other_faces });
        let node = |contact: usize| mesh.contact_nodes[contact] as usize;
        let contacts = mesh.contact_nodes.len();
        let mut interface = Self { contacts, facing: vec![None; contacts], ..Self::default() };
        let mut most = vec![0.0; contacts];
        for (k, row) in rows.iter().enumerate() {
            let contact = first + row.slave;
            let on_symmetry = mesh.is_on_symmetry_plane(mesh.contact_nodes[contact]);
            let mut normal = up[row.slave].map(|n| (1.0 - of_master) * n);
            for &(j, w) in &row.image {
                let other = across(other_up[j]);
                (0..3).for_each(|c| normal[c] -= of_master * w * other[c]);
                if w > most[first_master + j] {
                    (most[first_master + j], interface.facing[first_master + j]) = (w, Some(k));
                }
            }
            if on_symmetry {
                normal[1] = 0.0;
            }
            interface.facing[contact] = Some(k);
            interface.slaves.push(contact);
            interface.nodes.push(node(contact));
            interface.frames.push(frame(normal));
            interface.area.push(row.area);
            interface.on_symmetry.push(on_symmetry);
            interface.masters.push(row.image.iter().map(|&(j, w)| (first_master + j, node(first_master + j), w)).collect());
        }
        interface
    }

    /// What the masters' values x (three a node) come to at a slave, in the slave's coordinates;
    /// not along y where that is not coupled.
    fn opposite(&self, k: usize, x: &[f64]) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for &(_, node, w) in &self.masters[k] {
            let x = at(x, node);
            (0..3).for_each(|c| sum[c] += w * x[c]);
        }
        if self.on_symmetry[k] {
            sum[1] = 0.0;
        }
        across(sum)
    }

    /// A slave's force in the masters' coordinates, as far as they are coupled.
    fn carried(&self, k: usize, force: [f64; 3]) -> [f64; 3] {
        let [x, y, z] = across(force);
        [x, if self.on_symmetry[k] { 0.0 } else { y }, z]
    }
}

impl Interface for CoupleInterface {
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
        3 * self.nodes[k]
    }

    /// The symmetry plane sees to it, along whose normal nothing is coupled.
    fn is_free_along_y(&self, k: usize) -> bool {
        self.on_symmetry[k]
    }

    /// In the slave's coordinates.
    fn relative_along_axes(&self, k: usize, x: &[f64]) -> [f64; 3] {
        let (own, other) = (at(x, self.nodes[k]), self.opposite(k, x));
        std::array::from_fn(|c| own[c] - other[c])
    }

    fn expand(&self, y: &mut [f64]) {
        for k in 0..self.slaves.len() {
            let (w, other) = (from_frame(&self.frames[k], &at(y, self.nodes[k])), self.opposite(k, y));
            let u: [f64; 3] = std::array::from_fn(|c| w[c] + other[c]);
            y[3 * self.nodes[k]..][..3].copy_from_slice(&u);
        }
    }

    fn reduce(&self, f: &mut [f64]) {
        for k in 0..self.slaves.len() {
            let force = at(f, self.nodes[k]);
            let carried = self.carried(k, force);
            for &(_, node, w) in &self.masters[k] {
                (0..3).for_each(|c| f[3 * node + c] += w * carried[c]);
            }
            f[3 * self.nodes[k]..][..3].copy_from_slice(&to_frame(&self.frames[k], &force));
        }
    }

    /// Of both bodies, each in its own coordinates.
    fn nodal(&self, forces: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let mut nodal = vec![[0.0; 3]; self.contacts];
        for (k, force) in forces.iter().enumerate() {
            let force = from_frame(&self.frames[k], force);
            (0..3).for_each(|c| nodal[self.slaves[k]][c] += force[c]);
            let carried = self.carried(k, force);
            for &(contact, _, w) in &self.masters[k] {
                (0..3).for_each(|c| nodal[contact][c] -= w * carried[c]);
            }
        }
        nodal
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::couple::{couple, scaled};
    use crate::mesh::{SphereSpec, flat_mesh, opponent_mesh, sphere_mesh};

    fn bodies(a: f64, elements: usize, radius: f64) -> Mesh {
        let spec = |a| SphereSpec {
            contact_radius: a,
            elements_per_contact_radius: elements,
            fine_zone: 1.3,
            skin_levels: 0,
            first_layer: 1.0,
        };
        let other = if radius.is_finite() {
            scaled(opponent_mesh(&spec(a / radius)).unwrap(), radius)
        } else {
            flat_mesh(&spec(a)).unwrap()
        };
        couple(sphere_mesh(&spec(a)).unwrap(), other)
    }

    /// The sphere moved by `by` elements along x, both surfaces bent.
    fn slid(mesh: &Mesh, by: f64) -> Vec<f64> {
        let first = mesh.couple.as_ref().unwrap().node;
        let moved = |(n, x): (usize, &[f64; 3])| match n < first {
            true => [by + 0.01 * x[0], 0.01 * x[1] * x[0], -0.01 - 0.003 * x[0] + 0.001 * x[1]],
            false => [0.002 * x[1], -0.01 * x[1] * x[0], 0.004 * x[0]],
        };
        mesh.nodes.iter().enumerate().flat_map(moved).collect()
    }

    #[test]
    fn forces_and_displacements_are_dual_and_the_bodies_forces_sum_to_zero() {
        for (radius, slave) in [(2.0, 0), (2.0, 1), (f64::INFINITY, 0), (1.0, 1)] {
            let mesh = bodies(0.2, 4, radius);
            for by in [0.0, 0.3, 1.0, 3.0] {
                let interface = CoupleInterface::new(&mesh, &slid(&mesh, 0.05 * by), slave, 0.5);
                assert!(interface.slaves.len() > 20, "{}", interface.slaves.len());
                let n = 3 * mesh.nodes.len();
                let y: Vec<f64> = (0..n).map(|i| (0.37 * i as f64).sin()).collect();
                let f: Vec<f64> = (0..n).map(|i| (0.11 * i as f64 + 0.4).cos()).collect();
                let (mut u, mut g) = (y.clone(), f.clone());
                interface.expand(&mut u);
                interface.reduce(&mut g);
                let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
                assert!((dot(&u, &f) - dot(&y, &g)).abs() < 1e-10 * dot(&u, &u).sqrt() * dot(&f, &f).sqrt(), "slid by {by}");
                interface.contract(&mut u);
                assert!(u.iter().zip(&y).all(|(a, b)| (a - b).abs() < 1e-12), "slid by {by}");
                let forces: Vec<[f64; 3]> = (0..interface.slaves.len()).map(|k| [(k as f64).sin(), 0.0, 1.0]).collect();
                let nodal = interface.nodal(&forces);
                let work: f64 = forces.iter().zip(&interface.relative(&f)).map(|(a, b)| dot(a, b)).sum();
                let nodes = nodal.iter().zip(&mesh.contact_nodes);
                let at_nodes: f64 = nodes.map(|(p, &n)| dot(p, &f[3 * n as usize..][..3])).sum();
                assert!((work - at_nodes).abs() < 1e-9 * work.abs().max(1.0), "slid by {by}: {work} {at_nodes}");
                // What presses one body up presses the other one down.
                let first = mesh.couple.as_ref().unwrap().contact;
                let sum = |part: &[[f64; 3]], c: usize| part.iter().map(|f| f[c]).sum::<f64>();
                let (own, other) = nodal.split_at(first);
                let whole = sum(own, 2).abs();
                assert!(
                    (sum(own, 0) + sum(other, 0)).abs() < 1e-12 * whole && (sum(own, 2) - sum(other, 2)).abs() < 1e-12 * whole
                );
            }
        }
    }

    #[test]
    fn a_uniform_pressure_goes_through_the_interface() {
        // On the surface that the main job has: the force of each master node is that of its own
        // shape function, at whatever slip.
        let elements = 16;
        for radius in [1.0, 2.0, f64::INFINITY] {
            let mesh = bodies(0.2, elements, radius);
            let parts = mesh.couple.clone().unwrap();
            for slip in [0.0, 0.3, 1.0, 3.0] {
                let by = slip * 0.2 / elements as f64;
                let u: Vec<f64> = (0..mesh.nodes.len()).flat_map(|n| [if n < parts.node { by } else { 0.0 }, 0.0, 0.0]).collect();
                let interface = CoupleInterface::new(&mesh, &u, 0, 0.5);
                let mut force = vec![0.0; mesh.contact_nodes.len()];
                for k in 0..interface.slaves.len() {
                    interface.masters[k].iter().for_each(|&(contact, _, w)| force[contact] += interface.area[k] * w);
                }
                let mut area = vec![0.0; mesh.contact_nodes.len()];
                for face in &mesh.contact_faces[parts.contact_face..] {
                    let corners = face.map(|n| mesh.nodes[n as usize]);
                    let g = 0.6_f64.sqrt();
                    for (xi, wx) in [(-g, 5.0 / 9.0), (0.0, 8.0 / 9.0), (g, 5.0 / 9.0)] {
                        for (eta, wy) in [(-g, 5.0 / 9.0), (0.0, 8.0 / 9.0), (g, 5.0 / 9.0)] {
                            let signs = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
                            let n = signs.map(|[a, b]| 0.25 * (1.0 + a * xi) * (1.0 + b * eta));
                            let d = [0, 1].map(|i| {
                                [0, 1].map(|j| -> f64 {
                                    let slope = |s: &[f64; 2]| 0.25 * s[j] * (1.0 + s[1 - j] * [xi, eta][1 - j]);
                                    signs.iter().zip(&corners).map(|(s, x)| slope(s) * x[i]).sum()
                                })
                            });
                            let weight = wx * wy * (d[0][0] * d[1][1] - d[0][1] * d[1][0]).abs();
                            for (a, &node) in face.iter().enumerate() {
                                area[mesh.contact_nodes.partition_point(|&c| c < node)] += weight * n[a];
                            }
                        }
                    }
                }
                let mut worst = 0.0_f64;
                for (i, &node) in mesh.contact_nodes.iter().enumerate().skip(parts.contact) {
                    let x = mesh.nodes[node as usize];
                    if x[0].hypot(x[1]) < 0.22 {
                        let off = (force[i] / area[i] - 1.0).abs();
                        worst = worst.max(off);
                    }
                }
                assert!(worst < 1e-10, "radius {radius}, slip {slip}: {worst:.1e}");
            }
        }
    }
}

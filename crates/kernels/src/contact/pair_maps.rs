//! How the maps of an equal pair's interface are made ([`super::maps`]): from its coefficients,
//! which are diagonal along the axes, and the frames of its slaves.

use std::sync::Arc;

use super::frame::ContactFrame;
use super::interface::Interface;
use super::maps::{Block, NodeMap, PairMaps, Row};
use super::pair::PairInterface;

impl PairInterface {
    /// Its maps as a device takes them; made when they are first asked for.
    pub fn maps(&self) -> Arc<PairMaps> {
        self.maps.get_or_init(|| Arc::new(made(self))).clone()
    }
}

fn made(interface: &PairInterface) -> PairMaps {
    let nodes = &interface.nodes;
    let (contract, expand) = (contract(interface), expand(interface));
    PairMaps {
        halves: NodeMap::new(&halves(interface), nodes),
        nodal: NodeMap::new(&NodeMap::transposed(&contract), nodes),
        reduce: NodeMap::new(&NodeMap::transposed(&expand), nodes),
        contract: NodeMap::new(&contract, nodes),
        expand: NodeMap::new(&expand, nodes),
    }
}

const IDENTITY: Block = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];

/// Rows that leave everything as it is, and none at slaves.
fn rows_of(interface: &PairInterface) -> Vec<Row> {
    let row = |(i, slave): (usize, &Option<usize>)| if slave.is_some() { Row::new() } else { Row::from([(i, IDENTITY)]) };
    interface.slave_of.iter().enumerate().map(row).collect()
}

fn add(row: &mut Row, column: usize, block: Block) {
    let sum = row.entry(column).or_insert([0.0; 9]);
    sum.iter_mut().zip(block).for_each(|(sum, x)| *sum += x);
}

/// Components in a frame of what is scaled along the axes.
fn to_frame(frame: &ContactFrame, by: [f64; 3]) -> Block {
    std::array::from_fn(|m| frame[m / 3][m % 3] * by[m % 3])
}

/// The same the other way round.
fn from_frame(frame: &ContactFrame, by: [f64; 3]) -> Block {
    std::array::from_fn(|m| by[m / 3] * frame[m % 3][m / 3])
}

fn halves(interface: &PairInterface) -> Vec<Row> {
    let (signs, mut rows) = (interface.image.signs(), rows_of(interface));
    for (k, &slave) in interface.slaves.iter().enumerate() {
        for &(master, share) in &interface.shares[k] {
            let mut block = to_frame(&interface.frames[k], signs.map(|sign| 0.5 * share * sign));
            if interface.is_free_along_y(k) {
                block[3..6].fill(0.0);
            }
            add(&mut rows[slave], master, block);
        }
    }
    rows
}

fn contract(interface: &PairInterface) -> Vec<Row> {
    let (seam, mut rows) = (&interface.seam, rows_of(interface));
    let n = seam.slaves.len();
    for (k, &slave) in interface.slaves.iter().enumerate() {
        let frame = &interface.frames[k];
        match seam.position[k] {
            None => add(&mut rows[slave], slave, to_frame(frame, [1.0; 3])),
            Some(g) => {
                for (other, &of) in seam.slaves.iter().enumerate() {
                    let by = std::array::from_fn(|c| seam.direct[c][g * n + other]);
                    add(&mut rows[slave], interface.slaves[of], to_frame(frame, by));
                }
            }
        }
        interface.masters[k].iter().for_each(|&(master, by)| add(&mut rows[slave], master, to_frame(frame, by)));
    }
    rows
}

fn expand(interface: &PairInterface) -> Vec<Row> {
    let (seam, mut rows) = (&interface.seam, rows_of(interface));
    let n = seam.slaves.len();
    for (k, &slave) in interface.slaves.iter().enumerate() {
        let mut take = |of: usize, by: [f64; 3]| {
            if by == [0.0; 3] {
                return;
            }
            add(&mut rows[slave], interface.slaves[of], from_frame(&interface.frames[of], by));
            for &(master, f) in &interface.masters[of] {
                let [x, y, z] = std::array::from_fn(|c| -by[c] * f[c]);
                add(&mut rows[slave], master, [x, 0.0, 0.0, 0.0, y, 0.0, 0.0, 0.0, z]);
            }
        };
        match seam.position[k] {
            None => take(k, [1.0; 3]),
            Some(g) => (seam.slaves.iter().enumerate())
                .for_each(|(other, &of)| take(of, std::array::from_fn(|c| seam.inverse[c][g * n + other]))),
        }
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::pair::Image;
    use crate::mesh::{Mesh, SphereSpec, sphere_mesh, whole::whole};

    fn half(elements_per_contact_radius: usize) -> Mesh {
        let spec =
            SphereSpec { contact_radius: 0.2, elements_per_contact_radius, fine_zone: 1.3, skin_levels: 0, first_layer: 1.0 };
        sphere_mesh(&spec).unwrap()
    }

    #[test]
    fn they_are_what_the_interface_does() {
        let meshes = [(half(4), Image::HalfTurn), (whole(&half(3)), Image::HalfTurn), (whole(&half(3)), Image::Inversion)];
        for ((mesh, image), by) in meshes.iter().flat_map(|mesh| [0.0, 0.007, 0.0125, 0.025, -0.03].map(|by| (mesh, by))) {
            let moved = |x: &[f64; 3]| [by, 0.01 * x[1] * x[0], -0.01 - 0.003 * x[0] + 0.001 * x[1]];
            let u: Vec<f64> = mesh.nodes.iter().flat_map(moved).collect();
            let interface = PairInterface::new(mesh, &u, *image);
            let maps = interface.maps();
            let v: Vec<f64> = (0..u.len()).map(|i| (0.37 * i as f64).sin()).collect();
            let hold = |what: &str, ours: &[f64], theirs: &[f64]| {
                let worst = ours.iter().zip(theirs).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
                assert!(worst < 1e-12, "{what}, slid by {by}: {worst:e}");
            };
            let made = |make: &dyn Fn(&mut [f64])| {
                let mut v = v.clone();
                make(&mut v);
                v
            };
            let nodes = &mesh.contact_nodes;
            hold("contract", &maps.contract.times(nodes, &v), &made(&|v| interface.contract(v)));
            hold("expand", &maps.expand.times(nodes, &v), &made(&|v| interface.expand(v)));
            hold("reduce", &maps.reduce.times(nodes, &v), &made(&|v| interface.reduce(v)));
            // Every third unknown is fixed.
            let fixed: Vec<bool> = (0..v.len()).map(|i| i % 7 % 3 == 0).collect();
            let halves = maps.halves.times(nodes, &v);
            let given: Vec<f64> = (0..v.len()).map(|i| if fixed[i] { halves[i] } else { v[i] }).collect();
            let mut expected = vec![0.0; v.len()];
            interface.loads(&v, &fixed, &mut expected);
            let mut ours = maps.nodal.times(nodes, &given);
            // What is fixed elsewhere than at slaves is left as it is by the interface.
            let is_slave = |i: usize| nodes.binary_search(&((i / 3) as u32)).is_ok_and(|at| interface.slave_of[at].is_some());
            for i in (0..v.len()).filter(|&i| fixed[i] && !is_slave(i) && nodes.binary_search(&((i / 3) as u32)).is_err()) {
                ours[i] = v[i];
            }
            hold("loads", &ours, &expected);
        }
    }
}

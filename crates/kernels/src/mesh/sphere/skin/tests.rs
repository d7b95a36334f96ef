use std::collections::HashMap;

use super::*;
use crate::contact::interface::Symmetry;
use crate::mesh::quality;
use crate::mesh::sphere::{SphereSpec, flat_mesh, sphere_mesh};
use crate::mesh::{Mesh, connectivity::FACES};

fn spec(contact_radius: f64, elements: usize, fine_zone: f64, levels: usize) -> SphereSpec {
    SphereSpec { contact_radius, elements_per_contact_radius: elements, fine_zone, skin_levels: levels, first_layer: 1.0 }
}

fn specs() -> Vec<SphereSpec> {
    let mut specs = Vec::new();
    for contact_radius in [0.0005, 0.01, 0.2087, 0.65] {
        for (elements, levels) in [(3, 1), (4, 1), (4, 2), (5, 2), (6, 1), (8, 1), (4, 3), (3, 2), (16, 1)] {
            for fine_zone in [1.1, 1.3, 3.0] {
                specs.push(spec(contact_radius, elements, fine_zone, levels));
            }
        }
    }
    // Companions of 4 inside.
    for levels in 1..=3 {
        specs.extend([1.1, 1.3].map(|fine_zone| spec(0.2087, 2, fine_zone, levels)));
    }
    specs
}

/// The faces of a leaf in squares of the finest lattice.
fn squares(skin: &Skin<'_>, leaf: &Leaf, mut each: impl FnMut([usize; 4])) {
    let size = 1 << (skin.levels - leaf.level);
    for local in FACES {
        let [a, b, _, d] = local.map(|corner| skin.corner_at(leaf, corner).map(|i| i * size));
        // The edges from a along the face.
        let edge = |to: [usize; 3], k: usize| to[k] as isize - a[k] as isize;
        for i in 0..size as isize {
            for j in 0..size as isize {
                let at = |i: isize, j: isize| -> usize {
                    let step = |k: usize| (i * edge(b, k) + j * edge(d, k)) / size as isize;
                    let at = [0, 1, 2].map(|k| (a[k] as isize + step(k)) as usize);
                    skin.finest.number(Site { block: leaf.block, at }) as usize
                };
                let mut square = [at(i, j), at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)];
                square.sort_unstable();
                each(square);
            }
        }
    }
}

#[test]
fn cells_fit_and_neighbours_differ_by_one_level_at_most() {
    for spec in specs().into_iter().filter(|spec| spec.contact_radius == 0.2087) {
        let layout = Layout::new(&spec).unwrap();
        let skin = Skin::new(&layout);
        let mut around: HashMap<[usize; 4], Vec<usize>> = HashMap::new();
        for leaf in &skin.leaves {
            squares(&skin, leaf, |square| around.entry(square).or_default().push(leaf.level));
        }
        assert!(around.values().all(|levels| levels.len() <= 2), "{spec:?}");
        let both = around.values().filter(|levels| levels.len() == 2);
        assert!(both.clone().all(|levels| levels[0].abs_diff(levels[1]) <= 1), "{spec:?}");
        assert!(both.filter(|levels| levels[0] != levels[1]).count() > 0);
        // What has one side is on the outside: as much as of the whole lattice.
        let outside = around.values().filter(|levels| levels.len() == 1).count();
        let whole = Layout { skin: 0, blocks: skin.finest, ..layout.clone() };
        let all = Skin::new(&whole);
        let mut sides: HashMap<[usize; 4], usize> = HashMap::new();
        all.leaves.iter().for_each(|leaf| squares(&all, leaf, |square| *sides.entry(square).or_default() += 1));
        assert_eq!(outside, sides.values().filter(|n| **n == 1).count(), "{spec:?}");
    }
}

#[test]
fn what_is_named_is_a_node_and_elements_are_well_shaped() {
    for spec in specs() {
        let layout = Layout::new(&spec).unwrap();
        let mesh = sphere_mesh(&spec).unwrap();
        assert_eq!(mesh.elements.len(), element_count(&layout), "{spec:?}");
        assert!(mesh.elements.iter().flatten().all(|&n| (n as usize) < mesh.nodes.len()), "{spec:?}");
        let mut used = vec![false; mesh.nodes.len()];
        let mut worst = 1f64;
        for (element, nodes) in mesh.elements.iter().enumerate() {
            let mut distinct = nodes.to_vec();
            distinct.sort_unstable();
            distinct.dedup();
            assert_eq!(distinct.len(), 8, "{spec:?}: {element}");
            nodes.iter().for_each(|&n| used[n as usize] = true);
            let corners = mesh.corners(element);
            worst = worst.min(quality::scaled_jacobian(&corners));
        }
        assert!(worst > 0.58, "{spec:?}: scaled Jacobian {worst}");
        assert!(used.iter().all(|used| *used));
        assert!(!Symmetry::mirror(&mesh).nodes.is_empty(), "{spec:?}");
        assert!(mesh.hanging.iter().any(|hanging| !hanging.is_none()));
        assert!(mesh.contact_nodes.is_sorted() && mesh.plate_nodes.is_sorted());
    }
}

#[test]
fn the_surface_is_fine_over_the_fine_zone_and_has_its_area() {
    for spec in specs() {
        let mesh = sphere_mesh(&spec).unwrap();
        let finest = spec.contact_radius / (spec.elements_per_contact_radius << spec.skin_levels) as f64;
        let rho = |n: u32| mesh.nodes[n as usize][0].hypot(mesh.nodes[n as usize][1]);
        // Up to there all faces around a node are of the finest level.
        let mut of_finest = vec![0.0; mesh.nodes.len()];
        for face in &mesh.contact_faces {
            let shares = crate::mesh::connectivity::face_areas(face.map(|n| mesh.nodes[n as usize]));
            face.iter().zip(shares).for_each(|(&n, share)| of_finest[n as usize] += share);
        }
        let inside = || (0..mesh.contact_nodes.len()).filter(|&k| rho(mesh.contact_nodes[k]) < mesh.fine_radius - finest);
        for k in inside() {
            let (area, node) = (mesh.contact_area[k], mesh.contact_nodes[k]);
            assert!((of_finest[node as usize] / area - 1.0).abs() < 1e-12, "{spec:?}: {}", rho(node));
        }
        let within = || inside().filter(|&k| rho(mesh.contact_nodes[k]) < spec.contact_radius);
        let size = within().map(|k| mesh.contact_size[k]).sum::<f64>() / within().count() as f64;
        assert!((0.9..1.3).contains(&(size / finest)), "{spec:?}: {}", size / finest);
        // Faces without a corner that hangs cover all of the fine zone; all faces, the surface.
        let covered: f64 = mesh
            .contact_faces
            .iter()
            .map(|face| crate::mesh::connectivity::face_areas(face.map(|n| mesh.nodes[n as usize])).iter().sum::<f64>())
            .sum();
        assert!(covered > 0.95 * std::f64::consts::PI * (1.0 - (1.0 - mesh.fine_radius.powi(2)).sqrt()), "{spec:?}");
        let all = |mesh: &Mesh| mesh.contact_area.iter().sum::<f64>();
        let plain = sphere_mesh(&SphereSpec { skin_levels: 0, ..spec }).unwrap();
        assert!((all(&mesh) / all(&plain) - 1.0).abs() < 0.08, "{spec:?}: {} {}", all(&mesh), all(&plain));
    }
}

#[test]
fn levels_are_nested_and_the_half_has_its_own() {
    for spec in [spec(0.2087, 4, 1.3, 2), spec(0.01, 6, 1.1, 1), spec(0.3, 8, 2.0, 1)] {
        for mesh in [sphere_mesh(&spec).unwrap(), flat_mesh(&spec).unwrap()] {
            let half = mesh.half.as_ref().unwrap();
            let expected: Vec<u32> = (0u32..).zip(&mesh.nodes).filter(|(_, x)| x[0] >= 0.0).map(|(n, _)| n).collect();
            let mut nodes = half.node.clone();
            nodes.sort_unstable();
            assert_eq!(nodes, expected);
            for (hierarchy, rows) in [(&mesh.hierarchy, mesh.nodes.len()), (&half.hierarchy, half.node.len())] {
                let mut rows = rows;
                for p in hierarchy {
                    assert_eq!(p.row_start.len(), rows + 1);
                    for row in p.row_start.windows(2).map(|w| w[0] as usize..w[1] as usize) {
                        assert!([1, 2, 4, 8].contains(&row.len()));
                        assert!((p.weight[row.clone()].iter().sum::<f64>() - 1.0).abs() < 1e-15);
                        assert!(p.column[row].is_sorted_by(|a, b| a < b));
                    }
                    assert!(p.column.iter().all(|&c| (c as usize) < p.coarse_nodes));
                    rows = p.coarse_nodes;
                }
            }
        }
    }
}

/// Two surfaces that meet are integrated over these faces: a ring without any between the levels
/// would be a surface of its own, whose rows have hardly any weight.
#[test]
fn the_faces_that_meet_others_are_one_surface() {
    for spec in specs() {
        let mesh = sphere_mesh(&spec).unwrap();
        let mut edges: HashMap<[u32; 2], usize> = HashMap::new();
        for face in &mesh.contact_faces {
            for k in 0..4 {
                let (a, b) = (face[k], face[(k + 1) % 4]);
                *edges.entry([a.min(b), a.max(b)]).or_default() += 1;
            }
        }
        // Nodes along the rim, each with its two neighbours there: one loop.
        let mut rim: HashMap<u32, Vec<u32>> = HashMap::new();
        for ([a, b], _) in edges.into_iter().filter(|(_, faces)| *faces == 1) {
            rim.entry(a).or_default().push(b);
            rim.entry(b).or_default().push(a);
        }
        assert!(rim.values().all(|next| next.len() == 2), "{spec:?}");
        let first = *rim.keys().next().unwrap();
        let (mut before, mut at, mut length) = (first, rim[&first][0], 1);
        while at != first {
            let next = rim[&at].iter().copied().find(|&n| n != before).unwrap();
            (before, at, length) = (at, next, length + 1);
        }
        assert_eq!(length, rim.len(), "{spec:?}");
    }
}

/// What a level adds lies in the middle of the nodes that it is interpolated from, by its indices.
#[test]
fn interpolation_is_from_the_middle_of_parents() {
    for spec in [spec(0.2087, 4, 1.3, 2), spec(0.01, 6, 1.1, 1)] {
        let layout = Layout::new(&spec).unwrap();
        let skin = Skin::new(&layout);
        for (k, p) in skin.prolongations().iter().enumerate() {
            let level = skin.levels - k;
            for n in skin.up_to[level - 1]..skin.up_to[level] {
                let row = p.row_start[n] as usize..p.row_start[n + 1] as usize;
                let site = skin.sites[n];
                // The names of the parents in the block of the node, for there they are next to it.
                let size = 1 << (skin.levels - level);
                let odd: Vec<usize> = (0..3).filter(|&axis| site.at[axis] / size % 2 == 1).collect();
                assert_eq!(row.len(), 1 << odd.len(), "{spec:?}: {site:?}");
                let mut expected: Vec<u32> = (0..row.len())
                    .map(|side| {
                        let mut at = site.at;
                        odd.iter().enumerate().for_each(|(bit, &axis)| {
                            at[axis] = if side >> bit & 1 == 1 { at[axis] + size } else { at[axis] - size };
                        });
                        skin.number[skin.finest.number(Site { at, ..site }) as usize].expect("a node")
                    })
                    .collect();
                expected.sort_unstable();
                assert_eq!(p.column[row], expected, "{spec:?}: {site:?}");
            }
        }
    }
}

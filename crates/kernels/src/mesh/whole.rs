//! Both halves of a body as one mesh: half the lower hemisphere and its mirror image, y to -y.
//!
//! Nodes of the half keep their numbers; those of the image follow, but for what lies at y = 0,
//! which both have. The levels of the hierarchy are joined in the same way, so that a coarse mesh
//! is the whole of the half's.

use super::connectivity::{node_elements, sweep_order};
use super::{Hanging, Mesh, MirrorHalf, Prolongation};

/// Numbers of the image of each node of a half.
struct MirrorNumbers {
    /// The node itself where it lies at y = 0.
    of: Vec<u32>,
    /// Nodes of both halves.
    count: usize,
}

impl MirrorNumbers {
    fn new(is_shared: &[bool]) -> Self {
        let mut count = is_shared.len();
        let of = is_shared.iter().enumerate().map(|(node, &shared)| {
            if shared {
                return node as u32;
            }
            count += 1;
            (count - 1) as u32
        });
        Self { of: of.collect(), count }
    }

    /// Nodes of the half that have an image of their own, in increasing order.
    fn doubled(&self) -> impl Iterator<Item = u32> + '_ {
        (0u32..).zip(&self.of).filter(|(node, image)| *node != **image).map(|(node, _)| node)
    }

    /// A list of nodes in increasing order, and their images.
    fn with_images(&self, nodes: &[u32]) -> Vec<u32> {
        let images = nodes.iter().filter(|&&n| self.of[n as usize] != n).map(|&n| self.of[n as usize]);
        nodes.iter().copied().chain(images).collect()
    }
}

/// Local nodes of an element seen in the mirror: bottom and top change places, so that its volume
/// stays positive.
const MIRRORED: [usize; 8] = [4, 5, 6, 7, 0, 1, 2, 3];

/// The whole body, of the mesh of its half at y >= 0.
pub fn whole(half: &Mesh) -> Mesh {
    let is_shared: Vec<bool> = half.nodes.iter().map(|x| x[1] == 0.0).collect();
    let image = MirrorNumbers::new(&is_shared);
    let mirrored = |x: &[f64; 3]| [x[0], -x[1], x[2]];
    let doubled = image.doubled().map(|n| mirrored(&half.nodes[n as usize]));
    let nodes: Vec<[f64; 3]> = half.nodes.iter().copied().chain(doubled).collect();

    let of_image = |element: &[u32; 8]| MIRRORED.map(|a| image.of[element[a] as usize]);
    let elements: Vec<[u32; 8]> = half.elements.iter().copied().chain(half.elements.iter().map(of_image)).collect();
    let hanging: Vec<Hanging> = half.hanging.iter().copied().chain(half.hanging.iter().map(|h| h.renamed(MIRRORED))).collect();
    let order = sweep_order(nodes.len(), &elements);
    let elements: Vec<[u32; 8]> = order.iter().map(|&e| elements[e as usize]).collect();
    let hanging: Vec<Hanging> = order.iter().map(|&e| hanging[e as usize]).collect();

    // Counter-clockwise from outside again.
    let face = |[a, b, c, d]: [u32; 4]| [a, d, c, b].map(|n| image.of[n as usize]);
    let contact_faces = half.contact_faces.iter().copied().chain(half.contact_faces.iter().map(|&f| face(f))).collect();
    let at_contact = |values: &[f64], shared: f64| -> Vec<f64> {
        let own = half.contact_nodes.iter().zip(values).map(|(&n, &x)| if is_shared[n as usize] { shared * x } else { x });
        let images = half.contact_nodes.iter().zip(values).filter(|(n, _)| !is_shared[**n as usize]).map(|(_, &x)| x);
        own.chain(images).collect()
    };
    Mesh {
        node_elements: node_elements(nodes.len(), &elements),
        contact_nodes: image.with_images(&half.contact_nodes),
        contact_area: at_contact(&half.contact_area, 2.0),
        contact_size: at_contact(&half.contact_size, 1.0),
        plate_nodes: image.with_images(&half.plate_nodes),
        hierarchy: levels(&half.hierarchy, is_shared),
        nodes,
        elements,
        hanging,
        contact_faces,
        symmetry_nodes: Vec::new(),
        copies: 1,
        half: half.half.as_ref().map(|right| of_both(right, &half.nodes, &image)),
        fine_radius: half.fine_radius,
        couple: None,
    }
}

/// What of both halves is at x >= 0, from that of one.
fn of_both(right: &MirrorHalf, nodes: &[[f64; 3]], image: &MirrorNumbers) -> MirrorHalf {
    let is_shared = right.node.iter().map(|&n| nodes[n as usize][1] == 0.0).collect();
    MirrorHalf { node: image.with_images(&right.node), hierarchy: levels(&right.hierarchy, is_shared) }
}

/// The levels of both halves, from those of one and from what of its finest nodes lies at y = 0.
fn levels(half: &[Prolongation], mut is_shared: Vec<bool>) -> Vec<Prolongation> {
    half.iter()
        .map(|level| {
            let entries = |row: usize| level.row_start[row] as usize..level.row_start[row + 1] as usize;
            // Every coarse node is a fine one, whose row takes from it alone.
            let mut coarse_shared = vec![false; level.coarse_nodes];
            for (row, _) in is_shared.iter().enumerate().filter(|(_, shared)| **shared) {
                if let [only] = level.column[entries(row)] {
                    coarse_shared[only as usize] = true;
                }
            }
            let (fine, coarse) = (MirrorNumbers::new(&is_shared), MirrorNumbers::new(&coarse_shared));
            let mut joined =
                Prolongation { coarse_nodes: coarse.count, row_start: vec![0], column: Vec::new(), weight: Vec::new() };
            for row in 0..is_shared.len() {
                joined.column.extend(&level.column[entries(row)]);
                joined.weight.extend(&level.weight[entries(row)]);
                joined.row_start.push(joined.column.len() as u32);
            }
            for row in fine.doubled().map(|row| row as usize) {
                let images = level.column[entries(row)].iter().map(|&c| coarse.of[c as usize]);
                let mut row: Vec<(u32, f64)> = images.zip(level.weight[entries(row)].iter().copied()).collect();
                row.sort_by_key(|&(column, _)| column);
                joined.column.extend(row.iter().map(|&(column, _)| column));
                joined.weight.extend(row.iter().map(|&(_, weight)| weight));
                joined.row_start.push(joined.column.len() as u32);
            }
            is_shared = coarse_shared;
            joined
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::quality;
    use crate::mesh::{SphereSpec, sphere_mesh};

    fn half(skin_levels: usize) -> Mesh {
        let spec =
            SphereSpec { contact_radius: 0.2, elements_per_contact_radius: 6, fine_zone: 1.3, skin_levels, first_layer: 1.0 };
        sphere_mesh(&spec).unwrap()
    }

    #[test]
    fn a_whole_has_twice_the_volume_and_area_of_its_half() {
        for skin_levels in [0, 1, 2] {
            let half = half(skin_levels);
            let whole = whole(&half);
            assert_eq!((whole.elements.len(), whole.copies), (2 * half.elements.len(), 1));
            assert_eq!(whole.nodes.len(), 2 * half.nodes.len() - half.symmetry_nodes.len());
            assert!((quality::volume(&whole) / quality::volume(&half) - 2.0).abs() < 1e-12);
            let area = |mesh: &Mesh| mesh.contact_area.iter().sum::<f64>();
            assert!((area(&whole) / area(&half) - 2.0).abs() < 1e-12);
            assert!((0..whole.elements.len()).all(|e| quality::scaled_jacobian(&whole.corners(e)) > 0.0));
            assert!(whole.contact_nodes.is_sorted() && whole.plate_nodes.is_sorted());
            assert!(whole.plate_nodes.iter().all(|&n| whole.nodes[n as usize][2] == 1.0));
            let mut positions: Vec<[u64; 3]> = whole.nodes.iter().map(|x| (*x).map(|x| (x + 0.0).to_bits())).collect();
            positions.sort_unstable();
            positions.dedup();
            assert_eq!(positions.len(), whole.nodes.len());
            // The face of an image looks outwards too.
            let outwards = |mesh: &Mesh| {
                mesh.contact_faces.iter().all(|face| {
                    let [a, b, c, _] = face.map(|n| mesh.nodes[n as usize]);
                    let (s, t) = ([b[0] - a[0], b[1] - a[1]], [c[0] - a[0], c[1] - a[1]]);
                    s[0] * t[1] - s[1] * t[0] < 0.0
                })
            };
            assert!(outwards(&half) && outwards(&whole));
        }
    }

    #[test]
    fn the_levels_of_a_whole_keep_halves_apart() {
        for skin_levels in [0, 1] {
            let half = half(skin_levels);
            let whole = whole(&half);
            assert_eq!(whole.hierarchy.len(), half.hierarchy.len());
            let right = whole.half.clone().unwrap();
            assert!(right.node.iter().all(|&n| whole.nodes[n as usize][0] >= 0.0));
            assert_eq!(right.node.len(), whole.nodes.iter().filter(|x| x[0] >= 0.0).count());
            assert_eq!(right.hierarchy[0].row_start.len(), right.node.len() + 1);
            // Where a level's node lies in the body; what takes from two sides takes from the
            // middle.
            let mut y: Vec<f64> = whole.nodes.iter().map(|x| x[1]).collect();
            for level in &whole.hierarchy {
                assert_eq!(level.row_start.len(), y.len() + 1);
                let mut coarse = vec![f64::NAN; level.coarse_nodes];
                let rows = || (0..y.len()).map(|row| level.row_start[row] as usize..level.row_start[row + 1] as usize);
                for (entries, &y) in rows().zip(&y) {
                    if let [only] = level.column[entries] {
                        coarse[only as usize] = y;
                    }
                }
                assert!(coarse.iter().all(|y| y.is_finite()));
                for (entries, &y) in rows().zip(&y) {
                    assert!(level.column[entries.clone()].is_sorted());
                    assert!((level.weight[entries.clone()].iter().sum::<f64>() - 1.0).abs() < 1e-14);
                    let from = level.column[entries].iter().map(|&c| coarse[c as usize]);
                    assert!(from.into_iter().all(|from| if y == 0.0 { from == 0.0 } else { from * y >= 0.0 }));
                }
                y = coarse;
            }
        }
    }
}

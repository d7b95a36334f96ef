//! A structured box, for tests and for closed forms: bottom z = 0 touches, top is the plate, y = 0
//! is the symmetry plane.

use super::connectivity::{contact_measures, node_elements};
use super::hierarchy::{Between, Blocks, ClassMap, Site, hierarchy};
use super::{Hanging, Mesh, MeshError};

/// One block of cells along x, y, z.
struct BrickBlocks([usize; 3]);

impl Blocks for BrickBlocks {
    fn cells(&self) -> Vec<usize> {
        self.0.to_vec()
    }

    fn with_cells(&self, cells: &[usize]) -> Self {
        BrickBlocks([cells[0], cells[1], cells[2]])
    }

    fn sites(&self) -> Vec<Site> {
        let [nx, ny, nz] = self.0;
        let mut sites = Vec::with_capacity(self.node_count());
        for k in 0..=nz {
            for j in 0..=ny {
                sites.extend((0..=nx).map(|i| Site { block: 0, at: [i, j, k] }));
            }
        }
        sites
    }

    fn node_count(&self) -> usize {
        self.0.iter().map(|n| n + 1).product()
    }

    fn number(&self, site: Site) -> u32 {
        let [i, j, k] = site.at;
        (i + (self.0[0] + 1) * (j + (self.0[1] + 1) * k)) as u32
    }

    fn between(&self, _: &Self, site: Site, axis: usize, maps: &[ClassMap]) -> Between {
        maps[axis][site.at[axis]]
    }
}

/// A box of `nx` x `ny` x `nz` equal cells over [0, lx] x [0, ly] x [0, lz].
///
/// # Errors
/// A count of zero, a length that is not positive and finite, or too many nodes.
pub fn brick(nx: usize, ny: usize, nz: usize, lengths: [f64; 3]) -> Result<Mesh, MeshError> {
    let cells = [nx, ny, nz];
    let nodes = cells.iter().try_fold(1usize, |product, n| product.checked_mul(n.checked_add(1)?)).unwrap_or(usize::MAX);
    if cells.contains(&0) || lengths.iter().any(|l| !(l.is_finite() && *l > 0.0)) || nodes > 500_000_000 {
        return Err(MeshError::Brick { cells, lengths });
    }
    let blocks = BrickBlocks(cells);
    let node = |i, j, k| blocks.number(Site { block: 0, at: [i, j, k] });
    let sites = blocks.sites();
    let nodes: Vec<[f64; 3]> = sites.iter().map(|s| [0, 1, 2].map(|k| lengths[k] * (s.at[k] as f64 / cells[k] as f64))).collect();
    let mut elements = Vec::with_capacity(nx * ny * nz);
    for k in 0..nz {
        for j in 0..ny {
            for i in 0..nx {
                let at = |z| [node(i, j, z), node(i + 1, j, z), node(i + 1, j + 1, z), node(i, j + 1, z)];
                let ([a, b, c, d], [e, f, g, h]) = (at(k), at(k + 1));
                elements.push([a, b, c, d, e, f, g, h]);
            }
        }
    }
    let contact_faces: Vec<[u32; 4]> = elements[..nx * ny].iter().map(|e| [e[0], e[3], e[2], e[1]]).collect();
    let on = |axis: usize, index: usize| -> Vec<u32> {
        (0u32..).zip(&sites).filter(|(_, s)| s.at[axis] == index).map(|(n, _)| n).collect()
    };
    let contact_nodes = on(2, 0);
    let (contact_area, contact_size) = contact_measures(&nodes, &contact_faces, &contact_nodes);
    Ok(Mesh {
        node_elements: node_elements(nodes.len(), &elements),
        hanging: vec![Hanging::NONE; elements.len()],
        nodes,
        elements,
        contact_nodes,
        contact_faces,
        contact_area,
        contact_size,
        plate_nodes: on(2, nz),
        symmetry_nodes: on(1, 0),
        copies: 2,
        hierarchy: hierarchy(blocks),
        half: None,
        fine_radius: lengths[0].hypot(lengths[1]),
        couple: None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::connectivity::boundary_faces;
    use crate::mesh::quality;

    #[test]
    fn a_brick_has_its_volume_areas_and_faces() {
        let mesh = brick(3, 4, 5, [1.0, 2.0, 0.5]).unwrap();
        assert_eq!(mesh.elements.len(), 60);
        assert_eq!(mesh.nodes.len(), 120);
        assert!((quality::volume(&mesh) - 1.0).abs() < 1e-14);
        assert!((0..60).all(|e| (quality::scaled_jacobian(&mesh.corners(e)) - 1.0).abs() < 1e-12));
        assert_eq!(boundary_faces(&mesh.elements).len(), 2 * (12 + 15 + 20));
        assert!((mesh.contact_area.iter().sum::<f64>() - 2.0).abs() < 1e-14);
        assert!(mesh.contact_size.iter().all(|s| (s - (1f64 / 6.0).sqrt()).abs() < 1e-14));
        assert!(mesh.contact_nodes.iter().all(|&n| mesh.nodes[n as usize][2] == 0.0));
        assert!(mesh.plate_nodes.iter().all(|&n| mesh.nodes[n as usize][2] == 0.5) && mesh.plate_nodes.len() == 20);
        assert!(mesh.symmetry_nodes.iter().all(|&n| mesh.nodes[n as usize][1] == 0.0) && mesh.symmetry_nodes.len() == 24);
    }

    #[test]
    fn interpolation_keeps_linear_functions_of_an_even_brick() {
        let mesh = brick(16, 8, 8, [1.0, 1.0, 1.0]).unwrap();
        let coarse = brick(8, 4, 4, [1.0, 1.0, 1.0]).unwrap();
        let p = &mesh.hierarchy[0];
        assert_eq!(p.coarse_nodes, coarse.nodes.len());
        for (row, x) in mesh.nodes.iter().enumerate() {
            for (k, expected) in x.iter().enumerate() {
                let entries = p.row_start[row] as usize..p.row_start[row + 1] as usize;
                let value: f64 = entries.map(|e| p.weight[e] * coarse.nodes[p.column[e] as usize][k]).sum();
                assert!((value - expected).abs() < 1e-14);
            }
        }
        assert_eq!(mesh.hierarchy.len(), 1);
        assert!(brick(2, 2, 2, [1.0; 3]).unwrap().hierarchy.is_empty());
    }

    #[test]
    fn impossible_bricks_are_errors() {
        assert!(brick(0, 1, 1, [1.0; 3]).is_err());
        assert!(brick(1, 1, 1, [1.0, -1.0, 1.0]).is_err());
        assert!(brick(1, 1, 1, [1.0, f64::NAN, 1.0]).is_err());
        assert!(brick(usize::MAX, 1, 1, [1.0; 3]).is_err());
    }
}

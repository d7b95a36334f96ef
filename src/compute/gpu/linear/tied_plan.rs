//! What the linear systems of equal pairs take, before anything is allocated.

use super::levels::{product_numbers, shared_numbers, slot_numbers};
use super::records::Record;
use crate::contact::interface::Symmetry;
use crate::linalg::Pattern;
use crate::linalg::fold::{Fold, Folding};
use crate::linalg::layout::{HierarchyLayout, NOWHERE};
use crate::mesh::Mesh;

/// Maps of an interface.
const MAPS: usize = 5;
/// Numbers of a block of a map with its node.
pub(in super::super) const TIE_BLOCK: usize = 10;
/// Blocks of all maps of a slot that there is room for: by contact point, and some more for small
/// meshes. Rows of the seam are dense: half of a body has up to 57 by point, all of it up to 97.
const BLOCKS_OF_POINT: usize = 110;
const BLOCKS_OF_SEAM: usize = 6000;
/// What the systems of a pair take beside those of one body.
#[derive(Debug)]
pub struct TiedPlan {
    pub(super) layout: HierarchyLayout,
    /// By side, k and node of the half: a block of the upper triangle, and the signs that change.
    pub(super) sides: Vec<u32>,
    /// The whole body's nodes of each node of the half.
    pub(super) nodes_of: Vec<u32>,
    /// By node: as `unfold.wgsl` has them.
    pub(super) half_of: Vec<u32>,
    pub(super) contact_points: usize,
}

impl TiedPlan {
    /// That of a mesh; none if it cannot be folded. `source` as in [`super::plan::Plan::new`].
    pub fn new(mesh: &Mesh, pattern: &Pattern, source: &[u32]) -> Option<Self> {
        let half = mesh.half.as_ref()?;
        let fold = Fold::new(pattern, &half.node, &Symmetry::mirror(mesh).nodes)?;
        let layout = HierarchyLayout::new(&fold.matrix().pattern, &half.hierarchy).ok()?;
        let (finest, of_blocks) = (&layout.levels[0], fold.sources(pattern));
        let mut sides = Vec::with_capacity(4 * finest.source.len());
        for side in 0..2 {
            for &at in &finest.source {
                let found = if at == NOWHERE { None } else { of_blocks[at as usize].get(side) };
                sides.extend(found.map_or([NOWHERE, 0], |&(block, signs)| [source[block as usize], signs]));
            }
        }
        let mut half_of = vec![0; mesh.nodes.len()];
        for (a, &[own, opposite]) in (0..).zip(fold.nodes()) {
            half_of[opposite as usize] = 2 * a + 1;
            half_of[own as usize] = 2 * a;
        }
        let nodes_of = fold.nodes().iter().flatten().copied().collect();
        Some(Self { layout, sides, nodes_of, half_of, contact_points: mesh.contact_nodes.len() })
    }

    /// Words of a slot's maps that there is room for.
    pub fn words(&self) -> usize {
        words(self.contact_points)
    }

    /// Bytes of a slot's A P of the finest level, of both halves.
    pub fn product_bytes(&self) -> u64 {
        (2 * product_numbers(&self.layout.levels[0]) * size_of::<f32>()) as u64
    }

    /// Bytes of a slot: the widest array, and all together.
    pub fn bytes(&self) -> (u64, u64) {
        let (mut widest, mut all) = (self.words(), self.words());
        for (l, level) in self.layout.levels.iter().enumerate() {
            let (array, sum) = slot_numbers(level);
            let product = if l == 0 { 0 } else { product_numbers(level) };
            (widest, all) = (widest.max(2 * array).max(2 * product), all + 2 * (sum + product));
        }
        ((widest * size_of::<f32>()) as u64, (all * size_of::<f32>() + 2 * size_of::<Record>()) as u64)
    }

    /// Bytes of what the slots share.
    pub fn shared_bytes(&self) -> u64 {
        let levels: usize = self.layout.levels.iter().map(shared_numbers).sum();
        ((levels + self.sides.len() + self.nodes_of.len() + self.half_of.len()) * size_of::<u32>()) as u64 + SMALL_ARRAYS
    }
}

/// Words of a slot's maps that there is room for.
pub fn words(contact_points: usize) -> usize {
    MAPS * (contact_points + 1) + TIE_BLOCK * (BLOCKS_OF_POINT * contact_points + BLOCKS_OF_SEAM)
}

/// As `plan` has it.
const SMALL_ARRAYS: u64 = 8192;

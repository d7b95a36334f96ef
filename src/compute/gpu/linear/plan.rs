//! What the linear solver of a connectivity takes.

use super::super::layout::POINT_ROWS;
use super::levels::{product_numbers, shared_numbers, slot_numbers};
use super::records::Record;
use super::sizes::{CHUNK, RESTART, small_numbers};
use super::tied_plan::TiedPlan;
use crate::linalg::layout::{HierarchyLayout, NOWHERE};
use crate::mesh::Mesh;

/// What the linear solver of a connectivity needs to know, before anything is allocated.
#[derive(Debug)]
pub struct Plan {
    pub(super) layout: HierarchyLayout,
    /// Per block of the finest level: where it is in the tangent's upper triangle.
    pub(super) source: Vec<u32>,
    pub(super) point_of: Vec<u32>,
    pub(super) plate: Vec<u32>,
    pub(super) contact_points: usize,
    pub(super) upper_blocks: usize,
    /// The systems of pairs, if the batch is of those.
    pub(super) tied: Option<TiedPlan>,
}

impl Plan {
    /// The plan of a mesh; none if it has no hierarchy. `source` says for each block of the pattern
    /// which block of the upper triangle it is; `is_paired` says that the cases are equal pairs,
    /// turned half round y.
    pub fn new(
        mesh: &Mesh,
        pattern: &crate::linalg::Pattern,
        (source, upper_blocks): (&[u32], usize),
        is_paired: bool,
    ) -> Option<Self> {
        if mesh.hierarchy.is_empty() || mesh.couple.is_some() {
            return None;
        }
        let layout = HierarchyLayout::new(pattern, &mesh.hierarchy).ok()?;
        let finest = &layout.levels[0];
        let of_block = |&at: &u32| if at == NOWHERE { NOWHERE } else { source[at as usize] };
        let mut point_of = vec![NOWHERE; mesh.nodes.len()];
        for (point, &node) in mesh.contact_nodes.iter().enumerate() {
            point_of[node as usize] = point as u32;
        }
        Some(Self {
            source: finest.source.iter().map(of_block).collect(),
            point_of,
            plate: mesh.plate_nodes.clone(),
            contact_points: mesh.contact_nodes.len(),
            upper_blocks,
            tied: if is_paired { TiedPlan::new(mesh, pattern, source) } else { None },
            layout,
        })
    }

    /// Sizes of the tangent, and that no opponent is curved.
    pub(super) fn counts(&self) -> [u32; 4] {
        [self.upper_blocks as u32, self.contact_points as u32, 0, 0]
    }

    /// Bytes of a slot's Krylov vectors.
    pub fn krylov_bytes(&self) -> u64 {
        ((2 * RESTART + 1) * 3 * self.layout.levels[0].nodes * size_of::<f32>()) as u64
    }

    /// Bytes of a slot's A P of the finest level.
    pub fn product_bytes(&self) -> u64 {
        let own = (product_numbers(&self.layout.levels[0]) * size_of::<f32>()) as u64;
        own.max(self.tied.as_ref().map_or(0, TiedPlan::product_bytes))
    }

    /// Bytes of a slot but for these: the widest array, and all together.
    pub fn bytes(&self) -> (u64, u64) {
        let n = 3 * self.layout.levels[0].nodes;
        let (mut widest, mut all) = (n, 4 * n + small_numbers() + (RESTART + 3) * n.div_ceil(CHUNK));
        for (l, level) in self.layout.levels.iter().enumerate() {
            let (array, sum) = slot_numbers(level);
            let product = if l == 0 { 0 } else { product_numbers(level) };
            (widest, all) = (widest.max(array).max(product), all + sum + product);
        }
        let rows = POINT_ROWS * self.contact_points * size_of::<f32>();
        let tied = self.tied.as_ref().map_or((0, 0), TiedPlan::bytes);
        let own = ((widest * size_of::<f32>()) as u64, (all * size_of::<f32>() + rows + size_of::<Record>()) as u64);
        (own.0.max(tied.0), own.1 + tied.1)
    }

    /// Bytes of what the slots share: columns, lists, prolongations.
    pub fn shared_bytes(&self) -> u64 {
        let levels: usize = self.layout.levels.iter().map(shared_numbers).sum();
        let own = self.source.len() + self.point_of.len() + self.plate.len();
        ((levels + own) * size_of::<u32>()) as u64 + SMALL_ARRAYS + self.tied.as_ref().map_or(0, TiedPlan::shared_bytes)
    }
}

/// Bytes that uniform blocks and the padding of all shared arrays take at the most.
const SMALL_ARRAYS: u64 = 4096;

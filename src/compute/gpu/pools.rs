//! Memory that arrays have in turn: what one leaves is lost when the next is written.
//!
//! An iteration makes the elements' tangents, gathers them into blocks, forms the finest matrix of
//! these, takes A P of it on the way to the coarser ones, and iterates; then trials take stresses,
//! of which there may be some between two lists of Krylov iterations. So Krylov vectors may lie
//! where elements were, but not where stresses come.

use super::buffers::{ALIGNMENT, StorageBuffer};
use super::context::GpuContext;
use super::error::GpuError;

/// Bytes of a slot's share of each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PoolBytes {
    /// Of [`Pools::vectors`].
    pub vectors: u64,
    /// Of [`Pools::blocks`].
    pub blocks: u64,
}

impl PoolBytes {
    /// The wider one, and both, of a slot; with what the last binding's alignment may take, of
    /// which all slots together need one.
    pub fn widest_and_all(&self) -> (u64, u64) {
        (self.vectors.max(self.blocks) + ALIGNMENT, self.vectors + self.blocks + 2 * ALIGNMENT)
    }

    /// What is made for so many slots: of each pool.
    fn of_slots(&self, slots: usize) -> [u64; 2] {
        [self.vectors, self.blocks].map(|bytes| slots as u64 * bytes + ALIGNMENT)
    }
}

/// The memory of all slots.
#[derive(Debug)]
pub struct Pools {
    /// Tangents of elements, Krylov vectors, new states of a commit.
    pub vectors: StorageBuffer<u32>,
    /// Blocks of tangents, A P of the finest level, stresses of a force.
    pub blocks: StorageBuffer<u32>,
}

impl Pools {
    /// That of so many slots.
    ///
    /// # Errors
    /// As [`GpuContext::zeros`].
    pub fn new(context: &GpuContext, bytes: PoolBytes, slots: usize) -> Result<Self, GpuError> {
        let [vectors, blocks] = bytes.of_slots(slots).map(|bytes| bytes as usize / size_of::<u32>());
        Ok(Self {
            vectors: context.zeros("elements' tangents, Krylov vectors or new states", vectors)?,
            blocks: context.zeros("blocks of tangents, A P or stresses", blocks)?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_made_is_no_more_than_what_was_planned() {
        let bytes = PoolBytes { vectors: 1000, blocks: 1024 };
        let (widest, all) = bytes.widest_and_all();
        for slots in [1, 2, 7, 1000] {
            let made = bytes.of_slots(slots);
            assert!(made.iter().all(|made| *made <= slots as u64 * widest), "{slots}: {made:?}");
            assert!(made.iter().sum::<u64>() <= slots as u64 * all, "{slots}: {made:?}");
        }
    }
}

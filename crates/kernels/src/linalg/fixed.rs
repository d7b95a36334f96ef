//! The exact elimination of fixed unknowns: Dirichlet and contact unknowns whose matrix rows are
//! rows of the identity.

use super::kernel::Node;

/// Which unknowns are fixed, three bits a node.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Fixed {
    bits: Vec<u8>,
}

impl Fixed {
    /// From one flag an unknown.
    pub fn set(&mut self, fixed: &[bool]) {
        self.bits.clear();
        self.bits.extend(fixed.as_chunks::<3>().0.iter().map(|f| u8::from(f[0]) | u8::from(f[1]) << 1 | u8::from(f[2]) << 2));
    }

    /// The fixed components of a node, as bits.
    #[inline(always)]
    pub fn node(&self, node: usize) -> u8 {
        self.bits[node]
    }

    /// Sets the fixed entries of a vector to zero.
    pub fn clear(&self, x: &mut [f64]) {
        for (x, &bits) in x.as_chunks_mut::<3>().0.iter_mut().zip(&self.bits).filter(|(_, bits)| **bits != 0) {
            (0..3).filter(|c| bits >> c & 1 != 0).for_each(|c| x[c] = 0.0);
        }
    }

    /// As [`Fixed::clear`], for padded nodes.
    pub fn clear_nodes(&self, x: &mut [Node]) {
        for (x, &bits) in x.iter_mut().zip(&self.bits).filter(|(_, bits)| **bits != 0) {
            (0..3).filter(|c| bits >> c & 1 != 0).for_each(|c| x[c] = 0.0);
        }
    }

    /// Copies the fixed entries of `from` to `to`.
    pub fn copy(&self, from: &[f64], to: &mut [f64]) {
        for (i, &bits) in self.bits.iter().enumerate().filter(|(_, bits)| **bits != 0) {
            for c in 0..3 {
                if bits >> c & 1 != 0 {
                    to[3 * i + c] = from[3 * i + c];
                }
            }
        }
    }
}

//! Sparse LU (faer): the reference that the multigrid solver is tested against, and its fallback.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::LuError as FaerLuError;
use faer::sparse::linalg::lu::{LuRef, NumericLu, SymbolicLu, factorize_symbolic_lu};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMat};
use faer::{Conj, MatMut, Par};

use super::LinalgError;
use super::bsr::{BlockMatrix, Pattern};
use super::fixed::Fixed;

/// Memory the factors may take by default, in bytes.
pub const DEFAULT_MEMORY_LIMIT: usize = 8 << 30;

/// A sparse LU factorisation in f64 with partial pivoting and a fill-reducing column ordering. The ordering is made once for a
/// pattern. It is computed on one thread in a fixed order.
#[derive(Debug)]
pub struct DirectSolver {
    /// Memory in bytes that the factors may take, by estimate, before [`DirectSolver::update`] refuses.
    pub memory_limit: usize,
    pattern: Pattern,
    /// The scalar pattern in compressed columns.
    columns: SymbolicSparseColMat<usize>,
    /// Entry of the block matrix behind each scalar entry, `9 * block + place`.
    source: Vec<u32>,
    values: Vec<f64>,
    symbolic: Option<SymbolicLu<usize>>,
    numeric: NumericLu<usize, f64>,
    factorised: bool,
}

impl DirectSolver {
    /// A solver for matrices on `pattern`. Nothing expensive happens before the first update.
    pub fn new(pattern: &Pattern) -> Self {
        let rows = pattern.rows();
        let mut start = vec![0usize; rows + 1];
        for &j in pattern.column.iter() {
            start[j as usize + 1] += 1;
        }
        for j in 0..rows {
            start[j + 1] += start[j];
        }
        let mut next = start.clone();
        let mut transposed = vec![(0u32, 0u32); pattern.entries()];
        for i in 0..rows {
            for at in pattern.row(i) {
                let j = pattern.column[at] as usize;
                transposed[next[j]] = (i as u32, at as u32);
                next[j] += 1;
            }
        }
        let mut pointers = Vec::with_capacity(3 * rows + 1);
        let mut indices = Vec::with_capacity(9 * pattern.entries());
        let mut source = Vec::with_capacity(9 * pattern.entries());
        pointers.push(0);
        for j in 0..rows {
            for c in 0..3 {
                for &(i, at) in &transposed[start[j]..start[j + 1]] {
                    for r in 0..3 {
                        indices.push(3 * i as usize + r);
                        source.push(9 * at + 3 * r as u32 + c);
                    }
                }
                pointers.push(indices.len());
            }
        }
        let columns = SymbolicSparseColMat::new_checked(3 * rows, 3 * rows, pointers, None, indices);
        Self {
            memory_limit: DEFAULT_MEMORY_LIMIT,
            pattern: pattern.clone(),
            columns,
            values: vec![0.0; source.len()],
            source,
            symbolic: None,
            numeric: NumericLu::new(),
            factorised: false,
        }
    }

    /// Estimated memory of the factors, bytes: 15 n^(4/3) non-zeros of L and U together per unknown count n, the growth law of a
    /// three-dimensional mesh (George 1973) with a constant measured on hex8 bricks and a safety factor of two.
    pub fn memory_estimate(&self) -> usize {
        let n = 3.0 * self.pattern.rows() as f64;
        (8.0 * 2.0 * 60.0 * n.powf(4.0 / 3.0)) as usize
    }

    /// Factorises the matrix with its fixed unknowns eliminated.
    pub(super) fn update(&mut self, matrix: &BlockMatrix<f64>, fixed: &Fixed) -> Result<(), LinalgError> {
        self.factorised = false;
        let need = self.memory_estimate();
        if need > self.memory_limit {
            return Err(LinalgError::TooLarge { unknowns: matrix.unknowns(), need, limit: self.memory_limit });
        }
        let entries: &[f64] = matrix.blocks.as_flattened();
        for (value, &at) in self.values.iter_mut().zip(&self.source) {
            *value = entries[at as usize];
        }
        let (pointers, indices) = (self.columns.col_ptr(), self.columns.row_idx());
        for j in 0..matrix.unknowns() {
            for at in pointers[j]..pointers[j + 1] {
                let i = indices[at];
                if fixed.is_fixed(i) || fixed.is_fixed(j) {
                    self.values[at] = if i == j { 1.0 } else { 0.0 };
                } else if !self.values[at].is_finite() {
                    return Err(LinalgError::NotFinite { place: "the matrix", node: i / 3 });
                }
            }
        }
        let out_of_memory = |what: &dyn std::fmt::Debug| LinalgError::Factorisation { what: format!("{what:?}") };
        if self.symbolic.is_none() {
            let symbolic = factorize_symbolic_lu(self.columns.as_ref(), Default::default()).map_err(|e| out_of_memory(&e))?;
            self.symbolic = Some(symbolic);
        }
        let Some(symbolic) = &self.symbolic else { return Ok(()) };
        let a = SparseColMatRef::new(self.columns.as_ref(), &self.values);
        let scratch = symbolic.factorize_numeric_lu_scratch::<f64>(Par::Seq, Default::default());
        let mut memory = MemBuffer::try_new(scratch).map_err(|e| out_of_memory(&e))?;
        symbolic.factorize_numeric_lu(&mut self.numeric, a, Par::Seq, MemStack::new(&mut memory), Default::default()).map_err(
            |error| match error {
                FaerLuError::SymbolicSingular { index } => LinalgError::Singular { node: index / 3 },
                other => out_of_memory(&other),
            },
        )?;
        self.factorised = true;
        Ok(())
    }

    /// x = A^-1 x for the reduced system.
    pub(super) fn solve_in_place(&self, x: &mut [f64]) -> Result<(), LinalgError> {
        let Some(symbolic) = self.symbolic.as_ref().filter(|_| self.factorised) else { return Err(LinalgError::NotUpdated) };
        let n = x.len();
        let lu = LuRef::new_unchecked(symbolic, &self.numeric);
        let mut memory = MemBuffer::try_new(symbolic.solve_in_place_scratch::<f64>(1, Par::Seq))
            .map_err(|error| LinalgError::Factorisation { what: format!("{error:?}") })?;
        lu.solve_in_place_with_conj(Conj::No, MatMut::from_column_major_slice_mut(x, n, 1), Par::Seq, MemStack::new(&mut memory));
        match x.iter().position(|x| !x.is_finite()) {
            Some(at) => Err(LinalgError::Singular { node: at / 3 }),
            None => Ok(()),
        }
    }
}

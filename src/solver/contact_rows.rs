//! The rows of contact nodes in a matrix: turned into frames, replaced by what contact demands.

use crate::contact::coulomb::{Rows, Status};
use crate::contact::frame::ContactFrame;
use crate::linalg::bsr::BlockMatrix;
use crate::mesh::Mesh;
use crate::real::Real;

/// Replaces the contact nodes' rows by their contact conditions.
///
/// Rows of prescribed unknowns are left as they are: the linear solver takes `fixed` and never
/// reads them.
pub fn apply_contact<T: Real>(matrix: &mut BlockMatrix<T>, mesh: &Mesh, rows: &[Rows<f64>]) {
    for (rows, &node) in rows.iter().zip(&mesh.contact_nodes) {
        if rows.status == Status::Slip {
            apply_rows(matrix, node as usize, rows);
        }
    }
}

/// Turns the rows and columns of contact nodes into their frames, if they have any.
pub fn turn<T: Real>(matrix: &mut BlockMatrix<T>, mesh: &Mesh, frames: &[ContactFrame]) {
    for (q, &node) in frames.iter().zip(&mesh.contact_nodes) {
        turn_node(matrix, node as usize, q);
    }
}

/// Turns the row and the column of a node into a frame.
pub fn turn_node<T: Real>(matrix: &mut BlockMatrix<T>, node: usize, q: &ContactFrame) {
    for k in matrix.pattern.row(node) {
        let column = matrix.pattern.column[k] as usize;
        let a = matrix.blocks[k].map(T::to_f64);
        matrix.blocks[k] = std::array::from_fn(|m| T::of((0..3).map(|i| q[m / 3][i] * a[3 * i + m % 3]).sum()));
        // The pattern is symmetric.
        if let Some(k) = matrix.pattern.position(column, node) {
            let a = matrix.blocks[k].map(T::to_f64);
            matrix.blocks[k] = std::array::from_fn(|m| T::of((0..3).map(|j| a[3 * (m / 3) + j] * q[m % 3][j]).sum()));
        }
    }
}

/// Replaces the rows of a node by the conditions of its contact.
pub fn apply_rows<T: Real>(matrix: &mut BlockMatrix<T>, node: usize, rows: &Rows<f64>) {
    let diagonal = matrix.pattern.diagonal[node] as usize;
    for k in matrix.pattern.row(node) {
        let old = matrix.blocks[k].map(T::to_f64);
        matrix.blocks[k] = std::array::from_fn(|m| {
            let (i, j) = (m / 3, m % 3);
            let sum: f64 = (0..3).map(|m| rows.force_rows[i][m] * old[3 * m + j]).sum();
            T::of(if k == diagonal { sum + rows.displacement_rows[i][j] } else { sum })
        });
    }
}

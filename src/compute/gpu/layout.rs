//! Sizes of what host and kernels both know, in numbers. WGSL files state those that they use
//! again, under the same names; `agreement` compares them.

use crate::element::hex8::{NODES, PAIRS};

/// Parameters of a material.
pub const PARAMETERS: usize = 9;
/// Components of f - I, row by row.
pub const RELATIVE: usize = 9;
/// Components of a point's state: b_e_bar - I (xx, yy, zz, xy, yz, zx), alpha.
pub const STATE: usize = 7;
/// Components of a point's committed state and of what flowed in its last step.
pub const HISTORY: usize = 2 * STATE;
/// The same at the end of a step, with the point's elastic energy and plastic work.
pub const NEXT_HISTORY: usize = HISTORY + 2;
/// Components of an answer: deviatoric stress (6), b_e_bar - I (6), alpha, mu_bar, norm, normal
/// (6), beta_1, beta_3, beta_4, delta_gamma, plastic work, U', U'', U, W.
pub const ANSWER: usize = 30;
/// Components of the tangent: c_ab at 6 a + b.
pub const TANGENT: usize = 36;
/// Coordinates of an element's nodes.
pub const COORDINATES: usize = 3 * NODES;
/// Numbers of an element's tangent.
pub const ELEMENT_BLOCKS: usize = 9 * PAIRS;
/// Components of the stresses that a force is gathered from.
pub const STRESS: usize = 9;
/// Numbers that go to a contact point: force, increment.
pub const TRIAL: usize = 6;
/// Numbers of a contact point's conditions: residual, force rows, displacement rows.
pub const ROWS: usize = 3 + 2 * 9;
/// Numbers of a frame.
pub const FRAME: usize = 9;
/// Numbers of a contact point's conditions that an iterate keeps: those, status, weight, frame.
pub const CONDITIONS: usize = ROWS + 2 + FRAME;
/// Numbers that a contact point has in the linear solver: whether it slides, its rows, its frame.
pub const POINT_ROWS: usize = 1 + 2 * 9 + FRAME;
/// Numbers of a contact point before it moves: gap and position at the start of the step, the same
/// of the undeformed body, curvature of the opponent.
pub const FACING: usize = 2 * GAP_AND_POSITION + 1;
/// The first half of these.
pub const GAP_AND_POSITION: usize = 4;
/// What of them is read at a time: gap, position, curvature.
pub const FACED: usize = GAP_AND_POSITION + 1;
/// Numbers of a contact point that are recorded: displacement, force.
pub const AT_POINT: usize = 6;
/// Slots of a dispatch at the most: what is small for each of them is a block of parameters of this
/// length, with 16 bytes a slot.
pub const MOST_SLOTS: usize = 1024;
/// Bytes of the blocks of parameters by slot: cases, marks.
pub const BLOCKS_OF_SLOTS: u64 = 2 * (MOST_SLOTS * size_of::<[u32; 4]>()) as u64;
/// A contact point's node, where that lies on the symmetry plane.
pub const ON_SYMMETRY_PLANE: u32 = 1 << 31;

//! The kernels of elements, materials and contact: of which files each is made, in which order.

use super::kernel::Kernel;
use super::source::{ShaderSource, source};

/// Elementary functions.
pub const MATH: ShaderSource = source!("math.wgsl");
/// Vectors, matrices and symmetric tensors.
pub const TENSOR: ShaderSource = source!("tensor.wgsl");

/// Flow stress, slope, plastic work and the scalar return of every hardening law.
pub const HARDENING: ShaderSource = source!("material/hardening.wgsl");
/// The elastic half of the material, and its parameters by case.
pub const MATERIAL: ShaderSource = source!("material/material.wgsl");
/// Return mapping and tangent at a point.
pub const J2: ShaderSource = source!("material/j2.wgsl");
/// Flow to second order in the step.
pub const MULTISTEP: ShaderSource = source!("material/multistep.wgsl");
const RETURN_MAPPING_POINTS: ShaderSource = source!("material/return_mapping.wgsl");

/// The shape of a batch.
pub const BATCH: ShaderSource = source!("batch.wgsl");
/// Geometry and kinematics of the element.
pub const HEX8: ShaderSource = source!("element/hex8.wgsl");
/// Corners that hang.
pub const HANGING: ShaderSource = source!("element/hanging.wgsl");
/// The material of an element.
pub const BODY: ShaderSource = source!("element/body.wgsl");
/// A quadrature point at a trial displacement.
pub const PAIRS: ShaderSource = source!("element/pairs.wgsl");
const POINT: ShaderSource = source!("element/point.wgsl");
/// What it is evaluated at, for those who only read that.
const TRIALS: ShaderSource = source!("element/trials.wgsl");
/// Frames of surfaces.
pub const FRAME: ShaderSource = source!("contact/frame.wgsl");
/// Gap and frame over a rigid surface.
pub const RIGID: ShaderSource = source!("contact/rigid.wgsl");
/// What is known of a contact point before it moves.
pub const FACING: ShaderSource = source!("contact/facing.wgsl");
/// The contact conditions of a point.
pub const COULOMB: ShaderSource = source!("contact/coulomb.wgsl");

/// How they are stored.
pub const ROWS: ShaderSource = source!("contact/rows.wgsl");

/// The return mapping at every point of every active case; driven by [`super::material`].
pub static RETURN_MAPPING: Kernel =
    Kernel::new("return_mapping_points", &[MATH, TENSOR, HARDENING, MATERIAL, J2, RETURN_MAPPING_POINTS]);

/// det F - 1 of every quadrature point; this and the following are driven by [`super::batch`].
pub static HEX8_JACOBIAN: Kernel = Kernel::new("hex8_jacobian", &[BATCH, HEX8, HANGING, source!("element/jacobian.wgsl")]);

/// The weighted stress of every quadrature point.
pub static HEX8_INTERNAL_FORCE: Kernel = Kernel::new(
    "hex8_internal_force",
    &[BATCH, MATH, TENSOR, HARDENING, MATERIAL, J2, BODY, HEX8, HANGING, TRIALS, POINT, source!("element/internal_force.wgsl")],
);

/// The tangents of all elements, block by block.
pub static HEX8_TANGENT: Kernel = Kernel::new(
    "hex8_tangent",
    &[BATCH, MATH, TENSOR, HARDENING, MATERIAL, J2, BODY, HEX8, HANGING, TRIALS, POINT, PAIRS, source!("element/tangent.wgsl")],
);

/// The state from which every quadrature point starts a step.
pub static HEX8_BEGIN_STEP: Kernel = Kernel::new(
    "hex8_begin_step",
    &[BATCH, MATH, TENSOR, HARDENING, MATERIAL, J2, MULTISTEP, source!("element/begin_step.wgsl")],
);

/// The state of every quadrature point at the end of a step.
pub static HEX8_UPDATE: Kernel = Kernel::new(
    "hex8_update",
    &[
        BATCH,
        MATH,
        TENSOR,
        HARDENING,
        MATERIAL,
        J2,
        MULTISTEP,
        BODY,
        HEX8,
        HANGING,
        TRIALS,
        POINT,
        source!("element/update.wgsl"),
    ],
);

/// The energies of every element at the end of a step.
pub static HEX8_ENERGIES: Kernel = Kernel::new(
    "hex8_energies",
    &[BATCH, MATH, TENSOR, HARDENING, MATERIAL, J2, BODY, HEX8, HANGING, TRIALS, source!("element/energies.wgsl")],
);

/// A copy in single precision.
pub static NARROW: Kernel = Kernel::new("narrow", &[BATCH, source!("element/narrow.wgsl")]);

/// Stresses into nodal forces.
pub static GATHER_NODE_FORCE: Kernel =
    Kernel::new("gather_node_force", &[BATCH, HEX8, HANGING, TRIALS, source!("gather/node_force.wgsl")]);

/// Moduli into the tangent's upper block triangle.
pub static GATHER_TANGENT_BLOCKS: Kernel =
    Kernel::new("gather_tangent_blocks", &[BATCH, PAIRS, source!("gather/tangent_blocks.wgsl")]);

/// The contact conditions of every point.
pub static CONTACT_POINTS: Kernel =
    Kernel::new("contact_points", &[BATCH, FRAME, RIGID, FACING, COULOMB, ROWS, source!("contact/contact_points.wgsl")]);

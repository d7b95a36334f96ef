//! The kernels of Newton's iterates.

use super::super::kernel::Kernel;
use super::super::shader_sources::{BATCH, COULOMB, FACING, FRAME, RIGID, ROWS};
use super::super::source::{ShaderSource, source};

const TOLD: ShaderSource = source!("iterate/told.wgsl");
const ITERATE: ShaderSource = source!("iterate/iterate.wgsl");
const CONDITIONS: ShaderSource = source!("iterate/conditions.wgsl");
const FRAMES: ShaderSource = source!("iterate/frames.wgsl");
const NODE_INFO: ShaderSource = source!("iterate/node_info.wgsl");
const NODE_RESIDUAL: ShaderSource = source!("iterate/residual.wgsl");
const SUMS: ShaderSource = source!("linalg/sums.wgsl");
const PARTS: ShaderSource = source!("iterate/parts.wgsl");

/// The increments of a trial.
pub static PLACE: Kernel =
    Kernel::new("iterate_place", &[BATCH, TOLD, ITERATE, NODE_INFO, FRAME, RIGID, FACING, source!("iterate/place.wgsl")]);

/// Those of the current iterate.
pub static CURRENT: Kernel = Kernel::new("iterate_current", &[BATCH, TOLD, ITERATE, source!("iterate/current.wgsl")]);

/// Keeps the forces of a trial.
pub static SAVE: Kernel = Kernel::new("iterate_save", &[BATCH, TOLD, ITERATE, source!("iterate/save.wgsl")]);

/// The contact conditions of a trial.
pub static CONTACT: Kernel =
    Kernel::new("iterate_contact", &[BATCH, TOLD, ITERATE, FRAME, RIGID, FACING, COULOMB, ROWS, source!("iterate/contact.wgsl")]);

/// The sums of which its merit is made.
pub static MEASURE: Kernel = Kernel::new(
    "iterate_measure",
    &[BATCH, TOLD, ITERATE, CONDITIONS, NODE_INFO, FRAME, FRAMES, NODE_RESIDUAL, SUMS, PARTS, source!("iterate/measure.wgsl")],
);

/// What the host decides by.
pub static READ: Kernel = Kernel::new(
    "iterate_read",
    &[BATCH, TOLD, ITERATE, CONDITIONS, NODE_INFO, FRAME, FRAMES, COULOMB, SUMS, PARTS, source!("iterate/read.wgsl")],
);

/// The linear system at the current iterate.
pub static SYSTEM: Kernel = Kernel::new(
    "iterate_system",
    &[BATCH, TOLD, ITERATE, CONDITIONS, NODE_INFO, NODE_RESIDUAL, COULOMB, source!("iterate/system.wgsl")],
);

/// The correction.
pub static EXPAND: Kernel = Kernel::new(
    "iterate_expand",
    &[BATCH, TOLD, ITERATE, CONDITIONS, NODE_INFO, FRAME, FRAMES, NODE_RESIDUAL, source!("iterate/expand.wgsl")],
);

/// The system of the response to a unit indentation.
pub static UNIT: Kernel =
    Kernel::new("iterate_unit", &[BATCH, TOLD, ITERATE, CONDITIONS, NODE_INFO, FRAME, FRAMES, source!("iterate/unit.wgsl")]);

/// Keeps that response for the next iteration.
pub static RESPOND: Kernel = Kernel::new("iterate_respond", &[BATCH, TOLD, ITERATE, source!("iterate/respond.wgsl")]);

/// The change of h by which a normal force is held.
pub static DEPTH: Kernel = Kernel::new("iterate_depth", &[BATCH, TOLD, source!("iterate/depth.wgsl")]);

/// The correction with that change.
pub static PRESS: Kernel =
    Kernel::new("iterate_press", &[BATCH, TOLD, ITERATE, CONDITIONS, NODE_INFO, FRAME, FRAMES, source!("iterate/press.wgsl")]);

/// Points that come down again under full stick.
pub static LAND: Kernel = Kernel::new("iterate_land", &[BATCH, TOLD, ITERATE, CONDITIONS, COULOMB, source!("iterate/land.wgsl")]);

/// The committed displacement.
pub static COMMIT: Kernel = Kernel::new(
    "iterate_commit",
    &[BATCH, TOLD, ITERATE, CONDITIONS, NODE_INFO, FRAME, FRAMES, RIGID, FACING, COULOMB, source!("iterate/commit.wgsl")],
);

/// Energies of the body.
pub static ENERGIES: Kernel =
    Kernel::new("iterate_energies", &[BATCH, TOLD, ITERATE, SUMS, PARTS, source!("iterate/energies.wgsl")]);

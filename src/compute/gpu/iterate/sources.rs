//! The kernels of Newton's iterates.

use super::super::shader_sources::Binding::{Read, ReadWrite, Uniform};
use super::super::shader_sources::{ANSWER, BATCH, COULOMB, Kernel, PLANE, Source, source};

const TOLD: Source = source!("iterate/told.wgsl");
const ITERATE: Source = source!("iterate/iterate.wgsl");
const NODE_INFO: Source = source!("iterate/node_info.wgsl");
const NODE_RESIDUAL: Source = source!("iterate/residual.wgsl");
const SUMS: Source = source!("linalg/sums.wgsl");
const PARTS: Source = source!("iterate/parts.wgsl");

/// The increments of a trial.
pub static PLACE: Kernel = Kernel {
    name: "iterate_place",
    sources: &[BATCH, TOLD, ITERATE, NODE_INFO, PLANE, source!("iterate/place.wgsl")],
    bindings: &[Uniform, Read, Read, Read, Read, Read, Read, Read, Read, Read, ReadWrite, ReadWrite],
    workgroup: 64,
};

/// Those of the current iterate.
pub static CURRENT: Kernel = Kernel {
    name: "iterate_current",
    sources: &[BATCH, TOLD, ITERATE, source!("iterate/current.wgsl")],
    bindings: &[Uniform, Read, Read, Read, Read, Read, ReadWrite],
    workgroup: 64,
};

/// Keeps the forces of a trial.
pub static SAVE: Kernel = Kernel {
    name: "iterate_save",
    sources: &[BATCH, TOLD, ITERATE, source!("iterate/save.wgsl")],
    bindings: &[Uniform, Read, Read, Read, Read, Read, ReadWrite],
    workgroup: 64,
};

/// The contact conditions of a trial.
pub static CONTACT: Kernel = Kernel {
    name: "iterate_contact",
    sources: &[BATCH, TOLD, ITERATE, PLANE, COULOMB, ANSWER, source!("iterate/contact.wgsl")],
    bindings: &[Uniform, Read, Read, Read, Read, Read, Read, Read, Read, Read, Read, Read, Read, ReadWrite, ReadWrite],
    workgroup: 64,
};

/// The sums of which its merit is made.
pub static MEASURE: Kernel = Kernel {
    name: "iterate_measure",
    sources: &[BATCH, TOLD, ITERATE, NODE_INFO, NODE_RESIDUAL, SUMS, PARTS, source!("iterate/measure.wgsl")],
    bindings: &[Uniform, Read, Read, Read, Read, Read, Read, Read, Read, Read, Read, Read, Read, Read, ReadWrite],
    workgroup: 256,
};

/// What the host decides by.
pub static READ: Kernel = Kernel {
    name: "iterate_read",
    sources: &[BATCH, TOLD, ITERATE, COULOMB, SUMS, PARTS, source!("iterate/read.wgsl")],
    bindings: &[Uniform, Read, Read, Read, Read, Read, Read, Read, Read, Read, Read, Read, Read, ReadWrite, ReadWrite, ReadWrite],
    workgroup: 256,
};

/// The linear system at the current iterate.
pub static SYSTEM: Kernel = Kernel {
    name: "iterate_system",
    sources: &[BATCH, TOLD, ITERATE, NODE_INFO, NODE_RESIDUAL, COULOMB, source!("iterate/system.wgsl")],
    bindings: &[Uniform, Read, Read, Read, Read, Read, Read, Read, Read, Read, Read, Read, Read, ReadWrite, ReadWrite, ReadWrite],
    workgroup: 64,
};

/// The correction.
pub static EXPAND: Kernel = Kernel {
    name: "iterate_expand",
    sources: &[BATCH, TOLD, ITERATE, NODE_INFO, NODE_RESIDUAL, source!("iterate/expand.wgsl")],
    bindings: &[Uniform, Read, Read, Read, Read, Read, Read, Read, Read, Read, Read, Read, Read, Read, ReadWrite, ReadWrite],
    workgroup: 64,
};

/// The system of the response to a unit indentation.
pub static UNIT: Kernel = Kernel {
    name: "iterate_unit",
    sources: &[BATCH, TOLD, ITERATE, NODE_INFO, source!("iterate/unit.wgsl")],
    bindings: &[Uniform, Read, Read, Read, Read, Read, Read, Read, ReadWrite, ReadWrite],
    workgroup: 64,
};

/// Keeps that response for the next iteration.
pub static RESPOND: Kernel = Kernel {
    name: "iterate_respond",
    sources: &[BATCH, TOLD, ITERATE, source!("iterate/respond.wgsl")],
    bindings: &[Uniform, Read, Read, Read, Read, Read, Read, Read, ReadWrite],
    workgroup: 64,
};

/// The change of h by which a normal force is held.
pub static DEPTH: Kernel = Kernel {
    name: "iterate_depth",
    sources: &[BATCH, TOLD, source!("iterate/depth.wgsl")],
    bindings: &[Uniform, Read, Read, Read, Read, Read, ReadWrite],
    workgroup: 64,
};

/// The correction with that change.
pub static PRESS: Kernel = Kernel {
    name: "iterate_press",
    sources: &[BATCH, TOLD, ITERATE, source!("iterate/press.wgsl")],
    bindings: &[Uniform, Read, Read, Read, Read, Read, Read, ReadWrite],
    workgroup: 64,
};

/// Points that come down again under full stick.
pub static LAND: Kernel = Kernel {
    name: "iterate_land",
    sources: &[BATCH, TOLD, ITERATE, COULOMB, source!("iterate/land.wgsl")],
    bindings: &[Uniform, Read, Read, Read, Read, Read, ReadWrite, ReadWrite],
    workgroup: 64,
};

/// The committed displacement.
pub static COMMIT: Kernel = Kernel {
    name: "iterate_commit",
    sources: &[BATCH, TOLD, ITERATE, NODE_INFO, PLANE, COULOMB, source!("iterate/commit.wgsl")],
    bindings: &[
        Uniform, Read, Read, Read, Read, Read, Read, Read, Read, Read, Read, ReadWrite, ReadWrite, ReadWrite, ReadWrite,
        ReadWrite,
    ],
    workgroup: 64,
};

/// Energies of the body.
pub static ENERGIES: Kernel = Kernel {
    name: "iterate_energies",
    sources: &[BATCH, TOLD, ITERATE, SUMS, PARTS, source!("iterate/energies.wgsl")],
    bindings: &[Uniform, Read, Read, Read, Read, Read, ReadWrite],
    workgroup: 256,
};

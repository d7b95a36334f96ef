//! The WGSL of every kernel: which files, in which order, with which arguments.

use std::fmt;

use super::iterate::sources as iterate;
use super::linear::sources as linear;

/// The precision in which a kernel is compiled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Precision {
    /// Single.
    F32,
    /// Double: needs SHADER_F64.
    F64,
}

impl Precision {
    /// Both.
    pub const ALL: [Self; 2] = [Self::F32, Self::F64];

    fn prelude(self) -> Source {
        match self {
            Self::F32 => PRELUDE_F32,
            Self::F64 => PRELUDE_F64,
        }
    }
}

impl fmt::Display for Precision {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::F32 => "f32",
            Self::F64 => "f64",
        })
    }
}

/// One WGSL file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Source {
    /// Path from the repository root.
    pub path: &'static str,
    /// Contents.
    pub text: &'static str,
}

macro_rules! source {
    ($path:literal) => {
        $crate::compute::gpu::shader_sources::Source {
            path: concat!("shaders/", $path),
            text: include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/shaders/", $path)),
        }
    };
}
pub(super) use source;

const PRELUDE_F32: Source = source!("prelude_f32.wgsl");
const PRELUDE_F64: Source = source!("prelude_f64.wgsl");
/// Elementary functions.
pub const MATH: Source = source!("math.wgsl");
/// Vectors, matrices and symmetric tensors.
pub const TENSOR: Source = source!("tensor.wgsl");

/// Flow stress, slope, plastic work and the scalar return of every hardening law.
pub const HARDENING: Source = source!("material/hardening.wgsl");
/// The elastic half of the material, and its parameters by case.
pub const MATERIAL: Source = source!("material/material.wgsl");
/// Return mapping and tangent at a point.
pub const J2: Source = source!("material/j2.wgsl");
/// Flow to second order in the step.
pub const MULTISTEP: Source = source!("material/multistep.wgsl");
const RETURN_MAPPING_POINTS: Source = source!("material/return_mapping.wgsl");

/// The shape of a batch.
pub const BATCH: Source = source!("batch.wgsl");
/// Geometry and kinematics of the element.
pub const HEX8: Source = source!("element/hex8.wgsl");
/// Corners that hang.
pub const HANGING: Source = source!("element/hanging.wgsl");
/// The material of an element.
pub const BODY: Source = source!("element/body.wgsl");
/// A quadrature point at a trial displacement.
pub const PAIRS: Source = source!("element/pairs.wgsl");
const POINT: Source = source!("element/point.wgsl");
/// Gap and slip.
pub const PLANE: Source = source!("contact/plane.wgsl");
/// The contact conditions of a point.
pub const COULOMB: Source = source!("contact/coulomb.wgsl");

/// How they are stored.
pub const ANSWER: Source = source!("contact/answer.wgsl");

/// How a kernel sees an argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Binding {
    /// `var<uniform>`.
    Uniform,
    /// `var<storage, read>`.
    Read,
    /// `var<storage, read_write>`.
    ReadWrite,
}

/// A kernel: one entry point and what it needs.
#[derive(Debug)]
pub struct Kernel {
    /// Name, unique; also the name of the entry point.
    pub name: &'static str,
    /// Its files after the prelude, in order.
    pub sources: &'static [Source],
    /// Its arguments: `@group(0) @binding(i)` is the i-th.
    pub bindings: &'static [Binding],
    /// Threads in a workgroup (all along x).
    pub workgroup: u32,
}

/// Every kernel of the program.
pub static KERNELS: &[&Kernel] = &[
    &RETURN_MAPPING,
    &HEX8_JACOBIAN,
    &HEX8_INTERNAL_FORCE,
    &HEX8_TANGENT,
    &HEX8_BEGIN_STEP,
    &HEX8_UPDATE,
    &HEX8_ENERGIES,
    &NARROW,
    &GATHER_NODE_FORCE,
    &GATHER_TANGENT_BLOCKS,
    &CONTACT_POINTS,
    &linear::ASSEMBLE,
    &linear::INVERT_DIAGONAL,
    &linear::GALERKIN_PRODUCT,
    &linear::GALERKIN_COARSE,
    &linear::PRESCRIBE,
    &linear::SMOOTH_START,
    &linear::SMOOTH_STEP,
    &linear::CYCLE_RESIDUAL,
    &linear::SOLVE_COARSEST,
    &linear::SMALL_DOWN,
    &linear::SMALL_UP,
    &linear::RESIDUAL,
    &linear::RESTRICT,
    &linear::PROLONG,
    &linear::KRYLOV_PRODUCT,
    &linear::KRYLOV_DOTS,
    &linear::KRYLOV_ORTHOGONALISE,
    &linear::KRYLOV_MEASURE,
    &linear::KRYLOV_BEGIN,
    &linear::KRYLOV_ADVANCE,
    &linear::KRYLOV_RUNNING,
    &linear::KRYLOV_NORMALISE,
    &linear::KRYLOV_LEAST_SQUARES,
    &linear::KRYLOV_COMBINE,
    &linear::PLATE_FORCE,
    &iterate::PLACE,
    &iterate::CURRENT,
    &iterate::SAVE,
    &iterate::CONTACT,
    &iterate::MEASURE,
    &iterate::READ,
    &iterate::SYSTEM,
    &iterate::EXPAND,
    &iterate::UNIT,
    &iterate::RESPOND,
    &iterate::DEPTH,
    &iterate::PRESS,
    &iterate::LAND,
    &iterate::COMMIT,
    &iterate::ENERGIES,
];

use Binding::{Read, ReadWrite, Uniform};

/// The return mapping at every point of every active case; driven by [`super::material`].
pub static RETURN_MAPPING: Kernel = Kernel {
    name: "return_mapping_points",
    sources: &[MATH, TENSOR, HARDENING, MATERIAL, J2, RETURN_MAPPING_POINTS],
    bindings: &[
        Binding::Uniform,
        Binding::Read,
        Binding::Read,
        Binding::Read,
        Binding::ReadWrite,
        Binding::ReadWrite,
        Binding::ReadWrite,
        Binding::Read,
        Binding::Read,
    ],
    workgroup: 64,
};

/// det F - 1 of every quadrature point; this and the following are driven by [`super::batch`].
pub static HEX8_JACOBIAN: Kernel = Kernel {
    name: "hex8_jacobian",
    sources: &[BATCH, HEX8, HANGING, source!("element/jacobian.wgsl")],
    bindings: &[Uniform, Read, Read, Read, Read, Read, Read, ReadWrite],
    workgroup: 64,
};

/// The weighted stress of every quadrature point.
pub static HEX8_INTERNAL_FORCE: Kernel = Kernel {
    name: "hex8_internal_force",
    sources: &[BATCH, MATH, TENSOR, HARDENING, MATERIAL, J2, BODY, HEX8, HANGING, POINT, source!("element/internal_force.wgsl")],
    bindings: &[Uniform, Read, Read, Read, Read, Read, Read, Read, Read, Read, Read, ReadWrite, ReadWrite],
    workgroup: 64,
};

/// The tangents of all elements, block by block.
pub static HEX8_TANGENT: Kernel = Kernel {
    name: "hex8_tangent",
    sources: &[BATCH, MATH, TENSOR, HARDENING, MATERIAL, J2, BODY, HEX8, HANGING, POINT, PAIRS, source!("element/tangent.wgsl")],
    bindings: &[Uniform, Read, Read, Read, Read, Read, Read, Read, Read, Read, Read, ReadWrite, ReadWrite],
    workgroup: 64,
};

/// The state from which every quadrature point starts a step.
pub static HEX8_BEGIN_STEP: Kernel = Kernel {
    name: "hex8_begin_step",
    sources: &[BATCH, MATH, TENSOR, HARDENING, MATERIAL, J2, MULTISTEP, source!("element/begin_step.wgsl")],
    bindings: &[Uniform, Read, Read, Read, ReadWrite],
    workgroup: 64,
};

/// The state of every quadrature point at the end of a step.
pub static HEX8_UPDATE: Kernel = Kernel {
    name: "hex8_update",
    sources: &[
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
        POINT,
        source!("element/update.wgsl"),
    ],
    bindings: &[Uniform, Read, Read, Read, Read, Read, Read, Read, Read, Read, Read, ReadWrite, Read, ReadWrite, ReadWrite],
    workgroup: 64,
};

/// The energies of every element at the end of a step.
pub static HEX8_ENERGIES: Kernel = Kernel {
    name: "hex8_energies",
    sources: &[BATCH, MATH, TENSOR, HARDENING, MATERIAL, J2, BODY, HEX8, HANGING, source!("element/energies.wgsl")],
    bindings: &[Uniform, Read, Read, Read, Read, Read, Read, Read, Read, Read, Read, Read, Read, ReadWrite],
    workgroup: 64,
};

/// A copy in single precision.
pub static NARROW: Kernel = Kernel {
    name: "narrow",
    sources: &[BATCH, source!("element/narrow.wgsl")],
    bindings: &[Uniform, Read, Uniform, Read, ReadWrite],
    workgroup: 64,
};

/// Stresses into nodal forces.
pub static GATHER_NODE_FORCE: Kernel = Kernel {
    name: "gather_node_force",
    sources: &[BATCH, HEX8, HANGING, source!("gather/node_force.wgsl")],
    bindings: &[Uniform, Read, Read, Read, Read, Read, Read, Read, Read, Read, ReadWrite],
    workgroup: 64,
};

/// Moduli into the tangent's upper block triangle.
pub static GATHER_TANGENT_BLOCKS: Kernel = Kernel {
    name: "gather_tangent_blocks",
    sources: &[BATCH, PAIRS, source!("gather/tangent_blocks.wgsl")],
    bindings: &[Uniform, Read, Read, Read, Read, ReadWrite],
    workgroup: 64,
};

/// The contact conditions of every point.
pub static CONTACT_POINTS: Kernel = Kernel {
    name: "contact_points",
    sources: &[BATCH, PLANE, COULOMB, ANSWER, source!("contact/contact_points.wgsl")],
    bindings: &[Uniform, Read, Read, Read, Read, Read, Read, ReadWrite, ReadWrite],
    workgroup: 64,
};

impl Kernel {
    /// The whole source in one precision.
    pub fn assemble(&self, precision: Precision) -> Assembled {
        let mut parts = vec![precision.prelude()];
        parts.extend_from_slice(self.sources);
        Assembled::new(precision, &parts)
    }
}

/// Concatenated sources that know where each line came from.
#[derive(Clone, Debug)]
pub struct Assembled {
    /// The WGSL.
    pub text: String,
    /// The precision it was assembled for.
    pub precision: Precision,
    /// First byte and path of each part; the first part is the prelude.
    parts: Vec<(usize, &'static str)>,
}

impl Assembled {
    /// Concatenates `parts`, of which the first is the prelude.
    pub fn new(precision: Precision, parts: &[Source]) -> Self {
        let mut text = String::new();
        let mut starts = Vec::with_capacity(parts.len());
        for part in parts {
            starts.push((text.len(), part.path));
            text.push_str(part.text);
            text.push('\n');
        }
        Self { text, precision, parts: starts }
    }

    /// `file:line` of a byte.
    pub fn place(&self, byte: usize) -> String {
        let byte = byte.min(self.text.len());
        let (start, path) = self.parts.iter().rev().find(|(start, _)| *start <= byte).copied().unwrap_or((0, "shaders"));
        let line = self.text.as_bytes()[start..byte].iter().filter(|&&b| b == b'\n').count() + 1;
        format!("{path}:{line}")
    }

    /// Whether a byte belongs to the prelude, where the precision may be named.
    pub fn in_prelude(&self, byte: usize) -> bool {
        self.parts.get(1).is_none_or(|(start, _)| byte < *start)
    }

    /// First byte after the prelude.
    pub fn shared_start(&self) -> usize {
        self.parts.get(1).map_or(self.text.len(), |(start, _)| *start)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_file_and_line() {
        let a = Source { path: "a.wgsl", text: "one\ntwo\n" };
        let b = Source { path: "b.wgsl", text: "three\nfour" };
        let assembled = Assembled::new(Precision::F32, &[a, b]);
        assert_eq!(assembled.text, "one\ntwo\n\nthree\nfour\n");
        let place = |word: &str| assembled.place(assembled.text.find(word).unwrap());
        assert_eq!(["one", "two", "three", "four"].map(place), ["a.wgsl:1", "a.wgsl:2", "b.wgsl:1", "b.wgsl:2"]);
        assert!(assembled.in_prelude(5) && !assembled.in_prelude(9));
        assert_eq!(assembled.shared_start(), 9);
    }

    #[test]
    fn kernel_names_are_unique() {
        let mut names: Vec<_> = KERNELS.iter().map(|k| k.name).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), KERNELS.len());
    }
}

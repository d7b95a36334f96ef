//! Host and kernels agree on the numbers that both know: naga says what those of the WGSL are.

use std::collections::BTreeMap;
use std::mem::offset_of;

use super::dispatch::{outcomes, status_of};
use super::iterate::arrays::{CAME_OFF, FIRST_POINT, IS_PLATE, NUMBERS, PARTS, READINGS, SLIDES};
use super::iterate::marks::{flags, number, source};
use super::kernels::KERNELS;
use super::layout;
use super::linear::records::{CONVERGED, FULL, NOT_FINITE, RUNNING, Record};
use super::linear::sizes::{CHUNK, LevelShape, MOST_STEPS, NODES_IN_GROUP, ROWS_IN_GROUP, SMALL_NODES, THREADS, small_numbers};
use super::linear::tied::{TIE_CLEARS, TIE_KEEPS_FREE, TIE_OF_ALL};
use super::linear::tied_plan::TIE_BLOCK;
use super::resident::{FULL_STICK, HANGS_AT, HAS_HANGING, OCTANT_AT, SOME_HANG};
use super::source::Precision;
use super::validate::validate;
use super::{material, scratch};
use crate::compute::{Evaluated, Fault};
use crate::contact::coulomb::Status;
use crate::element::hex8::Invalid;
use crate::linalg::layout::NOWHERE;
use crate::material::{HardeningLaw, Refusal};
use material::PointStatus;
use naga::{Expression, Literal, Module, TypeInner};

/// Constants that only kernels know.
const OWN: &[&str] = &[
    "HOLLOMON_STRAIN",
    "HOLLOMON_STRESS",
    "IS_PRESCRIBED",
    "NODE",
    "POINTS_IN_GROUP",
    "POWER_STEP",
    "REFUSED_BY_KINEMATICS",
    "REFUSED_BY_MATERIAL",
    "SMALL_THREADS",
    "STALLED",
    "VOCE_INCREMENT",
];

/// Words of a record of which kernels in double precision know the bits alone.
const WORD: usize = size_of::<u32>();

/// Constants that the host knows as well.
fn of_host() -> BTreeMap<&'static str, u32> {
    let sizes = [
        ("PARAMETERS", layout::PARAMETERS),
        ("RELATIVE", layout::RELATIVE),
        ("STATE", layout::STATE),
        ("HISTORY", layout::HISTORY),
        ("NEXT_HISTORY", layout::NEXT_HISTORY),
        ("ANSWER", layout::ANSWER),
        ("TANGENT", layout::TANGENT),
        ("ELEMENT_BLOCKS", layout::ELEMENT_BLOCKS),
        ("STRESS", layout::STRESS),
        ("TRIAL", layout::TRIAL),
        ("ROWS", layout::ROWS),
        ("CONDITIONS", layout::CONDITIONS),
        ("CODE", layout::ROWS),
        ("WEIGHT", layout::ROWS + 1),
        ("FRAME", layout::ROWS + 2),
        ("FACING", layout::FACING),
        ("FROM_START", 0),
        ("FROM_REFERENCE", layout::GAP_AND_POSITION),
        ("CURVATURE", 2 * layout::GAP_AND_POSITION),
        ("MOST_SLOTS", layout::MOST_SLOTS),
        ("MOST_STEPS", MOST_STEPS),
        ("SMALL_UNKNOWNS", 3 * SMALL_NODES),
        ("POINT_ROWS", layout::POINT_ROWS),
        ("POINT_FRAME", layout::POINT_ROWS - layout::FRAME),
        ("AT_POINT", layout::AT_POINT),
        ("CHUNK", CHUNK),
        ("THREADS", THREADS),
        ("NODES_IN_GROUP", NODES_IN_GROUP),
        ("ROWS_IN_GROUP", ROWS_IN_GROUP),
        ("TIE_BLOCK", TIE_BLOCK),
        ("RECORD", size_of::<Record>() / WORD),
        ("ALONG", offset_of!(Record, along) / WORD),
        ("NUMBERS", NUMBERS),
        ("READINGS", READINGS),
        ("PARTS", PARTS),
        ("STEP", number::STEP),
        ("DEPTH", number::DEPTH),
        ("SHEAR", number::SHEAR),
        ("DEPTH_CHANGE", number::DEPTH_CHANGE),
        ("HELD_FORCE", number::HELD_FORCE),
        ("RATIO", number::RATIO),
        ("SHIFT_Z", number::SHIFT_Z),
        ("MISSING", number::MISSING),
        ("BACK", number::BACK),
    ];
    let words = [
        ("NOWHERE", NOWHERE),
        ("NO_COLUMN", NOWHERE),
        ("RUNNING", RUNNING),
        ("CONVERGED", CONVERGED),
        ("FULL", FULL),
        ("NOT_FINITE", NOT_FINITE),
        ("TIE_CLEARS", TIE_CLEARS),
        ("TIE_KEEPS_FREE", TIE_KEEPS_FREE),
        ("TIE_OF_ALL", TIE_OF_ALL),
        ("SOME_HANG", SOME_HANG),
        ("OCTANT_AT", OCTANT_AT),
        ("HANGS_AT", HANGS_AT),
        ("HAS_HANGING", HAS_HANGING),
        ("IS_PLATE", IS_PLATE),
        ("ON_SYMMETRY_PLANE", layout::ON_SYMMETRY_PLANE),
        ("SLIDES", SLIDES),
        ("CAME_OFF", CAME_OFF),
        ("FIRST_POINT", FIRST_POINT),
        ("PLACES_PLATE", flags::PLACES_PLATE),
        ("HOLDS_FORCE", flags::HOLDS_FORCE),
        ("LIFTS", flags::LIFTS),
        ("IS_FIRST", flags::IS_FIRST),
        ("LANDS", flags::LANDS),
        ("ALONG_CORRECTION", source::ALONG_CORRECTION),
        ("EXTRAPOLATED", source::EXTRAPOLATED),
        ("AT_START", source::AT_START),
        ("SHIFTED", source::SHIFTED),
    ];
    sizes.into_iter().map(|(name, size)| (name, size as u32)).chain(words).collect()
}

/// Names by which the host decodes a number: each stands for what it says.
fn is_decoded(name: &str, value: u32) -> Option<bool> {
    let law = |law: &HardeningLaw| law.word().to_uppercase() == name;
    Some(match name {
        "OPEN" => status_of(value) == Status::Open,
        "STICK" => status_of(value) == Status::Stick,
        "SLIP" => status_of(value) == Status::Slip,
        "STATUS_ELASTIC" => PointStatus::of(value) == PointStatus::Elastic,
        "STATUS_YIELDING" => PointStatus::of(value) == PointStatus::Yielding,
        "STATUS_INVERTED" => PointStatus::of(value) == PointStatus::Inverted,
        "STATUS_NOT_FINITE" => PointStatus::of(value) == PointStatus::NotFinite,
        _ => u32::from(HardeningLaw::ALL.iter().find(|found| law(found))?.code()) == value,
    })
}

fn modules() -> impl Iterator<Item = (&'static str, Module)> {
    KERNELS.iter().map(|kernel| (kernel.name, validate(&kernel.assemble(Precision::F32)).unwrap().module))
}

fn constants(module: &Module) -> BTreeMap<String, Literal> {
    let value = |(_, constant): (_, &naga::Constant)| match module.global_expressions[constant.init] {
        Expression::Literal(value) => Some((constant.name.clone()?, value)),
        _ => None,
    };
    module.constants.iter().filter_map(value).collect()
}

#[test]
fn whole_numbers_are_the_same_on_both_sides() {
    let host = of_host();
    let mut seen = Vec::new();
    for (kernel, module) in modules() {
        for (name, value) in constants(&module) {
            let Literal::U32(value) = value else { continue };
            match (host.get(name.as_str()), is_decoded(&name, value)) {
                (Some(of_host), _) => assert_eq!(value, *of_host, "{name} in {kernel}"),
                (None, Some(same)) => assert!(same, "{name} in {kernel} is {value}"),
                (None, None) => assert!(OWN.contains(&name.as_str()), "{name} in {kernel} is not said to be the kernels' own"),
            }
            seen.push(name);
        }
    }
    for name in host.keys().chain(OWN) {
        assert!(seen.iter().any(|found| found == name), "{name} is in no kernel");
    }
}

#[test]
fn what_else_is_decoded_is_what_kernels_say() {
    let all: BTreeMap<String, Literal> = modules().flat_map(|(_, module)| constants(&module)).collect();
    assert_eq!(all["FULL_STICK"], Literal::F32(FULL_STICK as f32));
    let [Literal::U32(by_kinematics), Literal::U32(by_material)] =
        ["REFUSED_BY_KINEMATICS", "REFUSED_BY_MATERIAL"].map(|name| all[name])
    else {
        panic!("codes are whole numbers")
    };
    // As `refuse` of point.wgsl codes them, at point 3 of element 5.
    let outcome = |by: u32, is_not_finite: u32| outcomes(&[32 * 5 + by + 2 * 3 + is_not_finite])[0];
    let invalid = |what| Evaluated::Invalid(Fault::of(5, what));
    assert_eq!(outcome(by_kinematics, 0), invalid(Invalid::Inverted(3)));
    assert_eq!(outcome(by_kinematics, 1), invalid(Invalid::NotFinite(3)));
    assert_eq!(outcome(by_material, 0), invalid(Invalid::Material(3, Refusal::Inverted)));
    assert_eq!(outcome(by_material, 1), invalid(Invalid::Material(3, Refusal::NotFinite)));
    // The parts of krylov.wgsl's small arrays, for a cycle of 30 vectors.
    assert_eq!(small_numbers(), 31 + 31 + 2 * 30 + 30 * 31 / 2 + 30);
}

/// Places and names of a struct's members, but for what is reserved, and its size.
fn members(module: &Module, name: &str) -> Option<(Vec<(usize, String)>, usize)> {
    let (_, found) = module.types.iter().find(|(_, found)| found.name.as_deref() == Some(name))?;
    let TypeInner::Struct { members, span } = &found.inner else { return None };
    let member = |member: &naga::StructMember| Some((member.offset as usize, member.name.clone()?));
    let is_used = |member: &(usize, String)| !member.1.starts_with("reserved");
    Some((members.iter().filter_map(member).filter(is_used).collect(), *span as usize))
}

macro_rules! of_host {
    ($type:ty: $($field:ident),*) => {
        (vec![$((offset_of!($type, $field), stringify!($field).to_owned())),*], size_of::<$type>())
    };
}

#[test]
fn structs_are_laid_out_alike_on_both_sides() {
    let record = of_host!(Record: done, vectors, steps, iterations, relative_to_start, tolerance, goal, rhs_norm, start_norm,
        residual, scale, along, running);
    let level = of_host!(LevelShape: nodes, width, coarse_nodes, products, coarse_width, restart, plate_nodes, coarsest_steps,
        smoothing_steps);
    let batch = of_host!(scratch::Dimensions: cases, in_dispatch, nodes, elements, contact_points, blocks, own_elements,
        materials, start_numbers, trial_numbers);
    let points = of_host!(material::PointDimensions: cases, in_dispatch, points);
    let mut seen = [0; 4];
    for (kernel, module) in modules() {
        let structs = [("Record", &record), ("Level", &level), ("Dimensions", &batch), ("PointDimensions", &points)];
        for (at, (name, expected)) in structs.into_iter().enumerate() {
            if let Some(found) = members(&module, name) {
                assert_eq!(&found, expected, "{name} in {kernel}");
                seen[at] += 1;
            }
        }
    }
    assert!(seen.iter().all(|kernels| *kernels > 0), "{seen:?}");
}

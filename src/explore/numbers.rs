//! The numbers beside the curves: of the law, of closed forms, of a simulation.

use serde_json::{Value, json};

use super::curves::LawCurves;
use crate::analytical::hertz;
use crate::case::Case;
use crate::output::plots::style::tick;
use crate::output::{SLIP_DISPLACEMENT_RATIO, Summary};

/// What a number is a multiple of, for its unit.
#[derive(Clone, Copy)]
enum NumberKind {
    Length,
    Force,
    Stiffness,
    Plain,
}

/// The unit of a number in the words of the case.
fn unit(case: &Case, kind: NumberKind) -> String {
    let name = |label: &Option<String>| label.clone().unwrap_or_default();
    let (length, force) = (name(&case.units.length), name(&case.units.force));
    match kind {
        NumberKind::Length => length,
        NumberKind::Force => force,
        NumberKind::Stiffness if length.is_empty() || force.is_empty() => String::new(),
        NumberKind::Stiffness => format!("{force}/{length}"),
        NumberKind::Plain => String::new(),
    }
}

/// The rows of the table: what it is, its symbol, its unit, and the numbers, empty where there is
/// none. `simulation` is what a simulation of the same contact has.
pub fn rows(curves: &LawCurves, simulation: Option<&Summary>) -> Vec<Value> {
    let (law, mindlin) = (&curves.summary, curves.mindlin());
    let of = |number: fn(&Summary) -> Option<f64>| [number(law), simulation.and_then(number)];
    let row = |words: &str, symbol: &str, kind: NumberKind, [law, run]: [Option<f64>; 2], closed: Option<f64>| {
        let told = |number: Option<f64>| number.filter(|number| number.is_finite()).map_or_else(String::new, tick);
        json!({
            "words": words, "symbol": symbol, "unit": unit(&curves.case, kind),
            "law": told(law), "closed": told(closed), "simulation": told(run),
        })
    };
    let limit = mindlin.friction * mindlin.normal_force;
    let to_share = mindlin.displacement(SLIP_DISPLACEMENT_RATIO);
    let ratio = |summary: &Summary| Some(summary.f_n_slip? / summary.f_n0?);
    let first = curves.first_yield.map(|_| curves.yield_lambda);
    vec![
        row("indentation", "h", NumberKind::Length, [Some(curves.h), None], None),
        row("indentation at first yield", "h_Y", NumberKind::Length, [None; 2], curves.first_yield),
        row("normal force at first yield", "F_Y", NumberKind::Force, [None; 2], curves.yield_force()),
        row("Johnson's parameter", "Λ", NumberKind::Plain, [Some(curves.lambda), None], None),
        row("Johnson's parameter at first yield", "Λ_Y", NumberKind::Plain, [None; 2], first),
        row("normalised hardness", "H", NumberKind::Plain, [Some(curves.hardness), None], None),
        row("normal force before the shear", "F_N0", NumberKind::Force, of(|s| s.f_n0), Some(mindlin.normal_force)),
        row(
            "contact radius there",
            "a_0",
            NumberKind::Length,
            [Some(curves.a), simulation.and_then(|s| s.a0)],
            Some(hertz::contact_radius(&curves.elastic, curves.h)),
        ),
        row("normal force at full slip", "F_N,slip", NumberKind::Force, of(|s| s.f_n_slip), Some(mindlin.normal_force)),
        row("what is left of it", "F_N,slip/F_N0", NumberKind::Plain, of(ratio), Some(1.0)),
        row("greatest tangential force", "F_T,max", NumberKind::Force, of(|s| s.f_t_max), Some(limit)),
        row("displacement to F_T = 0.99 μ F_N", "δ_T,slip", NumberKind::Length, of(|s| s.delta_t_slip), Some(to_share)),
        row(
            "stiffness of a shear without slip",
            "k_T",
            NumberKind::Stiffness,
            [Some(curves.k_t), None],
            Some(mindlin.initial_stiffness()),
        ),
    ]
}

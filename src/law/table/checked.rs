//! What a table has to be before its curves are drawn through its levels.

use super::cases::case_of;
use super::level::Level;
use super::tabulated::{FORMAT, Tabulated, VERSION, differ, frame_of_the_centres};
use crate::case::{Case, Friction};
use crate::contact_law::{Centres, POINTS};
use crate::law::bounds::{Checked, TOLD, ValueBounds};
use crate::law::json::LawKind;
use crate::law::table::Against;

/// Depths over R: a case presses to 0.3 of the larger radius at the most, which is ten times the
/// smaller one, and a body that is to be put in series three times as deep.
const DEPTH: ValueBounds = ValueBounds { least: 1e-15, most: 100.0 };
/// Lengths over R, forces over E R^2 and stiffnesses over E R.
const SIZE: ValueBounds = ValueBounds { least: 1e-30, most: 1e4 };
/// F_N at full slip over F_N0, but for rounding.
const SHARE: ValueBounds = ValueBounds { least: 1e-3, most: 1.0 + 1e-9 };
/// The exponent of a backbone: at 1 it has no curve.
const EXPONENT: ValueBounds = ValueBounds { least: 1.0 + 1e-9, most: 10.0 };
/// c of the yield curve.
const YIELDING: ValueBounds = ValueBounds { least: 1e-9, most: 1e6 };
/// F_T over mu times F_N at full slip, which is what is left of F_N0.
const TANGENTIAL: ValueBounds = ValueBounds { least: 0.0, most: 1e3 };
/// What F_N has lost of what it loses.
const NORMAL: ValueBounds = ValueBounds { least: -0.1, most: 1.1 };
/// How many levels there may be. A spline goes through them all.
const LEVELS: [usize; 2] = [3, 200];
/// By how much a level is deeper than the one before, at least: the spline divides by it.
const APART: f64 = 1.0 + 1e-6;
/// Share by which the ends of the range may lie outside of the levels: rounding.
const ROUNDING: f64 = 1e-9;

impl LawKind for Tabulated {
    const NAME: &'static str = "tabulated law";
    const FORMAT: &'static str = FORMAT;
    const VERSION: u32 = VERSION;

    fn check(&self) -> Checked {
        let case = self.case()?;
        if !matches!(case.contact.friction, Friction::Coefficient(_)) {
            return Err("case has contact.friction = \"stick\", and a table has to have a friction coefficient".to_owned());
        }
        for (key, value) in [("sphere.radius", case.sphere.radius), ("material.youngs_modulus", case.material.youngs_modulus)] {
            if differ(value, 1.0) {
                return Err(format!("case has {key} = {value:?}, and has to be in units in which that is 1"));
            }
        }
        let body = Against::of(&case);
        if body != self.body {
            return Err(format!("body says that it is against {}, and its case is against {body}", self.body));
        }
        frame_of_the_centres(self.frame, Centres::of(&case).frame(), "law tabulate")?;
        check_levels(&self.levels)?;
        DEPTH.hold_interval("range", self.range)?;
        let (first, last) = (self.levels[0].h, self.levels[self.levels.len() - 1].h);
        if !(self.range.from >= first * (1.0 - ROUNDING) && self.range.to <= last * (1.0 + ROUNDING)) {
            return Err(format!("range has to lie within its levels, which are from {first:?} to {last:?}"));
        }
        if !(self.range.to > self.range.from * APART) {
            return Err(format!("range.to is {:?}, and has to be more than range.from, {:?}", self.range.to, self.range.from));
        }
        let as_simulated = case_of(&case, self.elements_per_contact_radius);
        as_simulated.validate().map_err(|error| format!("elements_per_contact_radius or its case: {error}"))?;
        self.pressed_to_its_end(case).validate().map_err(|error| format!("range.to as the depth of its case: {error}"))?;
        TOLD.hold_all("errors", &self.errors)
    }
}

impl Tabulated {
    /// Its case with a press to its end and nothing else.
    pub(super) fn pressed_to_its_end(&self, mut case: Case) -> Case {
        case.path = vec![crate::case::Segment::Indentation { indentation: self.range.to / 1.1 }];
        case
    }
}

/// Refuses levels through which no curves can be drawn.
pub(in crate::law) fn check_levels(levels: &[Level]) -> Checked {
    let [fewest, most] = LEVELS;
    if !(fewest..=most).contains(&levels.len()) {
        return Err(format!("levels has {} of them, and there have to be from {fewest} to {most}", levels.len()));
    }
    for (i, level) in levels.iter().enumerate() {
        let key = |name: &str| format!("levels[{i}].{name}");
        DEPTH.hold_one(key("h"), level.h)?;
        for (name, value) in [
            ("F_N0", level.f_n0),
            ("a0", level.a0),
            ("delta_T_end", level.delta_t_end),
            ("unloading_radius", level.unloading_radius),
            ("k_T", level.k_t),
        ] {
            SIZE.hold_one(key(name), value)?;
        }
        SHARE.hold_one(key("slip_share"), level.slip_share)?;
        EXPONENT.hold_one(key("backbone"), level.backbone)?;
        if let Some(coefficient) = level.yield_coefficient {
            YIELDING.hold_one(key("yield_coefficient"), coefficient)?;
        }
        for (name, shape, bounds) in [("tangential", &level.tangential, TANGENTIAL), ("normal", &level.normal, NORMAL)] {
            if shape.len() != POINTS {
                return Err(format!("{} has {} numbers, and has to have {POINTS}", key(name), shape.len()));
            }
            bounds.hold(key(name), shape)?;
        }
    }
    for (i, pair) in levels.windows(2).enumerate() {
        if !(pair[1].h > pair[0].h * APART) {
            let (before, h) = (pair[0].h, pair[1].h);
            return Err(format!("levels[{}].h is {h:?}, and has to be more than that of the level before, {before:?}", i + 1));
        }
    }
    Ok(())
}

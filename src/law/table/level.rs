//! One depth of a table, and what is between two.

use serde::{Deserialize, Serialize};

use super::spline::Spline;
use crate::contact_law::POINTS;

/// The law at one depth; lengths over R, forces over E R^2.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Level {
    /// Indentation h.
    pub h: f64,
    /// Normal force F_N0 before any shear.
    #[serde(rename = "F_N0")]
    pub f_n0: f64,
    /// Contact radius a0.
    pub a0: f64,
    /// Normal force at full slip over F_N0, at most 1.
    pub slip_share: f64,
    /// Displacement at which the curves of the shear end, delta_T at x = 1: in a table that was
    /// simulated twice delta_T_slip, that at which F_T/F_N is 0.99 mu.
    #[serde(rename = "delta_T_end", alias = "delta_t_slip")]
    pub delta_t_end: f64,
    /// Radius with which 2 E* a is the stiffness of an unloading; that of the contact in Hertz's.
    pub unloading_radius: f64,
    /// Tangential stiffness k_T at the start of a reversal.
    #[serde(rename = "k_T")]
    pub k_t: f64,
    /// Exponent of the curve on reversal: 3/2 in Cattaneo and Mindlin's contact, near 1 where it
    /// turns sharply.
    pub backbone: f64,
    /// c of the yield curve of a press under F_T, d(delta_T)/dh = 2 c r/(1 - c r^2) with r =
    /// F_T/F_N; where there is none it is that of the shear at constant h.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub yield_coefficient: Option<f64>,
    /// F_T over mu times the normal force at full slip, at x = (j/24)^2, j = 1 and on.
    pub tangential: Vec<f64>,
    /// What F_N has lost of what it loses, likewise.
    pub normal: Vec<f64>,
}

/// Share of mu F_N up to which a curve goes.
const WITHIN: f64 = 1.0 - 1e-4;
/// Least and greatest exponent of a backbone.
pub(super) const BACKBONE: [f64; 2] = [1.02, 1.6];
/// What is tabulated as smooth curves in ln h: everything over the power of h that it has in
/// Hertz's contact.
#[derive(PartialEq)]
pub(in crate::law) struct Curves {
    columns: Vec<Spline>,
}

/// Columns of a level before its shapes.
const NUMBERS: usize = 7;

/// A level as columns that hardly bend over ln h.
pub(super) fn columns_of(level: &Level) -> Vec<f64> {
    let ln_h = level.h.ln();
    let mut columns = vec![
        level.f_n0.ln() - 1.5 * ln_h,
        level.a0.ln() - 0.5 * ln_h,
        level.slip_share,
        level.delta_t_end.ln() - ln_h,
        level.unloading_radius.ln() - 0.5 * ln_h,
        level.k_t.ln() - 0.5 * ln_h,
        level.backbone,
    ];
    columns.extend(level.tangential.iter().chain(&level.normal));
    columns
}

/// A level whose curves are what a contact can follow: F_N falls, and F_T stays within mu F_N.
pub(in crate::law) fn cleaned(level: Level) -> Level {
    level_of(level.h, &columns_of(&level))
}

/// The level of such columns.
pub(super) fn level_of(h: f64, columns: &[f64]) -> Level {
    let ln_h = h.ln();
    let mut normal = columns[NUMBERS + POINTS..].to_vec();
    // F_N falls, and has fallen at x = 1.
    let mut fallen = 0.0;
    for value in &mut normal {
        fallen = value.clamp(fallen, 1.0);
        *value = fallen;
    }
    let slip_share = columns[2].min(1.0);
    let mut tangential = columns[NUMBERS..NUMBERS + POINTS].to_vec();
    // Where everything slips before F_N has fallen, F_T is all that friction gives: a curve beyond
    // it would never be reached, and F_N fall no further.
    for (f_t, lost) in tangential.iter_mut().zip(&normal) {
        *f_t = f_t.min(WITHIN * (1.0 - (1.0 - slip_share) * lost) / slip_share);
    }
    Level {
        h,
        f_n0: (columns[0] + 1.5 * ln_h).exp(),
        a0: (columns[1] + 0.5 * ln_h).exp(),
        slip_share,
        delta_t_end: (columns[3] + ln_h).exp(),
        unloading_radius: (columns[4] + 0.5 * ln_h).exp(),
        k_t: (columns[5] + 0.5 * ln_h).exp(),
        backbone: columns[6].clamp(BACKBONE[0], BACKBONE[1]),
        yield_coefficient: None,
        tangential,
        normal,
    }
}

impl Curves {
    pub fn new(levels: &[Level]) -> Self {
        let x: Vec<f64> = levels.iter().map(|level| level.h.ln()).collect();
        let rows: Vec<Vec<f64>> = levels.iter().map(columns_of).collect();
        let column = |c: usize| rows.iter().map(|row| row[c]).collect::<Vec<f64>>();
        Self { columns: (0..NUMBERS + 2 * POINTS).map(|c| Spline::through(&x, &column(c))).collect() }
    }

    /// F_N0 and a0 alone.
    pub fn normal(&self, h: f64) -> [f64; 2] {
        let ln_h = h.ln();
        [(self.columns[0].at(ln_h) + 1.5 * ln_h).exp(), (self.columns[1].at(ln_h) + 0.5 * ln_h).exp()]
    }

    pub fn at(&self, h: f64) -> Level {
        let values: Vec<f64> = self.columns.iter().map(|spline| spline.at(h.ln())).collect();
        level_of(h, &values)
    }
}

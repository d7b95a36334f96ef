//! A study of oblique presses that follow a given yield coefficient.

use std::fs;
use std::path::Path;

use asperity::case::Case;
use asperity::contact_law::measured_slope;
use asperity::output::{HistoryWriter, OutputDirectory, StepRecord};

use crate::synthetic::{case_text, hardenings};

/// c that the oblique presses of [`write_presses`] follow.
pub fn yield_coefficient(friction: f64, h: f64) -> f64 {
    4.0 * (h / 0.02).powf(0.3) * (0.3 / friction).powf(0.2)
}

/// Writes a study of oblique presses of every hardening, three friction coefficients and two depths
/// into `dir`; all flow with [`yield_coefficient`] from first contact on.
pub fn write_presses(dir: &Path) {
    let mut table = String::from("case,directory,status,reason,contact.friction\n");
    let mut count = 0;
    for hardening in hardenings() {
        for friction in [0.1, 0.25, 0.45] {
            for depth in [0.02, 0.05] {
                let slope = measured_slope(friction);
                let press = case_text(&hardening, friction, depth);
                let shear = press.find("[[path]]\nshear").expect("a shear");
                let text = format!("{}shear = {}\n", &press[..shear], 2.0 * slope * depth);
                let id = format!("c{count:04}");
                let directory = OutputDirectory::create(dir.join("cases").join(&id)).expect("a directory");
                directory.write_case(&Case::parse(&text, "press.toml", &[]).expect("a case").to_toml()).expect("case.toml");
                let mut history = HistoryWriter::create(&directory.history()).expect("history.csv");
                for step in 1..=23 {
                    let share = step as f64 / 23.0;
                    let c = yield_coefficient(friction, share * depth);
                    // r of d(delta_T)/dh = 2 c r/(1 - c r^2).
                    let r = ((1.0 + slope * slope / c).sqrt() - 1.0) / slope;
                    let (h, f_n) = (2.0 * share * depth, 1e3 * share);
                    let row = StepRecord { step, h, delta_t: slope * h, f_n, f_t: r * f_n, ..StepRecord::default() };
                    history.append(&row).expect("a row");
                }
                table.push_str(&format!("{id},cases/{id},done,,{friction}\n"));
                count += 1;
            }
        }
    }
    fs::write(dir.join("study.csv"), table).expect("study.csv");
}

//! Study directories computed from a known law, with or without noise, in the place of simulations.

use std::fs;
use std::path::Path;

use asperity::case::Case;
use asperity::law::formulas::model::{self, Axisymmetric};
use asperity::law::formulas::normal::NormalModel;
use asperity::law::formulas::shear::ShearConstants;
use asperity::law::variables::Body;
use asperity::output::{HistoryWriter, OutputDirectory, StepRecord};

/// The constants that the studies follow, of the size that simulations give.
pub const CONSTANTS: ShearConstants = ShearConstants {
    fall: [1.2, 1.8, 0.4, 1.2, 2.0, 0.3],
    exponent: [30.0, 1.3, 2.0, 1.5, 0.7, 1.5],
    slip: [1.1, 0.3, 1.0, 1.0],
    curve: [0.4, 0.35, 0.5, 0.8],
};

/// The normal problem that they follow.
pub fn normal() -> NormalModel {
    NormalModel::new([1.1, 0.25, 1.4, 0.2], [0.11, 0.8, 1.6, 0.6, 0.4, 0.7])
}

/// One case's file; `hardening` are the lines of its table.
pub fn case_text(hardening: &str, friction: f64, h: f64) -> String {
    format!(
        "[sphere]\nradius = 2.0\n[material]\nyoungs_modulus = 200e3\npoissons_ratio = 0.3\n[material.hardening]\n{hardening}\n\
         [contact]\nfriction = {friction}\n[mesh]\nelements_per_contact_radius = 6\n[[path]]\nindentation = {}\n[[path]]\nshear = \"full-slip\"\n",
        2.0 * h
    )
}

/// Hardening tables of the study: ideal plastic over a wide range, and three that harden.
pub fn hardenings() -> Vec<String> {
    let ideal = |stress: f64| format!("law = \"ideal\"\nyield_stress = {stress}");
    let mut all: Vec<String> = [4000.0, 1500.0, 500.0, 200.0, 100.0].into_iter().map(ideal).collect();
    all.push("law = \"power\"\nyield_stress = 400.0\ncoefficient = 1200.0\nexponent = 0.4".to_owned());
    all.push("law = \"hollomon\"\ncoefficient = 2000.0\nexponent = 4.0".to_owned());
    all.push("law = \"hollomon\"\ncoefficient = 900.0\nexponent = 8.0".to_owned());
    all
}

/// The normal data and the curve (delta_T, F_T, F_N) of a case that follows the law,
/// and the stiffness at its start.
pub fn truth(case: &Case, friction: f64, h: f64) -> (Axisymmetric, Vec<[f64; 3]>, f64) {
    let body = Body::from_case(case).expect("a hardening law");
    let inputs = Axisymmetric::of(&body, friction, h, normal().state(&body, friction, h));
    let parameters = model::contact(&CONSTANTS, &inputs);
    let curve = (1..=25)
        .map(|i| parameters.delta_t_end * (f64::from(i) / 25.0).powf(1.8))
        .map(|d| {
            let (f_t, f_n) = model::forces(&parameters, friction, d);
            [d, f_t, f_n]
        })
        .collect();
    (inputs, curve, parameters.k_t0)
}

/// Writes a study of every hardening, three friction coefficients and three indentations (thinned
/// to a half) into `dir`; forces, radius and displacement are off by up to `noise`, in a way that
/// is the same every time.
pub fn write_study(dir: &Path, noise: f64) {
    let mut table = String::from("case,directory,status,reason,contact.friction\n");
    let mut count = 0;
    let mut state = 1_u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        1.0 + noise * (2.0 * ((state >> 11) as f64 / (1_u64 << 53) as f64) - 1.0)
    };
    for (i, hardening) in hardenings().iter().enumerate() {
        for (j, friction) in [0.1, 0.25, 0.45].into_iter().enumerate() {
            for (k, h) in [0.003, 0.01, 0.03].into_iter().enumerate() {
                if (i + j + k) % 2 == 1 {
                    continue;
                }
                let text = case_text(hardening, friction, h);
                let case = Case::parse(&text, "synthetic.toml", &[]).expect("a case");
                let (inputs, curve, k_t0) = truth(&case, friction, 2.0 * h);
                let id = format!("c{count:04}");
                let directory = OutputDirectory::create(dir.join("cases").join(&id)).expect("a directory");
                directory.write_case(&case.to_toml()).expect("case.toml");
                let mut history = HistoryWriter::create(&directory.history()).expect("history.csv");
                // Off alike in a whole case, as a mesh is, and a little at every step.
                let (size, force) = (random(), random());
                let start = StepRecord {
                    step: 1,
                    h: inputs.h,
                    f_n: inputs.f_n * force,
                    a: inputs.a * size.sqrt(),
                    contact_points: 50,
                    ..StepRecord::default()
                };
                history.append(&start).expect("a row");
                for (step, [d, f_t, f_n]) in curve.into_iter().enumerate() {
                    let small = 1.0 + 0.2 * (random() - 1.0);
                    history
                        .append(&StepRecord {
                            step: step + 2,
                            segment: 1,
                            delta_t: d * size,
                            f_t: f_t * force * small,
                            f_n: f_n * force,
                            k_t: (step == 0).then_some(k_t0 * force / size),
                            slipping_points: if step == 24 { 50 } else { 10 },
                            ..start
                        })
                        .expect("a row");
                }
                table.push_str(&format!("{id},cases/{id},done,,{friction}\n"));
                count += 1;
            }
        }
    }
    table.push_str(&format!("c{count:04},cases/c{count:04},failed,a step did not converge,0.1\n"));
    fs::write(dir.join("study.csv"), table).expect("study.csv");
}

//! The way from a study to a prediction with simulations of its own: the small study, its law, and
//! cases that it never saw.

use std::fs;
use std::path::Path;

use asperity::case::Case;
use asperity::law::Law;
use asperity::law::formulas::predict::{NormalSource, predict};
use asperity::output::{StepRecord, read_history};

use super::{asperity, text};

/// sigma_Y, mu and h0 of cases within the study's range, none of whose values occur in it, in a
/// random sequence.
const UNSEEN: [[f64; 3]; 10] = [
    [1125.0, 0.323, 0.0144],
    [2728.0, 0.322, 0.0176],
    [217.0, 0.24, 0.0183],
    [1209.0, 0.37, 0.0048],
    [734.0, 0.174, 0.0096],
    [982.0, 0.104, 0.0057],
    [434.0, 0.375, 0.0137],
    [311.0, 0.339, 0.005],
    [1108.0, 0.138, 0.004],
    [2240.0, 0.163, 0.0057],
];

/// The study's base case with other values, on the default mesh.
fn case_text(study: &str, [yield_stress, friction, indentation]: [f64; 3]) -> String {
    let base = study.split("[grid]").next().expect("a base").replace("base.", "");
    let mesh = "[mesh]\nelements_per_contact_radius = 5\nsurface_elements_per_contact_radius = 10\n";
    assert!(base.contains(mesh));
    let base = base.replace(mesh, "");
    let set = |text: String, from: &str, to: String| {
        assert_eq!(text.matches(from).count(), 1, "{from}");
        text.replace(from, &to)
    };
    let text = set(base, "yield_stress = 400.0", format!("yield_stress = {yield_stress}"));
    let text = set(text, "friction = 0.3", format!("friction = {friction}"));
    set(text, "indentation = 0.01", format!("indentation = {indentation}"))
}

/// (rms, greatest) of F_T as a share of its peak and of F_N as a share of F_N0, the prediction
/// being from h alone and the simulation at the limit of fine meshes.
fn errors(law: &Law, case: &Path, run: &Path) -> [[f64; 2]; 2] {
    let case = Case::load(case, &[]).expect("a case");
    let prediction = predict(law, &case, NormalSource::Formulas).expect("a prediction");
    assert!(prediction.out_of_range.is_empty(), "{:?}", prediction.out_of_range);
    let history = read_history(&run.join("history.csv")).expect("a history");
    let f_n0 = history.iter().rfind(|record| record.segment == 0).expect("a press").f_n;
    let limit = |record: &StepRecord| Some((record.delta_t, record.f_t_limit?, record.f_n_limit?));
    let shear: Vec<_> = history.iter().filter(|record| record.segment == 1).filter_map(limit).collect();
    assert!(shear.len() > 8, "{} steps with a limit", shear.len());
    let peak = shear.iter().fold(0.0_f64, |peak, (_, f_t, _)| peak.max(*f_t));
    let mu = prediction.inputs.friction;
    let differences: Vec<[f64; 2]> = std::iter::once([0.0, (prediction.inputs.f_n - f_n0) / f_n0])
        .chain(shear.iter().map(|&(delta_t, f_t_limit, f_n_limit)| {
            let (f_t, f_n) = law.forces(&prediction.parameters, mu, delta_t);
            [(f_t - f_t_limit) / peak, (f_n - f_n_limit) / f_n0]
        }))
        .collect();
    [0, 1].map(|i| {
        let squares: f64 = differences.iter().map(|d| d[i] * d[i]).sum();
        [(squares / differences.len() as f64).sqrt(), differences.iter().fold(0.0_f64, |most, d| most.max(d[i].abs()))]
    })
}

#[test]
fn a_small_study_predicts_cases_that_it_never_saw() {
    let folder = tempfile::tempdir().expect("a folder");
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/studies/small.toml");
    let study = folder.path().join("small");
    asperity(&["study", text(&source), "--out", text(&study), "--device", "cpu"]).code(0);
    // By itself, and with the constants of wear-2014 to start from.
    let laws = ["none", "wear-2014"].map(|prior| {
        asperity(&["law", "fit", text(&study), "--prior", prior]).code(0);
        let law = Law::read(&study.join("law.json")).expect("a law");
        assert_eq!((law.provenance.cases, law.provenance.materials), (27, 3), "{:?}", law.provenance.left_out);
        law
    });
    assert!(laws[0].formulas() != laws[1].formulas(), "the prior counts for nothing");
    let mut squares = [[0.0; 2]; 2];

    let source = fs::read_to_string(source).expect("the study");
    for (i, values) in UNSEEN.into_iter().enumerate() {
        let (case, run) = (folder.path().join(format!("{i}.toml")), folder.path().join(format!("run{i}")));
        fs::write(&case, case_text(&source, values)).expect("a case");
        asperity(&["run", text(&case), "--out", text(&run), "--device", "cpu"]).code(0);
        // Measured: up to 11.0 % in F_T and 3.6 % in F_N without a prior, 11.6 and 2.9 % with it.
        for i in 0..2 {
            let [f_t, f_n] = errors(&laws[i], &case, &run);
            println!("{values:?}: F_T rms {:.4} max {:.4}, F_N rms {:.4} max {:.4}", f_t[0], f_t[1], f_n[0], f_n[1]);
            assert!(f_t[1] < 0.125 && f_n[1] < 0.045, "law {i}, {values:?}: F_T {f_t:?}, F_N {f_n:?}");
            squares[i] = [squares[i][0] + f_t[0] * f_t[0], squares[i][1] + f_n[0] * f_n[0]];
        }
    }
    // Over all curves 3.1 and 1.3 % without, 3.6 and 1.3 % with it.
    let rms = squares.map(|sums| sums.map(|sum| (sum / UNSEEN.len() as f64).sqrt()));
    println!("rms of F_T and F_N without a prior and with that of wear-2014: {rms:.4?}");
    assert!(rms.iter().all(|[f_t, f_n]| *f_t < 0.04 && *f_n < 0.016), "{rms:?}");
}

//! A normal force that is held: over several shears, where what each misses of it does not add up,
//! and in deep plasticity.

use asperity::case::Case;
use asperity::internals::simulation::drive::Ending;
use asperity::internals::simulation::follow::{follow, on_cpu};
use asperity::internals::simulation::problem::Problem;
use asperity::output::{Recorder, StepRecord};

/// A held force is met to this share of it, see `solver::newton`.
const MET: f64 = 5e-5;

/// The rows of a case, which gets to the end of its path.
fn rows(text: &str, settings: &[&str]) -> Vec<StepRecord> {
    let settings: Vec<String> = settings.iter().map(|set| (*set).to_owned()).collect();
    let case = Case::parse(text, "case.toml", &settings).unwrap_or_else(|error| panic!("{error}"));
    let mut recorder = Recorder::new(&case, None);
    let followed = follow(Problem::new(&case).expect("a problem"), None, &mut |problem| on_cpu(problem), &mut recorder);
    assert_eq!(followed.expect("no failure of the program").ending, Ending::Done);
    recorder.rows
}

#[test]
fn a_force_that_is_held_by_one_shear_after_the_other_does_not_creep() {
    let strokes: String = (0..12).map(|i| format!(", {{shear={}, hold=\"normal-force\"}}", [4e-4, 0.0][i % 2])).collect();
    let path = format!("path=[{{indentation=0.02}}{strokes}, {{indentation=0.023}}, {{shear=3e-4, hold=\"normal-force\"}}]");
    let settings = ["mesh.elements_per_contact_radius=4", "solver.press_steps=10", "solver.shear_steps=4", &path];
    let rows = rows(include_str!("../fixtures/cases/ideal.toml"), &settings);
    let pressed = |segment: usize| rows.iter().rfind(|row| row.segment == segment).expect("a press").f_n;
    let off = |row: &StepRecord, held: f64| (row.f_n / held - 1.0).abs();
    let first = pressed(0);
    let worst = rows.iter().filter(|row| (1..=12).contains(&row.segment)).map(|row| off(row, first)).fold(0.0, f64::max);
    assert!(worst <= 1.01 * MET, "{worst:.1e} off what was pressed");
    // A press in between sets another force to hold.
    let second = pressed(13);
    let worst = rows.iter().filter(|row| row.segment == 14).map(|row| off(row, second)).fold(0.0, f64::max);
    assert!((second / first - 1.0).abs() > 0.01 && worst <= 1.01 * MET, "{worst:.1e} off {second}, at first {first}");
}

/// What flows is ten thousand times as soft as what does not, and systems that leave a hundredth of
/// that throw it back.
#[test]
fn a_force_is_held_in_deep_plasticity_on_a_fine_surface() {
    let text = "[sphere]\nradius = 1.0\n[material]\nyoungs_modulus = 10630.0\npoissons_ratio = 0.21\n[material.hardening]\n\
         law = \"linear\"\nyield_stress = 1.0\nmodulus = 6.68\n[contact]\nfriction = 0.337\n[mesh]\n\
         elements_per_contact_radius = 4\nsurface_elements_per_contact_radius = 8\n[[path]]\nindentation = 0.0592\n\
         [[path]]\nshear = 8.6e-4\nhold = \"normal-force\"\n";
    let rows = rows(text, &[]);
    let held = rows.iter().rfind(|row| row.segment == 0).expect("a press").f_n;
    assert!(rows.iter().all(|row| row.relaxed == 0), "relaxed steps");
    let shear: Vec<&StepRecord> = rows.iter().filter(|row| row.segment == 1).collect();
    assert!(shear.len() > 10 && shear.iter().all(|row| (row.f_n / held - 1.0).abs() <= 1.01 * MET), "{}", shear.len());
}

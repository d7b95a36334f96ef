//! Cases from one end of what may be asked for to the other: each is followed to the end of its
//! path.
//!
//! Prints a table of iterations and cut-backs (`cargo test --test range -- --nocapture`).

use std::error::Error;

use asperity::case::Case;
use asperity::internals::compute::cpu::Cpu;
use asperity::internals::simulation::drive::{Drive, Ending, Observer, StepView};
use asperity::internals::simulation::problem::Problem;
use asperity::internals::simulation::record::StepRecord;
use rayon::prelude::*;

const E: f64 = 200e3;

/// What is remembered of a run.
#[derive(Default)]
struct Watch {
    rows: Vec<StepRecord>,
    fallbacks: usize,
    notes: Vec<String>,
}

impl Observer for Watch {
    fn step(&mut self, view: &mut StepView<'_>) -> Result<(), Box<dyn Error + Send + Sync>> {
        self.rows.push(view.record.0);
        self.fallbacks += view.report.fallbacks;
        Ok(())
    }

    fn segment_end(&mut self, _: &mut StepView<'_>) -> Result<(), Box<dyn Error + Send + Sync>> {
        Ok(())
    }

    fn note(&mut self, text: &str) {
        self.notes.push(text.to_owned());
    }
}

/// Hardening as TOML for a yield strain sigma_Y/E.
fn hardening(law: &str, yield_strain: f64) -> String {
    let y = yield_strain * E;
    match law {
        "elastic" => "law = \"elastic\"".to_owned(),
        "ideal" => format!("law = \"ideal\"\nyield_stress = {y}"),
        "linear" => format!("law = \"linear\"\nyield_stress = {y}\nmodulus = {}", 0.02 * E),
        "power" => format!("law = \"power\"\nyield_stress = {y}\ncoefficient = {y}\nexponent = 0.5"),
        // m = 5 yields first at E (sigma_0/E)^(m/(m-1)).
        "hollomon" => format!("law = \"hollomon\"\ncoefficient = {}\nexponent = 5.0", E * yield_strain.powf(0.8)),
        "voce" => format!("law = \"voce\"\nyield_stress = {y}\nsaturation_stress = {}\nrate = 15.0", 1.5 * y),
        "table" => format!("law = \"table\"\npoints = [[0.0, {y}], [0.05, {}], [0.3, {}]]", 1.3 * y, 1.6 * y),
        _ => panic!("no law {law}"),
    }
}

/// Law, E/sigma_Y, friction, h/R, the shear: a multiple of R or "full-slip".
#[rustfmt::skip]
const CASES: &[(&str, f64, &str, f64, &str)] = &[
    ("elastic",   200.0, "0",         1e-4, "full-slip"),
    ("elastic",   200.0, "0.1",       1e-3, "full-slip"),
    ("elastic",   200.0, "0.5",       1e-3, "full-slip"),
    ("elastic",   200.0, "1",         1e-3, "full-slip"),
    ("elastic",   200.0, "\"stick\"", 1e-3, "1e-4"),
    ("elastic",   200.0, "0.3",       3e-2, "full-slip"),
    ("ideal",      20.0, "0.1",       1e-3, "full-slip"),
    ("ideal",      20.0, "0.3",       3e-2, "full-slip"),
    ("ideal",      20.0, "1",         1e-1, "0.02"),
    ("ideal",     100.0, "0",         1e-2, "full-slip"),
    ("ideal",     100.0, "0.5",       3e-2, "0.005"),
    ("ideal",     500.0, "0",         1e-4, "1e-5"),
    ("ideal",     500.0, "0.1",       1e-3, "full-slip"),
    ("ideal",     500.0, "0.3",       2e-2, "full-slip"),
    ("ideal",     500.0, "0.5",       2e-2, "0.003"),
    ("ideal",     500.0, "1",         2e-2, "0.003"),
    ("ideal",     500.0, "\"stick\"", 2e-2, "0.003"),
    ("ideal",     500.0, "0.3",       1e-1, "full-slip"),
    ("ideal",    5000.0, "0",         1e-3, "1e-4"),
    ("ideal",    5000.0, "0.1",       1e-4, "full-slip"),
    ("ideal",    5000.0, "0.1",       1e-2, "full-slip"),
    ("ideal",    2000.0, "0.5",       1e-2, "0.001"),
    ("ideal",    5000.0, "\"stick\"", 1e-3, "1e-4"),
    ("linear",     50.0, "0.5",       2e-2, "full-slip"),
    ("linear",   1000.0, "0.3",       1e-1, "full-slip"),
    ("linear",   5000.0, "1",         2e-2, "0.002"),
    ("power",     200.0, "0.1",       5e-2, "full-slip"),
    ("power",    2000.0, "\"stick\"", 1e-3, "2e-4"),
    ("hollomon",  500.0, "0.3",       1e-2, "full-slip"),
    ("hollomon", 3000.0, "1",         2e-2, "0.002"),
    ("voce",      500.0, "0.5",       1e-1, "0.01"),
    ("voce",     5000.0, "0.1",       2e-2, "full-slip"),
    ("table",     100.0, "0",         5e-2, "0.005"),
    ("table",    1000.0, "0.3",       1e-2, "full-slip"),
];

/// A case file of a sphere of radius 1 with this modulus, the rest as given.
fn case_text(poissons_ratio: f64, hardening: &str, friction: &str, mesh: &str, path: &str) -> String {
    format!(
        "[sphere]\nradius = 1.0\n[material]\nyoungs_modulus = {E}\npoissons_ratio = {poissons_ratio}\n[material.hardening]\n{hardening}\n\
         [contact]\nfriction = {friction}\n[mesh]\n{mesh}\n{path}"
    )
}

/// Follows the path of a case file's text.
fn drive(text: &str) -> (Ending, Watch) {
    let case = Case::parse(text, "case.toml", &[]).unwrap_or_else(|error| panic!("{error}\n{text}"));
    let problem = Problem::new(&case).expect("a problem");
    let newton = problem.newton().expect("a solver");
    let mut backend = Cpu::<f64>::new(vec![problem.model.clone()]).expect("a backend");
    let mut watch = Watch::default();
    let ending = Drive::new(&problem, &mut backend, 0, newton).run(&mut watch).expect("no failure of the program");
    (ending, watch)
}

/// One case: its line of the table, and what is wrong with it.
fn follow(&(law, stiffness, friction, h, shear): &(&str, f64, &str, f64, &str)) -> (String, Option<String>) {
    let shear_toml = if shear == "full-slip" { "\"full-slip\"" } else { shear };
    let mesh = "elements_per_contact_radius = 4\nfine_zone = 1.8";
    let path = format!("[[path]]\nindentation = {h:e}\n[[path]]\nshear = {shear_toml}\n");
    let text = case_text(0.3, &hardening(law, 1.0 / stiffness), friction, mesh, &path);
    let (ending, watch) = drive(&text);
    let last = watch.rows.last().copied().unwrap_or_default();
    let sum = |of: fn(&StepRecord) -> usize| watch.rows.iter().map(of).sum::<usize>();
    let line = format!(
        "{law:<9} {stiffness:>6} {friction:>8} {h:>7.0e} {shear:>10} {:>6} {:>7} {:>7} {:>7} {:>5} {:>10.3e} {:>8.4} {:>8.4} {}",
        watch.rows.len() - 1,
        sum(|row| row.newton_iterations),
        sum(|row| row.krylov_iterations),
        watch.fallbacks,
        sum(|row| row.cutbacks),
        last.f_n,
        last.f_t / last.f_n,
        last.a,
        watch.notes.join("; "),
    );
    let reached = match shear.parse::<f64>() {
        Ok(target) => last.delta_t == target,
        Err(_) => watch.notes.is_empty(),
    };
    let mu = friction.parse().unwrap_or(f64::INFINITY);
    let wrong = if ending != Ending::Done {
        Some(format!("{ending:?}"))
    } else if last.h != h || !reached {
        Some(format!("the path ends at h = {}, delta_T = {}: {:?}", last.h, last.delta_t, watch.notes))
    } else if watch.rows.iter().any(|row| row.f_t.abs() > mu * row.f_n * (1.0 + 1e-3) + 1e-3 * row.f_n) {
        Some("more friction than there can be".to_owned())
    } else if watch.rows.windows(2).any(|pair| pair[1].work_plastic < pair[0].work_plastic - 1e-9 * pair[1].work_external.abs()) {
        Some("plastic work that is given back".to_owned())
    } else {
        None
    };
    (line, wrong)
}

#[test]
fn every_corner_of_the_range_is_followed_to_its_end() {
    let mut failures = Vec::new();
    println!(
        "{:<9} {:>6} {:>8} {:>7} {:>10} {:>6} {:>7} {:>7} {:>7} {:>5} {:>10} {:>8} {:>8}",
        "law", "E/s_Y", "friction", "h/R", "shear", "steps", "newton", "krylov", "direct", "cuts", "F_N/ER^2", "F_T/F_N", "a/R"
    );
    // Side by side: what a case gives does not depend on the others.
    let followed: Vec<(String, Option<String>)> = CASES.par_iter().map(follow).collect();
    for (case, (line, wrong)) in CASES.iter().zip(followed) {
        println!("{line}");
        failures.extend(wrong.map(|wrong| format!("{case:?}: {wrong}")));
    }
    assert!(failures.is_empty(), "{} of {} cases:\n{}", failures.len(), CASES.len(), failures.join("\n"));
}

/// What, nu, hardening (E = 200e3), friction, elements along the contact radius, what it meets if
/// not the plane, path.
type Hard = (&'static str, f64, &'static str, &'static str, usize, &'static str, &'static [&'static str]);

const HARD: &[Hard] = &[
    // Points that come off hold tangential forces to which no equilibrium belongs.
    (
        "release under full stick",
        0.3,
        "law = \"linear\"\nyield_stress = 200.0\nmodulus = 2000.0",
        "\"stick\"",
        6,
        "",
        &["indentation = 0.06", "release = true"],
    ),
    (
        "shear and release under full stick",
        0.3,
        "law = \"ideal\"\nyield_stress = 400.0",
        "\"stick\"",
        5,
        "",
        &["indentation = 0.02", "shear = 0.004", "release = true"],
    ),
    // A change of volume is fifty times as stiff as one of shape.
    (
        "nearly incompressible",
        0.49,
        "law = \"ideal\"\nyield_stress = 3700.0",
        "0.2",
        5,
        "",
        &["indentation = 4e-4", "indentation = 3.6e-4", "shear = 3e-5", "release = true"],
    ),
    // The same in plastic flow: the guess of a step must not change the volume beside the plane.
    ("nearly incompressible and plastic", 0.49, SOFT, "0.3", 4, "", PRESS_AND_SHEAR),
    ("the same between equal spheres", 0.49, SOFT, "0.3", 4, "[opponent]\nequal = true", PRESS_AND_SHEAR),
    ("the same on a rigid sphere", 0.49, SOFT, "0.3", 4, "[opponent]\nrigid = true\nradius = 2.0", PRESS_AND_SHEAR),
    ("the same on a body that deforms", 0.49, SOFT, "0.3", 4, "[opponent]\nradius = 1.5", PRESS_AND_SHEAR),
];

/// Ideally plastic at E/500.
const SOFT: &str = "law = \"ideal\"\nyield_stress = 400.0";
const PRESS_AND_SHEAR: &[&str] = &["indentation = 0.02", "shear = 0.004"];
/// Newton iterations a step that a path may take on average.
const ITERATIONS: usize = 8;

#[test]
fn what_used_to_be_hard_is_followed_without_a_cutback() {
    let follow = |&(what, nu, law, friction, elements, opponent, path): &Hard| {
        let path: String = path.iter().map(|segment| format!("[[path]]\n{segment}\n")).collect();
        let text = case_text(nu, law, friction, &format!("elements_per_contact_radius = {elements}\n{opponent}"), &path);
        (what, path.ends_with("release = true\n"), drive(&text))
    };
    let followed: Vec<_> = HARD.par_iter().map(follow).collect();
    for (what, released, (ending, watch)) in followed {
        let cutbacks: usize = watch.rows.iter().map(|row| row.cutbacks).sum();
        let iterations: usize = watch.rows.iter().map(|row| row.newton_iterations).sum();
        println!("{what}: {} steps, {iterations} iterations, {cutbacks} cut-backs", watch.rows.len() - 1);
        assert_eq!(ending, Ending::Done, "{what}");
        let last = watch.rows[watch.rows.len() - 1];
        assert!(!released || last.f_n == 0.0, "{what}: F_N = {} is left", last.f_n);
        assert_eq!(cutbacks, 0, "{what}");
        assert!(iterations <= ITERATIONS * watch.rows.len(), "{what}: {iterations} iterations");
        // What was done on the body is in it, or gone by plastic work and friction.
        let most = watch.rows.iter().fold(0.0, |most: f64, row| most.max(row.work_external));
        let found = last.energy_elastic + last.work_plastic + last.work_friction;
        assert!((last.work_external - found).abs() < 0.02 * most, "{what}: work {} against {found}", last.work_external);
    }
}

/// What a press starts from may carry no force, next to none, or lie far below: where it was
/// before, it is as if it had been cut finely.
#[test]
fn a_press_after_a_release_does_not_depend_on_what_the_release_left() {
    let pressed_again = |released: &[&str], again: &[f64]| {
        let segments = ["indentation = 0.02"].iter().chain(released).map(|segment| (*segment).to_owned());
        let again = again.iter().map(|h| format!("indentation = {h}"));
        let path: String = segments.chain(again).map(|segment| format!("[[path]]\n{segment}\n")).collect();
        let (ending, watch) = drive(&case_text(0.3, SOFT, "0.3", "elements_per_contact_radius = 6", &path));
        assert_eq!(ending, Ending::Done);
        let steps = watch.rows.iter().filter(|row| row.segment == released.len() + 1).count();
        (steps, watch.rows[watch.rows.len() - 1].f_n)
    };
    let finely: Vec<f64> = (1..=40).map(|i| 0.0182 + (0.02 - 0.0182) * f64::from(i) / 40.0).collect();
    let (_, fine) = pressed_again(&["release = true"], &finely);
    let cases: [(&[&str], usize); 3] =
        [(&["release = true"], 8), (&["release = 0.001"], 8), (&["release = true", "indentation = 0.012"], 9)];
    for (released, least) in cases {
        let again = [0.02];
        let (steps, f_n) = pressed_again(released, &again);
        println!("{released:?}: {steps} steps, F_N = {f_n:.6e}, finely {fine:.6e}");
        assert!(steps >= least, "{released:?}: {steps} steps");
        assert!((f_n / fine - 1.0).abs() < 5e-3, "{released:?}: F_N = {f_n} against {fine}");
    }
}

/// Hertz's force, F = 4/3 E* (R* h^3)^(1/2), of the shallowest contacts that are meshed for: of a
/// sphere on a plane, of two equal ones, and of a large one under a small one.
#[test]
fn the_shallowest_contacts_are_those_of_hertz() {
    let modulus = E / (1.0 - 0.3f64.powi(2));
    let contacts = [
        ("", 1.0, modulus),
        ("[opponent]\nequal = true\n", 0.5, 0.5 * modulus),
        ("[opponent]\nradius = 0.1\n", 1.0 / 11.0, 0.5 * modulus),
        ("[opponent]\nradius = 10.0\n", 10.0 / 11.0, 0.5 * modulus),
    ];
    contacts.par_iter().for_each(|&(opponent, radius, modulus)| {
        let least: f64 = 2.5e-7 / radius;
        for h in [1.001 * least, 10.0 * least].into_iter().take(if opponent.is_empty() { 2 } else { 1 }) {
            let mesh = format!("elements_per_contact_radius = 6\n{opponent}");
            let (ending, watch) =
                drive(&case_text(0.3, "law = \"elastic\"", "0", &mesh, &format!("[[path]]\nindentation = {h:e}\n")));
            assert_eq!(ending, Ending::Done, "{opponent}");
            let last = watch.rows.last().expect("a step");
            // Forces over E R^2.
            let hertz = 4.0 / 3.0 * modulus / E * (radius * h.powi(3)).sqrt();
            let error = last.f_n / hertz - 1.0;
            println!("{opponent:?}, h = {h:e}: F_N {:+.2} %, a/a_Hertz {:.3}", 100.0 * error, last.a / (radius * h).sqrt());
            assert!(error.abs() < 0.015, "{opponent:?}, h = {h:e}: {error}");
        }
    });
}

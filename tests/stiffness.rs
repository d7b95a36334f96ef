//! The tangential stiffness at the start of a shear: against Mindlin's, against short steps, and
//! whatever the steps.

use std::error::Error;

use asperity::analytical::ElasticSphere;
use asperity::analytical::cattaneo_mindlin::initial_stiffness;
use asperity::case::Case;
use asperity::internals::compute::cpu::Cpu;
use asperity::internals::simulation::drive::{Drive, Ending, Observer, StepView};
use asperity::internals::simulation::problem::Problem;
use asperity::internals::simulation::record::StepRecord;

/// Keeps the rows.
#[derive(Default)]
struct Rows(Vec<StepRecord>);

impl Observer for Rows {
    fn step(&mut self, view: &mut StepView<'_>) -> Result<(), Box<dyn Error + Send + Sync>> {
        self.0.push(view.record.0);
        Ok(())
    }

    fn segment_end(&mut self, _: &mut StepView<'_>) -> Result<(), Box<dyn Error + Send + Sync>> {
        Ok(())
    }

    fn note(&mut self, _: &str) {}
}

/// The rows of a path at E = 200e3, R = 1: scaled, so that k_T is over E R.
fn follow(nu: f64, hardening: &str, rest: &str) -> Vec<StepRecord> {
    let text = format!(
        "[sphere]\nradius = 1.0\n[material]\nyoungs_modulus = 200e3\npoissons_ratio = {nu}\n[material.hardening]\n{hardening}\n\
         [contact]\nfriction = 0.3\n{rest}"
    );
    let case = Case::parse(&text, "case.toml", &[]).expect("a case");
    let problem = Problem::new(&case).expect("a problem");
    let mut backend = Cpu::<f64, f32>::with_tangents(vec![problem.model.clone()]).expect("a backend");
    let newton = problem.newton().expect("a solver");
    let mut rows = Rows::default();
    let ending = Drive::new(&problem, &mut backend, 0, newton).run(&mut rows).expect("a run");
    assert_eq!(ending, Ending::Done);
    rows.0
}

/// Every k_T, in the order of the shears.
fn stiffnesses(rows: &[StepRecord]) -> Vec<f64> {
    rows.iter().filter_map(|row| row.k_t).collect()
}

const IDEAL: &str = "law = \"ideal\"\nyield_stress = 400.0";
const LINEAR: &str = "law = \"linear\"\nyield_stress = 400.0\nmodulus = 2000.0";
/// Coarse, and solved so far that a force of 1e-4 F_N is known.
const TIGHT: &str = "[mesh]\nelements_per_contact_radius = 6\n[solver]\ntolerance = 1e-7\nshear_steps = 1\n";

#[test]
fn a_small_elastic_contact_has_mindlins() {
    let sphere = |nu| ElasticSphere { radius: 1.0, youngs_modulus: 1.0, poissons_ratio: nu };
    for (nu, opponent, bodies) in [
        // Shear and pressure have next to nothing to do with each other, as in Mindlin's solution;
        // at nu = 0.3 what sticks to a plane is 4 % stiffer.
        (0.49, "", 1.0),
        (0.49, "[opponent]\nrigid = true\nradius = 3.0\n", 1.0),
        // Nor between equal bodies: each has the whole force, and half of the motion.
        (0.3, "[opponent]\nequal = true\n", 2.0),
    ] {
        let h = 1e-5 * bodies;
        let rest =
            format!("{opponent}[mesh]\nelements_per_contact_radius = 8\n[[path]]\nindentation = {h}\n[[path]]\nshear = 1e-9\n");
        let rows = follow(nu, "law = \"elastic\"", &rest);
        let (last, k_t) = (rows[rows.len() - 1], stiffnesses(&rows)[0]);
        // The body's own share is of the order of a/R, which is 0.003: 1.4/(E R) at nu = 0.3.
        let exact = 1.0 / (1.0 / initial_stiffness(&sphere(nu), last.a) + 1.4);
        println!("nu = {nu}, {opponent:?}: a = {}, k_T0 = {k_t}, Mindlin and the body {exact}: {:.4}", last.a, k_t / exact);
        assert!((k_t / exact - 1.0).abs() < 0.015, "{k_t} and {exact}");
    }
}

#[test]
fn it_is_the_slope_of_short_steps_after_a_plastic_press() {
    for (hardening, hold) in [(IDEAL, "indentation"), (LINEAR, "indentation"), (IDEAL, "normal-force")] {
        // The first step takes up what the press has left unbalanced.
        let rest = format!(
            "{TIGHT}[[path]]\nindentation = 0.02\n[[path]]\nshear = 1e-6\nhold = \"{hold}\"\n\
             [[path]]\nshear = 3e-6\nhold = \"{hold}\"\n"
        );
        let rows = follow(0.3, hardening, &rest);
        let (k_t, [.., from, to]) = (stiffnesses(&rows), rows.as_slice()) else { panic!("rows") };
        let slope = (to.f_t - from.f_t) / (to.delta_t - from.delta_t);
        println!("{hardening:?}, {hold}: k_T0 = {:.6}, the slope of a step {slope:.6}: {:.4}", k_t[0], slope / k_t[0]);
        assert!((slope / k_t[0] - 1.0).abs() < 0.03, "{slope} and {k_t:?}");
    }
}

#[test]
fn neither_steps_nor_tolerance_are_in_it() {
    let path = "[[path]]\nindentation = 0.02\n[[path]]\nshear = 1e-4\n";
    let of = |solver: &str| {
        let rest = format!("[mesh]\nelements_per_contact_radius = 5\n[solver]\n{solver}\n{path}");
        stiffnesses(&follow(0.3, IDEAL, &rest))[0]
    };
    let usual = of("shear_steps = 15");
    assert_eq!(of("shear_steps = 2").to_bits(), usual.to_bits());
    assert_eq!(of("shear_steps = 40").to_bits(), usual.to_bits());
    let [tight, direct] = [of("tolerance = 1e-6"), of("linear = \"direct\"")];
    println!("k_T0 = {usual}, solved to 1e-6 {tight}, directly {direct}");
    assert!((tight / usual - 1.0).abs() < 3e-3 && (direct / usual - 1.0).abs() < 3e-3, "{usual}, {tight}, {direct}");
}

#[test]
fn every_shear_has_its_own_and_no_other_row_has_one() {
    let rest =
        format!("{TIGHT}[[path]]\nindentation = 0.02\n[[path]]\nshear = 5e-4\n[[path]]\nshear = 0.0\n[[path]]\nrelease = true\n");
    let rows = follow(0.3, IDEAL, &rest);
    let with: Vec<usize> = rows.iter().filter(|row| row.k_t.is_some()).map(|row| row.segment).collect();
    assert_eq!(with, [1, 2]);
    // Reversed, the body unloads.
    let k_t = stiffnesses(&rows);
    println!("k_T = {:.5}, reversed {:.5}", k_t[0], k_t[1]);
    assert!(k_t[1] > 1.1 * k_t[0], "{k_t:?}");
}

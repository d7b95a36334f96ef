//! Two unlike bodies that both deform: Hertz with R* and E*; Cattaneo and Mindlin where pressure
//! and shear do not act on each other; a stiff flat as the plane; an equal sphere as the image.

use super::runner::Runner;
use super::sphere::{History, RADIUS, YOUNGS_MODULUS, press, shear, sphere};
use super::{Check, VerifyError};
use crate::analytical::{ElasticSphere, hertz};
use crate::case::{Case, Friction, Hardening, Hold, Material, Opponent, Segment};
use crate::simulation::record::StepRecord;

const NU: f64 = 0.3;
/// Contact radius at which Hertz is checked, the smallest that is meshed for: what the bodies
/// beyond their plates lack goes with it.
const SMALL: f64 = 0.005 * RADIUS;
/// Contact radius of the shears.
const A: f64 = 0.01 * RADIUS;
/// Where F_T is compared, over d_s.
const LOADING: [f64; 3] = [0.25, 0.5, 0.75];
/// The second body of the shears: (1 - 2 nu)/G is that of the first one, so beta = 0.
const STIFFER: f64 = 1.7;
const LARGER: f64 = 2.0;

fn material(youngs_modulus: f64, poissons_ratio: f64) -> Material {
    Material { youngs_modulus, poissons_ratio, hardening: Hardening::Elastic }
}

/// Runs the checks.
pub fn checks(runner: &mut Runner<'_>) -> Result<Vec<Check>, VerifyError> {
    let mut checks = hertzian(runner, Some(2.0 * RADIUS))?;
    checks.extend(hertzian(runner, None)?);
    for mu in [0.1, 0.4] {
        checks.extend(sheared(runner, mu)?);
    }
    checks.extend(stiff_flat(runner)?);
    checks.extend(image(runner)?);
    Ok(checks)
}

/// An elastic sphere against one that is three times as stiff, or such a flat.
fn hertzian(runner: &mut Runner<'_>, radius: Option<f64>) -> Result<Vec<Check>, VerifyError> {
    let mut case = sphere(NU, Hardening::Elastic, 0.0, runner.elements(8), Vec::new());
    case.opponent = Some(Opponent::Deforming { radius, material: material(3.0 * YOUNGS_MODULUS, NU) });
    let h = SMALL * SMALL / case.effective_radius();
    case.path = vec![press(h)];
    case.solver.press_steps = Some(4);
    case.solver.tolerance = 1e-5;
    let row = runner.follow(&case)?.last();
    let exact = ElasticSphere {
        radius: case.effective_radius(),
        youngs_modulus: YOUNGS_MODULUS / case.compliance()[0],
        poissons_ratio: NU,
    };
    let pair = radius.map_or_else(|| "a flat".to_owned(), |radius| format!("R_2/R_1 = {}", radius / RADIUS));
    let check = |what: &str, ours: f64, reference: f64, because: &'static str| {
        Check::relative("two bodies", format!("E_2/E_1 = 3, {pair}: {what} at a = 0.005 R"), ours, reference, 0.01, because)
    };
    Ok(vec![
        check(
            "F_N",
            row.f_n,
            hertz::force(&exact, h),
            "the bodies beyond their plates are missing, which makes F_N up to 0.65 a/R larger; the rest is the mesh",
        ),
        check("a", row.a, hertz::contact_radius(&exact, h), "a is found to less than a tenth of an element, of which it has 8"),
    ])
}

/// Poisson's ratio at which the stiffer body has the first one's (1 - 2 nu)/G.
fn indifferent_ratio() -> f64 {
    // 1 - nu - 2 nu^2 = s.
    let s = STIFFER * (1.0 - NU - 2.0 * NU * NU);
    0.25 * ((9.0 - 8.0 * s).sqrt() - 1.0)
}

/// Elastic bodies of unlike stiffness and size whose pressure does not shear the interface.
fn sheared(runner: &mut Runner<'_>, mu: f64) -> Result<Vec<Check>, VerifyError> {
    const BECAUSE: &str = "beta = 0: slip across the shear direction and the mesh are worth 1 % each";
    let nu_2 = indifferent_ratio();
    let mut case = sphere(NU, Hardening::Elastic, mu, runner.elements(8), Vec::new());
    case.contact.friction = Friction::Coefficient(mu);
    case.opponent =
        Some(Opponent::Deforming { radius: Some(LARGER * RADIUS), material: material(STIFFER * YOUNGS_MODULUS, nu_2) });
    let h = A * A / case.effective_radius();
    let exact = ElasticSphere {
        radius: case.effective_radius(),
        youngs_modulus: YOUNGS_MODULUS / case.compliance()[0],
        poissons_ratio: NU,
    };
    // Cattaneo's slip displacement, 3 mu F_N/(16 a) times the sum of (2 - nu)/G.
    let shear_modulus = 0.5 * YOUNGS_MODULUS / (1.0 + NU);
    let compliance = case.compliance()[1];
    let slip_displacement = |f_n: f64, a: f64| 3.0 * mu * f_n / (16.0 * a) * (2.0 - NU) / shear_modulus * compliance;
    let expected = slip_displacement(hertz::force(&exact, h), A);
    case.path = vec![press(h)];
    case.path.extend(LOADING.map(|x| shear(x * expected, Hold::Indentation)));
    case.mesh.contact_radius = Some(A);
    (case.solver.press_steps, case.solver.shear_steps) = (Some(4), Some(2));
    case.solver.tolerance = 1e-5;
    let history = runner.follow(&case)?;
    let (own, other) = (runner.equator(NU)?, runner.equator(nu_2)?);
    let (f_n, a) = (history.end(0).f_n, history.end(0).a);
    let between = |one: f64, two: f64, force: f64| force / (YOUNGS_MODULUS * RADIUS) * (one + two / (STIFFER * LARGER));
    let mut checks = vec![Check::relative(
        "two bodies",
        format!("beta = 0: F_N, mu = {mu}"),
        f_n,
        hertz::force(&exact, h + between(own.normal, other.normal, f_n)),
        0.01,
        "Hertz with R* and E*: friction has no part in it",
    )];
    for (segment, x) in (1..).zip(LOADING) {
        let row = history.end(segment);
        let contact = row.delta_t - between(own.tangential, other.tangential, row.f_t);
        let reference = 1.0 - (1.0 - contact / slip_displacement(f_n, a)).max(0.0).powf(1.5);
        let what = format!("beta = 0: F_T/(mu F_N) at {x} d_s, mu = {mu}");
        checks.push(Check::relative("two bodies", what, row.f_t / (mu * f_n), reference, 0.02, BECAUSE).by(1.0));
    }
    Ok(checks)
}

/// The main job's path on a coarse mesh, pressed and sheared.
fn main_job(elements: usize, travel: f64) -> Case {
    let path: Vec<Segment> = vec![press(0.02 * travel), shear(0.002 * travel, Hold::Indentation)];
    let mut case = sphere(NU, Hardening::Ideal { yield_stress: 400.0 }, 0.3, elements, path);
    // The same mesh for both, whatever radius each of them foresees.
    case.mesh.contact_radius = Some(0.21 * RADIUS);
    (case.solver.press_steps, case.solver.shear_steps) = (Some(20), Some(6));
    case.solver.tolerance = 1e-5;
    case
}

fn compared(what: &str, ours: &History, reference: &History, tolerance: f64, because: &'static str) -> Vec<Check> {
    let check = |of: &str, ours: f64, reference: f64| {
        Check::relative("two bodies", format!("{what}: {of}"), ours, reference, tolerance, because)
    };
    let (a, b) = (ours.end(0), reference.end(0));
    let (c, d) = (ours.last(), reference.last());
    vec![
        check("F_N, pressed", a.f_n, b.f_n),
        check("a, pressed", a.a, b.a),
        check("F_N, sheared", c.f_n, d.f_n),
        check("F_T, sheared", c.f_t, d.f_t),
        check("a, sheared", c.a, d.a),
    ]
}

/// A flat that is 1e5 times as stiff, and the plane.
fn stiff_flat(runner: &mut Runner<'_>) -> Result<Vec<Check>, VerifyError> {
    let plane = main_job(6, RADIUS);
    let mut case = plane.clone();
    case.opponent = Some(Opponent::Deforming { radius: None, material: material(1e5 * YOUNGS_MODULUS, NU) });
    let (plane, case) = (runner.follow(&plane)?, runner.follow(&case)?);
    Ok(compared("flat, E_2/E_1 = 1e5, and plane", &case, &plane, 2e-3, "the flat gives way by 1e-5"))
}

/// Two equal spheres, both meshed, and one with its own image.
fn image(runner: &mut Runner<'_>) -> Result<Vec<Check>, VerifyError> {
    let mut image = main_job(8, 2.0 * RADIUS);
    let mut case = image.clone();
    image.opponent = Some(Opponent::Equal);
    case.opponent = Some(Opponent::Deforming { radius: Some(RADIUS), material: case.material.clone() });
    let (image, case) = (runner.follow(&image)?, runner.follow(&case)?);
    let mut checks = compared("equal sphere, meshed, and image", &case, &image, 1e-3, "slaves and masters are other nodes");
    // Pressed, both have the same points; sheared, other ones are in contact at the edge.
    for force in &mut checks[2..4] {
        force.tolerance = Some(4e-3);
        force.because = "other points at the edge: the mesh's error, 0.2 % on 8 elements, and on 10 with 20 at the surface";
    }
    if let Some(radius) = checks.last_mut() {
        radius.tolerance = Some(5e-3);
        radius.because = "other points at the edge: an element's share of the area";
    }
    let both = |row: StepRecord| row.work_plastic_opponent / row.work_plastic;
    checks.push(Check::relative(
        "two bodies",
        "equal sphere, meshed: its share of the plastic work",
        both(case.end(0)),
        0.5,
        1e-3,
        "the bodies are equal",
    ));
    Ok(checks)
}

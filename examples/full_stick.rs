//! Static friction under full stick: a sphere pressed, then sheared at constant normal force, on
//! meshes of increasing fineness, as a table.
//!
//! `cargo run --release --example full_stick -- [--meshes 4,6,8,12] [--finer 1]
//! [--tangent 0,0.02] [--indentation 2.8e-4] [--stiffness 500] [--shear 0.04] [--shear-steps 15]`
//!
//! `finer` is the number of elements at the surface over that inside (1, 2 or 4), `tangent` E_t/E
//! of the linear hardening (0: none), `indentation` h/R, `stiffness` E/sigma_Y, `shear` the length
//! of the shear over the predicted contact radius. What the columns say, and what they are held
//! against, is in `benches/full_stick/README.md`.

use std::process::ExitCode;

use asperity::analytical::{ElasticSphere, brizmer, predicted_contact_radius};
use asperity::case::Case;
use asperity::internals::compute::cpu::Cpu;
use asperity::internals::contact::coulomb::Status;
use asperity::internals::simulation::drive::{Drive, Ending, Observer, StepView};
use asperity::internals::simulation::problem::Problem;
use asperity::internals::simulation::record::StepRecord;

type Failed = Box<dyn std::error::Error + Send + Sync>;

const NU: f64 = 0.3;
/// Shares of the first tangential stiffness at which F_T/F_N is read.
const LEVELS: [f64; 4] = [0.5, 0.3, 0.2, brizmer::SLIDING_STIFFNESS];
/// A slope is taken over the last part of the way, from delta_T over this number: over single steps
/// it jumps whenever a point comes down.
const STRETCH: f64 = 1.3;
/// Points nearer to the middle than this share of the contact radius are the inner ones.
const INNER: f64 = 0.7;
/// The fine mesh reaches this much beyond the predicted contact radius: the contact grows in the
/// shear.
const ROOM: f64 = 1.375;

/// What is varied.
#[derive(Clone, Copy, Debug)]
struct Setup {
    elements: usize,
    /// Elements at the surface over these.
    finer: usize,
    /// E/sigma_Y.
    stiffness: f64,
    /// E_t/E.
    tangent: f64,
    /// h/R.
    indentation: f64,
    /// Length of the shear over the predicted contact radius.
    shear: f64,
    shear_steps: usize,
}

impl Setup {
    /// Hardening modulus H in sigma_Y: 1/E_t = 1/E + 1/H.
    fn modulus(&self) -> f64 {
        self.stiffness * self.tangent / (1.0 - self.tangent)
    }

    /// Flow stress in sigma_Y.
    fn flow_stress(&self, alpha: f64) -> f64 {
        1.0 + self.modulus() * alpha
    }

    /// The case; stresses in sigma_Y, lengths in R.
    fn case(&self) -> Result<Case, Failed> {
        let a = predicted_contact_radius(self.stiffness, NU, |alpha| self.flow_stress(alpha), self.indentation);
        let text = format!(
            "[sphere]\nradius = 1.0\n[material]\nyoungs_modulus = {:e}\npoissons_ratio = {NU}\n[material.hardening]\nlaw = \"linear\"\n\
             yield_stress = 1.0\nmodulus = {:e}\n[contact]\nfriction = \"stick\"\n[mesh]\nelements_per_contact_radius = {}\n\
             surface_elements_per_contact_radius = {}\ncontact_radius = {:e}\nfine_zone = 1.6\n\
             [solver]\nshear_steps = {}\n[[path]]\nindentation = {:e}\n[[path]]\nshear = {:e}\nhold = \"normal-force\"\n",
            self.stiffness,
            self.modulus(),
            self.elements,
            self.elements * self.finer,
            ROOM * a,
            self.shear_steps,
            self.indentation,
            self.shear * a,
        );
        Ok(Case::parse(&text, "full-stick.toml", &[])?)
    }
}

/// Tangential traction over the flow stress in shear, k = sigma(alpha)/sqrt(3) of the elements
/// below.
#[derive(Clone, Copy, Debug, Default)]
struct Traction {
    /// F_T over the integral of k on the contact.
    all: f64,
    /// The same of the inner points.
    inner: f64,
}

struct Watch {
    setup: Setup,
    rows: Vec<StepRecord>,
    traction: Traction,
}

impl Observer for Watch {
    fn step(&mut self, view: &mut StepView<'_>) -> Result<(), Failed> {
        self.rows.push(view.record.0);
        Ok(())
    }

    fn segment_end(&mut self, view: &mut StepView<'_>) -> Result<(), Failed> {
        let alpha = view.fields()?.alpha;
        let lists = &view.mesh.node_elements;
        let closed = || view.points.iter().filter(|p| p.status != Status::Open);
        let area: f64 = closed().map(|p| p.area).sum();
        let centre = closed().map(|p| p.area * p.reference[0]).sum::<f64>() / area;
        let radius = (2.0 * area / std::f64::consts::PI).sqrt();
        let ratio = |within: f64| {
            let (mut force, mut strength) = (0.0, 0.0);
            for p in closed().filter(|p| (p.reference[0] - centre).hypot(p.reference[1]) < within) {
                let around = &lists.entry[lists.list(p.node)];
                let mean = around.iter().map(|&entry| alpha[entry as usize / 8]).sum::<f64>() / around.len() as f64;
                force -= p.force[0];
                // Scaled by E. Areas are undeformed ones: the surface stretches by less than a per
                // cent.
                strength += p.area * self.setup.flow_stress(mean) / (3f64.sqrt() * self.setup.stiffness);
            }
            force / strength
        };
        self.traction = Traction { all: ratio(f64::INFINITY), inner: ratio(INNER * radius) };
        Ok(())
    }

    fn note(&mut self, text: &str) {
        eprintln!("{text}");
    }
}

/// What a run says.
#[derive(Clone, Debug)]
struct Outcome {
    /// P* = F_N/L_c.
    load: f64,
    /// First tangential stiffness over 8 G a/(2 - nu).
    first_stiffness: f64,
    /// F_T/F_N where the stiffness has first fallen to the shares [`LEVELS`]; none where it has
    /// not.
    friction: [Option<f64>; 4],
    /// Least share that the stiffness fell to.
    least_stiffness: f64,
    /// F_T/F_N at the end.
    last_friction: f64,
    /// Contact area at the end over that before the shear.
    growth: f64,
    /// Tractions at the end.
    traction: Traction,
    /// Steps in which points slid, against the stick condition, because there was no solution
    /// otherwise.
    slid: usize,
}

/// Follows a setup to its end.
fn shear(setup: &Setup) -> Result<Outcome, Failed> {
    let problem = Problem::new(&setup.case()?)?;
    let mut backend = Cpu::<f64>::new(vec![problem.model.clone()])?;
    let newton = problem.newton()?;
    let mut watch = Watch { setup: *setup, rows: Vec::new(), traction: Traction::default() };
    let ending = Drive::new(&problem, &mut backend, 0, newton).run(&mut watch)?;
    if ending != Ending::Done {
        return Err(format!("{} elements, E_t = {} E: {ending:?}", setup.elements, setup.tangent).into());
    }
    Ok(outcome(setup, &watch))
}

fn outcome(setup: &Setup, watch: &Watch) -> Outcome {
    let before = watch.rows.iter().rfind(|row| row.segment == 0).copied().unwrap_or_default();
    // The shear, from its start; forces by E.
    let path: Vec<StepRecord> =
        std::iter::once(before).chain(watch.rows.iter().filter(|row| row.segment == 1).copied()).collect();
    let last = path[path.len() - 1];
    let first = path[1].f_t / path[1].delta_t;
    let slopes: Vec<(f64, f64)> = (1..path.len())
        .map(|i| {
            let from = path[..i].iter().rfind(|row| row.delta_t * STRETCH <= path[i].delta_t).unwrap_or(&path[0]);
            let slope = (path[i].f_t - from.f_t) / (path[i].delta_t - from.delta_t);
            (0.5 * (path[i].f_t + from.f_t) / before.f_n, slope / first)
        })
        .collect();
    let friction = LEVELS.map(|level| {
        let falls = slopes.windows(2).find(|w| w[0].1 >= level && w[1].1 < level)?;
        let [(f0, s0), (f1, s1)] = [falls[0], falls[1]];
        Some(f0 + (s0 - level) / (s0 - s1) * (f1 - f0))
    });
    let sphere = ElasticSphere { radius: 1.0, youngs_modulus: 1.0, poissons_ratio: NU };
    Outcome {
        load: before.f_n / brizmer::critical_force(&sphere, 1.0 / setup.stiffness),
        first_stiffness: first * (2.0 - NU) * (1.0 + NU) / (4.0 * before.a),
        friction,
        least_stiffness: slopes.iter().map(|s| s.1).fold(f64::INFINITY, f64::min),
        last_friction: last.f_t / last.f_n,
        growth: (last.stick_radius / before.stick_radius).powi(2),
        traction: watch.traction,
        slid: watch.rows.iter().filter(|row| row.slipping_points > 0).count(),
    }
}

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}

fn run() -> Result<(), Failed> {
    let (mut meshes, mut tangents) = (vec![4, 6, 8, 12], vec![0.0, 0.02]);
    let mut setup =
        Setup { elements: 8, finer: 1, stiffness: 500.0, tangent: 0.0, indentation: 2.8e-4, shear: 0.04, shear_steps: 15 };
    let mut arguments = std::env::args().skip(1);
    while let Some(key) = arguments.next() {
        let value = arguments.next().ok_or_else(|| format!("{key} wants a value"))?;
        match key.as_str() {
            "--meshes" => meshes = value.split(',').map(str::parse).collect::<Result<_, _>>()?,
            "--finer" => setup.finer = value.parse()?,
            "--tangent" => tangents = value.split(',').map(str::parse).collect::<Result<_, _>>()?,
            "--indentation" => setup.indentation = value.parse()?,
            "--stiffness" => setup.stiffness = value.parse()?,
            "--shear" => setup.shear = value.parse()?,
            "--shear-steps" => setup.shear_steps = value.parse()?,
            _ => return Err(format!("no option {key}").into()),
        }
    }
    println!(
        "| E_t/E | elements | P* | K_1 | mu at 0.5 | 0.3 | 0.2 | 0.1 | published | least K | mu at the end | A/A_0 | F_T/(k A) | inner | slid |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|");
    for tangent in tangents {
        for &elements in &meshes {
            let o = shear(&Setup { elements, tangent, ..setup })?;
            let friction = o.friction.map(|mu| mu.map_or("-".to_owned(), |mu| format!("{mu:.3}"))).join(" | ");
            println!(
                "| {tangent} | {elements} | {:.1} | {:.3} | {friction} | {:.3} | {:.3} | {:.3} | {:.2} | {:.2} | {:.3} | {} |",
                o.load,
                o.first_stiffness,
                brizmer::static_friction(o.load),
                o.least_stiffness,
                o.last_friction,
                o.growth,
                o.traction.all,
                o.traction.inner,
                o.slid,
            );
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pressed_to_42(elements: usize, finer: usize, tangent: f64) -> Outcome {
        let setup = Setup { elements, finer, stiffness: 500.0, tangent, indentation: 2.8e-4, shear: 0.04, shear_steps: 15 };
        let outcome = shear(&setup).expect("the path is followed to its end");
        println!("{elements} elements, {finer} times as many at the surface, E_t = {tangent} E: {outcome:?}");
        outcome
    }

    /// Limit analysis: no more than k A can be carried once everything flows in shear. On a mesh
    /// the points at the edge carry more, in proportion to their spacing; the inner ones do not.
    #[test]
    fn the_traction_tends_to_the_flow_stress_in_shear() {
        let [coarse, fine] = [4, 8].map(|elements| pressed_to_42(elements, 1, 0.0));
        let excess = [&coarse, &fine].map(|o| o.traction.all - 1.0);
        // Half as large on a mesh of half the spacing, if k A is the limit; 0.52 and 0.23 measured.
        assert!(excess[1] > 0.1 && (0.35..0.6).contains(&(excess[1] / excess[0])), "{excess:?}");
        // 0.960 measured.
        assert!((0.95..1.005).contains(&fine.traction.inner), "{}", fine.traction.inner);
        // Without hardening the stiffness does fall to a tenth. Where it does comes down with the
        // mesh.
        let [coarse, fine] = [coarse, fine].map(|o| o.friction[3].expect("a tenth is reached"));
        assert!(fine < 0.85 * coarse, "{coarse} {fine}");
    }

    /// The surface decides: 4 elements inside and 8 at the surface are no worse than 8 throughout.
    #[test]
    fn a_finer_surface_does_what_a_finer_mesh_does() {
        let o = pressed_to_42(4, 2, 0.0);
        // 1.15 and 0.988 measured; 1.51 on 4 elements throughout, 1.23 on 8.
        assert!((1.0..1.2).contains(&o.traction.all), "{}", o.traction.all);
        assert!((0.97..1.005).contains(&o.traction.inner), "{}", o.traction.inner);
    }

    /// With E_t = 0.02 E the stiffness levels off near a tenth instead of vanishing: where it
    /// crosses a tenth is no property of the contact.
    #[test]
    fn hardening_keeps_the_stiffness_near_a_tenth() {
        let [ideal, hardening] = [0.0, 0.02].map(|tangent| pressed_to_42(4, 1, tangent));
        assert!(ideal.least_stiffness < 0.05, "{}", ideal.least_stiffness);
        assert!((0.07..0.13).contains(&hardening.least_stiffness), "{}", hardening.least_stiffness);
        // And yet the inner points carry no more than the flow stress that the strain has left
        // behind.
        assert!((0.9..1.03).contains(&hardening.traction.inner), "{}", hardening.traction.inner);
        assert!(hardening.last_friction > 1.2 * ideal.last_friction);
    }
}

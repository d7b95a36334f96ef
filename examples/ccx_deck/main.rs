//! Writes a case as an input deck for CalculiX: the same mesh, material and path, for the
//! comparison in `benches/against_ccx`.
//!
//! `cargo run --release --example ccx_deck -- CASE.toml OUT.inp [--set KEY=VALUE]...
//! [--overclosure N] [--stick-slope N] [--increment SHARE] [--element NAME] [--solver NAME]`
//!
//! Contact is what CalculiX has: surface to surface, a linear pressure-overclosure law of slope 100
//! E/R and a stick slope of 5 E/R, settings with which it is known to finish. The rigid plane is
//! one large element whose nodes are all held, a rigid sphere a cap of small ones. An opponent that
//! deforms is meshed as Asperity does it, lies below as the mirror image of its own coordinates,
//! and is held where the sphere is driven: at its equator, a flat on its dome. The surface of the
//! softer body is the slave.
//!
//! The elements are C3D8, which have Asperity's nodes but lock in plastic flow: their pressure
//! swings from one integration point to the next. `--element` takes three that do not: C3D8R, the
//! same with one point (CalculiX stabilises its hourglass modes), C3D8I, with incompatible modes,
//! and C3D20R, with a node more on each edge.

mod quadratic;
#[cfg(test)]
mod tests;

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;

use asperity::case::{self, Case, Friction, Hold, Opponent, Segment, ShearTarget};
use asperity::internals::mesh::Mesh;
use asperity::internals::mesh::connectivity::FACES;
use asperity::internals::simulation::problem::Problem;
use asperity::material::FlowStress;

use quadratic::Middles;

/// What CalculiX can be told beside the case.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Settings {
    /// Slope of the pressure-overclosure law, in E/R.
    overclosure_slope: f64,
    /// Slope of the traction-slip law of sticking points, in E/R.
    stick_slope: f64,
    /// First and largest increment of a step, as a share of it.
    largest_increment: f64,
    /// The bodies' elements.
    element: Element,
    /// Solver of the linear systems, by CalculiX' name.
    solver: &'static str,
}

/// Solvers of linear systems that CalculiX may have been built with.
const SOLVERS: [&str; 4] = ["SPOOLES", "PARDISO", "ITERATIVE CHOLESKY", "ITERATIVE SCALING"];

/// An element, by CalculiX' name.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Element {
    /// Eight nodes, eight points.
    C3D8,
    /// Eight nodes, one point.
    C3D8R,
    /// Eight nodes, eight points, incompatible modes.
    C3D8I,
    /// Twenty nodes, eight points.
    C3D20R,
}

impl Element {
    const ALL: [Self; 4] = [Self::C3D8, Self::C3D8R, Self::C3D8I, Self::C3D20R];

    fn name(self) -> &'static str {
        match self {
            Self::C3D8 => "C3D8",
            Self::C3D8R => "C3D8R",
            Self::C3D8I => "C3D8I",
            Self::C3D20R => "C3D20R",
        }
    }
}

/// Those with which CalculiX is known to finish.
const KNOWN_TO_FINISH: Settings =
    Settings { overclosure_slope: 100.0, stick_slope: 5.0, largest_increment: 0.1, element: Element::C3D8, solver: SOLVERS[0] };
/// A rigid sphere: facets in y (twice as many in x, along the shear), and its thickness over R.
const CAP: (usize, f64) = (36, 0.2);
/// Faces in CalculiX' numbering, S1 to S6, as positions in [`FACES`].
const FACE_ORDER: [usize; 6] = [4, 5, 2, 1, 3, 0];
/// Equivalent plastic strains at which a smooth hardening law is tabulated: from here to here, and
/// so many.
const TABLE: (f64, f64, usize) = (1e-5, 3.0, 80);

type Failed = Box<dyn std::error::Error>;

fn main() -> ExitCode {
    match arguments().and_then(|arguments| write_deck(&arguments)) {
        Ok(text) => {
            println!("{text}");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}

struct Arguments {
    case: PathBuf,
    out: PathBuf,
    set: Vec<String>,
    settings: Settings,
}

fn arguments() -> Result<Arguments, Failed> {
    const USAGE: &str = "usage: ccx_deck CASE.toml OUT.inp [--set KEY=VALUE]... [--overclosure N] [--stick-slope N] \
                         [--increment SHARE] [--element C3D8|C3D8R|C3D8I|C3D20R] [--solver NAME]";
    let (mut files, mut set, mut settings) = (Vec::new(), Vec::new(), KNOWN_TO_FINISH);
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let number = match argument.as_str() {
            "--element" => {
                let name = arguments.next().unwrap_or_default();
                let known = Element::ALL.into_iter().find(|element| element.name() == name);
                settings.element =
                    known.ok_or_else(|| format!("--element wants C3D8, C3D8R, C3D8I or C3D20R, not \"{name}\""))?;
                continue;
            }
            "--solver" => {
                let name = arguments.next().unwrap_or_default();
                let known = SOLVERS.into_iter().find(|solver| *solver == name);
                settings.solver = known.ok_or_else(|| format!("--solver wants one of {SOLVERS:?}, not \"{name}\""))?;
                continue;
            }
            "--set" => {
                set.push(arguments.next().ok_or("--set wants KEY=VALUE")?);
                continue;
            }
            "--overclosure" => &mut settings.overclosure_slope,
            "--stick-slope" => &mut settings.stick_slope,
            "--increment" => &mut settings.largest_increment,
            _ => {
                files.push(PathBuf::from(argument));
                continue;
            }
        };
        let given = arguments.next().and_then(|word| word.parse().ok()).filter(|given| *given > 0.0);
        *number = given.ok_or_else(|| format!("{argument} wants a number > 0"))?;
    }
    let [case, out] = <[PathBuf; 2]>::try_from(files).map_err(|_| USAGE)?;
    Ok(Arguments { case, out, set, settings })
}

fn write_deck(Arguments { case, out, set, settings }: &Arguments) -> Result<String, Failed> {
    let case = Case::load(case, set)?;
    let problem = Problem::new(&case)?;
    if problem.model.mesh.hanging.iter().any(|hanging| !hanging.is_none()) {
        return Err("mesh: corners that hang are not written in a deck; give elements_per_contact_radius alone".into());
    }
    std::fs::write(out, deck(&case, &problem, settings)?).map_err(|error| format!("{}: {error}", out.display()))?;
    let mesh = &problem.model.mesh;
    Ok(format!("{}: {} nodes, {} elements", out.display(), mesh.nodes.len(), mesh.elements.len()))
}

/// The whole deck, in the case's units.
fn deck(case: &Case, problem: &Problem, settings: &Settings) -> Result<String, Failed> {
    if case.opponent == Some(Opponent::Equal) {
        return Err("a deck has a plane, a rigid sphere or a meshed opponent: give two equal spheres as opponent.radius".into());
    }
    let mut text = String::from("** Half of the lower half of a sphere; symmetry plane y = 0, equator driven.\n");
    geometry(&mut text, case, problem, settings.element)?;
    materials(&mut text, case, problem)?;
    contact(&mut text, case, problem, settings)?;
    let (mut h, mut delta_t) = (0.0, 0.0);
    for segment in &case.path {
        match segment {
            Segment::Indentation { indentation } => h = *indentation,
            Segment::Oblique { indentation, shear } => (h, delta_t) = (*indentation, *shear),
            Segment::Shear { shear: ShearTarget::Displacement(to), hold: Hold::Indentation } => delta_t = *to,
            Segment::Shear { shear: ShearTarget::FullSlip, .. } => {
                return Err("a deck cannot ask for full slip: give the shear a displacement, as in path.1.shear=0.03".into());
            }
            Segment::Shear { .. } => return Err("a held normal force is not written to decks: hold the indentation".into()),
            Segment::Motion { .. } | Segment::Slip { .. } => {
                return Err(
                    "what moves across the x axis or turns is not written to decks: they are of half of the sphere".into()
                );
            }
            Segment::Release { .. } => {
                return Err("a release has no end known in advance: give an indentation to go back to".into());
            }
        }
        step(&mut text, h, delta_t, settings)?;
    }
    Ok(text)
}

/// Nodes, elements, sets and surfaces of the sphere and what it is pressed against.
fn geometry(text: &mut String, case: &Case, problem: &Problem, kind: Element) -> Result<(), Failed> {
    let (mesh, radius) = (&problem.model.mesh, case.sphere.radius);
    let (first_below, first_mirrored) = (mesh.own_nodes(), mesh.own_elements());
    let elements: Vec<[u32; 8]> =
        mesh.elements.iter().enumerate().map(|(e, &element)| turned(element, e >= first_mirrored)).collect();
    let middles = if kind == Element::C3D20R { Middles::new(mesh, &elements, &radii(case)) } else { Middles::default() };
    text.push_str("*NODE, NSET=BODY\n");
    for (i, x) in mesh.nodes.iter().chain(&middles.nodes).enumerate() {
        let above = if i < mesh.nodes.len() { i < first_below } else { middles.above[i - mesh.nodes.len()] };
        // 0 - z, not -z, which would write -0.
        let z = if above { x[2] } else { 0.0 - x[2] };
        writeln!(text, "{}, {:.12e}, {:.12e}, {:.12e}", i + 1, x[0] * radius, x[1] * radius, z * radius)?;
    }
    let kind = kind.name();
    for (e, element) in elements.iter().enumerate() {
        if e == 0 {
            writeln!(text, "*ELEMENT, TYPE={kind}, ELSET=SPHERE")?;
        } else if e == first_mirrored {
            writeln!(text, "*ELEMENT, TYPE={kind}, ELSET=OPPONENT")?;
        }
        let ids: Vec<String> = std::iter::once(e + 1)
            .chain(element.iter().map(|n| *n as usize + 1))
            .chain(middles.of(element).map(|n| n as usize + 1))
            .map(|id| id.to_string())
            .collect();
        // A line of a deck has at most sixteen numbers.
        for (first, some) in ids.chunks(11).enumerate() {
            writeln!(text, "{}{}", some.join(", "), if 11 * (first + 1) < ids.len() { "," } else { "" })?;
        }
    }
    let (driven, held): (Vec<u32>, Vec<u32>) = mesh.plate_nodes.iter().partition(|n| (**n as usize) < first_below);
    let (driven, held) = (middles.with(&driven), middles.with(&held));
    let prescribed: BTreeSet<u32> = driven.iter().chain(&held).copied().collect();
    let symmetry: Vec<u32> = middles.with(&mesh.symmetry_nodes).into_iter().filter(|n| !prescribed.contains(n)).collect();
    set(text, "EQUATOR", &driven)?;
    set(text, "SYMMETRY", &symmetry)?;
    let (above, below): (Vec<_>, Vec<_>) = element_faces(mesh).into_iter().partition(|(e, _)| *e < first_mirrored);
    surface(text, "BELOW", &above)?;
    if mesh.couple.is_some() {
        set(text, "HELD", &held)?;
        // In elements that are turned, S1 and S2 have changed places.
        let turned = |&(e, number): &(usize, usize)| (e, if number < 2 { 1 - number } else { number });
        return surface(text, "ABOVE", &below.iter().map(turned).collect::<Vec<_>>());
    }
    let first = (mesh.nodes.len() + middles.nodes.len(), mesh.elements.len());
    match &problem.case.0.opponent {
        Some(Opponent::Rigid { radius }) => cap(text, case, problem, first, 1.0 / radius),
        _ => plane(text, first, radius),
    }
}

/// Bottom and top exchanged, which keeps the volume of a mirror image positive.
fn turned(mut element: [u32; 8], mirrored: bool) -> [u32; 8] {
    if mirrored {
        element.rotate_left(4);
    }
    element
}

/// Radii of the bodies' curved surfaces, over R; of a flat none.
fn radii(case: &Case) -> Vec<f64> {
    let own = if case.sphere.flat { None } else { Some(1.0) };
    let other = match &case.opponent {
        Some(Opponent::Deforming { radius: Some(radius), .. }) => Some(radius / case.sphere.radius),
        _ => None,
    };
    [own, other].into_iter().flatten().collect()
}

/// The rigid plane, one large element; its top is the surface ABOVE. `first`: nodes and elements
/// before it.
fn plane(text: &mut String, (nodes, elements): (usize, usize), radius: f64) -> Result<(), Failed> {
    let (far, below) = (2.0 * radius, -0.5 * radius);
    text.push_str("*NODE, NSET=HELD\n");
    let square = [[-far, -far], [far, -far], [far, far], [-far, far]];
    for (i, (z, [x, y])) in [below, 0.0].iter().flat_map(|z| square.map(|p| (*z, p))).enumerate() {
        writeln!(text, "{}, {x:.6e}, {y:.6e}, {z:.6e}", nodes + 1 + i)?;
    }
    let ids: Vec<String> = (1..=8).map(|i| (nodes + i).to_string()).collect();
    writeln!(text, "*ELEMENT, TYPE=C3D8, ELSET=OPPONENT\n{}, {}", elements + 1, ids.join(", "))?;
    surface(text, "ABOVE", &[(elements, 1)])
}

/// A rigid sphere of curvature `curvature`/R: a cap of small elements whose nodes are all held, as
/// wide as the fine zone and the shear together. `first`: nodes and elements before it.
fn cap(text: &mut String, case: &Case, problem: &Problem, first: (usize, usize), curvature: f64) -> Result<(), Failed> {
    let radius = case.sphere.radius;
    let sheared = case.path.iter().map(|segment| match segment {
        Segment::Oblique { shear, .. } | Segment::Shear { shear: ShearTarget::Displacement(shear), .. } => shear.abs() / radius,
        _ => 0.0,
    });
    let half = problem.model.mesh.fine_radius + sheared.fold(0.0, f64::max);
    let (facets, thickness) = CAP;
    if curvature * half >= 0.7 {
        return Err(format!("a rigid sphere of radius {} is too small for this fine zone and shear", radius / curvature).into());
    }
    let step = half / facets as f64;
    text.push_str("*NODE, NSET=HELD\n");
    let (wide, deep) = (2 * facets + 1, facets + 2);
    for (layer, below) in [thickness, 0.0].into_iter().enumerate() {
        for j in 0..deep {
            for i in 0..wide {
                // The first row lies beyond the symmetry plane.
                let (x, y) = (i as f64 * step - half, (j as f64 - 1.0) * step);
                let square = x * x + y * y;
                let top = -curvature * square / (1.0 + (1.0 - curvature * curvature * square).sqrt());
                let id = first.0 + 1 + i + wide * (j + deep * layer);
                let z = top - below;
                writeln!(text, "{id}, {:.12e}, {:.12e}, {:.12e}", x * radius, y * radius, z * radius)?;
            }
        }
    }
    text.push_str("*ELEMENT, TYPE=C3D8, ELSET=OPPONENT\n");
    let mut faces = Vec::new();
    for j in 0..deep - 1 {
        for i in 0..wide - 1 {
            let corner = first.0 + 1 + i + wide * j;
            let below = [corner, corner + 1, corner + 1 + wide, corner + wide];
            let ids: Vec<String> = below.into_iter().chain(below.map(|n| n + wide * deep)).map(|n| n.to_string()).collect();
            let element = first.1 + faces.len();
            writeln!(text, "{}, {}", element + 1, ids.join(", "))?;
            faces.push((element, 1));
        }
    }
    surface(text, "ABOVE", &faces)
}

/// A surface of faces: element and number, both counted from 0.
fn surface(text: &mut String, name: &str, faces: &[(usize, usize)]) -> Result<(), Failed> {
    writeln!(text, "*SURFACE, NAME={name}, TYPE=ELEMENT")?;
    for (element, number) in faces {
        writeln!(text, "{}, S{}", element + 1, number + 1)?;
    }
    Ok(())
}

fn set(text: &mut String, name: &str, nodes: &[u32]) -> Result<(), Failed> {
    writeln!(text, "*NSET, NSET={name}")?;
    for some in nodes.chunks(12) {
        let ids: Vec<String> = some.iter().map(|n| (n + 1).to_string()).collect();
        writeln!(text, "{},", ids.join(", "))?;
    }
    Ok(())
}

/// Element and number (0 to 5, for S1 to S6) of each contact face.
fn element_faces(mesh: &Mesh) -> Vec<(usize, usize)> {
    let sorted = |mut face: [u32; 4]| {
        face.sort_unstable();
        face
    };
    let wanted: BTreeSet<[u32; 4]> = mesh.contact_faces.iter().map(|&face| sorted(face)).collect();
    let mut found = Vec::with_capacity(wanted.len());
    for (e, element) in mesh.elements.iter().enumerate() {
        for (number, at) in FACE_ORDER.iter().enumerate() {
            if wanted.contains(&sorted(FACES[*at].map(|local| element[local]))) {
                found.push((e, number));
            }
        }
    }
    found
}

/// Materials of both bodies; a plane has the sphere's elasticity, which does not matter.
fn materials(text: &mut String, case: &Case, problem: &Problem) -> Result<(), Failed> {
    let model = &problem.model;
    let e = case.material.youngs_modulus;
    material(text, "METAL", &case.material, e, &model.material.hardening)?;
    match (&case.opponent, &model.opponent) {
        // Its law is in units of the sphere's E too.
        (Some(Opponent::Deforming { material: given, .. }), Some(scaled)) => {
            material(text, "OTHER", given, e, &scaled.hardening)?;
        }
        _ => material(text, "OTHER", &case.material, e, &FlowStress::Elastic)?,
    }
    text.push_str("*SOLID SECTION, ELSET=SPHERE, MATERIAL=METAL\n*SOLID SECTION, ELSET=OPPONENT, MATERIAL=OTHER\n");
    Ok(())
}

/// Elasticity and the hardening curve, the law's stress times `unit`; stresses in the case's units.
fn material(text: &mut String, name: &str, given: &case::Material, unit: f64, law: &FlowStress<f64>) -> Result<(), Failed> {
    let (e, nu) = (given.youngs_modulus, given.poissons_ratio);
    writeln!(text, "*MATERIAL, NAME={name}\n*ELASTIC\n{e:.12e}, {nu:.12e}")?;
    if matches!(law, FlowStress::Elastic) {
        return Ok(());
    }
    text.push_str("*PLASTIC\n");
    let (first, last, count) = TABLE;
    let ratio = (last / first).powf(1.0 / (count - 1) as f64);
    let strains = std::iter::once(0.0).chain((0..count).map(|i| first * ratio.powi(i as i32)));
    let mut before = f64::NEG_INFINITY;
    for strain in strains {
        let stress = unit * law.flow_stress(strain);
        // Ideal plasticity is one line; CalculiX keeps the last stress beyond the last strain.
        if stress != before {
            writeln!(text, "{stress:.12e}, {strain:.12e}")?;
        }
        before = stress;
    }
    Ok(())
}

fn contact(text: &mut String, case: &Case, problem: &Problem, settings: &Settings) -> Result<(), Failed> {
    let unit = case.material.youngs_modulus / case.sphere.radius;
    writeln!(
        text,
        "*SURFACE INTERACTION, NAME=TOUCH\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n{:.12e}",
        settings.overclosure_slope * unit
    )?;
    match case.contact.friction {
        Friction::Coefficient(0.0) => {}
        Friction::Coefficient(mu) => writeln!(text, "*FRICTION\n{mu:.12e}, {:.12e}", settings.stick_slope * unit)?,
        Friction::Stick => return Err("full stick is not written to decks: give a coefficient of friction".into()),
    }
    let slave_is_opponent = problem.couple().is_some_and(|bodies| bodies.slave == 1);
    let pair = if slave_is_opponent { "ABOVE, BELOW" } else { "BELOW, ABOVE" };
    writeln!(text, "*CONTACT PAIR, INTERACTION=TOUCH, TYPE=SURFACE TO SURFACE\n{pair}")?;
    text.push_str("*BOUNDARY\nHELD, 1, 3\nSYMMETRY, 2, 2\n");
    Ok(())
}

/// One segment; the equator's reaction of every increment goes to the .dat file.
fn step(text: &mut String, h: f64, delta_t: f64, settings: &Settings) -> Result<(), Failed> {
    let (solver, largest) = (settings.solver, settings.largest_increment);
    writeln!(text, "*STEP, NLGEOM, INC=1000\n*STATIC, SOLVER={solver}\n{largest}, 1., 1e-6, {largest}")?;
    writeln!(text, "*BOUNDARY\nEQUATOR, 1, 1, {delta_t:.12e}\nEQUATOR, 2, 2\nEQUATOR, 3, 3, {:.12e}", -h)?;
    text.push_str("*NODE PRINT, NSET=EQUATOR, TOTALS=ONLY\nRF\n*END STEP\n");
    Ok(())
}

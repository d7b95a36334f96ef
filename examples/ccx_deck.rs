//! Writes a case as an input deck for CalculiX: the same mesh, material and path, for the
//! comparison in `benches/against_ccx`.
//!
//! `cargo run --release --example ccx_deck -- CASE.toml OUT.inp [--set KEY=VALUE]`
//!
//! Contact is what CalculiX has: surface to surface, a linear pressure-overclosure law of slope 100
//! E/R and a stick slope of 5 E/R, settings with which it is known to finish. The rigid plane is
//! one large element whose nodes are all held.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use asperity::case::{Case, Friction, Hold, Segment, ShearTarget};
use asperity::internals::mesh::Mesh;
use asperity::internals::mesh::connectivity::FACES;
use asperity::internals::simulation::problem::Problem;
use asperity::material::Hardening;

/// Slope of the pressure-overclosure law, in E/R.
const OVERCLOSURE_SLOPE: f64 = 100.0;
/// Slope of the traction-slip law of sticking points, in E/R.
const STICK_SLOPE: f64 = 5.0;
/// First and largest increment of a step: a tenth of it, with which CalculiX is known to finish.
const LARGEST_INCREMENT: f64 = 0.1;
/// Faces in CalculiX' numbering, S1 to S6, as positions in [`FACES`].
const FACE_ORDER: [usize; 6] = [4, 5, 2, 1, 3, 0];
/// Equivalent plastic strains at which a smooth hardening law is tabulated: from here to here, and
/// so many.
const TABLE: (f64, f64, usize) = (1e-5, 3.0, 80);

type Failed = Box<dyn std::error::Error>;

fn main() -> ExitCode {
    match arguments().and_then(|(case, out, set)| write_deck(&case, &out, &set)) {
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

fn arguments() -> Result<(PathBuf, PathBuf, Vec<String>), Failed> {
    let (mut files, mut set) = (Vec::new(), Vec::new());
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--set" => set.push(arguments.next().ok_or("--set wants KEY=VALUE")?),
            _ => files.push(PathBuf::from(argument)),
        }
    }
    match <[PathBuf; 2]>::try_from(files) {
        Ok([case, out]) => Ok((case, out, set)),
        Err(_) => Err("usage: ccx_deck CASE.toml OUT.inp [--set KEY=VALUE]".into()),
    }
}

fn write_deck(case: &Path, out: &Path, set: &[String]) -> Result<String, Failed> {
    let case = Case::load(case, set)?;
    let problem = Problem::new(&case)?;
    std::fs::write(out, deck(&case, &problem)?).map_err(|error| format!("{}: {error}", out.display()))?;
    let mesh = &problem.model.mesh;
    Ok(format!("{}: {} nodes, {} elements", out.display(), mesh.nodes.len(), mesh.elements.len()))
}

/// The whole deck, in the case's units.
fn deck(case: &Case, problem: &Problem) -> Result<String, Failed> {
    let mesh = &problem.model.mesh;
    let mut text =
        String::from("** Half of the lower half of a sphere on a rigid plane; symmetry plane y = 0, equator driven.\n");
    geometry(&mut text, mesh, case.sphere.radius)?;
    material(&mut text, case, &problem.model.material.hardening)?;
    contact(&mut text, case)?;
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
            Segment::Release { .. } => {
                return Err("a release has no end known in advance: give an indentation to go back to".into());
            }
        }
        step(&mut text, h, delta_t)?;
    }
    Ok(text)
}

/// Nodes, elements, sets, surfaces and the plane.
fn geometry(text: &mut String, mesh: &Mesh, radius: f64) -> Result<(), Failed> {
    let nodes = mesh.nodes.len();
    text.push_str("*NODE, NSET=BODY\n");
    for (i, x) in mesh.nodes.iter().enumerate() {
        writeln!(text, "{}, {:.12e}, {:.12e}, {:.12e}", i + 1, x[0] * radius, x[1] * radius, x[2] * radius)?;
    }
    text.push_str("*ELEMENT, TYPE=C3D8, ELSET=SPHERE\n");
    for (e, element) in mesh.elements.iter().enumerate() {
        let ids: Vec<String> = element.iter().map(|n| (n + 1).to_string()).collect();
        writeln!(text, "{}, {}", e + 1, ids.join(", "))?;
    }
    let (far, below) = (2.0 * radius, -0.5 * radius);
    text.push_str("*NODE, NSET=PLANE_NODES\n");
    let square = [[-far, -far], [far, -far], [far, far], [-far, far]];
    for (i, (z, [x, y])) in [below, 0.0].iter().flat_map(|z| square.map(|p| (*z, p))).enumerate() {
        writeln!(text, "{}, {x:.6e}, {y:.6e}, {z:.6e}", nodes + 1 + i)?;
    }
    let plane = mesh.elements.len() + 1;
    let ids: Vec<String> = (1..=8).map(|i| (nodes + i).to_string()).collect();
    writeln!(text, "*ELEMENT, TYPE=C3D8, ELSET=PLANE\n{plane}, {}", ids.join(", "))?;

    let driven: std::collections::BTreeSet<u32> = mesh.plate_nodes.iter().copied().collect();
    let symmetry: Vec<u32> = mesh.symmetry_nodes.iter().copied().filter(|n| !driven.contains(n)).collect();
    set(text, "EQUATOR", &mesh.plate_nodes)?;
    set(text, "SYMMETRY", &symmetry)?;
    text.push_str("*SURFACE, NAME=BELOW, TYPE=ELEMENT\n");
    for (element, face) in element_faces(mesh) {
        writeln!(text, "{}, S{}", element + 1, face + 1)?;
    }
    // The top of the plane's element.
    writeln!(text, "*SURFACE, NAME=PLANE_TOP, TYPE=ELEMENT\n{plane}, S2")?;
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
    let wanted: std::collections::BTreeSet<[u32; 4]> = mesh.contact_faces.iter().map(|&face| sorted(face)).collect();
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

/// Elasticity and the hardening curve; stresses in the case's units.
fn material(text: &mut String, case: &Case, law: &Hardening<f64>) -> Result<(), Failed> {
    let e = case.material.youngs_modulus;
    writeln!(text, "*MATERIAL, NAME=METAL\n*ELASTIC\n{e:.12e}, {:.12e}", case.material.poissons_ratio)?;
    if !matches!(law, Hardening::Elastic) {
        text.push_str("*PLASTIC\n");
        let (first, last, count) = TABLE;
        let ratio = (last / first).powf(1.0 / (count - 1) as f64);
        let strains = std::iter::once(0.0).chain((0..count).map(|i| first * ratio.powi(i as i32)));
        let mut before = f64::NEG_INFINITY;
        for strain in strains {
            let stress = e * law.flow_stress(strain);
            // Ideal plasticity is one line; CalculiX keeps the last stress beyond the last strain.
            if stress != before {
                writeln!(text, "{stress:.12e}, {strain:.12e}")?;
            }
            before = stress;
        }
    }
    text.push_str("*MATERIAL, NAME=STIFF\n*ELASTIC\n");
    writeln!(text, "{e:.12e}, 0.3")?;
    text.push_str("*SOLID SECTION, ELSET=SPHERE, MATERIAL=METAL\n*SOLID SECTION, ELSET=PLANE, MATERIAL=STIFF\n");
    Ok(())
}

fn contact(text: &mut String, case: &Case) -> Result<(), Failed> {
    let unit = case.material.youngs_modulus / case.sphere.radius;
    writeln!(
        text,
        "*SURFACE INTERACTION, NAME=TOUCH\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n{:.12e}",
        OVERCLOSURE_SLOPE * unit
    )?;
    match case.contact.friction {
        Friction::Coefficient(0.0) => {}
        Friction::Coefficient(mu) => writeln!(text, "*FRICTION\n{mu:.12e}, {:.12e}", STICK_SLOPE * unit)?,
        Friction::Stick => return Err("full stick is not written to decks: give a coefficient of friction".into()),
    }
    text.push_str("*CONTACT PAIR, INTERACTION=TOUCH, TYPE=SURFACE TO SURFACE\nBELOW, PLANE_TOP\n");
    text.push_str("*BOUNDARY\nPLANE_NODES, 1, 3\nSYMMETRY, 2, 2\n");
    Ok(())
}

/// One segment; the equator's reaction of every increment goes to the .dat file.
fn step(text: &mut String, h: f64, delta_t: f64) -> Result<(), Failed> {
    let largest = LARGEST_INCREMENT;
    writeln!(text, "*STEP, NLGEOM, INC=1000\n*STATIC\n{largest}, 1., 1e-6, {largest}")?;
    writeln!(text, "*BOUNDARY\nEQUATOR, 1, 1, {delta_t:.12e}\nEQUATOR, 2, 2\nEQUATOR, 3, 3, {:.12e}", -h)?;
    text.push_str("*NODE PRINT, NSET=EQUATOR, TOTALS=ONLY\nRF\n*END STEP\n");
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    /// CalculiX' manual, "Eight-node brick element": nodes of the faces S1 to S6, counted from 1.
    const MANUAL: [[usize; 4]; 6] = [[1, 2, 3, 4], [5, 8, 7, 6], [1, 5, 6, 2], [2, 6, 7, 3], [3, 7, 8, 4], [4, 8, 5, 1]];

    fn case(keys: &[&str]) -> (Case, Problem) {
        let file = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/benches/against_ccx/case.toml"));
        let keys: Vec<String> = ["mesh.elements_per_contact_radius=4", "mesh.fine_zone=1.3"]
            .iter()
            .chain(keys)
            .map(|key| (*key).to_owned())
            .collect();
        let case = Case::load(file, &keys).expect("a case");
        let problem = Problem::new(&case).expect("a problem");
        (case, problem)
    }

    fn text(keys: &[&str]) -> Result<String, String> {
        let (case, problem) = case(keys);
        deck(&case, &problem).map_err(|error| error.to_string())
    }

    /// Lines of data under the cards that begin with `card`.
    fn data<'a>(deck: &'a str, card: &str) -> Vec<Vec<&'a str>> {
        let mut found = Vec::new();
        let mut inside = false;
        for line in deck.lines() {
            if line.starts_with('*') {
                inside = line.starts_with(card);
            } else if inside {
                found.push(line.split(',').map(str::trim).filter(|word| !word.is_empty()).collect());
            }
        }
        found
    }

    fn number(word: &str) -> f64 {
        word.parse().expect("a number")
    }

    #[test]
    fn the_contact_surface_is_that_of_the_mesh() {
        let (_, problem) = case(&[]);
        let (deck, mesh) = (text(&[]).expect("a deck"), &problem.model.mesh);
        assert_eq!(data(&deck, "*NODE, NSET=BODY").len(), mesh.nodes.len());
        assert_eq!(data(&deck, "*ELEMENT, TYPE=C3D8, ELSET=SPHERE").len(), mesh.elements.len());
        let faces = |face: &[u32; 4]| face.iter().copied().collect::<BTreeSet<u32>>();
        let wanted: BTreeSet<_> = mesh.contact_faces.iter().map(faces).collect();
        let found: BTreeSet<_> = data(&deck, "*SURFACE, NAME=BELOW")
            .iter()
            .map(|row| {
                let element: usize = row[0].parse().expect("an element");
                let side: usize = row[1].strip_prefix('S').and_then(|s| s.parse().ok()).expect("a side");
                faces(&MANUAL[side - 1].map(|local| mesh.elements[element - 1][local - 1]))
            })
            .collect();
        assert_eq!(found, wanted);
        // The plane's S2 is its top, z = 0, wide enough for the whole lower half.
        let plane = data(&deck, "*NODE, NSET=PLANE_NODES");
        for local in MANUAL[1] {
            assert!(number(plane[local - 1][3]) == 0.0 && number(plane[local - 1][1]).abs() == 2.0, "{plane:?}");
        }
    }

    #[test]
    fn every_name_is_defined_and_every_node_held_once() {
        let deck = text(&[]).expect("a deck");
        let defined: BTreeSet<&str> = deck
            .lines()
            .filter(|l| l.starts_with('*'))
            .flat_map(|l| l.split(", "))
            .filter_map(|w| w.split_once('='))
            .map(|(_, n)| n)
            .collect();
        for row in data(&deck, "*BOUNDARY").iter().chain(&data(&deck, "*CONTACT PAIR")) {
            assert!(row.iter().take(2).filter(|word| word.parse::<f64>().is_err()).all(|name| defined.contains(name)), "{row:?}");
        }
        let nodes = |set: &str| -> BTreeSet<String> { data(&deck, set).concat().iter().map(|n| n.to_string()).collect() };
        let (equator, symmetry) = (nodes("*NSET, NSET=EQUATOR"), nodes("*NSET, NSET=SYMMETRY"));
        assert!(!equator.is_empty() && !symmetry.is_empty() && equator.is_disjoint(&symmetry));
    }

    #[test]
    fn numbers_are_in_the_units_of_the_case() {
        let deck = text(&["sphere.radius=2.0", "path.0.indentation=0.04", "path.1.shear=-0.06"]).expect("a deck");
        assert_eq!(number(data(&deck, "*SURFACE BEHAVIOR")[0][0]), 100.0 * 200e3 / 2.0);
        assert_eq!(data(&deck, "*FRICTION")[0].iter().map(|w| number(w)).collect::<Vec<_>>(), [0.3, 5.0 * 200e3 / 2.0]);
        assert_eq!(
            data(&deck, "*PLASTIC").iter().map(|row| (number(row[0]), number(row[1]))).collect::<Vec<_>>(),
            [(400.0, 0.0)]
        );
        let top = data(&deck, "*NODE, NSET=BODY").iter().map(|row| number(row[3])).fold(0.0, f64::max);
        assert_eq!(top, 2.0);
        let held: Vec<f64> = data(&deck, "*BOUNDARY").iter().filter(|row| row.len() == 4).map(|row| number(row[3])).collect();
        assert_eq!(held, [0.0, -0.04, -0.06, -0.04]);
        // Hardening comes as a table that rises.
        let law = "material.hardening={law=\"linear\",yield_stress=400.0,modulus=1000.0}";
        let rows = data(&text(&[law]).expect("a deck"), "*PLASTIC")
            .iter()
            .map(|row| [number(row[0]), number(row[1])])
            .collect::<Vec<_>>();
        assert!(rows.len() > 50 && rows.windows(2).all(|two| two[0][0] < two[1][0] && two[0][1] < two[1][1]));
        assert!(rows.iter().all(|[stress, strain]| (stress - 400.0 - 1000.0 * strain).abs() < 1e-9 * stress), "{rows:?}");
    }

    #[test]
    fn what_calculix_cannot_follow_is_refused() {
        for (key, word) in [
            ("path.1.shear=\"full-slip\"", "path.1.shear=0.03"),
            ("path.1.hold=\"normal-force\"", "hold"),
            ("contact.friction=\"stick\"", "stick"),
        ] {
            let error = text(&[key]).expect_err(key);
            assert!(error.contains(word), "{error}");
        }
    }

    #[test]
    fn calculix_takes_the_deck() {
        let Ok(version) = std::process::Command::new("ccx").arg("-v").output() else {
            eprintln!("SKIPPED: ccx is not installed");
            return;
        };
        assert!(String::from_utf8_lossy(&version.stdout).contains("Version"));
        let dir = tempfile::tempdir().expect("a directory");
        // One increment of the press.
        let deck = text(&[]).expect("a deck").replacen("0.1, 1., 1e-6, 0.1", "0.1, 0.1, 1e-6, 0.1", 1);
        let first = deck.split_inclusive("*END STEP\n").next().expect("a step");
        std::fs::write(dir.path().join("deck.inp"), first).expect("the deck");
        let run = std::process::Command::new("ccx").args(["-i", "deck"]).current_dir(dir.path()).output().expect("ccx runs");
        let told = String::from_utf8_lossy(&run.stdout).into_owned();
        assert!(run.status.success() && !told.contains("*ERROR") && !told.contains("*WARNING"), "{told}");
        let forces = std::fs::read_to_string(dir.path().join("deck.dat")).expect("forces");
        let last = forces.lines().rev().find(|line| !line.trim().is_empty()).expect("a line");
        let pressed: Vec<f64> = last.split_whitespace().map(number).collect();
        assert!(pressed.len() == 3 && pressed[2] < -1.0 && pressed[0].abs() < 1e-6, "{last}");
    }
}

//! Writes a case as an input deck for CalculiX: the same mesh, material and path, for the
//! comparison in `benches/against_ccx`.
//!
//! `cargo run --release --example ccx_deck -- CASE.toml OUT.inp [--set KEY=VALUE]...
//! [--overclosure N] [--stick-slope N] [--increment SHARE]`
//!
//! Contact is what CalculiX has: surface to surface, a linear pressure-overclosure law of slope 100
//! E/R and a stick slope of 5 E/R, settings with which it is known to finish. The rigid plane is
//! one large element whose nodes are all held. An opponent that deforms is meshed as Asperity does
//! it, lies below as the mirror image of its own coordinates, and is held where the sphere is
//! driven: at its equator, a flat on its dome. The surface of the softer body is the slave.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;

use asperity::case::{self, Case, Friction, Hold, Opponent, Segment, ShearTarget};
use asperity::internals::mesh::Mesh;
use asperity::internals::mesh::connectivity::FACES;
use asperity::internals::simulation::problem::Problem;
use asperity::material::Hardening;

/// What CalculiX can be told beside the case.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Settings {
    /// Slope of the pressure-overclosure law, in E/R.
    overclosure_slope: f64,
    /// Slope of the traction-slip law of sticking points, in E/R.
    stick_slope: f64,
    /// First and largest increment of a step, as a share of it.
    largest_increment: f64,
}

/// Those with which CalculiX is known to finish.
const KNOWN_TO_FINISH: Settings = Settings { overclosure_slope: 100.0, stick_slope: 5.0, largest_increment: 0.1 };
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
    const USAGE: &str =
        "usage: ccx_deck CASE.toml OUT.inp [--set KEY=VALUE]... [--overclosure N] [--stick-slope N] [--increment SHARE]";
    let (mut files, mut set, mut settings) = (Vec::new(), Vec::new(), KNOWN_TO_FINISH);
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let number = match argument.as_str() {
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
    std::fs::write(out, deck(&case, &problem, settings)?).map_err(|error| format!("{}: {error}", out.display()))?;
    let mesh = &problem.model.mesh;
    Ok(format!("{}: {} nodes, {} elements", out.display(), mesh.nodes.len(), mesh.elements.len()))
}

/// The whole deck, in the case's units.
fn deck(case: &Case, problem: &Problem, settings: &Settings) -> Result<String, Failed> {
    if problem.equal_pair || problem.rigid.is_some() {
        return Err("a deck has a plane or a meshed opponent: give two equal spheres as opponent.radius".into());
    }
    let mesh = &problem.model.mesh;
    let mut text = String::from("** Half of the lower half of a sphere; symmetry plane y = 0, equator driven.\n");
    geometry(&mut text, mesh, case.sphere.radius)?;
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
            Segment::Release { .. } => {
                return Err("a release has no end known in advance: give an indentation to go back to".into());
            }
        }
        step(&mut text, h, delta_t, settings.largest_increment)?;
    }
    Ok(text)
}

/// Nodes, elements, sets and surfaces of the sphere and what it is pressed against.
fn geometry(text: &mut String, mesh: &Mesh, radius: f64) -> Result<(), Failed> {
    let couple = mesh.couple.as_deref();
    let first_below = couple.map_or(mesh.nodes.len(), |couple| couple.node);
    let first_mirrored = couple.map_or(mesh.elements.len(), |couple| couple.element);
    text.push_str("*NODE, NSET=BODY\n");
    for (i, x) in mesh.nodes.iter().enumerate() {
        // 0 - z, not -z, which would write -0.
        let z = if i < first_below { x[2] } else { 0.0 - x[2] };
        writeln!(text, "{}, {:.12e}, {:.12e}, {:.12e}", i + 1, x[0] * radius, x[1] * radius, z * radius)?;
    }
    for (e, element) in mesh.elements.iter().enumerate() {
        let mut ids = element.map(|n| (n + 1).to_string());
        if e == 0 {
            text.push_str("*ELEMENT, TYPE=C3D8, ELSET=SPHERE\n");
        } else if e == first_mirrored {
            text.push_str("*ELEMENT, TYPE=C3D8, ELSET=OPPONENT\n");
        }
        if e >= first_mirrored {
            // Bottom and top exchanged, which keeps the volume of a mirror image positive.
            ids.rotate_left(4);
        }
        writeln!(text, "{}, {}", e + 1, ids.join(", "))?;
    }
    let (driven, held): (Vec<u32>, Vec<u32>) = mesh.plate_nodes.iter().partition(|n| (**n as usize) < first_below);
    let prescribed: BTreeSet<u32> = mesh.plate_nodes.iter().copied().collect();
    let symmetry: Vec<u32> = mesh.symmetry_nodes.iter().copied().filter(|n| !prescribed.contains(n)).collect();
    set(text, "EQUATOR", &driven)?;
    set(text, "SYMMETRY", &symmetry)?;
    let (above, below): (Vec<_>, Vec<_>) = element_faces(mesh).into_iter().partition(|(e, _)| *e < first_mirrored);
    surface(text, "BELOW", &above)?;
    if couple.is_some() {
        set(text, "HELD", &held)?;
        // In elements that are turned, S1 and S2 have changed places.
        let turned = |&(e, number): &(usize, usize)| (e, if number < 2 { 1 - number } else { number });
        return surface(text, "ABOVE", &below.iter().map(turned).collect::<Vec<_>>());
    }
    plane(text, mesh, radius)
}

/// The rigid plane, one large element; its top is the surface ABOVE.
fn plane(text: &mut String, mesh: &Mesh, radius: f64) -> Result<(), Failed> {
    let (nodes, element) = (mesh.nodes.len(), mesh.elements.len());
    let (far, below) = (2.0 * radius, -0.5 * radius);
    text.push_str("*NODE, NSET=HELD\n");
    let square = [[-far, -far], [far, -far], [far, far], [-far, far]];
    for (i, (z, [x, y])) in [below, 0.0].iter().flat_map(|z| square.map(|p| (*z, p))).enumerate() {
        writeln!(text, "{}, {x:.6e}, {y:.6e}, {z:.6e}", nodes + 1 + i)?;
    }
    let ids: Vec<String> = (1..=8).map(|i| (nodes + i).to_string()).collect();
    writeln!(text, "*ELEMENT, TYPE=C3D8, ELSET=OPPONENT\n{}, {}", element + 1, ids.join(", "))?;
    surface(text, "ABOVE", &[(element, 1)])
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
        _ => material(text, "OTHER", &case.material, e, &Hardening::Elastic)?,
    }
    text.push_str("*SOLID SECTION, ELSET=SPHERE, MATERIAL=METAL\n*SOLID SECTION, ELSET=OPPONENT, MATERIAL=OTHER\n");
    Ok(())
}

/// Elasticity and the hardening curve, the law's stress times `unit`; stresses in the case's units.
fn material(text: &mut String, name: &str, given: &case::Material, unit: f64, law: &Hardening<f64>) -> Result<(), Failed> {
    let (e, nu) = (given.youngs_modulus, given.poissons_ratio);
    writeln!(text, "*MATERIAL, NAME={name}\n*ELASTIC\n{e:.12e}, {nu:.12e}")?;
    if matches!(law, Hardening::Elastic) {
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
    let slave_is_opponent = problem.couple.as_ref().is_some_and(|(slave, _)| *slave == 1);
    let pair = if slave_is_opponent { "ABOVE, BELOW" } else { "BELOW, ABOVE" };
    writeln!(text, "*CONTACT PAIR, INTERACTION=TOUCH, TYPE=SURFACE TO SURFACE\n{pair}")?;
    text.push_str("*BOUNDARY\nHELD, 1, 3\nSYMMETRY, 2, 2\n");
    Ok(())
}

/// One segment; the equator's reaction of every increment goes to the .dat file.
fn step(text: &mut String, h: f64, delta_t: f64, largest: f64) -> Result<(), Failed> {
    writeln!(text, "*STEP, NLGEOM, INC=1000\n*STATIC\n{largest}, 1., 1e-6, {largest}")?;
    writeln!(text, "*BOUNDARY\nEQUATOR, 1, 1, {delta_t:.12e}\nEQUATOR, 2, 2\nEQUATOR, 3, 3, {:.12e}", -h)?;
    text.push_str("*NODE PRINT, NSET=EQUATOR, TOTALS=ONLY\nRF\n*END STEP\n");
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    /// CalculiX' manual, "Eight-node brick element": nodes of the faces S1 to S6, counted from 1.
    const MANUAL: [[usize; 4]; 6] = [[1, 2, 3, 4], [5, 8, 7, 6], [1, 5, 6, 2], [2, 6, 7, 3], [3, 7, 8, 4], [4, 8, 5, 1]];

    fn case(keys: &[&str]) -> (Case, Problem) {
        case_of("case.toml", keys)
    }

    fn case_of(name: &str, keys: &[&str]) -> (Case, Problem) {
        let file = &Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/benches/against_ccx")).join(name);
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
        text_of("case.toml", keys)
    }

    fn text_of(name: &str, keys: &[&str]) -> Result<String, String> {
        let (case, problem) = case_of(name, keys);
        deck(&case, &problem, &KNOWN_TO_FINISH).map_err(|error| error.to_string())
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
        let plane = data(&deck, "*NODE, NSET=HELD");
        for local in MANUAL[1] {
            assert!(number(plane[local - 1][3]) == 0.0 && number(plane[local - 1][1]).abs() == 2.0, "{plane:?}");
        }
    }

    #[test]
    fn every_name_is_defined_and_every_node_held_once() {
        ["case.toml", "pairs/unlike.toml", "pairs/larger.toml", "pairs/flat.toml"].into_iter().for_each(names_and_nodes);
    }

    fn names_and_nodes(name: &str) {
        let deck = text_of(name, &[]).expect("a deck");
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
        let held = nodes("*NSET, NSET=HELD");
        assert_eq!(held.is_empty(), name == "case.toml");
        assert!(held.is_disjoint(&symmetry) && held.is_disjoint(&equator));
    }

    /// Position of each node, and the nodes of each element from 0 on.
    fn mesh_of(deck: &str) -> (Vec<[f64; 3]>, Vec<Vec<usize>>) {
        let nodes = data(deck, "*NODE, NSET=BODY").iter().map(|row| [1, 2, 3].map(|i| number(row[i]))).collect();
        let element = |row: &Vec<&str>| row[1..].iter().map(|n| n.parse::<usize>().expect("a node") - 1).collect();
        (nodes, data(deck, "*ELEMENT").iter().map(element).collect())
    }

    fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|i| a[i] - b[i])
    }

    fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    }

    fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
        (0..3).map(|i| a[i] * b[i]).sum()
    }

    #[test]
    fn an_opponent_lies_below_with_its_volume_and_its_surface() {
        for name in ["pairs/unlike.toml", "pairs/larger.toml", "pairs/flat.toml"] {
            let deck = text_of(name, &[]).expect("a deck");
            let (nodes, elements) = mesh_of(&deck);
            let above = data(&deck, "*ELEMENT, TYPE=C3D8, ELSET=SPHERE").len();
            assert!(0 < above && above < elements.len());
            for (e, element) in elements.iter().enumerate() {
                let at = |i: usize| nodes[element[i]];
                let edges = [1, 3, 4].map(|i| minus(at(i), at(0)));
                assert!(dot(cross(edges[0], edges[1]), edges[2]) > 0.0, "{name}: element {e}");
                assert!((0..8).all(|i| if e < above { at(i)[2] >= 0.0 } else { at(i)[2] <= 0.0 }), "{name}: element {e}");
            }
            // The manual has the nodes of all faces around the inward normal: up on the sphere, down
            // in what lies below. Both surfaces have a node at the pole.
            for (surface, inward) in [("BELOW", 1.0), ("ABOVE", -1.0)] {
                let mut nearest = f64::INFINITY;
                for row in data(&deck, &format!("*SURFACE, NAME={surface},")) {
                    let element: usize = row[0].parse().expect("an element");
                    let side: usize = row[1].strip_prefix('S').and_then(|s| s.parse().ok()).expect("a side");
                    let corners = MANUAL[side - 1].map(|local| nodes[elements[element - 1][local - 1]]);
                    let normal = cross(minus(corners[2], corners[0]), minus(corners[3], corners[1]));
                    assert!((element - 1 < above) == (inward > 0.0), "{name}: {surface} has the other body");
                    nearest = corners.iter().map(|x| dot(*x, *x)).fold(nearest, f64::min);
                    let centre = [0, 1, 2].map(|i| corners.iter().map(|x| x[i]).sum::<f64>() / 4.0);
                    if dot(centre, centre) < 0.01 {
                        assert!(inward * normal[2] > 0.0, "{name}: {surface} {row:?}");
                    }
                }
                assert!(nearest < 1e-20, "{name}: {surface} is {nearest} from the pole");
            }
        }
    }

    #[test]
    fn each_body_has_its_material_and_the_softer_one_is_the_slave() {
        let plastic = |deck: &str| data(deck, "*PLASTIC").iter().map(|row| number(row[0])).collect::<Vec<_>>();
        let elastic = |deck: &str| data(deck, "*ELASTIC").iter().map(|row| [number(row[0]), number(row[1])]).collect::<Vec<_>>();
        let near = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-9;
        let unlike = text_of("pairs/unlike.toml", &[]).expect("a deck");
        assert_eq!(elastic(&unlike), [[200e3, 0.3], [600e3, 0.3]]);
        let yields = plastic(&unlike);
        assert!(yields.len() == 2 && near(yields[0], 400.0) && near(yields[1], 800.0), "{yields:?}");
        assert_eq!(data(&unlike, "*CONTACT PAIR"), [["BELOW", "ABOVE"]]);
        let larger = text_of("pairs/larger.toml", &[]).expect("a deck");
        assert_eq!(elastic(&larger), [[200e3, 0.3], [100e3, 0.33]]);
        assert_eq!(data(&larger, "*CONTACT PAIR"), [["ABOVE", "BELOW"]]);
        // 200 + 600 sqrt(alpha), after the sphere's 81 rows, of which the last is at alpha = 3.
        let yields = plastic(&larger);
        assert!(near(yields[81], 200.0) && near(yields[161], 200.0 + 600.0 * 3f64.sqrt()), "{yields:?}");
        let bottom = |deck: &str| mesh_of(deck).0.iter().map(|x| x[2]).fold(0.0, f64::min);
        assert!(near(bottom(&unlike), -1.0) && near(bottom(&larger), -2.0));
    }

    #[test]
    fn settings_are_what_was_asked_for() {
        let (case, problem) = case(&[]);
        let settings = Settings { overclosure_slope: 200.0, stick_slope: 20.0, largest_increment: 0.05 };
        let deck = deck(&case, &problem, &settings).expect("a deck");
        assert_eq!(number(data(&deck, "*SURFACE BEHAVIOR")[0][0]), 200.0 * 200e3);
        assert_eq!(number(data(&deck, "*FRICTION")[0][1]), 20.0 * 200e3);
        assert!(data(&deck, "*STATIC").iter().all(|row| number(row[0]) == 0.05 && number(row[3]) == 0.05));
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
            ("opponent.equal=true", "opponent.radius"),
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

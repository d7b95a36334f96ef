//! All that an engine starts from: the tables of every pair of materials and of every wall, and an
//! input or a program that runs as it is.

use std::fmt::Write as _;

use super::engine::{TableFile, beyond_the_law, table_file};
use super::file::ExportedFile;
use crate::case::{Case, Friction, Opponent, Segment};
use crate::contact_law::export::{
    COHESION_NAME, FRAME_NAME, HEADER_NAME, TURNING_NAME, fill, header, header_3d, header_cohesion, header_frame, header_turning,
};
use crate::law::range::{OutOfRange, clamped};
use crate::law::{LawError, LawFile};

const INPUT: &str = include_str!("in.asperity");
const PROGRAM: &str = include_str!("main.c");

/// How many spheres the input pours.
const SPHERES: usize = 40;

/// An engine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Engine {
    /// LAMMPS with the plug-in: an input.
    Lammps,
    /// Any program in C: headers and a program.
    C,
}

/// What an engine starts from.
#[derive(Clone, Debug, PartialEq)]
pub struct Start {
    /// The files, the one to begin with first.
    pub files: Vec<ExportedFile>,
    /// By the names of tables, what of their deepest contacts the law was not made for.
    pub out_of_range: Vec<(String, Vec<OutOfRange>)>,
}

/// A table of the start.
struct StartTable {
    /// Its file.
    name: String,
    /// The materials, counted from 0; of a wall the one that touches it.
    first: usize,
    second: Option<usize>,
    /// The critical time step of a sphere with density 1, in the case's units.
    time_step: f64,
}

/// The files of the spheres of some cases, by their names: what their cases say of opponents and
/// paths is used for the depth alone, which is that of each sphere's own surface.
///
/// # Errors
/// A law of one contact alone; what a law says of a case.
pub fn start_files(law: &LawFile, engine: Engine, cases: &[(String, Case)]) -> Result<Start, LawError> {
    if !matches!(law, LawFile::Interpolated(_)) {
        return Err(LawError::NotCovered {
            problem: "an engine starts from tables of two spheres and of a wall, and this law is of one kind of contact alone",
            remedy: "Take `built-in`, or another law by interpolation; or export this one with --format",
        });
    }
    if cases.iter().any(|(_, case)| case.sphere.flat) {
        return Err(LawError::NotCovered {
            problem: "an engine has spheres, and the body of the case is a flat",
            remedy: "Leave sphere.flat out, and name the material of a wall with [opponent] in a case for --format",
        });
    }
    cases.iter().try_for_each(|(_, case)| clamped(case))?;
    let names = names(cases);
    let mut start = Start { files: Vec::new(), out_of_range: Vec::new() };
    let mut tables = Vec::new();
    let mut add = |name: String, first: usize, second: Option<usize>, case: &Case| -> Result<(), LawError> {
        let TableFile { content, time_step } = table_file(law, case)?;
        let beyond = beyond_the_law(law, case)?;
        if !beyond.is_empty() {
            start.out_of_range.push((name.clone(), beyond));
        }
        start.files.push(ExportedFile { name: name.clone(), content });
        let lightest = [first, second.unwrap_or(first)].map(|i| cases[i].1.sphere.radius).into_iter().fold(f64::MAX, f64::min);
        let mass = 4.0 / 3.0 * std::f64::consts::PI * lightest.powi(3);
        let scale = (mass / (case.material.youngs_modulus * case.sphere.radius)).sqrt();
        tables.push(StartTable { name, first, second, time_step: time_step * scale });
        Ok(())
    };
    for (i, (_, case)) in cases.iter().enumerate() {
        add(format!("{}.asperity", names[i]), i, Some(i), &contact(case, Some(Opponent::Equal), 2.0 * depth(case)))?;
        add(format!("{}-wall.asperity", names[i]), i, None, &contact(case, None, depth(case)))?;
        for (j, (_, other)) in cases.iter().enumerate().skip(i + 1) {
            let opponent = Opponent::Deforming { radius: Some(other.sphere.radius), material: other.material.clone() };
            let mut both = contact(case, Some(opponent), depth(case) + depth(other));
            both.contact.friction = mixed(case.contact.friction, other.contact.friction);
            add(format!("{}-{}.asperity", names[i], names[j]), i, Some(j), &both)?;
        }
    }
    let first = match engine {
        Engine::Lammps => vec![ExportedFile { name: "in.asperity".to_owned(), content: input(cases, &names, &tables) }],
        Engine::C => vec![
            ExportedFile { name: "main.c".to_owned(), content: program(cases, &names, &tables) },
            ExportedFile { name: HEADER_NAME.to_owned(), content: header() },
            ExportedFile { name: "asperity_contact3d.h".to_owned(), content: header_3d() },
            ExportedFile { name: TURNING_NAME.to_owned(), content: header_turning() },
            ExportedFile { name: COHESION_NAME.to_owned(), content: header_cohesion() },
            ExportedFile { name: FRAME_NAME.to_owned(), content: header_frame() },
        ],
    };
    start.files.splice(0..0, first);
    Ok(start)
}

/// How deep the surface of the sphere itself is pressed at the most.
fn depth(case: &Case) -> f64 {
    let all = case.deepest_press().map_or(0.0, |(_, h)| h);
    match case.opponent {
        Some(Opponent::Equal | Opponent::Deforming { radius: Some(_), .. }) => 0.5 * all,
        None | Some(Opponent::Rigid { .. } | Opponent::Deforming { radius: None, .. }) => all,
    }
}

/// The sphere of a case against something else.
fn contact(case: &Case, opponent: Option<Opponent>, indentation: f64) -> Case {
    Case { opponent, path: vec![Segment::Indentation { indentation }], ..case.clone() }
}

/// The friction between two materials: the geometric mean, as LAMMPS mixes it.
fn mixed(one: Friction, other: Friction) -> Friction {
    match (one, other) {
        (Friction::Coefficient(one), Friction::Coefficient(other)) if one != other => Friction::Coefficient((one * other).sqrt()),
        (Friction::Stick, _) => other,
        _ => one,
    }
}

/// Names of the materials that can be parts of the names of files; different ones.
fn names(cases: &[(String, Case)]) -> Vec<String> {
    let plain = |name: &str| name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect::<String>();
    let told = |name: &str| if name.chars().any(|c| c.is_ascii_alphanumeric()) { plain(name) } else { String::new() };
    let names: Vec<String> = cases.iter().map(|(name, _)| told(name)).collect();
    let different = names.iter().enumerate().all(|(i, name)| !name.is_empty() && name != "in" && !names[..i].contains(name));
    if different {
        return names;
    }
    names.iter().enumerate().map(|(i, name)| format!("{}{}", if name.is_empty() { "material" } else { name }, i + 1)).collect()
}

/// What is the same for all engines: a line for each material.
fn described(cases: &[(String, Case)], names: &[String], mark: &str) -> String {
    let line = |(i, (_, case)): (usize, &(String, Case))| {
        let mu = match case.contact.friction {
            Friction::Coefficient(mu) => mu,
            Friction::Stick => f64::NAN,
        };
        let (radius, modulus) = (case.sphere.radius, case.material.youngs_modulus);
        format!("{mark} {} {}: R = {radius:?}, E = {modulus:?}, mu = {mu:?}", i + 1, names[i])
    };
    cases.iter().enumerate().map(line).collect::<Vec<_>>().join("\n")
}

/// The input for LAMMPS.
fn input(cases: &[(String, Case)], names: &[String], tables: &[StartTable]) -> String {
    let count = cases.len();
    let largest = cases.iter().map(|(_, case)| case.sphere.radius).fold(0.0, f64::max);
    let [mut densities, mut coefficients, mut walls, mut pours, mut poured] = [const { String::new() }; 5];
    for (i, (_, case)) in cases.iter().enumerate() {
        let number = i + 1;
        // Writing to a String cannot fail.
        let _ = writeln!(densities, "variable density{number} index 1.0    # {}", names[i]);
        let _ = writeln!(poured, "unfix pour{number}");
        let _ = writeln!(
            pours,
            "region above{number} block 0 ${{side}} 0 ${{side}} $(v_R*{:?}) $(v_R*{:?})\n\
             fix pour{number} all pour {} {number} {} region above{number} vol 0.3 100 &\n  diam one {:?} \
             dens ${{density{number}}} ${{density{number}}}",
            2.0 + 18.0 * i as f64 / count as f64,
            2.0 + 18.0 * (i + 1) as f64 / count as f64,
            SPHERES.div_ceil(count),
            4711 + i,
            2.0 * case.sphere.radius
        );
    }
    let steps: Vec<String> = tables
        .iter()
        .map(|table| {
            let [one, two] = [table.first, table.second.unwrap_or(table.first)].map(|i| format!("v_density{}", i + 1));
            let lighter = if one == two { one } else { format!("ternary({one}<{two},{one},{two})") };
            format!("{:?}*sqrt({lighter})", 0.1 * table.time_step)
        })
        .collect();
    let mut step = String::new();
    for (k, formula) in steps.iter().enumerate() {
        let _ = writeln!(step, "variable step{k} equal {formula}");
        let least = if k == 0 { "${step0}".to_owned() } else { format!("$(ternary(v_step{k}<v_step,v_step{k},v_step))") };
        let _ = writeln!(step, "variable step{k} equal ${{step{k}}}\nvariable step equal {least}");
    }
    for table in tables {
        let modulus = cases[table.first].1.material.youngs_modulus;
        let first = table.first + 1;
        let _ = match table.second {
            Some(second) => writeln!(
                coefficients,
                "pair_coeff {first} {} {} {modulus:?} restitution ${{restitution}}",
                second + 1,
                table.name
            ),
            None => write!(walls, " &\n  type {first} {} {modulus:?} restitution ${{restitution}}", table.name),
        };
    }
    let first = &cases[0].1;
    fill(
        INPUT,
        [
            ("MATERIALS", described(cases, names, "#")),
            ("DENSITIES", densities.trim_end().to_owned()),
            ("TYPES", count.to_string()),
            ("RADIUS", format!("{largest:?}")),
            ("MODULUS", format!("{:?}", first.material.youngs_modulus)),
            ("STEPS", step.trim_end().to_owned()),
            ("COEFFICIENTS", coefficients.trim_end().to_owned()),
            ("WALLS", walls),
            ("POURS", pours.trim_end().to_owned()),
            ("POURED", poured.trim_end().to_owned()),
        ],
    )
}

/// The program in C.
fn program(cases: &[(String, Case)], names: &[String], tables: &[StartTable]) -> String {
    let materials: Vec<String> = cases
        .iter()
        .enumerate()
        .map(|(i, (_, case))| {
            format!("    {{\"{}\", {:?}, {:?}, 1.0}}", names[i], case.sphere.radius, case.material.youngs_modulus)
        })
        .collect();
    let contacts: Vec<String> = tables
        .iter()
        .map(|table| {
            let second = table.second.map_or_else(|| "WALL".to_owned(), |second| second.to_string());
            format!("    {{\"{}\", {}, {second}}}", table.name, table.first)
        })
        .collect();
    fill(
        PROGRAM,
        [("DESCRIBED", described(cases, names, " *")), ("MATERIALS", materials.join(",\n")), ("CONTACTS", contacts.join(",\n"))],
    )
}

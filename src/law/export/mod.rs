//! The law for other programs: C headers and a table for engines, a Python module with the
//! incremental contact update, and test vectors for both.
//!
//! What of them is the update comes from [`contact_law::export`](crate::contact_law::export). The
//! Python module has the constants of the law besides, and makes its tables itself. In C the update
//! is one header; it gets the tables of one material and one friction, or a second header of the
//! whole law makes them.

mod engine;
mod start;
mod vectors;

pub use engine::{beyond_the_law, engine_files, engine_source};
pub use start::{Engine, Start, start_files};
pub use vectors::{table_vectors, unit_vectors, vectors};

use super::formulas::contact_parameters::LAST;
use super::formulas::elastic::BODY;
use super::formulas::model::Law;
use super::formulas::shear::EXPONENT_SPAN;
use super::table::Tabulated;
use super::{LawError, LawFile};
use crate::case::{Case, Hardening};
use crate::contact_law::export::{HEADER_NAME, check_program, fill, header, header_3d, header_parts, module_parts};
use crate::contact_law::{ContactParameters, POINTS};
use crate::material::HardeningLaw;

const HEADER: &str = include_str!("asperity_law.h");
const MODULE: &str = include_str!("asperity_law.py");
const FORMULAS_MODULE: &str = include_str!("asperity_law_formulas.py");
const TABLE_MODULE: &str = include_str!("asperity_law_table.py");

/// A language of the export.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Language {
    /// Headers and a table, C99, C++17 and CUDA.
    C,
    /// One module, Python 3.8 or later.
    Python,
}

/// A file of an export.
#[derive(Clone, Debug, PartialEq)]
pub struct ExportedFile {
    /// Its name.
    pub name: String,
    /// Its content.
    pub content: String,
}

/// The files of the Python export, the law itself first: then the test vectors; the module checks
/// itself.
pub fn files(law: &Law) -> Vec<ExportedFile> {
    python_files(source(law, Language::Python), vectors(law, vectors::SEED))
}

/// The files of either kind of law. For C a law of formulas gives the headers and the table of a
/// case's material and friction; without a case, one header for all materials that makes its tables
/// itself.
///
/// # Errors
/// A table without numbers; what [`engine_files`] has.
pub fn law_files(law: &LawFile, language: Language, case: Option<&Case>) -> Result<Vec<ExportedFile>, LawError> {
    match (language, law) {
        (Language::C, LawFile::Formulas(law)) if case.is_none() => return Ok(header_files(law)),
        (Language::C, law) => return engine_files(law, case),
        (Language::Python, _) => {}
    }
    match law.of_case(case)?.as_ref() {
        LawFile::Formulas(law) => Ok(files(law)),
        LawFile::Interpolated(_) => Err(LawFile::without_a_case()),
        LawFile::Table(table) => Ok(python_files(table_source(table)?, table_vectors(table, vectors::SEED)?)),
    }
}

/// Either kind of law as source of a language: for C the table, which includes the update's header.
///
/// # Errors
/// As [`law_files`].
pub fn law_source(law: &LawFile, language: Language, case: Option<&Case>) -> Result<String, LawError> {
    match (language, law) {
        (Language::C, LawFile::Formulas(law)) if case.is_none() => return Ok(in_one_file(&source(law, Language::C))),
        (Language::C, law) => return Ok(in_one_file(&engine_source(law, case)?)),
        (Language::Python, _) => {}
    }
    match law.of_case(case)?.as_ref() {
        LawFile::Formulas(law) => Ok(source(law, Language::Python)),
        LawFile::Interpolated(_) => Err(LawFile::without_a_case()),
        LawFile::Table(table) => table_source(table),
    }
}

/// A header with the update in place of the line that includes it.
fn in_one_file(text: &str) -> String {
    text.replacen(&format!("#include \"{HEADER_NAME}\"\n"), &header(), 1)
}

/// The header for all materials, the update that it includes, test vectors, and the program that
/// checks them.
fn header_files(law: &Law) -> Vec<ExportedFile> {
    vec![
        ExportedFile { name: "asperity_law.h".to_owned(), content: source(law, Language::C) },
        ExportedFile { name: HEADER_NAME.to_owned(), content: header() },
        ExportedFile { name: "asperity_contact3d.h".to_owned(), content: header_3d() },
        ExportedFile { name: "asperity_law_vectors.csv".to_owned(), content: vectors(law, vectors::SEED) },
        ExportedFile { name: "asperity_law_check.c".to_owned(), content: check_program("asperity_law_check.c") },
    ]
}

fn python_files(source: String, vectors: String) -> Vec<ExportedFile> {
    vec![
        ExportedFile { name: "asperity_law.py".to_owned(), content: source },
        ExportedFile { name: "asperity_law_vectors.csv".to_owned(), content: vectors },
    ]
}

/// The law for all materials as source of a language.
pub fn source(law: &Law, language: Language) -> String {
    let number = |x: f64| format!("{x:.16e}");
    let mut constants = String::new();
    let mut constant = |name: &str, value: f64| {
        constants.push_str(&match language {
            Language::C => format!("#define ASPERITY_{name} {}\n", number(value)),
            Language::Python => format!("{name} = {}\n", number(value)),
        });
    };
    let mut list = |name: &str, values: &[f64]| {
        for (i, value) in values.iter().enumerate() {
            constant(&format!("{name}_{i}"), *value);
        }
    };
    list("FALL", &law.constants.fall);
    list("EXPONENT", &law.constants.exponent);
    list("SLIP", &law.constants.slip);
    list("CURVE", &law.constants.curve);
    list("NORMAL_RADIUS", &law.normal.radius);
    list("NORMAL_FORCE", &law.normal.force);
    list("BODY", &BODY);
    constant("EXPONENT_SPAN", EXPONENT_SPAN);
    let range = &law.validity;
    for (name, interval) in [
        ("LAMBDA", range.lambda),
        ("FRICTION", range.friction),
        ("RADIUS", range.relative_radius),
        ("AREA", range.c_squared),
        ("NU", range.poissons_ratio),
        ("HARDENING", range.hardening_exponent),
    ] {
        constant(&format!("{name}_FROM"), interval.from);
        constant(&format!("{name}_TO"), interval.to);
    }
    let short = |x: f64| format!("{x:.4}").trim_end_matches('0').trim_end_matches('.').to_owned();
    let values = [
        ("VERSION", env!("CARGO_PKG_VERSION").to_owned()),
        ("SOURCE", format!("the law of study {} ({} cases)", plain(&law.provenance.study), law.provenance.cases)),
        (
            "FITTED",
            format!(
                "Fitted for Lambda {} to {}, mu {} to {}, a/R {} to {}, nu {} to {}",
                short(range.lambda.from),
                short(range.lambda.to),
                short(range.friction.from),
                short(range.friction.to),
                short(range.relative_radius.from),
                short(range.relative_radius.to),
                short(range.poissons_ratio.from),
                short(range.poissons_ratio.to)
            ),
        ),
        ("SETUP", FORMULAS_MODULE.to_owned()),
        ("NORMAL_CURVE", "1".to_owned()),
        ("CONSTANTS", constants.trim_end().to_owned()),
        ("LAST", format!("{LAST:?}")),
        ("HARDENING_CODES", hardening_codes(language)),
    ];
    match language {
        Language::C => fill(HEADER, values.into_iter().chain(header_parts())),
        Language::Python => fill(MODULE, values.into_iter().chain(module_parts())),
    }
}

/// A table as a Python module.
fn table_source(table: &Tabulated) -> Result<String, LawError> {
    let ContactParameters { radius, effective_modulus, friction, log_first, log_step, table: rows, shapes, .. } =
        table.unit_parameters()?;
    let material = table.material()?;
    let number = |x: f64| format!("{x:.16e}");
    let list = |values: &[f64]| values.iter().map(|&x| number(x)).collect::<Vec<_>>().join(", ");
    let lines = |all: &mut dyn Iterator<Item = String>| all.map(|line| format!("    {line},\n")).collect::<String>();
    let shape_lines = |shape: &[[f64; POINTS]; 2]| {
        let [t, n] = shape.map(|values| format!("({})", list(&values)));
        format!("({t}, {n})")
    };
    let (kind, numbers, stresses) = hardening_numbers(&material.hardening);
    let points: Vec<f64> = match &material.hardening {
        Hardening::Table { points } => points.iter().flatten().copied().collect(),
        _ => Vec::new(),
    };
    let words = ["False", "True"];
    let point_list: String = points.iter().map(|&x| format!("{}, ", number(x))).collect();
    let fragment = fill(
        TABLE_MODULE,
        [
            ("NU", number(material.poissons_ratio)),
            ("FRICTION", number(friction)),
            ("MODULUS", number(effective_modulus)),
            ("RADIUS", number(radius)),
            ("LOG_FIRST", number(log_first)),
            ("LOG_STEP", number(log_step)),
            ("DEEPEST", number(table.range.to)),
            ("HARDENING", kind.to_string()),
            ("PAIRS", (points.len() / 2).to_string()),
            ("NUMBERS", list(&numbers)),
            ("STRESSES", stresses.map(|stress| words[usize::from(stress)]).join(", ")),
            ("POINT_LIST", point_list.trim_end().to_owned()),
            ("ROWS", lines(&mut rows.iter().map(|row| format!("({})", list(row))))),
            ("SHAPES", lines(&mut shapes.iter().map(shape_lines))),
        ],
    );
    let short = |x: f64| format!("{x:.4}").trim_end_matches('0').trim_end_matches('.').to_owned();
    let what = format!("one material (nu = {}), mu = {}, on {}", short(material.poissons_ratio), short(friction), table.body);
    let values = [
        ("VERSION", env!("CARGO_PKG_VERSION").to_owned()),
        ("SOURCE", format!("a table of {what}")),
        ("FITTED", format!("Of {what}, h/R up to {}", short(table.range.to))),
        ("SETUP", fragment),
        ("NORMAL_CURVE", "2".to_owned()),
        ("HARDENING_CODES", hardening_codes(Language::Python)),
    ];
    Ok(fill(MODULE, values.into_iter().chain(module_parts())))
}

/// The code of a hardening law, its numbers in the exports, and which of them are stresses.
fn hardening_numbers(hardening: &Hardening) -> (u8, [f64; 3], [bool; 3]) {
    let (law, numbers) = (hardening.kind(), hardening.numbers());
    let parameters = law.parameters();
    (
        law.code(),
        std::array::from_fn(|i| numbers.get(i).copied().unwrap_or(0.0)),
        std::array::from_fn(|i| parameters.get(i).is_some_and(|parameter| parameter.is_stress)),
    )
}

/// The codes of the hardening laws by their names, a line each, with their numbers in a comment.
fn hardening_codes(language: Language) -> String {
    let lines = HardeningLaw::ALL.map(|law| {
        let names: Vec<String> = law.parameters().iter().map(|parameter| parameter.key.replace('_', " ")).collect();
        let about = match law {
            HardeningLaw::Table => "none; pairs of plastic strain and stress in `points`".to_owned(),
            _ if law.formula().is_empty() => names.join(", "),
            _ => format!("{}: {}", names.join(", "), law.formula()),
        };
        let code = format!("{} = {}", law.word().to_uppercase(), law.code());
        match language {
            Language::C => {
                let comma = if law == HardeningLaw::Table { "" } else { "," };
                let comment = if about.is_empty() { about } else { format!("/* {about} */") };
                format!("    {:<22} {comment}", format!("ASPERITY_{code}{comma}"))
            }
            Language::Python if about.is_empty() => code,
            Language::Python => format!("{code}  # {}", about.replace('`', "")),
        }
    });
    lines.map(|line| line.trim_end().to_owned()).join("\n")
}

/// A name that can stand in a comment of any language.
fn plain(name: &str) -> String {
    name.chars().map(|c| if c.is_ascii_alphanumeric() || "-_. ".contains(c) { c } else { '_' }).collect()
}

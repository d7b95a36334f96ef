//! The law for other programs: a C header and a Python module with the incremental contact update, and test vectors for both.
//!
//! Header, module and [`ContactParameters`](super::contact::ContactParameters) are triplets: the same functions in the same order with the same operations. Only the
//! constants of the law are filled in here.

mod vectors;

pub use vectors::vectors;

use super::contact::{COLUMNS, KNOTS, SLIDERS};
use super::forms::{EXPONENT_SPAN, NormalCurve, SlipForm, Variable};
use super::model::Law;
use super::normal::NormalForm;

const HEADER: &str = include_str!("asperity_law.h");
const MODULE: &str = include_str!("asperity_law.py");
const CHECK: &str = include_str!("asperity_law_check.c");

/// A language of the export.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Language {
    /// One header, C99 and C++17.
    C,
    /// One module, Python 3.8 or later.
    Python,
}

/// A file of an export.
#[derive(Clone, Debug, PartialEq)]
pub struct ExportedFile {
    /// Its name.
    pub name: &'static str,
    /// Its content.
    pub content: String,
}

/// The files of an export, the law itself first: then the test vectors and, for C, the program that checks them (the Python module checks
/// itself).
pub fn files(law: &Law, language: Language) -> Vec<ExportedFile> {
    let vectors = ExportedFile { name: "asperity_law_vectors.csv", content: vectors(law, vectors::SEED) };
    match language {
        Language::C => {
            let check = ExportedFile { name: "asperity_law_check.c", content: CHECK.to_owned() };
            vec![ExportedFile { name: "asperity_law.h", content: source(law, language) }, vectors, check]
        }
        Language::Python => vec![ExportedFile { name: "asperity_law.py", content: source(law, language) }, vectors],
    }
}

/// The law as source of a language.
pub fn source(law: &Law, language: Language) -> String {
    let number = |x: f64| format!("{x:.16e}");
    let mut constants = String::new();
    let mut constant = |name: &str, value: f64| {
        constants.push_str(&match language {
            Language::C => format!("#define ASPERITY_{name} {}\n", number(value)),
            Language::Python => format!("{name} = {}\n", number(value)),
        });
    };
    let mut list = |name: &str, values: &[f64], length: usize| {
        for i in 0..length {
            constant(&format!("{name}_{i}"), values.get(i).copied().unwrap_or(0.0));
        }
    };
    list("FALL", &law.constants.fall, 6);
    list("EXPONENT", &law.constants.exponent, 6);
    list("SLIP", &law.constants.slip, 4);
    list("CURVE", &law.constants.curve, 4);
    list("NORMAL_RADIUS", &law.normal.radius, 4);
    list("NORMAL_FORCE", &law.normal.force, 6);
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
        ("STUDY", plain(&law.provenance.study)),
        ("CASES", law.provenance.cases.to_string()),
        ("LAMBDA_FROM", short(range.lambda.from)),
        ("LAMBDA_TO", short(range.lambda.to)),
        ("FRICTION_FROM", short(range.friction.from)),
        ("FRICTION_TO", short(range.friction.to)),
        ("RADIUS_FROM", short(range.relative_radius.from)),
        ("RADIUS_TO", short(range.relative_radius.to)),
        ("NU_FROM", short(range.poissons_ratio.from)),
        ("NU_TO", short(range.poissons_ratio.to)),
        ("VARIABLE", variable(law.forms.variable).to_string()),
        ("SLIP_FORM", slip_form(law.forms.slip_displacement).to_string()),
        ("NORMAL_CURVE", normal_curve(law.forms.normal_curve).to_string()),
        ("NORMAL_FORM", normal_form(law.normal.form).to_string()),
        ("KNOTS", KNOTS.to_string()),
        ("COLUMNS", COLUMNS.to_string()),
        ("SLIDERS", SLIDERS.to_string()),
        ("CONSTANTS", constants.trim_end().to_owned()),
    ];
    let template = match language {
        Language::C => HEADER,
        Language::Python => MODULE,
    };
    values.iter().fold(template.to_owned(), |text, (name, value)| text.replace(&format!("@{name}@"), value))
}

/// A name that can stand in a comment of any language.
fn plain(name: &str) -> String {
    name.chars().map(|c| if c.is_ascii_alphanumeric() || "-_. ".contains(c) { c } else { '_' }).collect()
}

fn variable(variable: Variable) -> u8 {
    match variable {
        Variable::Lambda => 0,
        Variable::FrictionLambda => 1,
        Variable::Stiffness => 2,
        Variable::Area => 3,
    }
}

fn slip_form(form: SlipForm) -> u8 {
    match form {
        SlipForm::Direct => 0,
        SlipForm::ThroughStiffness => 1,
    }
}

fn normal_curve(curve: NormalCurve) -> u8 {
    match curve {
        NormalCurve::PowerOfComplement => 0,
        NormalCurve::ComplementOfPower => 1,
    }
}

fn normal_form(form: NormalForm) -> u8 {
    match form {
        NormalForm::Published => 0,
        NormalForm::Corrected => 1,
        NormalForm::Smooth => 2,
    }
}

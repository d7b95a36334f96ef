//! The law of one material and one friction for engines: a table, as a C constant and as a file
//! that is read when an engine starts, beside the update that uses it.

use std::fmt::Write as _;

use super::vectors::{SEED, unit_vectors};
use super::{ExportedFile, fill, plain, sizes};
use crate::case::Case;
use crate::law::contact::{COLUMNS, ContactParameters, KNOTS};
use crate::law::tabulated::{Against, is_on_a_flat};
use crate::law::{LawError, LawFile};

const CONTACT: &str = include_str!("asperity_contact.h");
pub(super) const CONTACT_3D: &str = include_str!("asperity_contact3d.h");
const CHECK: &str = include_str!("asperity_contact_check.c");

/// Version of the table's file.
const VERSION: u32 = 3;

/// Columns of the parameters' table in the order of the header's.
const ORDER: [usize; COLUMNS] = [0, 1, 3, 7, 2, 4, 5, 6];

/// What an engine gets.
struct Unit {
    /// The update's parameters of a sphere with R = 1 and E = 1.
    parameters: ContactParameters,
    /// Its case, in those units.
    case: Case,
    /// What the sphere is pressed against.
    body: Against,
    /// h/R up to which the law was made; 0 where nothing of this material is within its range.
    deepest: f64,
    /// What it is, in words.
    source: String,
}

impl Unit {
    /// Of a law, for the material and the friction of `case`; a table needs no case.
    fn new(law: &LawFile, case: Option<&Case>) -> Result<Self, LawError> {
        if let (Some(case), LawFile::Table(table)) = (case, law) {
            table.covers(case)?;
        }
        match (law, case) {
            (LawFile::Table(table), _) => {
                let case = table.deepest_case()?;
                let nu = case.material.poissons_ratio;
                Ok(Self {
                    parameters: table.unit_parameters()?,
                    body: table.body,
                    deepest: table.range.to,
                    source: format!("a table of one material (nu = {nu}), mu = {}, on: {}", table.friction(), table.body),
                    case,
                })
            }
            (LawFile::Formulas(formulas), Some(case)) => {
                // Refuses what the law does not cover before the numbers lose their units.
                law.contact_parameters(case)?;
                let unit = case.scaled().0;
                let parameters = law.contact_parameters(&unit)?;
                let mut deepest: f64 = 0.0;
                for i in 0..KNOTS {
                    let h = (parameters.log_first + parameters.log_step * i as f64).exp();
                    if law.out_of_range(&unit, h)?.is_empty() {
                        deepest = deepest.max(h);
                    }
                }
                Ok(Self {
                    deepest,
                    source: format!(
                        "the law of study {} for one material (nu = {}), mu = {}",
                        plain(&formulas.provenance.study),
                        unit.material.poissons_ratio,
                        parameters.friction
                    ),
                    parameters,
                    case: unit,
                    body: Against::Plane,
                })
            }
            (LawFile::Interpolated(law), Some(case)) => Self::new(&LawFile::Table(Box::new(law.table(case)?)), Some(case)),
            (LawFile::Interpolated(_), None) => Err(LawFile::without_a_case()),
            (LawFile::Formulas(_), None) => Err(LawError::NotCovered {
                problem: "an engine takes the law of one material and one friction, and this one is of all",
                remedy: "name a case after it: asperity law export LAW.json CASE.toml --format c",
            }),
        }
    }

    /// Whether it is of a sphere on a flat: of a wall.
    fn plane(&self) -> bool {
        is_on_a_flat(&self.case)
    }

    /// What it is of: "plane" of a sphere on any flat, which is what an engine must know.
    fn kind(&self) -> &'static str {
        if self.plane() { Against::Plane.word() } else { self.body.word() }
    }

    /// What h and the tangential displacement are of what the two centres move: all of it, whatever
    /// the sphere meets.
    fn share(&self) -> f64 {
        1.0
    }

    /// The cubics from knot to knot as the update reads them: coefficients of 1, u, u^2, u^3 of all
    /// columns, the logarithms first. Of those the first coefficient is the quantity itself, and of
    /// a and delta_T_slip all are of the inverse.
    fn knots(&self) -> Vec<[Vec<f64>; 4]> {
        let parameters = &self.parameters;
        let cubic = |i: usize, column: usize| {
            let (value, slope) = (parameters.table[i][column], parameters.knot_slope(column, i));
            let [square, cube] = if i + 1 < KNOTS {
                let (rise, next) = (parameters.table[i + 1][column] - value, parameters.knot_slope(column, i + 1));
                [3.0 * rise - 2.0 * slope - next, slope + next - 2.0 * rise]
            } else {
                [0.0, 0.0]
            };
            let sign = if column == 1 || column == 3 { -1.0 } else { 1.0 };
            let start = if ORDER[..4].contains(&column) { (sign * value).exp() } else { value };
            [start, sign * slope, sign * square, sign * cube]
        };
        (0..KNOTS).map(|i| [0, 1, 2, 3].map(|power| ORDER.iter().map(|&column| cubic(i, column)[power]).collect())).collect()
    }

    /// The single numbers by the names that they have in the file.
    fn numbers(&self) -> [(&'static str, f64); 10] {
        let p = &self.parameters;
        [
            ("share", self.share()),
            ("poissons_ratio", self.case.material.poissons_ratio),
            ("friction", p.friction),
            ("effective_modulus", p.effective_modulus),
            ("effective_radius", p.radius),
            ("deepest", self.deepest),
            ("form", p.form),
            ("first", p.log_first.exp()),
            ("log_step", p.log_step),
            ("gentle", p.gentle),
        ]
    }

    /// As a file that `asperity_read_table` reads.
    fn file(&self) -> String {
        let mut text = format!("asperity-contact-table {VERSION}\nbody {}\n", self.kind());
        // Writing to a String cannot fail.
        for (name, value) in self.numbers() {
            let _ = writeln!(text, "{name} {value:?}");
        }
        let row = |values: &[f64]| values.iter().map(|x| format!("{x:?}")).collect::<Vec<_>>().join(" ") + "\n";
        text.push_str("knots\n");
        self.knots().iter().flatten().for_each(|values| text.push_str(&row(values)));
        text.push_str("shapes\n");
        self.parameters.shapes.iter().flatten().for_each(|values| text.push_str(&row(values)));
        text.push_str("end\n");
        text
    }

    /// As a C constant.
    fn header(&self) -> String {
        let number = |x: f64| format!("ASPERITY_R({x:?})");
        let row = |values: &[f64]| format!("{{{}}}", values.iter().map(|&x| number(x)).collect::<Vec<_>>().join(", "));
        let numbers = self.numbers().map(|(_, value)| number(value));
        let [share, nu, friction, modulus, curvature, deepest, _, first, log_step, gentle] = numbers;
        let mut text = format!(
            "/* asperity_law.h: {}, h/R up to {}. Written by asperity {}. */\n#ifndef ASPERITY_LAW_H\n#define ASPERITY_LAW_H\n\n\
             #include \"asperity_contact.h\"\n\nstatic const asperity_table asperity_law = {{\n    {}, {}, {share}, {nu}, {friction}, {modulus}, {curvature}, \
             {deepest}, {first}, {log_step}, {gentle},\n    {{\n",
            self.source,
            self.deepest,
            env!("CARGO_PKG_VERSION"),
            u8::from(self.plane()),
            self.parameters.form,
        );
        for cubics in self.knots() {
            let _ = writeln!(text, "        {{{}}},", cubics.map(|values| row(&values)).join(", "));
        }
        text.push_str("    },\n    {\n");
        for [tangential, normal] in &self.parameters.shapes {
            let _ = writeln!(text, "        {{{}, {}}},", row(tangential), row(normal));
        }
        text.push_str("    }};\n\n#endif\n");
        text
    }
}

/// The update, which is the same for every law.
pub fn contact_header() -> String {
    fill(CONTACT, [("VERSION", env!("CARGO_PKG_VERSION").to_owned())].into_iter().chain(sizes()))
}

/// The program that compares a C export with the test vectors, under a name.
pub(super) fn check_program(name: &str) -> String {
    fill(CHECK, [("NAME", name.to_owned())])
}

/// The law as a C constant. A law of formulas needs the case of a material and a friction.
///
/// # Errors
/// The law says nothing of the case; no case; a table of another material.
pub fn engine_source(law: &LawFile, case: Option<&Case>) -> Result<String, LawError> {
    Ok(Unit::new(law, case)?.header())
}

/// All files for engines: the law as a constant and as a file, the update, its use in three
/// dimensions, test vectors, and the program that checks them.
///
/// # Errors
/// As [`engine_source`].
pub fn engine_files(law: &LawFile, case: Option<&Case>) -> Result<Vec<ExportedFile>, LawError> {
    let unit = Unit::new(law, case)?;
    let vectors = unit_vectors(&unit.parameters, &unit.case.material, unit.deepest.max(1e-3), SEED);
    Ok([
        ("asperity_law.h", unit.header()),
        ("law.asperity", unit.file()),
        ("asperity_contact.h", contact_header()),
        ("asperity_contact3d.h", CONTACT_3D.to_owned()),
        ("asperity_law_vectors.csv", vectors),
        ("asperity_contact_check.c", check_program("asperity_contact_check.c")),
    ]
    .map(|(name, content)| ExportedFile { name, content })
    .into())
}

//! The law of one material and one friction for engines, beside the update that uses it.

use super::file::{ExportedFile, plain};
use super::vectors::{SEED, unit_vectors};
use crate::case::Case;
use crate::contact_law::SLIDERS;
use crate::contact_law::export::{
    COHESION_NAME, EngineTable, FRAME_NAME, HEADER_NAME, TURNING_NAME, check_program, fill, header, header_3d, header_cohesion,
    header_frame, header_turning,
};
use crate::law::range::OutOfRange;
use crate::law::table::{Against, is_on_a_flat};
use crate::law::{LawError, LawFile};

const MODULE: &str = include_str!("asperity_law.py");

/// What an engine gets.
struct EngineUnits {
    /// The table of a sphere with R = 1 and E = 1.
    table: EngineTable,
    /// Its case, in those units.
    case: Case,
}

impl EngineUnits {
    /// Of a law, for the material and the friction of `case`; a table needs no case.
    fn new(law: &LawFile, case: Option<&Case>) -> Result<Self, LawError> {
        if let (Some(case), LawFile::Table(table)) = (case, law) {
            table.covers(case)?;
        }
        let warnings = case.map_or_else(|| Ok(Vec::new()), |case| beyond_the_law(law, case))?;
        let warnings: Vec<String> = warnings.iter().map(ToString::to_string).collect();
        let (parameters, deepest, source, case, against) = match (law, case) {
            (LawFile::Table(table), _) => {
                let case = table.deepest_case()?;
                let nu = case.material.poissons_ratio;
                let source = format!("a table of one material (nu = {nu}), mu = {}, on: {}", table.friction(), table.body);
                (table.unit_parameters()?, table.range.to, source, case, table.body)
            }
            (LawFile::Formulas(formulas), Some(case)) => {
                // Refuses what the law does not cover before the numbers lose their units.
                law.contact_parameters(case)?;
                let unit = case.scaled().0;
                let parameters = law.contact_parameters(&unit)?;
                let mut deepest: f64 = 0.0;
                for h in parameters.first_loading().knots() {
                    if law.out_of_range(&unit, h)?.is_empty() {
                        deepest = deepest.max(h);
                    }
                }
                let source = format!(
                    "the law of study {} for one material (nu = {}), mu = {}",
                    plain(&formulas.provenance.study),
                    unit.material.poissons_ratio,
                    parameters.friction
                );
                (parameters, deepest, source, unit, Against::Plane)
            }
            (LawFile::Interpolated(law), Some(case)) => {
                let mut unit = Self::new(&LawFile::Table(Box::new(law.compose(case)?)), Some(case))?;
                unit.table.warnings = warnings;
                return Ok(unit);
            }
            (LawFile::Interpolated(_), None) => return Err(LawFile::without_a_case()),
            (LawFile::Formulas(_), None) => {
                return Err(LawError::NotCovered {
                    problem: "an export is the law of one material and one friction, and this one is of all",
                    remedy: "Name a case after it: asperity law export LAW.json CASE.toml --format c",
                });
            }
        };
        let plane = is_on_a_flat(&case);
        let body = if plane { Against::Plane.word() } else { against.word() };
        let poissons_ratio = case.material.poissons_ratio;
        Ok(Self { table: EngineTable { parameters, poissons_ratio, body, plane, deepest, source, warnings }, case })
    }

    /// 2 sqrt(m/k) of a contact at its deepest over sqrt(m/(E R)), m being the mass of the sphere
    /// and the other body immovable: as `asperity_time_step` has it.
    fn time_step(&self) -> f64 {
        let virgin = self.table.parameters.virgin(self.table.deepest.max(1e-3));
        let normal = (virgin.gamma * virgin.point.f_n0 / virgin.depth).max(virgin.slope);
        2.0 / normal.max(3.5 * virgin.point.k_t).sqrt()
    }
}

/// A table for an engine, as a file.
pub(super) struct TableFile {
    /// What [`asperity_read_table`](super) reads.
    pub(super) content: String,
    /// The critical time step over sqrt(m/(E R)).
    pub(super) time_step: f64,
}

/// The table of the contact of a case.
pub(super) fn table_file(law: &LawFile, case: &Case) -> Result<TableFile, LawError> {
    let unit = EngineUnits::new(law, Some(case))?;
    Ok(TableFile { content: unit.table.file(), time_step: unit.time_step() })
}

/// What of the deepest contact of a case lies outside of what a law was made for.
///
/// # Errors
/// The hardening law of the case.
pub fn beyond_the_law(law: &LawFile, case: &Case) -> Result<Vec<OutOfRange>, LawError> {
    case.deepest_press().map_or_else(|| Ok(Vec::new()), |(_, h)| law.out_of_range(case, h))
}

/// The law as a C constant. A law of formulas needs the case of a material and a friction.
///
/// # Errors
/// The law says nothing of the case; no case; a table of another material.
pub fn engine_source(law: &LawFile, case: Option<&Case>) -> Result<String, LawError> {
    Ok(EngineUnits::new(law, case)?.table.header())
}

/// All files for Python: the module, which has the update and its table within, and test vectors.
///
/// # Errors
/// As [`engine_source`].
pub(super) fn python_files(law: &LawFile, case: Option<&Case>) -> Result<Vec<ExportedFile>, LawError> {
    let EngineUnits { table, case } = EngineUnits::new(law, case)?;
    let values = [
        ("SOURCE", table.source.clone()),
        ("DEEPEST", table.deepest.to_string()),
        ("VERSION", env!("CARGO_PKG_VERSION").to_owned()),
        ("SLIDERS", SLIDERS.to_string()),
        ("HEADER", header()),
        ("TABLE", table.file()),
    ];
    let vectors = unit_vectors(&table.parameters, &case.material, table.deepest.max(1e-3), SEED);
    Ok([("asperity_law.py", fill(MODULE, values)), ("asperity_law_vectors.csv", vectors)]
        .map(|(name, content)| ExportedFile { name: name.to_owned(), content })
        .into())
}

/// All files for engines: the law as a constant and as a file, the update, its use in three
/// dimensions, test vectors, and the program that checks them.
///
/// # Errors
/// As [`engine_source`].
pub fn engine_files(law: &LawFile, case: Option<&Case>) -> Result<Vec<ExportedFile>, LawError> {
    let EngineUnits { table, case } = EngineUnits::new(law, case)?;
    let vectors = unit_vectors(&table.parameters, &case.material, table.deepest.max(1e-3), SEED);
    Ok([
        ("asperity_law.h", table.header()),
        ("law.asperity", table.file()),
        (HEADER_NAME, header()),
        ("asperity_contact3d.h", header_3d()),
        (TURNING_NAME, header_turning()),
        (COHESION_NAME, header_cohesion()),
        (FRAME_NAME, header_frame()),
        ("asperity_law_vectors.csv", vectors),
        ("asperity_contact_check.c", check_program("asperity_contact_check.c")),
    ]
    .map(|(name, content)| ExportedFile { name: name.to_owned(), content })
    .into())
}

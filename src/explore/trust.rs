//! Where a law comes from, and how far it can be trusted for one contact.

use crate::case::Case;
use crate::law::interpolated::Source;
use crate::law::report::{RegionError, region};
use crate::law::table::Against;
use crate::law::{LawError, LawFile};

/// What is known of a law's errors near a contact: shares, root mean square and greatest, of
/// contacts that it was not made from.
#[derive(Clone, Debug, PartialEq)]
pub struct Trust {
    /// Where the law comes from.
    pub source: String,
    /// Of F_N0.
    pub press: [f64; 2],
    /// Of F_T along a shear at constant h, over its peak.
    pub tangential: [f64; 2],
    /// Of F_N along it, over F_N0.
    pub normal: [f64; 2],
    /// Of which contacts these are the errors.
    pub over: String,
    /// Whether they are known: of a table that was put together none are.
    pub is_known: bool,
}

impl Trust {
    /// Of a contact of a case: its Lambda and that of first yield, and mu.
    ///
    /// # Errors
    /// None that a law has which was read; the name of the table.
    pub fn of(law: &LawFile, case: &Case, [lambda, first]: [f64; 2], mu: f64) -> Result<Self, LawError> {
        let wanted = region(lambda, first, mu);
        match law {
            LawFile::Interpolated(law) => {
                let body = Against::of(case);
                let own = law.of_equal_spheres(case).unwrap_or(law);
                let Source { cases, materials, .. } = &own.source;
                let mut source =
                    format!("interpolated between {cases} simulated contacts of {materials} materials with {}", own.body);
                let (row, mut over) = near(&own.errors, &wanted);
                if own.body != body {
                    source += ", of each body by itself, and the two put in series";
                    over += ", without what putting in series adds (docs/law-errors.md has pairs)";
                }
                // All pairs are pressed by the law of equal spheres.
                let pressed = law.pair.as_deref().filter(|_| case.opponent.is_some()).unwrap_or(own);
                Ok(Self { source, press: pressed.normal_errors.f_n0, over, ..Self::from_row(row) })
            }
            LawFile::Formulas(law) => {
                let p = &law.provenance;
                let source = format!("formulas, fitted to {} simulated cases of {} materials", p.cases, p.materials);
                let (row, over) = near(&law.errors_predicted, &wanted);
                let kept = law.normal_candidates.iter().find(|candidate| candidate.kept);
                let press = kept.map_or([0.0; 2], |kept| [kept.f_n_rms, kept.f_n_max]);
                Ok(Self { source, press, over, ..Self::from_row(row) })
            }
            LawFile::Table(table) => {
                let mut of = [[0.0_f64; 2]; 3];
                for one in &table.errors {
                    for (kind, [rms, most]) in
                        [[one.f_n0.abs(); 2], [one.f_t_rms, one.f_t_max], [one.f_n_rms, one.f_n_max]].into_iter().enumerate()
                    {
                        of[kind] = [of[kind][0].max(rms), of[kind][1].max(most)];
                    }
                }
                let [press, tangential, normal] = of;
                Ok(Self {
                    source: format!("table of {} depths of this one contact", table.levels.len()),
                    press,
                    tangential,
                    normal,
                    is_known: !table.errors.is_empty(),
                    over: format!("{} depths between those of a table of every other one", table.errors.len()),
                })
            }
        }
    }

    fn from_row(row: Option<&RegionError>) -> Self {
        let errors = row.map(|row| row.errors).unwrap_or_default();
        Self {
            source: String::new(),
            press: [0.0; 2],
            tangential: [errors.f_t_rms, errors.f_t_max],
            normal: [errors.f_n_rms, errors.f_n_max],
            over: String::new(),
            is_known: errors.cases > 0,
        }
    }
}

/// The row of a region, or that of all where there is none; and which it is, in words.
fn near<'a>(rows: &'a [RegionError], wanted: &str) -> (Option<&'a RegionError>, String) {
    let row = rows.iter().find(|row| row.region == wanted).or_else(|| rows.iter().find(|row| row.region == "all"));
    let words = row.map_or_else(String::new, |row| {
        let region = if row.region == "all" { "all regions" } else { &row.region };
        format!("{} contacts of unseen materials ({region})", row.errors.cases)
    });
    (row, words)
}

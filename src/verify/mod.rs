//! Closed-form checks of the whole program: what `asperity verify` runs.
//!
//! Stands beside `study`: above `simulation`, whose cases it runs, and below `cli`, which prints
//! what it finds. `runner` follows a case, `check` is a row of the table, `table` and `report` put
//! them out, `equator` measures what the body between contact and plate adds to the displacements;
//! each other file is a family of checks.
//!
//! A tolerance comes from the range in which the closed form holds and from the known error of the
//! mesh, and says so in a line beside it (`because`; `asperity verify -v` prints them). What no
//! closed form decides is a row without a tolerance.
//!
//! | family | held against | tolerance |
//! |---|---|---|
//! | `hertz` | Hertz, F_N and a at h = 1e-4 R; the exact first yield by Mises on the axis | 1 %; 2 % |
//! | `cattaneo-mindlin` | Cattaneo-Mindlin and Mindlin-Deresiewicz at nu = 0.49; the departure at nu = 0.3 for information | 2 % of mu F_N, half an element in c |
//! | `spence` | an elastic press with friction, Spence: c/a and what friction adds to F_N | 0.03, a third of an element; 0.45 % |
//! | `models` | without friction, the range of Olsson-Larsson and Jackson-Green, Lambda = 11 to 120; the unloading slope 2 E* a | what the models are worth, 6 % in Hbar and 8 % in c^2; 2 % |
//! | `plastic` | F_N, a, the hardness, the loss of F_N and the onset of sliding known from other codes | 2 % beyond their range; 5 % for the onset |
//! | `pressure` | the profile of an axisymmetric code at the end of the press, with friction and without | 4 % |
//! | `energy` | work = elastic + plastic + friction, with doubled steps | what is missing more than 1.6 times smaller |
//! | `jaeger-ciavarella` | elastic shear after a plastic preload, from the unloading curve | 3 % of mu F_N |
//! | `rigid-sphere` | the plane at a radius of 1e9 R; Hertz with R*; the hardness of a flat; friction, energies and cost of a shear | 1e-6; 1 %; 4 % |
//! | `two-bodies` | Hertz with R* and E*; Cattaneo-Mindlin at beta = 0; the plane by a stiff flat; the equal pair by two meshes | 1 %; 2 % of mu F_N; 0.2 %; 0.1 % |
//! | `invariance` | F_N(d) = F_N(-d), F_T(d) = -F_T(-d); other units | a hundred times the solver's tolerance |

pub mod check;
pub mod equator;
pub mod report;
pub mod runner;
pub mod sphere;
pub mod table;

mod cattaneo_mindlin;
mod couple;
mod error;
mod hertz;
mod invariance;
mod jaeger_ciavarella;
mod models;
mod plastic;
mod pressure;
mod rigid;
mod spence;

use std::time::{Duration, Instant};

pub use check::{Check, HeldAgainst, Scale, Verdict};
pub use error::VerifyError;
pub use report::VerificationReport;
pub use runner::{BackendFactory, Fineness, Runner};

/// A group of checks that share their cases.
#[derive(Clone, Copy, Debug)]
pub struct Family {
    /// Its name, for `--only`.
    pub name: &'static str,
    /// The names of its checks, which stand in the table; `--only` takes them as well.
    pub checks: &'static [&'static str],
    run: fn(&mut Runner<'_>) -> Result<Vec<Check>, VerifyError>,
}

/// All families, in the order in which they run.
pub const FAMILIES: [Family; 11] = [
    Family { name: "hertz", checks: &["hertz", "first yield", "equator"], run: hertz::checks },
    Family {
        name: "cattaneo-mindlin",
        checks: &["cattaneo-mindlin", "mindlin-deresiewicz", "equator", "nu = 0.3", "equal pair"],
        run: cattaneo_mindlin::checks,
    },
    Family { name: "spence", checks: &["spence"], run: spence::checks },
    Family { name: "models", checks: &["olsson-larsson, jackson-green", "unloading"], run: models::checks },
    Family { name: "plastic", checks: &["plastic press", "plastic shear", "energy"], run: plastic::checks },
    Family { name: "pressure", checks: &["pressure"], run: pressure::checks },
    Family { name: "energy", checks: &["energy"], run: plastic::step_convergence },
    Family { name: "jaeger-ciavarella", checks: &["jaeger-ciavarella"], run: jaeger_ciavarella::checks },
    Family { name: "rigid-sphere", checks: &["rigid sphere"], run: rigid::checks },
    Family { name: "two-bodies", checks: &["two bodies"], run: couple::checks },
    Family { name: "invariance", checks: &["symmetry", "units"], run: invariance::checks },
];

/// Rows of one family and how long they took.
#[derive(Clone, Debug)]
pub struct FamilyReport {
    /// Its rows.
    pub checks: Vec<Check>,
    /// Wall time.
    pub took: Duration,
}

impl Family {
    /// Whether `only`, the name of a family or of a check, names any of its checks.
    pub fn has(&self, only: &str) -> bool {
        self.name == only || !is_family(only) && self.checks.contains(&only)
    }

    /// Whether `only` names a check of this family: all of them, if it is the family's own name.
    pub fn names(&self, only: &str, check: &Check) -> bool {
        self.name == only || !is_family(only) && check.check == only
    }

    /// Runs the family. A path that cannot be followed is a failed row, not an error: the other
    /// families still run.
    ///
    /// # Errors
    /// A case cannot be set up, or the device fails.
    pub fn run(&self, runner: &mut Runner<'_>) -> Result<FamilyReport, VerifyError> {
        let start = Instant::now();
        let checks = match (self.run)(runner) {
            Err(VerifyError::Stopped(reason)) => vec![stopped(self.name, &reason)],
            other => {
                let checks = other?;
                debug_assert!(checks.iter().all(|check| self.checks.contains(&check.check)), "{}: {checks:?}", self.name);
                checks
            }
        };
        Ok(FamilyReport { checks, took: start.elapsed() })
    }
}

fn is_family(name: &str) -> bool {
    FAMILIES.iter().any(|family| family.name == name)
}

/// What `--only` takes: every family, and every check that stands in the table.
pub fn names() -> Vec<&'static str> {
    let mut names: Vec<&str> = FAMILIES.iter().map(|family| family.name).collect();
    for check in FAMILIES.iter().flat_map(|family| family.checks) {
        if !names.contains(check) {
            names.push(check);
        }
    }
    names
}

/// The row of a family whose path ended early.
fn stopped(name: &'static str, reason: &str) -> Check {
    Check::relative(name, reason, f64::NAN, 0.0, 0.0, "every path of the checks can be followed to its end")
}

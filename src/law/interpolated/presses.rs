//! c of oblique presses from a study of them, for the law that it belongs to.

use std::path::Path;

use super::fit::{FEWEST_MATERIALS, both, material_number};
use super::inputs::{INPUTS, inputs};
use super::model::{Interpolated, bodies, friction};
use super::process::{InputPoint, Process};
use super::yielding::Yielding;
use crate::case::{Case, Friction, Hardening, Material, Segment};
use crate::law::LawError;
use crate::law::data::study_name;
use crate::law::json::LawKind as _;
use crate::law::study_table::StudyTable;
use crate::law::table::{Against, slides_to_its_end, straight, yielding};
use crate::output::{OutputDirectory, read_history};

/// Depths of a press that become samples, over its last one: those in which the contact has enough
/// elements.
const DEPTHS: [f64; 3] = [1.0, 0.55, 0.3];
/// Fewest presses: four for each input.
const FEWEST: usize = 4 * INPUTS;

/// The law with c of the oblique presses of the study in `dir`.
///
/// # Errors
/// No study there, results that cannot be read, too few presses or materials against the opponent
/// of the law, values that no process can be made of.
pub fn with_yielding(law: Interpolated, dir: &Path) -> Result<Interpolated, LawError> {
    let (mut places, mut values, mut groups) = (Vec::<InputPoint>::new(), Vec::new(), Vec::new());
    let (mut materials, mut left_out, mut cases) = (Vec::<Material>::new(), Vec::new(), 0);
    for row in StudyTable::read(&dir.join("study.csv"))?.rows {
        if !row.is_done() {
            left_out.push((row.id, row.status));
            continue;
        }
        let directory = OutputDirectory::existing(dir.join(&row.directory));
        let case = directory.load_case()?;
        if let Some(reason) = unusable(&case, law.body) {
            left_out.push((row.id, reason.to_owned()));
            continue;
        }
        let history = read_history(&directory.history())?;
        let known: Vec<[f64; 2]> = yielding(&case, &history).iter().map(|[x, c]| [*x, c.ln()]).collect();
        let Some(&[deepest, _]) = known.last().filter(|_| !slides_to_its_end(&case, &history)) else {
            left_out.push((row.id, "slides to its end".to_owned()));
            continue;
        };
        let (body, sphere) = bodies(&case)?;
        let material = material_number(&mut materials, case.scaled().0.material);
        cases += 1;
        for share in DEPTHS {
            let at = deepest + share.ln();
            let Some(value) = straight(&known, at).filter(|_| at >= known[0][0] - 1e-9) else { continue };
            places.push(law.place(&inputs(&body, &sphere, friction(&case), at.exp())));
            values.push(value);
            groups.push(material);
        }
    }
    let what = "c of oblique presses";
    if cases < FEWEST || materials.len() < FEWEST_MATERIALS {
        let (of, needed) = (materials.len(), FEWEST_MATERIALS);
        let problem = format!("{} has {cases} of them, of {of} materials, and needs {FEWEST} of {needed}", dir.display());
        return Err(LawError::Fit { what, problem });
    }
    let all: Vec<usize> = (0..values.len()).collect();
    let (process, unseen) = Process::fit("ln c".to_owned(), &places, &values, &groups, &all)
        .ok_or(LawError::Fit { what: "a Gaussian process", problem: "its covariance has no factors".to_owned() })?;
    let errors = both(values.iter().zip(&unseen).map(|(value, unseen)| unseen - value));
    let study = study_name(dir);
    let yielding = Some(Yielding { study, cases, materials: materials.len(), left_out, errors, process, samples: places });
    let law = Interpolated { yielding, ..law };
    law.check().map_err(|problem| LawError::Fit { what, problem })?;
    Ok(law)
}

/// Why a case says nothing of c, as the end of "left out: ...".
fn unusable(case: &Case, body: Against) -> Option<&'static str> {
    if Against::of(case) != body || case.sphere.flat {
        return Some("with another opponent");
    }
    if !case.sphere.equator.is_clamped() {
        return Some("with a free equator");
    }
    if !matches!(case.contact.friction, Friction::Coefficient(mu) if mu > 0.0) {
        return Some("without a friction coefficient");
    }
    if matches!(case.scaled().0.material.hardening, Hardening::Elastic) {
        return Some("elastic");
    }
    if !matches!(case.path.first(), Some(Segment::Oblique { .. })) {
        return Some("not pressed obliquely");
    }
    None
}

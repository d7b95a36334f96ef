//! What a run says before it starts: what it will do, and how long that will take.

use crate::case::{BYTES_PER_ELEMENT, Case, Friction, Hold, Opponent, Segment, ShearTarget};
use crate::compute::Description;
use crate::output::in_words;
use crate::simulation::problem::Problem;
use crate::simulation::scout::Scout;

/// The cost of a Newton iteration grows with this power of the number of elements.
const COST_EXPONENT: f64 = 1.1;
/// Segments that are named; of a longer path the rest is counted.
const NAMED: usize = 4;

/// The run in two lines: `press to h = 0.02, shear to full slip; mu = 0.3` and `16 elements along
/// the contact radius; on CPU (2 threads) in f64`.
pub(super) fn plan(case: &Case, computed_on: &Description) -> [String; 2] {
    let mut segments: Vec<String> = case.path.iter().take(NAMED).map(segment).collect();
    if case.path.len() > NAMED {
        segments.push(format!("{} more segments", case.path.len() - NAMED));
    }
    let friction = match case.contact.friction {
        Friction::Coefficient(mu) => format!("mu = {mu}"),
        Friction::Stick => "full stick".to_owned(),
    };
    let against = match &case.opponent {
        None => String::new(),
        Some(Opponent::Equal) => " against an equal sphere".to_owned(),
        Some(Opponent::Rigid { radius }) => format!(" against a rigid sphere of radius {radius}"),
        Some(Opponent::Deforming { radius: Some(radius), .. }) => format!(" against a sphere of radius {radius} that deforms"),
        Some(Opponent::Deforming { radius: None, .. }) => " against a flat that deforms".to_owned(),
    };
    let elements = case.mesh.elements_per_contact_radius;
    let at_surface = match case.mesh.surface_elements() {
        surface if surface == elements => String::new(),
        surface => format!(" and {surface} at the surface"),
    };
    let Description { device, precision } = computed_on;
    [
        format!("{}{against}; {friction}", segments.join(", ")),
        format!("{elements} elements along the contact radius{at_surface}; on {device} in {precision}"),
    ]
}

fn held(hold: Hold) -> &'static str {
    if hold == Hold::NormalForce { " at constant F_N" } else { "" }
}

fn segment(segment: &Segment) -> String {
    match segment {
        Segment::Indentation { indentation } => format!("press to h = {indentation}"),
        Segment::Oblique { indentation, shear } => format!("press to h = {indentation} and shear to {shear}"),
        Segment::Shear { shear, hold } => {
            let target = match shear {
                ShearTarget::FullSlip => "full slip".to_owned(),
                ShearTarget::Displacement(shear) => shear.to_string(),
            };
            format!("shear to {target}{}", held(*hold))
        }
        Segment::Motion { to, hold } => {
            let mut parts = Vec::new();
            if let Some(h) = to.indentation {
                parts.push(format!("press to h = {h}"));
            }
            if let Some([x, y]) = to.shear {
                parts.push(format!("shear to [{x}, {y}]"));
            }
            if let Some(twist) = to.twist {
                parts.push(format!("twist to {twist}"));
            }
            if let Some([about_x, about_y]) = to.roll {
                parts.push(format!("roll to [{about_x}, {about_y}]"));
            }
            format!("{}{}", parts.join(" and "), held(*hold))
        }
        Segment::Slip { direction, hold } => format!("shear to full slip at {direction} degrees{}", held(*hold)),
        Segment::Release { share } if *share > 0.0 => format!("release to {share} F_N"),
        Segment::Release { .. } => "release".to_owned(),
    }
}

/// What the coarse run tells of the run: its size, and about how long it will take in the same
/// place.
pub(super) fn forecast(scout: &Scout, problem: &Problem, scout_seconds: f64) -> String {
    let elements = problem.model.mesh.elements.len();
    let refinement = scout.spacing / problem.spacing;
    let seconds = scout_seconds * refinement * (elements as f64 / scout.mesh_elements.max(1) as f64).powf(COST_EXPONENT);
    format!(
        "{elements} elements, {:.2} GiB; about {} to go, going by the coarse run on {} elements",
        elements as f64 * BYTES_PER_ELEMENT / f64::from(1 << 30),
        in_words(seconds),
        scout.mesh_elements
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plan_names_what_is_done() {
        let text = include_str!("../../fixtures/cases/reversal.toml");
        let case = Case::parse(text, "reversal.toml", &[]).expect("a case");
        let device = Description { device: "CPU (2 threads)".to_owned(), precision: "f64" };
        let path = "press to h = 0.02, shear to 0.002, shear to -0.002, press to h = 0.025, 2 more segments; mu = 0.3";
        let mesh = "10 elements along the contact radius and 20 at the surface; on CPU (2 threads) in f64";
        assert_eq!(plan(&case, &device), [path, mesh]);
        let case = Case::parse(text, "", &["path=[{indentation=0.01},{release=0.5}]".into(), "contact.friction=stick".into()]);
        assert_eq!(plan(&case.expect("a case"), &device)[0], "press to h = 0.01, release to 0.5 F_N; full stick");
    }
}

//! Shares of a study for machines side by side, and how long a case is likely to take.

use std::str::FromStr;

use crate::case::{Case, Friction, Motion, Segment, estimated_elements};
use crate::simulation::path::RELEASE_STEPS;
use crate::simulation::problem::press_steps;

/// One of some shares of a study, `1/4` to `4/4`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// Which share, from 1.
    pub index: usize,
    /// Of how many.
    pub count: usize,
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let parsed = text.split_once('/').and_then(|(index, count)| Some((index.parse().ok()?, count.parse().ok()?)));
        match parsed {
            Some((index, count)) if 1 <= index && index <= count => Ok(Self { index, count }),
            _ => Err("a share is I/N with I from 1 to N, as in 1/4".to_owned()),
        }
    }
}

impl Shard {
    /// The cases of this share, increasing. Every case falls to one share, which depends on the
    /// costs alone: the dearest first, each to the share that has the least so far, the first of
    /// equals.
    pub fn of(&self, costs: &[f64]) -> Vec<usize> {
        let mut loads = vec![0.0; self.count];
        let mut mine = Vec::new();
        for case in by_descending_cost(costs) {
            let (least, _) = loads.iter().enumerate().fold(
                (0, f64::INFINITY),
                |best, (share, &load)| {
                    if load < best.1 { (share, load) } else { best }
                },
            );
            loads[least] += costs[case];
            if least + 1 == self.index {
                mine.push(case);
            }
        }
        mine.sort_unstable();
        mine
    }
}

/// Indices by falling cost, equal ones in their order.
pub fn by_descending_cost(costs: &[f64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..costs.len()).collect();
    order.sort_by(|&a, &b| costs[b].total_cmp(&costs[a]));
    order
}

/// Steps of a press that take as long as a shear to full slip, typically.
const SHEAR_STEPS: f64 = 22.0;

/// How long a case is likely to take, in no unit: elements times steps, and more where plastic
/// strains are large against the elastic ones and where friction is high, which costs Newton
/// iterations. For the order of cases and for the time left, not for science: measured times of
/// single cases are up to a factor of three off it.
pub fn cost(case: &Case) -> f64 {
    let radius = case.sphere.radius;
    let (mut steps, mut deepest) = (0.0, 0.0f64);
    for segment in &case.path {
        steps += match segment {
            Segment::Indentation { indentation } | Segment::Oblique { indentation, .. } => {
                deepest = deepest.max(indentation / radius);
                press_steps(case) as f64
            }
            Segment::Motion { to: Motion { indentation: Some(indentation), .. }, .. } => {
                deepest = deepest.max(indentation / radius);
                press_steps(case) as f64
            }
            Segment::Shear { .. } | Segment::Slip { .. } | Segment::Motion { .. } => SHEAR_STEPS,
            Segment::Release { .. } => RELEASE_STEPS,
        };
    }
    // Of the order of Johnson's Lambda: contact strain over yield strain.
    let modulus = case.material.youngs_modulus;
    let plasticity =
        case.material.hardening.yield_stress(modulus).map_or(0.0, |stress| (2.0 * deepest).sqrt() * modulus / stress);
    let friction = match case.contact.friction {
        Friction::Coefficient(mu) => mu.min(1.0),
        Friction::Stick => 0.0,
    };
    estimated_elements(case) as f64 * steps * (1.0 + plasticity / 250.0) * (1.0 + friction)
}

/// Processor seconds for a [`cost`] of 1: those of the main job at 4, 8 and 16 elements, which it
/// gives to 10 %.
const SECONDS: f64 = 1.35e-5;

/// About how long a case is likely to take on a core of a machine of 2020, in seconds; as uncertain
/// as [`cost`].
pub fn estimated_seconds(case: &Case) -> f64 {
    SECONDS * cost(case)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_disjoint_complete_and_balanced() {
        let costs: Vec<f64> = (0..37).map(|i| 1.0 + f64::from(i * i % 23)).collect();
        for count in [1, 2, 5, 40] {
            let mut all = Vec::new();
            let mut loads = Vec::new();
            for index in 1..=count {
                let share = Shard { index, count }.of(&costs);
                assert!(share.is_sorted());
                loads.push(share.iter().map(|&case| costs[case]).sum::<f64>());
                all.extend(share);
            }
            all.sort_unstable();
            assert_eq!(all, (0..37).collect::<Vec<_>>());
            let spread = loads.iter().copied().fold(0.0, f64::max) - loads.iter().copied().fold(f64::INFINITY, f64::min);
            assert!(spread <= 23.0, "{count}: {loads:?}");
        }
    }

    #[test]
    fn a_share_is_written_as_i_of_n() {
        assert_eq!("2/4".parse(), Ok(Shard { index: 2, count: 4 }));
        for wrong in ["0/4", "5/4", "1", "a/b", "1/0", "-1/2", "1/2/3", ""] {
            assert!(wrong.parse::<Shard>().unwrap_err().contains("I from 1 to N"), "{wrong}");
        }
    }

    #[test]
    fn fine_deep_and_soft_cases_come_first() {
        let text = include_str!("../../fixtures/cases/ideal.toml");
        let with = |set: &str| cost(&Case::parse(text, "ideal.toml", &[set.to_owned()]).expect("a case"));
        let base = with("contact.friction=0.3");
        assert!(with("mesh.elements_per_contact_radius=24") > base);
        assert!(with("material.hardening.yield_stress=100") > base);
        assert!(with("contact.friction=0.1") < base);
        assert_eq!(by_descending_cost(&[1.0, 3.0, 1.0, 2.0]), [1, 3, 0, 2]);
    }
}

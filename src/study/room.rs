//! How many cases of a study there is memory for at a time.

use super::StudyError;
use super::file::Study;
use crate::case::{Case, check_room, estimated_memory, fits};
use crate::memory::{self, Room};

impl Study {
    /// Refuses a study of which a case that is `wanted`, by its index, takes more memory than there
    /// is.
    ///
    /// # Errors
    /// [`StudyError::Combination`], with what it takes, how much there is, and what says so.
    pub fn check_room(&self, wanted: impl Fn(usize) -> bool) -> Result<(), StudyError> {
        let room = memory::room();
        let large: Vec<usize> =
            (0..self.cases.len()).filter(|&case| !fits(&self.cases[case].case, &room) && wanted(case)).collect();
        let Some(first) = large.first().map(|&case| &self.cases[case]) else { return Ok(()) };
        let Err(error) = check_room(&first.case, None, &room) else { return Ok(()) };
        let combination = self.combination(first);
        let (failing, count) = (large.len(), self.cases.len());
        Err(StudyError::Combination { source: Box::new(error), combination, failing, count, more: false })
    }
}

/// How many of these cases may be computed at a time, `most` at most and at least one: so many that
/// the largest of them fit together. What says itself how much it may take is not counted.
pub(super) fn at_a_time<'a>(cases: impl Iterator<Item = &'a Case>, most: usize, room: &Room) -> usize {
    let counted = cases.filter(|case| case.solver.max_memory_gib.is_none());
    let mut gib: Vec<f64> = counted.map(|case| estimated_memory(case) + room.of_each_worker()).collect();
    gib.sort_by(|one, other| other.total_cmp(one));
    let mut taken = 0.0;
    let fitting = gib.iter().take_while(|&&gib| {
        taken += gib;
        taken <= room.gib
    });
    match fitting.count() {
        all if all == gib.len() => most,
        some => some.clamp(1, most.max(1)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::memory::Origin;

    #[test]
    fn as_many_as_fit_together_and_never_none() {
        let text = include_str!("../../fixtures/cases/ideal.toml");
        let case = |settings: &[&str]| {
            let settings: Vec<String> = settings.iter().map(|&setting| setting.to_owned()).collect();
            Case::parse(text, "ideal.toml", &settings).unwrap()
        };
        let (large, small) = (case(&["mesh.elements_per_contact_radius=32"]), case(&["mesh.elements_per_contact_radius=8"]));
        let [of_large, of_small] = [&large, &small].map(estimated_memory);
        let room = |gib: f64| Room { gib, from: Origin::Machine };
        let both = [large.clone(), small.clone(), small.clone(), small.clone()];
        assert_eq!(at_a_time(both.iter(), 8, &room(100.0)), 8);
        assert_eq!(at_a_time(both.iter(), 2, &room(100.0)), 2);
        assert_eq!(at_a_time(both.iter(), 8, &room(of_large + 2.5 * of_small)), 3);
        assert_eq!(at_a_time(both.iter(), 8, &room(0.5 * of_large)), 1);
        assert_eq!(at_a_time(std::iter::empty(), 8, &room(0.0)), 8);
        // What the user says counts, and nothing else.
        let given = vec![case(&["mesh.elements_per_contact_radius=32", "solver.max_memory_gib=100"]); 4];
        assert_eq!(at_a_time(given.iter(), 4, &room(0.5 * of_large)), 4);
        assert!(fits(&given[0], &room(0.0)) && !fits(&large, &room(0.5 * of_large)) && fits(&small, &room(of_small)));
    }
}

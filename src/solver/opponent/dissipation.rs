//! What friction dissipates at a contact point in a step.

use crate::contact::coulomb::{Friction, Status};

/// Work that friction dissipates at a point that slips by `slip` (along the surface) in a step,
/// where contact exerts `before` at its start and `after` at its end (two tangential components and
/// the normal one, in one frame). Never negative.
///
/// A point first takes its tangential force to the limit, which dissipates nothing, and then slips
/// at it, against the direction of the slip: the work is |slip| times the mean of the limits at
/// both ends, to second order in the step. A mean of the forces themselves gives work back where
/// the slip has reversed within the step. A point that sticks at the end has not slipped.
pub fn dissipated(friction: Friction<f64>, status: Status, before: &[f64; 3], after: &[f64; 3], slip: [f64; 2]) -> f64 {
    let along = |force: &[f64; 3]| -(force[0] * slip[0] + force[1] * slip[1]);
    let first = match (status, friction) {
        (Status::Stick, _) => return 0.0,
        // Where it came off within the step nobody knows: with what it carried at the start.
        (Status::Open, _) => along(before).max(0.0),
        (Status::Slip, Friction::Coulomb(mu)) => mu * before[2].max(0.0) * slip[0].hypot(slip[1]),
        // Under full stick a point that was let go slides by what it carried.
        (Status::Slip, Friction::Stick) => along(before).max(0.0),
    };
    0.5 * (first + along(after).max(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    const MU: Friction<f64> = Friction::Coulomb(0.5);

    #[test]
    fn a_point_that_slides_on_dissipates_the_limit_times_the_way() {
        let work = dissipated(MU, Status::Slip, &[-1.0, 0.0, 2.0], &[-2.0, 0.0, 4.0], [0.1, 0.0]);
        assert!((work - 0.15).abs() < 1e-15);
        assert_eq!(dissipated(MU, Status::Stick, &[-1.0, 0.0, 2.0], &[-0.5, 0.0, 4.0], [1e-9, 0.0]), 0.0);
        assert_eq!(dissipated(Friction::Coulomb(0.0), Status::Slip, &[0.0, 0.0, 2.0], &[0.0, 0.0, 4.0], [0.1, 0.3]), 0.0);
    }

    #[test]
    fn under_full_stick_a_point_that_is_let_go_gives_back_half_of_what_it_carried() {
        let work = dissipated(Friction::Stick, Status::Slip, &[-1.0, 0.0, 2.0], &[0.0, 0.0, 2.0], [0.1, 0.0]);
        assert!((work - 0.05).abs() < 1e-15);
        assert_eq!(dissipated(Friction::Stick, Status::Slip, &[-1.0, 0.0, 2.0], &[0.0, 0.0, 2.0], [-0.1, 0.0]), 0.0);
    }

    #[test]
    fn a_slip_that_reverses_within_a_step_gives_nothing_back() {
        // It carried the limit one way and carries it the other way at the end.
        let work = dissipated(MU, Status::Slip, &[1.0, 0.0, 2.0], &[-1.0, 0.0, 2.0], [0.1, 0.0]);
        assert!((work - 0.1).abs() < 1e-15);
        assert!(dissipated(MU, Status::Open, &[1.0, 0.0, 2.0], &[0.0; 3], [0.1, 0.0]) == 0.0);
    }
}

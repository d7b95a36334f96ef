//! The first shear of a history, which the numbers of a summary are of.

use super::StepRecord;
use super::curve::Curve;

/// delta_T_slip is the displacement at which |F_T|/F_N first reaches this share of mu: the last per
/// cent of the curve is so flat that where it ends depends on mesh and steps.
pub const SLIP_DISPLACEMENT_RATIO: f64 = 0.99;
/// The same for delta_T_90 and delta_T_95, which have limits, and for delta_T_slip, which is a
/// convention.
pub(super) const SLIP_DISPLACEMENT_RATIOS: [f64; 3] = [0.90, 0.95, SLIP_DISPLACEMENT_RATIO];

/// Where a smooth curve through the origin and these points of |F_T|/F_N over the displacement
/// first comes to `wanted`; `None` if it does not, or if there are no points.
pub(super) fn reaches(points: impl Iterator<Item = [f64; 2]>, wanted: f64) -> Option<f64> {
    let mut points = points.peekable();
    points.peek()?;
    Curve::through(std::iter::once([0.0; 2]).chain(points)).reaches(wanted)
}

/// The last record before the first shear and the records of that shear, up to where it stops or
/// turns. Without a shear the record of the greatest indentation and nothing.
pub(super) fn first_shear<'a>(history: &'a [StepRecord], oblique: &[usize]) -> (Option<&'a StepRecord>, &'a [StepRecord]) {
    let way = |pair: &[StepRecord]| [pair[1].delta_t - pair[0].delta_t, pair[1].delta_t_y - pair[0].delta_t_y];
    let sheared = |pair: &[StepRecord]| way(pair) != [0.0; 2] && !oblique.contains(&pair[1].segment);
    let begin = history.windows(2).position(sheared);
    let Some(begin) = begin else {
        let deepest = history.iter().reduce(|deepest, record| if record.h >= deepest.h { record } else { deepest });
        return (deepest, &[]);
    };
    let [x, y] = way(&history[begin..begin + 2]);
    let on = |pair: &&[StepRecord]| sheared(pair) && x * way(pair)[0] + y * way(pair)[1] > 0.0;
    let length = history[begin..].windows(2).take_while(on).count();
    (Some(&history[begin]), &history[begin + 1..=begin + length])
}

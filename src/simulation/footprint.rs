//! The size of the contact, to a fraction of an element, by two methods that use different fields.

use super::record::ContactPoint;
use crate::contact::coulomb::Status;

/// Size of a contact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Footprint {
    /// Radius at which the gap outside the contact goes to zero.
    pub radius: f64,
    /// Radius from the second and fourth moments of the contact pressure.
    pub radius_moment: f64,
    /// Radius of a disc with the tributary area of the sticking points.
    pub stick_radius: f64,
}

/// Measures the contact of one committed state; `spacing` is the typical distance of contact points.
pub fn footprint(points: &[ContactPoint], spacing: f64) -> Footprint {
    let closed = || points.iter().filter(|p| p.status != Status::Open);
    let area: f64 = closed().map(|p| p.area).sum();
    if !(area > 0.0) {
        return Footprint::default();
    }
    let stick_area: f64 = closed().filter(|p| p.status == Status::Stick).map(|p| p.area).sum();
    let radius_area = (2.0 * area / std::f64::consts::PI).sqrt();
    let force: f64 = closed().map(|p| p.force[2]).sum();
    let centre = if force > 0.0 { closed().map(|p| p.force[2] * p.position[0]).sum::<f64>() / force } else { 0.0 };
    let r = |p: &ContactPoint| (p.position[0] - centre).hypot(p.position[1]);
    Footprint {
        radius: radius_from_gap(points, r, radius_area, spacing).unwrap_or(radius_area),
        radius_moment: radius_from_moments(closed().map(|p| (r(p), p.force[2]))).unwrap_or(radius_area),
        stick_radius: (2.0 * stick_area / std::f64::consts::PI).sqrt(),
    }
}

/// Outside a smooth contact the gap opens as (r - a)^(3/2) (the edge of every frictionless or frictional non-adhesive contact, Johnson 1985,
/// section 5.1), so gap^(2/3) is a straight line whose zero is a.
fn radius_from_gap(points: &[ContactPoint], r: impl Fn(&ContactPoint) -> f64, radius_area: f64, spacing: f64) -> Option<f64> {
    let band = 0.25 * spacing..=3.5 * spacing;
    let (mut n, mut sx, mut sy, mut sxx, mut sxy) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for p in points.iter().filter(|p| p.status == Status::Open && p.position[2] > 0.0) {
        let x = r(p) - radius_area;
        if band.contains(&x) {
            let y = p.position[2].powf(2.0 / 3.0);
            n += 1.0;
            sx += x;
            sy += y;
            sxx += x * x;
            sxy += x * y;
        }
    }
    let determinant = n * sxx - sx * sx;
    if n < 6.0 || determinant <= 0.0 {
        return None;
    }
    let slope = (n * sxy - sx * sy) / determinant;
    let at_zero = (sy - slope * sx) / n;
    let radius = radius_area - at_zero / slope;
    // A fit that leaves the neighbourhood of the counted area has not seen a smooth edge.
    (slope > 0.0 && (radius - radius_area).abs() < 1.5 * spacing).then_some(radius)
}

/// For a pressure p_0 (1 - r^2/a^2)^k the moments are <r^2> = a^2/(k+2) and <r^4> = 2 a^4/((k+2)(k+3)): two equations for a and k. Hertz
/// (k = 1/2) and a uniform pressure (k = 0) are both of this form.
fn radius_from_moments(pressure: impl Iterator<Item = (f64, f64)>) -> Option<f64> {
    let (mut m0, mut m2, mut m4, mut n) = (0.0, 0.0, 0.0, 0);
    for (r, f) in pressure {
        m0 += f;
        m2 += f * r * r;
        m4 += f * r.powi(4);
        n += 1;
    }
    if n < 6 || !(m0 > 0.0) || !(m2 > 0.0) {
        return None;
    }
    let mean = m2 / m0;
    let ratio = m4 / m0 / (mean * mean);
    // k from -1/2 (a flat punch) to 2 is all that a contact can show; outside it the points are too few.
    let k = ((3.0 * ratio - 4.0) / (2.0 - ratio)).clamp(-0.5, 2.0);
    Some(((k + 2.0) * mean).sqrt())
}

//! The size of the contact, to a fraction of an element, by two methods that use different fields.
//!
//! A node on the edge knows no half contact: it is closed or open, and it is closed as soon as the
//! smallest force holds it. Counting closed nodes, or looking for the end of the gap, therefore
//! finds the radius at which a node just touches. The pressure says more: nodes within half an
//! element of that radius carry less than their share, and what they lack tells where the edge is.

use super::record::ContactPoint;
use crate::contact::coulomb::Status;

/// Size of a contact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Footprint {
    /// Contact radius from the pressure: where the profile of the inner points would have to end to
    /// carry the whole force.
    pub radius: f64,
    /// Contact radius from the gap: where the gap of the points outside goes to zero.
    pub radius_gap: f64,
    /// Radius of a disc with the tributary area of the sticking points.
    pub stick_radius: f64,
}

/// A contact point in the polar frame of the contact.
struct Polar {
    r: f64,
    area: f64,
    force: f64,
    gap: f64,
    closed: bool,
}

/// Width of the ring that the pressure profile is taken from, in spacings, outside of which other
/// nodes would blur it.
const RING: f64 = 5.0;
/// Width of the band outside the contact in which the gap is looked at, in spacings.
const BAND: f64 = 3.0;
/// Fewer points than this make no profile.
const FEWEST_POINTS: usize = 6;

/// Measures the contact of one committed state; `spacing` is the typical distance of contact
/// points.
pub fn footprint(points: &[ContactPoint], spacing: f64) -> Footprint {
    let closed = || points.iter().filter(|p| p.status != Status::Open);
    let area: f64 = closed().map(|p| p.area).sum();
    if !(area > 0.0) {
        return Footprint::default();
    }
    let disc = |area: f64| (2.0 * area / std::f64::consts::PI).sqrt();
    let stick_area: f64 = closed().filter(|p| p.status == Status::Stick).map(|p| p.area).sum();
    let force: f64 = closed().map(|p| p.force[2]).sum();
    let centre = if force > 0.0 { closed().map(|p| p.force[2] * p.position[0]).sum::<f64>() / force } else { 0.0 };
    let reference_centre = closed().map(|p| p.area * p.reference[0]).sum::<f64>() / area;
    // The surface has stretched under the contact: the ratio of current to reference distances of
    // the closed points.
    let (now, then) = closed().fold((0.0, 0.0), |(now, then), p| {
        let (r, r0) = ((p.position[0] - centre).hypot(p.position[1]), (p.reference[0] - reference_centre).hypot(p.reference[1]));
        (now + p.area * r * r0, then + p.area * r0 * r0)
    });
    let stretch = if then > 0.0 { now / then } else { 1.0 };
    let polar: Vec<Polar> = points
        .iter()
        .map(|p| Polar {
            r: (p.position[0] - centre).hypot(p.position[1]),
            area: p.area * stretch * stretch,
            force: p.force[2],
            gap: p.gap,
            closed: p.status != Status::Open,
        })
        .collect();
    let touching = disc(area) * stretch;
    Footprint {
        radius: radius_from_pressure(&polar, touching, spacing).unwrap_or(touching),
        radius_gap: radius_from_gap(&polar, touching, spacing).unwrap_or(touching),
        // + 0: a sum over no points is -0.
        stick_radius: disc(stick_area + 0.0) * stretch,
    }
}

/// Height in the middle and curvature of the surface in contact: the paraboloid z = z_0 + kappa
/// r^2/2 that fits its closed points best, by their areas. `None` for a few points.
pub fn bulge(points: &[ContactPoint]) -> Option<[f64; 2]> {
    let closed = || points.iter().filter(|p| p.status != Status::Open);
    let force: f64 = closed().map(|p| p.force[2]).sum();
    let centre = if force > 0.0 { closed().map(|p| p.force[2] * p.position[0]).sum::<f64>() / force } else { 0.0 };
    let square = |p: &ContactPoint| (p.position[0] - centre).powi(2) + p.position[1].powi(2);
    let (slope, height) = line(closed().map(|p| (p.area, square(p), p.position[2])))?;
    Some([height, 2.0 * slope])
}

/// Slope and value at zero of the weighted least-squares line y(x), if there are points enough.
fn line(points: impl Iterator<Item = (f64, f64, f64)>) -> Option<(f64, f64)> {
    let (mut n, mut w, mut x1, mut y1, mut x2, mut xy) = (0, 0.0, 0.0, 0.0, 0.0, 0.0);
    for (weight, x, y) in points {
        n += 1;
        w += weight;
        x1 += weight * x;
        y1 += weight * y;
        x2 += weight * x * x;
        xy += weight * x * y;
    }
    let determinant = w * x2 - x1 * x1;
    if n < FEWEST_POINTS || !(determinant > 0.0) {
        return None;
    }
    let slope = (w * xy - x1 * y1) / determinant;
    Some((slope, (y1 - slope * x1) / w))
}

/// The edge from the pressure. Inside, p^2 is fitted by a line in r^2, which is exact for Hertz's
/// pressure and for a uniform one; the force that points near the edge lack against that profile is
/// the integral of the profile from the edge to the touching radius.
fn radius_from_pressure(points: &[Polar], touching: f64, spacing: f64) -> Option<f64> {
    let inside = touching - spacing;
    let from = (touching - (RING + 1.0) * spacing).max(0.0);
    let ring = points.iter().filter(|p| p.closed && (from..inside).contains(&p.r));
    let (slope, at_zero) = line(ring.map(|p| (p.area, p.r * p.r, (p.force / p.area).powi(2))))?;
    let squared = |r: f64| (at_zero + slope * r * r).max(0.0);
    let lacking: f64 = points.iter().filter(|p| p.closed && p.r >= inside).map(|p| squared(p.r).sqrt() * p.area - p.force).sum();
    // Half of the disc is meshed: the profile carries integral pi r p dr. With s = r^2 that is pi/2
    // integral sqrt(c + m s) ds.
    let carried = |r: f64| {
        let (lo, hi) = (r * r, touching * touching);
        let n = 64;
        let step = (hi - lo) / f64::from(n);
        (0..n).map(|i| squared((lo + (f64::from(i) + 0.5) * step).sqrt()).sqrt() * step).sum::<f64>()
            * std::f64::consts::FRAC_PI_2
    };
    // Where the profile itself ends before the touching radius, the contact does too.
    let end = if slope < 0.0 { (-at_zero / slope).max(0.0).sqrt().min(touching) } else { touching };
    if lacking <= 0.0 {
        return Some(end);
    }
    let (mut lo, mut hi) = (from, end);
    for _ in 0..60 {
        let middle = 0.5 * (lo + hi);
        if carried(middle) > lacking { lo = middle } else { hi = middle }
    }
    Some(0.5 * (lo + hi))
}

/// The edge from the gap. It opens as (r - a)^q, with q = 3/2 at an elastic edge (Johnson 1985,
/// section 5.1) and q = 1 where plastic flow has piled the material up; of these the line gap^(1/q)
/// that fits best is taken, with q in steps of 1/20.
fn radius_from_gap(points: &[Polar], touching: f64, spacing: f64) -> Option<f64> {
    let band = || points.iter().filter(|p| !p.closed && p.gap > 0.0 && (p.r - touching).abs() < BAND * spacing);
    let mut best: Option<(f64, f64)> = None;
    for i in 0..=10 {
        let q = 1.0 + 0.05 * f64::from(i);
        let Some((slope, at_zero)) = line(band().map(|p| (p.area, p.r - touching, p.gap.powf(1.0 / q)))) else { continue };
        let error: f64 = band().map(|p| p.area * ((slope * (p.r - touching) + at_zero).max(0.0).powf(q) - p.gap).powi(2)).sum();
        let radius = touching - at_zero / slope;
        if slope > 0.0 && (radius - touching).abs() < spacing && best.is_none_or(|(least, _)| error < least) {
            best = Some((error, radius));
        }
    }
    best.map(|(_, radius)| radius)
}

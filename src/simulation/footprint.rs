//! The size of the contact, to a fraction of an element, by two methods that use different fields.
//! docs/accuracy.md has what they give.
//!
//! A node on the edge knows no half contact: it is closed or open, and it is closed as soon as the
//! smallest force holds it. Counting closed nodes, or looking for the end of the gap, therefore
//! finds the radius at which a node just touches. The pressure says more: nodes within half an
//! element of that radius carry less than their share, and what they lack tells where the edge is.

use std::f64::consts::PI;

use super::record::RecordedPoint;
use crate::contact::coulomb::Status;

/// Size of a contact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Footprint {
    /// Contact radius from the pressure: where the profile of the inner points has to end to carry
    /// the whole force.
    pub radius: f64,
    /// Contact radius from the gap: where the gap of the points outside goes to zero.
    pub radius_gap: f64,
    /// Radius that a disc with the area of the sticking points has now.
    pub stick_radius: f64,
}

/// A contact point in the polar frame of the contact.
struct PolarPlace {
    /// Distance from the middle of the contact, along the plane.
    r: f64,
    /// The same in the undeformed body: the chord from the middle. On a sphere as on a flat what is
    /// nearer than s has the area pi s^2 (Archimedes), so that areas tell chords.
    s: f64,
    /// Area of the undeformed surface that it stands for.
    area: f64,
    force: f64,
    gap: f64,
    closed: bool,
}

/// Width of the ring that the pressure profile is taken from, in spacings. Half and twice of this
/// and of the numbers below: `benches/constants`.
const RING: f64 = 4.0;
/// Width of the rim outside the ring, in spacings: its points carry more or less than their share.
const RIM: f64 = 1.0;
/// Exponents m of profiles p^m that are linear in s^2: that of Hertz's pressure and of a uniform
/// one, and the least.
const EXPONENTS: [f64; 2] = [2.0, 0.5];
/// Width of the band outside the contact in which the gap is looked at, in spacings.
const BAND: f64 = 3.0;
/// Points so many spacings to either side tell how far the surface there has moved.
const NEAR: f64 = 1.0;
/// Fewer points than this make no profile.
const FEWEST_POINTS: usize = 6;

/// Measures the contact of one committed state; `spacing` is the typical distance of contact
/// points, of which so many `copies` make the contact.
pub fn footprint(points: &[RecordedPoint], spacing: f64, copies: usize) -> Footprint {
    let copies = copies as f64;
    let closed = || points.iter().filter(|p| p.status != Status::Open);
    let area: f64 = closed().map(|p| p.area).sum();
    if !(area > 0.0) {
        return Footprint::default();
    }
    let disc = |area: f64| (copies * area / PI).sqrt();
    let stick_area: f64 = closed().filter(|p| p.status == Status::Stick).map(|p| p.area).sum();
    let polar = polar(points);
    // Stretched as the surface is there: more in the middle of a plastic contact than at its edge.
    let now = |s: f64| present_radius(&polar, s, spacing);
    let edge = disc(area);
    let touching = now(edge);
    Footprint {
        radius: edge_from_pressure(&polar, edge, spacing, 2.0 * PI / copies).map_or(touching, now),
        radius_gap: radius_from_gap(&polar, touching, spacing).unwrap_or(touching),
        stick_radius: if stick_area > 0.0 { now(disc(stick_area)) } else { 0.0 },
    }
}

/// The points in the polar frame of the contact: around the middle of its force, and of its area in
/// the undeformed body.
fn polar(points: &[RecordedPoint]) -> Vec<PolarPlace> {
    let closed = || points.iter().filter(|p| p.status != Status::Open);
    let mean = |weight: fn(&RecordedPoint) -> f64, of: fn(&RecordedPoint) -> f64| {
        let sum: f64 = closed().map(weight).sum();
        if sum > 0.0 { closed().map(|p| weight(p) * of(p)).sum::<f64>() / sum } else { 0.0 }
    };
    // Of a half the middle is at y = 0.
    let is_whole = points.iter().any(|p| p.is_of_whole);
    let across = |y: f64| if is_whole { y } else { 0.0 };
    let centre = [mean(|p| p.force[2], |p| p.position[0]), across(mean(|p| p.force[2], |p| p.position[1]))];
    let [x, y] = [mean(|p| p.area, |p| p.reference[0]), across(mean(|p| p.area, |p| p.reference[1]))];
    // A sphere through the origin has z = kappa |x|^2/2 everywhere.
    let (by_square, squares) = points.iter().fold((0.0, 0.0), |(by_square, squares), p| {
        let square: f64 = p.reference.iter().map(|x| x * x).sum();
        (by_square + square * p.reference[2], squares + square * square)
    });
    let middle = [x, y, if squares > 0.0 { by_square / squares * (x * x + y * y) } else { 0.0 }];
    let point = |p: &RecordedPoint| PolarPlace {
        r: (p.position[0] - centre[0]).hypot(p.position[1] - centre[1]),
        s: p.reference.iter().zip(middle).map(|(x, c)| (x - c) * (x - c)).sum::<f64>().sqrt(),
        area: p.area,
        force: p.force[2],
        gap: p.gap,
        closed: p.status != Status::Open,
    };
    points.iter().map(point).collect()
}

/// Where what was at `s` is now: a line through the points near it, which count the more the nearer
/// they are (Cleveland, J. Am. Stat. Assoc. 74, 1979). Of a few points, all stretched alike.
fn present_radius(points: &[PolarPlace], s: f64, spacing: f64) -> f64 {
    let through = |width: f64| {
        let near = points.iter().filter(|p| (p.s - s).abs() < width);
        let weight = |p: &PolarPlace| p.area * (1.0 - ((p.s - s).abs() / width).powi(3)).powi(3);
        Some(line(near.map(|p| (weight(p), p.s - s, p.r)))?.1)
    };
    [NEAR, 2.0 * NEAR, 4.0 * NEAR].into_iter().find_map(|width| through(width * spacing)).unwrap_or_else(|| {
        let (now, then) = points
            .iter()
            .filter(|p| p.closed)
            .fold((0.0, 0.0), |(now, then), p| (now + p.area * p.r * p.s, then + p.area * p.s * p.s));
        if then > 0.0 { s * now / then } else { s }
    })
}

/// Height in the middle and curvature of the surface in contact: the paraboloid z = z_0 + kappa
/// r^2/2 that fits its closed points best, by their areas. `None` for a few points.
pub fn bulge(points: &[RecordedPoint]) -> Option<[f64; 2]> {
    let closed = || points.iter().filter(|p| p.status != Status::Open);
    let force: f64 = closed().map(|p| p.force[2]).sum();
    let centre = if force > 0.0 { closed().map(|p| p.force[2] * p.position[0]).sum::<f64>() / force } else { 0.0 };
    let square = |p: &RecordedPoint| (p.position[0] - centre).powi(2) + p.position[1].powi(2);
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

/// A profile of the pressure, p^m = at_zero + slope s^2.
struct PressureProfile {
    exponent: f64,
    slope: f64,
    at_zero: f64,
}

impl PressureProfile {
    fn pressure(&self, squared: f64) -> f64 {
        (self.at_zero + self.slope * squared).max(0.0).powf(1.0 / self.exponent)
    }

    /// Where it ends by itself.
    fn end(&self) -> f64 {
        if self.slope < 0.0 { (-self.at_zero / self.slope).max(0.0).sqrt() } else { f64::INFINITY }
    }

    /// What it carries between two radii of a sector of this `angle`, pi for half of a disc:
    /// integral angle s p ds, with s^2 the variable.
    fn carried(&self, from: f64, to: f64, angle: f64) -> f64 {
        let (lo, hi) = (from * from, to * to);
        let n = 64;
        let step = (hi - lo) / f64::from(n);
        (0..n).map(|i| self.pressure(lo + (f64::from(i) + 0.5) * step) * step).sum::<f64>() * (0.5 * angle)
    }
}

/// The edge from the pressure, in the undeformed body, where closed points stand for the disc of
/// radius `touching`.
///
/// In a ring inside, p^2 is fitted by a line in s^2, which is exact for Hertz's pressure and for a
/// uniform one. Where the points of the rim carry less than this profile would there, it ends
/// abruptly, so far inside `touching` that it carries as much as they do. Where they carry more, as
/// under friction, which moves the pressure of an elastic contact inwards, it runs out more slowly
/// than Hertz's: with that power of p, less than the second, with which it carries what they do.
fn edge_from_pressure(points: &[PolarPlace], touching: f64, spacing: f64, angle: f64) -> Option<f64> {
    let inside = touching - RIM * spacing;
    let from = (inside - RING * spacing).max(0.0);
    let ring = || points.iter().filter(|p| p.closed && (from..inside).contains(&p.s));
    let fit = |exponent: f64| {
        let pressure = |p: &PolarPlace| (p.force / p.area).max(0.0).powf(exponent);
        let (slope, at_zero) = line(ring().map(|p| (p.area, p.s * p.s, pressure(p))))?;
        Some(PressureProfile { exponent, slope, at_zero })
    };
    let rim = || points.iter().filter(|p| p.closed && p.s >= inside);
    let lacking = |profile: &PressureProfile| rim().map(|p| profile.pressure(p.s * p.s) * p.area - p.force).sum::<f64>();
    let [hertz, least] = EXPONENTS;
    let mut profile = fit(hertz)?;
    let missing = lacking(&profile);
    if missing > 0.0 {
        let cut = |s: f64| profile.carried(s, touching, angle) <= missing;
        return Some(halved(from, profile.end().min(touching), |s| !cut(s)));
    }
    let exponent = halved(least, hertz, |exponent| fit(exponent).is_some_and(|profile| lacking(&profile) > 0.0));
    profile = fit(exponent)?;
    Some(profile.end().min(touching))
}

/// Between `lo`, below which `is_below` holds, and `hi`, above which it does not.
fn halved(mut lo: f64, mut hi: f64, is_below: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..60 {
        let middle = 0.5 * (lo + hi);
        if is_below(middle) { lo = middle } else { hi = middle }
    }
    0.5 * (lo + hi)
}

/// The edge from the gap. It opens as (r - a)^q, with q = 3/2 at an elastic edge (Johnson 1985,
/// section 5.1) and q = 1 where plastic flow has piled the material up; of these the line gap^(1/q)
/// that fits best is taken, with q in steps of 1/20.
fn radius_from_gap(points: &[PolarPlace], touching: f64, spacing: f64) -> Option<f64> {
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

#[cfg(test)]
mod tests;

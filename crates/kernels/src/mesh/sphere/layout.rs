//! How many cells, and how their sizes grow.

use super::butterfly::Butterfly;
use super::spec::SphereSpec;
use crate::mesh::MeshError;

/// Depth of the shell under the pole, in contact radii. Half and twice of this and of the numbers
/// below (of a growth, of what is over 1): `benches/constants`.
pub const SHELL_DEPTH: f64 = 1.4;
/// Growth of the rings' spacing outside the fine zone that the count aims at, up to 16 elements per
/// contact radius.
const RING_GROWTH: f64 = 1.22;
/// Growth of the layers' thickness in the shell that the count aims at.
const LAYER_GROWTH: f64 = 1.14;
/// How square the centre block is, see [`Layout::squareness`].
const SQUARENESS: f64 = 0.70;
/// See [`Layout::spread`] and `benches/limits/ripple.py`.
const SPREAD: f64 = 0.5;
/// Smallest a/R for which a layout is made: that of a sphere ten times as large as the one pressed
/// against it.
const SMALLEST_CONTACT: f64 = 0.000_05;
/// Largest a/R for which a layout is made.
pub const LARGEST_CONTACT: f64 = 0.65;
/// Most elements per contact radius at the surface.
pub const FINEST_SURFACE: usize = 64;
/// Radii of the finely meshed surface that there may be, in contact radii.
pub const FINE_ZONES: std::ops::RangeInclusive<f64> = 1.1..=3.0;
/// Thicknesses of the first layer that there may be, over the elements' width.
pub const FIRST_LAYERS: std::ops::RangeInclusive<f64> = 0.5..=1.5;
/// Largest distance from the axis to which the fine zone may reach.
pub const LARGEST_FINE_RADIUS: f64 = 0.85;

/// Counts and gradings of a sphere's mesh; lengths in the half ball of `geometry`.
#[derive(Clone, Debug)]
pub struct Layout {
    /// The body is a flat, the half ball itself, not a sphere.
    pub flat: bool,
    /// Half the cells across the centre block.
    pub m: usize,
    /// Cells along the index classes.
    pub blocks: Butterfly,
    /// Spacing of the rings in the fine zone: the contact radius over the elements per contact
    /// radius.
    pub spacing: f64,
    /// Mean radii of the rings, from the centre block's half-width (r = 0) to the equator, 2.
    pub radii: Vec<f64>,
    /// Rings up to the end of the fine zone.
    pub fine_rings: usize,
    /// Shares of a depth line at which the layers lie, 0 to 1.
    pub depths: Vec<f64>,
    /// Depth of the shell under the pole.
    pub shell_depth: f64,
    /// How square the centre block is: 1 straight sides, 0 a circle.
    pub squareness: f64,
    /// Rings over which the square turns into the fine zone's rings.
    pub rounding_rings: usize,
    /// Spacings (of the elements inside, where the surface is finer) over which the distances of
    /// one ring's nodes from the pole are spread, evenly from either axis to the diagonal: with
    /// none the nodes would enter a growing contact ring by ring.
    pub spread: f64,
    /// Radial moves of the surface nodes by their number, in the half ball's plane, that make them
    /// touch evenly; none if empty.
    pub shifts: Vec<f64>,
    /// Rings outside the fine zone over which the spread fades away.
    pub fading_rings: usize,
    /// Distance from the axis, on the sphere, to which the fine zone reaches.
    pub fine_radius: f64,
    /// Levels of the skin, 0 none (see `skin`).
    pub skin: usize,
}

/// Distance from the pole in the stereographic projection of a point of the sphere's surface at the
/// distance `rho` from the axis.
pub fn stereographic(rho: f64) -> f64 {
    2.0 * rho / (1.0 + (1.0 - rho * rho).sqrt())
}

/// Even number nearest to `x`, at least 2.
fn nearest_even(x: f64) -> usize {
    2 * ((0.5 * x).round().max(1.0) as usize)
}

/// Growth q at which `count` sizes 1, q, q^2, ... sum to `sum`.
fn growth(count: usize, sum: f64) -> f64 {
    let total = |q: f64| (0..count).rev().fold(0.0, |s, _| 1.0 + q * s);
    let (mut low, mut high) = (0.0, 1.0 + sum);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        // Two numbers without one between them: it stays there.
        if middle == low || middle == high {
            break;
        }
        if total(middle) < sum { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Number of sizes 1, q, q^2, ... for the growth `q` to sum to `sum`.
fn sizes_for(sum: f64, q: f64) -> f64 {
    (1.0 + (q - 1.0) * sum).ln() / q.ln()
}

impl Layout {
    /// The layout of a sphere for a description, its surface nodes not moved yet.
    ///
    /// # Errors
    /// A value out of range.
    pub fn new(spec: &SphereSpec) -> Result<Layout, MeshError> {
        Self::of(spec, false)
    }

    /// The layout of a sphere or a flat, its surface nodes not moved yet.
    ///
    /// # Errors
    /// A value out of range.
    pub fn of(spec: &SphereSpec, flat: bool) -> Result<Layout, MeshError> {
        let projected = |rho: f64| if flat { rho } else { stereographic(rho) };
        let &SphereSpec { contact_radius, elements_per_contact_radius: count, fine_zone, .. } = spec;
        if !(SMALLEST_CONTACT..=LARGEST_CONTACT).contains(&contact_radius) {
            return Err(MeshError::ContactRadius(contact_radius));
        }
        if !(2..=32).contains(&count) {
            return Err(MeshError::ElementsPerContactRadius(count));
        }
        if !FINE_ZONES.contains(&fine_zone) {
            return Err(MeshError::FineZone(fine_zone));
        }
        if !FIRST_LAYERS.contains(&spec.first_layer) {
            return Err(MeshError::FirstLayer(spec.first_layer));
        }
        if count.checked_shl(spec.skin_levels as u32).is_none_or(|finest| finest > FINEST_SURFACE) {
            return Err(MeshError::SkinLevels(spec.skin_levels));
        }
        let spacing = projected(contact_radius) / count as f64;
        let fine_radius = (fine_zone * contact_radius).min(LARGEST_FINE_RADIUS);
        let m = nearest_even(0.5 * count as f64);
        let fine_rings = (projected(fine_radius) / spacing - 1e-9).ceil() as usize - m;
        let fine_end = (m + fine_rings) as f64 * spacing;

        let remaining = (2.0 - fine_end) / spacing;
        // Finer meshes are finer outside too, though not in proportion: the far field matters
        // little.
        let wanted = sizes_for(remaining, RING_GROWTH.powf((16.0 / count as f64).sqrt().min(1.0)));
        let nr = nearest_even(fine_rings as f64 + wanted).max(nearest_even(fine_rings as f64 + 2.0));
        let outer = nr - fine_rings;
        // The first ring outside has already grown once.
        let q = growth(outer + 1, remaining + 1.0);
        let mut radii: Vec<f64> = (0..=fine_rings).map(|r| (m + r) as f64 * spacing).collect();
        let mut size = spacing;
        for _ in 0..outer {
            size *= q;
            radii.push(radii[radii.len() - 1] + size);
        }
        radii[nr] = 2.0;

        let shell_depth = SHELL_DEPTH * projected(contact_radius);
        let layers = shell_depth / (spec.first_layer * spacing);
        let nd = nearest_even(sizes_for(layers, LAYER_GROWTH));
        let q = growth(nd, layers);
        let mut depths = vec![0.0];
        let mut size = 1.0 / layers;
        for d in 0..nd {
            depths.push(depths[d] + size);
            size *= q;
        }
        depths[nd] = 1.0;

        Ok(Layout {
            flat,
            m,
            blocks: Butterfly { nx: 2 * m, ny: m, nr, nd, half: false },
            spacing,
            radii,
            fine_rings,
            depths,
            shell_depth,
            squareness: SQUARENESS,
            rounding_rings: (m / 2).max(1),
            spread: SPREAD,
            shifts: Vec::new(),
            fading_rings: outer.div_ceil(2),
            fine_radius,
            skin: spec.skin_levels,
        })
    }

    /// The layout with every cell halved in all directions, its lines kept.
    pub fn halved(&self) -> Self {
        let between = |x: &[f64]| -> Vec<f64> {
            let mut fine: Vec<f64> = x.windows(2).flat_map(|w| [w[0], 0.5 * (w[0] + w[1])]).collect();
            fine.extend(x.last());
            fine
        };
        Self {
            m: 2 * self.m,
            blocks: self.blocks.halved(1),
            spacing: 0.5 * self.spacing,
            spread: 2.0 * self.spread,
            fine_rings: 2 * self.fine_rings,
            rounding_rings: 2 * self.rounding_rings,
            fading_rings: 2 * self.fading_rings,
            radii: between(&self.radii),
            depths: between(&self.depths),
            shifts: Vec::new(),
            ..*self
        }
    }
}

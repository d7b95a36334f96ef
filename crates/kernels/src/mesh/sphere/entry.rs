//! Where the surface's nodes lie so that they come into contact evenly.
//!
//! A point carries the pressure of its tributary area, and it does so from the moment it touches:
//! the force of a growing contact rises in steps wherever many points touch at once, or where none
//! does for a while. Regular meshes do both; counted in points, a square grid has the ripple of
//! Gauss's circle problem. So the points are moved along their radii until each touches when the
//! area inside its circle is that of all points before it and half its own: the area in contact
//! then follows a growing circle to within half a point. The moves are at most a spacing, the lines
//! of the mesh stay smooth.

use super::butterfly::{BOTTOM, SIDE};
use super::geometry::Geometry;
use super::layout::{Layout, SHELL_DEPTH};
use crate::mesh::connectivity::face_areas;
use crate::mesh::hierarchy::{Blocks, Site};

/// Rounds of relaxation, and the share of the way that each goes: areas change with the positions.
/// Half and twice of these and of the numbers below: `benches/constants`.
const ROUNDS: usize = 60;
const RELAXATION: f64 = 0.3;
/// Contact radii to which points touch evenly, if the fine zone reaches so far.
const REACH: f64 = 1.5;
/// Spacings beyond over which the moves fade away.
const FADING: f64 = 3.0;
/// Radii closer than this, in spacings, count as equal: which of two such points comes first is
/// then the place's on the mesh to say, not rounding's.
const TIE: f64 = 1e-6;

impl Layout {
    /// The layout with its surface nodes moved so that they touch evenly.
    pub fn touching_evenly(mut self) -> Self {
        self.shifts = even_entry(&self);
        self
    }
}

/// Radial moves of the surface's nodes in the half ball's plane, by their number (surface nodes
/// come first); `layout` without moves.
fn even_entry(layout: &Layout) -> Vec<f64> {
    let blocks = layout.blocks;
    let geometry = Geometry::new(layout);
    let sites: Vec<Site> =
        blocks.sites().into_iter().take_while(|s| s.at[2] == 0 && (s.block == BOTTOM || s.block == SIDE)).collect();
    let mut position: Vec<[f64; 3]> = sites.iter().map(|&s| geometry.on_surface(s)).collect();
    let start: Vec<f64> = position.iter().map(|x| x[0].hypot(x[1])).collect();
    let direction: Vec<[f64; 2]> =
        position.iter().zip(&start).map(|(x, r)| if *r > 0.0 { [x[0] / r, x[1] / r] } else { [0.0; 2] }).collect();
    let mirrored: Vec<usize> = sites.iter().map(|&s| blocks.number(blocks.mirrored(s)) as usize).collect();
    let faces = blocks.surface_faces(blocks.nr);
    let even_end = layout.radii[layout.fine_rings].min(REACH * layout.shell_depth / SHELL_DEPTH);
    // Images in the diagonal touch one after the other, by turns the one near x and the one near y
    // first, along each ring and from ring to ring: neither axis has more of the early ones.
    let place: Vec<[usize; 2]> = sites.iter().map(|&s| blocks.on_ring(s)).collect();
    let turn = |n: usize| if (place[n][0] + place[n][1]).is_multiple_of(2) { -direction[n][0] } else { direction[n][0] };
    let mut radius = start.clone();
    // One of each mirrored pair; a pair touches at once.
    let mut order: Vec<usize> = (0..sites.len()).filter(|&n| !blocks.is_left(sites[n])).collect();
    for _ in 0..ROUNDS {
        let mut area = vec![0.0; sites.len()];
        for face in &faces {
            let shares = face_areas(face.map(|n| position[n as usize]));
            face.iter().zip(shares).for_each(|(&n, share)| area[n as usize] += share);
        }
        let rank = |n: usize| (radius[n] / (TIE * layout.spacing)).round();
        order.sort_by(|&a, &b| {
            let tie = || place[a].cmp(&place[b]).then(turn(a).total_cmp(&turn(b)));
            rank(a).total_cmp(&rank(b)).then_with(tie)
        });
        let mut inside = 0.0;
        let mut moved = radius.clone();
        for &n in &order {
            let own = if mirrored[n] == n { area[n] } else { 2.0 * area[n] };
            // Half a circle of this radius has the area of the points inside and half of this
            // one's.
            let even = ((2.0 * inside + own) / std::f64::consts::PI).sqrt();
            let share = (1.0 - (radius[n] - even_end) / (FADING * layout.spacing)).clamp(0.0, 1.0);
            if radius[n] > 0.0 {
                let to = radius[n] + RELAXATION * share * (even - radius[n]);
                moved[n] = to.clamp(start[n] - layout.spacing, start[n] + layout.spacing);
            }
            inside += own;
        }
        for &n in &order {
            radius[n] = moved[n];
            radius[mirrored[n]] = moved[n];
        }
        for ((x, r), d) in position.iter_mut().zip(&radius).zip(&direction) {
            *x = [r * d[0], r * d[1], 0.0];
        }
    }
    radius.iter().zip(&start).map(|(r, s)| r - s).collect()
}

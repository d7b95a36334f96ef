//! Where the butterfly's nodes lie.
//!
//! The half ball |X| <= 2, Z >= 0 is mapped onto the lower hemisphere by the inversion that takes
//! the plane Z = 0 to the sphere's surface, the half sphere |X| = 2 to the equator plane and the
//! origin to the pole, where its scale is one. Inversions are conformal, so the mesh is laid out in
//! the half ball, where the contact surface is a plane: what is orthogonal there stays orthogonal
//! here. With N = 1 + kappa Z + kappa^2 |X|^2/4 and the body's curvature kappa = 1,
//!
//!   x = X/N,   y = Y/N,   z = (Z + kappa |X|^2/2)/N;
//!
//! on Z = 0 this is the stereographic projection, |X| = 2 tan(theta/2). With kappa = 0 it is the
//! half ball itself: a flat, whose plate is the half sphere |X| = 2.

use super::butterfly::{BOTTOM, Butterfly, CORE, SIDE};
use super::layout::Layout;
use crate::mesh::hierarchy::{Blocks, Site};
use std::f64::consts::FRAC_PI_4;

/// Polar angle of the core's wall far from the pole. Half and twice of this and of the numbers
/// below: `benches/constants`.
const WALL_ANGLE: f64 = 0.62;
/// Inclination of the depth lines where they meet the core: at the rim of its floor, and far from
/// the pole.
const RIM_INCLINATION: f64 = 0.38;
const WALL_INCLINATION: f64 = 1.15;
/// Length of a depth line's tangent at the surface over its chord, where the shell is not deeper.
const START_LENGTH: f64 = 0.9;

/// Smooth step from 0 (x <= 0) to 1 (x >= 1).
pub fn smooth_step(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

/// Polar position of a surface node in the half ball's plane Z = 0: distance from the pole and
/// angle in the octant.
#[derive(Clone, Copy, Debug)]
struct Polar {
    radius: f64,
    angle: f64,
}

/// The geometry of one layout.
pub struct Geometry<'a> {
    layout: &'a Layout,
    blocks: Butterfly,
    /// Depth and half-width of the core's floor, its rim's distance from the pole and polar angle.
    floor_depth: f64,
    rim_distance: f64,
    rim_angle: f64,
}

impl<'a> Geometry<'a> {
    /// The geometry of `layout`.
    pub fn new(layout: &'a Layout) -> Self {
        // The core's floor is as wide as the surface's centre block.
        let (floor_depth, floor_width) = (layout.shell_depth, layout.radii[0]);
        Geometry {
            layout,
            blocks: layout.blocks,
            floor_depth,
            rim_distance: floor_depth.hypot(floor_width),
            rim_angle: floor_width.atan2(floor_depth),
        }
    }

    /// Position of a node on the sphere.
    pub fn position(&self, site: Site) -> [f64; 3] {
        if self.blocks.is_left(site) {
            let [x, y, z] = self.position(self.blocks.mirrored(site));
            return [-x, y, z];
        }
        let [x, y, z] = self.in_half_ball(site);
        if self.layout.flat {
            return [x, y, z];
        }
        let square = x * x + y * y + z * z;
        let n = 1.0 + z + 0.25 * square;
        [x / n, y / n, if self.is_on_plate(site) { 1.0 } else { (z + 0.5 * square) / n }]
    }

    /// Whether a node lies on the half sphere |X| = 2, which moves as the rigid plate: the sphere's
    /// equator.
    pub fn is_on_plate(&self, site: Site) -> bool {
        site.block != BOTTOM && site.at[if site.block == SIDE { 1 } else { 2 }] == self.blocks.nr
    }

    /// Position of a node with x >= 0 in the half ball.
    fn in_half_ball(&self, site: Site) -> [f64; 3] {
        // In the octant 0 <= y <= x; `swap` mirrors at the diagonal, and keeps y = 0 and x = 0
        // exact.
        let m = self.layout.m;
        let [a, b, c] = site.at;
        let (big, small, swap) = match site.block {
            SIDE => {
                let along = if a <= m { a } else { 2 * m - a };
                (m, along, a > m)
            }
            _ => {
                let right = a - m;
                (right.max(b), right.min(b), b > right)
            }
        };
        let t = if big == 0 { 0.0 } else { small as f64 / big as f64 };
        let shift = self.shift(site);
        let (angle, [across, up]) = match site.block {
            BOTTOM => self.bottom(big, t, c, shift),
            SIDE => self.side(t, b, c, shift),
            CORE => self.core(big, t, c),
            _ => (0.0, [0.0; 2]),
        };
        let (far, near) = if small == 0 {
            (across, 0.0)
        } else if small == big {
            (across * std::f64::consts::FRAC_1_SQRT_2, across * std::f64::consts::FRAC_1_SQRT_2)
        } else {
            (across * angle.cos(), across * angle.sin())
        };
        if swap { [near, far, up] } else { [far, near, up] }
    }

    /// How square the centre block's lines are, from 1 at the centre to the layout's squareness at
    /// its perimeter.
    fn squareness(&self, share: f64) -> f64 {
        1.0 - (1.0 - self.layout.squareness) * share * share
    }

    /// The centre block's shape at the share `share` of its half-width: relative radius and angle.
    fn centre_shape(&self, share: f64, t: f64) -> Polar {
        let angle = t.atan();
        Polar { radius: share * (1.0 + self.squareness(share) * (1.0 / angle.cos() - 1.0)), angle }
    }

    /// Ring `r` on the surface: radius and angle.
    fn ring(&self, r: usize, t: f64) -> Polar {
        let l = self.layout;
        let turn = smooth_step(r as f64 / l.rounding_rings as f64);
        let square = t.atan();
        let angle = square + turn * (t * FRAC_PI_4 - square);
        let square_offset = l.squareness * (1.0 / square.cos() - 1.0);
        let fade = 1.0 - smooth_step((r as f64 - l.fine_rings as f64) / l.fading_rings as f64);
        // Even from either axis to the diagonal, so that the contact's edge meets the phases of the
        // ring spacing equally often, and alike on both sides of the diagonal.
        let spread = l.spread * t * l.spacing * fade;
        let radius = l.radii[r] + (1.0 - turn) * l.radii[r] * square_offset + turn * spread;
        Polar { radius: if r == l.blocks.nr { 2.0 } else { radius }, angle }
    }

    /// Distance of the core's wall from the pole at ring `r`, and its polar angle.
    fn wall(&self, r: usize) -> (f64, f64) {
        let (first, radius) = (self.layout.radii[0], self.layout.radii[r]);
        let distance = radius + (self.rim_distance - first) * (2.0 - radius) / (2.0 - first);
        let angle = WALL_ANGLE - (WALL_ANGLE - self.rim_angle) * self.rim_distance / distance;
        (distance, angle)
    }

    /// A point of the core at level `r` of its wall: angle around the axis, distance from the axis
    /// and height.
    fn core(&self, big: usize, t: f64, r: usize) -> (f64, [f64; 2]) {
        let share = big as f64 / self.layout.m as f64;
        let turn = smooth_step(r as f64 / self.layout.rounding_rings as f64) * share * share;
        let shape = self.centre_shape(share, t);
        let angle = shape.angle + turn * (t * FRAC_PI_4 - shape.angle);
        let (distance, wall_angle) = self.wall(r);
        // The floor is flat, the lid a sphere about the pole.
        let bulge = (1.0 - self.rim_distance / distance) / (1.0 - 0.5 * self.rim_distance);
        let polar = wall_angle * shape.radius;
        let floor = wall_angle.cos();
        (angle, [distance * polar.sin(), distance * (floor + bulge * (polar.cos() - floor))])
    }

    /// A point on a depth line from the surface to the core: a cubic of Hermite in the half plane
    /// of its angle.
    fn depth_line(&self, surface: Polar, end: (f64, [f64; 2]), start_length: f64, inclination: f64, d: usize) -> (f64, [f64; 2]) {
        let s = self.layout.depths[d];
        let (end_angle, end) = end;
        let chord = (end[0] - surface.radius).hypot(end[1]);
        let (h00, h01) = ((1.0 + 2.0 * s) * (1.0 - s) * (1.0 - s), s * s * (3.0 - 2.0 * s));
        let (h10, h11) = (s * (1.0 - s) * (1.0 - s), s * s * (s - 1.0));
        let across = h00 * surface.radius + h01 * end[0] - h11 * chord * inclination.sin();
        let up = h10 * start_length + h01 * end[1] + h11 * chord * inclination.cos();
        (surface.angle + h01 * (end_angle - surface.angle), [across, up])
    }

    /// Radial move of the surface node above a node of the shell.
    fn shift(&self, site: Site) -> f64 {
        let [a, b, _] = site.at;
        match site.block {
            CORE => 0.0,
            block => self.layout.shifts.get(self.blocks.number(Site { block, at: [a, b, 0] }) as usize).copied().unwrap_or(0.0),
        }
    }

    /// Position of a surface node in the half ball's plane Z = 0.
    pub fn on_surface(&self, site: Site) -> [f64; 3] {
        if self.blocks.is_left(site) {
            let [x, y, z] = self.in_half_ball(self.blocks.mirrored(site));
            return [-x, y, z];
        }
        self.in_half_ball(site)
    }

    /// A point of the shell's centre.
    fn bottom(&self, big: usize, t: f64, d: usize, shift: f64) -> (f64, [f64; 2]) {
        let share = big as f64 / self.layout.m as f64;
        let shape = self.centre_shape(share, t);
        let surface = Polar { radius: self.layout.radii[0] * shape.radius + shift, angle: shape.angle };
        let end = self.core(big, t, 0);
        self.depth_line(surface, end, self.floor_depth, RIM_INCLINATION * shape.radius * shape.radius, d)
    }

    /// A point of the shell's rings.
    fn side(&self, t: f64, r: usize, d: usize, shift: f64) -> (f64, [f64; 2]) {
        if r == 0 {
            return self.bottom(self.layout.m, t, d, shift);
        }
        let mut surface = self.ring(r, t);
        surface.radius += shift;
        let end = self.core(self.layout.m, t, r);
        if r == self.layout.blocks.nr {
            return self.equator_line(surface, end, d);
        }
        let (distance, _) = self.wall(r);
        let corner = self.layout.squareness * (1.0 / t.atan().cos() - 1.0);
        let near = (self.rim_distance / distance).powi(2) * (1.0 + corner).powi(2);
        let inclination = WALL_INCLINATION + (RIM_INCLINATION * (1.0 + corner).powi(2) - WALL_INCLINATION) * near.min(1.0);
        let chord = (end.1[0] - surface.radius).hypot(end.1[1]);
        self.depth_line(surface, end, self.floor_depth.max(START_LENGTH * chord), inclination, d)
    }

    /// A point on the equator, the half sphere |X| = 2: along its meridian.
    fn equator_line(&self, surface: Polar, end: (f64, [f64; 2]), d: usize) -> (f64, [f64; 2]) {
        let s = self.layout.depths[d];
        let from_plane = s * end.1[1].atan2(end.1[0]);
        let angle = surface.angle + s * s * (3.0 - 2.0 * s) * (end.0 - surface.angle);
        (angle, [2.0 * from_plane.cos(), 2.0 * from_plane.sin()])
    }
}

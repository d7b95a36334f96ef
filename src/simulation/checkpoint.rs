//! Where a run stands between two attempts at a step: all that the next one depends on, and nothing
//! else.
//!
//! A step is a function of the committed state and its target alone, so a run that is put back to
//! such a place goes on with the same bits. What the solver keeps between steps besides (matrices,
//! factors, the last trial) is formed anew in each and is not here.

use serde::{Deserialize, Serialize};

use super::SimulationError;
use super::equator::FreeEquator;
use super::path::{SegmentStart, Target, way_length};
use super::record::{RecordedPoint, StepRecord};
use crate::compute::CaseState;
use crate::contact::coulomb::Status;
use crate::mesh::Mesh;
use crate::solver::opponent::Opponent;
use crate::solver::pose::{MODES, Pose, product, rotation};

/// Greatest number that a state may have, which is scaled: displacements are over R, forces over E
/// R^2.
const LARGEST: f64 = 1e9;
/// Most of what is counted along a path.
const MOST_COUNTED: usize = 1_000_000_000;
/// Targets are taken in 2^2 parts at most. Half and twice of the exponent: `benches/constants`.
pub(super) const FINEST: u32 = 2;

/// The committed state of the drive, scaled.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Committed {
    pub u: Vec<f64>,
    /// Displacement one accepted step before, for extrapolation.
    pub u_before: Vec<f64>,
    /// Where the plate stands, and stood one accepted step before, at which indentation.
    pub pose: Pose,
    pub pose_before: Pose,
    pub h_before: f64,
    /// How far a free equator is to have widened at the end of the next step.
    pub stretch: [f64; MODES],
    /// What is known of how it widens; none of a clamped one.
    pub equator: Option<FreeEquator>,
    /// How far the centre has moved with what the sphere has rolled.
    pub travel: [f64; 2],
    /// What the last step of the present segment moved, `None` if there is none.
    pub last_increment: Option<Increment>,
    /// Length of the last step as [`Committed::length_to`] measures it.
    pub last_length: f64,
    pub force: Vec<f64>,
    /// What each contact node does; `points` follows from it.
    pub statuses: Vec<Status>,
    /// Gap at each contact node.
    pub gaps: Vec<f64>,
    #[serde(skip)]
    pub points: Vec<RecordedPoint>,
    pub record: StepRecord,
    pub h_max: f64,
    /// Longest elastic recovery of any state so far.
    pub longest_recovery: f64,
    /// Direction of the last shear along x, 0 before the first that is not even in x.
    pub direction: f64,
    /// Direction of the last shear along x and y and about z (see
    /// [`super::drive::Drive::way_of`]).
    pub way: [f64; 3],
    /// Moment of the plate about the sphere's centre.
    pub moment: [f64; 3],
}

/// What a step has moved.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Increment {
    pub h: f64,
    /// delta_T along x and y.
    pub along: [f64; 2],
    /// Roll about x and y and twist, in rad.
    pub turned: [f64; 3],
}

impl Committed {
    /// The undeformed state.
    pub fn virgin(mesh: &Mesh, opponent: &dyn Opponent) -> Self {
        let zero = vec![0.0; 3 * mesh.nodes.len()];
        let statuses = vec![Status::Open; mesh.contact_nodes.len()];
        let gaps = mesh.contact_nodes.iter().map(|&n| opponent.first_gap(&mesh.nodes[n as usize])).collect();
        let mut state = Self { u: zero.clone(), u_before: zero.clone(), force: zero, statuses, gaps, ..Self::default() };
        state.place_points(mesh);
        state
    }

    /// Up to the first shear all is even in x.
    pub fn is_even(&self) -> bool {
        self.direction == 0.0
    }

    /// Length of a step to a target in the measure in which plastic flow goes on evenly: the
    /// contact radius grows as sqrt(h) under pressing, and what moves along and about the surface
    /// is measured by itself.
    pub fn length_to(&self, target: &Target) -> f64 {
        let radius = |h: f64| h.max(0.0).sqrt();
        let (along, turned) = self.way_to(target);
        (radius(target.h) - radius(self.record.h)).abs() + way_length((along, turned), self.record.a)
    }

    /// What a step to a target moves along x and y, and turns.
    pub fn way_to(&self, target: &Target) -> ([f64; 2], [f64; 3]) {
        let (r, angles) = (&self.record, self.record.angles());
        let turned = std::array::from_fn(|i| target.angles[i] - angles[i]);
        ([target.delta_t - r.delta_t, target.across - r.delta_t_y], turned)
    }

    /// Where the plate stands at a target. As the sphere turns, its centre moves so that delta_T,
    /// the displacement of the surfaces, stays as it is: by (R - h) times the angle of a roll.
    pub fn pose_at(&self, target: &Target) -> Pose {
        let [x, y] = self.travel_to(target);
        let (_, turned) = self.way_to(target);
        let turn = match (self.pose.turn, turned == [0.0; 3]) {
            (turn, true) => turn,
            (None, false) => Some(rotation(turned)),
            (Some(turn), false) => Some(product(&rotation(turned), &turn)),
        };
        Pose { shift: [target.delta_t + x, target.across + y], turn, stretch: self.stretch }
    }

    /// How far the centre has moved at a target with what the sphere has rolled.
    pub fn travel_to(&self, target: &Target) -> [f64; 2] {
        let (_, [about_x, about_y, _]) = self.way_to(target);
        let arm = 1.0 - 0.5 * (self.record.h + target.h);
        [self.travel[0] + arm * about_y, self.travel[1] - arm * about_x]
    }

    /// The direction of a path that goes on without a component along x.
    pub fn odd_direction(&self) -> f64 {
        if self.direction != 0.0 { self.direction } else { 1.0 }
    }

    /// Distance from the axis to the outermost closed point, in the undeformed body; zero without
    /// contact.
    pub fn reach(&self) -> f64 {
        let closed = self.points.iter().filter(|p| p.status != Status::Open);
        closed.map(|p| p.reference[0].hypot(p.reference[1])).fold(0.0, f64::max)
    }

    /// Forms the contact points from displacement, force and status. On the symmetry plane the
    /// internal force along y is left out: it balances the other half of the body, not the plane.
    pub fn place_points(&mut self, mesh: &Mesh) {
        let Self { u, force, statuses, gaps, points, .. } = self;
        let point = |(i, (&node, &status)): (usize, (&u32, &Status))| {
            let (base, x) = (3 * node as usize, mesh.nodes[node as usize]);
            let on_symmetry_plane = mesh.is_on_symmetry_plane(node);
            let exerted = [force[base], if on_symmetry_plane { 0.0 } else { force[base + 1] }, force[base + 2]];
            RecordedPoint {
                node: node as usize,
                reference: x,
                position: [x[0] + u[base], x[1] + u[base + 1], x[2] + u[base + 2]],
                force: exerted,
                gap: gaps[i],
                area: mesh.contact_area[i],
                on_symmetry_plane,
                is_of_whole: mesh.copies == 1,
                status,
            }
        };
        *points = mesh.contact_nodes.iter().zip(&*statuses).enumerate().map(point).collect();
    }
}

/// How far the path has been followed.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct PathPosition {
    /// The undeformed state has been shown.
    pub begun: bool,
    /// The segment that is followed; their number once all are behind.
    pub segment: usize,
    /// The state at its start, `None` before it.
    pub start: Option<SegmentStart>,
    /// Targets of the segment that are reached.
    pub reached: usize,
    /// The next target has been set out for. Its parts that are still to be reached are `waiting`,
    /// the next one last.
    pub under_way: bool,
    pub waiting: Vec<Target>,
    /// F_T along x and y when it was set out for.
    pub force_before: [f64; 2],
    /// Tangential stiffness at the start of the shear, until its first step is recorded.
    pub stiffness: Option<f64>,
    /// Normal force of the meshed part that a segment holds: what there was before the first of
    /// those that hold it one after the other. What each of them misses of it does not add up so.
    pub held_force: Option<f64>,
    /// Iterations of failed attempts and bisections since the last accepted step.
    pub wasted: usize,
    pub cutbacks: usize,
    /// Bisections that are not made up for by accepted steps.
    pub depth: usize,
    /// Targets are taken in 2^pace parts.
    pub pace: u32,
    /// The observer knows of a relaxed step in this segment.
    pub relaxed_told: bool,
}

impl PathPosition {
    /// Nothing of the segment has been done.
    pub fn is_at_segment_start(&self) -> bool {
        self.reached == 0 && !self.under_way
    }

    /// At the start of the next segment.
    pub fn next_segment(&self) -> Self {
        let Self { begun, pace, held_force, .. } = *self;
        Self { begun, segment: self.segment + 1, pace, held_force, ..Self::default() }
    }
}

/// A copy of everything on which the rest of a run depends; [`super::drive::Drive::resume`] goes on
/// from it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Snapshot {
    pub(super) state: Committed,
    pub(super) place: PathPosition,
    /// Force scales of the last accepted step and of all (see
    /// [`crate::solver::newton::Newton::force_scales`]).
    pub(super) force_scales: [f64; 2],
    pub(super) case: CaseState,
}

impl Snapshot {
    /// Number of the last accepted step.
    pub fn step(&self) -> usize {
        self.state.record.step
    }

    /// Why no run can have been in this state, in words. [`check`](Self::check) compares it with a
    /// mesh.
    pub fn flaw(&self) -> Option<String> {
        let Self { state, place, force_scales, case } = self;
        let sound = |value: &f64| value.abs() <= LARGEST;
        let start = place.start.iter().flat_map(|start| {
            // Under full stick the coefficient of friction is infinite, and it may be any number.
            let friction = if start.friction > 0.0 { 0.0 } else { start.friction };
            let [own, both] = start.compliance;
            let [about_x, about_y, twist] = start.angles;
            [start.h, start.h_max, start.delta_t, start.across, start.f_n, start.a, friction, start.nu, own, both]
                .into_iter()
                .chain([about_x, about_y, twist])
        });
        let targets = place.waiting.iter().flat_map(|target| {
            let Target { h, delta_t, across, angles: [about_x, about_y, twist], .. } = *target;
            [h, delta_t, across, about_x, about_y, twist]
        });
        let points = case.points.iter().flatten().flat_map(|point| point.be.iter().chain([&point.alpha]));
        let flow = case.flow.iter().flatten().flat_map(|flow| flow.strain.iter().chain([&flow.alpha]));
        let record = [state.record.h, state.record.delta_t, state.record.f_n, state.record.f_t, state.record.a];
        let record = record.into_iter().chain([state.record.delta_t_y]).chain(state.record.angles());
        let single = [state.last_length, state.h_max, state.direction, state.h_before];
        let poses = [state.pose, state.pose_before];
        let poses =
            poses.iter().flat_map(|pose| pose.shift.iter().chain(pose.turn.iter().flatten().flatten()).chain(&pose.stretch));
        let widening = state.stretch.iter().chain(state.equator.iter().flat_map(FreeEquator::numbers));
        let vectors =
            place.force_before.iter().chain(&state.travel).chain(&state.way).chain(&state.moment).chain(poses).chain(widening);
        let single = single.into_iter().chain(vectors.copied());
        let wrong = |what: &str| Some(format!("{what} beyond {LARGEST:e}, or none"));
        if !state.u.iter().chain(&state.u_before).chain(&case.displacement).chain(&state.gaps).all(sound) {
            return wrong("a displacement or a gap");
        }
        if !state.force.iter().chain(force_scales).all(sound) || !points.chain(flow).chain(&case.plastic_work).all(sound) {
            return wrong("a force, a strain or a work");
        }
        let last = state.last_increment.iter().flat_map(|last| last.along.iter().chain(&last.turned).chain([&last.h]));
        let increment = last.chain(&place.stiffness).chain(&place.held_force).copied();
        if !start.chain(targets).chain(record).chain(single).chain(increment).all(|value| sound(&value)) {
            return wrong("a number of its place on the path");
        }
        let PathPosition { segment, reached, wasted, cutbacks, depth, pace, .. } = *place;
        let counts = [segment, reached, wasted, cutbacks, depth, state.record.step, place.waiting.len()];
        let most = counts.into_iter().max().unwrap_or(0);
        if most > MOST_COUNTED || pace > FINEST {
            return Some(format!("a count of {} on its path", most.max(pace as usize)));
        }
        None
    }

    /// Whether this is a state of a body with that mesh.
    ///
    /// # Errors
    /// [`SimulationError::Snapshot`] with the sizes that differ.
    pub fn check(&self, mesh: &Mesh) -> Result<(), SimulationError> {
        let Self { state, case, .. } = self;
        let (unknowns, elements) = (3 * mesh.nodes.len(), mesh.elements.len());
        for (what, found, expected) in [
            ("displacements", state.u.len(), unknowns),
            ("earlier displacements", state.u_before.len(), unknowns),
            ("forces", state.force.len(), unknowns),
            ("committed displacements", case.displacement.len(), unknowns),
            ("contact points", state.statuses.len(), mesh.contact_nodes.len()),
            ("gaps", state.gaps.len(), mesh.contact_nodes.len()),
            ("elements", case.points.len(), elements),
            ("elements with a last flow", case.flow.len(), elements),
            ("elements with plastic work", case.plastic_work.len(), elements),
        ] {
            if found != expected {
                return Err(SimulationError::Snapshot { what, found, expected });
            }
        }
        Ok(())
    }
}

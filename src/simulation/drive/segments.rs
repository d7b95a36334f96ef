//! The segments of a path, each as a sequence of targets.

use std::f64::consts::PI;

use super::{Drive, Ending, Observer};
use crate::case::{Hold, ShearTarget};
use crate::compute::handle::CaseHandle;
use crate::contact::coulomb::{Friction, Status};
use crate::simulation::SimulationError;
use crate::simulation::path::{SegmentStart, ShearSteps, Target};
use crate::simulation::record::StepRecord;
use crate::solver::iterate::stiffness::SetOff;

/// Full slip: the sticking points carry no more than this share of the normal force. Half and twice
/// of it: `benches/constants`.
const STICK_SHARE: f64 = 2e-3;
/// A release to a share of F_N asks for the force itself when so many steps are left by the
/// contact's stiffness, which the simulated one exceeds by a fifth at most. Half and twice of it:
/// `benches/constants`.
const LANDING: f64 = 1.25;
/// F_T has stopped rising when it grows by less than this share over a step. Half and twice of it:
/// `benches/constants`.
const PLATEAU: f64 = 1e-3;
/// Strains by which it is tried what flows at the start of a shear, over the mean pressure's: so
/// much of the yield strain, about. At ten times as much an ideally plastic contact is 0.08 %
/// softer, at a tenth the rounding of f32 is seen. Half and twice of it: `benches/constants`.
const STIFFNESS_PROBE: f64 = 1e-4;

impl Drive<'_> {
    /// Reaches the targets of a segment one after the other.
    pub(super) fn reach(&mut self, targets: &[Target], observer: &mut dyn Observer) -> Result<Ending, SimulationError> {
        while let Some(target) = targets.get(self.place.reached) {
            let ending = self.advance(target, observer)?;
            if ending != Ending::Done {
                return Ok(ending);
            }
        }
        Ok(Ending::Done)
    }

    /// Withdraws the plate until nothing touches; the steps shorten as the contact shrinks, so that
    /// the residual indentation is sharp.
    pub(super) fn release(&mut self, start: &SegmentStart, observer: &mut dyn Observer) -> Result<Ending, SimulationError> {
        let step = self.resolution().release_step(start);
        if self.place.is_at_segment_start() && (self.state.record.contact_points == 0 || step <= 0.0) {
            observer.note("release: nothing touches, so there is nothing to release");
            return Ok(Ending::Done);
        }
        while self.place.under_way || self.state.record.contact_points > 0 {
            let f = (self.state.record.f_n / start.f_n).clamp(0.0, 1.0);
            let h = self.state.record.h - step * (0.2 + 0.8 * f.sqrt());
            let target = Target { h, extrapolate: false, ..start.place() };
            let ending = self.advance(&target, observer)?;
            if ending != Ending::Done {
                return Ok(ending);
            }
        }
        Ok(Ending::Done)
    }

    /// Withdraws the plate until F_N has fallen to a share of what it was: in steps up to the last
    /// one, which asks for the force itself.
    pub(super) fn release_to(
        &mut self,
        start: &SegmentStart,
        share: f64,
        observer: &mut dyn Observer,
    ) -> Result<Ending, SimulationError> {
        let wanted = share * start.f_n;
        let step = self.resolution().release_step(start);
        if self.place.is_at_segment_start() && (self.state.record.contact_points == 0 || step <= 0.0) {
            observer.note("release: nothing touches, so there is nothing to release");
            return Ok(Ending::Done);
        }
        self.held_force = Some(wanted / self.mesh.copies as f64);
        // A force that is asked for is met to 5e-5.
        while self.place.under_way || self.state.record.f_n > wanted * (1.0 + 1e-4) {
            let StepRecord { h, a, f_n, .. } = self.state.record;
            let rest = (f_n - wanted) / start.unloading_stiffness(a.max(1e-12));
            let hold_force = rest <= LANDING * step;
            let h = h - if hold_force { rest } else { step };
            let target = Target { h, hold_force, extrapolate: false, ..start.place() };
            let ending = self.advance(&target, observer)?;
            if ending != Ending::Done {
                self.held_force = None;
                return Ok(ending);
            }
        }
        self.held_force = None;
        Ok(Ending::Done)
    }

    /// Shears along x to a displacement, or in any direction, a unit vector, to full slip.
    /// Says whether the segment holds the normal force: that which the one before held, or else
    /// what there is.
    pub(super) fn set_held_force(&mut self, start: &SegmentStart, is_held: bool) {
        self.held_force = is_held.then(|| self.place.held_force.unwrap_or(start.f_n / self.mesh.copies as f64));
        self.place.held_force = self.held_force;
    }

    pub(super) fn shear(
        &mut self,
        start: &SegmentStart,
        shear: ShearTarget,
        direction: [f64; 2],
        hold: Hold,
        observer: &mut dyn Observer,
    ) -> Result<Ending, SimulationError> {
        if self.place.is_at_segment_start() {
            if start.f_n <= 0.0 {
                observer.note("shear: nothing touches, so the sphere moves freely");
            }
            self.place.stiffness = self.tangential_stiffness(hold, direction)?;
        }
        let length = match shear {
            ShearTarget::Displacement(d) => (d - start.delta_t).abs(),
            ShearTarget::FullSlip => f64::INFINITY,
        };
        let steps = ShearSteps::new(start, length, hold == Hold::NormalForce, &self.resolution());
        let bound = steps.bound(start.a);
        self.set_held_force(start, hold == Hold::NormalForce);
        loop {
            let i = self.place.reached + 1;
            let distance = steps.distance(i);
            let ends = length.is_finite() && distance >= length * (1.0 - 1e-9);
            let target = Target {
                h: self.state.record.h,
                delta_t: match shear {
                    ShearTarget::Displacement(d) if ends => d,
                    _ => start.delta_t + direction[0] * distance,
                },
                across: start.across + direction[1] * distance,
                hold_force: self.held_force.is_some(),
                extrapolate: i > 1,
                ..start.place()
            };
            let ending = self.advance(&target, observer)?;
            if ending != Ending::Done {
                self.held_force = None;
                return Ok(ending);
            }
            if ends {
                break;
            }
            if length.is_infinite() {
                let before = self.place.force_before;
                let along = |force: [f64; 2]| force[0] * direction[0] + force[1] * direction[1];
                let risen = along(self.state.record.tangential_force()) - along(before);
                if self.slips_fully() && risen <= PLATEAU * along(before).abs() {
                    break;
                }
                if distance >= bound {
                    observer.note(&format!(
                        "shear: full slip was not reached within delta_T = {:.4} R; {} of {} contact points slip",
                        self.problem.bodies() * distance,
                        self.state.record.slipping_points,
                        self.state.record.contact_points
                    ));
                    break;
                }
            }
        }
        self.held_force = None;
        Ok(Ending::Done)
    }

    /// The stiffness with which the contact sets out for a shear, of the whole sphere: nothing
    /// slips, and what flowed flows on where the shear goes on loading it. `None` where the state
    /// has no answer.
    pub(super) fn tangential_stiffness(&mut self, hold: Hold, direction: [f64; 2]) -> Result<Option<f64>, SimulationError> {
        let StepRecord { f_n, a, contact_points, .. } = self.state.record;
        if contact_points == 0 || f_n <= 0.0 || self.problem.model.friction == Friction::Coulomb(0.0) {
            return Ok(Some(0.0));
        }
        self.fetch()?;
        // What flowed is not anticipated.
        self.handle().begin_step(0.0)?;
        self.newton.set_out(&self.mesh, &self.state.u, &self.state.u, false);
        let start = SetOff {
            displacement: &self.state.u,
            probe: STIFFNESS_PROBE * f_n / (PI * a.max(self.problem.spacing)),
            direction,
            holds_force: hold == Hold::NormalForce,
        };
        let mut handle = CaseHandle { backend: &mut *self.backend, case: self.case };
        let stiffness = self.newton.tangential_stiffness(&mut handle, &start)?;
        Ok(stiffness.map(|meshed| self.mesh.copies as f64 * meshed))
    }

    /// Every point slips, but for points at the edge that carry next to nothing.
    fn slips_fully(&self) -> bool {
        let closed = self.state.points[self.newton.opponent().contacts(&self.mesh)].iter().filter(|p| p.status != Status::Open);
        let (mut stick, mut all) = (0.0, 0.0);
        for p in closed {
            all += p.force[2];
            if p.status == Status::Stick {
                stick += p.force[2];
            }
        }
        stick <= STICK_SHARE * all
    }
}

//! What becomes of a step that has converged: it is committed, measured and recorded.

use super::{Drive, Observer};
use crate::compute::handle::CaseHandle;
use crate::compute::iterate::Settled;
use crate::compute::{Energies, Evaluated, Fault};
use crate::contact::coulomb::Status;
use crate::simulation::SimulationError;
use crate::simulation::body_share::given_way;
use crate::simulation::checkpoint::Increment;
use crate::simulation::footprint::{bulge, footprint};
use crate::simulation::path::Target;
use crate::simulation::record::StepRecord;
use crate::solver::StepReport;
use crate::solver::opponent::StepTaken;
use crate::solver::phases::{Lap, Phase};

/// What a step leaves that is accepted.
struct Taken {
    energies: Energies,
    outcome: Evaluated,
    /// Three a node; of a step on a device right at contact nodes alone.
    displacement: Vec<f64>,
    /// Alike.
    internal_force: Vec<f64>,
    /// What contact exerts at each contact node, what each does, and its gap.
    forces: Vec<[f64; 3]>,
    statuses: Vec<Status>,
    gaps: Vec<f64>,
}

/// What the plate exerts at the end of a step, on the whole sphere.
struct Exerted {
    /// F_T along x and y, and F_N.
    force: [f64; 3],
    /// About x, y and z, at the point of contact.
    moment: [f64; 3],
    /// External work since the start.
    work: f64,
}

fn cross(a: &[f64; 3], b: &[f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The plate's moment about another point, from that about `from`; its force is along x, y and
/// down.
fn shifted(moment: [f64; 3], [x, y, down]: [f64; 3], from: &[f64; 3], to: &[f64; 3]) -> [f64; 3] {
    let more = cross(&std::array::from_fn(|k| from[k] - to[k]), &[x, y, 0.0 - down]);
    std::array::from_fn(|k| moment[k] + more[k])
}

impl Drive<'_> {
    /// Commits the accepted trial and records it. What cannot be committed is a step that failed:
    /// its fault is returned, and nothing has changed.
    pub(super) fn accept(
        &mut self,
        target: &Target,
        mut report: StepReport,
        observer: &mut dyn Observer,
    ) -> Result<Option<Fault>, SimulationError> {
        let before = self.state.record;
        let taken = match self.settled.take() {
            Some(settled) => self.take_from_device(settled),
            None => self.take_from_host(&mut report)?,
        };
        if let Evaluated::Invalid(fault) = taken.outcome {
            return Ok(Some(fault));
        }
        let (wasted, cutbacks) = (std::mem::take(&mut self.place.wasted), std::mem::take(&mut self.place.cutbacks));
        if let (Some(before), Some(after)) = (self.traffic_before.take(), self.backend.about().traffic) {
            report.traffic = after - before;
        }
        let h = self.newton.accepted_h();
        let force: [f64; 3] = std::array::from_fn(|c| taken.forces[..self.mesh.own_contacts()].iter().map(|f| f[c]).sum());
        let slaves = self.newton.opponent().contacts(&self.mesh);
        let count = |s: Status| taken.statuses[slaves.clone()].iter().filter(|status| **status == s).count();
        let (contact_points, slipping_points) = (count(Status::Stick) + count(Status::Slip), count(Status::Slip));
        let (energies, copies) = (taken.energies, self.mesh.copies as f64);
        let friction_work = self.keep(taken);
        let turned = self.move_plate(target, h);
        self.state.place_points(&self.mesh);
        self.state.record = StepRecord {
            step: before.step + 1,
            segment: before.segment,
            newton_iterations: report.iterations.len() + wasted,
            cutbacks,
            krylov_iterations: report.krylov(),
            merit: report.merit,
            energy_elastic: copies * energies.elastic,
            work_plastic: copies * energies.plastic,
            work_friction: before.work_friction + copies * friction_work,
            contact_points,
            slipping_points,
            max_alpha: energies.max_alpha,
            reach: self.state.reach(),
            relaxed: usize::from(report.relaxed),
            landed_again: report.landed_again,
            work_plastic_opponent: copies * energies.opponent_plastic,
            k_t: self.place.stiffness.take(),
            ..self.measured(target, h, turned, force)
        };
        self.state.longest_recovery = self.state.longest_recovery.max(self.start().recovery());
        self.tell_step(&report);
        if let Some((what, value)) = self.state.record.not_finite() {
            return Err(SimulationError::NotFinite { step: self.state.record.step, what, value });
        }
        if report.relaxed {
            self.note_relaxed(observer);
        }
        self.last_report = report;
        self.backend.take_notes().iter().for_each(|note| observer.note(note));
        observer.step(&mut self.view()).map_err(SimulationError::Observer)?;
        Ok(None)
    }

    /// The state is that of the end of the step; gives what friction has dissipated in it, in the
    /// meshed part.
    fn keep(&mut self, taken: Taken) -> f64 {
        let Taken { displacement, internal_force, forces, statuses, gaps, .. } = taken;
        let friction_work = self.newton.friction_work(&StepTaken {
            mesh: &self.mesh,
            friction: self.problem.model.friction,
            displacements: [&self.state.u, &displacement],
            before: &self.state.force,
            after: &forces,
            statuses: &statuses,
        });
        self.state.u_before = std::mem::replace(&mut self.state.u, displacement);
        self.state.force = internal_force;
        for (force, &node) in forces.iter().zip(&self.mesh.contact_nodes) {
            self.state.force[3 * node as usize..][..3].copy_from_slice(force);
        }
        (self.state.statuses, self.state.gaps) = (statuses, gaps);
        self.newton.committed();
        friction_work
    }

    /// What of the record tells of the plate and the contact, from the contact's force on the
    /// meshed part, after a step to `target` and `h` that has `turned` the plate.
    fn measured(&mut self, target: &Target, h: f64, turned: [f64; 3], force: [f64; 3]) -> StepRecord {
        let slaves = self.newton.opponent().contacts(&self.mesh);
        let size = footprint(&self.state.points[slaves.clone()], self.problem.spacing, self.mesh.copies);
        // A slave that is the opponent lies the other way round.
        let side = if slaves.start == 0 { 1.0 } else { -1.0 };
        let shape = self.mesh.couple.as_ref().and_then(|_| bulge(&self.state.points[slaves]));
        let [depth, curvature] = shape.map_or([0.0; 2], |[height, curvature]| [0.0 - side * height, side * curvature]);
        let Exerted { force: [f_t, f_t_y, f_n], moment: [m_roll_x, m_roll_y, m_twist], work } = self.exerted(force, h, turned);
        let [along, across, down] = given_way(&self.problem.case, [f_t, f_t_y, f_n], size.radius);
        StepRecord {
            h,
            delta_t: target.delta_t,
            f_n,
            f_t,
            a: size.radius,
            stick_radius: size.stick_radius,
            a_gap: size.radius_gap,
            work_external: work,
            h_opponent: depth,
            curvature,
            delta_t_y: target.across,
            f_t_y,
            roll_x: target.angles[0],
            roll_y: target.angles[1],
            twist: target.angles[2],
            m_twist,
            m_roll_x,
            m_roll_y,
            h_contact: h - down,
            delta_t_contact: target.delta_t - along,
            delta_t_y_contact: target.across - across,
            // A run alone knows no limits.
            ..StepRecord::default()
        }
    }

    /// Tells of the first step of a segment that was accepted with relaxed conditions.
    fn note_relaxed(&mut self, observer: &mut dyn Observer) {
        if !std::mem::replace(&mut self.place.relaxed_told, true) {
            let r = &self.state.record;
            observer.note(&format!(
                "step {} of segment {} was accepted with relaxed conditions; column relaxed of the history tells of it and of any other in this segment",
                r.step, r.segment
            ));
        }
    }

    /// The plate is where it was to be, and at `h`; gives what it has turned.
    fn move_plate(&mut self, target: &Target, h: f64) -> [f64; 3] {
        let state = &mut self.state;
        let before = state.record.h;
        let (along, turned) = state.way_to(target);
        state.last_increment = Some(Increment { h: h - before, along, turned });
        state.last_length = state.length_to(target);
        let (pose, travel) = (state.pose_at(target), state.travel_to(target));
        (state.pose_before, state.h_before) = (std::mem::replace(&mut state.pose, pose), before);
        state.travel = travel;
        let outward = state.equator.is_some().then(|| self.newton.outward(&state.pose));
        if let (Some(equator), Some(outward)) = (&mut state.equator, outward) {
            equator.settle(outward, state.pose.stretch);
        }
        state.h_max = state.h_max.max(h);
        turned
    }

    /// What the plate exerts, from the contact's force on the meshed part, after a step that has
    /// `turned` it.
    fn exerted(&mut self, force: [f64; 3], h: f64, turned: [f64; 3]) -> Exerted {
        let (before, copies) = (self.state.record, self.mesh.copies as f64);
        // 0 - x, not -x: no force is 0, not -0.
        let (f_n, f_t) = (copies * force[2], 0.0 - copies * force[0]);
        // The halves pull each other along y.
        let f_t_y = if self.mesh.copies == 1 { 0.0 - force[1] } else { 0.0 };
        let centre = self.state.pose.centre(h);
        let about_centre = self.moment(&centre);
        let turn_work: f64 = (0..3).map(|k| 0.5 * (self.state.moment[k] + about_centre[k]) * turned[k]).sum();
        self.state.moment = about_centre;
        let [from, to] = [self.state.pose_before.shift, self.state.pose.shift];
        let work = before.work_external
            + 0.5 * (before.f_n + f_n) * (h - before.h)
            + 0.5 * (before.f_t + f_t) * (to[0] - from[0])
            + 0.5 * (before.f_t_y + f_t_y) * (to[1] - from[1])
            + turn_work
            + copies * self.state.equator.map_or(0.0, |equator| equator.work());
        let force = [f_t, f_t_y, f_n];
        let contact = self.newton.opponent().contact_point(&centre);
        Exerted { force, moment: shifted(about_centre, force, &centre, &contact), work }
    }

    /// Writes the step that was recorded last into the log.
    fn tell_step(&self, report: &StepReport) {
        let r = &self.state.record;
        log::info!(
            "step {}: h = {:.5}, delta_T = {:.5}, {} iterations, {} Krylov, {} cut-backs, merit {:.1e}, {:.2} s (tangent {:.2}, force {:.2}, \
             contact {:.2}, linear update {:.2}, linear solve {:.2}, commit {:.2})",
            r.step,
            r.h,
            r.delta_t,
            r.newton_iterations,
            report.krylov(),
            r.cutbacks,
            report.merit,
            report.times.total(),
            report.times.seconds(Phase::Tangent),
            report.times.seconds(Phase::Force),
            report.times.seconds(Phase::Contact),
            report.times.seconds(Phase::LinearUpdate),
            report.times.seconds(Phase::LinearSolve),
            report.times.seconds(Phase::Commit),
        );
    }

    /// Moment of the plate about the sphere's centre, against that of the contact, about x, y and
    /// z; of the whole sphere.
    fn moment(&self, centre: &[f64; 3]) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for point in &self.state.points[..self.mesh.own_contacts()] {
            let arm: [f64; 3] = std::array::from_fn(|k| point.position[k] - centre[k]);
            sum.iter_mut().zip(cross(&arm, &point.force)).for_each(|(sum, moment)| *sum -= moment);
        }
        // What is even in y has a moment about y alone.
        if self.mesh.copies == 2 { [0.0, 2.0 * sum[1], 0.0] } else { sum }
    }

    /// Commits the accepted trial, whose vectors are on the host.
    fn take_from_host(&mut self, report: &mut StepReport) -> Result<Taken, SimulationError> {
        let accepted = self.newton.accepted();
        let mut lap = Lap::start();
        let (energies, outcome) = CaseHandle { backend: &mut *self.backend, case: self.case }.commit(&accepted.u)?;
        lap.end(&mut report.times, Phase::Commit);
        let (forces, statuses, gaps) = self.newton.contact_state(&self.mesh);
        let (displacement, internal_force) = (accepted.u.clone(), accepted.force.clone());
        Ok(Taken { energies, outcome, displacement, internal_force, forces, statuses, gaps })
    }

    /// The committed step of a device, of which contact points are known.
    fn take_from_device(&mut self, settled: Settled) -> Taken {
        let Settled { outcome, energies, points } = settled;
        let (mut displacement, internal_force) = (self.state.u.clone(), self.state.force.clone());
        let (mut statuses, mut gaps) = (Vec::with_capacity(points.len()), Vec::with_capacity(points.len()));
        for (point, &node) in points.iter().zip(&self.mesh.contact_nodes) {
            displacement[3 * node as usize..][..3].copy_from_slice(&point.displacement);
            let reference = self.mesh.nodes[node as usize];
            let position = std::array::from_fn(|i| reference[i] + point.displacement[i]);
            let (status, gap) = self.newton.opponent().settled(&position, point.status, self.problem.model.friction);
            statuses.push(status);
            gaps.push(gap);
        }
        self.is_away = true;
        Taken {
            energies,
            outcome,
            displacement,
            internal_force,
            forces: points.iter().map(|point| point.force).collect(),
            statuses,
            gaps,
        }
    }
}

//! The nonlinear system of one step: residual, merit and the linearised system with its contact
//! rows.

use std::sync::Arc;

use rayon::prelude::*;

use super::couple::apply_rows;
use super::encounter::Encounter;
use super::phases::{Lap, Phase, PhaseTimes};
use super::rigid::{Against, position};
use super::{Control, Worst};
use crate::compute::handle::Evaluate;
use crate::compute::iterate::{missing_weight, prescribed};
use crate::compute::{CaseModel, ComputeError, Fault, Outcome};
use crate::contact::coulomb::{CONTACT_WEIGHT, Friction, Point, Rows, Status, contact_rows};
use crate::contact::frame::Frame;
use crate::contact::pair::{Interface, leave_even};
use crate::contact::plane::gap;
use crate::linalg::bsr::BlockMatrix;
use crate::mesh::Mesh;
use crate::real::Real;

/// Which displacements are prescribed, whatever the contact does.
#[derive(Clone, Debug)]
pub struct Boundary {
    /// Nodes of the rigid plate that moves; that of another body stands still.
    pub plate: Vec<u32>,
    /// Per unknown: prescribed by the plate or by symmetry.
    pub prescribed: Vec<bool>,
    /// Per contact point: slides without friction in the present step, whatever the case says. For
    /// points that come into contact within a step under full stick: where they touch down, and so
    /// what they stick to, is not known before its end.
    pub frictionless: Vec<bool>,
    /// Per unknown: a typical stiffness by which a missing prescribed displacement enters the
    /// merit.
    pub weight: f64,
    /// The interface with the body's own image, in place of the plane.
    pub pair: Option<Meeting>,
    /// A rigid sphere in place of the plane.
    pub against: Option<Against>,
    /// Another body in place of the plane.
    pub encounter: Option<Encounter>,
    /// Nodes and contact nodes of the sphere; those of another body follow them.
    pub own_nodes: usize,
    pub own_contacts: usize,
    /// Of two bodies: the node opposite in x of each node.
    pub mirror: Vec<u32>,
}

/// The interface of an equal pair in one step, and where it starts from.
#[derive(Clone, Debug)]
pub struct Meeting {
    /// The interface.
    pub interface: Arc<Interface>,
    /// Relative positions of the undeformed bodies, per slave in its frame.
    pub reference: Vec<[f64; 3]>,
    /// Relative displacements at the start of the step.
    pub start: Vec<[f64; 3]>,
    /// All is even in x: nothing slips, and friction has nothing to do.
    pub symmetric: bool,
}

impl Meeting {
    /// The interface of a step that starts from displacement `start` and is expected to lead to
    /// `expected` (three a node), both and the step even in x if it is `symmetric`.
    pub fn new(mesh: &Mesh, start: &[f64], expected: &[f64], symmetric: bool) -> Self {
        let interface = Arc::new(Interface::new(mesh, expected));
        Self { reference: interface.relative(mesh.nodes.as_flattened()), start: interface.relative(start), interface, symmetric }
    }

    /// Moves points of a guess that have passed the opponent back to it, both sides by as much.
    pub fn separate(&self, mesh: &Mesh, guess: &mut [f64]) {
        let gap = |w: &[[f64; 3]], k: usize| (self.reference[k][2] + w[k][2]).min(0.0);
        let before = self.interface.relative(guess);
        for (i, k) in self.interface.facing.iter().enumerate() {
            let Some(k) = *k else { continue };
            if self.interface.slave_of[i].is_none() {
                guess[3 * mesh.contact_nodes[i] as usize + 2] -= 0.5 * gap(&before, k);
            }
        }
        let between = self.interface.relative(guess);
        self.interface.contract(guess);
        for (k, &slave) in self.interface.slaves.iter().enumerate() {
            guess[3 * mesh.contact_nodes[slave] as usize + 2] -= gap(&between, k);
        }
        self.interface.expand(guess);
    }
}

impl Boundary {
    /// Plate and symmetry plane of a mesh.
    pub fn new(mesh: &Mesh) -> Self {
        let frictionless = vec![false; mesh.contact_nodes.len()];
        let own_nodes = mesh.own_nodes();
        Self {
            plate: mesh.plate_nodes.iter().copied().filter(|&n| (n as usize) < own_nodes).collect(),
            prescribed: prescribed(mesh),
            frictionless,
            weight: missing_weight(mesh),
            pair: None,
            against: None,
            encounter: None,
            own_nodes,
            own_contacts: mesh.own_contacts(),
            mirror: Vec::new(),
        }
    }

    /// With another body: whether all of the step is even in x. Rounding is not, nor the points
    /// that it makes flow on one side alone: what they add is left out.
    pub fn is_even(&self) -> bool {
        !self.mirror.is_empty() && self.encounter.as_ref().is_some_and(|encounter| encounter.symmetric)
    }

    /// Writes the plate's position into a displacement.
    pub fn place_plate(&self, u: &mut [f64], h: f64, delta_t: f64) {
        for &n in &self.plate {
            u[3 * n as usize..3 * n as usize + 3].copy_from_slice(&[delta_t, 0.0, -h]);
        }
    }
}

/// Everything known at one trial displacement; the default is one of no mesh.
#[derive(Clone, Debug, Default)]
pub struct Trial {
    /// Displacement, three a node.
    pub u: Vec<f64>,
    /// Internal force, three a node.
    pub force: Vec<f64>,
    /// Contact conditions of each contact node.
    pub rows: Vec<Rows<f64>>,
    /// Residual: a force; for a prescribed unknown the displacement in excess.
    pub residual: Vec<f64>,
    /// Of two bodies: the force that the interface carries at each slave node, in its frame.
    pub interface_force: Vec<[f64; 3]>,
    /// Against a rigid sphere: the frame of its surface at each contact node.
    pub frames: Vec<Frame>,
    /// Indentation (an unknown when the normal force is held).
    pub h: f64,
    /// Normal force by which merits are scaled: the sum of f_z over the closed points.
    pub force_scale: f64,
    /// Norm of the residual (free forces, contact residuals, missing normal force), a force.
    pub merit: f64,
    /// Normal force that the plate feels, minus its f_z.
    pub plate_force: f64,
}

impl Trial {
    /// An empty trial for a mesh.
    pub fn new(mesh: &Mesh) -> Self {
        let open = contact_rows(
            Friction::Coulomb(0.0),
            &Point { force: [0.0; 3], gap: 1.0, slip: [0.0; 2], weight: 1.0, on_symmetry_plane: false },
        );
        let n = 3 * mesh.nodes.len();
        Self {
            u: vec![0.0; n],
            force: vec![0.0; n],
            rows: vec![open; mesh.contact_nodes.len()],
            residual: vec![0.0; n],
            interface_force: Vec::new(),
            frames: Vec::new(),
            h: 0.0,
            force_scale: 0.0,
            merit: f64::INFINITY,
            plate_force: 0.0,
        }
    }

    /// Evaluates forces, contact, residual and merit at `self.u`; what it takes is added to
    /// `times`.
    pub fn evaluate(
        &mut self,
        case: &mut dyn Evaluate,
        boundary: &Boundary,
        control: &Control,
        times: &mut PhaseTimes,
    ) -> Result<Outcome, ComputeError> {
        let mut lap = Lap::start();
        let over_plane = boundary.pair.is_none() && boundary.encounter.is_none() && boundary.against.is_none();
        let outcome = if over_plane {
            case.trial(&self.u, &mut self.force, &mut self.rows)?
        } else {
            case.internal_force(&self.u, &mut self.force)?
        };
        lap.end(times, Phase::Force);
        if outcome != Outcome::Valid {
            self.merit = f64::INFINITY;
            return Ok(outcome);
        }
        if !over_plane {
            return self.assess(case, boundary, control, times);
        }
        let mesh = case.model().mesh.clone();
        self.meet_rows(&mesh, boundary);
        self.finish(boundary, control);
        lap.end(times, Phase::Contact);
        Ok(self.finite(&mesh))
    }

    /// Evaluates contact, residual and merit at `self.u`, taking `self.force` to be the forces
    /// there.
    pub fn assess(
        &mut self,
        case: &mut dyn Evaluate,
        boundary: &Boundary,
        control: &Control,
        times: &mut PhaseTimes,
    ) -> Result<Outcome, ComputeError> {
        let mut lap = Lap::start();
        let mesh = case.model().mesh.clone();
        if let Some(pair) = &boundary.pair {
            self.meet(case.model(), boundary, pair);
        } else if let Some(encounter) = &boundary.encounter {
            self.meet_body(case.model(), boundary, encounter);
        } else if let Some(against) = &boundary.against {
            self.meet_rigid(case.model(), boundary, against);
        } else {
            self.meet_plane(case, &mesh, boundary)?;
        }
        self.finish(boundary, control);
        lap.end(times, Phase::Contact);
        Ok(self.finite(&mesh))
    }

    /// Whether all numbers are that decide on the trial or are recorded of it. The forces at points
    /// in contact are looked at one by one: where contact prescribes displacements, they are in no
    /// residual.
    fn finite(&self, mesh: &Mesh) -> Outcome {
        let at_contact = mesh.contact_nodes.iter().flat_map(|&n| &self.force[3 * n as usize..3 * n as usize + 3]);
        let mut decisive = [self.merit, self.force_scale, self.plate_force].into_iter().chain(at_contact.copied());
        if decisive.all(f64::is_finite) {
            return Outcome::Valid;
        }
        let first = |numbers: &[f64]| numbers.iter().position(|x| !x.is_finite());
        let at = first(&self.residual).or_else(|| first(&self.force)).map(|i| (i / 3, i % 3));
        Outcome::Invalid(Fault::Residual { at })
    }

    /// Contact rows of the plane, and the residual with them in it.
    fn meet_plane(&mut self, case: &mut dyn Evaluate, mesh: &Mesh, boundary: &Boundary) -> Result<(), ComputeError> {
        case.contact(&self.u, &self.force, &mut self.rows)?;
        self.meet_rows(mesh, boundary);
        Ok(())
    }

    /// The rows of points that slide without friction, and the residual with all rows in it.
    fn meet_rows(&mut self, mesh: &Mesh, boundary: &Boundary) {
        for (i, _) in boundary.frictionless.iter().enumerate().filter(|(_, free)| **free) {
            let base = 3 * mesh.contact_nodes[i] as usize;
            let point = Point {
                force: [self.force[base], self.force[base + 1], self.force[base + 2]],
                gap: gap(mesh.nodes[base / 3][2], self.u[base + 2]),
                slip: [0.0; 2],
                weight: self.rows[i].weight,
                on_symmetry_plane: boundary.prescribed[base + 1],
            };
            self.rows[i] = contact_rows(Friction::Coulomb(0.0), &point);
        }
        self.residual.copy_from_slice(&self.force);
        for (rows, &node) in self.rows.iter().zip(&mesh.contact_nodes) {
            self.residual[3 * node as usize..3 * node as usize + 3].copy_from_slice(&rows.residual);
        }
        self.force_scale = self
            .rows
            .iter()
            .zip(&mesh.contact_nodes)
            .filter(|(rows, _)| rows.status != Status::Open)
            .map(|(_, &n)| self.force[3 * n as usize + 2].abs())
            .sum();
    }

    /// Before the slaves of an interface are gone through: no point is in contact.
    pub(super) fn open_all(&mut self) {
        let open = contact_rows(
            Friction::Coulomb(0.0),
            &Point { force: [0.0; 3], gap: 1.0, slip: [0.0; 2], weight: 1.0, on_symmetry_plane: false },
        );
        self.rows.fill(open);
        self.force_scale = 0.0;
        self.interface_force.clear();
    }

    /// Contact rows of an equal pair at its slave nodes, and the residual of the unknowns y (see
    /// [`crate::contact::pair`]).
    fn meet(&mut self, model: &CaseModel, boundary: &Boundary, pair: &Meeting) {
        let (mesh, interface) = (&model.mesh, &pair.interface);
        self.residual.copy_from_slice(&self.force);
        if pair.symmetric {
            leave_even(&boundary.mirror, &mut self.residual);
        }
        interface.reduce(&mut self.residual);
        self.open_all();
        for (k, w) in interface.relative(&self.u).into_iter().enumerate() {
            let slave = interface.slaves[k];
            let base = 3 * mesh.contact_nodes[slave] as usize;
            let force = [self.residual[base], self.residual[base + 1], self.residual[base + 2]];
            let on_symmetry_plane = boundary.prescribed[base + 1];
            // On the seam there is no slip along y, nor a force: the row is that of a free node.
            let free_y = interface.is_free_along_y(k) && !on_symmetry_plane;
            let slip = |c: usize| w[c] - pair.start[k][c];
            let point = Point {
                force: if free_y { [force[0], 0.0, force[2]] } else { force },
                gap: pair.reference[k][2] + w[2],
                slip: [slip(0), if free_y { 0.0 } else { slip(1) }],
                // Two bodies in series are half as stiff.
                weight: 0.5 * CONTACT_WEIGHT * mesh.contact_size[slave],
                on_symmetry_plane,
            };
            let friction = if boundary.frictionless[slave] || pair.symmetric { Friction::Coulomb(0.0) } else { model.friction };
            let mut rows = contact_rows(friction, &point);
            if free_y {
                rows.fixed[1] = false;
                rows.residual[1] = force[1];
                rows.force_rows[1] = [0.0, 1.0, 0.0];
                rows.displacement_rows[1] = [0.0; 3];
            }
            if pair.symmetric && rows.status == Status::Slip && model.friction != Friction::Coulomb(0.0) {
                rows.status = Status::Stick;
            }
            if rows.status != Status::Open {
                // The master side carries as much again.
                self.force_scale += 2.0 * force[2].abs();
            }
            self.residual[base..base + 3].copy_from_slice(&rows.residual);
            self.interface_force.push(force);
            self.rows[slave] = rows;
        }
    }

    /// The residual of what is prescribed, the plate's force and the merit.
    fn finish(&mut self, boundary: &Boundary, control: &Control) {
        for (i, &p) in boundary.prescribed.iter().enumerate() {
            if p {
                // Symmetry nodes are at u_y = 0; the plate is handled below.
                self.residual[i] = self.u[i];
            }
        }
        let target = [control.delta_t, 0.0, -self.h];
        self.plate_force = 0.0;
        for &n in &boundary.plate {
            let base = 3 * n as usize;
            for i in 0..3 {
                self.residual[base + i] = self.u[base + i] - target[i];
            }
            self.plate_force -= self.force[base + 2];
        }
        let sum: f64 = chunked_sum(self.residual.len(), |i| {
            let r = self.residual[i] * if boundary.prescribed[i] { boundary.weight } else { 1.0 };
            r * r
        });
        let missing = control.normal_force.map_or(0.0, |f| f - self.plate_force);
        self.merit = (sum + missing * missing).sqrt();
    }

    /// Force of the plane on a contact point, as the contact's conditions have it: normal to the
    /// plane the internal force; along it xi_t projected onto the friction cone (see
    /// [`crate::contact::coulomb`]), which is the internal force less the row's residual. In
    /// equilibrium that is nothing; what the tolerance leaves of it is a force that is missing in
    /// the body, not friction beyond Coulomb's bound. The symmetry plane's force is not the
    /// contact's.
    pub fn point_force(&self, mesh: &Mesh, point: usize) -> [f64; 3] {
        let (rows, node) = (&self.rows[point], mesh.contact_nodes[point] as usize);
        if rows.status == Status::Open {
            return [0.0; 3];
        }
        let tangential = |i: usize| self.force[3 * node + i] - rows.residual[i];
        let across = if mesh.nodes[node][1] == 0.0 { 0.0 } else { tangential(1) };
        [tangential(0), across, self.force[3 * node + 2].max(0.0)]
    }

    /// What contact exerts on each contact node, along the axes: of a plane [`Trial::point_force`],
    /// of a rigid sphere the same in its frame; of two bodies what the interface's forces,
    /// projected as those are, come to at the nodes of both sides.
    pub fn point_forces(&self, mesh: &Mesh, boundary: &Boundary) -> Vec<[f64; 3]> {
        if let Some(encounter) = &boundary.encounter {
            return encounter.interface.nodal(&self.interface_forces(encounter));
        }
        let Some(pair) = &boundary.pair else {
            let points = 0..self.rows.len();
            return match &boundary.against {
                None => points.map(|i| self.point_force(mesh, i)).collect(),
                Some(_) => points.map(|i| self.rigid_point_force(mesh, i)).collect(),
            };
        };
        pair.interface.nodal(&self.pair_forces(pair))
    }

    /// Status of each contact node; a master has that of the slave that carries most of its load.
    pub fn statuses(&self, boundary: &Boundary) -> Vec<Status> {
        let own = |i: usize| self.rows[i].status;
        if let Some(encounter) = &boundary.encounter {
            let facing = |k: &Option<usize>| k.map_or(Status::Open, |k| own(encounter.interface.slaves[k]));
            return encounter.interface.facing.iter().map(facing).collect();
        }
        match &boundary.pair {
            None => (0..self.rows.len()).map(own).collect(),
            Some(pair) => {
                let facing = |k: &Option<usize>| k.map_or(Status::Open, |k| own(pair.interface.slaves[k]));
                pair.interface.facing.iter().map(facing).collect()
            }
        }
    }

    /// Turns corrections from the unknowns of the linear system to displacements.
    pub(super) fn expand(&self, mesh: &Mesh, boundary: &Boundary, x: &mut [f64]) {
        if let Some(pair) = &boundary.pair {
            pair.interface.expand(x);
        } else if let Some(encounter) = &boundary.encounter {
            encounter.interface.expand(x);
        } else if boundary.against.is_some() {
            self.to_axes(mesh, x);
        }
    }

    /// Turns displacements into the unknowns of the linear system.
    pub(super) fn contract(&self, mesh: &Mesh, boundary: &Boundary, x: &mut [f64]) {
        if let Some(pair) = &boundary.pair {
            pair.interface.contract(x);
        } else if let Some(encounter) = &boundary.encounter {
            encounter.interface.contract(x);
        } else if boundary.against.is_some() {
            self.to_frames(mesh, x);
        }
    }

    /// Gap at each contact node: to the plane or the rigid sphere, or between the bodies of an
    /// equal pair.
    pub fn gaps(&self, mesh: &Mesh, boundary: &Boundary) -> Vec<f64> {
        if let Some(encounter) = &boundary.encounter {
            return encounter.gaps(mesh, &self.u);
        }
        if let Some(against) = &boundary.against {
            return mesh.contact_nodes.iter().map(|&n| against.rigid.gap(&position(mesh, &self.u, n))).collect();
        }
        match &boundary.pair {
            None => mesh.contact_nodes.iter().map(|&n| gap(mesh.nodes[n as usize][2], self.u[3 * n as usize + 2])).collect(),
            Some(pair) => {
                let w = pair.interface.relative(&self.u);
                let height = |i: usize| {
                    2.0 * (mesh.nodes[mesh.contact_nodes[i] as usize][2] + self.u[3 * mesh.contact_nodes[i] as usize + 2])
                };
                // A node at the rim that nothing faces: the gap to its own mirror image.
                let facing = pair.interface.facing.iter().enumerate();
                facing.map(|(i, k)| k.map_or_else(|| height(i), |k| pair.reference[k][2] + w[k][2])).collect()
            }
        }
    }

    /// Tangential and normal force of the contact on the meshed half of the sphere, [x, y, z].
    pub fn contact_force(&self, mesh: &Mesh, boundary: &Boundary) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for force in self.point_forces(mesh, boundary).into_iter().take(boundary.own_contacts) {
            for (s, f) in sum.iter_mut().zip(force) {
                *s += f;
            }
        }
        sum
    }

    /// Norm of the tangential residuals of the points in contact.
    pub fn tangential_residual(&self) -> f64 {
        let closed = self.rows.iter().filter(|rows| rows.status != Status::Open);
        closed.map(|rows| rows.residual[0].powi(2) + rows.residual[1].powi(2)).sum::<f64>().sqrt()
    }

    /// The unknown with the largest residual, over the force `scale`.
    pub fn worst(&self, mesh: &Mesh, boundary: &Boundary, scale: f64) -> Worst {
        let mut worst = Worst::default();
        for (i, &r) in self.residual.iter().enumerate() {
            let r = if boundary.prescribed[i] { r * boundary.weight } else { r } / scale.max(f64::MIN_POSITIVE);
            if r.abs() > worst.residual.abs() || r.is_nan() {
                worst = Worst { node: i / 3, direction: i % 3, position: mesh.nodes[i / 3], residual: r };
            }
            if r.is_nan() {
                break;
            }
        }
        worst
    }
}

/// A sum over an index range with a fixed order of additions at any thread count.
pub fn chunked_sum(n: usize, term: impl Fn(usize) -> f64 + Sync) -> f64 {
    const CHUNK: usize = 4096;
    let parts: Vec<f64> =
        (0..n.div_ceil(CHUNK)).into_par_iter().map(|c| (c * CHUNK..((c + 1) * CHUNK).min(n)).map(&term).sum()).collect();
    parts.iter().sum()
}

/// Rows of the plate's normal reaction: `w . du` is the change of the plate's summed f_z.
pub fn plate_functional<T: Real>(matrix: &BlockMatrix<T>, plate: &[u32], w: &mut [f64]) {
    w.fill(0.0);
    for &n in plate {
        for k in matrix.pattern.row(n as usize) {
            let base = 3 * matrix.pattern.column[k] as usize;
            for j in 0..3 {
                w[base + j] += matrix.blocks[k][6 + j].to_f64();
            }
        }
    }
}

/// Says which unknowns are prescribed, by boundary or contact.
pub fn fixed_unknowns(mesh: &Mesh, boundary: &Boundary, rows: &[Rows<f64>], fixed: &mut [bool]) {
    fixed.copy_from_slice(&boundary.prescribed);
    for (rows, &node) in rows.iter().zip(&mesh.contact_nodes) {
        let n = node as usize;
        for i in 0..3 {
            fixed[3 * n + i] |= rows.fixed[i];
        }
    }
}

/// Replaces the contact nodes' rows by their contact conditions.
///
/// Rows of prescribed unknowns are left as they are: the linear solver takes `fixed` and never
/// reads them.
pub fn apply_contact<T: Real>(matrix: &mut BlockMatrix<T>, mesh: &Mesh, rows: &[Rows<f64>]) {
    for (rows, &node) in rows.iter().zip(&mesh.contact_nodes) {
        if rows.status == Status::Slip {
            apply_rows(matrix, node as usize, rows);
        }
    }
}

/// Right-hand side of the linear system: minus the residual, and for prescribed unknowns the
/// displacement that is missing.
pub fn right_hand_side(trial: &Trial, mesh: &Mesh, boundary: &Boundary, rhs: &mut [f64]) {
    for (b, r) in rhs.iter_mut().zip(&trial.residual) {
        *b = -r;
    }
    for (rows, &node) in trial.rows.iter().zip(&mesh.contact_nodes) {
        for i in 0..3 {
            let k = 3 * node as usize + i;
            // Contact residuals of prescribed unknowns are stated as forces c g; as displacements
            // they are g.
            if rows.fixed[i] && !boundary.prescribed[k] {
                rhs[k] = -rows.residual[i] / rows.weight;
            }
        }
    }
}

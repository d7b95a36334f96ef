//! The nonlinear system of one step: residual, merit and the linearised system with its contact
//! rows.

use rayon::prelude::*;

use super::opponent::Opponent;
use super::opponent::plane::Plane;
use super::phases::{Lap, Phase, PhaseTimes};
use super::pose::{CENTRE, Pose};
use super::{Control, Worst};
use crate::compute::handle::CaseHandle;
use crate::compute::iterate::{missing_weight, prescribed};
use crate::compute::{ComputeError, Evaluated, Fault};
use crate::contact::coulomb::{Friction, Point, Rows, Status, contact_rows};
use crate::contact::frame::ContactFrame;
use crate::linalg::bsr::BlockMatrix;
use crate::mesh::Mesh;
use crate::real::Real;

/// Which displacements are prescribed, whatever the contact does, and what there is contact with.
#[derive(Debug)]
pub struct Boundary {
    /// Nodes of the rigid plate that moves; that of another body stands still.
    pub plate: Vec<u32>,
    /// How far from the sphere's centre they lie in the undeformed body.
    pub from_centre: Vec<[f64; 3]>,
    /// Per unknown: prescribed by the plate or by symmetry.
    pub prescribed: Vec<bool>,
    /// Per contact point: slides without friction in the present step, whatever the case says. For
    /// points that come into contact within a step under full stick: where they touch down, and so
    /// what they stick to, is not known before its end.
    pub frictionless: Vec<bool>,
    /// Every point that touches sticks, but for those that slide without friction.
    pub stuck: bool,
    /// Per unknown: a typical stiffness by which a missing prescribed displacement enters the
    /// merit.
    pub weight: f64,
    /// What the body is pressed against.
    pub opponent: Box<dyn Opponent>,
    /// Nodes of the sphere; those of another body follow them.
    pub own_nodes: usize,
    /// Its contact nodes, alike.
    pub own_contacts: usize,
}

impl Boundary {
    /// Plate and symmetry plane of a mesh, over a plane.
    pub fn new(mesh: &Mesh) -> Self {
        let frictionless = vec![false; mesh.contact_nodes.len()];
        let own_nodes = mesh.own_nodes();
        let plate: Vec<u32> = mesh.plate_nodes.iter().copied().filter(|&n| (n as usize) < own_nodes).collect();
        let from_centre = |&n: &u32| std::array::from_fn(|k| mesh.nodes[n as usize][k] - CENTRE[k]);
        Self {
            from_centre: plate.iter().map(from_centre).collect(),
            plate,
            prescribed: prescribed(mesh),
            frictionless,
            stuck: false,
            weight: missing_weight(mesh),
            opponent: Box::new(Plane),
            own_nodes,
            own_contacts: mesh.own_contacts(),
        }
    }

    /// The friction of a contact point, of a case with this one.
    pub fn friction_at(&self, contact: usize, friction: Friction<f64>) -> Friction<f64> {
        match (self.frictionless[contact], self.stuck) {
            (true, _) => Friction::Coulomb(0.0),
            (false, true) => Friction::Stick,
            (false, false) => friction,
        }
    }

    /// Writes the plate's position into a displacement.
    pub fn place_plate(&self, u: &mut [f64], h: f64, pose: &Pose) {
        for (&n, from_centre) in self.plate.iter().zip(&self.from_centre) {
            u[3 * n as usize..3 * n as usize + 3].copy_from_slice(&pose.displacement(h, from_centre));
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
    /// Where there is an interface: the force that it carries at each slave node, in its frame.
    pub interface_force: Vec<[f64; 3]>,
    /// Against a rigid sphere: the frame of its surface at each contact node.
    pub frames: Vec<ContactFrame>,
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
        let n = 3 * mesh.nodes.len();
        Self {
            u: vec![0.0; n],
            force: vec![0.0; n],
            rows: vec![open(); mesh.contact_nodes.len()],
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
        case: &mut CaseHandle<'_>,
        boundary: &Boundary,
        control: &Control,
        times: &mut PhaseTimes,
    ) -> Result<Evaluated, ComputeError> {
        let mut lap = Lap::start();
        let outcome = case.internal_force(&self.u, &mut self.force)?;
        lap.end(times, Phase::Force);
        if outcome != Evaluated::Valid {
            self.merit = f64::INFINITY;
            return Ok(outcome);
        }
        self.assess(case, boundary, control, times)
    }

    /// Evaluates contact, residual and merit at `self.u`, taking `self.force` to be the forces
    /// there.
    pub fn assess(
        &mut self,
        case: &mut CaseHandle<'_>,
        boundary: &Boundary,
        control: &Control,
        times: &mut PhaseTimes,
    ) -> Result<Evaluated, ComputeError> {
        let mut lap = Lap::start();
        let mesh = case.model().mesh.clone();
        boundary.opponent.meet(self, case, boundary)?;
        self.finish(boundary, control);
        lap.end(times, Phase::Contact);
        Ok(self.finite(&mesh))
    }

    /// Whether all numbers are that decide on the trial or are recorded of it. The forces at points
    /// in contact are looked at one by one: where contact prescribes displacements, they are in no
    /// residual.
    fn finite(&self, mesh: &Mesh) -> Evaluated {
        let at_contact = mesh.contact_nodes.iter().flat_map(|&n| &self.force[3 * n as usize..3 * n as usize + 3]);
        let mut decisive = [self.merit, self.force_scale, self.plate_force].into_iter().chain(at_contact.copied());
        if decisive.all(f64::is_finite) {
            return Evaluated::Valid;
        }
        let first = |numbers: &[f64]| numbers.iter().position(|x| !x.is_finite());
        let at = first(&self.residual).or_else(|| first(&self.force)).map(|i| (i / 3, i % 3));
        Evaluated::Invalid(Fault::Residual { at })
    }

    /// Internal force at a node.
    pub(super) fn force_at(&self, node: u32) -> [f64; 3] {
        let base = 3 * node as usize;
        [self.force[base], self.force[base + 1], self.force[base + 2]]
    }

    /// Before the slaves of an interface are gone through: no point is in contact.
    pub(super) fn open_all(&mut self) {
        self.rows.fill(open());
        self.force_scale = 0.0;
        self.interface_force.clear();
    }

    /// The residual of what is prescribed, the plate's force and the merit.
    fn finish(&mut self, boundary: &Boundary, control: &Control) {
        for (i, &p) in boundary.prescribed.iter().enumerate() {
            if p {
                // Symmetry nodes are at u_y = 0; the plate is handled below.
                self.residual[i] = self.u[i];
            }
        }
        self.plate_force = 0.0;
        for (&n, from_centre) in boundary.plate.iter().zip(&boundary.from_centre) {
            let base = 3 * n as usize;
            let target = control.pose.displacement(self.h, from_centre);
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

    /// Tangential and normal force of the contact on the meshed half of the sphere, [x, y, z].
    pub fn contact_force(&self, mesh: &Mesh, boundary: &Boundary) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for force in boundary.opponent.forces(self, mesh).into_iter().take(boundary.own_contacts) {
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

/// The rows of a point that is not in contact.
fn open() -> Rows<f64> {
    let apart = Point { force: [0.0; 3], gap: 1.0, slip: [0.0; 2], weight: 1.0, on_symmetry_plane: false };
    contact_rows(Friction::Coulomb(0.0), &apart)
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

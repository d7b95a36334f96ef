//! The linear systems of an equal pair, in the unknowns of its interface (see
//! [`crate::contact::pair`]).
//!
//! What preconditions knows of a pair that has not slid: a field that is even in x touches its
//! image along the normal alone and slides freely, an odd one is held along the plane alone. So the
//! right-hand side is split into its even and odd parts, and each goes through a V-cycle of its
//! own, on half of the body (see [`crate::linalg::fold`]). Up to the first shear all is even.
//!
//! Of an inverted image that holds of what is even or odd when the body is turned half round z, for
//! which there is no half: each part goes through a V-cycle of the whole body.

use super::half::HalfCycle;
use super::tied::{InSingle, Tie, Tied, clear};
use crate::contact::coulomb::Status;
use crate::contact::interface::{Interface, Symmetry};
use crate::contact::pair::{Image, PairInterface};
use crate::linalg::fgmres::System;
use crate::linalg::fold::{Fold, Parity};
use crate::linalg::{Hierarchy, LinalgError, Pattern};
use crate::mesh::Mesh;

/// Solves for the unknowns y of a pair.
#[derive(Debug)]
pub struct PairSolver {
    tie: Tie<PairInterface>,
    cycles: Cycles,
    work: Work,
}

/// What preconditions.
#[derive(Debug)]
enum Cycles {
    /// On half of the body, of a half turn.
    Halves(Box<Halves>),
    /// On all of it, of an inversion.
    Whole(Box<Whole>),
}

/// The V-cycles of half of the body for what is even in x, and what is odd.
#[derive(Debug)]
struct Halves {
    fold: Fold,
    even: HalfCycle,
    odd: HalfCycle,
}

/// The V-cycles of the whole body for what is even and what is odd when it is turned half round z.
#[derive(Debug)]
struct Whole {
    turn: Symmetry,
    /// Of the even part, and of the odd one.
    hierarchies: [Hierarchy; 2],
    fixed: [Vec<bool>; 2],
    load: Vec<f32>,
    z: Vec<f32>,
}

#[derive(Debug, Default)]
struct Work {
    u: Vec<f64>,
    f: Vec<f64>,
    single: InSingle,
}

impl Halves {
    fn new(mesh: &Mesh, pattern: &Pattern, mirror: &[u32]) -> Result<Option<Self>, LinalgError> {
        let Some(half) = mesh.half.as_ref().filter(|_| !mirror.is_empty()) else { return Ok(None) };
        let Some(fold) = Fold::new(pattern, &half.node, mirror) else { return Ok(None) };
        let hierarchy = Hierarchy::new(&fold.matrix.pattern, &half.hierarchy)?;
        Ok(Some(Self {
            even: HalfCycle::new(Parity::Even, hierarchy.clone(), half.node.len()),
            odd: HalfCycle::new(Parity::Odd, hierarchy, half.node.len()),
            fold,
        }))
    }

    fn refresh(&mut self, tie: &Tie<PairInterface>, prescribed: &[bool]) -> Result<(), LinalgError> {
        let Tie { interface, rows, contact_nodes, .. } = tie;
        self.fold.update(&tie.matrix);
        self.even.fix(&self.fold, prescribed);
        self.odd.fix(&self.fold, prescribed);
        for (a, nodes) in self.fold.nodes().iter().enumerate() {
            for contact in nodes.map(|node| contact_nodes.binary_search(&node).ok()).into_iter().flatten() {
                let Some(k) = interface.slave_of[contact] else { continue };
                match rows[contact].status {
                    Status::Open => {}
                    status => {
                        self.even.fixed[3 * a + 2] = true;
                        if status == Status::Stick {
                            self.odd.fixed[3 * a] = true;
                            self.odd.fixed[3 * a + 1] |= !interface.is_free_along_y(k);
                        }
                    }
                }
            }
        }
        self.even.update(&self.fold)?;
        if tie.symmetric { Ok(()) } else { self.odd.update(&self.fold) }
    }

    /// Adds to `u` what the V-cycles make of the forces `f`.
    fn add(&mut self, is_even: bool, f: &[f64], u: &mut [f64]) {
        self.even.add(&self.fold, f, u);
        if !is_even {
            self.odd.add(&self.fold, f, u);
        }
    }
}

impl Whole {
    fn new(mesh: &Mesh, pattern: &Pattern, turn: &Symmetry) -> Result<Option<Self>, LinalgError> {
        if turn.nodes.is_empty() {
            return Ok(None);
        }
        let hierarchy = Hierarchy::new(pattern, &mesh.hierarchy)?;
        let n = 3 * pattern.rows();
        Ok(Some(Self {
            turn: turn.clone(),
            hierarchies: [hierarchy.clone(), hierarchy],
            fixed: [vec![false; n], vec![false; n]],
            load: vec![0.0; n],
            z: vec![0.0; n],
        }))
    }

    /// Points that touch are held along the normal in the even part, and those that stick along the
    /// plane in the odd one.
    fn refresh(&mut self, tie: &Tie<PairInterface>, prescribed: &[bool]) -> Result<(), LinalgError> {
        self.fixed.iter_mut().for_each(|fixed| fixed.copy_from_slice(prescribed));
        let [even, odd] = &mut self.fixed;
        for (contact, k) in tie.interface.facing().iter().enumerate() {
            let Some(k) = *k else { continue };
            let status = tie.rows[tie.interface.slaves[k]].status;
            let node = tie.contact_nodes[contact];
            for unknown in [node, self.turn.nodes[node as usize]].map(|n| 3 * n as usize) {
                even[unknown + 2] |= status != Status::Open;
                (0..2).for_each(|c| odd[unknown + c] |= status == Status::Stick);
            }
        }
        let [of_even, of_odd] = &mut self.hierarchies;
        of_even.update(&tie.matrix, even)?;
        if tie.symmetric { Ok(()) } else { of_odd.update(&tie.matrix, odd) }
    }

    /// Adds to `u` what the V-cycles make of the forces `f`.
    fn add(&mut self, is_even: bool, f: &[f64], u: &mut [f64]) {
        let parts = if is_even { 1 } else { 2 };
        for (part, hierarchy) in self.hierarchies.iter_mut().enumerate().take(parts) {
            let parity = if part == 0 { 1.0 } else { -1.0 };
            for (n, &opposite) in self.turn.nodes.iter().enumerate() {
                for (c, sign) in self.turn.signs.into_iter().enumerate() {
                    self.load[3 * n + c] = (0.5 * (f[3 * n + c] + parity * sign * f[3 * opposite as usize + c])) as f32;
                }
            }
            clear(&self.fixed[part], &mut self.load);
            hierarchy.v_cycle(&self.load, &mut self.z);
            u.iter_mut().zip(&self.z).for_each(|(u, z)| *u += f64::from(*z));
        }
    }
}

impl PairSolver {
    /// Plans a solver for a mesh with this symmetry, its mirror in x for a half turn and its half
    /// turn round z for an inversion; `None` if it has none, or if elements cross x = 0 where they
    /// must not.
    ///
    /// # Errors
    /// [`LinalgError::Hierarchy`] if the prolongations do not fit.
    pub fn new(mesh: &Mesh, pattern: &Pattern, symmetry: &Symmetry, image: Image) -> Result<Option<Self>, LinalgError> {
        let cycles = match image {
            Image::HalfTurn => Halves::new(mesh, pattern, &symmetry.nodes)?.map(|halves| Cycles::Halves(Box::new(halves))),
            Image::Inversion => Whole::new(mesh, pattern, symmetry)?.map(|whole| Cycles::Whole(Box::new(whole))),
        };
        let n = 3 * pattern.rows();
        Ok(cycles.map(|cycles| Self {
            tie: Tie::new(mesh, pattern, symmetry),
            cycles,
            work: Work { u: vec![0.0; n], f: vec![0.0; n], single: InSingle::default() },
        }))
    }
}

impl Tied for PairSolver {
    type Interface = PairInterface;

    fn tie(&self) -> &Tie<PairInterface> {
        &self.tie
    }

    fn tie_mut(&mut self) -> &mut Tie<PairInterface> {
        &mut self.tie
    }

    fn refresh(&mut self, prescribed: &[bool]) -> Result<(), LinalgError> {
        match &mut self.cycles {
            Cycles::Halves(halves) => halves.refresh(&self.tie, prescribed),
            Cycles::Whole(whole) => whole.refresh(&self.tie, prescribed),
        }
    }
}

impl System<f32> for PairSolver {
    fn step(&mut self, v: &[f32], z: &mut [f32], w: &mut [f32]) {
        let mut work = std::mem::take(&mut self.work);
        work.f.iter_mut().zip(v).for_each(|(f, v)| *f = f64::from(*v));
        self.tie.interface.loads(&work.f, &self.tie.fixed, &mut work.u);
        std::mem::swap(&mut work.u, &mut work.f);
        work.u.fill(0.0);
        match &mut self.cycles {
            Cycles::Halves(halves) => halves.add(self.tie.symmetric, &work.f, &mut work.u),
            Cycles::Whole(whole) => whole.add(self.tie.symmetric, &work.f, &mut work.u),
        }
        self.tie.interface.contract(&mut work.u);
        clear(&self.tie.fixed, &mut work.u);
        z.iter_mut().zip(&work.u).for_each(|(z, u)| *z = *u as f32);
        let y: Vec<f64> = z.iter().map(|z| f64::from(*z)).collect();
        work.u.copy_from_slice(&y);
        self.tie.interface.expand(&mut work.u);
        work.single.multiply(&self.tie.matrix, &work.u, &mut work.f);
        self.tie.carry_over(&y, &mut work.f);
        clear(&self.tie.fixed, &mut work.f);
        w.iter_mut().zip(&work.f).for_each(|(w, f)| *w = *f as f32);
        self.work = work;
    }

    fn residual(&self, b: &[f64], x: &[f64], r: &mut [f64]) {
        self.remainder(b, x, r);
    }
}

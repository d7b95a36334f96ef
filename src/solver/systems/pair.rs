//! The linear systems of an equal pair, in the unknowns of its interface (see
//! [`crate::contact::pair`]).
//!
//! What preconditions knows of a pair that has not slid: a field that its image keeps touches that
//! along the normal alone and slides freely, one that changes sign is held along the plane alone.
//! So the right-hand side is split into its even and its odd part, in x over an image that is
//! turned half round y, and under a half turn round z over an inverted one. Each goes through a
//! V-cycle of its own, on half of the body (see [`crate::linalg::fold`] and
//! [`crate::linalg::turn`]). Up to the first shear all is even. The twin on a device, of a half
//! turn round y, is `compute::gpu::linear::tied` with `shaders/linalg/{fold,unfold,tie_*}.wgsl`.

use super::half::HalfCycle;
use super::tied::{InSingle, Tie, Tied, clear};
use crate::contact::coulomb::{Rows, Status};
use crate::contact::interface::{Interface, Symmetry};
use crate::contact::pair::{Image, PairInterface};
use crate::linalg::fgmres::System;
use crate::linalg::fold::{Fold, Folding, Parity};
use crate::linalg::turn::Turn;
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
    /// Over an image turned half round y.
    Mirrored(Box<Halves<Fold>>),
    /// Over an inverted one.
    Turned(Box<Halves<Turn>>),
}

/// The V-cycles of half of the body for what is even, and what is odd.
#[derive(Debug)]
struct Halves<F> {
    fold: F,
    even: HalfCycle,
    odd: HalfCycle,
}

#[derive(Debug, Default)]
struct Work {
    u: Vec<f64>,
    f: Vec<f64>,
    single: InSingle,
}

impl Halves<Fold> {
    fn new(mesh: &Mesh, pattern: &Pattern, mirror: &[u32]) -> Result<Option<Self>, LinalgError> {
        let Some(half) = mesh.half.as_ref().filter(|_| !mirror.is_empty()) else { return Ok(None) };
        let Some(fold) = Fold::new(pattern, &half.node, mirror) else { return Ok(None) };
        let hierarchy = Hierarchy::new(&fold.matrix().pattern, &half.hierarchy)?;
        Ok(Some(Self {
            even: HalfCycle::new(Parity::Even, hierarchy.clone(), half.node.len()),
            odd: HalfCycle::new(Parity::Odd, hierarchy, half.node.len()),
            fold,
        }))
    }

    /// What is fixed in either half: what is so whatever the contact does, points that touch along
    /// the normal in what is even, and those that stick along the plane in what is odd.
    fn fix(&mut self, contact_nodes: &[u32], interface: &PairInterface, rows: &[Rows<f64>], prescribed: &[bool]) {
        self.fix_prescribed(prescribed);
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
    }

    fn refresh(&mut self, tie: &Tie<PairInterface>, prescribed: &[bool]) -> Result<(), LinalgError> {
        self.fold.update(&tie.matrix);
        self.fix(&tie.contact_nodes, &tie.interface, &tie.rows, prescribed);
        self.update(tie)
    }
}

impl Halves<Turn> {
    fn new(mesh: &Mesh, pattern: &Pattern, turned: &[u32]) -> Result<Option<Self>, LinalgError> {
        let Some(half) = mesh.half.as_ref().filter(|_| !turned.is_empty()) else { return Ok(None) };
        let Some(fold) = Turn::new(pattern, &half.node, turned) else { return Ok(None) };
        let cycle = |parity| -> Result<HalfCycle, LinalgError> {
            let hierarchy = Hierarchy::new(&fold.matrix().pattern, &half.hierarchy)?;
            Ok(HalfCycle::new(parity, hierarchy.with_ties(fold.ties(parity), &half.hierarchy), half.node.len()))
        };
        Ok(Some(Self { even: cycle(Parity::Even)?, odd: cycle(Parity::Odd)?, fold }))
    }

    /// Points that touch are held along the normal in what is even, and those that stick along the
    /// plane in what is odd.
    fn refresh(&mut self, tie: &Tie<PairInterface>, prescribed: &[bool]) -> Result<(), LinalgError> {
        self.fold.update(&tie.matrix);
        self.fix_prescribed(prescribed);
        let status = |node: u32| {
            let contact = tie.contact_nodes.binary_search(&node).ok()?;
            Some(tie.rows[tie.interface.slaves[tie.interface.facing()[contact]?]].status)
        };
        for (a, nodes) in self.fold.nodes().iter().enumerate() {
            for status in nodes.iter().filter_map(|&node| status(node)) {
                self.even.fixed[3 * a + 2] |= status != Status::Open;
                if status == Status::Stick {
                    self.odd.fixed[3 * a..3 * a + 2].fill(true);
                }
            }
        }
        self.update(tie)
    }
}

impl<F: Folding> Halves<F> {
    /// Fixes what is so whatever the contact does.
    fn fix_prescribed(&mut self, prescribed: &[bool]) {
        self.even.fix(&self.fold, prescribed);
        self.odd.fix(&self.fold, prescribed);
    }

    /// Forms the hierarchies that are needed.
    fn update(&mut self, tie: &Tie<PairInterface>) -> Result<(), LinalgError> {
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

impl PairSolver {
    /// Plans a solver for a mesh with this symmetry, its mirror in x for a half turn and its half
    /// turn round z for an inversion; `None` if it has none, or if elements cross x = 0.
    ///
    /// # Errors
    /// [`LinalgError::Hierarchy`] if the prolongations do not fit.
    pub fn new(mesh: &Mesh, pattern: &Pattern, symmetry: &Symmetry, image: Image) -> Result<Option<Self>, LinalgError> {
        let cycles = match image {
            Image::HalfTurn => {
                Halves::<Fold>::new(mesh, pattern, &symmetry.nodes)?.map(|halves| Cycles::Mirrored(Box::new(halves)))
            }
            Image::Inversion => {
                Halves::<Turn>::new(mesh, pattern, &symmetry.nodes)?.map(|halves| Cycles::Turned(Box::new(halves)))
            }
        };
        let n = 3 * pattern.rows();
        Ok(cycles.map(|cycles| Self {
            tie: Tie::new(mesh, pattern, symmetry),
            cycles,
            work: Work { u: vec![0.0; n], f: vec![0.0; n], single: InSingle::default() },
        }))
    }

    /// Which unknowns are fixed in what preconditions, of what is even and of what is odd; none
    /// over an inverted image.
    pub fn halves(&mut self, interface: &PairInterface, rows: &[Rows<f64>], prescribed: &[bool]) -> Option<[Vec<bool>; 2]> {
        let Cycles::Mirrored(halves) = &mut self.cycles else { return None };
        halves.fix(&self.tie.contact_nodes, interface, rows, prescribed);
        Some([halves.even.fixed.clone(), halves.odd.fixed.clone()])
    }

    /// Has its V-cycles smooth with a matrix that is rounded as on a device.
    #[must_use]
    pub fn with_rounded_smoothers(mut self) -> Self {
        if let Cycles::Mirrored(halves) = &mut self.cycles {
            halves.even.round_smoothers();
            halves.odd.round_smoothers();
        }
        self
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
            Cycles::Mirrored(halves) => halves.refresh(&self.tie, prescribed),
            Cycles::Turned(halves) => halves.refresh(&self.tie, prescribed),
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
            Cycles::Mirrored(halves) => halves.add(self.tie.symmetric, &work.f, &mut work.u),
            Cycles::Turned(halves) => halves.add(self.tie.symmetric, &work.f, &mut work.u),
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

//! The linear systems of an equal pair, in the unknowns of its interface (see
//! [`crate::contact::pair`]).
//!
//! What preconditions knows of a pair that has not slid: a field that is even in x touches its
//! image along the normal alone and slides freely, an odd one is held along the plane alone. So the
//! right-hand side is split into its even and odd parts, and each goes through a V-cycle of its
//! own, on half of the body (see [`crate::linalg::fold`]). Up to the first shear all is even.
//!
//! Of an inverted image that holds of what is even or odd when the body is turned half round z.
//! Even then is what is even in both x and y, or odd in both; odd what is even in one of them
//! alone. Each of the four goes through a V-cycle on a quarter of the body.

use super::half::{HalfCycle, folded_fixed};
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
    /// On a quarter of it, of an inversion.
    Quarters(Box<Quarters>),
}

/// The V-cycles of half of the body for what is even in x, and what is odd.
#[derive(Debug)]
struct Halves {
    fold: Fold,
    even: HalfCycle,
    odd: HalfCycle,
}

/// The V-cycles of a quarter of the body for what is even or odd in x and in y.
#[derive(Debug)]
struct Quarters {
    in_x: Fold,
    in_y: Fold,
    parts: Vec<Quarter>,
    /// Of the half at x >= 0.
    forces: Vec<f32>,
    displacements: Vec<f64>,
    fixed: Vec<bool>,
}

/// What has one parity in x, and one in y, which is its cycle's.
#[derive(Debug)]
struct Quarter {
    in_x: Parity,
    /// Whether the half turn round z leaves it as it is.
    is_even: bool,
    cycle: HalfCycle,
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
        let Some(fold) = Fold::new(pattern, &half.node, mirror, 0) else { return Ok(None) };
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

impl Quarters {
    fn new(mesh: &Mesh, pattern: &Pattern, turn: &Symmetry) -> Result<Option<Self>, LinalgError> {
        let mirror = Symmetry::mirror(mesh).nodes;
        let Some((half, quarter)) = mesh.half.as_ref().and_then(|half| Some((half, half.quarter.as_ref()?))) else {
            return Ok(None);
        };
        if turn.nodes.is_empty() || mirror.is_empty() {
            return Ok(None);
        }
        let mut place = vec![u32::MAX; pattern.rows()];
        (0..).zip(&half.node).for_each(|(a, &n)| place[n as usize] = a);
        let nodes: Vec<u32> = quarter.node.iter().map(|&n| place[n as usize]).collect();
        let in_y = |node: u32| turn.nodes[mirror[node as usize] as usize];
        let across: Vec<u32> = half.node.iter().map(|&n| place[in_y(n) as usize]).collect();
        let Some(in_x) = Fold::new(pattern, &half.node, &mirror, 0) else { return Ok(None) };
        let Some(in_y) = Fold::new(&in_x.matrix.pattern, &nodes, &across, 1) else { return Ok(None) };
        let hierarchy = Hierarchy::new(&in_y.matrix.pattern, &quarter.hierarchy)?;
        let parts = Parity::ALL.into_iter().flat_map(|x| Parity::ALL.map(|y| (x, y)));
        let parts = parts.map(|(in_x, in_y)| Quarter {
            in_x,
            is_even: in_x == in_y,
            cycle: HalfCycle::new(in_y, hierarchy.clone(), nodes.len()),
        });
        let n = 3 * half.node.len();
        Ok(Some(Self {
            parts: parts.collect(),
            forces: vec![0.0; n],
            displacements: vec![0.0; n],
            fixed: vec![false; n],
            in_x,
            in_y,
        }))
    }

    /// Points that touch are held along the normal in what is even, and those that stick along the
    /// plane in what is odd: where their images in x and y do so as well, as what is held here can
    /// move nowhere.
    fn refresh(&mut self, tie: &Tie<PairInterface>, prescribed: &[bool]) -> Result<(), LinalgError> {
        self.in_x.update(&tie.matrix);
        self.in_y.update(&self.in_x.matrix);
        let status = |node: u32| {
            let contact = tie.contact_nodes.binary_search(&node).ok()?;
            Some(tie.rows[tie.interface.slaves[tie.interface.facing()[contact]?]].status)
        };
        for part in self.parts.iter_mut().filter(|part| part.is_even || !tie.symmetric) {
            folded_fixed(&self.in_x, part.in_x, prescribed, &mut self.fixed);
            part.cycle.fix(&self.in_y, &self.fixed);
            for (fixed, &[a, b]) in part.cycle.fixed.as_chunks_mut::<3>().0.iter_mut().zip(self.in_y.nodes()) {
                let [a, b] = [a, b].map(|half| self.in_x.nodes()[half as usize]);
                let turned = [[a[0], b[1]], [a[1], b[0]]];
                let held =
                    |is_held: fn(Status) -> bool| turned.iter().all(|pair| pair.iter().filter_map(|&n| status(n)).any(is_held));
                if part.is_even {
                    fixed[2] |= held(|status| status != Status::Open);
                } else if held(|status| status == Status::Stick) {
                    fixed[..2].fill(true);
                }
            }
            part.cycle.update(&self.in_y)?;
        }
        Ok(())
    }

    /// Adds to `u` what the V-cycles make of the forces `f`.
    fn add(&mut self, is_even: bool, f: &[f64], u: &mut [f64]) {
        for parity in Parity::ALL {
            self.in_x.fold(parity, f, &mut self.forces);
            self.displacements.fill(0.0);
            for part in self.parts.iter_mut().filter(|part| part.in_x == parity && (part.is_even || !is_even)) {
                part.cycle.add(&self.in_y, &self.forces, &mut self.displacements);
            }
            self.in_x.unfold_add(parity, &self.displacements, u);
        }
    }
}

impl PairSolver {
    /// Plans a solver for a mesh with this symmetry, its mirror in x for a half turn and its half
    /// turn round z for an inversion; `None` if it has none, or if elements cross x = 0, or for an
    /// inversion y = 0.
    ///
    /// # Errors
    /// [`LinalgError::Hierarchy`] if the prolongations do not fit.
    pub fn new(mesh: &Mesh, pattern: &Pattern, symmetry: &Symmetry, image: Image) -> Result<Option<Self>, LinalgError> {
        let cycles = match image {
            Image::HalfTurn => Halves::new(mesh, pattern, &symmetry.nodes)?.map(|halves| Cycles::Halves(Box::new(halves))),
            Image::Inversion => Quarters::new(mesh, pattern, symmetry)?.map(|quarters| Cycles::Quarters(Box::new(quarters))),
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
            Cycles::Quarters(quarters) => quarters.refresh(&self.tie, prescribed),
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
            Cycles::Quarters(quarters) => quarters.add(self.tie.symmetric, &work.f, &mut work.u),
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

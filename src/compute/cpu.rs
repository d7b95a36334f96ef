//! The CPU backend, in f64 (the reference) or f32 (the twin of the single-precision device); or in
//! f64 with tangents in f32, which is what runs use.

use std::sync::Arc;

use rayon::prelude::*;

use super::gather::GatherPlan;
use super::linear::Solved;
use super::sweep::{Keep, WaveSweep};
use super::{
    About, Answer, Call, CaseFields, CaseModel, CaseState, Compute, ComputeError, Description, Energies, Evaluated, Fault,
    TangentBlocks,
};
use crate::contact::coulomb::{CONTACT_WEIGHT, Friction, Point, Rows, contact_rows};
use crate::contact::frame::to_frame;
use crate::contact::rigid::Rigid;
use crate::element::hex8::{self, ElementGeometry, ElementState, Invalid, NODES, Nodal, Points, Tangent, pair};
use crate::lanes::array;
use crate::material::multistep::Flow;
use crate::material::{Material, PointState};
use crate::mesh::Mesh;
use crate::real::Real;

/// Elements handed to a thread at a time: enough work to outweigh the handing.
const CHUNK: usize = 64;
/// The same for tangents and block rows, which take longer and of which a wave has few: enough of
/// them for many threads.
const WAVE_CHUNK: usize = 16;
/// Change of an element's displacement gradient within a step up to which a tangent in single
/// precision that was formed before is taken again. It is off by about as much, a thousandth of
/// what linear systems are solved to; at ten times that, converged forces were 4e-6 from those of a
/// device, which forms all anew. What yields, or is soon to, is formed anew. Half and twice of it:
/// `benches/constants`.
const SAME_TANGENT: f64 = 1e-4;
/// Up to this bulk over shear modulus, that of nu = 0.3; beyond, the more volume outweighs shape,
/// the less, as linear systems are solved to less (see `solver::loosest_linear`).
const SAME_UP_TO: f64 = 13.0 / 6.0;

/// One case as the CPU holds it; its tangents are formed in `T`.
struct CpuCase<R, T> {
    material: Material<R>,
    /// Material of the elements from this one on.
    opponent: (usize, Material<R>),
    friction: Friction<R>,
    /// Of a rigid opponent.
    surface: Rigid,
    mesh: Arc<Mesh>,
    geometry: Vec<ElementGeometry<R>>,
    /// What tangents take of material and geometry.
    tangent_material: Material<T>,
    tangent_opponent: Material<T>,
    tangent_geometry: Vec<ElementGeometry<T>>,
    /// Committed state of each element.
    state: Vec<ElementState<R>>,
    /// The states from which the present step starts.
    start: Vec<Points<R>>,
    /// Committed displacement, three a node.
    committed: Vec<f64>,
    /// Weight c of each contact node.
    weight: Vec<R>,
    on_symmetry_plane: Vec<bool>,
    /// How far the nodes of an element may move against its first before its tangent is formed
    /// anew, if it does not yield before.
    reach: Vec<T>,
    /// Shortest distance between two of its nodes.
    size: Vec<T>,
    /// Counts the changes of what steps start from: tangents of another step are not taken again.
    step: u64,
}

/// The tangent of an element, and where it was formed.
#[derive(Clone)]
struct KeptTangent<T> {
    tangent: Tangent<T>,
    step: u64,
    increment: Nodal<T>,
    /// How far a node may have moved since, against the first.
    reach: T,
}

impl<T: Real> KeptTangent<T> {
    const NONE: Self = Self { tangent: [[T::ZERO; 9]; hex8::PAIRS], step: 0, increment: [[T::ZERO; 3]; NODES], reach: T::ZERO };

    /// Whether it will do for an increment of a step.
    #[inline(always)]
    fn holds(&self, step: u64, increment: &Nodal<T>) -> bool {
        let moved = |a: usize, i: usize| (increment[a][i] - increment[0][i]) - (self.increment[a][i] - self.increment[0][i]);
        // Not so of a NaN.
        self.step == step && (1..NODES).all(|a| (0..3).all(|i| moved(a, i).abs() < self.reach))
    }
}

/// Evaluates a batch on the CPU's cores, residuals and states in `R` and tangents in `T`.
///
/// A tangent in f32 costs two thirds of one in f64, and is as good: the multigrid levels are in f32
/// anyway, and the residual alone decides what a converged step is. For the same reason it is not
/// formed for each iteration of a step where an elastic element has hardly moved since it was.
/// Tangents in `R` are exact.
pub struct Cpu<R, T = R> {
    models: Vec<CaseModel>,
    cases: Vec<CpuCase<R, T>>,
    plan: GatherPlan,
    element_force: Vec<Nodal<R>>,
    sweep: WaveSweep,
    /// Tangents of the elements within the sweep's front, or of all elements, of each case.
    element_tangent: Vec<Vec<KeptTangent<T>>>,
    /// State and elastic energy of each element at the end of a step, before it is committed.
    next: Vec<(ElementState<R>, R)>,
}

impl<R: Real> Cpu<R> {
    /// Takes a batch of cases in their undeformed, virgin state; everything is in `R`.
    ///
    /// # Errors
    /// [`ComputeError::Connectivity`], [`ComputeError::InvertedMesh`].
    pub fn new(models: Vec<CaseModel>) -> Result<Self, ComputeError> {
        Self::with_tangents(models)
    }
}

impl<R: Real, T: Real> Cpu<R, T> {
    /// As [`Cpu::new`], with tangents in `T`.
    ///
    /// # Errors
    /// As [`Cpu::new`].
    pub fn with_tangents(models: Vec<CaseModel>) -> Result<Self, ComputeError> {
        let Some(first) = models.first() else {
            return Ok(Self {
                models,
                cases: Vec::new(),
                plan: GatherPlan { pattern: crate::mesh::pattern::Pattern::from_elements(0, &[]), offset: Vec::new() },
                element_force: Vec::new(),
                sweep: WaveSweep::default(),
                element_tangent: Vec::new(),
                next: Vec::new(),
            });
        };
        let plan = GatherPlan::new(&first.mesh);
        let elements = first.mesh.elements.len();
        for (case, model) in models.iter().enumerate() {
            if !model.is_alike(first) {
                return Err(ComputeError::Connectivity { case });
            }
        }
        let cases = models.iter().map(CpuCase::new).collect::<Result<_, _>>()?;
        // The front of one case has room for the next one's.
        let (keep, kept) = if takes_again::<R, T>() { (Keep::All, models.len()) } else { (Keep::Front, 1) };
        let sweep = WaveSweep::new(&first.mesh, keep);
        Ok(Self {
            models,
            cases,
            plan,
            element_force: vec![[[R::ZERO; 3]; NODES]; elements],
            element_tangent: vec![vec![KeptTangent::NONE; sweep.slots()]; kept],
            sweep,
            next: Vec::new(),
        })
    }
}

impl<R: Real, T: Real> CpuCase<R, T> {
    fn new(model: &CaseModel) -> Result<Self, ComputeError> {
        let mesh = model.mesh.clone();
        let opponent = model.opponent.as_ref().unwrap_or(&model.material);
        let size: Vec<f64> = (0..mesh.elements.len()).map(|element| size(&mesh.corners(element))).collect();
        let same = |element: usize| {
            let Material { elasticity, .. } = if element < model.opponent_from() { &model.material } else { opponent };
            SAME_TANGENT * (SAME_UP_TO * elasticity.shear / elasticity.bulk).min(1.0)
        };
        let mut on_plane = vec![false; mesh.nodes.len()];
        mesh.symmetry_nodes.iter().for_each(|&n| on_plane[n as usize] = true);
        Ok(Self {
            material: model.material.cast(),
            opponent: (model.opponent_from(), opponent.cast()),
            tangent_material: model.material.cast(),
            tangent_opponent: opponent.cast(),
            friction: match model.friction {
                Friction::Coulomb(mu) => Friction::Coulomb(R::of(mu)),
                Friction::Stick => Friction::Stick,
            },
            surface: model.surface,
            state: vec![ElementState::default(); mesh.elements.len()],
            start: vec![Points::default(); mesh.elements.len()],
            committed: vec![0.0; 3 * mesh.nodes.len()],
            weight: mesh.contact_size.iter().map(|&h| R::of(CONTACT_WEIGHT * h)).collect(),
            on_symmetry_plane: mesh.contact_nodes.iter().map(|&n| on_plane[n as usize]).collect(),
            reach: size.iter().enumerate().map(|(e, size)| T::of(size * same(e))).collect(),
            size: size.iter().map(|size| T::of(*size)).collect(),
            step: 1,
            geometry: geometry_of(&mesh)?,
            tangent_geometry: geometry_of(&mesh)?,
            mesh,
        })
    }

    #[inline(always)]
    fn material(&self, element: usize) -> &Material<R> {
        if element < self.opponent.0 { &self.material } else { &self.opponent.1 }
    }

    #[inline(always)]
    fn tangent_material(&self, element: usize) -> &Material<T> {
        if element < self.opponent.0 { &self.tangent_material } else { &self.tangent_opponent }
    }

    /// Committed displacement and increment at an element's corners; the increment is formed in f64
    /// and rounded once.
    #[inline(always)]
    fn nodal<N: Real>(&self, element: usize, displacement: &[f64]) -> (Nodal<N>, Nodal<N>) {
        let nodes = &self.mesh.elements[element];
        let mut committed = [[N::ZERO; 3]; NODES];
        let mut increment = [[N::ZERO; 3]; NODES];
        for a in 0..NODES {
            let base = 3 * nodes[a] as usize;
            for i in 0..3 {
                let u = self.committed[base + i];
                committed[a][i] = N::of(u);
                increment[a][i] = N::of(displacement[base + i] - u);
            }
        }
        let hanging = self.mesh.hanging[element];
        if !hanging.is_none() {
            hanging.to_corners(&mut committed);
            hanging.to_corners(&mut increment);
        }
        (committed, increment)
    }

    /// The tangent into `blocks`, wave by wave of elements: a row is summed when the last of its
    /// elements is there.
    fn tangent<B: Real>(
        &self,
        (plan, sweep, tangents): (&GatherPlan, &WaveSweep, &mut [KeptTangent<T>]),
        displacement: &[f64],
        blocks: &mut [[B; 9]],
    ) -> Evaluated {
        let mut rows = block_rows(plan, blocks);
        for (elements, complete) in sweep.waves() {
            let slot = sweep.slot(elements.start);
            let out = &mut tangents[slot..slot + elements.len()];
            let outcome =
                self.each_element(elements.start, WAVE_CHUNK, displacement, out, |case, e, committed, increment, out| {
                    if takes_again::<R, T>() && out.holds(case.step, increment) {
                        return Ok(());
                    }
                    let start = &case.start[e].map(|p| PointState { be: p.be.map(convert), alpha: convert(p.alpha) });
                    let (geometry, material) = (&case.tangent_geometry[e], case.tangent_material(e));
                    out.step = 0;
                    let margin = hex8::tangent(geometry, material, start, committed, increment, &mut out.tangent)?;
                    let hanging = case.mesh.hanging[e];
                    if !hanging.is_none() {
                        hanging.to_named_tangent(&mut out.tangent, pair);
                    }
                    (out.step, out.increment) = (case.step, *increment);
                    out.reach = case.reach[e].min(case.size[e] * margin);
                    Ok(())
                });
            if outcome != Evaluated::Valid {
                return outcome;
            }
            let mut complete: Vec<_> = complete.iter().map(|&node| (node, std::mem::take(&mut rows[node as usize]))).collect();
            let tangents = &*tangents;
            complete.par_iter_mut().with_min_len(WAVE_CHUNK).for_each(|(node, row)| {
                gather_row(plan, &self.mesh, *node as usize, |element| &tangents[sweep.slot(element)].tangent, row);
            });
        }
        Evaluated::Valid
    }

    /// Evaluates `f` on the elements from `first` on into `out`, so many at a time in each thread;
    /// the first invalid element by index is reported.
    fn each_element<N: Real, O: Send>(
        &self,
        first: usize,
        at_a_time: usize,
        displacement: &[f64],
        out: &mut [O],
        f: impl Fn(&Self, usize, &Nodal<N>, &Nodal<N>, &mut O) -> Result<(), Invalid> + Sync,
    ) -> Evaluated {
        out.par_chunks_mut(at_a_time)
            .enumerate()
            .map(|(chunk, out)| {
                for (i, out) in out.iter_mut().enumerate() {
                    let element = first + chunk * at_a_time + i;
                    let (committed, increment) = self.nodal(element, displacement);
                    if let Err(invalid) = f(self, element, &committed, &increment, out) {
                        return Some((element, invalid));
                    }
                }
                None
            })
            .reduce(
                || None,
                |a, b| match (a, b) {
                    (Some(x), Some(y)) => Some(if x.0 <= y.0 { x } else { y }),
                    (x, y) => x.or(y),
                },
            )
            .map_or(Evaluated::Valid, |(element, invalid)| Evaluated::Invalid(Fault::of(element, invalid)))
    }
}

impl<R: Real, T: Real> Compute for Cpu<R, T> {
    fn models(&self) -> &[CaseModel] {
        &self.models
    }

    fn about(&self) -> About {
        let threads = rayon::current_num_threads();
        let device = format!("CPU ({threads} thread{})", if threads == 1 { "" } else { "s" });
        About::plain(Description { device, precision: R::NAME })
    }

    fn call(&mut self, calls: Vec<(usize, Call)>) -> Result<Vec<Answer>, ComputeError> {
        calls.into_iter().map(|(case, call)| self.answer(case, call)).collect()
    }
}

impl<R: Real, T: Real> Cpu<R, T> {
    fn answer(&mut self, case: usize, call: Call) -> Result<Answer, ComputeError> {
        Ok(match call {
            Call::BeginStep(weight) => {
                self.begin_step(case, weight);
                Answer::Done
            }
            Call::Force { displacement } => self.internal_force(case, &displacement),
            Call::Tangent { displacement, blocks } => self.tangent(case, &displacement, blocks),
            Call::Contact { displacement, force } => self.contact(case, &displacement, &force),
            Call::Commit { displacement } => self.commit(case, &displacement),
            Call::Fields => Answer::Fields(self.fields(case)?),
            Call::State => Answer::State(self.state(case)),
            Call::Restore(state) => {
                self.restore(case, &state);
                Answer::Done
            }
            Call::Replace(model) => {
                self.replace(case, *model)?;
                Answer::Replaced(true)
            }
            Call::Solve(_) => Answer::Solved(Solved::not_tried()),
            Call::Iterate(_) => return Err(ComputeError::Device("the CPU keeps no iterates".to_owned())),
        })
    }

    fn begin_step(&mut self, case: usize, weight: f64) {
        let case = &mut self.cases[case];
        case.step += 1;
        let weight = R::of(weight);
        case.start.par_iter_mut().zip(&case.state).with_min_len(CHUNK).for_each(|(start, state)| *start = state.start(weight));
    }

    fn internal_force(&mut self, case: usize, displacement: &[f64]) -> Answer {
        let case = &self.cases[case];
        let mut force = vec![0.0; displacement.len()];
        let outcome = case.each_element(0, CHUNK, displacement, &mut self.element_force, |case, e, committed, increment, out| {
            *out = hex8::internal_force(&case.geometry[e], case.material(e), &case.start[e], committed, increment)?;
            let hanging = case.mesh.hanging[e];
            if !hanging.is_none() {
                hanging.to_named(out);
            }
            Ok(())
        });
        let (lists, element_force) = (&case.mesh.node_elements, &self.element_force);
        force.par_chunks_mut(3 * CHUNK).enumerate().for_each(|(chunk, out)| {
            for (i, out) in out.chunks_exact_mut(3).enumerate() {
                let node = chunk * CHUNK + i;
                let mut sum = [R::ZERO; 3];
                for &entry in &lists.entry[lists.list(node)] {
                    let f = &element_force[entry as usize / 8][entry as usize % 8];
                    for (s, &f) in sum.iter_mut().zip(f) {
                        *s += f;
                    }
                }
                for (out, s) in out.iter_mut().zip(sum) {
                    *out = s.to_f64();
                }
            }
        });
        Answer::Force { force, outcome }
    }

    fn tangent(&mut self, case: usize, displacement: &[f64], blocks: TangentBlocks) -> Answer {
        let tangents = case.min(self.element_tangent.len() - 1);
        let case = &self.cases[case];
        let assembly = (&self.plan, &self.sweep, self.element_tangent[tangents].as_mut_slice());
        let mut blocks = blocks.resized(self.plan.pattern.entries());
        let outcome = match &mut blocks {
            TangentBlocks::Double(blocks) => case.tangent(assembly, displacement, blocks),
            TangentBlocks::Single(blocks) => case.tangent(assembly, displacement, blocks),
        };
        Answer::Tangent { blocks, outcome }
    }

    /// Of displacements and forces at the contact nodes.
    fn contact(&self, case: usize, displacement: &[f64], force: &[f64]) -> Answer {
        let case = &self.cases[case];
        let nodes = case.mesh.contact_nodes.iter().enumerate();
        let numbers = displacement.as_chunks::<3>().0.iter().zip(force.as_chunks::<3>().0);
        let rows = nodes.zip(numbers).map(|((i, &node), (u, force))| {
            let (start, reference) = (&case.committed[3 * node as usize..][..3], case.mesh.nodes[node as usize]);
            // Formed in f64: a gap is a small difference of larger numbers.
            let x = std::array::from_fn(|c| reference[c] + u[c]);
            let frame = case.surface.frame(&x);
            let [along, across, _] = to_frame(&frame, &std::array::from_fn(|c| u[c] - start[c]));
            let point = Point {
                force: to_frame(&frame, force).map(R::of),
                gap: R::of(case.surface.gap(&x)),
                slip: [along, across].map(R::of),
                weight: case.weight[i],
                on_symmetry_plane: case.on_symmetry_plane[i],
            };
            widen(&contact_rows(case.friction, &point))
        });
        Answer::Contact(rows.collect())
    }

    fn commit(&mut self, index: usize, displacement: &[f64]) -> Answer {
        let case = &self.cases[index];
        let mut energies = Energies::default();
        self.next.resize(case.state.len(), (ElementState::default(), R::ZERO));
        let outcome = case.each_element(0, CHUNK, displacement, &mut self.next, |case, e, committed, increment, out| {
            let (state, start) = (&case.state[e], &case.start[e]);
            *out = hex8::update(&case.geometry[e], case.material(e), state, start, committed, increment)?;
            Ok(())
        });
        if outcome == Evaluated::Valid {
            let case = &mut self.cases[index];
            let opponent = case.opponent.0;
            for (e, ((state, start), (next, elastic))) in case.state.iter_mut().zip(&mut case.start).zip(&self.next).enumerate() {
                if e >= opponent {
                    energies.opponent_plastic += next.plastic_work.to_f64();
                }
                *state = *next;
                *start = next.points;
                energies.elastic += elastic.to_f64();
                energies.plastic += next.plastic_work.to_f64();
                energies.max_alpha = next.points.iter().fold(energies.max_alpha, |m, p| m.max(p.alpha.to_f64()));
            }
            case.step += 1;
            case.committed.copy_from_slice(displacement);
        }
        Answer::Commit { energies, outcome }
    }

    fn fields(&self, case: usize) -> Result<CaseFields, ComputeError> {
        let case = &self.cases[case];
        let mut out = vec![([0.0; 6], 0.0, 0.0_f64); case.state.len()];
        let outcome = case.each_element(0, CHUNK, &case.committed, &mut out, |case, e, committed, _, out| {
            let geometry = &case.geometry[e];
            let fields = hex8::fields(geometry, case.material(e), &case.state[e].points, committed)?;
            for q in 0..hex8::QUADRATURE_POINTS {
                let share = (geometry.volume.0[q] / geometry.total_volume).to_f64();
                let alpha = case.state[e].points[q].alpha.to_f64();
                for (mean, s) in out.0.iter_mut().zip(fields.stress[q]) {
                    *mean += share * s.to_f64();
                }
                out.1 += share * alpha;
                out.2 = out.2.max(alpha);
            }
            Ok(())
        });
        outcome.check().map_err(|fault| ComputeError::Device(format!("the committed state is invalid: {fault}")))?;
        Ok(CaseFields {
            stress: out.iter().map(|o| o.0).collect(),
            alpha: out.iter().map(|o| o.1).collect(),
            max_alpha: out.iter().fold(0.0, |m, o| m.max(o.2)),
        })
    }

    fn state(&self, case: usize) -> CaseState {
        let case = &self.cases[case];
        CaseState {
            displacement: case.committed.clone(),
            points: case
                .state
                .iter()
                .map(|s| s.points.map(|p| PointState { be: p.be.map(R::to_f64), alpha: p.alpha.to_f64() }))
                .collect(),
            flow: case
                .state
                .iter()
                .map(|s| s.flow.map(|f| Flow { strain: f.strain.map(R::to_f64), alpha: f.alpha.to_f64() }))
                .collect(),
            plastic_work: case.state.iter().map(|s| s.plastic_work.to_f64()).collect(),
        }
    }

    fn replace(&mut self, case: usize, model: CaseModel) -> Result<(), ComputeError> {
        if !model.is_alike(&self.models[case]) {
            return Err(ComputeError::Connectivity { case });
        }
        self.cases[case] = CpuCase::new(&model)?;
        // Tangents are known by the step that they are of, which is counted anew.
        if let Some(held) = self.element_tangent.get_mut(case) {
            held.fill(KeptTangent::NONE);
        }
        self.models[case] = model;
        Ok(())
    }

    fn restore(&mut self, case: usize, state: &CaseState) {
        let case = &mut self.cases[case];
        case.step += 1;
        case.committed.clone_from(&state.displacement);
        for (e, s) in case.state.iter_mut().enumerate() {
            s.points = state.points[e].map(|p| PointState { be: p.be.map(R::of), alpha: R::of(p.alpha) });
            s.flow = state.flow[e].map(|f| Flow { strain: f.strain.map(R::of), alpha: R::of(f.alpha) });
            s.plastic_work = R::of(state.plastic_work[e]);
            case.start[e] = s.points;
        }
    }
}

/// Whether a tangent may be taken again: where it is less exact than the residual anyway.
fn takes_again<R: Real, T: Real>() -> bool {
    R::EPSILON.to_f64() < T::EPSILON.to_f64()
}

/// The shortest distance between two nodes.
fn size(nodes: &[[f64; 3]; NODES]) -> f64 {
    let distance = |a: usize, b: usize| (0..3).map(|i| (nodes[a][i] - nodes[b][i]).powi(2)).sum::<f64>().sqrt();
    (1..NODES).flat_map(|a| (0..a).map(move |b| distance(a, b))).fold(f64::INFINITY, f64::min)
}

/// A number in another precision, rounded once.
#[inline(always)]
fn convert<R: Real, T: Real>(x: R) -> T {
    T::of(x.to_f64())
}

fn geometry_of<R: Real>(mesh: &Mesh) -> Result<Vec<ElementGeometry<R>>, ComputeError> {
    let of_element = |element: usize| {
        ElementGeometry::new(&mesh.corners(element))
            .map_err(|invalid| ComputeError::InvertedMesh { element, point: invalid.point() })
    };
    (0..mesh.elements.len()).map(of_element).collect()
}

/// The blocks of each node's row; `blocks` in the order of the plan's pattern.
fn block_rows<'a, B>(plan: &GatherPlan, blocks: &'a mut [[B; 9]]) -> Vec<&'a mut [[B; 9]]> {
    let mut rows = Vec::with_capacity(plan.pattern.rows());
    let mut rest = blocks;
    for node in 0..plan.pattern.rows() {
        let (row, tail) = rest.split_at_mut(plan.pattern.row(node).len());
        rows.push(row);
        rest = tail;
    }
    rows
}

/// Sums the tangents of the elements around a node into its block row, in the order of the node's
/// elements.
fn gather_row<'a, R: Real, B: Real>(
    plan: &GatherPlan,
    mesh: &Mesh,
    node: usize,
    tangent_of: impl Fn(usize) -> &'a Tangent<R>,
    row: &mut [[B; 9]],
) {
    let lists = &mesh.node_elements;
    row.fill([B::ZERO; 9]);
    for entry_index in lists.list(node) {
        let entry = lists.entry[entry_index] as usize;
        let (tangent, a) = (tangent_of(entry / 8), entry % 8);
        let offset = &plan.offset[entry_index];
        // Of two nodes an element has the block of the lower one's row; the other's is transposed.
        for b in 0..a {
            let k = &tangent[pair(b, a)];
            add(&mut row[offset[b] as usize], [k[0], k[3], k[6], k[1], k[4], k[7], k[2], k[5], k[8]]);
        }
        for b in a..NODES {
            add(&mut row[offset[b] as usize], tangent[pair(a, b)]);
        }
    }
}

/// out += block, eight numbers at once and the last by itself.
#[inline(always)]
fn add<R: Real, B: Real>(out: &mut [B; 9], block: [R; 9]) {
    let eight = B::add_eight(array(B::ZERO, |m| out[m]), array(B::ZERO, |m| convert(block[m])));
    out[..8].copy_from_slice(&eight);
    out[8] += convert::<R, B>(block[8]);
}

fn widen<R: Real>(rows: &Rows<R>) -> Rows<f64> {
    Rows {
        status: rows.status,
        residual: rows.residual.map(R::to_f64),
        force_rows: rows.force_rows.map(|r| r.map(R::to_f64)),
        displacement_rows: rows.displacement_rows.map(|r| r.map(R::to_f64)),
        fixed: rows.fixed,
        weight: rows.weight.to_f64(),
    }
}

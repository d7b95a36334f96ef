//! Cases on a device: those of one mesh connectivity share it, and where one ends the next takes
//! its place.
//!
//! A batch of some size is two halves, each a backend of its own with half of the device's memory:
//! while the host deals with what one has found, the other one has the device.

use std::collections::{BTreeMap, VecDeque};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::Ordering;
use std::sync::{Mutex, MutexGuard, PoisonError};

use rayon::ThreadPool;
use rayon::prelude::*;

use super::StudyError;
use super::batch::{Guest, Host, Slot, share};
use super::schedule::{Finished, side_by_side};
use super::simulate::Simulator;
use crate::compute::select::{Devices, PrecisionChoice, Selected};
use crate::compute::{CaseModel, Compute, ComputeError};
use crate::mesh::{Hanging, Mesh};
use crate::output::Summary;
use crate::simulation::follow::seats;
use crate::simulation::problem::Problem;

/// From this number of cases on a batch is two halves. A device takes about as long for fewer cases
/// as for half of them.
const HALVED_FROM: usize = 8;

/// The backends that share so many cases.
pub fn backends(cases: usize) -> usize {
    if cases >= HALVED_FROM { 2 } else { 1 }
}

/// A case that has begun: what is to be computed, or what another process has made of it meanwhile.
enum Begun {
    Open(Box<Problem>),
    Done(Box<Summary>),
}

/// Cases of one connectivity that nobody computes yet.
struct Waiting {
    left: Mutex<VecDeque<usize>>,
    /// The problems of those that have begun.
    problems: Mutex<BTreeMap<usize, Problem>>,
}

impl Waiting {
    fn left(&self) -> MutexGuard<'_, VecDeque<usize>> {
        self.left.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn problems(&self) -> MutexGuard<'_, BTreeMap<usize, Problem>> {
        self.problems.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Begins a case, if it has not begun.
    fn begin(&self, simulator: &Simulator<'_>, case: usize) -> Result<Begun, StudyError> {
        if let Some(problem) = self.problems().remove(&case) {
            return Ok(Begun::Open(Box::new(problem)));
        }
        simulator.begin(case)?;
        match simulator.done_meanwhile(case) {
            Some(summary) => Ok(Begun::Done(Box::new(summary))),
            None => Ok(Begun::Open(Box::new(simulator.problem(case)?))),
        }
    }

    /// Puts a case that has begun back, in front of the others.
    fn put_back(&self, case: usize, problem: Problem) {
        self.problems().insert(case, problem);
        self.left().push_front(case);
    }

    /// Takes the next cases out, as many as `most`, and begins them; those of which there is
    /// nothing to compute are `finished`.
    fn take(
        &self,
        simulator: &Simulator<'_>,
        most: usize,
        finished: &mut Finished<'_>,
    ) -> Result<Vec<(usize, Problem)>, StudyError> {
        let cases: Vec<usize> = {
            let mut left = self.left();
            let count = most.min(left.len());
            left.drain(..count).collect()
        };
        let begun: Vec<_> = cases.into_par_iter().map(|case| (case, self.begin(simulator, case))).collect();
        let mut open = Vec::new();
        for (case, begun) in begun {
            let summary = match begun {
                Ok(Begun::Open(problem)) => {
                    open.push((case, *problem));
                    continue;
                }
                Ok(Begun::Done(summary)) => *summary,
                Err(error) => simulator.broke_off(case, &error.to_string()),
            };
            simulator.progress.started();
            finished(case, Ok(summary))?;
        }
        Ok(open)
    }
}

/// A place of a batch, and the case that it has from the beginning, up to when that is begun.
struct Desk {
    place: Slot,
    first: Mutex<Option<(usize, Problem)>>,
    /// What the user should know of how its device was chosen.
    notes: Vec<String>,
}

/// The backends of a batch, and the places of all of them.
type Opened = (Vec<Host>, Vec<Desk>);

impl Desk {
    fn first(&self) -> MutexGuard<'_, Option<(usize, Problem)>> {
        self.first.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Computes cases on a device, as many at a time as there are pools.
pub(super) fn on_device(
    simulator: &Simulator<'_>,
    devices: (&Devices, PrecisionChoice),
    pools: &[ThreadPool],
    order: &[usize],
    finished: &mut Finished<'_>,
) -> Result<(), StudyError> {
    for alike in by_connectivity(simulator, order) {
        let waiting = Waiting { left: Mutex::new(alike.into()), problems: Mutex::default() };
        let mut most = pools.len();
        while !simulator.stop.load(Ordering::Relaxed) && !waiting.left().is_empty() {
            let cases = waiting.take(simulator, most, finished)?;
            let Some((hosts, desks)) = open(simulator, devices, cases, &waiting, &mut most, finished)? else { continue };
            serve(simulator, devices, (hosts, desks), pools, &waiting, finished)?;
        }
    }
    Ok(())
}

/// The backends for these cases, two if they are many. Where they do not fit, half of the cases are
/// put back, and no more than that is tried from now on; a single one that fits nowhere is
/// `finished`. `None` if nothing is left.
fn open(
    simulator: &Simulator<'_>,
    (devices, precision): (&Devices, PrecisionChoice),
    mut cases: Vec<(usize, Problem)>,
    waiting: &Waiting,
    most: &mut usize,
    finished: &mut Finished<'_>,
) -> Result<Option<Opened>, StudyError> {
    while !cases.is_empty() {
        let backends = backends(cases.len());
        let models: Vec<CaseModel> = cases.iter().map(|(_, problem)| problem.model.clone()).collect();
        let chunks = models.chunks(models.len().div_ceil(backends));
        let opened: Result<Vec<Selected>, ComputeError> = if cases.len() > 1 {
            chunks.map(|models| devices.batch(backends as u64, precision, models.to_vec())).collect()
        } else {
            // Without the device as well, if it may be.
            devices.select(precision, models).map(|selected| vec![selected])
        };
        match opened {
            Ok(opened) => {
                let (mut hosts, mut desks) = (Vec::new(), Vec::new());
                let mut cases = cases.into_iter();
                for Selected { backend, notes } in opened {
                    let (host, places) = share(backend);
                    hosts.push(host);
                    desks.extend(places.into_iter().zip(&mut cases).map(|(place, case)| Desk {
                        place,
                        first: Mutex::new(Some(case)),
                        notes: notes.clone(),
                    }));
                }
                return Ok(Some((hosts, desks)));
            }
            Err(ComputeError::Device(reason)) if cases.len() > 1 => {
                *most = cases.len() / 2;
                log::info!("{} cases at a time are too many for the device ({reason}); {most} are tried", cases.len());
                for (case, problem) in cases.drain(*most..).rev() {
                    waiting.put_back(case, problem);
                }
            }
            Err(error) => {
                for (case, _) in cases.drain(..) {
                    simulator.progress.started();
                    finished(case, Ok(simulator.broke_off(case, &error.to_string())))?;
                }
            }
        }
    }
    Ok(None)
}

/// Computes the cases of the desks, and after them those that wait.
fn serve(
    simulator: &Simulator<'_>,
    (devices, precision): (&Devices, PrecisionChoice),
    (hosts, desks): Opened,
    pools: &[ThreadPool],
    waiting: &Waiting,
    finished: &mut Finished<'_>,
) -> Result<(), StudyError> {
    // A case that starts over on another mesh leaves the batch.
    let elsewhere = |problem: &Problem| devices.select(precision, vec![problem.model.clone()]);
    let follow = |case: usize, problem: Problem, guest: Guest, notes: &[String]| {
        let computed_on = guest.about().description;
        let mut seat = seats((Box::new(guest), 0), problem.zone, elsewhere);
        simulator.progress.started();
        simulator.follow(case, problem, &mut seat, computed_on, notes)
    };
    std::thread::scope(move |scope| {
        for host in hosts {
            // Should a backend panic, its guests find it gone, and that is their error.
            scope.spawn(|| catch_unwind(AssertUnwindSafe(|| devices.served(host.serve()))));
        }
        let next = |desk: usize| desks[desk].first().as_ref().map(|(case, _)| *case).or_else(|| waiting.left().pop_front());
        let work = |desk: usize, case: usize| -> Option<Summary> {
            let Desk { place, notes, .. } = &desks[desk];
            let first = desks[desk].first().take();
            let summary = match first {
                Some((_, problem)) => {
                    let guest = place.first(problem.model.clone());
                    follow(case, problem, guest, notes)
                }
                None => match waiting.begin(simulator, case) {
                    Ok(Begun::Open(problem)) => match place.next(&problem.model) {
                        Ok(Some(guest)) => follow(case, *problem, guest, notes),
                        // The device has failed, or has no room for it: for another batch.
                        Ok(None) | Err(ComputeError::Device(_)) => {
                            waiting.put_back(case, *problem);
                            return None;
                        }
                        Err(error) => Err(error.into()),
                    },
                    Ok(Begun::Done(summary)) => Ok(*summary),
                    Err(error) => Err(error),
                },
            };
            Some(summary.unwrap_or_else(|error| simulator.broke_off(case, &error.to_string())))
        };
        let outcome = side_by_side(&pools[..desks.len()], next, &simulator.stop, work, finished);
        // With the last of their places the hosts go.
        drop(desks);
        outcome
    })
}

/// The cases of `order` in groups that may share a batch (see [`CaseModel::is_alike`]); groups and
/// cases in the order in which they come. A case that has no mesh is a group of its own.
fn by_connectivity(simulator: &Simulator<'_>, order: &[usize]) -> Vec<Vec<usize>> {
    let key = |&case: &usize| match simulator.problem(case) {
        Ok(problem) => (connectivity(&problem.model.mesh), problem.model.image.map(|image| image as u8)),
        Err(_) => ((0, case as u64), None),
    };
    let keys: Vec<((usize, u64), Option<u8>)> = order.par_iter().map(key).collect();
    let mut groups: Vec<Vec<usize>> = Vec::new();
    let mut group_of = BTreeMap::new();
    for (&case, key) in order.iter().zip(keys) {
        let group = *group_of.entry(key).or_insert_with(|| {
            groups.push(Vec::new());
            groups.len() - 1
        });
        groups[group].push(case);
    }
    groups
}

/// Number of elements and a hash of their nodes, of their corners that hang and of the contact's
/// nodes (FNV-1a, Fowler, Noll & Vo 1991): equal where a batch can be shared.
fn connectivity(mesh: &Mesh) -> (usize, u64) {
    let corner = |hanging: &Hanging, a: usize| u64::from(hanging.hangs(a)) << 32 | (hanging.octant() as u64) << 33;
    let of_element = |(nodes, hanging): (&[u32; 8], &Hanging)| -> [u64; 8] {
        std::array::from_fn(|a| u64::from(nodes[a]) | corner(hanging, a))
    };
    let elements = mesh.elements.iter().zip(&mesh.hanging).flat_map(of_element);
    let numbers = elements.chain(mesh.contact_nodes.iter().map(|&node| node.into()));
    let hash = numbers.fold(0xcbf2_9ce4_8422_2325u64, |hash, number| (hash ^ number).wrapping_mul(0x0100_0000_01b3));
    (mesh.elements.len(), hash)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::brick::brick;

    #[test]
    fn meshes_with_other_corners_that_hang_share_no_batch() {
        let mesh = brick(1, 1, 1, [1.0; 3]).unwrap();
        let with = |octant: usize, corner: usize| {
            let hanging = vec![Hanging::new(octant, |a| a == corner)];
            connectivity(&Mesh { hanging, ..mesh.clone() })
        };
        let mut all = vec![connectivity(&mesh), with(0, 1), with(2, 1), with(0, 3), with(2, 3)];
        assert_eq!(all[1], with(0, 1));
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), 5);
    }
}

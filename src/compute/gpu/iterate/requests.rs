//! Requests as marks of slots, and what the slots answer.

use super::super::backend::Gpu;
use super::super::buffers::DeviceReal;
use super::super::dispatch::{Dispatch, status_of};
use super::super::linear::records::Solves;
use super::arrays::{CAME_OFF, SLIDES};
use super::marks::{Brought, Corrections, Readout, SlotMark, flags, number, source};
use crate::compute::call::not_asked;
use crate::compute::iterate::{
    Ask, Begin, Correct, Corrected, From, Plate, Reading, Reply, Request, Settled, SettledPoint, Vectors,
};
use crate::compute::linear::SideReport;
use crate::compute::{Answer, Call, ComputeError, Evaluated};
use crate::contact::coulomb::Friction;

/// What is asked of the iterates of a case, and the reply.
struct SlotRequest {
    case: usize,
    kept: bool,
    plate: Plate,
    ask: Ask,
    answer: Reply,
}

impl<R: DeviceReal> Gpu<R> {
    /// What [`Call::Iterate`] asks for.
    pub(in super::super) fn iterate(&mut self, calls: Vec<(usize, Call)>) -> Result<Vec<Answer>, ComputeError> {
        let asked = |(case, call)| match call {
            Call::Iterate(Request { kept, plate, ask }) => Ok(SlotRequest { case, kept, plate, ask, answer: Reply::Nothing }),
            _ => Err(not_asked()),
        };
        let mut requests = calls.into_iter().map(asked).collect::<Result<Vec<_>, _>>()?;
        self.answer_asked(&mut requests)?;
        Ok(requests.into_iter().map(|request| Answer::Iterate(request.answer)).collect())
    }

    fn answer_asked(&mut self, requests: &mut [SlotRequest]) -> Result<(), ComputeError> {
        let Some(kind) = requests.first().map(|request| std::mem::discriminant(&request.ask)) else { return Ok(()) };
        if requests.iter().any(|request| std::mem::discriminant(&request.ask) != kind) {
            return Err(ComputeError::Device("calls that go together ask for different things".to_owned()));
        }
        for request in requests.iter_mut().filter(|request| request.kept) {
            self.current[request.case] ^= 1;
        }
        match requests[0].ask {
            Ask::Begin(_) => self.begin_iterates(requests),
            Ask::Correct(_) => self.correct(requests),
            Ask::Try(..) => self.try_lengths(requests),
            Ask::Land => self.land(requests),
            Ask::Commit => self.settle(requests),
            Ask::Bring | Ask::Give(_) | Ask::Displacements | Ask::SetEarlier(_) => {
                requests.iter_mut().try_for_each(|request| self.transfer(request))
            }
        }
    }

    /// What all marks of a case have: from the current iterate to the other one.
    fn mark(&self, request: &SlotRequest) -> SlotMark {
        let current = self.current[request.case];
        let stick = self.models[request.case].friction == Friction::Stick;
        let mut mark = SlotMark { current, trial: 1 - current, ..SlotMark::default() };
        if request.kept && stick {
            mark.flags |= flags::LANDS;
        }
        if let Some(force) = request.plate.held {
            mark.flags |= flags::HOLDS_FORCE;
            mark.numbers[number::HELD_FORCE] = force;
        }
        mark.numbers[number::DEPTH] = request.plate.h;
        mark.numbers[number::SHEAR] = request.plate.delta_t;
        mark
    }

    /// Calls `serve` for the dispatches of some of the requests, given by their indices.
    fn dispatch(
        &mut self,
        requests: &mut [SlotRequest],
        some: &[usize],
        mut serve: impl FnMut(&mut Self, &Dispatch, &mut [&mut SlotRequest]) -> Result<(), ComputeError>,
    ) -> Result<(), ComputeError> {
        for dispatch in self.schedule(some.iter().map(|&i| requests[i].case)) {
            let mut chosen: Vec<(usize, &mut SlotRequest)> = requests
                .iter_mut()
                .enumerate()
                .filter_map(|(i, request)| dispatch.requests.iter().position(|&slot| some[slot] == i).map(|slot| (slot, request)))
                .collect();
            chosen.sort_by_key(|(slot, _)| *slot);
            let mut chosen: Vec<&mut SlotRequest> = chosen.into_iter().map(|(_, request)| request).collect();
            serve(self, &dispatch, &mut chosen)?;
        }
        Ok(())
    }

    fn begin_iterates(&mut self, requests: &mut [SlotRequest]) -> Result<(), ComputeError> {
        for request in requests.iter() {
            if let Ask::Begin(Begin { sliding: Some(sliding), .. }) = &request.ask {
                self.batch()?.set_sliding(request.case, sliding)?;
            }
        }
        let shifts = |request: &SlotRequest| matches!(request.ask, Ask::Begin(Begin { from: From::Shift(_), .. }));
        for shifted in [false, true] {
            let some: Vec<usize> = (0..requests.len()).filter(|&i| shifts(&requests[i]) == shifted).collect();
            self.dispatch(requests, &some, |gpu, dispatch, requests| {
                let marks: Vec<SlotMark> = requests.iter().map(|request| gpu.first_mark(request)).collect();
                let readouts = if shifted {
                    gpu.batch()?.assess_iterates(dispatch, &marks, true)?
                } else {
                    gpu.batch()?.try_iterates(dispatch, &marks)?
                };
                for ((request, readout), mark) in requests.iter_mut().zip(readouts).zip(&marks) {
                    let read = reading(&readout);
                    if read.outcome == Evaluated::Valid {
                        gpu.current[request.case] = mark.trial;
                    }
                    gpu.note(request.case, mark, &readout);
                    request.answer = Reply::Reading(alone(read));
                }
                Ok(())
            })?;
        }
        Ok(())
    }

    fn first_mark(&self, request: &SlotRequest) -> SlotMark {
        let mut mark = self.mark(request);
        let Ask::Begin(Begin { from, .. }) = &request.ask else { return mark };
        match *from {
            From::Extrapolation { ratio, lift } => {
                mark.source = source::EXTRAPOLATED;
                mark.flags |= flags::PLACES_PLATE | if lift { flags::LIFTS } else { 0 };
                mark.numbers[number::RATIO] = ratio;
            }
            From::Start => mark.source = source::AT_START,
            From::Shift([x, z]) => {
                mark.source = source::SHIFTED;
                mark.trial = mark.current;
                mark.flags |= flags::PLACES_PLATE;
                (mark.numbers[number::RATIO], mark.numbers[number::SHIFT_Z]) = (x, z);
            }
        }
        mark
    }

    fn correct(&mut self, requests: &mut [SlotRequest]) -> Result<(), ComputeError> {
        for held in [false, true] {
            let some: Vec<usize> = (0..requests.len()).filter(|&i| requests[i].plate.held.is_some() == held).collect();
            self.dispatch(requests, &some, |gpu, dispatch, requests| gpu.correct_alike(dispatch, requests))?;
        }
        Ok(())
    }

    /// Requests that all hold a force, or none of them.
    fn correct_alike(&mut self, dispatch: &Dispatch, requests: &mut [&mut SlotRequest]) -> Result<(), ComputeError> {
        let asks: Vec<Correct> =
            requests.iter().filter_map(|request| if let Ask::Correct(ask) = request.ask { Some(ask) } else { None }).collect();
        let marks: Vec<SlotMark> =
            requests.iter().zip(&asks).map(|(request, ask)| self.mark_of_correction(request, ask)).collect();
        let of = |tolerance: fn(&Correct) -> f64, relative: fn(&Correct) -> bool, expected: fn(&Correct) -> usize| {
            let tolerances: Vec<f32> = asks.iter().map(|ask| tolerance(ask) as f32).collect();
            let relative: Vec<bool> = asks.iter().map(relative).collect();
            Solves::new(&tolerances, &relative, asks.iter().map(expected).max().unwrap_or(0))
        };
        let correction = of(|ask| ask.tolerance, |_| false, |ask| ask.expected);
        let unit = of(|ask| ask.unit_tolerance, |ask| ask.first, |ask| ask.unit_expected);
        let Corrections { tangents, reports, units, readouts } =
            self.batch()?.correct_iterates(dispatch, &marks, [&correction, &unit])?;
        for (slot, request) in requests.iter_mut().enumerate() {
            let (readout, back) = (&readouts[slot], marks[slot].numbers[number::BACK]);
            self.note(request.case, &marks[slot], readout);
            let report = SideReport {
                rhs_norm: reports[slot].rhs_norm * back,
                start_norm: reports[slot].start_norm * back,
                residual: reports[slot].residual * back,
                along: reports[slot].along * back,
                ..reports[slot]
            };
            request.answer = Reply::Corrected(Corrected {
                tangent: tangents[slot],
                report,
                unit: units.get(slot).copied(),
                delta_h: if units.is_empty() { 0.0 } else { readout.numbers[8] },
                slope: readout.numbers[6],
                trial: reading(readout),
            });
        }
        Ok(())
    }

    fn mark_of_correction(&self, request: &SlotRequest, ask: &Correct) -> SlotMark {
        let mut mark = self.mark(request);
        mark.flags |= flags::PLACES_PLATE | if ask.first { flags::IS_FIRST } else { 0 };
        mark.numbers[number::STEP] = 1.0;
        mark.numbers[number::BACK] = 1.0 / scale(self.largest[request.case][mark.current as usize]);
        if let Some(force) = request.plate.held {
            mark.numbers[number::MISSING] = force - ask.plate_force;
        }
        mark
    }

    fn try_lengths(&mut self, requests: &mut [SlotRequest]) -> Result<(), ComputeError> {
        let all: Vec<usize> = (0..requests.len()).collect();
        self.dispatch(requests, &all, |gpu, dispatch, requests| {
            let marks: Vec<SlotMark> = requests.iter().map(|request| gpu.mark_at_length(request)).collect();
            let readouts = gpu.batch()?.try_iterates(dispatch, &marks)?;
            for ((request, readout), mark) in requests.iter_mut().zip(readouts).zip(&marks) {
                gpu.note(request.case, mark, &readout);
                request.answer = Reply::Reading(reading(&readout));
            }
            Ok(())
        })
    }

    fn mark_at_length(&self, request: &SlotRequest) -> SlotMark {
        let mut mark = self.mark(request);
        if let Ask::Try(length, delta_h) = request.ask {
            // Rounding must not leave the plate a hair from where it belongs.
            mark.flags |= if length == 1.0 { flags::PLACES_PLATE } else { 0 };
            (mark.numbers[number::STEP], mark.numbers[number::DEPTH_CHANGE]) = (length, delta_h);
        }
        mark
    }

    fn land(&mut self, requests: &mut [SlotRequest]) -> Result<(), ComputeError> {
        let all: Vec<usize> = (0..requests.len()).collect();
        self.dispatch(requests, &all, |gpu, dispatch, requests| {
            let marks: Vec<SlotMark> = requests
                .iter()
                .map(|request| {
                    let mark = gpu.mark(request);
                    SlotMark { trial: mark.current, ..mark }
                })
                .collect();
            let readouts = gpu.batch()?.assess_iterates(dispatch, &marks, false)?;
            for ((request, readout), mark) in requests.iter_mut().zip(readouts).zip(&marks) {
                gpu.note(request.case, mark, &readout);
                request.answer = Reply::Reading(alone(reading(&readout)));
            }
            Ok(())
        })
    }

    fn settle(&mut self, requests: &mut [SlotRequest]) -> Result<(), ComputeError> {
        let all: Vec<usize> = (0..requests.len()).collect();
        self.dispatch(requests, &all, |gpu, dispatch, requests| {
            let marks: Vec<SlotMark> = requests.iter().map(|request| gpu.mark(request)).collect();
            let committed = gpu.batch()?.commit_iterates(dispatch, &marks)?;
            for (request, committed) in requests.iter_mut().zip(committed) {
                gpu.fresh[request.case] = false;
                let count = committed.status.len();
                let point = |k: usize| {
                    let vector = |first: usize| std::array::from_fn(|i| committed.at_points[(first + i) * count + k]);
                    SettledPoint { displacement: vector(0), force: vector(3), status: status_of(committed.status[k]) }
                };
                request.answer = Reply::Settled(Settled {
                    outcome: committed.outcome,
                    energies: committed.energies,
                    points: (0..count).map(point).collect(),
                });
            }
            Ok(())
        })
    }

    /// What moves whole vectors, of one case.
    fn transfer(&mut self, request: &mut SlotRequest) -> Result<(), ComputeError> {
        let case = request.case;
        let numbers = |vector: Vec<R>| vector.iter().map(|x| x.to_f64()).collect::<Vec<f64>>();
        request.answer = match &request.ask {
            Ask::Bring => {
                self.refresh(case)?;
                let Brought { increments, forces, let_go } = self.batch()?.bring_iterate(case, self.current[case])?;
                let displacement = increments.iter().zip(&self.committed[case]).map(|(d, u)| u + d.to_f64()).collect();
                let [sliding, came_off] = [SLIDES, CAME_OFF].map(|bit| let_go.iter().map(|&bits| bits & bit != 0).collect());
                Reply::Vectors(Box::new(Vectors { displacement, force: numbers(forces), sliding, came_off }))
            }
            Ask::Give(correction) => {
                self.batch()?.give_correction(case, correction)?;
                Reply::Nothing
            }
            Ask::Displacements => {
                self.refresh(case)?;
                Reply::Displacements([self.committed[case].clone(), numbers(self.batch()?.earlier(case)?)])
            }
            Ask::SetEarlier(displacement) => {
                self.batch()?.set_earlier(case, displacement)?;
                Reply::Nothing
            }
            _ => Reply::Nothing,
        };
        Ok(())
    }

    /// The host's copy of a committed displacement, from the device where that has moved it.
    pub(in super::super) fn refresh(&mut self, case: usize) -> Result<(), ComputeError> {
        if !self.fresh[case] {
            self.committed[case] = self.batch()?.displacement(case)?.iter().map(|u| u.to_f64()).collect();
            self.fresh[case] = true;
        }
        Ok(())
    }

    /// Keeps what the host needs of a trial to scale the next system.
    fn note(&mut self, case: usize, mark: &SlotMark, readout: &Readout) {
        self.largest[case][mark.trial as usize] = readout.numbers[9];
    }
}

/// The power of two by which numbers as large as this come near to 1: systems are solved in single
/// precision, whose squares must not leave its range.
fn scale(largest: f64) -> f64 {
    let single = largest as f32;
    if !(single > 0.0 && single.is_finite()) {
        return 1.0;
    }
    f64::from(127 - ((single.to_bits() >> 23) & 0xff) as i32).exp2()
}

/// What is read of an iterate that no correction has led to.
fn alone(reading: Reading) -> Reading {
    Reading { slope: 0.0, released: 0.0, changed: 0, landed: 0, ..reading }
}

fn reading(readout: &Readout) -> Reading {
    let Readout { outcome, numbers, counts } = readout;
    if *outcome != Evaluated::Valid {
        return Reading::of_nothing(*outcome);
    }
    let read = Reading {
        outcome: *outcome,
        merit: numbers[0],
        force_scale: numbers[1],
        plate_force: numbers[2],
        tangential: numbers[3],
        normal_force: numbers[4],
        slope: numbers[5],
        released: numbers[7],
        changed: counts[0] as usize,
        landed: counts[1] as usize,
    };
    read.check().map_or_else(|fault| Reading::of_nothing(Evaluated::Invalid(fault)), |()| read)
}

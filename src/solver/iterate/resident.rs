//! Iterates whose vectors stay on the device: few numbers go there, few come back.

use super::host::HostIterate;
use super::linearise::{EXPECTED, UNIT_RESPONSE, no_depth, unit_share};
use super::{Asked, Correction, Extrapolation, Iterate, SetOut};
use crate::compute::handle::CaseHandle;
use crate::compute::iterate::{Ask, Begin, Correct, Corrected, From, Plate, Reading, Reply, Settled, Vectors};
use crate::compute::linear::Ended;
use crate::compute::{ComputeError, Evaluated, Fault};
use crate::contact::coulomb::Friction;
use crate::solver::outcome::{Halt, StepFailure, Worst};
use crate::solver::phases::{Lap, Phase, PhaseTimes};
use crate::solver::{Control, SolverError};

/// Iterates of one case on a device, and on the host for what the device does not do.
pub struct ResidentIterate {
    /// Iterates of steps that do not stay on the device, and the direct solver.
    pub host: HostIterate,
    /// Indentation of the current iterate.
    h: f64,
    is_placed: bool,
    /// Plate force of the current iterate.
    plate_force: f64,
    /// Change of h along the correction.
    delta_h: f64,
    /// The trial at the end of the correction, which came with it.
    whole: Option<Reading>,
    tried: Option<(f64, f64)>,
    /// What was tried last is the current iterate, which the device has not been told yet.
    kept: bool,
    /// Krylov iterations of the step's last system and of its response to a unit indentation.
    expected: [usize; 2],
    /// As [`HostIterate`] has it.
    unit_scale: f64,
}

impl ResidentIterate {
    /// Iterates of the same case.
    pub fn new(host: HostIterate) -> Self {
        Self {
            host,
            h: 0.0,
            is_placed: false,
            plate_force: 0.0,
            delta_h: 0.0,
            whole: None,
            tried: None,
            kept: false,
            expected: [EXPECTED; 2],
            unit_scale: 1.0,
        }
    }

    /// Commits the current iterate.
    ///
    /// # Errors
    /// [`SolverError::Compute`].
    pub fn settle(&mut self, case: &mut CaseHandle<'_>) -> Result<Settled, SolverError> {
        let kept = std::mem::take(&mut self.kept);
        match case.iterate(kept, Plate::default(), Ask::Commit)? {
            Reply::Settled(settled) => Ok(settled),
            other => Err(unexpected(&other)),
        }
    }

    fn plate(&self, control: &Control) -> Plate {
        Plate { h: self.h, delta_t: control.pose.shift[0], held: control.normal_force }
    }

    fn ask(&mut self, case: &mut CaseHandle<'_>, control: &Control, ask: Ask) -> Result<Reply, SolverError> {
        let kept = std::mem::take(&mut self.kept);
        Ok(case.iterate(kept, self.plate(control), ask)?)
    }

    fn ask_reading(&mut self, case: &mut CaseHandle<'_>, control: &Control, ask: Ask) -> Result<Reading, SolverError> {
        match self.ask(case, control, ask)? {
            Reply::Reading(reading) => Ok(reading),
            other => Err(unexpected(&other)),
        }
    }

    fn begin_from(&mut self, case: &mut CaseHandle<'_>, control: &Control, from: From) -> Result<Reading, SolverError> {
        let slides = &self.host.boundary().frictionless;
        let sliding = match from {
            From::Shift(_) => None,
            // Two bodies that meet in a plane: nothing slips, as nothing is there that friction
            // would have to hold.
            _ if !self.host.opponent().is_rigid() => Some(vec![true; slides.len()]),
            // Without full stick no point slides that the friction does not let.
            _ => (case.model().friction == Friction::Stick).then(|| slides.clone()),
        };
        let reading = self.ask_reading(case, control, Ask::Begin(Begin { from, sliding }))?;
        self.plate_force = reading.plate_force;
        Ok(reading)
    }

    /// The current iterate, from which the host goes on; points that slide in it slide there too.
    ///
    /// # Errors
    /// [`SolverError::Compute`].
    pub fn hand_over(&mut self, case: &mut CaseHandle<'_>, control: &Control) -> Result<Box<Vectors>, SolverError> {
        if self.kept && case.model().friction == Friction::Stick {
            // What came off last is noted with this request.
            self.ask_reading(case, control, Ask::Land)?;
        }
        match self.ask(case, control, Ask::Bring)? {
            Reply::Vectors(mut vectors) => {
                if self.host.opponent().is_rigid() {
                    self.host.set_sliding(&vectors.sliding);
                }
                self.host.opponent().leave_even(&mut vectors.displacement);
                Ok(vectors)
            }
            other => Err(unexpected(&other)),
        }
    }

    /// The current iterate on the host, and whether it can be gone on from.
    fn bring(&mut self, case: &mut CaseHandle<'_>, control: &Control) -> Result<Evaluated, SolverError> {
        match self.ask(case, control, Ask::Bring)? {
            Reply::Vectors(vectors) => self.host.take_over(case, &vectors, self.h, control),
            other => Err(unexpected(&other)),
        }
    }

    /// The correction by the host, which has a direct solver to fall back on.
    fn correct_there(&mut self, case: &mut CaseHandle<'_>, asked: Asked<'_>, times: &mut PhaseTimes) -> Result<Correction, Halt> {
        let brought = self.bring(case, asked.control)?;
        brought.check().map_err(|fault| StepFailure::Invalid { fault, when: "at an iterate from the device" })?;
        self.host.state_system(case, times);
        // The guess of a unit response is on the device.
        let found = self.host.solve_here(case, Asked { first: true, ..asked }, times)?;
        self.delta_h = found.delta_h;
        self.ask(case, asked.control, Ask::Give(self.host.delta.clone()))?;
        self.unit_scale = self.host.unit_scale;
        Ok(Correction { slope: self.host.slope_of_current(), ..found })
    }
}

fn unexpected(answer: &Reply) -> SolverError {
    ComputeError::Device(format!("the device answered {answer:?}, which was not asked")).into()
}

impl Iterate for ResidentIterate {
    fn begin(
        &mut self,
        case: &mut CaseHandle<'_>,
        start: &SetOut<'_>,
        control: &Control,
        times: &mut PhaseTimes,
    ) -> Result<Reading, Halt> {
        let mut lap = Lap::start();
        (self.kept, self.whole, self.tried) = (false, None, None);
        self.expected = [EXPECTED; 2];
        if let Some(Extrapolation { ratio, lift }) = start.extrapolation {
            self.h = control.h;
            let reading = self.begin_from(case, control, From::Extrapolation { ratio, lift })?;
            if reading.check().is_ok() {
                self.is_placed = true;
                lap.end(times, Phase::Force);
                return Ok(reading);
            }
        }
        self.h = if control.normal_force.is_some() { start.h } else { control.h };
        let mut reading = self.begin_from(case, control, From::Start)?;
        let missing = [control.pose.shift[0] - start.pose.shift[0], start.h - self.h];
        self.is_placed = missing.iter().all(|u| u.abs() <= 1e-14);
        if reading.outcome == Evaluated::Valid && reading.force_scale == 0.0 {
            // Nothing touches: the body follows the plate as it is.
            reading = self.begin_from(case, control, From::Shift(missing))?;
            self.is_placed = true;
        }
        lap.end(times, Phase::Force);
        Ok(reading)
    }

    fn h(&self) -> f64 {
        self.h
    }

    fn plate_is_placed(&self, _control: &Control) -> bool {
        self.is_placed
    }

    fn correct(&mut self, case: &mut CaseHandle<'_>, asked: Asked<'_>, times: &mut PhaseTimes) -> Result<Correction, Halt> {
        let Asked { control, eta, first } = asked;
        let mut lap = Lap::start();
        let share = eta.min(UNIT_RESPONSE);
        let ask = Correct {
            tolerance: eta,
            expected: self.expected[0],
            unit_tolerance: if first { share } else { unit_share(share, self.unit_scale) },
            unit_expected: self.expected[1],
            first,
            plate_force: self.plate_force,
        };
        (self.whole, self.tried) = (None, None);
        let corrected = match self.ask(case, control, Ask::Correct(ask))? {
            Reply::Corrected(corrected) => corrected,
            other => return Err(unexpected(&other).into()),
        };
        let Corrected { tangent, report, unit, delta_h, slope, trial } = corrected;
        lap.end(times, Phase::LinearSolve);
        tangent.check().map_err(StepFailure::of_tangent)?;
        if let Some(unit) = unit.filter(|_| first) {
            self.unit_scale = if unit.rhs_norm > 0.0 { (unit.start_norm / unit.rhs_norm).min(1.0) } else { 1.0 };
        }
        self.expected = [report.iterations, unit.map_or(0, |unit| unit.iterations)];
        let krylov = self.expected.iter().sum();
        // The response to a unit indentation only says how far to move the plate: the best iterate
        // will do.
        if report.ended != Ended::Converged || unit.is_some_and(|unit| unit.ended == Ended::NotFinite) {
            log::debug!("  the device's linear solve ended {:?} after {krylov} iterations", report.ended);
            let found = self.correct_there(case, asked, times)?;
            return Ok(Correction { krylov: krylov + found.krylov, ..found });
        }
        if !delta_h.is_finite() {
            return Err(no_depth(delta_h).into());
        }
        self.delta_h = delta_h;
        self.whole = Some(trial);
        self.tried = Some((1.0, trial.plate_force));
        Ok(Correction { krylov, fallback: false, delta_h, slope })
    }

    fn try_length(
        &mut self,
        case: &mut CaseHandle<'_>,
        control: &Control,
        length: f64,
        times: &mut PhaseTimes,
    ) -> Result<Reading, Halt> {
        if let Some(whole) = self.whole.filter(|_| length == 1.0) {
            return Ok(whole);
        }
        let mut lap = Lap::start();
        let reading = self.ask_reading(case, control, Ask::Try(length, self.delta_h))?;
        self.whole = None;
        self.tried = Some((length, reading.plate_force));
        lap.end(times, Phase::Force);
        Ok(reading)
    }

    /// The device has the last trial alone.
    fn favour(&mut self) {}

    fn keep(&mut self, case: &mut CaseHandle<'_>, control: &Control, length: f64, times: &mut PhaseTimes) -> Result<(), Halt> {
        if self.tried.is_none_or(|(tried, _)| tried != length) {
            self.try_length(case, control, length, times)?;
        }
        self.kept = true;
        self.h += length * self.delta_h;
        self.is_placed |= length == 1.0;
        self.plate_force = self.tried.map_or(self.plate_force, |(_, force)| force);
        Ok(())
    }

    fn land(
        &mut self,
        case: &mut CaseHandle<'_>,
        control: &Control,
        expected: usize,
        _times: &mut PhaseTimes,
    ) -> Result<Option<(usize, Reading)>, Halt> {
        // What came off is noted with the next request.
        if expected == 0 {
            return Ok(None);
        }
        let reading = self.ask_reading(case, control, Ask::Land)?;
        Ok(Some((expected, reading)))
    }

    fn locate(&mut self, case: &mut CaseHandle<'_>, control: &Control) -> Result<Option<Fault>, Halt> {
        self.kept = true;
        Ok(self.bring(case, control)?.check().err())
    }

    fn worst(&mut self, case: &mut CaseHandle<'_>, control: &Control, scale: f64) -> Result<Worst, Halt> {
        self.bring(case, control)?;
        self.host.worst(case, control, scale)
    }
}

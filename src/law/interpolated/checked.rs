//! What a law by interpolation has to be before anything is asked of it.

use super::components::Components;
use super::inputs::{INPUTS, NAMES};
use super::model::{FORMAT, Interpolated, PROCESSES, VERSION};
use super::process::Process;
use crate::contact_law::Frame;
use crate::law::bounds::{Checked, TOLD, ValueBounds};
use crate::law::json::LawKind;
use crate::law::table::{Against, frame_of_the_centres};

/// Means of inputs and outputs and the ends of their ranges, which are logarithms and shares.
const VALUE: ValueBounds = ValueBounds { least: -1e3, most: 1e3 };
/// ln c.
const LOG_OF_C: ValueBounds = ValueBounds { least: -10.0, most: 10.0 };
/// Deviations, of which 1e-12 stands for none.
const DEVIATION: ValueBounds = ValueBounds { least: 1e-12, most: 1e3 };
/// Inputs of a sample over their deviation.
const PLACE: ValueBounds = ValueBounds { least: -1e3, most: 1e3 };
/// Lengths over which a function changes, of inputs over their deviation.
const LENGTH: ValueBounds = ValueBounds { least: 1e-3, most: 1e6 };
/// Variances over deviation^2.
const VARIANCE: ValueBounds = ValueBounds { least: 0.0, most: 1e6 };
/// Weights of the samples.
const WEIGHT: ValueBounds = ValueBounds { least: -1e12, most: 1e12 };
/// Points of a mean curve, which are shares, and of a direction, whose length is 1.
const CURVE: ValueBounds = ValueBounds { least: -10.0, most: 10.0 };
/// Elements along the contact radius, as a case may have them.
const ELEMENTS: ValueBounds = ValueBounds { least: 4.0, most: 32.0 };

impl LawKind for Interpolated {
    const NAME: &'static str = "law by interpolation";
    const FORMAT: &'static str = FORMAT;
    const VERSION: u32 = VERSION;

    fn check(&self) -> Checked {
        let wanted = (self.body == Against::EqualSphere).then_some(Frame::LineOfCentres);
        frame_of_the_centres(self.frame, wanted, "law fit --interpolate")?;
        if !matches!(self.body, Against::Plane | Against::EqualSphere) {
            return Err(format!("body is {}, and has to be a rigid plane or an equal sphere", self.body));
        }
        ELEMENTS.hold_one("source.elements_per_contact_radius", self.source.elements_per_contact_radius as f64)?;
        self.check_inputs()?;
        self.check_processes()?;
        self.check_yielding()?;
        check_components("ratio", &self.ratio)?;
        check_components("normal", &self.normal)?;
        TOLD.hold_all("errors", &self.errors)?;
        TOLD.hold_all("normal_errors", &self.normal_errors)
    }
}

impl Interpolated {
    fn check_inputs(&self) -> Checked {
        let count = self.inputs.len();
        if count != INPUTS {
            return Err(format!("inputs has {count} of them, and there have to be {INPUTS}"));
        }
        for (i, (input, name)) in self.inputs.iter().zip(NAMES).enumerate() {
            if input.name != name {
                return Err(format!("inputs[{i}].name is {:?}, and has to be {name:?}", crate::case::short(&input.name)));
            }
            VALUE.hold_one(format_args!("inputs[{i}].mean"), input.mean)?;
            DEVIATION.hold_one(format_args!("inputs[{i}].deviation"), input.deviation)?;
            VALUE.hold_interval(format_args!("inputs[{i}].range"), input.range)?;
        }
        if self.samples.is_empty() {
            return Err("samples is empty, and has to have one at least".to_owned());
        }
        self.samples.iter().enumerate().try_for_each(|(i, place)| PLACE.hold(format_args!("samples[{i}]"), place))
    }

    fn check_processes(&self) -> Checked {
        let (count, samples) = (self.processes.len(), self.samples.len());
        if count != PROCESSES {
            return Err(format!("processes has {count} of them, and there have to be {PROCESSES}"));
        }
        let mut processes = self.processes.iter().enumerate();
        processes.try_for_each(|(i, process)| check_process(&format!("processes[{i}]"), process, samples))
    }

    fn check_yielding(&self) -> Checked {
        let Some(yielding) = &self.yielding else { return Ok(()) };
        if yielding.samples.is_empty() {
            return Err("yielding.samples is empty, and has to have one at least".to_owned());
        }
        let mut places = yielding.samples.iter().enumerate();
        places.try_for_each(|(i, place)| PLACE.hold(format_args!("yielding.samples[{i}]"), place))?;
        LOG_OF_C.hold_one("yielding.process.mean", yielding.process.mean)?;
        TOLD.hold("yielding.errors", &yielding.errors)?;
        check_process("yielding.process", &yielding.process, yielding.samples.len())
    }
}

fn check_process(key: &str, process: &Process, samples: usize) -> Checked {
    VALUE.hold_one(format_args!("{key}.mean"), process.mean)?;
    DEVIATION.hold_one(format_args!("{key}.deviation"), process.deviation)?;
    LENGTH.hold(format_args!("{key}.lengths"), &process.lengths)?;
    VARIANCE.hold(format_args!("{key}.variances"), &process.variances)?;
    if process.weights.len() != samples {
        let weights = process.weights.len();
        return Err(format!("{key}.weights has {weights} numbers, and has to have {samples}, one for each sample"));
    }
    WEIGHT.hold(format_args!("{key}.weights"), &process.weights)
}

fn check_components(key: &str, components: &Components) -> Checked {
    CURVE.hold(format_args!("{key}.mean"), &components.mean)?;
    let directions = components.directions.iter().enumerate();
    directions.into_iter().try_for_each(|(k, direction)| CURVE.hold(format_args!("{key}.directions[{k}]"), direction))
}

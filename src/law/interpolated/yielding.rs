//! How a contact yields under F_T, by its inputs: c of oblique presses, interpolated like the other
//! numbers of the law. It comes from a study of its own, since a press has all depths up to its
//! last, and F_T of a press asks for finer meshes than that of a shear.

use serde::{Deserialize, Serialize};

use super::process::{InputPoint, Process};

/// c of oblique presses over the inputs of the law that it belongs to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Yielding {
    /// Name of the study's directory.
    pub study: String,
    /// Presses used.
    pub cases: usize,
    /// Different materials.
    pub materials: usize,
    /// Cases left out, with the reasons.
    pub left_out: Vec<(String, String)>,
    /// rms and greatest error of ln c, each material from the others.
    pub errors: [f64; 2],
    /// ln c.
    pub process: Process,
    /// The samples' inputs, less the mean of the law's, over its deviation.
    pub samples: Vec<InputPoint>,
}

impl Yielding {
    /// c at a place; outside of the samples it is that of the nearest value of each input.
    pub(super) fn at(&self, place: &InputPoint) -> f64 {
        let nearest = std::array::from_fn(|i| {
            let of = |pick: fn(f64, f64) -> f64, start: f64| self.samples.iter().map(|sample| sample[i]).fold(start, pick);
            place[i].max(of(f64::min, f64::INFINITY)).min(of(f64::max, f64::NEG_INFINITY))
        });
        self.process.at(&self.samples, &nearest).exp()
    }
}

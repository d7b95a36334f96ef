//! Each kernel against the CPU: one body for every backend, CPU f64, CPU f32, GPU f64, GPU f32.
//!
//! The reference is the CPU in f64, fed with what the backend under test was fed with after
//! rounding. Each backend has to stay within its bound of the reference *and* to obey the equations
//! by itself, so that a fault shared with the reference shows too.
//!
//! The bodies assert. `tests/conformance.rs` makes each a test; `asperity prove` runs those of a
//! device ([`comparisons`]) and tells of an assertion that does not hold ([`Comparison::run`]).

pub mod assembly;
pub mod batch;
pub mod contact;
pub mod element;
pub mod iterate;
pub mod kernels;
pub mod linear;
pub mod material;
pub mod pairs;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex, PoisonError};

use crate::compute::gpu::{GpuContext, Precision};

/// A body for a device.
type TestBody = fn(&Arc<GpuContext>);

/// What takes long on a software driver; other comparisons have the same kernels.
const LONG: [&str; 6] = [
    "two bodies",
    "forces and tangents, elements halved twice",
    "states and energies, elements halved twice",
    "forces and tangents: their equations, elements halved twice",
    "linear systems, elements halved twice",
    "linear systems of pairs of whole spheres",
];

/// A comparison of a device with the CPU in one precision.
#[derive(Clone, Copy)]
pub struct Comparison {
    /// What is compared, in words.
    pub name: &'static str,
    /// The precision of the residual's kernels.
    pub precision: Precision,
    body: TestBody,
}

impl Comparison {
    /// Whether it takes long on a software driver, and other comparisons have its kernels too.
    pub fn is_long(&self) -> bool {
        LONG.contains(&self.name)
    }

    /// Compares on a device.
    ///
    /// # Errors
    /// What did not hold, with its place in the source, or what the device said.
    pub fn run(&self, context: &Arc<GpuContext>) -> Result<(), String> {
        quietly(|| (self.body)(context))
    }
}

/// Runs what may panic, and gives what it says; the panic itself is not printed.
///
/// # Errors
/// The message and the place of the panic.
pub fn quietly(run: impl FnOnce()) -> Result<(), String> {
    static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());
    let _hook = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
    let said = Arc::new(Mutex::new(None));
    let (heard, thread) = (Arc::clone(&said), std::thread::current().id());
    let before: Arc<dyn Fn(&std::panic::PanicHookInfo<'_>) + Send + Sync> = std::panic::take_hook().into();
    let others = Arc::clone(&before);
    std::panic::set_hook(Box::new(move |info| {
        if std::thread::current().id() != thread {
            return others(info);
        }
        let payload = info.payload();
        let text = payload.downcast_ref::<String>().map(String::as_str);
        let payload = text.or_else(|| payload.downcast_ref::<&str>().copied()).unwrap_or("it panicked");
        let words = payload.split_whitespace().collect::<Vec<_>>().join(" ");
        let place = info.location().map_or_else(String::new, |at| format!("{}:{}: ", at.file(), at.line()));
        *heard.lock().unwrap_or_else(PoisonError::into_inner) = Some(format!("{place}{words}"));
    }));
    let outcome = catch_unwind(AssertUnwindSafe(run));
    std::panic::set_hook(Box::new(move |info| before(info)));
    let said = said.lock().unwrap_or_else(PoisonError::into_inner).take();
    outcome.map_err(|_| said.unwrap_or_else(|| "it panicked".to_owned()))
}

/// Bodies of one file in both precisions.
macro_rules! in_both {
    ($list:ident, $module:ident, $backend:path: $($name:literal $body:ident),+ $(,)?) => {
        $(
            $list.push(Comparison {
                name: $name,
                precision: Precision::F64,
                body: |context| $module::$body::<f64, _>(&$backend(context.clone()), &$module::Bounds::F64),
            });
            $list.push(Comparison {
                name: $name,
                precision: Precision::F32,
                body: |context| $module::$body::<f32, _>(&$backend(context.clone()), &$module::Bounds::F32),
            });
        )+
    };
}

/// The same of those that compare a device with the CPU's own solver.
macro_rules! in_both_on_a_device {
    ($list:ident, $module:ident: $($name:literal $body:ident),+ $(,)?) => {
        $(
            $list.push(Comparison {
                name: $name,
                precision: Precision::F64,
                body: |context| $module::$body::<f64>(context, &$module::Bounds::F64),
            });
            $list.push(Comparison {
                name: $name,
                precision: Precision::F32,
                body: |context| $module::$body::<f32>(context, &$module::Bounds::F32),
            });
        )+
    };
}

/// The comparisons that a device with these abilities is put to; without double precision those in
/// f32.
pub fn comparisons(has_double: bool) -> Vec<Comparison> {
    let mut all: Vec<Comparison> = Vec::with_capacity(48);
    in_both!(all, material, material::GpuPoints:
        "return mapping" agrees_with_the_reference,
        "return mapping: its equations" obeys_its_equations,
        "return mapping: points without an answer" reports_what_has_no_answer,
        "return mapping: repeated bits" is_deterministic,
        "return mapping along a cycle" follows_a_cycle,
    );
    in_both!(all, element, batch::OnGpu:
        "forces and tangents" forces_and_tangents_agree,
        "states and energies" commits_and_energies_agree,
        "two bodies" two_bodies_answer_as_each_by_itself,
        "a state taken and restored" a_state_survives_being_taken_and_restored,
        "forces and tangents: their equations" obeys_its_equations,
        "displacements that are refused" bad_displacements_are_refused,
        "forces and tangents, elements halved twice" forces_and_tangents_agree_on_two_levels,
        "states and energies, elements halved twice" commits_and_energies_agree_on_two_levels,
        "forces and tangents: their equations, elements halved twice" obeys_its_equations_on_two_levels,
    );
    in_both!(all, contact, batch::OnGpu:
        "contact rows" rows_agree,
        "contact rows of what is no number" nan_is_not_swallowed,
    );
    in_both!(all, assembly, batch::OnGpu: "a batch and its cases alone" a_batch_has_the_bits_of_its_cases_alone);
    in_both_on_a_device!(all, pairs:
        "linear systems of pairs" systems_are_the_cpus,
        "linear systems of pairs of whole spheres" systems_of_whole_spheres_are_the_cpus,
    );
    let in_double: [(&'static str, TestBody); 5] = [
        // The solver's kernels are in f32 beside either residual.
        ("linear systems", |context| linear::meets_tolerances_as_the_cpu_does::<f64>(context, linear::own_numbers)),
        ("linear systems, elements halved twice", |context| {
            linear::meets_tolerances_on_two_levels::<f64>(context, linear::own_numbers)
        }),
        ("linear systems, down to one element", linear::meets_tolerances_down_to_one_element),
        ("Krylov cycles: their equations", kernels::a_krylov_cycle_obeys_its_equations),
        ("trials and corrections of iterates", iterate::trials_and_corrections_are_the_cpus),
    ];
    all.extend(in_double.map(|(name, body)| Comparison { name, precision: Precision::F64, body }));
    all.retain(|comparison| has_double || comparison.precision == Precision::F32);
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_does_not_hold_is_told_with_its_place() {
        let said = quietly(|| panic!("two\n and three")).unwrap_err();
        assert!(said.starts_with("src/conformance/mod.rs:") && said.ends_with(": two and three"), "{said}");
        assert_eq!(quietly(|| ()), Ok(()));
    }

    #[test]
    fn a_device_without_double_precision_is_put_to_those_in_single() {
        assert!(comparisons(false).iter().all(|comparison| comparison.precision == Precision::F32));
        assert!(comparisons(true).len() > 2 * comparisons(false).len());
    }
}

//! How scratch memory cuts a batch up changes no bit.

use crate::device::device;
use asperity::internals::compute::gpu::{Gpu, Precision};
use asperity::internals::conformance::assembly::{CELLS, bits, steps};
use asperity::internals::conformance::batch::models;

/// Scratch memory for two cases at a time: four dispatches in the place of one.
#[test]
fn short_memory_cuts_a_call_up_and_changes_no_bit() {
    let name = "short_memory_cuts_a_call_up_and_changes_no_bit";
    let Some(context) = device(name, Precision::F32) else { return };
    let models = models(CELLS);
    let steps = steps::<f32>(&models);
    let mut whole = Gpu::<f32>::new(context.into(), models.clone()).unwrap();
    let used = whole.context().unwrap().budget().used();
    let expected = bits(&mut whole, &steps);
    let Some(context) = device(name, Precision::F32) else { return };
    // Enough for what stays of the cases and for some of the slots.
    let context = std::sync::Arc::new(context.with_budget(used / 3 * 2));
    let mut cut = Gpu::<f32>::new(context.clone(), models.clone()).unwrap();
    assert!(context.budget().used() < used / 3 * 2);
    assert!(bits(&mut cut, &steps) == expected);
}

/// A kernel that sees a short part of an array: fewer cases at a time, which is said.
#[test]
fn short_arrays_cut_a_batch_up_and_change_no_bit() {
    let name = "short_arrays_cut_a_batch_up_and_change_no_bit";
    let models = models(CELLS);
    let steps = steps::<f32>(&models);
    let with = |bytes: Option<u64>| {
        let context = device(name, Precision::F32)?;
        let context = match bytes {
            Some(bytes) => context.with_longest_array(bytes),
            None => context,
        };
        Some(Gpu::<f32>::new(context.into(), models.clone()))
    };
    let Some(whole) = with(None) else { return };
    let mut whole = whole.unwrap();
    assert!(whole.notes().is_empty(), "{:?}", whole.notes());
    let expected = bits(&mut whole, &steps);
    let mut cut = 0;
    for bytes in [200_000, 100_000, 60_000, 40_000] {
        let Some(Ok(mut gpu)) = with(Some(bytes)) else { continue };
        if let [note] = &gpu.notes()[..] {
            assert!(note.contains("of 7 cases of a batch no more than"), "{note}");
            assert!(bits(&mut gpu, &steps) == expected, "{bytes}");
            cut += 1;
        }
    }
    assert!(cut > 1, "no array was too short: the test tests nothing");
    // Not one case fits.
    assert!(with(Some(1000)).is_some_and(|gpu| gpu.is_err()));
}

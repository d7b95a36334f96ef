//! Newton's iterates on a device: each against the CPU's, whoever is beside it, and what passes on
//! the way.

use crate::device::device;
use asperity::internals::compute::Compute;
use asperity::internals::compute::gpu::{Gpu, Precision};
use asperity::internals::compute::iterate::{Ask, Correct, Corrected, Plate, Reading};
use asperity::internals::compute::linear::Ended;
use asperity::internals::compute::traffic::Traffic;
use asperity::internals::conformance::iterate::{DEPTH, ask, begin, corrected, plate, pressed, reading};
use asperity::internals::mesh::Mesh;
use asperity::internals::solver::Control;
use asperity::internals::solver::pose::Pose;
use std::sync::Arc;

/// What is read of cases does not depend on who is beside them; and few bytes pass, whatever the
/// batch, in one submission and one wait, where a force is held too.
#[test]
fn a_batch_reads_as_its_cases_alone_and_little_passes() {
    let Some(context) = device("a_batch_reads_as_its_cases_alone_and_little_passes", Precision::F64) else { return };
    let mut pressed = pressed(&Arc::new(context));
    let (gpu, mesh) = (&mut pressed.gpu, pressed.models[0].mesh.clone());
    for held in [None, Some(2e-4)] {
        let control = Control { h: DEPTH + 2e-4, pose: Pose::along_x(0.0), normal_force: held };
        let round = |gpu: &mut Gpu<f64>, cases: &[usize]| -> Vec<(Reading, Corrected)> {
            let (answers, passed) = correct_from_start(gpu, &mesh, cases, &control, 0.1, [12, 12]);
            let count = cases.len() as u64;
            assert!(passed.bytes_up <= 512 * count && passed.bytes_down <= 256 * count, "{passed:?} for {count}");
            assert!(passed.submissions <= 2 && passed.waits == 1, "{passed:?}");
            // 13 Krylov iterations are sent off, for a system and for the response to the plate.
            let systems = 1 + u64::from(held.is_some());
            assert!(passed.dispatches <= 30 * 13 * systems + 40, "{passed:?}");
            answers
        };
        let together = round(gpu, &[0, 1, 2, 3, 4]);
        assert!(together.iter().all(|(_, found)| found.report.ended == Ended::Converged));
        assert!(together.iter().all(|(_, found)| found.unit.is_some() == held.is_some()));
        for case in 0..5 {
            assert_eq!(round(gpu, &[case])[0], together[case], "case {case} alone");
        }
        let others = round(gpu, &[3, 0]);
        assert_eq!((others[0], others[1]), (together[3], together[0]));
    }
}

/// How many Krylov iterations are sent off at first changes no bit: neither where a correction
/// takes more, nor where the response to the plate does, nor where both do.
#[test]
fn a_list_that_is_too_short_changes_no_bit() {
    let Some(context) = device("a_list_that_is_too_short_changes_no_bit", Precision::F64) else { return };
    let mut pressed = pressed(&Arc::new(context));
    let (gpu, mesh) = (&mut pressed.gpu, pressed.models[0].mesh.clone());
    for held in [None, Some(2e-4)] {
        let control = Control { h: DEPTH + 2e-4, pose: Pose::along_x(0.0), normal_force: held };
        let (expected, _) = correct_from_start(gpu, &mesh, &[0, 1, 2, 3, 4], &control, 1e-3, [20, 20]);
        for lists in [[0, 20], [20, 0], [0, 0]] {
            let (found, passed) = correct_from_start(gpu, &mesh, &[0, 1, 2, 3, 4], &control, 1e-3, lists);
            let short = lists[0] == 0 || held.is_some();
            assert!(!short || passed.waits > 1, "{lists:?}: {passed:?}");
            assert_eq!(found, expected, "{lists:?}");
        }
    }
}

/// Corrections from the start of the step, so many Krylov iterations expected for the correction
/// and the response to the plate, and what passed on the way.
fn correct_from_start(
    gpu: &mut Gpu<f64>,
    mesh: &Mesh,
    cases: &[usize],
    control: &Control,
    tolerance: f64,
    [expected, unit_expected]: [usize; 2],
) -> (Vec<(Reading, Corrected)>, Traffic) {
    let all = |ask: &dyn Fn(usize) -> Ask| -> Vec<(usize, bool, Plate, Ask)> {
        cases.iter().enumerate().map(|(i, &case)| (case, false, plate(control), ask(i))).collect()
    };
    let begun: Vec<Reading> = ask(gpu, &all(&|_| begin(mesh))).iter().map(reading).collect();
    let correct = |i: usize| {
        let plate_force = begun[i].plate_force;
        Ask::Correct(Correct { tolerance, expected, unit_tolerance: 0.1 * tolerance, unit_expected, first: true, plate_force })
    };
    let before = gpu.about().traffic.unwrap();
    let answers = ask(gpu, &all(&correct));
    let passed = gpu.about().traffic.unwrap() - before;
    (begun.into_iter().zip(answers.iter().map(corrected)).collect(), passed)
}

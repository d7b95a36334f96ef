//! Which backend a run gets, and what it is told, where a device is missing, small, imprecise, or
//! lost.

mod device;

use asperity::internals::compute::gpu::{GpuError, Precision};
use asperity::internals::compute::handle::CaseHandle;
use asperity::internals::compute::select::{DeviceChoice, PrecisionChoice, Selected, select, select_on};
use asperity::internals::compute::{CaseModel, Compute, ComputeError};
use asperity::internals::contact::coulomb::Friction;
use asperity::internals::contact::rigid::Rigid;
use asperity::internals::mesh::brick::brick;
use asperity::material::{Elasticity, FlowStress, Material};
use device::device;
use std::process::Command;
use std::sync::Arc;

fn models() -> Vec<CaseModel> {
    let mesh = Arc::new(brick(2, 2, 2, [1.0; 3]).unwrap());
    let material = Material { elasticity: Elasticity::new(1.0, 0.3), hardening: FlowStress::ideal(2e-3).unwrap() };
    let model =
        CaseModel { mesh, material, friction: Friction::Coulomb(0.3), opponent: None, image: None, surface: Rigid::default() };
    vec![model.clone(), model]
}

fn force(backend: &mut dyn Compute) -> Result<Vec<f64>, ComputeError> {
    let displacement: Vec<f64> = (0..3 * backend.models()[1].mesh.nodes.len()).map(|i| 1e-4 * ((i * i) % 7) as f64).collect();
    let mut force = Vec::new();
    CaseHandle { backend, case: 1 }.internal_force(&displacement, &mut force)?;
    Ok(force)
}

fn message(selected: Result<Selected, ComputeError>) -> String {
    match selected {
        Ok(selected) => panic!("{} was selected: {:?}", selected.backend.about().description.device, selected.notes),
        Err(error) => error.to_string(),
    }
}

/// Notes that f32 means mixed; there are no others.
fn told_of_f32(selected: &Selected) -> usize {
    assert!(selected.notes.iter().all(|note| note.contains("f32 means mixed")), "{:?}", selected.notes);
    selected.notes.len()
}

#[test]
fn the_cpu_is_what_was_asked_for() {
    for choice in [PrecisionChoice::Auto, PrecisionChoice::F64, PrecisionChoice::Mixed, PrecisionChoice::F32] {
        let selected = select(DeviceChoice::Cpu, choice, models()).unwrap();
        assert_eq!(told_of_f32(&selected), usize::from(choice == PrecisionChoice::F32), "{:?}", selected.notes);
        assert!(selected.backend.about().description.device.starts_with("CPU"));
        assert_eq!(selected.backend.about().description.precision, "f64");
    }
}

/// Two cases that cannot share a batch are an error of the caller on every device, not a reason to
/// change it.
#[test]
fn a_bad_batch_is_no_fault_of_the_device() {
    let mut bad = models();
    bad[1].mesh = Arc::new(brick(2, 2, 1, [1.0; 3]).unwrap());
    let refused = |s: Result<Selected, _>| matches!(s, Err(ComputeError::Connectivity { case: 1 }));
    assert!(refused(select(DeviceChoice::Cpu, PrecisionChoice::Auto, bad.clone())));
    let Some(context) = device("a_bad_batch_is_no_fault_of_the_device", Precision::F32) else { return };
    assert!(refused(select_on(Ok(Some(context)), DeviceChoice::Auto, PrecisionChoice::Mixed, bad)));
}

#[test]
fn the_device_is_named_with_its_precision() {
    let name = "the_device_is_named_with_its_precision";
    for choice in [PrecisionChoice::Auto, PrecisionChoice::Mixed, PrecisionChoice::F32] {
        let Some(context) = device(name, Precision::F64) else { return };
        let adapter = context.adapter().name.clone();
        let mut selected = select_on(Ok(Some(context)), DeviceChoice::Gpu, choice, models()).unwrap();
        let description = selected.backend.about().description;
        assert!(description.device.contains(&adapter) && description.precision == "f64", "{description:?}");
        assert_eq!(description.device.contains("residuals on the CPU"), choice != PrecisionChoice::Auto);
        assert_eq!(told_of_f32(&selected), usize::from(choice == PrecisionChoice::F32));
        assert!(force(selected.backend.as_mut()).is_ok());
    }
}

#[test]
fn without_double_precision_the_residual_comes_from_the_cpu() {
    let name = "without_double_precision_the_residual_comes_from_the_cpu";
    let mut reference = select(DeviceChoice::Cpu, PrecisionChoice::Auto, models()).unwrap();
    for device_choice in [DeviceChoice::Auto, DeviceChoice::Gpu] {
        let Some(context) = device(name, Precision::F32) else { return };
        let context = context.without_double_precision();
        let mut selected = select_on(Ok(Some(context)), device_choice, PrecisionChoice::Auto, models()).unwrap();
        let description = selected.backend.about().description;
        assert!(description.device.contains("in f32; residuals on the CPU") && description.precision == "f64", "{description:?}");
        assert!(selected.notes.len() == 1 && selected.notes[0].contains("no double precision"), "{:?}", selected.notes);
        assert_eq!(force(selected.backend.as_mut()).unwrap(), force(reference.backend.as_mut()).unwrap());
    }
}

#[test]
fn a_budget_too_small_is_the_cpus_turn_or_an_error() {
    let name = "a_budget_too_small_is_the_cpus_turn_or_an_error";
    // nothing fits; the resident arrays fit, and no evaluation
    for (budget, what) in [(1000, "device memory"), (28_000, "an evaluation of one case")] {
        let Some(context) = device(name, Precision::F32) else { return };
        let context = context.with_budget(budget);
        let mut selected = select_on(Ok(Some(context)), DeviceChoice::Auto, PrecisionChoice::Mixed, models()).unwrap();
        assert!(selected.backend.about().description.device.starts_with("CPU"));
        let [note] = &selected.notes[..] else { panic!("{:?}", selected.notes) };
        assert!(note.contains("ASPERITY_GPU_MEMORY") && note.contains("the CPU was taken instead"), "{note}");
        assert!(force(selected.backend.as_mut()).is_ok());
        let Some(context) = device(name, Precision::F32) else { return };
        let text = message(select_on(Ok(Some(context.with_budget(budget))), DeviceChoice::Gpu, PrecisionChoice::Mixed, models()));
        assert!(text.contains("ASPERITY_GPU_MEMORY") && text.contains(what), "{text}");
    }
}

#[test]
fn a_driver_that_opens_no_device_is_the_cpus_turn_or_an_error() {
    let broken = || Err(GpuError::NoDevice { adapter: "Some GPU".into(), reason: "no".into() });
    let selected = select_on(broken(), DeviceChoice::Auto, PrecisionChoice::Auto, models()).unwrap();
    assert!(selected.backend.about().description.device.starts_with("CPU"));
    assert!(selected.notes.len() == 1 && selected.notes[0].contains("Some GPU"), "{:?}", selected.notes);
    assert!(message(select_on(broken(), DeviceChoice::Gpu, PrecisionChoice::Auto, models())).contains("Some GPU"));
}

#[test]
fn a_device_lost_before_its_first_step_is_the_cpus_turn() {
    let name = "a_device_lost_before_its_first_step_is_the_cpus_turn";
    let Some(context) = device(name, Precision::F32) else { return };
    context.destroy();
    let mut selected = select_on(Ok(Some(context)), DeviceChoice::Auto, PrecisionChoice::Mixed, models()).unwrap();
    assert!(selected.notes.len() == 1 && selected.notes[0].contains("failed"), "{:?}", selected.notes);
    assert!(force(selected.backend.as_mut()).is_ok());
}

/// `VK_DRIVER_FILES` is how the Vulkan loader is told that there is no driver.
#[test]
#[cfg(target_os = "linux")]
fn without_a_driver_auto_is_the_cpu_and_gpu_is_one_clear_error() {
    let name = "without_a_driver_auto_is_the_cpu_and_gpu_is_one_clear_error";
    if std::env::var_os("ASPERITY_CHILD").is_none() {
        let mut child = Command::new(std::env::current_exe().unwrap());
        child.args(["--exact", name, "--nocapture"]).env("ASPERITY_CHILD", "1").env("ASPERITY_ADAPTER", "");
        let output = child.env("VK_DRIVER_FILES", "/dev/null").env("VK_ICD_FILENAMES", "/dev/null").output().unwrap();
        let text = String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success() && text.contains("child: done"), "{text}");
        return;
    }
    let mut selected = select(DeviceChoice::Auto, PrecisionChoice::Auto, models()).unwrap();
    assert!(selected.backend.about().description.device.starts_with("CPU"));
    assert!(force(selected.backend.as_mut()).is_ok());
    let text = message(select(DeviceChoice::Gpu, PrecisionChoice::Auto, models()));
    assert!(text.contains("no GPU found") && text.contains("--device cpu"), "{text}");
    println!("child: done");
}

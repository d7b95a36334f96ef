//! One body for every backend: CPU f64, CPU f32, GPU f64, GPU f32. The bodies are those of
//! `asperity prove`, in `src/conformance`; here each is a test of its own.

#[path = "conformance/assembly.rs"]
mod assembly;
#[path = "conformance/iterate.rs"]
mod iterate;
#[path = "conformance/linear.rs"]
mod linear;
#[path = "conformance/memory.rs"]
mod memory;
#[path = "conformance/pair.rs"]
mod pair;
#[path = "conformance/press.rs"]
mod press;
#[path = "conformance/recorder.rs"]
mod recorder;

mod device;

/// Instantiates bodies of a file, `fn body<R, B: Backend<R>>(backend: &B, bounds: &Bounds)`, for
/// the four backends.
macro_rules! for_every_backend {
    ($module:ident, $cpu:path, $gpu:path: $($body:ident),+ $(,)?) => {
        mod $module {
            use asperity::internals::conformance::$module as bodies;
            mod cpu_f64 {
                $(#[test] fn $body() { super::bodies::$body::<f64, _>(&$cpu, &super::bodies::Bounds::F64); })+
            }
            mod cpu_f32 {
                $(#[test] fn $body() { super::bodies::$body::<f32, _>(&$cpu, &super::bodies::Bounds::F32); })+
            }
            mod gpu_f64 {
                $(#[test] fn $body() {
                    let context = crate::device::device(stringify!($body), asperity::internals::compute::gpu::Precision::F64);
                    let Some(context) = context else { return };
                    super::bodies::$body::<f64, _>(&$gpu(context.into()), &super::bodies::Bounds::F64);
                })+
            }
            mod gpu_f32 {
                $(#[test] fn $body() {
                    let context = crate::device::device(stringify!($body), asperity::internals::compute::gpu::Precision::F32);
                    let Some(context) = context else { return };
                    super::bodies::$body::<f32, _>(&$gpu(context.into()), &super::bodies::Bounds::F32);
                })+
            }
        }
    };
}

/// Instantiates bodies of a file that compare a device in f64.
macro_rules! for_a_device {
    ($module:ident: $($body:ident),+ $(,)?) => {
        $(#[test] fn $body() {
            let context = crate::device::device(stringify!($body), asperity::internals::compute::gpu::Precision::F64);
            let Some(context) = context else { return };
            asperity::internals::conformance::$module::$body(&context.into());
        })+
    };
}

use asperity::internals::conformance::{batch, material as points};

for_every_backend!(material, crate::points::CpuPoints, crate::points::GpuPoints:
    agrees_with_the_reference,
    obeys_its_equations,
    reports_what_has_no_answer,
    is_deterministic,
    follows_a_cycle,
);
for_every_backend!(element, crate::batch::OnCpu, crate::batch::OnGpu:
    two_bodies_answer_as_each_by_itself,
    forces_and_tangents_agree,
    commits_and_energies_agree,
    a_state_survives_being_taken_and_restored,
    obeys_its_equations,
    bad_displacements_are_refused,
    forces_and_tangents_agree_on_two_levels,
    commits_and_energies_agree_on_two_levels,
    obeys_its_equations_on_two_levels,
);
for_every_backend!(contact, crate::batch::OnCpu, crate::batch::OnGpu: rows_agree, nan_is_not_swallowed);

/// What a batch leaves.
mod whole {
    for_every_backend!(assembly, crate::batch::OnCpu, crate::batch::OnGpu: a_batch_has_the_bits_of_its_cases_alone);
}

/// Those of the linear solver by themselves.
mod kernels {
    for_a_device!(kernels: a_krylov_cycle_obeys_its_equations);
}

/// Linear systems of equal pairs, in both precisions of a device.
mod systems_of_pairs {
    use asperity::internals::compute::gpu::Precision;
    use asperity::internals::conformance::pairs::{Bounds, systems_are_the_cpus, systems_of_whole_spheres_are_the_cpus};

    for_a_device!(pairs: a_pair_without_room_disturbs_no_other);

    #[test]
    fn systems_are_the_cpus_in_f64() {
        let Some(context) = crate::device::device("systems_are_the_cpus_in_f64", Precision::F64) else { return };
        systems_are_the_cpus::<f64>(&context.into(), &Bounds::F64);
    }

    #[test]
    fn systems_are_the_cpus_in_f32() {
        let Some(context) = crate::device::device("systems_are_the_cpus_in_f32", Precision::F32) else { return };
        systems_are_the_cpus::<f32>(&context.into(), &Bounds::F32);
    }

    #[test]
    fn systems_of_whole_spheres_are_the_cpus_in_f64() {
        let Some(context) = crate::device::device("systems_of_whole_spheres_are_the_cpus_in_f64", Precision::F64) else { return };
        systems_of_whole_spheres_are_the_cpus::<f64>(&context.into(), &Bounds::F64);
    }

    #[test]
    fn systems_of_whole_spheres_are_the_cpus_in_f32() {
        let Some(context) = crate::device::device("systems_of_whole_spheres_are_the_cpus_in_f32", Precision::F32) else { return };
        systems_of_whole_spheres_are_the_cpus::<f32>(&context.into(), &Bounds::F32);
    }
}

/// Newton's iterates against the CPU's.
mod iterates {
    for_a_device!(iterate: trials_and_corrections_are_the_cpus);
}

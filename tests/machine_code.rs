//! What an AMD card's compiler makes of the kernels: registers and spills, without the card. Mesa's
//! RADV compiles for a card that is not there if `RADV_FORCE_FAMILY` names one.
#![cfg(target_os = "linux")]
#![allow(unsafe_code)]

use std::ffi::CStr;
use std::io::Write;
use std::path::Path;

use ash::{khr, vk};
use asperity::internals::compute::gpu::kernel::Kernel;
use asperity::internals::compute::gpu::kernels::KERNELS;
use asperity::internals::compute::gpu::reflect::Binding;
use asperity::internals::compute::gpu::source::Precision;
use asperity::internals::compute::gpu::validate::{ValidSource, validate};

const ICD: &str = "/usr/share/vulkan/icd.d/radeon_icd.x86_64.json";
/// Vector registers with which a SIMD holds eight waves at a time.
const MOST: u64 = 128;
/// A device of the driver's that has no card.
struct Radv {
    _entry: ash::Entry,
    instance: ash::Instance,
    device: ash::Device,
    executables: khr::pipeline_executable_properties::Device,
}

impl Radv {
    /// SAFETY: the caller has set the driver's variables before any thread reads the environment.
    unsafe fn open() -> Result<Self, Box<dyn std::error::Error>> {
        unsafe {
            let entry = ash::Entry::load()?;
            let application = vk::ApplicationInfo::default().api_version(vk::API_VERSION_1_2);
            let instance = entry.create_instance(&vk::InstanceCreateInfo::default().application_info(&application), None)?;
            let cards = instance.enumerate_physical_devices()?;
            let card = *cards.first().ok_or("no card")?;
            let priorities = [1.0];
            let queues = [vk::DeviceQueueCreateInfo::default().queue_family_index(0).queue_priorities(&priorities)];
            let extensions = [khr::pipeline_executable_properties::NAME.as_ptr()];
            let features = vk::PhysicalDeviceFeatures::default().shader_float64(true).shader_int64(true);
            let mut executable =
                vk::PhysicalDevicePipelineExecutablePropertiesFeaturesKHR::default().pipeline_executable_info(true);
            let create = vk::DeviceCreateInfo::default()
                .queue_create_infos(&queues)
                .enabled_extension_names(&extensions)
                .enabled_features(&features)
                .push_next(&mut executable);
            let device = instance.create_device(card, &create, None)?;
            let executables = khr::pipeline_executable_properties::Device::new(&instance, &device);
            Ok(Self { _entry: entry, instance, device, executables })
        }
    }

    /// The compiler's statistics of a kernel, by name.
    unsafe fn statistics(&self, kernel: &Kernel, precision: Precision) -> Vec<(String, u64)> {
        let ValidSource { module, info } = validate(&kernel.assemble(precision)).unwrap();
        // As release builds compile them: without bounds checks.
        let unchecked = naga::proc::BoundsCheckPolicy::Unchecked;
        let policies = naga::proc::BoundsCheckPolicies {
            index: unchecked,
            buffer: unchecked,
            image_load: unchecked,
            binding_array: unchecked,
        };
        let options = naga::back::spv::Options { lang_version: (1, 3), bounds_check_policies: policies, ..Default::default() };
        let words = naga::back::spv::write_vec(&module, &info, &options, None).unwrap();
        let kind = |binding: Binding| match binding {
            Binding::Uniform => vk::DescriptorType::UNIFORM_BUFFER,
            Binding::Read | Binding::ReadWrite => vk::DescriptorType::STORAGE_BUFFER,
        };
        let variables = &kernel.interface().unwrap().variables;
        let bindings: Vec<_> = variables
            .iter()
            .map(|variable| {
                vk::DescriptorSetLayoutBinding::default()
                    .binding(variable.binding)
                    .descriptor_type(kind(variable.kind))
                    .descriptor_count(1)
                    .stage_flags(vk::ShaderStageFlags::COMPUTE)
            })
            .collect();
        let name = std::ffi::CString::new(kernel.name).unwrap();
        // SAFETY: every handle is made by this device, used by it alone, and what it points to
        // lives to the end of the call.
        unsafe {
            let shader = self.device.create_shader_module(&vk::ShaderModuleCreateInfo::default().code(&words), None).unwrap();
            let set = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
            let sets = [self.device.create_descriptor_set_layout(&set, None).unwrap()];
            let layout = vk::PipelineLayoutCreateInfo::default().set_layouts(&sets);
            let layout = self.device.create_pipeline_layout(&layout, None).unwrap();
            let stage =
                vk::PipelineShaderStageCreateInfo::default().stage(vk::ShaderStageFlags::COMPUTE).module(shader).name(&name);
            let create = vk::ComputePipelineCreateInfo::default()
                .stage(stage)
                .layout(layout)
                .flags(vk::PipelineCreateFlags::CAPTURE_STATISTICS_KHR);
            let pipelines = self.device.create_compute_pipelines(vk::PipelineCache::null(), &[create], None);
            let pipeline = pipelines.unwrap_or_else(|(_, error)| panic!("{} in {precision}: {error}", kernel.name))[0];
            let executable = vk::PipelineExecutableInfoKHR::default().pipeline(pipeline).executable_index(0);
            let found = self.executables.get_pipeline_executable_statistics(&executable).unwrap();
            let named = |s: &vk::PipelineExecutableStatisticKHR<'_>| {
                let name = CStr::from_ptr(s.name.as_ptr()).to_string_lossy().into_owned();
                (name, s.value.u64)
            };
            let statistics = found.iter().map(named).collect();
            self.device.destroy_pipeline(pipeline, None);
            self.device.destroy_pipeline_layout(layout, None);
            self.device.destroy_descriptor_set_layout(sets[0], None);
            self.device.destroy_shader_module(shader, None);
            statistics
        }
    }
}

impl Drop for Radv {
    fn drop(&mut self) {
        // SAFETY: nothing made by the device is left.
        unsafe {
            self.device.destroy_device(None);
            self.instance.destroy_instance(None);
        }
    }
}

/// No kernel spills, and none takes more registers than eight waves of a SIMD have.
#[test]
fn no_kernel_spills_on_an_amd_card() {
    // SAFETY: this is the only test of its program, and no other thread has begun.
    let radv = unsafe {
        std::env::set_var("RADV_FORCE_FAMILY", "navi21");
        std::env::set_var("VK_ICD_FILENAMES", ICD);
        std::env::set_var("VK_DRIVER_FILES", ICD);
        Path::new(ICD).exists().then(|| Radv::open())
    };
    let radv = match radv {
        Some(Ok(radv)) => radv,
        other => {
            let why =
                other.map_or_else(|| format!("{ICD} is not there"), |r| r.err().map_or_else(String::new, |e| e.to_string()));
            assert!(std::env::var("ASPERITY_REQUIRE_GPU").as_deref() != Ok("1"), "no AMD compiler: {why}");
            // The print macros are captured for passing tests; the handle is not.
            #[allow(clippy::explicit_write)]
            writeln!(std::io::stderr(), "SKIPPED: no AMD compiler: {why}").unwrap();
            return;
        }
    };
    let mut wrong = Vec::new();
    for kernel in KERNELS {
        for precision in Precision::ALL {
            // SAFETY: the device is open.
            let statistics = unsafe { radv.statistics(kernel, precision) };
            let of = |wanted: &str| statistics.iter().find(|(name, _)| name == wanted).map(|(_, value)| *value);
            let (Some(registers), Some(spilled)) = (of("VGPRs"), of("Spilled VGPRs")) else {
                panic!("{} has no count of registers: {statistics:?}", kernel.name)
            };
            println!("{:24} {precision} {registers:4} registers, {spilled} spilled", kernel.name);
            if spilled > 0 || registers > MOST {
                wrong.push(format!("{} in {precision}: {registers} registers, {spilled} spilled", kernel.name));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

//! Which adapters there are, and which one is taken.

use super::error::GpuError;
use super::needs::{self, KernelLimits};
use std::fmt;

/// The environment variable that selects an adapter by a part of its name (case does not matter).
pub const ADAPTER_VARIABLE: &str = "ASPERITY_ADAPTER";

/// What the user asked for with `--device`, where a device may be used at all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DeviceRequest {
    /// A real GPU if there is one, the CPU otherwise.
    Auto,
    /// A GPU; a software adapter if there is nothing else.
    Gpu,
}

/// What sort of machine stands behind an adapter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum AdapterKind {
    /// Its own memory.
    Discrete,
    /// Shares the CPU's memory.
    Integrated,
    /// A part of a GPU, through a hypervisor.
    Virtual,
    /// Unknown to the driver layer.
    Other,
    /// A driver that computes on the CPU: slower than the CPU backend, there for tests.
    Software,
}

impl AdapterKind {
    /// Whether this is hardware that a run gains from.
    pub fn is_real(self) -> bool {
        matches!(self, Self::Discrete | Self::Integrated | Self::Virtual)
    }
}

impl From<wgpu::DeviceType> for AdapterKind {
    fn from(kind: wgpu::DeviceType) -> Self {
        match kind {
            wgpu::DeviceType::DiscreteGpu => Self::Discrete,
            wgpu::DeviceType::IntegratedGpu => Self::Integrated,
            wgpu::DeviceType::VirtualGpu => Self::Virtual,
            wgpu::DeviceType::Cpu => Self::Software,
            wgpu::DeviceType::Other => Self::Other,
        }
    }
}

impl fmt::Display for AdapterKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Discrete => "discrete GPU",
            Self::Integrated => "integrated GPU",
            Self::Virtual => "virtual GPU",
            Self::Other => "unknown device",
            Self::Software => "software (CPU)",
        })
    }
}

/// One adapter as the driver describes it.
#[derive(Clone, Debug)]
pub struct Adapter {
    /// Name, as `ASPERITY_ADAPTER` matches it.
    pub name: String,
    /// What sort of machine.
    pub kind: AdapterKind,
    /// Driver interface: vulkan, metal, dx12.
    pub backend: String,
    /// Driver and version.
    pub driver: String,
    /// f64 in shaders (SHADER_F64): Vulkan only.
    pub double_precision: bool,
    /// Times of dispatches can be read (TIMESTAMP_QUERY).
    pub timestamps: bool,
    /// Longest array a kernel sees, bytes.
    pub max_binding: u64,
    /// Longest array, bytes.
    pub max_buffer: u64,
    /// What a kernel may have of it.
    pub limits: KernelLimits,
    /// Workgroups in one direction of a dispatch.
    pub max_workgroups: u32,
}

impl Adapter {
    /// Describes a wgpu adapter.
    pub fn of(adapter: &wgpu::Adapter) -> Self {
        let (info, features, limits) = (adapter.get_info(), adapter.features(), adapter.limits());
        Self {
            name: info.name,
            kind: info.device_type.into(),
            backend: info.backend.to_string(),
            driver: format!("{} {}", info.driver, info.driver_info).trim().to_owned(),
            double_precision: features.contains(wgpu::Features::SHADER_F64),
            timestamps: features.contains(wgpu::Features::TIMESTAMP_QUERY),
            max_binding: limits.max_storage_buffer_binding_size,
            max_buffer: limits.max_buffer_size,
            limits: KernelLimits::of(&limits),
            max_workgroups: limits.max_compute_workgroups_per_dimension,
        }
    }
}

/// What is taken, and why.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Choice {
    /// Index into the adapters; none is the CPU backend.
    pub adapter: Option<usize>,
    /// Whether the environment named it, so that nothing else is asked.
    pub named: bool,
    /// The reason, for the log and for `asperity devices`.
    pub reason: String,
}

/// The instance that every adapter comes from. Validation layers and debug labels are left out:
/// this program has error scopes.
pub(super) fn instance() -> wgpu::Instance {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = wgpu::Backends::VULKAN | wgpu::Backends::METAL | wgpu::Backends::DX12;
    descriptor.flags = wgpu::InstanceFlags::empty();
    // Where the driver tells its memory budget (VK_EXT_memory_budget), refuse before the machine
    // starts to swap.
    descriptor.memory_budget_thresholds.for_resource_creation = Some(90);
    wgpu::Instance::new(descriptor)
}

/// The adapters of an instance, in the driver's order.
pub(super) fn enumerate(instance: &wgpu::Instance) -> Vec<wgpu::Adapter> {
    pollster::block_on(instance.enumerate_adapters(wgpu::Backends::all()))
}

/// Every adapter of this machine, in the driver's order; empty without a driver.
pub fn adapters() -> Vec<Adapter> {
    enumerate(&instance()).iter().map(Adapter::of).collect()
}

/// Bytes of an adapter's largest heap of device-local memory; `None` where its interface is not
/// Vulkan, or there is no such heap.
#[cfg(any(target_os = "linux", target_os = "windows"))]
pub(super) fn own_memory(adapter: &wgpu::Adapter) -> Option<u64> {
    const DEVICE_LOCAL: u32 = 1;
    // SAFETY: the handles are asked about, and neither kept nor destroyed; both live as long as the
    // adapter, which is borrowed.
    #[allow(unsafe_code)]
    let properties = unsafe {
        let adapter = adapter.as_hal::<wgpu::hal::api::Vulkan>()?;
        adapter.shared_instance().raw_instance().get_physical_device_memory_properties(adapter.raw_physical_device())
    };
    let heaps = properties.memory_heaps.iter().take(properties.memory_heap_count as usize);
    heaps.filter(|heap| heap.flags.as_raw() & DEVICE_LOCAL != 0).map(|heap| heap.size).max()
}

/// There is no Vulkan to ask here.
#[cfg(not(any(target_os = "linux", target_os = "windows")))]
pub(super) fn own_memory(_: &wgpu::Adapter) -> Option<u64> {
    None
}

/// The adapter named in the environment, if any.
pub fn wanted_name() -> Option<String> {
    std::env::var(ADAPTER_VARIABLE).ok().filter(|name| !name.trim().is_empty())
}

/// Chooses among `adapters`.
///
/// A name (from [`ADAPTER_VARIABLE`]) decides alone. Otherwise a real GPU is taken: discrete before
/// integrated before virtual, with double precision before without. A software adapter is slower
/// than the CPU backend: `Auto` takes the CPU instead, `Gpu` takes the software adapter if there is
/// nothing else. An adapter whose limits are below what the kernels need is passed over.
///
/// # Errors
/// [`GpuError::NoSuchAdapter`] for a name that matches nothing, [`GpuError::NoAdapter`] for `Gpu`
/// without any adapter, [`GpuError::Unfit`] where the one that is left has too low a limit.
pub fn choose(adapters: &[Adapter], request: DeviceRequest, wanted: Option<&str>) -> Result<Choice, GpuError> {
    let best = |accept: &dyn Fn(&Adapter) -> bool| {
        (0..adapters.len())
            .filter(|&i| accept(&adapters[i]))
            .min_by_key(|&i| (adapters[i].kind, !adapters[i].double_precision, i))
    };
    let unfit = |i: usize| {
        let what = needs::unmet(&adapters[i].limits)?;
        Some(GpuError::Unfit { adapter: adapters[i].name.clone(), what })
    };
    if let Some(wanted) = wanted {
        let needle = wanted.trim().to_lowercase();
        let found = best(&|a| a.name.to_lowercase().contains(&needle)).ok_or_else(|| GpuError::NoSuchAdapter {
            wanted: wanted.to_owned(),
            present: match adapters {
                [] => "none".to_owned(),
                _ => adapters.iter().map(|a| a.name.as_str()).collect::<Vec<_>>().join(", "),
            },
        })?;
        return match unfit(found) {
            Some(error) => Err(error),
            None => Ok(Choice { adapter: Some(found), named: true, reason: format!("named by {ADAPTER_VARIABLE}={wanted}") }),
        };
    }
    let fits = |a: &Adapter| needs::unmet(&a.limits).is_none();
    if let Some(found) = best(&|a| a.kind.is_real() && fits(a)) {
        let others = adapters.iter().filter(|a| a.kind.is_real()).count() > 1;
        let reason = if others { "the best of the real GPUs" } else { "a real GPU" };
        return Ok(Choice { adapter: Some(found), named: false, reason: reason.to_owned() });
    }
    let refused = best(&|a| a.kind.is_real()).and_then(unfit);
    let cpu = |reason: String| Ok(Choice { adapter: None, named: false, reason });
    match (request, refused, best(&fits)) {
        (DeviceRequest::Auto, Some(error), _) => cpu(error.to_string()),
        (DeviceRequest::Auto, None, _) if adapters.is_empty() => cpu("no adapter is present".to_owned()),
        (DeviceRequest::Auto, None, _) => {
            cpu("only a software adapter is present, and it is slower than the CPU backend".to_owned())
        }
        (DeviceRequest::Gpu, _, Some(found)) => {
            let reason = "no real GPU is of use: this is slower than --device cpu".to_owned();
            Ok(Choice { adapter: Some(found), named: false, reason })
        }
        (DeviceRequest::Gpu, refused, None) => {
            Err(refused.or_else(|| best(&|_| true).and_then(unfit)).unwrap_or(GpuError::NoAdapter))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn adapter(name: &str, kind: AdapterKind, double_precision: bool) -> Adapter {
        Adapter {
            name: name.into(),
            kind,
            backend: "vulkan".into(),
            driver: String::new(),
            double_precision,
            timestamps: true,
            max_binding: 1 << 27,
            max_buffer: 1 << 31,
            limits: needs::ENOUGH,
            max_workgroups: 65535,
        }
    }

    /// As `adapter`, with four arrays a kernel.
    fn with_four(name: &str, kind: AdapterKind) -> Adapter {
        let mut adapter = adapter(name, kind, true);
        adapter.limits.storage_buffers = 4;
        adapter
    }

    #[test]
    fn an_adapter_that_is_too_small_is_passed_over() {
        let small = [with_four("small", AdapterKind::Discrete), adapter("Iris Xe", AdapterKind::Integrated, false)];
        assert_eq!(taken(&small, DeviceRequest::Auto, None), Some(1));
        let named = choose(&small, DeviceRequest::Auto, Some("small")).unwrap_err();
        let GpuError::Unfit { adapter: name, what } = &named else { panic!("{named}") };
        assert!(name == "small" && what.starts_with("needs ") && what.ends_with("the adapter has 4"), "{named}");
        let software = [with_four("small", AdapterKind::Discrete), adapter("llvmpipe", AdapterKind::Software, true)];
        let choice = choose(&software, DeviceRequest::Auto, None).unwrap();
        assert!(choice.adapter.is_none() && choice.reason.contains("storage buffers in one kernel ("), "{choice:?}");
        assert_eq!(taken(&software, DeviceRequest::Gpu, None), Some(1));
        assert_eq!(choose(&software[..1], DeviceRequest::Gpu, None), Err(named));
        let only_software = [with_four("llvmpipe", AdapterKind::Software)];
        assert!(matches!(choose(&only_software, DeviceRequest::Gpu, None), Err(GpuError::Unfit { .. })));
        assert_eq!(taken(&only_software, DeviceRequest::Auto, None), None);
    }

    fn taken(adapters: &[Adapter], request: DeviceRequest, name: Option<&str>) -> Option<usize> {
        choose(adapters, request, name).unwrap().adapter
    }

    #[test]
    fn a_software_adapter_is_never_taken_automatically() {
        let software = [adapter("llvmpipe", AdapterKind::Software, true)];
        assert_eq!(taken(&software, DeviceRequest::Auto, None), None);
        assert_eq!(taken(&software, DeviceRequest::Gpu, None), Some(0));
        assert_eq!(taken(&software, DeviceRequest::Auto, Some("LLVM")), Some(0));
        let unknown = [adapter("mystery", AdapterKind::Other, true)];
        assert_eq!(taken(&unknown, DeviceRequest::Auto, None), None);
    }

    #[test]
    fn real_gpus_are_ranked() {
        let all = [
            adapter("llvmpipe", AdapterKind::Software, true),
            adapter("Iris Xe", AdapterKind::Integrated, false),
            adapter("RTX (DX12)", AdapterKind::Discrete, false),
            adapter("RTX (Vulkan)", AdapterKind::Discrete, true),
        ];
        for request in [DeviceRequest::Auto, DeviceRequest::Gpu] {
            assert_eq!(taken(&all, request, None), Some(3));
            assert_eq!(taken(&all[..3], request, None), Some(2));
            assert_eq!(taken(&all[..2], request, None), Some(1));
            assert_eq!(taken(&all, request, Some("iris")), Some(1));
        }
    }

    #[test]
    fn nothing_there() {
        assert_eq!(taken(&[], DeviceRequest::Auto, None), None);
        assert_eq!(choose(&[], DeviceRequest::Gpu, None), Err(GpuError::NoAdapter));
        let present = [adapter("A", AdapterKind::Discrete, true), adapter("B", AdapterKind::Software, true)];
        let error = choose(&present, DeviceRequest::Auto, Some("C")).unwrap_err();
        assert_eq!(error, GpuError::NoSuchAdapter { wanted: "C".into(), present: "A, B".into() });
        assert!(error.to_string().contains("ASPERITY_ADAPTER=C"), "{error}");
    }
}

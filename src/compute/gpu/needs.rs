//! What the kernels need of an adapter, and whether it has that: asked before it is chosen.
//!
//! The needs are read from the sources of [`KERNELS`] as naga reads them, so that a kernel which is
//! added or grows needs nothing here. They are within what WebGPU promises of every adapter, and a
//! device is asked for no more but for what the size of a batch depends on.

use super::kernel::Kernel;
use super::kernels::KERNELS;
use super::reflect::Binding;
use std::fmt;
use std::sync::OnceLock;

/// What a kernel may have of an adapter, or takes of it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct KernelLimits {
    /// Arrays that it sees at once.
    pub storage_buffers: u64,
    /// Blocks of parameters that it sees at once.
    pub uniform_buffers: u64,
    /// Bytes of such a block.
    pub uniform_bytes: u64,
    /// Threads of a workgroup.
    pub threads: u64,
    /// Bytes that the threads of a workgroup share.
    pub shared_bytes: u64,
}

impl KernelLimits {
    /// Those of them that wgpu has.
    pub fn of(limits: &wgpu::Limits) -> Self {
        Self {
            storage_buffers: limits.max_storage_buffers_per_shader_stage.into(),
            uniform_buffers: limits.max_uniform_buffers_per_shader_stage.into(),
            uniform_bytes: limits.max_uniform_buffer_binding_size,
            threads: limits.max_compute_invocations_per_workgroup.min(limits.max_compute_workgroup_size_x).into(),
            shared_bytes: limits.max_compute_workgroup_storage_size.into(),
        }
    }
}

/// What a device is asked for, whose adapter has these limits: WebGPU's defaults, or what it has
/// where that is less; and of arrays and workgroups as many as it has.
pub(super) fn asked_for(adapter: &wgpu::Limits) -> wgpu::Limits {
    wgpu::Limits {
        max_storage_buffer_binding_size: adapter.max_storage_buffer_binding_size,
        max_buffer_size: adapter.max_buffer_size,
        max_compute_workgroups_per_dimension: adapter.max_compute_workgroups_per_dimension,
        ..wgpu::Limits::defaults().or_worse_values_from(adapter)
    }
}

/// Limits of an adapter on which every kernel runs, for tests: WebGPU's defaults.
#[cfg(test)]
pub(super) const ENOUGH: KernelLimits =
    KernelLimits { storage_buffers: 8, uniform_buffers: 12, uniform_bytes: 64 << 10, threads: 256, shared_bytes: 16 << 10 };

/// The most that any kernel takes of one limit.
#[derive(Clone, Copy, Debug)]
pub struct Need {
    /// Of what, in words.
    pub what: &'static str,
    /// The limit's place among [`KernelLimits`].
    of: OfLimits,
    /// How much.
    pub needed: u64,
    /// The kernel.
    pub kernel: &'static str,
}

impl Need {
    /// What an adapter has of it.
    pub fn has(&self, limits: &KernelLimits) -> u64 {
        (self.of)(limits)
    }
}

impl fmt::Display for Need {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {} ({})", self.needed, self.what, self.kernel)
    }
}

/// One of the limits.
type OfLimits = fn(&KernelLimits) -> u64;

/// The limits in words.
const KINDS: [(&str, OfLimits); 5] = [
    ("storage buffers in one kernel", |limits| limits.storage_buffers),
    ("uniform buffers in one kernel", |limits| limits.uniform_buffers),
    ("bytes in one uniform buffer", |limits| limits.uniform_bytes),
    ("threads in one workgroup", |limits| limits.threads),
    ("bytes of memory in one workgroup", |limits| limits.shared_bytes),
];

/// What a kernel takes; nothing of a source that is not valid, which is an error when it is
/// compiled.
fn taken(kernel: &Kernel) -> KernelLimits {
    let Ok(interface) = kernel.interface() else { return KernelLimits::default() };
    let uniform = interface.variables.iter().filter(|variable| variable.kind == Binding::Uniform).count();
    KernelLimits {
        storage_buffers: (interface.variables.len() - uniform) as u64,
        uniform_buffers: uniform as u64,
        uniform_bytes: interface.uniform_bytes,
        threads: interface.workgroup.into(),
        shared_bytes: interface.shared_bytes,
    }
}

fn most(kernels: &[&'static Kernel]) -> Vec<Need> {
    let taken: Vec<(&'static str, KernelLimits)> = kernels.iter().map(|kernel| (kernel.name, taken(kernel))).collect();
    let of_kind = |&(what, of): &(&'static str, OfLimits)| {
        let (kernel, limits) = taken.iter().rev().max_by_key(|(_, limits)| of(limits))?;
        Some(Need { what, of, needed: of(limits), kernel })
    };
    KINDS.iter().filter_map(of_kind).collect()
}

/// The needs of all kernels, one for each limit; found once.
pub fn needs() -> &'static [Need] {
    static NEEDS: OnceLock<Vec<Need>> = OnceLock::new();
    NEEDS.get_or_init(|| most(KERNELS))
}

/// The first need that an adapter does not meet, in words; none if it meets all.
pub fn unmet(limits: &KernelLimits) -> Option<String> {
    let need = needs().iter().find(|need| need.has(limits) < need.needed)?;
    Some(format!("needs {need}, the adapter has {}", need.has(limits)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compute::gpu::source::ShaderSource;

    static SHARING: Kernel = Kernel::new(
        "sharing",
        &[ShaderSource {
            path: "tests",
            text: "
struct Block { a: vec4<u32>, b: real }
@group(0) @binding(0) var<uniform> block: Block;
@group(0) @binding(1) var<storage, read_write> values: array<real>;
var<workgroup> shared_numbers: array<real, 32>;
@compute @workgroup_size(8, 4)
fn sharing(@builtin(local_invocation_index) i: u32) {
    shared_numbers[i] = block.b;
    values[i] = shared_numbers[i];
}
",
        }],
    );

    #[test]
    fn a_kernels_needs_are_those_of_its_source() {
        let expected = KernelLimits { storage_buffers: 1, uniform_buffers: 1, uniform_bytes: 32, threads: 32, shared_bytes: 256 };
        assert_eq!(taken(&SHARING), expected);
        let needs = most(&[&SHARING]);
        assert!(needs.len() == KINDS.len() && needs.iter().all(|need| need.kernel == "sharing"));
    }

    #[test]
    fn a_device_is_asked_for_the_defaults_and_long_arrays() {
        let defaults = wgpu::Limits::defaults();
        assert_eq!(KernelLimits::of(&defaults), ENOUGH);
        let large = wgpu::Limits {
            max_storage_buffers_per_shader_stage: 1000,
            max_compute_workgroup_storage_size: 96 << 10,
            max_storage_buffer_binding_size: 2 << 30,
            max_buffer_size: 4 << 30,
            ..defaults.clone()
        };
        let asked = asked_for(&large);
        assert_eq!((asked.max_storage_buffer_binding_size, asked.max_buffer_size), (2 << 30, 4 << 30));
        assert_eq!(KernelLimits::of(&asked), ENOUGH);
        let small = wgpu::Limits { max_uniform_buffer_binding_size: 16 << 10, ..defaults };
        assert_eq!(asked_for(&small).max_uniform_buffer_binding_size, 16 << 10);
    }

    #[test]
    fn every_need_is_compared() {
        assert_eq!(unmet(&ENOUGH), None);
        for need in needs() {
            assert!(need.needed > 0 && KERNELS.iter().any(|kernel| kernel.name == need.kernel), "{need}");
        }
        let short = [
            (KernelLimits { storage_buffers: 7, ..ENOUGH }, "storage buffers in one kernel (", "has 7"),
            (KernelLimits { uniform_buffers: 0, ..ENOUGH }, "uniform buffers in one kernel (", "has 0"),
            (KernelLimits { uniform_bytes: 16, ..ENOUGH }, "bytes in one uniform buffer (", "has 16"),
            (KernelLimits { threads: 128, ..ENOUGH }, "threads in one workgroup (", "has 128"),
            (KernelLimits { shared_bytes: 64, ..ENOUGH }, "bytes of memory in one workgroup (", "has 64"),
        ];
        for (limits, need, has) in short {
            let said = unmet(&limits).unwrap();
            assert!(said.starts_with("needs ") && said.contains(need) && said.ends_with(has), "{said}");
        }
    }
}

//! Arguments of kernels: arrays, each with the name that the kernel's WGSL has for it.

/// How much of an array a dispatch touches.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Extent {
    /// So little that it is not counted.
    #[default]
    Little,
    /// All of it, however many slots there are.
    Whole,
    /// One of so many equal parts for each slot: there are as many as slots, cases or geometries,
    /// or as iterates or vectors of these.
    Each(u64),
}

/// The size of an argument.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Array {
    /// Bytes of the array.
    pub bytes: u64,
    /// What of it is touched.
    pub extent: Extent,
}

impl Array {
    /// Bytes that a dispatch for so many slots touches.
    pub fn touched(&self, slots: u64) -> u64 {
        match self.extent {
            Extent::Little => 0,
            Extent::Whole => self.bytes,
            // Cases may share a geometry, which then moves once.
            Extent::Each(parts) => self.bytes / parts.max(1) * slots.min(parts),
        }
    }
}

/// An argument of a kernel.
#[derive(Clone, Debug)]
pub struct Argument<'a> {
    /// The WGSL variable that it goes to.
    pub(super) name: &'static str,
    pub(super) resource: wgpu::BindingResource<'a>,
    pub(super) array: Array,
}

/// Arrays with the names of the WGSL variables that they go to: `args! { level: self.block, b }`.
macro_rules! args {
    (@ $name:ident) => { $name.named(stringify!($name)) };
    (@ $name:ident $array:expr) => { $array.named(stringify!($name)) };
    ($($name:ident $(: $array:expr)?),* $(,)?) => {
        [$($crate::compute::gpu::arguments::args!(@ $name $($array)?)),*]
    };
}
pub(super) use args;

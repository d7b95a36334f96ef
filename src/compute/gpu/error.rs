//! What can go wrong on a device, and what to do about it.

use thiserror::Error;

/// A failure of the device layer. Each message says what failed, where, and what to do.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum GpuError {
    /// No adapter at all.
    #[error(
        "no GPU found: no driver for Vulkan, Metal or DX12 is present. Use --device cpu (or auto), or install a driver \
         (software Vulkan: apt-get install mesa-vulkan-drivers libvulkan1); `asperity devices` lists what is found"
    )]
    NoAdapter,
    /// Drivers are installed, and no adapter comes of them.
    #[error(
        "no GPU can be used: Vulkan's drivers are installed ({drivers}) and none of them opens a device. The driver is broken, \
         is of another version than the system's, or may not see the card: `vulkaninfo --summary` says which.{hint} \
         --device cpu needs none"
    )]
    BrokenDriver {
        /// Their files.
        drivers: String,
        /// What else is known, a sentence with a space before it, or nothing.
        hint: String,
    },
    /// A limit of an adapter is below what a kernel needs.
    #[error("{adapter}: {what}. Another adapter may do (ASPERITY_ADAPTER), or --device cpu")]
    Unfit {
        /// Name of the adapter.
        adapter: String,
        /// The need, the kernel and the limit.
        what: String,
    },
    /// `ASPERITY_ADAPTER` matches nothing.
    #[error("ASPERITY_ADAPTER={wanted}: no adapter has this in its name. Present: {present}. Unset it or name one of these")]
    NoSuchAdapter {
        /// The value of the variable.
        wanted: String,
        /// Names of the adapters found.
        present: String,
    },
    /// The driver refused to open a device.
    #[error("{adapter}: the driver opened no device: {reason}. Another adapter may do (ASPERITY_ADAPTER), or --device cpu")]
    NoDevice {
        /// Name of the adapter.
        adapter: String,
        /// The driver's words.
        reason: String,
    },
    /// Double precision asked of an adapter without it.
    #[error("{adapter} has no double precision in shaders (SHADER_F64): use --precision auto, mixed or f32, or --device cpu")]
    NoDoublePrecision {
        /// Name of the adapter.
        adapter: String,
    },
    /// A shader that does not compile: a fault of this program.
    #[error("{place}: {message}. This is a fault of the program, not of the input; --device cpu avoids it")]
    Shader {
        /// `file:line` of the WGSL.
        place: String,
        /// The compiler's words.
        message: String,
    },
    /// An argument that a kernel cannot be bound with: a fault of this program.
    #[error("kernel {kernel}: {flaw} `{name}`. This is a fault of the program, not of the input; --device cpu avoids it")]
    Argument {
        /// The kernel.
        kernel: &'static str,
        /// Name of the argument.
        name: String,
        /// What is wrong with it.
        flaw: ArgumentFlaw,
    },
    /// A pipeline, buffer or bind group that the driver or wgpu refused.
    #[error("{what}: {message}. This is a fault of the program or the driver, not of the input; --device cpu avoids it")]
    Rejected {
        /// What was being made.
        what: String,
        /// The words of wgpu.
        message: String,
    },
    /// The memory budget is exhausted.
    #[error(
        "{what} needs {needed_mib:.0} MiB of device memory, {used_mib:.0} of {budget_mib:.0} MiB are taken: put fewer cases in a \
         batch, coarsen the mesh, or raise the budget with ASPERITY_GPU_MEMORY (MiB) if the device has more"
    )]
    OutOfBudget {
        /// The array.
        what: String,
        /// Its size.
        needed_mib: f64,
        /// What was taken before.
        used_mib: f64,
        /// The budget.
        budget_mib: f64,
    },
    /// One array is longer than a kernel of this device can see.
    #[error(
        "{what} has {bytes} bytes, this device binds at most {limit}: put fewer cases in a batch or coarsen the mesh; \
         --device cpu has no such limit"
    )]
    TooLarge {
        /// The array.
        what: String,
        /// Its size, bytes.
        bytes: u64,
        /// The device's limit, bytes.
        limit: u64,
    },
    /// An upload or download whose length is not the array's.
    #[error("{what} holds {expected} numbers, {given} were given: a fault of the program")]
    Length {
        /// The array.
        what: String,
        /// Its length.
        expected: usize,
        /// The length given.
        given: usize,
    },
    /// The device was lost, or reported an error that nobody was waiting for. What it holds is not
    /// to be trusted.
    #[error("the device failed: {reason}. Nothing computed on it since is used; run again, or use --device cpu")]
    Lost {
        /// The driver's words.
        reason: String,
    },
    /// What was read back does not belong to the submission that was waited for.
    #[error(
        "{what} came back stale: the device skipped a submission. Nothing computed on it is used; run again, or --device cpu"
    )]
    Stale {
        /// The array read.
        what: String,
    },
    /// The device did not finish in time.
    #[error("{what} was not finished after {seconds} s: the device hangs or is shared. Run again, or use --device cpu")]
    Timeout {
        /// What was waited for.
        what: String,
        /// The limit.
        seconds: u64,
    },
}

/// What is wrong with a kernel's argument.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
pub enum ArgumentFlaw {
    /// A variable that the kernel uses has no argument.
    #[error("no argument is given for its variable")]
    Missing,
    /// The kernel has no variable of this name.
    #[error("it has no variable for the argument")]
    Unknown,
    /// Two arguments have this name.
    #[error("there are two arguments for its variable")]
    Doubled,
}

impl From<GpuError> for crate::compute::ComputeError {
    fn from(error: GpuError) -> Self {
        Self::Device(error.to_string())
    }
}

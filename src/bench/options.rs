//! What is measured, how large, and the threads for it.

use super::error::BenchError;
use super::timing::Patience;

/// The device that is benched beside the CPU.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BenchDevice {
    /// A GPU where there is one; a software adapter is not taken.
    Auto,
    /// None.
    Cpu,
    /// A GPU, a software adapter if there is nothing else, and an error without any.
    Gpu,
}

/// What is measured, and how large.
#[derive(Clone, Debug)]
pub struct Options {
    /// The device beside the CPU.
    pub device: BenchDevice,
    /// Threads of the rows on all cores.
    pub threads: usize,
    /// Cases a call.
    pub batches: Vec<usize>,
    /// Elements along the contact radius.
    pub elements: usize,
    /// Material points a case of the return mapping, a multiple of eight.
    pub points: usize,
    /// Length of the arrays that are copied, bytes.
    pub copied: usize,
    /// How often and how long each evaluation is repeated.
    pub patience: Patience,
}

impl Options {
    /// The whole table: minutes on a machine with a GPU.
    pub fn full(device: BenchDevice, threads: usize) -> Self {
        let patience = Patience { least: 3, most: 15, seconds: 1.0, enough: 4.0 };
        let batches = vec![1, 4, 16, 64, 256];
        Self { device, threads, batches, elements: 8, points: 4096, copied: 256 << 20, patience }
    }

    /// A look at it in a minute, for machines without a GPU and for tests: small meshes, small
    /// batches, few repetitions.
    pub fn quick(device: BenchDevice, threads: usize) -> Self {
        let patience = Patience { least: 3, most: 5, seconds: 0.05, enough: 1.0 };
        Self { device, threads, batches: vec![1, 4, 8], elements: 4, points: 512, copied: 64 << 20, patience }
    }
}

/// The pools of one thread and of all.
pub struct ThreadPools {
    /// One thread.
    pub one: rayon::ThreadPool,
    /// As many as asked for.
    pub all: rayon::ThreadPool,
    /// How many that is.
    pub threads: usize,
}

impl ThreadPools {
    /// Starts the threads.
    ///
    /// # Errors
    /// [`BenchError::Threads`].
    pub fn new(threads: usize) -> Result<Self, BenchError> {
        let pool = |threads: usize| {
            let built = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            built.map_err(|error| BenchError::Threads { threads, what: error.to_string() })
        };
        Ok(Self { one: pool(1)?, all: pool(threads)?, threads })
    }
}

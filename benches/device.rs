//! `asperity bench` as a bench target: the table of all evaluations on CPU and device, a software
//! adapter included.
//!
//! `cargo bench --bench device` takes minutes; with `-- --quick` or `-- --test` the small one. An
//! empty `MESA_SHADER_CACHE_DIR` shows what compiling costs on software Vulkan.

use asperity::internals::bench::{BenchDevice, BenchError, Options, run, table};

fn main() {
    let quick = std::env::args().any(|a| a == "--test" || a == "--quick");
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let options = |device| if quick { Options::quick(device, threads) } else { Options::full(device, threads) };
    let mut say = |text: &str| eprintln!("{text}");
    let measured = match run(&options(BenchDevice::Gpu), &mut say) {
        Err(BenchError::Device(error)) => {
            println!("{error}: the CPU alone");
            run(&options(BenchDevice::Cpu), &mut say)
        }
        measured => measured,
    };
    match measured {
        Ok(report) => print!("{}", table::table(&report)),
        Err(error) => println!("{error}"),
    }
}

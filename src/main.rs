//! The `asperity` program; everything is in the library.

mod out_of_memory;

#[global_allocator]
static ALLOCATOR: out_of_memory::Explained = out_of_memory::Explained;

fn main() -> std::process::ExitCode {
    quiet_drivers();
    asperity::internals::cli::main()
}

/// Mesa's Vulkan layer that asks the display for its preferred adapter complains on stderr where
/// there is no display. This program has no display, and its own ranking of adapters.
#[cfg(target_os = "linux")]
fn quiet_drivers() {
    // SAFETY: the first thing that the program does: there is no other thread that could read the
    // environment.
    #[allow(unsafe_code)]
    unsafe {
        std::env::set_var("NODEVICE_SELECT", "1");
    }
}

#[cfg(not(target_os = "linux"))]
fn quiet_drivers() {}

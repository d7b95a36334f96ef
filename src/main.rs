//! The `asperity` program; everything is in the library.

fn main() -> std::process::ExitCode {
    asperity::cli::main()
}

//! Processor time of the exported contact update beside Hertz and Mindlin's: `cargo bench --bench
//! contact_update [-- LAW.json]`, the fitted law of the repository or a table. Compiled by gcc, in
//! double and in float.

use std::path::{Path, PathBuf};
use std::process::Command;

use asperity::case::Case;
use asperity::law::LawFile;
use asperity::law::export::engine_files;

type Failed = Box<dyn std::error::Error>;

fn main() -> Result<(), Failed> {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|word| word != "--bench").collect();
    let once = arguments.iter().any(|word| word == "--test");
    if !Command::new("gcc").arg("--version").output().is_ok_and(|output| output.status.success()) {
        println!("SKIPPED contact_update: no gcc");
        return Ok(());
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let given = arguments.iter().find(|word| !word.starts_with("--"));
    let law = LawFile::read(&given.map_or_else(|| root.join("fixtures/law/law.json"), PathBuf::from))?;
    let case = Case::load(&root.join("fixtures/cases/ideal.toml"), &[])?;
    let dir = tempfile::tempdir()?;
    for file in engine_files(&law, given.is_none().then_some(&case))? {
        std::fs::write(dir.path().join(file.name), file.content)?;
    }
    for precision in [&[][..], &["-DASPERITY_SINGLE"]] {
        let program = dir.path().join("bench");
        let built = Command::new("gcc")
            .args(["-std=c99", "-O3", "-march=native"])
            .args(precision)
            .arg("-I")
            .arg(dir.path())
            .arg(root.join("benches/contact_update/contact_update.c"))
            .arg("-o")
            .args([&program])
            .arg("-lm")
            .status()?;
        if !built.success() {
            return Err("gcc failed".into());
        }
        println!("{}", if precision.is_empty() { "double" } else { "float" });
        Command::new(&program).arg(if once { "1" } else { "15" }).status()?;
    }
    Ok(())
}

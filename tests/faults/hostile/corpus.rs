//! What is changed: fixtures, files that are hostile as they stand, and what a run leaves.

use std::fs;
use std::path::{Path, PathBuf};

use asperity::Case;
use asperity::law::interpolated::Interpolated;
use rustix::process::{Pid, Signal, kill_process};
use serde_json::Value;

use super::super::common::{Scratch, program};
use super::super::program::{scratch, whole};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The TOML files of some folders.
pub fn toml_files(folders: &[&str]) -> Vec<Vec<u8>> {
    let mut found = Vec::new();
    for folder in folders {
        let entries = fs::read_dir(root().join(folder)).expect("a corpus");
        let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("an entry").path()).collect();
        paths.sort();
        let files = paths.iter().filter(|path| path.to_string_lossy().ends_with(".toml"));
        found.extend(files.map(|path| fs::read(path).expect("a file")));
    }
    found
}

pub fn fixture(name: &str) -> String {
    fs::read_to_string(root().join(name)).expect("a fixture")
}

pub fn json(text: &str) -> Value {
    serde_json::from_str(text).expect("JSON")
}

/// The law of the fixtures without the cases it was fitted to, which are most of it.
pub fn formulas() -> Value {
    let mut law = json(&fixture("fixtures/law/law.json"));
    for value in law.as_object_mut().expect("an object").values_mut() {
        if let Some(items) = value.as_array_mut() {
            items.truncate(2);
        }
    }
    law
}

/// A law by interpolation with so many of its samples.
pub fn interpolated(name: &str) -> Value {
    const SAMPLES: usize = 12;
    let mut law = json(&fixture(name));
    law["samples"].as_array_mut().expect("samples").truncate(SAMPLES);
    for process in law["processes"].as_array_mut().expect("processes") {
        process["weights"].as_array_mut().expect("weights").truncate(SAMPLES);
    }
    law
}

/// Tables of a sphere on a plane, of two equal spheres and of two that differ.
pub fn tables() -> Vec<Value> {
    let law = Interpolated::built_in().expect("the built-in law");
    let made = ["", "[opponent]\nequal = true\n", OTHER].map(|opponent| {
        let table = law.compose(&case(opponent)).expect("a table");
        serde_json::to_value(table).expect("JSON")
    });
    made.into_iter().chain([json(&fixture("fixtures/law/pairs/steel.json"))]).collect()
}

/// Another body that deforms.
const OTHER: &str = "[opponent]\nradius = 2.0\n[opponent.material]\nyoungs_modulus = 70e3\npoissons_ratio = 0.33\n\
                     [opponent.material.hardening]\nlaw = \"linear\"\nyield_stress = 200.0\nmodulus = 500.0\n";

/// A case to use a law with: a press, an oblique one, a shear there and back, and a release.
pub fn case(opponent: &str) -> Case {
    let text = format!(
        "[sphere]\nradius = 1.0\n[material]\nyoungs_modulus = 200e3\npoissons_ratio = 0.3\n[material.hardening]\n\
         law = \"ideal\"\nyield_stress = 400.0\n[contact]\nfriction = 0.3\n{opponent}[[path]]\nindentation = 0.01\n\
         [[path]]\nindentation = 0.02\nshear = 0.001\n[[path]]\nshear = \"full-slip\"\n[[path]]\nshear = 0.0\n\
         hold = \"normal-force\"\n[[path]]\nrelease = true\n"
    );
    Case::parse(&text, "case.toml", &[]).expect("a case")
}

/// A file of the run that nothing disturbed.
pub fn of_run(name: &str) -> Vec<u8> {
    fs::read(whole().join(name)).expect("a file of the run")
}

/// The last of its contact tables.
pub fn contact() -> Vec<u8> {
    let entries = fs::read_dir(whole().join("contact")).expect("tables");
    let last = entries.map(|entry| entry.expect("an entry").path()).max().expect("a table");
    fs::read(last).expect("a table")
}

/// The directory of a run that was interrupted, with its checkpoint.
pub fn interrupted() -> (Scratch, PathBuf) {
    let scratch = scratch();
    let out = scratch.path("out");
    let args = scratch.args(&out, &["-q", "--set", "solver.press_steps=60", "--set", "solver.max_cutbacks=2"]);
    let mut child = program().args(args).stderr(std::process::Stdio::null()).spawn().expect("it runs");
    while !out.join("checkpoint.bin").exists() {
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
    kill_process(Pid::from_child(&child), Signal::TERM).expect("a signal is sent");
    child.wait().expect("it ends");
    (scratch, out)
}

/// A study of two cases in `folder`, both the run that nothing disturbed; its table is returned.
pub fn study(folder: &Path) -> Vec<u8> {
    for name in ["cases/c0000", "cases/c0001"] {
        let case = folder.join(name);
        fs::create_dir_all(&case).expect("a folder");
        for file in ["case.toml", "history.csv", "summary.json"] {
            fs::copy(whole().join(file), case.join(file)).expect("a copy");
        }
    }
    let row = "200000.0,0.3,400.0,0.3,1.0,0.01,0.14,70.0,50.0,15.0,0.0015,0.0018,0.002,30000.0,\
               400.0,60.0,2.8,1.1,15.2,0.9,0.4,4,8,100,0,1.5";
    let head = "case,directory,status,reason,contact.friction,E,nu,sigma_Y,mu,R,h0,a0,F_N0,F_N_slip,F_T_max,delta_T_90,\
                delta_T_95,delta_T_slip,k_T0,sigma_rep,Lambda,Hbar,c2,F_T_max_limit,F_N0_error,F_T_max_error,\
                elements_per_contact_radius,surface_elements_per_contact_radius,newton_iterations,cutbacks,cpu_s";
    format!(
        "{head}\nc0000,cases/c0000,done,,0.3,{row}\nc0001,cases/c0001,done,,0.1,{row}\nc0002,cases/c0002,pending,,0.2,{row}\n"
    )
    .into_bytes()
}

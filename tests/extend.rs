//! `asperity run --extend`: a run that is done goes on along a longer path, to the bits that this
//! has from the beginning.
#![cfg(unix)]

mod common;

use std::fs;
use std::process::Stdio;
use std::time::{Duration, Instant};

use asperity::internals::compute::wrong::WRONG_VARIABLE;
use asperity::output::{RunStatus, Summary, read_history};
use common::{Scratch, difference, files, program, stderr, stdout};
use rustix::process::{Pid, Signal, kill_process};

const CASE: &str = r#"
[sphere]
radius = 1.0
[material]
youngs_modulus = 200e3
poissons_ratio = 0.3
[material.hardening]
law = "ideal"
yield_stress = 400.0
[contact]
friction = 0.3
[mesh]
elements_per_contact_radius = 5
[solver]
press_steps = 6
shear_steps = 4
[[path]]
indentation = 0.02
"#;
const PRESSED: &str = "path=[{indentation=0.02}]";
const SHEARED: &str = "path=[{indentation=0.02},{shear=0.002}]";
const RELEASED: &str = "path=[{indentation=0.02},{shear=0.002},{shear=\"full-slip\"},{release=0.5}]";

fn scratch() -> Scratch {
    Scratch::new(CASE, &["--device", "cpu"])
}

fn set<'a>(sets: &[&'a str], more: &[&'a str]) -> Vec<&'a str> {
    sets.iter().flat_map(|set| ["--set", *set]).chain(more.iter().copied()).collect()
}

fn done(scratch: &Scratch, name: &str, options: &[&str]) -> String {
    let output = scratch.run(name, options);
    assert_eq!(output.status.code(), Some(0), "{options:?}: {}", stderr(&output));
    stderr(&output)
}

#[test]
fn a_longer_path_has_the_bits_that_it_has_from_the_beginning() {
    for (name, sets) in [
        ("scouted", &["output.fields=\"all\""][..]),
        ("blind", &["solver.error_estimate=false", "output.fields=\"none\"", "output.plots=false"]),
        ("stick", &["contact.friction=\"stick\"", "output.parquet=true"]),
        ("equal", &["opponent.equal=true", "mesh.elements_per_contact_radius=4"]),
        ("free", &["sphere.equator=\"free\"", "mesh.elements_per_contact_radius=4"]),
    ] {
        let scratch = scratch();
        let last =
            if name == "stick" { "path=[{indentation=0.02},{shear=0.002},{shear=-0.001},{release=0.5}]" } else { RELEASED };
        let with = |path, more: &[&'static str]| set(&[sets, &[path]].concat(), more);
        done(&scratch, "out", &with(PRESSED, &["-q"]));
        let pressed = read_history(&scratch.path("out/history.csv")).expect("a history");
        let told = done(&scratch, "out", &with(SHEARED, &["--extend", "-v"]));
        assert!(told.contains(&format!("extended after step {} of the run in ", pressed.len())), "{name}: {told}");
        done(&scratch, "whole", &with(SHEARED, &["-q"]));
        assert_eq!(difference(&scratch.path("out"), &scratch.path("whole")), None, "{name}");
        let sheared = read_history(&scratch.path("out/history.csv")).expect("a history");
        let limits = sheared.iter().filter(|row| row.f_t_limit.is_some()).count();
        assert!(if name == "blind" { limits == 0 } else { 2 * limits > sheared.len() }, "{name}: {limits} limits");
        // By two segments, of which the first goes on from the last.
        done(&scratch, "out", &with(last, &["--extend", "-q", "--threads", "1"]));
        done(&scratch, "whole", &with(last, &["-q", "--force"]));
        assert_eq!(difference(&scratch.path("out"), &scratch.path("whole")), None, "{name}");
        // What is done stays as it is.
        let before = files(&scratch.path("out"));
        let output = scratch.run("out", &with(last, &["--extend"]));
        assert!(output.status.success() && stdout(&output).starts_with("already done: "), "{name}: {}", stderr(&output));
        assert!(files(&scratch.path("out")) == before, "{name}");
    }
}

#[test]
fn an_extension_that_is_interrupted_or_killed_goes_on() {
    let scratch = scratch();
    let with = |path, more: &[&'static str]| set(&[path, "solver.shear_steps=30"], more);
    done(&scratch, "pressed", &with(PRESSED, &["-q"]));
    done(&scratch, "whole", &with(SHEARED, &["-q"]));
    let pressed = read_history(&scratch.path("pressed/history.csv")).expect("a history").len();
    for (signal, code, again) in
        [(Signal::TERM, Some(75), "--resume"), (Signal::KILL, None, "--resume"), (Signal::TERM, Some(75), "--extend")]
    {
        let _ = fs::remove_dir_all(scratch.path("out"));
        for (name, bytes) in files(&scratch.path("pressed")) {
            let path = scratch.path("out").join(name);
            fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
            fs::write(path, bytes).expect("a copy");
        }
        let mut command = program();
        command.args(scratch.args("out", &with(SHEARED, &["--extend", "-q", "--checkpoint-every", "0"])));
        let child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("the program runs");
        let begun = Instant::now();
        while read_history(&scratch.path("out/history.csv")).map_or(0, |rows| rows.len()) < pressed + 4 {
            assert!(begun.elapsed() < Duration::from_secs(300), "no step for ever");
            std::thread::sleep(Duration::from_millis(2));
        }
        kill_process(Pid::from_child(&child), signal).expect("a signal is sent");
        let output = child.wait_with_output().expect("it ends");
        assert_eq!(output.status.code(), code, "{}", stderr(&output));
        // The shorter path is not what is unfinished there.
        let refused = scratch.run("out", &with(PRESSED, &["--resume"]));
        assert_eq!(refused.status.code(), Some(2), "{}", stderr(&refused));
        done(&scratch, "out", &[&with(SHEARED, &["-q"])[..], &[again]].concat());
        assert_eq!(difference(&scratch.path("out"), &scratch.path("whole")), None, "{signal:?}, {again}");
    }
}

#[test]
fn what_cannot_be_extended_is_refused_and_stays_as_it_is() {
    let scratch = scratch();
    let refused = |name: &str, sets: &[&'static str], parts: &[&str]| {
        // The log tells of the attempt.
        let kept = || {
            let mut kept = scratch.path(name).exists().then(|| files(&scratch.path(name)));
            kept.iter_mut().for_each(|kept| drop(kept.remove("run.log")));
            kept
        };
        let before = kept();
        let output = scratch.run(name, &set(sets, &["--extend", "-q"]));
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{sets:?}: {message}");
        for part in ["error: --out ", "cannot be extended: ", "nothing was changed"].iter().chain(parts) {
            assert!(message.contains(part), "{part}: {message}");
        }
        assert!(kept() == before, "{sets:?}: something was changed");
    };
    refused("none", &[SHEARED], &["it holds no run that is done", "leave out --extend"]);
    done(&scratch, "out", &set(&[SHEARED], &["-q"]));
    refused("out", &[RELEASED, "contact.friction=0.2"], &["contact.friction is 0.3 there and 0.2 here"]);
    refused(
        "out",
        &[RELEASED, "mesh.elements_per_contact_radius=4"],
        &["mesh.elements_per_contact_radius is 5 there and 4 here"],
    );
    refused("out", &[PRESSED], &["path.1.", " there and absent here"]);
    refused("out", &["path=[{indentation=0.02},{shear=0.001},{release=true}]"], &["path.1.shear is 0.002 there and 0.001 here"]);
    let across = "path=[{indentation=0.02},{shear=0.002},{shear=[0.001,0.001]}]";
    refused("out", &[across], &["the longer path leaves the x axis", "the whole sphere"]);
    // Deeper, the mesh would be another one.
    let deeper = "path=[{indentation=0.02},{shear=0.002},{indentation=0.04}]";
    refused("out", &[deeper], &["from the beginning, the longer path would have another mesh", "mesh.contact_radius"]);
    // So it would by what the coarse run finds, not by the closed form alone.
    let narrow = "mesh.contact_radius=0.12";
    done(&scratch, "narrow", &set(&[narrow, "path=[{indentation=0.005}]"], &["-q"]));
    refused("narrow", &[narrow, "path=[{indentation=0.005},{indentation=0.02}]"], &["another mesh"]);

    done(&scratch, "forgotten", &set(&[SHEARED, "output.keep_checkpoint=false"], &["-q"]));
    assert!(!scratch.path("forgotten/checkpoint.bin").exists());
    refused("forgotten", &[RELEASED], &["was not kept (output.keep_checkpoint)"]);
    let fails = ["solver.max_iterations=1", "solver.max_cutbacks=0", "solver.error_estimate=false"];
    assert_eq!(scratch.run("fails", &set(&fails, &["-q"])).status.code(), Some(3));
    assert!(!scratch.path("fails/checkpoint.bin").exists());
    refused("fails", &[&fails[..], &[SHEARED]].concat(), &["its run ended as \"not converged\""]);
}

#[test]
fn a_mesh_that_is_given_is_pressed_deeper() {
    let scratch = scratch();
    let given = ["mesh.contact_radius=0.3", "solver.error_estimate=false"];
    let with = |path, more: &[&'static str]| set(&[&given[..], &[path]].concat(), more);
    let deeper = "path=[{indentation=0.02},{indentation=0.03}]";
    done(&scratch, "out", &with(PRESSED, &["-q"]));
    done(&scratch, "out", &with(deeper, &["--extend", "-q"]));
    done(&scratch, "whole", &with(deeper, &["-q"]));
    assert_eq!(difference(&scratch.path("out"), &scratch.path("whole")), None);
    assert_eq!(Summary::read(&scratch.path("out/summary.json")).expect("a summary").status, RunStatus::Done);
}

/// Of an extension that does not converge the end before it is kept, and another one goes on from
/// there.
#[test]
fn an_extension_that_fails_leaves_the_end_before_it() {
    let scratch = scratch();
    let with = |path, more: &[&'static str]| set(&["solver.error_estimate=false", "solver.max_cutbacks=1", path], more);
    done(&scratch, "out", &with(PRESSED, &["-q"]));
    let steps = read_history(&scratch.path("out/history.csv")).expect("a history").len();
    // The other way, in which every step is refused.
    let mut command = program();
    let other = "path=[{indentation=0.02},{shear=-0.002}]";
    let output = command.args(scratch.args("out", &with(other, &["--extend", "-q"]))).env(WRONG_VARIABLE, "force:1").output();
    let output = output.expect("the program runs");
    assert_eq!(output.status.code(), Some(3), "{}", stderr(&output));
    assert!(read_history(&scratch.path("out/history.csv")).expect("a history").len() > steps);
    assert_eq!(Summary::read(&scratch.path("out/summary.json")).expect("a summary").status, RunStatus::NotConverged);
    done(&scratch, "out", &with(SHEARED, &["--extend", "-q"]));
    done(&scratch, "whole", &with(SHEARED, &["-q"]));
    assert_eq!(difference(&scratch.path("out"), &scratch.path("whole")), None);
}

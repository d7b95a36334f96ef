//! `asperity study --slurm` and `--merge`: a study that other processes compute.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

use super::{CliError, Exit, called};
use crate::quoting;
use crate::study::slurm::{self, Slurm};
use crate::study::{self, Merged, Study, StudyDirectory};

/// Writes the scripts, whose tasks have these `options` of the command too, and submits them if
/// that is wanted.
pub fn slurm(study: &Study, arguments: &[String], out: &Path, options: &[String], submit: bool) -> Result<Exit, CliError> {
    let slurm = Slurm::parse(arguments)?;
    let program = called::program().map_err(|source| CliError::Out { dir: out.to_owned(), what: "find this program", source })?;
    slurm::check(out, &program)?;
    study::prepare(study, out)?;
    let scripts = slurm::write(&StudyDirectory::new(out), &slurm, &program, options)?;
    let script = quoting::path(&scripts.submit);
    if !submit {
        super::print(&format!("{}, {} tasks; to submit them: bash {script}\n", study.size(), slurm.tasks))?;
        return Ok(Exit::Done);
    }
    let failed = |what: String| CliError::Submit { script: scripts.submit.clone(), what };
    let output =
        Command::new("bash").arg(&scripts.submit).output().map_err(|error| failed(format!("bash cannot be started: {error}")))?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        return Err(failed(format!("sbatch did not take them: {}", said.split_whitespace().collect::<Vec<_>>().join(" "))));
    }
    super::print(&format!("{}: {}", study.size(), String::from_utf8_lossy(&output.stdout)))?;
    Ok(Exit::Done)
}

/// Joins directories and says what is missing.
pub fn merge(sources: &[PathBuf], out: &Path, quiet: bool) -> Result<Exit, CliError> {
    const MOST: usize = 20;
    let Merged { report, copied, missing, busy } = study::merge(sources, out)?;
    let dir = out.display();
    if !quiet {
        let (done, failed, pending) = (report.done, report.failed, report.pending);
        super::print(&format!(
            "{done} done, {failed} failed, {pending} missing; {copied} cases copied; a row each in {dir}/study.csv\n"
        ))?;
    }
    // A closed stderr does not change how it went.
    if !missing.is_empty() {
        let more = if missing.len() > MOST { ", ..." } else { "" };
        let busy = if busy.is_empty() { String::new() } else { format!(" ({} are being computed)", busy.len()) };
        let _ = writeln!(
            std::io::stderr(),
            "error: {} of {} cases are missing{busy}: {}{more}. `asperity study {} --out {} --resume` computes them",
            missing.len(),
            report.done + report.failed + report.pending,
            missing[..missing.len().min(MOST)].join(", "),
            quoting::path(out.join("study.toml")),
            quoting::path(out)
        );
        return Ok(Exit::Interrupted);
    }
    if let Some((id, reason)) = &report.first_failure {
        let _ = writeln!(std::io::stderr(), "error: {} cases failed, the first in {dir}/cases/{id}: {reason}", report.failed);
        return Ok(Exit::CasesFailed);
    }
    Ok(Exit::Done)
}

//! What can be taken away from the page: the case, the law for an engine, the curves as numbers.

use std::fmt::Write as _;

use super::curves::LawCurves;
use super::tar;
use crate::case::Case;
use crate::law::export::{Engine, ExportedFile, Language, Start, law_source, start_files};
use crate::law::{LawError, LawFile};
use crate::output::{StepRecord, decimal};

/// A file to be kept: its name, its type in HTTP, its bytes.
pub type KeptExport = (String, &'static str, Vec<u8>);

const TEXT: &str = "text/plain; charset=utf-8";
const TAR: &str = "application/x-tar";

/// What the page offers: the file's name and what is in it, for the links.
pub const OFFERS: [(&str, &str); 6] = [
    ("case.toml", "the case, for asperity run"),
    ("curves.csv", "the law's curves as numbers"),
    ("asperity_law.h", "the law and its update in one C header"),
    ("engine-c.tar", "headers, tables and a program in C: two spheres, and a wall"),
    ("engine-lammps.tar", "tables and an input for LAMMPS with the plug-in"),
    ("asperity_law.py", "the law and its update as a Python module"),
];

/// One of the files; `None` for a name that is not offered.
///
/// # Errors
/// What the law says of the case.
pub fn file(
    name: &str,
    law: &LawFile,
    case: &Case,
    curves: impl FnOnce() -> Result<LawCurves, LawError>,
) -> Result<Option<KeptExport>, LawError> {
    let text = |content: String| (name.to_owned(), TEXT, content.into_bytes());
    Ok(Some(match name {
        "case.toml" => text(case.to_toml()),
        "curves.csv" => (name.to_owned(), "text/csv; charset=utf-8", csv(&curves()?).into_bytes()),
        "asperity_law.h" => text(law_source(law, Language::C, Some(case))?),
        "asperity_law.py" => text(law_source(law, Language::Python, Some(case))?),
        "engine-c.tar" => (name.to_owned(), TAR, start(law, Engine::C, case, "engine-c")?),
        "engine-lammps.tar" => (name.to_owned(), TAR, start(law, Engine::Lammps, case, "engine-lammps")?),
        _ => return Ok(None),
    }))
}

/// All that an engine starts from, and how to run it.
fn start(law: &LawFile, engine: Engine, case: &Case, folder: &str) -> Result<Vec<u8>, LawError> {
    let Start { mut files, out_of_range } = start_files(law, engine, &[("sphere".to_owned(), case.clone())])?;
    let how = match engine {
        Engine::Lammps => {
            "To run it: lmp -in in.asperity -var plugin PATH/asperityplugin.so\n\
             The plug-in is built in Asperity's repository by: bash integrations/lammps/run.sh --build\n"
        }
        Engine::C => "To run it: cc -std=c99 -O2 main.c -o main -lm && ./main\n",
    };
    let mut content = how.to_owned();
    for (table, beyond) in out_of_range {
        let list: Vec<String> = beyond.iter().map(ToString::to_string).collect();
        let _ = writeln!(content, "{table} goes beyond what the law was made from: {}.", list.join(", "));
    }
    files.push(ExportedFile { name: "README.txt".to_owned(), content });
    Ok(tar::packed(folder, &files))
}

/// Both paths, with the columns that `law predict` prints.
fn csv(curves: &LawCurves) -> String {
    let mut text = String::from("path,segment,h,delta_T,F_N,F_T\n");
    let mut add = |path: &str, rows: &[StepRecord]| {
        for row in rows {
            let numbers = [row.h, row.delta_t, row.f_n, row.f_t].map(decimal);
            let _ = writeln!(text, "{path},{},{}", row.segment, numbers.join(","));
        }
    };
    add("shear", &curves.shear);
    add("cycle", &curves.cycle);
    text
}

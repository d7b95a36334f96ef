//! A study on a cluster with Slurm: a job array whose tasks take a share each, and a job after them
//! that makes the table.
//!
//! The scripts lie in the study's directory and can be read, changed and submitted by hand. A task
//! that is warned of its time limit checkpoints, ends with 75 and goes back into the queue by
//! itself; one that is cancelled stays so. `submit.sh` again computes what is left.

use std::path::{Path, PathBuf};
use std::{fs, io};

use super::StudyError;
use super::directory::StudyDirectory;
use crate::case::{nearest, short};
use crate::output::write_own;
use crate::quoting;

/// How the study is to be handed over.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Slurm {
    /// Tasks of the array: shares of the study.
    pub tasks: usize,
    /// How many may run at a time; none: as many as the cluster lets.
    pub at_once: Option<usize>,
    /// Seconds before its limit at which a task is warned.
    pub warning: usize,
    /// What is handed on to sbatch, names and values.
    pub directives: Vec<(String, String)>,
}

/// What sbatch takes beside, by its long options. Those that the scripts themselves set are not
/// among them.
const DIRECTIVES: [&str; 20] = [
    "account",
    "begin",
    "clusters",
    "comment",
    "constraint",
    "cpus-per-task",
    "exclude",
    "gpus",
    "gres",
    "licenses",
    "mail-type",
    "mail-user",
    "mem",
    "mem-per-cpu",
    "nice",
    "nodelist",
    "partition",
    "qos",
    "reservation",
    "time",
];
/// Those of them that the job for the table needs too.
const FOR_THE_TABLE: [&str; 5] = ["account", "clusters", "partition", "qos", "reservation"];
/// Most tasks: Slurm's own default limit.
const MOST_TASKS: usize = 1000;

impl Slurm {
    /// Reads `key=value` arguments: `tasks`, `at-once`, `warning` and options of sbatch by their
    /// long names.
    ///
    /// # Errors
    /// [`StudyError::Slurm`].
    pub fn parse(arguments: &[String]) -> Result<Self, StudyError> {
        let mut slurm = Self { tasks: 4, at_once: None, warning: 60, directives: Vec::new() };
        for argument in arguments {
            let refuse = |what: String| StudyError::Slurm { argument: short(argument).into_owned(), what };
            let (key, value) =
                argument.split_once('=').ok_or_else(|| refuse("has no `=`. Give key=value, as in time=02:00:00".to_owned()))?;
            let count = |most: usize| {
                let number = value.parse::<usize>().ok().filter(|number| (1..=most).contains(number));
                number.ok_or_else(|| refuse(format!("is not a whole number from 1 to {most}. Correct it")))
            };
            match key {
                "tasks" => slurm.tasks = count(MOST_TASKS)?,
                "at-once" => slurm.at_once = Some(count(MOST_TASKS)?),
                "warning" => slurm.warning = count(65535)?,
                _ if !DIRECTIVES.contains(&key) => {
                    let known = DIRECTIVES.join(", ");
                    let all: Vec<&str> = DIRECTIVES.into_iter().chain(["tasks", "at-once", "warning"]).collect();
                    let meant = nearest(key, &all).map_or(String::new(), |key| format!(", did you mean `{key}`?"));
                    let end = if meant.is_empty() { "." } else { "" };
                    return Err(refuse(format!(
                        "is unknown{meant}{end} Give tasks, at-once, warning or an option of sbatch: {known}"
                    )));
                }
                _ if value.is_empty()
                    || !value.chars().all(|c| c.is_ascii_alphanumeric() || "-_.,:;@%/+=[]()*&|!".contains(c)) =>
                {
                    return Err(refuse("has a value that no option of sbatch takes. Correct it".to_owned()));
                }
                _ => slurm.directives.push((key.to_owned(), value.to_owned())),
            }
        }
        Ok(slurm)
    }
}

/// The scripts in a study's directory.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Scripts {
    /// Submits the two jobs, again after an end that was none.
    pub submit: PathBuf,
}

/// Refuses a directory or a program with a path that scripts or Slurm cannot take. To be asked
/// before anything is written; the directory need not be there.
///
/// # Errors
/// [`StudyError::Slurm`], [`StudyError::Directory`].
pub fn check(out: &Path, program: &Path) -> Result<(), StudyError> {
    paths(out, program).map(drop)
}

/// The directory, without links and from the root on, and the program, as text.
fn paths(out: &Path, program: &Path) -> Result<[String; 2], StudyError> {
    let root = resolved(out).map_err(|source| StudyError::Directory { dir: out.to_owned(), what: "be found", source })?;
    // A pattern of Slurm's, or the end of its quotes.
    const FOR_SLURM: &str = "%\"\\";
    let refuse = |path: &Path, what: &str| StudyError::Slurm { argument: format!("{path:?}"), what: what.to_owned() };
    let text = |path: &Path, refused: &str| {
        let text = path.to_str().filter(|text| !text.chars().any(|c| c.is_control() || refused.contains(c)));
        text.map(str::to_owned)
    };
    let directory = text(&root, FOR_SLURM).ok_or_else(|| {
        let what = "has characters that Slurm does not take in a path (%, \", \\, or such as no text has). Give another directory \
                    with --out (nothing was written)";
        refuse(&root, what)
    })?;
    let program = text(program, "")
        .ok_or_else(|| refuse(program, "is this program, and no path of a script. Install it elsewhere (nothing was written)"))?;
    Ok([directory, program])
}

/// A path without links and from the root on, as far as it is there.
fn resolved(path: &Path) -> io::Result<PathBuf> {
    let absolute = std::path::absolute(path)?;
    let there = absolute.ancestors().find_map(|above| Some((above, fs::canonicalize(above).ok()?)));
    Ok(match there {
        Some((above, real)) => {
            absolute.strip_prefix(above).map_or(absolute.clone(), |rest| real.components().chain(rest.components()).collect())
        }
        None => absolute,
    })
}

/// Writes the scripts for the study in `directory`, which is prepared. `program` is this program,
/// `options` are those of `asperity study` that the tasks are to have.
///
/// # Errors
/// As [`check`]; [`StudyError::Output`].
pub fn write(directory: &StudyDirectory, slurm: &Slurm, program: &Path, options: &[String]) -> Result<Scripts, StudyError> {
    let [dir, program] = paths(directory.root(), program)?;
    let name = Path::new(&dir).file_name().map_or("study".into(), |name| name.to_string_lossy());
    let name: String = name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '-' }).collect();
    let directives = |keys: &[&str]| -> String {
        let wanted = slurm.directives.iter().filter(|(key, _)| keys.contains(&key.as_str()));
        wanted.map(|(key, value)| format!("#SBATCH --{key}={value}\n")).collect()
    };
    let holes = [
        ("@NAME@", name),
        ("@TASKS@", slurm.tasks.to_string()),
        ("@AT_ONCE@", slurm.at_once.map_or(String::new(), |count| format!("%{count}"))),
        ("@WARNING@", slurm.warning.to_string()),
        ("@ALL@\n", directives(&DIRECTIVES)),
        ("@FEW@\n", directives(&FOR_THE_TABLE)),
        ("@OPTIONS@", options.iter().map(|option| format!(" {}", quoting::word(option))).collect()),
        ("@LOGS@", format!("{dir}/slurm")),
        ("@DIR@", quoting::word(&dir)),
        ("@STUDY@", quoting::word(format!("{dir}/study.toml"))),
        ("@PROGRAM@", quoting::word(&program)),
    ];
    let folder = directory.root().join("slurm");
    for (file, text) in [("tasks.sh", TASKS), ("table.sh", TABLE), ("submit.sh", SUBMIT)] {
        write_own(&folder.join(file), |out| out.write_all(filled(text, &holes).as_bytes()))?;
    }
    Ok(Scripts { submit: folder.join("submit.sh") })
}

/// A template with its holes filled, in one pass: what is filled in has no holes, whatever it looks
/// like.
fn filled(template: &str, holes: &[(&str, String)]) -> String {
    let (mut text, mut rest) = (String::with_capacity(2 * template.len()), template);
    while let Some(at) = rest.find('@') {
        let (before, from) = rest.split_at(at);
        text.push_str(before);
        let found = holes.iter().find_map(|(hole, value)| Some((value.as_str(), from.strip_prefix(hole)?)));
        let (value, after) = found.unwrap_or(from.split_at(1));
        text.push_str(value);
        rest = after;
    }
    text + rest
}

const TASKS: &str = include_str!("slurm/tasks.sh");
const TABLE: &str = include_str!("slurm/table.sh");
const SUBMIT: &str = include_str!("slurm/submit.sh");

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(arguments: &[&str]) -> Result<Slurm, String> {
        Slurm::parse(&arguments.iter().map(|a| (*a).to_owned()).collect::<Vec<_>>()).map_err(|error| error.to_string())
    }

    #[test]
    fn arguments_are_ours_or_those_of_sbatch() {
        let slurm = parsed(&["tasks=12", "at-once=3", "time=02:00:00", "mem=4G"]).unwrap();
        assert_eq!((slurm.tasks, slurm.at_once, slurm.warning), (12, Some(3), 60));
        assert_eq!(slurm.directives[0], ("time".to_owned(), "02:00:00".to_owned()));
        for (wrong, part) in [
            ("tasks=0", "from 1 to 1000"),
            ("tasks", "has no `=`"),
            ("array=1-4", "is unknown"),
            ("partiton=long", "is unknown, did you mean `partition`? Give tasks"),
            ("time=", "no option of sbatch takes"),
            ("comment=a\nb", "no option of sbatch takes"),
        ] {
            let message = parsed(&[wrong]).unwrap_err();
            assert!(message.starts_with("--slurm ") && message.contains(part), "{message}");
        }
    }

    /// All that a shell, Slurm's comments and the templates could take for something else.
    const NASTY: &str = "it's a \u{fc}ber $HOME `x` @PROGRAM@ @DIR@ @ALL@ #1 & (2); ~*?[!]{a,b}<>|";

    #[test]
    fn the_scripts_have_everything_filled_in_and_are_shell() {
        let scratch = tempfile::tempdir().unwrap();
        let root = scratch.path().join(NASTY);
        fs::create_dir(&root).unwrap();
        let slurm = parsed(&["tasks=3", "at-once=2", "partition=long", "time=10"]).unwrap();
        let program = Path::new("/opt/a b/50% @LOGS@ \"x\"/asperity");
        let scripts = write(&StudyDirectory::new(&root), &slurm, program, &["--device=cpu".into(), "--a b".into()]).unwrap();
        let read = |name: &str| fs::read_to_string(scripts.submit.with_file_name(name)).unwrap();
        let tasks = read("tasks.sh");
        let quoted = fs::canonicalize(&root).unwrap().display().to_string().replace('\'', "'\\''");
        for part in [
            "--array=1-3%2\n",
            "--partition=long\n",
            "--time=10\n",
            "--signal=B:USR1@60\n",
            "'/opt/a b/50% @LOGS@ \"x\"/asperity' study ",
            "\"${SLURM_CPUS_PER_TASK:-1}\" --device=cpu '--a b' &",
            &format!("#SBATCH --output=\"{}/slurm/task-%a.log\"\n", fs::canonicalize(&root).unwrap().display()),
            &format!("study '{quoted}/study.toml' --out '{quoted}' --shard"),
        ] {
            assert!(tasks.contains(part), "{part}: {tasks}");
        }
        let table = read("table.sh");
        assert!(table.contains("--partition=long\n") && !table.contains("--time="), "{table}");
        for name in ["tasks.sh", "table.sh", "submit.sh"] {
            let bash = std::process::Command::new("bash").arg("-n").arg(scripts.submit.with_file_name(name)).output();
            if let Ok(bash) = bash {
                assert!(bash.status.success(), "{name}: {}", String::from_utf8_lossy(&bash.stderr));
            }
        }
    }

    #[test]
    fn every_hole_of_the_templates_is_filled() {
        let scratch = tempfile::tempdir().unwrap();
        let slurm = parsed(&["tasks=3"]).unwrap();
        let scripts = write(&StudyDirectory::new(scratch.path()), &slurm, Path::new("/opt/asperity"), &[]).unwrap();
        for name in ["tasks.sh", "table.sh", "submit.sh"] {
            let text = fs::read_to_string(scripts.submit.with_file_name(name)).unwrap();
            let left = text.replace("USR1@60", "").replace("$@", "");
            assert!(!left.contains('@'), "{name}: {left}");
        }
    }

    #[test]
    fn what_is_filled_in_has_no_holes() {
        let holes = [("@A@", "@B@".to_owned()), ("@B@", "@A@@".to_owned()), ("@C@\n", String::new())];
        assert_eq!(filled("x@@A@y@B@@D@\n@C@\n@", &holes), "x@@B@y@A@@@D@\n@");
    }

    #[test]
    fn a_path_that_slurm_cannot_take_is_refused_before_it_is_there() {
        let scratch = tempfile::tempdir().unwrap();
        for (wrong, program) in [("100%", "/a"), ("a\"b", "/a"), ("a\\b/new", "/a"), ("two\nlines", "/a"), ("out", "/a\nb")] {
            let out = scratch.path().join(wrong);
            let error = check(&out, Path::new(program)).unwrap_err().to_string();
            assert!(error.starts_with("--slurm \"") && error.contains("nothing was written") && !error.contains('\n'), "{error}");
            assert!(!out.exists());
        }
        check(&scratch.path().join("new/out"), Path::new("/a%b")).unwrap();
    }
}

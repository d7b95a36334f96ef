//! A study on a cluster with Slurm: a job array whose tasks take a share each, and a job after them
//! that makes the table.
//!
//! The scripts lie in the study's directory and can be read, changed and submitted by hand. A task
//! that is warned of its time limit checkpoints, ends with 75 and goes back into the queue by
//! itself; one that is cancelled stays so. `submit.sh` again computes what is left.

use std::fs;
use std::path::{Path, PathBuf};

use super::StudyError;
use super::directory::StudyDirectory;
use crate::output::write_own;

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
            let refuse = |what: String| StudyError::Slurm { argument: crate::case::short(argument).into_owned(), what };
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
                    return Err(refuse(format!("is unknown. Give tasks, at-once, warning or an option of sbatch: {known}")));
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

/// Writes the scripts for the study in `directory`, which is prepared. `program` is this program,
/// `options` are those of `asperity study` that the tasks are to have.
///
/// # Errors
/// [`StudyError::Slurm`] for a path that Slurm cannot take; [`StudyError::Output`],
/// [`StudyError::Directory`].
pub fn write(directory: &StudyDirectory, slurm: &Slurm, program: &Path, options: &[String]) -> Result<Scripts, StudyError> {
    let failed = |source| StudyError::Directory { dir: directory.root().to_owned(), what: "be read", source };
    let root = fs::canonicalize(directory.root()).map_err(failed)?;
    let [dir, program] = [root.as_path(), program].map(|path| path.to_str().unwrap_or("\n").to_owned());
    for path in [&dir, &program] {
        if path.chars().any(|c| c.is_control() || "\"\\%".contains(c)) {
            let what = "has characters that Slurm does not take in a path. Give another directory".to_owned();
            return Err(StudyError::Slurm { argument: format!("{path:?}"), what });
        }
    }
    let name = root.file_name().map_or("study".into(), |name| name.to_string_lossy());
    let name: String = name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '-' }).collect();
    let directives = |keys: &[&str]| -> String {
        let wanted = slurm.directives.iter().filter(|(key, _)| keys.contains(&key.as_str()));
        wanted.map(|(key, value)| format!("#SBATCH --{key}={value}\n")).collect()
    };
    let fill = |text: &str| {
        let at_once = slurm.at_once.map_or(String::new(), |count| format!("%{count}"));
        let text = text.replace("@NAME@", &name).replace("@TASKS@", &slurm.tasks.to_string()).replace("@AT_ONCE@", &at_once);
        let text = text.replace("@WARNING@", &slurm.warning.to_string());
        let text = text.replace("@ALL@\n", &directives(&DIRECTIVES)).replace("@FEW@\n", &directives(&FOR_THE_TABLE));
        let options: String = options.iter().map(|option| format!(" {}", quoted(option))).collect();
        text.replace("@OPTIONS@", &options)
            .replace("@LOGS@", &format!("{dir}/slurm"))
            .replace("@DIR@", &quoted(&dir))
            .replace("@PROGRAM@", &quoted(&program))
    };
    let folder = directory.root().join("slurm");
    for (file, text) in [("tasks.sh", TASKS), ("table.sh", TABLE), ("submit.sh", SUBMIT)] {
        write_own(&folder.join(file), |out| out.write_all(fill(text).as_bytes()))?;
    }
    Ok(Scripts { submit: folder.join("submit.sh") })
}

/// As one word of a shell.
fn quoted(text: &str) -> String {
    format!("'{}'", text.replace('\'', "'\\''"))
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
            ("time=", "no option of sbatch takes"),
            ("comment=a\nb", "no option of sbatch takes"),
        ] {
            let message = parsed(&[wrong]).unwrap_err();
            assert!(message.starts_with("--slurm ") && message.contains(part), "{message}");
        }
    }

    #[test]
    fn the_scripts_have_everything_filled_in_and_are_shell() {
        let scratch = tempfile::tempdir().unwrap();
        let root = scratch.path().join("it's a study");
        fs::create_dir(&root).unwrap();
        let slurm = parsed(&["tasks=3", "at-once=2", "partition=long", "time=10"]).unwrap();
        let scripts =
            write(&StudyDirectory::new(&root), &slurm, Path::new("/opt/a b/asperity"), &["--device".into(), "cpu".into()])
                .unwrap();
        let read = |name: &str| fs::read_to_string(scripts.submit.with_file_name(name)).unwrap();
        let tasks = read("tasks.sh");
        for part in [
            "--array=1-3%2\n",
            "--partition=long\n",
            "--time=10\n",
            "--signal=B:USR1@60\n",
            "'/opt/a b/asperity'",
            " '--device' 'cpu'",
            "'\\''s a study'",
        ] {
            assert!(tasks.contains(part), "{part}: {tasks}");
        }
        let table = read("table.sh");
        assert!(table.contains("--partition=long\n") && !table.contains("--time="), "{table}");
        for name in ["tasks.sh", "table.sh", "submit.sh"] {
            for hole in
                ["@NAME@", "@TASKS@", "@AT_ONCE@", "@WARNING@", "@ALL@", "@FEW@", "@OPTIONS@", "@LOGS@", "@DIR@", "@PROGRAM@"]
            {
                assert!(!read(name).contains(hole), "{hole} in {}", read(name));
            }
            let bash = std::process::Command::new("bash").arg("-n").arg(scripts.submit.with_file_name(name)).output();
            if let Ok(bash) = bash {
                assert!(bash.status.success(), "{name}: {}", String::from_utf8_lossy(&bash.stderr));
            }
        }
        let error = write(&StudyDirectory::new(&root), &slurm, Path::new("/opt/a%b/asperity"), &[]).unwrap_err();
        assert!(error.to_string().contains("characters that Slurm does not take"), "{error}");
    }
}

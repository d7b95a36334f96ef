//! `docs/commands.md`, made from the definition of the command line.

use std::fmt::Write as _;

use clap::{Arg, Command};

const HEAD: &str = "\
# Commands

<!-- Made from the command line: ASPERITY_BLESS=1 cargo test --test documents -->

`asperity COMMAND --help` prints the same on the terminal. In place of a case file, `-` is standard input. For
exit codes, see [Results](results.md#exit-codes).
";

const SHARED_HEAD: &str = "
## Shared options

Several commands have some or all of these options; each lists those that it has.

";

/// Those options, as `asperity run` has them.
const SHARED: [&str; 6] = ["set", "device", "precision", "threads", "quiet", "verbose"];

/// Prose is at most this wide.
const WIDTH: usize = 110;

pub fn text() -> String {
    let mut text = HEAD.to_owned();
    let mut program = asperity::internals::cli::command();
    program.build();
    let listed: Vec<(String, Command)> = commands(&program, "asperity");
    text += "\n| command | |\n|---|---|\n";
    for (name, command) in &listed {
        let about = command.get_about().map(ToString::to_string).unwrap_or_default();
        let _ = writeln!(text, "| [`{name}`](#{}) | {} |", name.replace(' ', "-"), about.replace('|', "\\|"));
    }
    let (_, run) = listed.iter().find(|(name, _)| name == "asperity run").expect("asperity run");
    let shared: Vec<String> = run.get_arguments().filter(|arg| SHARED.contains(&arg.get_id().as_str())).map(argument).collect();
    text += SHARED_HEAD;
    shared.iter().for_each(|option| text += &item(option));
    for (name, command) in listed {
        describe(&mut text, &name, command, &shared);
    }
    text
}

/// Every command that does something, with its full name.
fn commands(command: &Command, name: &str) -> Vec<(String, Command)> {
    let below = command.get_subcommands().filter(|below| below.get_name() != "help");
    let mut found = Vec::new();
    for command in below {
        let name = format!("{name} {}", command.get_name());
        if command.has_subcommands() {
            found.extend(commands(command, &name));
        } else {
            found.push((name, command.clone()));
        }
    }
    found
}

fn describe(text: &mut String, name: &str, mut command: Command, shared: &[String]) {
    let usage = command.render_usage().to_string();
    let about = command.get_long_about().or(command.get_about()).map(ToString::to_string).unwrap_or_default();
    // Writing to a String cannot fail.
    let _ = write!(text, "\n## {name}\n\n{}\n", wrapped(&sentence(&about), ""));
    let _ = write!(text, "```text\n{}\n```\n\n", usage.trim_start_matches("Usage: "));
    let shown = |arg: &&Arg| !arg.is_hide_set() && !["help", "version"].contains(&arg.get_id().as_str());
    let options = command.get_arguments().filter(|arg| !arg.is_positional());
    let mut named = Vec::new();
    for arg in command.get_positionals().chain(options).filter(shown) {
        let described = argument(arg);
        match arg.get_long() {
            Some(long) if shared.contains(&described) => named.push(format!("`--{long}`")),
            _ => *text += &item(&described),
        }
    }
    if !named.is_empty() {
        *text += &item(&format!("{}: [shared options](#shared-options).", named.join(", ")));
    }
}

fn item(text: &str) -> String {
    wrapped(&format!("- {text}"), "  ")
}

fn argument(arg: &Arg) -> String {
    let values: Vec<String> = arg.get_value_names().unwrap_or_default().iter().map(|name| format!("<{name}>")).collect();
    let takes = arg.get_action().takes_values();
    let mut name = match (arg.get_long(), arg.get_short()) {
        (Some(long), Some(short)) => format!("--{long}, -{short}"),
        (Some(long), None) => format!("--{long}"),
        _ => String::new(),
    };
    if takes {
        name = format!("{name} {}", values.join(" ")).trim().to_owned();
    }
    let help = arg.get_long_help().or(arg.get_help()).map(ToString::to_string).unwrap_or_default();
    let mut text = format!("`{name}`: {}", sentence(&help));
    let possible = arg.get_possible_values();
    let possible: Vec<String> = possible
        .iter()
        .filter(|_| takes)
        .map(|value| (format!("`{}`", value.get_name()), value.get_help()))
        .map(|(name, help)| match help {
            Some(help) => format!("{name} ({})", lower(&help.to_string())),
            None => name,
        })
        .collect();
    if !possible.is_empty() {
        let _ = write!(text, " One of {}.", possible.join(", "));
    }
    let defaults: Vec<String> = arg.get_default_values().iter().map(|value| format!("`{}`", value.to_string_lossy())).collect();
    if takes && !defaults.is_empty() {
        let _ = write!(text, " Default: {}.", defaults.join(", "));
    }
    text
}

/// Every sentence ends.
fn sentence(text: &str) -> String {
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    if text.ends_with(['.', ']', ':']) { text } else { text + "." }
}

fn lower(text: &str) -> String {
    let mut letters = text.chars();
    let abbreviation = text.starts_with("GPU") || text.starts_with("C9") || text.starts_with("C+");
    match letters.next() {
        Some(first) if !abbreviation => first.to_lowercase().chain(letters).collect(),
        _ => text.to_owned(),
    }
}

fn wrapped(text: &str, indent: &str) -> String {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        let line = lines.last_mut().expect("a line");
        if line.is_empty() {
            line.push_str(word);
        } else if line.len() + 1 + word.len() > WIDTH {
            lines.push(format!("{indent}{word}"));
        } else {
            line.push(' ');
            line.push_str(word);
        }
    }
    lines.join("\n") + "\n"
}

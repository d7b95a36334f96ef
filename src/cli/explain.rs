//! `asperity explain`: what a key of a case or study file means.

use std::fmt::Write as _;

use clap::Args;

use super::{CliError, Exit, print};
use crate::case::keys::{self, KEYS, Key, Presence, TABLES};

/// What `explain` says of the tables of a study file, which are not keys of a case.
const STUDY: [(&str, &str); 4] = [
    (
        "base",
        "The case from which every case of a study is made: the tables of a case file under base, as in [base.sphere] and \
         [[base.path]]. Keys that the grid gives may be left out. A study writes no fields and no plots unless its base asks for them.",
    ),
    (
        "grid",
        "Dotted keys of the case with lists of values, as in \"contact.friction\" = [0.1, 0.3, \"stick\"] or \"path.0.indentation\" = \
         [0.005, 0.02]. Every combination is a case, the last key fastest; a value may be a whole table. At most 100000 cases.",
    ),
    (
        "zip",
        "Dotted keys of the case with lists of one length, which are gone through together: the first value of each, the second of each, and so on. \
         Where there is a grid too, every one of its combinations meets each of them. [[zip]] may be there several times.",
    ),
    (
        "list",
        "Cases one by one: [[list]] and below it dotted keys of the case with a value each, as in \"contact.friction\" = 0.1. What a case does not say is \
         the base's. Where there is a grid or a zip too, every one of their combinations meets each case of the list.",
    ),
];

/// Explain a key of case and study files.
///
/// Says what it means, its unit, range and default.
#[derive(Clone, Debug, Args)]
pub struct ExplainArgs {
    /// A key such as contact.friction or friction, or a table such as mesh. Without one, all keys
    /// are listed.
    #[arg(value_name = "KEY")]
    pub key: Option<String>,
}

/// Prints what there is to say of the key.
pub fn explain(args: &ExplainArgs) -> Result<Exit, CliError> {
    let Some(name) = &args.key else {
        print(&list())?;
        return Ok(Exit::Done);
    };
    if let Some((name, text)) = STUDY.iter().find(|(table, _)| table == name) {
        print(&format!("[{name}] of a study file\n{}", indented(text)))?;
        return Ok(Exit::Done);
    }
    // A key of a study stands below base, or in quotes in the grid.
    let found = keys::find(name.strip_prefix("base.").unwrap_or(name));
    if found.is_empty() {
        return Err(CliError::UnknownKey { key: name.clone(), nearest: keys::nearest_key(name) });
    }
    let texts: Vec<String> = found.into_iter().map(said).collect();
    print(&texts.join("\n"))?;
    Ok(Exit::Done)
}

/// Every key in a line, table by table.
fn list() -> String {
    let mut text = String::new();
    for (table, about) in TABLES {
        let brackets = if table == "path" { format!("[[{table}]]") } else { format!("[{table}]") };
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{brackets}: {about}");
        let mut before = "";
        for key in KEYS.iter().filter(|key| key.table == table) {
            let laws = if key.laws.is_empty() { String::new() } else { format!(" ({})", key.laws.join(", ")) };
            let name = if key.name == before { "" } else { key.name };
            let _ = writeln!(text, "  {name:<28} {}{laws}", key.range);
            before = key.name;
        }
    }
    text.push_str("[base], [grid]: of a study file\n`asperity explain KEY` says more about one.\n");
    text
}

fn said(key: &Key) -> String {
    let mut text = format!("{}\n{}", key.dotted(), indented(key.meaning));
    let (presence, value) = match key.presence {
        Presence::Required => ("required", String::new()),
        Presence::Defaults(value) => ("default", value.to_owned()),
        Presence::Optional(words) => ("optional; without it", words.to_owned()),
    };
    let mut line = |name: &str, value: &str| {
        // Writing to a String cannot fail.
        let _ = match value {
            "" => writeln!(text, "  {name}"),
            value => writeln!(text, "  {name}: {value}"),
        };
    };
    if !key.laws.is_empty() {
        line("with the hardening law", &key.laws.join(", "));
    }
    if !key.unit.is_empty() {
        line("unit", key.unit);
    }
    line("range", key.range);
    line(presence, &value);
    line("example", &format!("{} = {}", key.name, key.example));
    text
}

/// Lines of at most 100 characters, indented by two.
fn indented(text: &str) -> String {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        if lines.last().is_some_and(|line| line.len() + word.len() > 96) {
            lines.push(String::new());
        }
        if let Some(line) = lines.last_mut() {
            let _ = write!(line, " {word}");
        }
    }
    lines.iter().map(|line| format!(" {line}\n")).collect()
}

//! A case file to start from: every key with what it means, made from the table of keys.

use super::keys::{KEYS, Key, Presence, TABLES};

/// Width of the comments.
const WIDTH: usize = 96;

/// A commented case with this hardening law; `file` is how its first lines call it, as a
/// shell reads it. Optional keys
/// are there as comments, with their defaults.
pub fn starter_case(law: &str, file: &str) -> String {
    let mut text = format!(
        "# A sphere is pressed onto a rigid plane and sheared along it.\n\
         #     asperity check {file}              the case as it would run, with its size\n\
         #     asperity run {file} --out out      runs it\n\
         #     asperity explain KEY               more about a key\n\
         # Any one consistent system of units: the radius sets that of length, Young's modulus that\n\
         # of stress; forces are stress times length squared. With millimetres and MPa, newtons.\n"
    );
    for (table, about) in TABLES {
        let keys: Vec<&Key> = KEYS.iter().filter(|key| key.table == table && key.fits(law)).collect();
        if table == "path" {
            path(&mut text, about, &keys);
            continue;
        }
        text.push_str(&format!("\n[{table}]  # {about}\n"));
        for key in keys {
            text.push_str(&comment(key));
            let value = if key.name == "law" { format!("{law:?}") } else { key.example.to_owned() };
            text.push_str(&match key.presence {
                Presence::Required => format!("{} = {value}\n", key.name),
                Presence::Defaults(value) => format!("# {} = {value}\n", key.name),
                Presence::Optional(_) => format!("# {} = {value}\n", key.name),
            });
        }
    }
    text
}

/// The same in twenty lines: the keys that a case must have, and an opponent to take.
pub fn short_case(law: &str, file: &str) -> String {
    let mut text = format!(
        "# `asperity run {file}` runs it, `asperity explain KEY` says what a key means.\n\
         # Any consistent units: with mm and MPa forces are in N.\n"
    );
    for (table, _) in TABLES.into_iter().filter(|(table, _)| *table != "path") {
        let required = KEYS.iter().filter(|key| key.table == table && key.fits(law) && key.presence == Presence::Required);
        let lines: Vec<String> = required
            .map(|key| match key.name {
                "law" => format!("law = {law:?}\n"),
                name => format!("{name} = {}\n", key.example),
            })
            .collect();
        if !lines.is_empty() {
            text.push_str(&format!("[{table}]\n{}", lines.concat()));
        }
    }
    text.push_str("# [opponent]\n# equal = true   # another such sphere; without it a rigid plane\n");
    text.push_str("[[path]]\nindentation = 0.02\n[[path]]\nshear = \"full-slip\"\n");
    text
}

/// A press and a shear.
fn path(text: &mut String, about: &str, keys: &[&Key]) {
    text.push_str(&format!("\n# [[path]]: {about}. The keys of a segment:\n"));
    for key in keys {
        text.push_str(&wrapped(&format!("{}: {}", key.name, said(key)), "#   "));
    }
    text.push_str("[[path]]\nindentation = 0.02\n\n[[path]]\nshear = \"full-slip\"\nhold = \"indentation\"\n");
}

/// What a key means, its unit and its range.
fn said(key: &Key) -> String {
    let unit = if key.unit.is_empty() { String::new() } else { format!("{}, ", key.unit) };
    let otherwise = match key.presence {
        Presence::Required | Presence::Defaults(_) => String::new(),
        Presence::Optional(words) => format!("; without it, {words}"),
    };
    format!("{} ({unit}{}){}", key.meaning, key.range, if key.table == "path" { "" } else { &otherwise })
}

fn comment(key: &Key) -> String {
    wrapped(&said(key), "# ")
}

/// The text in lines that begin with `start`.
fn wrapped(text: &str, start: &str) -> String {
    let mut lines = vec![start.to_owned()];
    for word in text.split_whitespace() {
        let fresh = lines.last().is_none_or(|line| line.len() == start.len());
        let full = lines.last().is_some_and(|line| line.len() + 1 + word.len() > WIDTH);
        if full && !fresh {
            lines.push(start.to_owned());
        }
        if let Some(line) = lines.last_mut() {
            if line.len() > start.len() {
                line.push(' ');
            }
            line.push_str(word);
        }
    }
    lines.iter().map(|line| format!("{}\n", line.trim_end())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::Case;
    use crate::case::keys::LAWS;

    #[test]
    fn a_starter_of_every_law_is_a_case_in_narrow_lines() {
        for law in LAWS {
            let text = starter_case(law, "case.toml");
            let case = Case::parse(&text, "case.toml", &[]).unwrap_or_else(|error| panic!("{law}: {error}\n{text}"));
            assert_eq!((case.path.len(), case.mesh), (2, Default::default()), "{law}");
            assert!(text.lines().all(|line| line.len() <= 100), "{text}");
            // What stands there as a comment is what would be right without it.
            let is_key = |line: &&str| line.split_once(" = ").is_some_and(|(name, _)| KEYS.iter().any(|key| key.name == name));
            // Of the opponents the rigid one is enough.
            let uncommented: Vec<&str> = text
                .lines()
                .filter(|line| {
                    let left_out = ["# equal = ", "# flat = ", "# material = ", "# plot_width = \"85mm\""];
                    !left_out.iter().any(|start| line.starts_with(start))
                })
                .map(|line| line.strip_prefix("# ").filter(is_key).unwrap_or(line))
                .collect();
            let uncommented = uncommented.join("\n");
            let with_all = Case::parse(&uncommented, "case.toml", &[]).unwrap_or_else(|error| panic!("{law}: {error}"));
            assert_eq!(with_all.output, case.output);
            assert_eq!(with_all.solver.tolerance, case.solver.tolerance);
        }
    }
}

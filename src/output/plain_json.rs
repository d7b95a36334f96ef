//! JSON files that somebody may have changed: what is wrong with one by its line and its key, in
//! the words of a file and not of a parser.

use std::fmt;

use serde::de::DeserializeOwned;
use serde_json::error::Category;

use crate::case::{nearest, short};

/// What is wrong with a text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Flaw {
    /// Line, counted from 1.
    pub line: usize,
    /// The key, such as `levels[2].F_N0`; empty for the file as a whole.
    pub key: String,
    /// What it is, in words.
    pub problem: String,
}

impl fmt::Display for Flaw {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.key.as_str() {
            "" => f.write_str(&self.problem),
            key => write!(f, "{} {}", short(key), self.problem),
        }
    }
}

/// Reads a value from the whole of a text.
///
/// # Errors
/// [`Flaw`]: it is no JSON, or another value than the one wanted.
pub fn from_str<T: DeserializeOwned>(text: &str) -> Result<T, Flaw> {
    let mut reader = serde_json::Deserializer::from_str(text);
    let value = serde_path_to_error::deserialize(&mut reader).map_err(|error| {
        let key = error.path().to_string();
        flaw(if key == "." { String::new() } else { key }, error.inner())
    })?;
    reader.end().map_err(|error| flaw(String::new(), &error))?;
    Ok(value)
}

fn flaw(key: String, error: &serde_json::Error) -> Flaw {
    let message = error.to_string();
    let message = message.rsplit_once(" at line ").map_or(message.as_str(), |(message, _)| message);
    let line = error.line().max(1);
    if error.classify() != Category::Data {
        let problem = if message == "number out of range" {
            "has a number that is too large".to_owned()
        } else if error.classify() == Category::Eof {
            "ends too soon, and is not the whole of a JSON file".to_owned()
        } else {
            format!("is not JSON: {message} in column {}", error.column())
        };
        return Flaw { line, key: String::new(), problem };
    }
    let (within, problem) = plainly(message);
    Flaw { line, key: within.map_or(key.clone(), |name| below(&key, name)), problem }
}

/// A key below another; the path of an unknown key has its name already.
fn below(key: &str, name: &str) -> String {
    if key.is_empty() || key == name {
        name.to_owned()
    } else if key.rsplit('.').next() == Some(name) {
        key.to_owned()
    } else {
        format!("{key}.{name}")
    }
}

/// A message of serde in plain words, and the key below the present one that it is about.
fn plainly(message: &str) -> (Option<&str>, String) {
    let quoted = |start: &str| message.strip_prefix(start).and_then(|rest| rest.split('`').nth(1));
    if let Some(name) = quoted("missing field") {
        return (Some(name), "is missing".to_owned());
    }
    if let Some(name) = quoted("unknown field") {
        return (Some(name), "is no key of this file".to_owned());
    }
    if let Some(name) = quoted("duplicate field") {
        return (Some(name), "is there twice".to_owned());
    }
    if let (Some(name), Some((_, allowed))) = (quoted("unknown variant"), message.split_once(", expected ")) {
        let allowed = allowed.trim_start_matches("one of ").replace('`', "\"");
        let words: Vec<&str> = allowed.split('"').skip(1).step_by(2).collect();
        let meant = nearest(name, &words).map_or(String::new(), |word| format!(" (did you mean {word:?}?)"));
        return (None, format!("is {:?}{meant}, and has to be {}", short(name), last_with_or(&allowed)));
    }
    let wrong = ["invalid type: ", "invalid value: "].iter().find_map(|start| message.strip_prefix(start));
    if let Some((found, wanted)) = wrong.and_then(|rest| rest.rsplit_once(", expected ")) {
        return (None, format!("is {}, and has to be {}", short(&found_of(found)), wanted_of(wanted)));
    }
    if let Some((count, wanted)) = message.strip_prefix("invalid length ").and_then(|rest| rest.split_once(", expected ")) {
        return (None, format!("has {count} values, and has to be {}", wanted_of(wanted)));
    }
    (None, format!("cannot be read: {}", short(message)))
}

/// `"a", "b", "c"` with an `or` before the last.
fn last_with_or(list: &str) -> String {
    list.rsplit_once(", ").map_or(list.to_owned(), |(first, last)| format!("{first} or {last}"))
}

/// What stands there.
fn found_of(found: &str) -> String {
    let number = ["floating point `", "integer `", "boolean `"].iter().find_map(|start| found.strip_prefix(start));
    match (number, found) {
        (Some(number), _) => number.trim_end_matches('`').to_owned(),
        (_, "sequence") => "a list".to_owned(),
        (_, "map") => "an object".to_owned(),
        _ => found.replacen("string ", "", 1),
    }
}

/// What should.
fn wanted_of(wanted: &str) -> String {
    let length = ["an array of length ", "a tuple of size "].iter().find_map(|start| wanted.strip_prefix(start));
    if let Some(count) = length {
        return format!("a list of {count} values");
    }
    match wanted {
        "f64" => "a number",
        "u8" | "u16" | "u32" | "u64" | "usize" => "a whole number, 0 or more",
        "a string" | "string or map" | "variant identifier" => "a text",
        "a boolean" => "true or false",
        "a sequence" => "a list",
        _ if wanted == "a map" || wanted.starts_with("struct ") => "an object",
        _ => wanted,
    }
    .to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::Deserialize;

    #[derive(Debug, Deserialize)]
    #[serde(rename_all = "kebab-case")]
    enum Kind {
        First,
        Second,
        Third,
    }

    #[derive(Debug, Deserialize)]
    #[serde(deny_unknown_fields)]
    #[allow(dead_code)]
    struct Inner {
        count: usize,
        pair: [f64; 2],
        kind: Kind,
    }

    #[derive(Debug, Deserialize)]
    #[serde(deny_unknown_fields)]
    #[allow(dead_code)]
    struct Outer {
        name: String,
        list: Vec<Inner>,
    }

    #[test]
    fn what_is_wrong_is_told_by_line_and_key() {
        let inner = r#"{"count": 1, "pair": [1, 2], "kind": "first"}"#;
        let good = format!("{{\n\"name\": \"n\",\n\"list\": [\n{inner},\n{inner}]}}");
        assert_eq!(from_str::<Outer>(&good).expect("it is right").list.len(), 2);
        let last = |from: &str, to: &str| {
            let at = good.rfind(from).expect(from);
            format!("{}{to}{}", &good[..at], &good[at + from.len()..])
        };
        for (text, line, told) in [
            (last("[1, 2]", "[1, \"x\"]"), 5, "list[1].pair[1] is \"x\", and has to be a number"),
            (last("[1, 2]", "[1]"), 5, "list[1].pair has 1 values, and has to be a list of 2 values"),
            (last("[1, 2]", "null"), 5, "list[1].pair is null, and has to be a list of 2 values"),
            (last("\"count\": 1", "\"count\": -1"), 5, "list[1].count is -1, and has to be a whole number, 0 or more"),
            (last("\"count\": 1", "\"count\": {}"), 5, "list[1].count is an object, and has to be a whole number, 0 or more"),
            (last("\"count\": 1, ", ""), 5, "list[1].count is missing"),
            (last("count", "cuont"), 5, "list[1].cuont is no key of this file"),
            (last("\"count\": 1", "\"count\": 1, \"count\": 2"), 5, "list[1].count is there twice"),
            (
                last("\"first\"", "\"fifth\""),
                5,
                "list[1].kind is \"fifth\" (did you mean \"first\"?), and has to be \"first\", \"second\" or \"third\"",
            ),
            (last("\"n\"", "true"), 2, "name is true, and has to be a text"),
            (last("[1, 2]", "[1, 1e999]"), 5, "has a number that is too large"),
            (last("]}", ""), 5, "ends too soon, and is not the whole of a JSON file"),
            (last("]}", "]} x"), 5, "is not JSON: trailing characters in column 49"),
            ("7".to_owned(), 1, "is 7, and has to be an object"),
            (String::new(), 1, "ends too soon, and is not the whole of a JSON file"),
        ] {
            let flaw = from_str::<Outer>(&text).expect_err(told);
            assert_eq!((flaw.to_string().as_str(), flaw.line), (told, line), "{text}");
        }
        let long = from_str::<Outer>(&last("\"n\"", &format!("[\"{}\"]", "x".repeat(5000)))).expect_err("a list");
        assert!(long.to_string().len() < 500, "{long}");
        let kinds: Vec<Kind> = from_str("[\"first\", \"second\", \"third\"]").expect("all of them");
        assert!(matches!(kinds[..], [Kind::First, Kind::Second, Kind::Third]));
    }
}

//! What was probably meant: by a word, by a key, by a number, by a line that is not TOML.

use super::keys::{KEYS, TABLES};
use super::likeness::{most_like, nearest};

/// What an unknown key of a table was meant to be: the dotted key if another table has one of this
/// name, else one of the `known` of its own that resembles it, else one of another table that does.
/// `table` is dotted, empty for the top level; what is dotted begins with `root`, empty or `base.`.
pub(super) fn key_meant(name: &str, table: &str, known: &[&str], root: &str) -> Option<String> {
    let whole = |dotted: &str| {
        // The opponent's material has the keys of the body's.
        let opponent = table.starts_with("opponent.material") && dotted.starts_with("material.");
        format!("{root}{}{dotted}", if opponent { "opponent." } else { "" })
    };
    // Here is not elsewhere; below `root` everything is.
    let own = if table.is_empty() { String::new() } else { format!("{table}.") };
    let elsewhere = || all_keys().filter(|(last, dotted)| !root.is_empty() || *dotted != format!("{own}{last}"));
    let same = elsewhere().find(|(last, _)| *last == name).map(|(_, dotted)| whole(&dotted));
    same.or_else(|| nearest(name, known)).or_else(|| {
        let (last, likeness) = most_like(name, elsewhere().map(|(last, _)| last))?;
        let (_, dotted) = elsewhere().find(|(other, _)| *other == last && likeness > 0.85)?;
        Some(whole(&dotted))
    })
}

/// Every key and every table by its last part, and dotted as `--set` takes it. A path presses first
/// and then goes on.
fn all_keys() -> impl Iterator<Item = (&'static str, String)> {
    let dotted = |table: &str, name: &str| match (table, name) {
        ("path", "indentation") => "path.0.indentation".to_owned(),
        ("path", _) => format!("path.1.{name}"),
        _ => format!("{table}.{name}"),
    };
    let keys = KEYS.iter().map(move |key| (key.name, dotted(key.table, key.name)));
    let tables = TABLES.iter().map(|(table, _)| (table.rsplit('.').next().unwrap_or(table), (*table).to_owned()));
    tables.chain(keys)
}

/// What a text was meant to be where a number is wanted, as a sentence; `quoted` says that it stood
/// in quotes.
pub(super) fn number_meant(text: &str, quoted: bool) -> Option<String> {
    if let Some(meant) = comma(text) {
        return Some(meant);
    }
    let number = text.trim().parse::<f64>().ok().filter(|number| number.is_finite())?;
    Some(format!("did you mean {number:?}{}?", if quoted { ", without quotes" } else { "" }))
}

/// For a number with a comma, what it was meant to be.
fn comma(text: &str) -> Option<String> {
    let text = text.trim();
    let (sign, digits) = text.strip_prefix(['-', '+']).map_or(("", text), |rest| (&text[..1], rest));
    let (mantissa, power) = digits.find(['e', 'E']).map_or((digits, ""), |at| digits.split_at(at));
    let parts: Vec<&str> = mantissa.split([',', '.']).collect();
    let all_digits = parts.iter().all(|part| !part.is_empty() && part.bytes().all(|byte| byte.is_ascii_digit()));
    if !mantissa.contains(',') || !all_digits || format!("1{power}").parse::<f64>().is_err() {
        return None;
    }
    let made = |whole: &str, share: &str| format!("{sign}{whole}{}{share}{power}", if share.is_empty() { "" } else { "." });
    let last = mantissa.rfind([',', '.'])?;
    let (whole, share) = (parts[..parts.len() - 1].concat(), parts[parts.len() - 1]);
    let separators = [mantissa.matches(',').count(), mantissa.matches('.').count()];
    let meant = match separators {
        [_, 0] if parts.len() > 2 && parts[1..].iter().all(|part| part.len() == 3) => made(&parts.concat(), ""),
        [1, 0] if share.len() == 3 && !whole.starts_with('0') => {
            format!("{} or {}", made(&whole, share), made(&parts.concat(), ""))
        }
        _ if mantissa[..last].contains(&mantissa[last..=last]) => return None,
        _ => made(&whole, share),
    };
    Some(format!("did you mean {meant}? A number has a decimal point, no comma"))
}

/// What is wrong with the line at `offset`, which is not TOML, if it is something that people from
/// elsewhere write.
pub(super) fn line_meant(text: &str, offset: usize) -> Option<String> {
    let at = (0..=offset.min(text.len())).rev().find(|&at| text.is_char_boundary(at)).unwrap_or(0);
    // A line may be found wrong at its end, which is the beginning of the next.
    let before = text[..at].strip_suffix('\n').filter(|_| !text[at..].lines().next().is_some_and(|line| line.contains('=')));
    let start = before.unwrap_or(&text[..at]).rfind('\n').map_or(0, |end| end + 1);
    let line = text[start..].lines().next().unwrap_or_default();
    let values = line.split('#').next().unwrap_or_default().split('=').skip(1);
    let number = |value: &str| {
        let value = value.trim_start();
        let end = value.find(|c: char| !c.is_ascii_digit() && !"+-.,eE_".contains(c)).unwrap_or(value.len());
        let token = value[..end].trim_end_matches(',');
        comma(token).or_else(|| {
            let bare = token.trim_start_matches(['+', '-']);
            let one_sided = bare.len() > 1 && (bare.starts_with('.') || bare.ends_with('.') || bare.contains(".e"));
            let number = token.parse::<f64>().ok().filter(|number| one_sided && number.is_finite())?;
            Some(format!("did you mean {number:?}? A number has digits on both sides of its point"))
        })
    };
    values.map(number).find(Option::is_some).flatten().or_else(|| {
        let (found, what) = line.chars().find_map(|c| match c {
            '\u{201c}'..='\u{201f}' | '\u{ab}' | '\u{bb}' => Some((c, "a quote is \"")),
            '\u{2018}'..='\u{201b}' => Some((c, "a quote is ' or \"")),
            '\u{2010}'..='\u{2015}' | '\u{2212}' => Some((c, "a minus is -")),
            '\u{a0}' | '\u{2000}'..='\u{200b}' | '\u{202f}' | '\u{3000}' => Some((c, "a blank is the common one")),
            _ => None,
        })?;
        let shown =
            if found.is_whitespace() || found == '\u{200b}' { found.escape_unicode().to_string() } else { found.to_string() };
        Some(format!("the line has {shown}, where {what}"))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_comma_is_a_point_or_parts_thousands() {
        for (written, meant) in [
            ("0,3", "0.3"),
            ("-0,002", "-0.002"),
            ("200,5e3", "200.5e3"),
            ("0,125", "0.125"),
            ("200,000", "200.000 or 200000"),
            ("1,234,567", "1234567"),
            ("200,000.5", "200000.5"),
            ("200.000,5", "200000.5"),
        ] {
            assert_eq!(
                comma(written),
                Some(format!("did you mean {meant}? A number has a decimal point, no comma")),
                "{written}"
            );
        }
        for other in ["0.3", "0,", ",3", "a,b", "1,2x", "", ",", "1,e", "stick", "1.2,3.4,5", "1,2,3"] {
            assert_eq!(comma(other), None, "{other}");
        }
        assert_eq!(number_meant("200e3", true).as_deref(), Some("did you mean 200000.0, without quotes?"));
        assert_eq!(number_meant(".5", false).as_deref(), Some("did you mean 0.5?"));
        assert_eq!(number_meant("half", true), None);
    }

    #[test]
    fn a_line_is_looked_at_where_it_is_wrong() {
        let text = "a = 1,5 # b\nc = { d = 1, e = 2 }\nf = .5\ng = 5.\nh = \u{201c}stick\u{201d}\n";
        let found = |part: &str| line_meant(text, text.find(part).expect("there"));
        assert!(found("1,5").expect("a hint").contains("1.5"));
        assert!(found(" # b").expect("a hint").contains("1.5"));
        assert_eq!(found("d = "), None);
        assert!(found(".5\n").expect("a hint").contains("0.5"));
        assert!(found("5.\n").expect("a hint").contains("5.0"));
        assert!(found("h = ").expect("a hint").contains("a quote is \""));
        assert_eq!(line_meant("", 0), None);
        assert_eq!(line_meant("a", 9), None);
    }

    #[test]
    fn keys_are_found_in_other_tables() {
        let meant = |name: &str, table: &str, known: &[&str]| key_meant(name, table, known, "");
        let root = ["sphere", "material", "contact", "opponent", "mesh", "solver", "output", "units", "path"];
        for (name, dotted) in [
            ("friction", "contact.friction"),
            ("frictoin", "contact.friction"),
            ("shear", "path.1.shear"),
            ("indentation", "path.0.indentation"),
            ("yield_stress", "material.hardening.yield_stress"),
            ("hardening", "material.hardening"),
            ("radius", "sphere.radius"),
            ("press_steps", "solver.press_steps"),
            ("contacts", "contact"),
        ] {
            assert_eq!(meant(name, "", &root).as_deref(), Some(dotted), "{name}");
        }
        assert_eq!(meant("yield_stress", "material", &["hardening"]).as_deref(), Some("material.hardening.yield_stress"));
        let there = meant("yield_stress", "opponent.material", &["hardening"]);
        assert_eq!(there.as_deref(), Some("opponent.material.hardening.yield_stress"));
        assert_eq!(meant("modulus", "material.hardening", &["law", "yield_stress"]), None);
        assert_eq!(meant("yield_stres", "material.hardening", &["law", "yield_stress"]).as_deref(), Some("yield_stress"));
        assert_eq!(meant("xyzzy", "", &root), None);
        assert_eq!(key_meant("sphere", "", &["base", "grid"], "base.").as_deref(), Some("base.sphere"));
        assert_eq!(key_meant("grids", "", &["base", "grid"], "base.").as_deref(), Some("grid"));
    }
}

//! Pieces of the report: escaped text, tables, formulas. All of it is well-formed XML as well as
//! HTML.

/// Text as it may stand between tags and in attributes.
pub fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            // Not allowed in XML, and of no use in a report.
            c if c.is_control() && !matches!(c, '\n' | '\t') => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

/// A table; cells are HTML already.
#[derive(Clone, Debug, Default)]
pub struct HtmlTable {
    head: String,
    rows: String,
    text_columns: Vec<usize>,
}

impl HtmlTable {
    /// With this header; `text_columns` are those that are set to the left.
    pub fn new<S: AsRef<str>>(header: &[S], text_columns: &[usize]) -> Self {
        let mut table = Self { text_columns: text_columns.to_vec(), ..Self::default() };
        let cells: Vec<String> = header.iter().enumerate().map(|(i, cell)| table.cell("th", i, cell.as_ref())).collect();
        table.head = format!("<tr>{}</tr>\n", cells.concat());
        table
    }

    fn cell(&self, tag: &str, column: usize, content: &str) -> String {
        let class = if self.text_columns.contains(&column) { " class=\"text\"" } else { "" };
        format!("<{tag}{class}>{content}</{tag}>")
    }

    /// Adds a row of the given class, which may be empty.
    pub fn row<S: AsRef<str>>(&mut self, class: &str, cells: &[S]) {
        let cells: Vec<String> = cells.iter().enumerate().map(|(i, cell)| self.cell("td", i, cell.as_ref())).collect();
        let class = if class.is_empty() { String::new() } else { format!(" class=\"{class}\"") };
        self.rows.push_str(&format!("<tr{class}>{}</tr>\n", cells.concat()));
    }

    /// The whole of it.
    pub fn html(&self) -> String {
        format!("<div class=\"wide\"><table>\n<thead>{}</thead>\n<tbody>\n{}</tbody></table></div>\n", self.head, self.rows)
    }
}

/// A number with four significant digits; nothing for none.
pub fn number(value: Option<f64>) -> String {
    let Some(value) = value.filter(|value| value.is_finite()) else { return String::new() };
    let size = value.abs();
    if size == 0.0 {
        return "0".to_owned();
    }
    if !(1e-3..1e6).contains(&size) {
        let text = format!("{value:.3e}");
        let (digits, exponent) = text.split_once('e').unwrap_or((&text, "0"));
        return format!("{digits}·10<sup>{}</sup>", exponent.replace('-', "−"));
    }
    let decimals = (3 - size.log10().floor() as i32).clamp(0, 7) as usize;
    format!("{value:.decimals$}")
}

/// A share in per cent with two decimals.
pub fn percent(share: f64) -> String {
    format!("{:.2}", 100.0 * share)
}

/// A formula or a name of the law in plain letters, as `law fit` prints it, with Greek letters,
/// subscripts and exponents.
pub fn formula(plain: &str) -> String {
    let letters: Vec<char> = plain.chars().collect();
    let mut out = String::new();
    let mut i = 0;
    while i < letters.len() {
        let c = letters[i];
        if c.is_alphanumeric() {
            let end = end_of(&letters, i, |c| c.is_alphanumeric());
            let word: String = letters[i..end].iter().collect();
            out.push_str(&symbol(&word));
            i = end;
            let mut subscripts = Vec::new();
            while i + 1 < letters.len() && letters[i] == '_' && letters[i + 1].is_alphanumeric() {
                let end = end_of(&letters, i + 1, |c| c.is_alphanumeric());
                subscripts.push(letters[i + 1..end].iter().collect::<String>());
                i = end;
            }
            if !subscripts.is_empty() {
                out.push_str(&format!("<sub>{}</sub>", subscripts.join(",")));
            }
        } else if c == '^' {
            let (start, end, next) = exponent(&letters, i + 1);
            let inner: String = letters[start..end].iter().collect();
            out.push_str(&format!("<sup>{}</sup>", formula(&inner)));
            i = next;
        } else {
            match c {
                // A hyphen stands between letters.
                '-' if i == 0 || !letters[i - 1].is_alphabetic() || !letters.get(i + 1).is_some_and(|c| c.is_alphabetic()) => {
                    out.push('−')
                }
                c => out.push_str(&escape(&c.to_string())),
            }
            i += 1;
        }
    }
    out
}

/// A value of a grid as the table has it, escaped: of an inline table, as hardening laws are, the
/// law's name and then its numbers.
pub fn grid_value(cell: &str) -> String {
    let Some(inner) = cell.trim().strip_prefix('{').and_then(|cell| cell.strip_suffix('}')) else { return escape(cell) };
    let (law, numbers): (Vec<&str>, Vec<&str>) = inner.split(',').map(str::trim).partition(|part| part.starts_with("law"));
    let name = law.iter().map(|law| law.trim_start_matches("law").trim_matches([' ', '=', '"']));
    escape(&name.chain(numbers).collect::<Vec<_>>().join(", "))
}

fn end_of(letters: &[char], start: usize, inside: impl Fn(char) -> bool) -> usize {
    (start..letters.len()).find(|&i| !inside(letters[i])).unwrap_or(letters.len())
}

/// Start, end and what follows of the exponent at `at`: what is in brackets, or a word or a number.
fn exponent(letters: &[char], at: usize) -> (usize, usize, usize) {
    if letters.get(at) == Some(&'(') {
        let mut depth = 0;
        for i in at..letters.len() {
            match letters[i] {
                '(' => depth += 1,
                ')' => depth -= 1,
                _ => {}
            }
            if depth == 0 {
                return (at + 1, i, i + 1);
            }
        }
    }
    // The point of a number, not that of a sentence.
    let mut end = end_of(letters, at, |c| c.is_alphanumeric() || c == '.');
    if end > at && letters[end - 1] == '.' {
        end -= 1;
    }
    (at, end, end)
}

fn symbol(word: &str) -> String {
    match word {
        "Lambda" => "Λ",
        "mu" => "μ",
        "nu" => "ν",
        "pi" => "π",
        "sigma" => "σ",
        "delta" => "δ",
        "eps" => "ε",
        "Hbar" => "<span class=\"bar\">H</span>",
        "a0" => "a<sub>0</sub>",
        "c2" => "c<sup>2</sup>",
        word => word,
    }
    .to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formulas_get_their_letters() {
        assert_eq!(formula("delta_T_slip"), "δ<sub>T,slip</sub>");
        assert_eq!(formula("1 - tanh(0.5 mu) z^1.25, x"), "1 − tanh(0.5 μ) z<sup>1.25</sup>, x");
        assert_eq!(
            formula("[1 + X^2]^(-1/0.5) < a_H^2."),
            "[1 + X<sup>2</sup>]<sup>−1/0.5</sup> &lt; a<sub>H</sub><sup>2</sup>."
        );
        assert_eq!(formula("a0^2"), "a<sub>0</sub><sup>2</sup>");
        assert_eq!(formula("(R h)^(1/2)"), "(R h)<sup>1/2</sup>");
        assert_eq!(formula("Hbar(Lambda/Lambda_Y)"), "<span class=\"bar\">H</span>(Λ/Λ<sub>Y</sub>)");
        assert_eq!(formula("Jaeger-Ciavarella, [1-(1-x)^M]"), "Jaeger-Ciavarella, [1−(1−x)<sup>M</sup>]");
        assert_eq!(formula("a^(b"), "a<sup></sup>(b");
    }

    #[test]
    fn hardening_laws_are_named_first() {
        let cell = "{ coefficient = 8325.53, exponent = 2.5, law = \"hollomon\" }";
        assert_eq!(grid_value(cell), "hollomon, coefficient = 8325.53, exponent = 2.5");
        assert_eq!([grid_value("0.05"), grid_value("\"stick\"")], ["0.05", "&quot;stick&quot;"]);
    }

    #[test]
    fn numbers_have_four_digits() {
        let shown = [0.0, 1.0, -12.3456, 0.012_345_6, 123_456.0, 1.5e-7].map(|x| number(Some(x)));
        assert_eq!(shown, ["0", "1.000", "-12.35", "0.01235", "123456", "1.500·10<sup>−7</sup>"]);
        assert_eq!(number(None) + &number(Some(f64::NAN)), "");
        assert_eq!(escape("a<b & \"c\"\u{1b}"), "a&lt;b &amp; &quot;c&quot; ");
    }
}

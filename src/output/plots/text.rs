//! Text of pictures: its width, its subscripts and superscripts.

use std::fmt::Write as _;

/// Height of a line over the size of its letters.
pub const LINE_HEIGHT: f64 = 1.24;
/// Size of what is off the line over that of the line.
const SMALL: f64 = 0.75;
/// Puts a bar over the letter before it.
const MACRON: char = '\u{304}';

/// Advance widths of the letters from space to tilde in DejaVu Sans, in thousandths of the size: a
/// wide font, so that what fits in it fits in most.
const WIDTHS: [u16; 95] = [
    318, 401, 460, 838, 636, 950, 780, 275, 390, 390, 500, 838, 318, 361, 318, 337, 636, 636, 636, 636, 636, 636, 636, 636, 636,
    636, 337, 337, 838, 838, 838, 531, 1000, 684, 686, 698, 770, 632, 575, 775, 752, 295, 295, 656, 557, 863, 748, 787, 603, 787,
    695, 635, 611, 732, 684, 989, 685, 611, 685, 390, 337, 390, 838, 500, 500, 613, 635, 550, 635, 615, 352, 635, 634, 278, 278,
    579, 278, 974, 634, 612, 635, 635, 411, 521, 392, 634, 592, 818, 592, 592, 525, 636, 337, 636, 838,
];
/// The same for every other letter.
const OTHER: u16 = 640;

/// Width in pixels of a text whose lines are `height` high.
pub fn text_width(text: &str, height: f64) -> f64 {
    let size = height / LINE_HEIGHT;
    let (mut width, mut scale) = (0.0, 1.0);
    let (mut braced, mut as_it_stands) = (false, false);
    for letter in text.chars() {
        match letter {
            letter if VERBATIM.contains(&letter) => (as_it_stands, scale, braced) = (letter == VERBATIM[0], 1.0, false),
            '_' | '^' if !as_it_stands => scale = SMALL,
            '{' if scale < 1.0 => braced = true,
            '}' if braced => (braced, scale) = (false, 1.0),
            MACRON => {}
            letter => {
                if !braced && !letter.is_alphanumeric() {
                    scale = 1.0;
                }
                let place = (letter as usize).checked_sub(' ' as usize);
                let thousandths = place.and_then(|place| WIDTHS.get(place)).copied().unwrap_or(OTHER);
                width += scale * f64::from(thousandths) / 1000.0;
            }
        }
    }
    width * size
}

/// A text in lines that are no wider than `width` pixels, broken between words.
pub fn wrapped(text: &str, height: f64, width: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if text_width(&format!("{line} {word}"), height) <= width => {
                // Writing to a String cannot fail.
                let _ = write!(line, " {word}");
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// Turns `_x` and `_{xyz}` of a text into subscripts of an SVG, `^x` and `^{xyz}` into
/// superscripts: what follows a `_` is lowered and what follows a `^` is raised, up to the end of
/// the word or of the braces. A letter before a combining macron (U+0304) gets a bar, drawn, as few
/// fonts place theirs well. `size` is that of the letters, in pixels: sizes in per cent or in ems
/// are not read alike everywhere. Symbols are slanted.
pub fn subscripts(text: &str, size: f64) -> String {
    let mut out = String::new();
    for (i, part) in text.split(VERBATIM).enumerate() {
        out += &if i % 2 == 0 { set(part, size) } else { part.to_owned() };
    }
    out
}

/// A part of a text in which `_` and `^` have their meaning.
fn set(text: &str, size: f64) -> String {
    let mut out = String::new();
    let marked = symbols_marked(text);
    let mut rest = marked.as_str();
    let mut height = 0.0;
    while !rest.is_empty() {
        let (plain, after) = rest.split_at(rest.find(['_', '^']).unwrap_or(rest.len()));
        if height != 0.0 && !plain.is_empty() {
            // Back to the line; without the attribute some readers drop a space at the start of a
            // span.
            out.push_str(&format!("<tspan dy=\"{}\" xml:space=\"preserve\">{plain}</tspan>", number(-height * size)));
            height = 0.0;
        } else {
            out.push_str(plain);
        }
        let target = match after.chars().next() {
            Some('_') => 0.25,
            Some(_) => -0.375,
            None => break,
        };
        let after = &after[1..];
        let (inner, after) = match after.strip_prefix('{').and_then(|after| after.split_once('}')) {
            Some(pair) => pair,
            None => after.split_at(after.find(|c: char| !c.is_alphanumeric()).unwrap_or(after.len())),
        };
        if !inner.is_empty() {
            let (shift, small) = (number((target - height) * size), number(SMALL * size));
            // An exponent may be a symbol; what is lowered is a label.
            let symbol = target < 0.0 && inner.len() == 1 && inner.chars().all(char::is_alphabetic);
            let inner = if symbol { format!("{}{inner}{}", SLANTED[0], SLANTED[1]) } else { inner.to_owned() };
            out.push_str(&format!("<tspan dy=\"{shift}\" font-size=\"{small}\">{inner}</tspan>"));
            height = target;
        }
        rest = after;
    }
    barred(&out).replace(SLANTED[0], "<tspan font-style=\"italic\">").replace(SLANTED[1], "</tspan>")
}

/// Opens and closes what is slanted, until the text is an SVG: letters for private use.
const SLANTED: [char; 2] = ['\u{e000}', '\u{e001}'];

/// Opens and closes what is meant as it stands, as a name of the user's is.
const VERBATIM: [char; 2] = ['\u{e002}', '\u{e003}'];

/// A name that is shown letter by letter, without subscripts and symbols.
pub fn verbatim(name: &str) -> String {
    format!("{}{name}{}", VERBATIM[0], VERBATIM[1])
}

/// Marks the symbols of quantities: Greek letters, and single Latin ones. A unit (`in N`, `(N)`),
/// the article and what is lowered or raised are upright (ISO 80000-1, 7.1 and 7.2).
fn symbols_marked(text: &str) -> String {
    const RAISED: &str = "⁰¹²³⁴⁵⁶⁷⁸⁹⁻";
    let is_greek = |letter: char| ('\u{391}'..='\u{3c9}').contains(&letter);
    // What makes a word of the letter beside it.
    let joins = |letter: char| letter.is_alphanumeric() && !is_greek(letter) && !RAISED.contains(letter);
    let letters: Vec<char> = text.chars().collect();
    let mut out = String::with_capacity(text.len());
    for (i, &letter) in letters.iter().enumerate() {
        let before = |count: usize| i.checked_sub(count).map(|at| letters[at]);
        let after = |count: usize| letters.get(i + count).copied();
        let greek = is_greek(letter);
        let alone = letter.is_ascii_alphabetic()
            && before(1).is_none_or(|c| !joins(c) && !"_^{,&'’.-".contains(c))
            && after(1).is_none_or(|c| !joins(c) && !"';.-".contains(c));
        // `in N`, and what stands in parentheses by itself: (N), (μm).
        let opens = (0..i).rev().find(|&at| "( )_^/".contains(letters[at]));
        let closes = (i + 1..letters.len()).find(|&at| "( )_^/".contains(letters[at]));
        let enclosed = opens.is_some_and(|at| letters[at] == '(') && closes.is_some_and(|at| letters[at] == ')');
        let unit = before(1) == Some(' ') && before(2) == Some('n') && before(3) == Some('i') || enclosed;
        let article = letter == 'a' && after(1) == Some(' ') && after(2).is_some_and(|c| c.is_lowercase());
        if !unit && (greek || alone && !article) {
            // A bar belongs to its letter.
            let bar = after(1).filter(|next| *next == MACRON);
            out.extend([SLANTED[0], letter].into_iter().chain(bar).chain([SLANTED[1]]));
        } else if letter != MACRON || !out.ends_with(SLANTED[1]) {
            out.push(letter);
        }
    }
    out
}

/// A letter and its macron as a letter under a line.
fn barred(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for letter in text.chars() {
        if letter != MACRON {
            out.push(letter);
        } else if let Some(below) = out.pop() {
            out.push_str(&format!("<tspan text-decoration=\"overline\">{below}</tspan>"));
        }
    }
    out
}

/// A number with two decimals at most.
pub fn number(x: f64) -> String {
    let text = format!("{x:.2}");
    let short = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if short == "-0" { "0".to_owned() } else { short.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn subscripts_are_lowered_and_the_line_goes_on() {
        let low = |text: &str| format!("<tspan dy=\"3\" font-size=\"9\">{text}</tspan>");
        let back = |text: &str| format!("<tspan dy=\"-3\" xml:space=\"preserve\">{text}</tspan>");
        let symbol = |letter: &str| format!("<tspan font-style=\"italic\">{letter}</tspan>");
        let subscripts = |text: &str| subscripts(text, 12.0);
        assert_eq!(subscripts("plain &amp; simple"), "plain &amp; simple");
        assert_eq!(subscripts("F_N"), format!("{}{}", symbol("F"), low("N")));
        let delta = back(&format!("/{}", symbol("δ")));
        let x = back(&format!(" {}", symbol("x")));
        assert_eq!(subscripts("F_N/δ_{T,slip} x"), format!("{}{}{delta}{}{x}", symbol("F"), low("N"), low("T,slip")));
        let up = format!("<tspan dy=\"-4.5\" font-size=\"9\">{}</tspan>", symbol("n"));
        let power = format!("(1 − {}){up}<tspan dy=\"4.5\" xml:space=\"preserve\"> {}</tspan>", symbol("x"), symbol("b"));
        assert_eq!(subscripts("(1 − x)^n b"), power);
        assert_eq!(subscripts("a_"), symbol("a"));
        let mean = "<tspan font-style=\"italic\"><tspan text-decoration=\"overline\">H</tspan></tspan>";
        assert_eq!(subscripts("H\u{304} = F_N"), format!("{mean} = {}{}", symbol("F"), low("N")));
    }

    #[test]
    fn symbols_are_slanted_and_units_and_words_are_not() {
        let slanted = |text: &str| {
            let svg = subscripts(text, 12.0);
            let letters: Vec<String> =
                svg.split("italic\">").skip(1).map(|after| after.split('<').next().unwrap_or_default().to_owned()).collect();
            letters.concat()
        };
        for (text, expected) in [
            ("h / R", "hR"),
            ("F_N in N", "F"),
            ("force F (N)", "F"),
            ("δ_T (μm), p (MPa)", "δp"),
            ("δ_T in m", "δ"),
            ("a / R", "aR"),
            ("closed form of a contact", ""),
            ("Johnson's map", ""),
            ("E/σ_Y = 500, μ = 0.3", "Eσμ"),
            ("p &lt; 1e-5, 10^3 F / (E R^2)", "pFER"),
            ("F_N, main", "F"),
            ("1 − F_T/μF_N", "FμF"),
            ("c² = a² / (2 R h)", "caRh"),
            ("π a² σ_rep", "πaσ"),
            ("F_N, \u{e002}runs/h 0.3\u{e003}", "F"),
        ] {
            assert_eq!(slanted(text), expected, "{text}");
        }
    }

    #[test]
    fn widths_are_those_of_a_wide_font() {
        assert!((text_width("normal force", 12.4) - 63.8).abs() < 0.1, "{}", text_width("normal force", 12.4));
        // What is lowered is smaller, up to the end of the word.
        assert!(text_width("F_N", 13.0) < text_width("FN", 13.0) && text_width("F_N x", 13.0) > text_width("F_Nx", 13.0));
        assert_eq!(text_width("H\u{304}", 13.0), text_width("H", 13.0));
        assert_eq!(wrapped("one two three", 12.4, text_width("one two", 12.4)), ["one two", "three"]);
    }
}

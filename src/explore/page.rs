//! The page: its text, with the fields as an address has them.

use std::fmt::Write as _;

use quick_xml::escape::escape;

use super::export::OFFERS;
use super::form::{Form, OPPONENTS, OTHER, about, keys_of};
use super::results::StudyCases;
use crate::case::Case;
use crate::law::LawFile;
use crate::material::HardeningLaw;

/// The page before its fields are put in: `{{NAME}}` stands for one of them.
const PAGE: &str = include_str!("page.html");
/// Its style.
pub const STYLE: &str = include_str!("page.css");
/// Its script.
pub const SCRIPT: &str = include_str!("page.js");
/// Most cases of a study in the list.
const MOST_LISTED: usize = 1000;

/// Where a slider goes from and to.
#[derive(Clone, Copy)]
struct Slider {
    from: f64,
    to: f64,
    /// Even steps are even factors.
    logarithmic: bool,
    /// A field of which both ends are multiples.
    times: &'static str,
}

impl Slider {
    const fn even(from: f64, to: f64) -> Self {
        Self { from, to, logarithmic: false, times: "" }
    }

    const fn factors(from: f64, to: f64) -> Self {
        Self { from, to, logarithmic: true, times: "" }
    }

    const fn of(self, times: &'static str) -> Self {
        Self { times, ..self }
    }
}

/// A field with a slider.
struct SliderField<'a> {
    /// Its name in the query.
    name: &'a str,
    /// Its name among the elements of the page.
    id: String,
    label: &'a str,
    symbol: &'a str,
    unit: &'a str,
    value: &'a str,
    slider: Slider,
}

impl SliderField<'_> {
    fn html(&self) -> String {
        let Self { name, id, label, symbol, unit, value, slider: Slider { from, to, logarithmic, times } } = self;
        let (label, value, unit) = (escape(*label), escape(*value), escape(*unit));
        let symbol = if symbol.is_empty() { String::new() } else { format!(" <var>{symbol}</var>") };
        let scale = if *logarithmic { "log" } else { "even" };
        format!(
            "<div class=\"field\"><label for=\"{id}\">{label}{symbol} <span class=\"unit\">{unit}</span></label>\
             <input type=\"text\" inputmode=\"decimal\" autocomplete=\"off\" spellcheck=\"false\" id=\"{id}\" name=\"{name}\" \
             value=\"{value}\" aria-describedby=\"{id}-wrong\">\
             <input type=\"range\" min=\"0\" max=\"1000\" step=\"1\" aria-label=\"{label}, slider\" \
             data-for=\"{id}\" data-from=\"{from}\" data-to=\"{to}\" data-scale=\"{scale}\" data-times=\"{times}\">\
             <p class=\"wrong\" id=\"{id}-wrong\" hidden></p></div>\n"
        )
    }
}

/// The whole page.
pub fn html(form: &Form, base: &Case, study: &StudyCases, law: &LawFile) -> String {
    let unit = |label: &Option<String>| label.clone().unwrap_or_default();
    let (length, stress) = (unit(&base.units.length), unit(&base.units.stress));
    let field = |name: &str, label: &str, symbol: &str, unit: &str, slider: Slider| {
        SliderField { name, id: format!("f-{}", name.replace('.', "-")), label, symbol, unit, value: form.get(name), slider }
            .html()
    };
    let radius = base.sphere.radius;
    let law_is = match law {
        LawFile::Interpolated(_) => "a law by interpolation between simulated contacts",
        LawFile::Formulas(_) => "formulas that were fitted to a study",
        LawFile::Table(_) => "a table of one simulated contact",
    };
    let parts = [
        ("RADIUS", field("radius", "Radius", "R", &length, Slider::factors(0.1 * radius, 10.0 * radius))),
        ("MATERIAL", material(form, base, "", &stress)),
        ("OTHER", material(form, base, OTHER, &stress)),
        ("FRICTION", field("friction", "Friction coefficient", "μ", "", Slider::even(0.0, 1.0))),
        ("INDENTATION", field("indentation", "Indentation", "h", &length, Slider::factors(1e-4, 0.2).of("radius"))),
        ("OPPONENTS", options(&OPPONENTS, form.get("opponent"))),
        ("OPPONENT_RADIUS", field("opponent.radius", "Its radius", "R_2", &length, Slider::factors(0.1, 10.0).of("radius"))),
        ("SAME", options(&[("same", "the same material"), ("own", "another material")], form.get("opponent.material"))),
        ("PATHS", options(&paths(base), form.get("path"))),
        ("DISPLACEMENT", field("displacement", "Sheared to and fro by", "δ_T", &length, Slider::even(0.0, 0.1).of("radius"))),
        ("ELEMENTS", elements(form, base)),
        ("AXES", options(&[("case", "in the units of the case"), ("none", "without units: over R and E")], form.get("axes"))),
        ("OFFERS", offers()),
        ("STUDY", study_list(study)),
        ("STUDY_HIDDEN", if study.cases.is_empty() { "hidden" } else { "" }.to_owned()),
        ("LAW", law_is.to_owned()),
        ("VERSION", env!("CARGO_PKG_VERSION").to_owned()),
    ];
    // Of what came from the query nothing is looked through for names again.
    let mut text = String::with_capacity(PAGE.len() + 16 * 1024);
    let mut rest = PAGE;
    while let Some((before, after)) = rest.split_once("{{") {
        let (name, behind) = after.split_once("}}").unwrap_or((after, ""));
        text.push_str(before);
        text.push_str(parts.iter().find(|(part, _)| *part == name).map_or("", |(_, part)| part));
        rest = behind;
    }
    text + rest
}

fn options(all: &[(&str, &str)], chosen: &str) -> String {
    all.iter().fold(String::new(), |mut text, (word, words)| {
        let selected = if *word == chosen { " selected" } else { "" };
        // Writing to a String cannot fail.
        let _ = writeln!(text, "<option value=\"{word}\"{selected}>{}</option>", escape(*words));
        text
    })
}

fn paths(base: &Case) -> Vec<(&'static str, &'static str)> {
    let own = Form::of(base).keeps_path().then_some(("case", "the path of the case, as it is"));
    [("slip", "press, shear to full slip"), ("cycle", "press, shear to and fro, release")].into_iter().chain(own).collect()
}

fn elements(form: &Form, base: &Case) -> String {
    let own = base.mesh.elements_per_contact_radius;
    let mut all = vec![4, 6, 8, 10, 16];
    all.push(own);
    all.sort_unstable();
    all.dedup();
    let words = |count: usize| match count {
        count if count == own => format!("{count}, as the case has it"),
        4 => "4, for a first look".to_owned(),
        count => count.to_string(),
    };
    let named: Vec<(String, String)> = all.iter().map(|&count| (count.to_string(), words(count))).collect();
    let borrowed: Vec<(&str, &str)> = named.iter().map(|(count, words)| (count.as_str(), words.as_str())).collect();
    options(&borrowed, form.get("elements"))
}

fn offers() -> String {
    OFFERS.iter().fold(String::new(), |mut text, (name, about)| {
        let _ =
            writeln!(text, "<li><a data-export=\"{name}\" href=\"export/{name}\" download=\"{name}\">{name}</a>: {about}</li>");
        text
    })
}

fn study_list(study: &StudyCases) -> String {
    study.cases.iter().take(MOST_LISTED).fold(String::new(), |mut text, one| {
        let form = Form::of(&one.case);
        let (query, h) = (form.query(), form.get("indentation").to_owned());
        let about = format!("{}: {}, μ = {}, h = {h}", one.id, form.get("law"), form.get("friction"));
        let _ = writeln!(text, "<option value=\"{}\">{}</option>", escape(query.as_str()), escape(about.as_str()));
        text
    })
}

/// The fields of one of the two materials: those of every hardening law, of which the script shows
/// the chosen one's.
fn material(form: &Form, base: &Case, prefix: &'static str, stress: &str) -> String {
    let (which, modulus) = match prefix {
        "" => ("", "youngs_modulus"),
        _ => ("other-", "opponent.youngs_modulus"),
    };
    let value = |name: &str| form.get(&format!("{prefix}{name}")).to_owned();
    let e = base.material.youngs_modulus;
    let plain = |name: &str, label, symbol, unit, slider| {
        let (own, value) = (format!("{prefix}{name}"), value(name));
        SliderField { name: &own, id: format!("f-{which}{name}"), label, symbol, unit, value: &value, slider }.html()
    };
    let mut text = plain("youngs_modulus", "Young's modulus", "E", stress, Slider::factors(0.01 * e, 100.0 * e));
    text += &plain("poissons_ratio", "Poisson's ratio", "ν", "", Slider::even(0.0, 0.49));
    let laws: Vec<(&str, &str)> = HardeningLaw::ALL.map(|law| (law.word(), law.word())).into();
    let _ = write!(
        text,
        "<div class=\"field\"><label for=\"f-{which}law\">Hardening law</label><select id=\"f-{which}law\" name=\"{prefix}law\" \
         aria-describedby=\"f-{which}law-wrong\">{}</select><p class=\"wrong\" id=\"f-{which}law-wrong\" hidden></p></div>",
        options(&laws, &value("law"))
    );
    for law in HardeningLaw::ALL {
        let _ = writeln!(text, "<div class=\"law\" data-law=\"{}\" data-of=\"{prefix}law\">", law.word());
        for key in keys_of(law) {
            let (name, id) = (format!("{prefix}{key}"), format!("f-{which}{}-{key}", law.word()));
            let (value, label) = (value(&format!("{}.{key}", law.word())), capital(about(law, key).1));
            if key == "points" {
                let _ = write!(
                    text,
                    "<div class=\"field\"><label for=\"{id}\">Strain and stress, pairs with semicolons between</label>\
                     <input type=\"text\" class=\"wide\" id=\"{id}\" name=\"{name}\" value=\"{}\" autocomplete=\"off\" \
                     spellcheck=\"false\" aria-describedby=\"{id}-wrong\"><p class=\"wrong\" id=\"{id}-wrong\" hidden></p></div>",
                    escape(value.as_str())
                );
                continue;
            }
            let is_stress = law.parameters().iter().any(|parameter| parameter.key == key && parameter.is_stress);
            let unit = if is_stress { stress } else { "" };
            let slider = slider_of(law, key, modulus, is_stress);
            text += &SliderField { name: &name, id, label: &label, symbol: "", unit, value: &value, slider }.html();
        }
        text += "</div>\n";
    }
    text
}

/// How far a slider of a hardening law's number goes.
fn slider_of(law: HardeningLaw, key: &str, modulus: &'static str, is_stress: bool) -> Slider {
    match (law, key) {
        (_, "yield_stress") => Slider::factors(1e-4, 0.1).of(modulus),
        (_, "saturation_stress") => Slider::factors(1e-4, 0.2).of(modulus),
        (HardeningLaw::Power, "exponent") => Slider::even(0.05, 1.0),
        (HardeningLaw::Hollomon, "exponent") => Slider::factors(1.5, 20.0),
        _ if is_stress => Slider::factors(1e-4, 1.0).of(modulus),
        _ => Slider::factors(0.1, 1000.0),
    }
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::plots::canvas::Colour;
    use crate::output::plots::style;

    fn law() -> LawFile {
        LawFile::built_in().unwrap()
    }

    fn base() -> Case {
        Case::parse(super::super::FIRST_CASE, "first.toml", &[]).unwrap()
    }

    #[test]
    fn the_page_is_small_whole_and_asks_for_nothing_elsewhere() {
        let (base, law) = (base(), law());
        let page = html(&Form::of(&base), &base, &StudyCases::default(), &law);
        assert!(page.len() + STYLE.len() + SCRIPT.len() < 100_000);
        assert!(!page.contains("{{") && page.matches("name=\"yield_stress\"").count() == 4);
        for text in [page.as_str(), STYLE, SCRIPT] {
            let elsewhere = ["http:", "https:", "@import", "url(", "eval(", "innerHTML", "document.write"];
            assert!(
                elsewhere.iter().all(|word| !text.contains(word)),
                "{:?}",
                elsewhere.iter().find(|word| text.contains(**word))
            );
        }
        // The policy of the answers forbids what stands in the page itself.
        assert!(!page.contains("style=") && !page.contains(" onclick") && !page.contains("<style"));
    }

    #[test]
    fn what_a_query_says_is_text() {
        let (base, law) = (base(), law());
        let form = Form::with(&base, "radius=%22%3E%3Cscript%3Ealert(1)%3C/script%3E&friction=%7B%7BLAW%7D%7D").unwrap();
        let page = html(&form, &base, &StudyCases::default(), &law);
        assert!(!page.contains("<script>alert") && page.contains("&lt;script&gt;alert(1)"));
        assert!(page.contains("value=\"{{LAW}}\""));
    }

    /// On a dark screen the style turns each colour of the pictures into another.
    #[test]
    fn the_style_knows_the_colours_of_the_pictures() {
        let all: [Colour; 10] = [
            style::WHITE,
            style::INK,
            style::PALE,
            style::FAINT,
            style::BLUE,
            style::VERMILION,
            style::ORANGE,
            style::GREEN,
            style::PURPLE,
            style::GREY,
        ];
        for colour in all {
            assert!(STYLE.contains(&format!("\"{colour}\"")), "{colour}");
        }
    }

    #[test]
    fn fields_come_back_from_their_query() {
        let base = base();
        let form = Form::with(&base, "radius=2&law=voce&rate=7&opponent=equal").unwrap();
        let again = Form::with(&base, &form.query()).unwrap();
        assert_eq!(again.case(&base), form.case(&base));
        assert_eq!(again.get("radius"), "2");
    }
}

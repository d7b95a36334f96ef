//! The page's fields, which are its address' query: from there to a case, and from a case to the
//! fields that a page begins with.
//!
//! What the fields do not say (the mesh, the solver, names of units) is the case's with which the
//! page was opened. The rules are those of a case file, and so are the messages.

use std::collections::BTreeMap;

use super::request::LONGEST_QUERY;
use crate::case::keys::KEYS;
use crate::case::{Case, CaseError, Document, Friction, Hardening, Hold, Material, Opponent, Segment, ShearTarget, mistakes};
use crate::material::HardeningLaw;

/// Fields beside those of the two materials.
const PLAIN: [&str; 12] = [
    "radius",
    "friction",
    "indentation",
    "opponent",
    "opponent.radius",
    "opponent.material",
    "path",
    "displacement",
    "elements",
    "axes",
    // No field of the page, but how wide its pictures are, and which step of a simulation is asked
    // for.
    "width",
    "frame",
];
/// Fields of a material beside the numbers of its hardening law.
const MATERIAL: [&str; 3] = ["youngs_modulus", "poissons_ratio", "law"];
/// What goes before the fields of the material of the other body.
pub const OTHER: &str = "opponent.";
/// Most fields of a query; a page has at most 24.
const MOST_FIELDS: usize = 40;

/// What the sphere may be pressed against, by its word in the query.
pub const OPPONENTS: [(&str, &str); 5] = [
    ("plane", "a rigid plane"),
    ("equal", "an equal sphere"),
    ("rigid", "a rigid sphere"),
    ("sphere", "another sphere that deforms"),
    ("flat", "a flat that deforms"),
];

/// A field that cannot be taken.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mistake {
    /// Its name; empty where it is no single one.
    pub field: String,
    /// What is wrong, and what is allowed.
    pub what: String,
}

/// The fields with their values as they were typed. Numbers of hardening laws stand under the name
/// of their law, as `power.exponent`: what is typed for one law is not lost while another is looked
/// at.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Form {
    values: BTreeMap<String, String>,
}

/// The parts of a query, decoded.
///
/// # Errors
/// What is wrong with it: no page of this program has sent it.
pub fn parse(query: &str) -> Result<Vec<(String, String)>, String> {
    if query.len() > LONGEST_QUERY {
        return Err(format!("the query is longer than {} KiB", LONGEST_QUERY / 1024));
    }
    let mut fields: Vec<(String, String)> = Vec::new();
    for part in query.split('&').filter(|part| !part.is_empty()) {
        let (name, value) = part.split_once('=').unwrap_or((part, ""));
        let (name, value) = (decoded(name)?, decoded(value)?);
        if fields.len() == MOST_FIELDS || fields.iter().any(|(other, _)| *other == name) {
            return Err("the query has too many fields, or one of them twice".to_owned());
        }
        fields.push((name, value));
    }
    Ok(fields)
}

/// A word of a query without its percent signs.
fn decoded(word: &str) -> Result<String, String> {
    let wrong = || "the query is not encoded as a browser does it".to_owned();
    let mut bytes = Vec::with_capacity(word.len());
    let mut rest = word.bytes();
    while let Some(byte) = rest.next() {
        bytes.push(match byte {
            b'+' => b' ',
            b'%' => {
                let digit = |byte: Option<u8>| byte.and_then(|byte| char::from(byte).to_digit(16));
                let (high, low) = (digit(rest.next()).ok_or_else(wrong)?, digit(rest.next()).ok_or_else(wrong)?);
                u8::try_from(16 * high + low).map_err(|_| wrong())?
            }
            byte => byte,
        });
    }
    let text = String::from_utf8(bytes).map_err(|_| wrong())?;
    if text.chars().any(char::is_control) { Err(wrong()) } else { Ok(text) }
}

/// A value as it stands in a query.
fn encoded(value: &str) -> String {
    let plain = |byte: &u8| byte.is_ascii_alphanumeric() || b"-_.~".contains(byte);
    value.bytes().map(|byte| if plain(&byte) { char::from(byte).to_string() } else { format!("%{byte:02X}") }).collect()
}

/// A number as a field shows it.
pub fn shown(number: f64) -> String {
    if number != 0.0 && !(1e-6..1e15).contains(&number.abs()) { format!("{number:e}") } else { number.to_string() }
}

/// The keys of a hardening law's fields.
pub fn keys_of(law: HardeningLaw) -> Vec<&'static str> {
    if law == HardeningLaw::Table { vec!["points"] } else { law.parameters().iter().map(|parameter| parameter.key).collect() }
}

/// What the table of keys says of a number of a hardening law: its example and its meaning.
pub fn about(law: HardeningLaw, key: &str) -> (&'static str, &'static str) {
    let of = KEYS.iter().find(|one| one.table == "material.hardening" && one.name == key && one.fits(law.word()));
    of.map_or(("", ""), |key| (key.example, key.meaning))
}

/// Pairs as a field shows them.
fn points_shown(points: &[[f64; 2]]) -> String {
    points.iter().map(|[alpha, stress]| format!("{} {}", shown(*alpha), shown(*stress))).collect::<Vec<_>>().join("; ")
}

/// The example of the table of keys, its stresses in the unit of a material.
fn example(law: HardeningLaw, key: &str, stress: f64) -> String {
    let text = about(law, key).0;
    if law == HardeningLaw::Table {
        let numbers: Vec<f64> = text.split(['[', ']', ',', ' ']).filter_map(|word| word.parse().ok()).collect();
        let points: Vec<[f64; 2]> = numbers.chunks_exact(2).map(|pair| [pair[0], stress * pair[1]]).collect();
        return points_shown(&points);
    }
    let is_stress = law.parameters().iter().any(|parameter| parameter.key == key && parameter.is_stress);
    text.parse::<f64>().map_or_else(|_| text.to_owned(), |number| shown(if is_stress { stress * number } else { number }))
}

impl Form {
    /// The fields of a case.
    pub fn of(case: &Case) -> Self {
        let mut form = Self { values: BTreeMap::new() };
        let mut set = |name: &str, value: String| drop(form.values.insert(name.to_owned(), value));
        set("radius", shown(case.sphere.radius));
        set(
            "friction",
            match case.contact.friction {
                Friction::Coefficient(mu) => shown(mu),
                Friction::Stick => "stick".to_owned(),
            },
        );
        set("indentation", shown(case.greatest_indentation()));
        let (word, radius, material) = match &case.opponent {
            None => ("plane", None, None),
            Some(Opponent::Equal) => ("equal", None, None),
            Some(Opponent::Rigid { radius }) => ("rigid", Some(*radius), None),
            Some(Opponent::Deforming { radius: Some(radius), material }) => ("sphere", Some(*radius), Some(material)),
            Some(Opponent::Deforming { radius: None, material }) => ("flat", None, Some(material)),
        };
        let other = material.filter(|material| **material != case.material);
        set("opponent", word.to_owned());
        set("opponent.radius", shown(radius.unwrap_or(case.sphere.radius)));
        set("opponent.material", if other.is_some() { "own" } else { "same" }.to_owned());
        let is_slip = matches!(
            case.path.as_slice(),
            [Segment::Indentation { .. }, Segment::Shear { shear: ShearTarget::FullSlip, hold: Hold::Indentation }]
        );
        set("path", if is_slip { "slip" } else { "case" }.to_owned());
        set("displacement", "0".to_owned());
        set("elements", case.mesh.elements_per_contact_radius.to_string());
        set("axes", "case".to_owned());
        form.set_material("", &case.material);
        form.set_material(OTHER, other.unwrap_or(&case.material));
        form
    }

    fn set_material(&mut self, prefix: &str, material: &Material) {
        let mut set = |name: &str, value: String| drop(self.values.insert(format!("{prefix}{name}"), value));
        set("youngs_modulus", shown(material.youngs_modulus));
        set("poissons_ratio", shown(material.poissons_ratio));
        set("law", material.hardening.kind().word().to_owned());
        // Other laws begin with a material that yields where this one does.
        let yields = material.hardening.yield_stress(material.youngs_modulus);
        let number = |key: &str, law| about(law, key).0.parse::<f64>().unwrap_or(1.0);
        let stress = yields.unwrap_or(2e-3 * material.youngs_modulus) / number("yield_stress", HardeningLaw::Ideal);
        for law in HardeningLaw::ALL {
            for key in keys_of(law) {
                set(&format!("{}.{key}", law.word()), example(law, key, stress));
            }
        }
        let own = material.hardening.kind();
        for (key, number) in own.parameters().iter().zip(material.hardening.numbers()) {
            set(&format!("{}.{}", own.word(), key.key), shown(number));
        }
        if let Hardening::Table { points } = &material.hardening {
            set("table.points", points_shown(points));
        }
    }

    /// The fields of a case with those of a query in their place.
    ///
    /// # Errors
    /// A query that no page of this program has sent.
    pub fn with(case: &Case, query: &str) -> Result<Self, String> {
        let mut form = Self::of(case);
        let fields = parse(query)?;
        let chosen = |prefix: &str| fields.iter().find(|(name, _)| *name == format!("{prefix}law")).map(|(_, word)| word.clone());
        for prefix in ["", OTHER] {
            if let Some(word) = chosen(prefix) {
                form.values.insert(format!("{prefix}law"), word);
            }
        }
        for (name, value) in &fields {
            let (prefix, own) = name.strip_prefix(OTHER).map_or(("", name.as_str()), |own| (OTHER, own));
            if PLAIN.contains(&name.as_str()) || MATERIAL.contains(&own) {
                form.values.insert(name.clone(), value.clone());
                continue;
            }
            let known = HardeningLaw::ALL.iter().flat_map(|law| keys_of(*law)).any(|key| key == own);
            if !known {
                return Err("the query has a field that the page has not".to_owned());
            }
            let law = form.get(&format!("{prefix}law")).to_owned();
            form.values.insert(format!("{prefix}{law}.{own}"), value.clone());
        }
        Ok(form)
    }

    /// The query of a page with these fields.
    pub fn query(&self) -> String {
        let mut parts = Vec::new();
        let mut add = |name: &str, value: &str| {
            if !value.is_empty() {
                parts.push(format!("{name}={}", encoded(value)));
            }
        };
        for name in PLAIN {
            add(name, self.get(name));
        }
        for prefix in ["", OTHER] {
            MATERIAL.iter().for_each(|name| add(&format!("{prefix}{name}"), self.get(&format!("{prefix}{name}"))));
            let law = self.get(&format!("{prefix}law"));
            for key in HardeningLaw::ALL.into_iter().filter(|one| one.word() == law).flat_map(keys_of) {
                add(&format!("{prefix}{key}"), self.get(&format!("{prefix}{law}.{key}")));
            }
        }
        parts.join("&")
    }

    /// A field as it was typed.
    pub fn get(&self, name: &str) -> &str {
        self.values.get(name).map_or("", String::as_str)
    }

    /// The case that the fields describe, with all else from `base`.
    ///
    /// # Errors
    /// Every field that cannot be taken.
    pub fn case(&self, base: &Case) -> Result<Case, Vec<Mistake>> {
        let mut reading = FormReading { form: self, mistakes: Vec::new() };
        let table = reading.table(base);
        if !reading.mistakes.is_empty() {
            return Err(reading.mistakes);
        }
        let document = Document::from_table(&table);
        Case::from_document(&document).map_err(|first| {
            let all = mistakes(&document);
            let all = if all.is_empty() { vec![first] } else { all };
            all.iter().map(|error| of_case(error, self.get("path"))).collect()
        })
    }

    /// Whether the path is the one of the case with which the page was opened.
    pub fn keeps_path(&self) -> bool {
        self.get("path") == "case"
    }
}

/// What the parser of case files says, at the field that it is about.
fn of_case(error: &CaseError, path: &str) -> Mistake {
    let key = error.key().unwrap_or_default();
    let text = error.to_string();
    let what = text.split_once(&format!("{key}: ")).filter(|_| !key.is_empty()).map_or(text.as_str(), |(_, what)| what);
    let parts: Vec<&str> = key.split('.').collect();
    // A point of a table has its numbers behind the key.
    let last = parts.iter().find(|part| **part == "points").or(parts.last()).copied().unwrap_or_default();
    let field = match parts.as_slice() {
        ["opponent", "radius"] => "opponent.radius".to_owned(),
        ["opponent", ..] => format!("{OTHER}{last}"),
        ["mesh", ..] => "elements".to_owned(),
        // The other paths have no field for it.
        ["path", _, "shear"] if path != "cycle" => "path".to_owned(),
        ["path", _, "shear"] => "displacement".to_owned(),
        _ => last.to_owned(),
    };
    Mistake { field, what: what.to_owned() }
}

/// Fields on their way to the tables of a case file.
struct FormReading<'a> {
    form: &'a Form,
    mistakes: Vec<Mistake>,
}

impl FormReading<'_> {
    fn wrong(&mut self, field: &str, what: &str) {
        self.mistakes.push(Mistake { field: field.to_owned(), what: what.to_owned() });
    }

    /// A number from a field; what it is called in the page is `name`.
    fn number(&mut self, field: &str, name: &str) -> toml::Value {
        let number = self.form.get(field).trim().parse::<f64>().ok().filter(|number| number.is_finite());
        if number.is_none() {
            self.wrong(name, "is no number; write it as in 0.3 or 200e3, with a decimal point");
        }
        toml::Value::Float(number.unwrap_or(0.0))
    }

    fn word(&mut self, field: &str, words: &[&str]) -> String {
        let word = self.form.get(field).to_owned();
        if !words.contains(&word.as_str()) {
            self.wrong(field, &format!("is none of {}", words.join(", ")));
        }
        word
    }

    fn material(&mut self, prefix: &str) -> toml::Value {
        let law = self.word(&format!("{prefix}law"), &HardeningLaw::WORDS);
        let mut hardening = toml::Table::new();
        hardening.insert("law".to_owned(), toml::Value::String(law.clone()));
        for key in HardeningLaw::ALL.into_iter().filter(|one| one.word() == law).flat_map(keys_of) {
            let (field, name) = (format!("{prefix}{law}.{key}"), format!("{prefix}{key}"));
            let value = if key == "points" { self.points(&field, &name) } else { self.number(&field, &name) };
            hardening.insert(key.to_owned(), value);
        }
        let mut material = toml::Table::new();
        for key in ["youngs_modulus", "poissons_ratio"] {
            let field = format!("{prefix}{key}");
            material.insert(key.to_owned(), self.number(&field, &field));
        }
        material.insert("hardening".to_owned(), toml::Value::Table(hardening));
        toml::Value::Table(material)
    }

    /// Pairs of a strain and a stress, a semicolon between them.
    fn points(&mut self, field: &str, name: &str) -> toml::Value {
        let mut pairs = Vec::new();
        for pair in self.form.get(field).split(';').map(str::trim).filter(|pair| !pair.is_empty()) {
            let numbers: Vec<f64> = pair.split([' ', ',']).filter_map(|word| word.parse().ok()).collect();
            match numbers.as_slice() {
                [alpha, stress] if alpha.is_finite() && stress.is_finite() => {
                    pairs.push(toml::Value::Array(vec![toml::Value::Float(*alpha), toml::Value::Float(*stress)]));
                }
                _ => {
                    self.wrong(
                        name,
                        "has something that is no pair; write strain and stress with a space between, pairs with a semicolon",
                    );
                    break;
                }
            }
        }
        toml::Value::Array(pairs)
    }

    fn opponent(&mut self) -> Option<toml::Value> {
        let word = self.word("opponent", &OPPONENTS.map(|(word, _)| word));
        let mut table = toml::Table::new();
        let truth = toml::Value::Boolean(true);
        match word.as_str() {
            "equal" => drop(table.insert("equal".to_owned(), truth)),
            "rigid" => {
                table.insert("rigid".to_owned(), truth);
                table.insert("radius".to_owned(), self.number("opponent.radius", "opponent.radius"));
            }
            "sphere" => drop(table.insert("radius".to_owned(), self.number("opponent.radius", "opponent.radius"))),
            "flat" => drop(table.insert("flat".to_owned(), truth)),
            _ => return None,
        }
        if matches!(word.as_str(), "sphere" | "flat") && self.word("opponent.material", &["same", "own"]) == "own" {
            table.insert("material".to_owned(), self.material(OTHER));
        }
        Some(toml::Value::Table(table))
    }

    fn path(&mut self) -> Option<toml::Value> {
        let segment = |key: &str, value: toml::Value| toml::Value::Table([(key.to_owned(), value)].into_iter().collect());
        let slip = || segment("shear", toml::Value::String("full-slip".to_owned()));
        let kind = self.word("path", &["slip", "cycle", "case"]);
        if kind == "case" {
            return None;
        }
        let press = segment("indentation", self.number("indentation", "indentation"));
        let toml::Value::Float(d) = self.number("displacement", "displacement") else { return None };
        let to = |d: f64| segment("shear", toml::Value::Float(d));
        Some(toml::Value::Array(match kind.as_str() {
            "cycle" if d == 0.0 => vec![press, slip(), to(0.0), segment("release", toml::Value::Boolean(true))],
            "cycle" => vec![press, to(d), to(-d), to(d), segment("release", toml::Value::Boolean(true))],
            _ => vec![press, slip()],
        }))
    }

    fn table(&mut self, base: &Case) -> toml::Table {
        // A case that was read is one that can be written.
        let mut table = toml::Table::try_from(base).unwrap_or_default();
        let mut put = |name: &str, key: &str, value: toml::Value| {
            if let toml::Value::Table(inner) = table.entry(name).or_insert_with(|| toml::Value::Table(toml::Table::new())) {
                inner.insert(key.to_owned(), value);
            }
        };
        put("sphere", "radius", self.number("radius", "radius"));
        let friction = self.form.get("friction").trim();
        let stick = toml::Value::String("stick".to_owned());
        put("contact", "friction", if friction == "stick" { stick } else { self.number("friction", "friction") });
        let elements = self.form.get("elements").trim().parse::<u16>();
        match elements {
            Ok(elements) if usize::from(elements) != base.mesh.elements_per_contact_radius => {
                put("mesh", "elements_per_contact_radius", toml::Value::Integer(elements.into()));
                put("mesh", "surface_elements_per_contact_radius", toml::Value::Integer(elements.into()));
            }
            Ok(_) => {}
            Err(_) => self.wrong("elements", "is no whole number"),
        }
        self.word("axes", &["case", "none"]);
        let (material, opponent, path) = (self.material(""), self.opponent(), self.path());
        table.insert("material".to_owned(), material);
        table.remove("opponent");
        table.extend(opponent.map(|opponent| ("opponent".to_owned(), opponent)));
        table.extend(path.map(|path| ("path".to_owned(), path)));
        table
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn base() -> Case {
        Case::parse(include_str!("../../fixtures/cases/ideal.toml"), "ideal.toml", &[]).unwrap()
    }

    fn case(query: &str) -> Result<Case, Vec<Mistake>> {
        Form::with(&base(), query).unwrap().case(&base())
    }

    #[test]
    fn without_a_query_it_is_the_case_itself() {
        for text in [
            include_str!("../../fixtures/cases/ideal.toml"),
            include_str!("../../fixtures/cases/equal.toml"),
            include_str!("../../fixtures/cases/table.toml"),
            include_str!("../../fixtures/cases/unlike.toml"),
            include_str!("../../fixtures/cases/voce.toml"),
        ] {
            let own = Case::parse(text, "case.toml", &[]).unwrap();
            assert_eq!(Form::of(&own).case(&own).unwrap(), own);
        }
    }

    #[test]
    fn every_hardening_law_has_fields_that_make_a_case() {
        for law in HardeningLaw::ALL {
            let made =
                case(&format!("law={}&opponent=sphere&opponent.material=own&opponent.law={}", law.word(), law.word())).unwrap();
            assert_eq!(made.material.hardening.kind(), law);
            assert!(matches!(made.opponent, Some(Opponent::Deforming { material, .. }) if material.hardening.kind() == law));
        }
    }

    #[test]
    fn fields_are_what_they_say() {
        let material = "youngs_modulus=70e3&poissons_ratio=0.2&law=power&yield_stress=100&coefficient=300&exponent=0.5";
        let contact = "radius=2&friction=0.1&indentation=0.03&path=cycle&displacement=0.01&opponent=equal";
        let made = case(&format!("{material}&{contact}")).unwrap();
        assert_eq!((made.sphere.radius, made.material.youngs_modulus, made.material.poissons_ratio), (2.0, 70e3, 0.2));
        assert_eq!(made.material.hardening, Hardening::Power { yield_stress: 100.0, coefficient: 300.0, exponent: 0.5 });
        assert_eq!(
            (made.contact.friction, made.opponent.clone(), made.path.len()),
            (Friction::Coefficient(0.1), Some(Opponent::Equal), 5)
        );
        assert_eq!(made.greatest_indentation(), 0.03);
        let table = case("law=table&points=0+100%3B+0.1+200").unwrap();
        assert_eq!(table.material.hardening, Hardening::Table { points: vec![[0.0, 100.0], [0.1, 200.0]] });
    }

    #[test]
    fn mistakes_stand_at_their_fields() {
        let fields = |query: &str| case(query).unwrap_err().into_iter().map(|mistake| mistake.field).collect::<Vec<_>>();
        assert_eq!(fields("poissons_ratio=0.7&friction=-1"), ["poissons_ratio", "friction"]);
        assert_eq!(fields("radius=abc&youngs_modulus=inf"), ["radius", "youngs_modulus"]);
        assert_eq!(fields("yield_stress=-3"), ["yield_stress"]);
        assert_eq!(fields("indentation=0.5"), ["indentation"]);
        assert_eq!(fields("opponent=sphere&opponent.radius=1000"), ["opponent.radius"]);
        assert_eq!(fields("path=cycle&displacement=3"), ["displacement"]);
        assert_eq!(fields("friction=stick"), ["path"]);
        assert_eq!(fields("opponent=moon&law=soft&axes=left&path=away"), ["axes", "law", "opponent", "path"]);
        assert_eq!(fields("law=table&points=1"), ["points"]);
        let what = &case("poissons_ratio=0.7").unwrap_err()[0].what;
        assert!(what.starts_with("is 0.7") && what.contains("Allowed"), "{what}");
    }

    #[test]
    fn a_hostile_query_is_refused_or_is_text() {
        let refused = |query: &str| Form::with(&base(), query).unwrap_err();
        assert!(refused("evil=1").contains("has not"));
        assert!(refused("radius=1&radius=2").contains("twice"));
        assert!(refused("radius=%zz").contains("encoded") && refused("radius=%00").contains("encoded"));
        assert!(refused("radius=%ff%fe").contains("encoded") && refused("radius=1%").contains("encoded"));
        assert!(refused(&"a".repeat(LONGEST_QUERY + 1)).contains("longer"));
        assert!(refused(&(0..60).map(|i| format!("a{i}=1&")).collect::<String>()).contains("too many"));
        // What a number is not is never taken for one, whatever it looks like.
        for value in ["1e999", "NaN", "-inf", "1e-400x", "%3Cscript%3E", "../../etc/passwd", "1;2", "0x10", "1_000"] {
            assert!(case(&format!("radius={value}")).is_err(), "{value}");
        }
        assert!(case(&format!("law=table&points={}", "0+1;".repeat(900))).is_err());
    }
}

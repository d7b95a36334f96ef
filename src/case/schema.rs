//! JSON Schema (draft 2020-12) of case and study files, for editors that complete and check TOML.

use serde_json::{Map, Value, json};

use super::keys::{KEYS, Key, Kind, LAWS, Limit, Presence, TABLES};

const DRAFT: &str = "https://json-schema.org/draft/2020-12/schema";

/// The schema of a case file.
pub fn case_schema() -> Value {
    let mut schema = case(true);
    schema["$schema"] = DRAFT.into();
    schema["title"] = "Asperity case".into();
    schema
}

/// The schema of a study file: a case under `base`, from which nothing has to be there as the grid
/// may give it, and what varies it under `grid`, `zip` and `list`.
pub fn study_schema() -> Value {
    let values = json!({
        "anyOf": [
            { "type": "array", "minItems": 1 },
            { "type": "object", "minProperties": 1, "additionalProperties": { "$ref": "#/$defs/values" } }
        ]
    });
    let grid = json!({
        "type": "object",
        "description": "dotted keys of the case with lists of values; every combination is a case",
        "minProperties": 1,
        "additionalProperties": { "$ref": "#/$defs/values" }
    });
    let zipped = json!({
        "type": "object",
        "description": "dotted keys of the case with lists of one length, gone through together",
        "minProperties": 1,
        "additionalProperties": { "$ref": "#/$defs/values" }
    });
    let zip = json!({ "anyOf": [zipped, { "type": "array", "minItems": 1, "items": zipped }] });
    let list = json!({
        "type": "array",
        "description": "cases one by one: dotted keys of the case with a value each",
        "minItems": 1,
        "items": { "type": "object", "minProperties": 1 }
    });
    json!({
        "$schema": DRAFT,
        "title": "Asperity study",
        "type": "object",
        "additionalProperties": false,
        "required": ["base"],
        "anyOf": [{ "required": ["grid"] }, { "required": ["zip"] }, { "required": ["list"] }],
        "properties": { "base": case(false), "grid": grid, "zip": zip, "list": list },
        "$defs": { "values": values }
    })
}

/// A case, as it stands in a file of its own or, `whole` being false, under the base of a study.
fn case(whole: bool) -> Value {
    let mut properties = Map::new();
    let mut material = Value::Null;
    for (table, about) in TABLES.into_iter().filter(|(table, _)| !table.contains('.')) {
        let mut schema = match table {
            "path" => path(),
            _ => object(KEYS.iter().filter(|key| key.table == table), whole),
        };
        if table == "material" {
            schema["properties"]["hardening"] = hardening(whole);
            if whole {
                schema["required"] = json!(["youngs_modulus", "poissons_ratio", "hardening"]);
            }
            material = schema.clone();
        }
        if table == "opponent" {
            let about = schema["properties"]["material"]["description"].take();
            schema["properties"]["material"] = material.clone();
            schema["properties"]["material"]["description"] = about;
        }
        schema["description"] = about.into();
        properties.insert(table.to_owned(), schema);
    }
    let mut schema = json!({ "type": "object", "additionalProperties": false, "properties": properties });
    if whole {
        schema["required"] = json!(["sphere", "material", "contact", "path"]);
    }
    schema
}

fn path() -> Value {
    let mut segment = object(KEYS.iter().filter(|key| key.table == "path"), false);
    segment["minProperties"] = 1.into();
    segment["dependentRequired"] = json!({ "shear_direction": ["shear"] });
    segment["dependentSchemas"] = json!({
        "hold": { "anyOf": [{ "required": ["shear"] }, { "required": ["twist"] }, { "required": ["roll"] }] }
    });
    json!({ "type": "array", "minItems": 1, "items": segment })
}

/// One object for each law, told apart by `law`.
fn hardening(whole: bool) -> Value {
    let of_law = |law: &str| {
        let keys = KEYS.iter().filter(|key| key.table == "material.hardening" && key.fits(law));
        let mut schema = object(keys, whole);
        schema["properties"]["law"]["const"] = law.into();
        schema
    };
    let laws: Vec<Value> = LAWS.into_iter().map(of_law).collect();
    // The base of a study may leave the law to the grid, and then fits several.
    let mut schema = json!({ "type": "object" });
    schema[if whole { "oneOf" } else { "anyOf" }] = laws.into();
    schema
}

fn object<'k>(keys: impl Iterator<Item = &'k Key>, whole: bool) -> Value {
    let (mut properties, mut required) = (Map::new(), Vec::new());
    for key in keys {
        properties.insert(key.name.to_owned(), property(key));
        if key.presence == Presence::Required {
            required.push(key.name);
        }
    }
    let mut schema = json!({ "type": "object", "additionalProperties": false, "properties": properties });
    if whole && !required.is_empty() {
        schema["required"] = json!(required);
    }
    schema
}

fn property(key: &Key) -> Value {
    let mut schema = match key.kind {
        Kind::Number(low, high, words) => {
            let number = number(low, high);
            if words.is_empty() { number } else { json!({ "anyOf": [number, { "enum": words }] }) }
        }
        Kind::Components(words) => {
            let pair = json!({ "type": "array", "minItems": 2, "maxItems": 2, "items": { "type": "number" } });
            json!({ "anyOf": [number(Limit::Free, Limit::Free), pair, { "enum": words }] })
        }
        Kind::Whole(least, most) => json!({ "type": "integer", "minimum": least, "maximum": most }),
        Kind::Truth => json!({ "type": "boolean" }),
        Kind::ShareOrTrue => {
            json!({ "anyOf": [{ "const": true }, { "type": "number", "exclusiveMinimum": 0, "exclusiveMaximum": 1 }] })
        }
        Kind::Word(words) => json!({ "enum": words }),
        // Filled in where the table is put together.
        Kind::Material => json!({ "type": "object" }),
        Kind::Text => json!({ "type": "string", "minLength": 1, "maxLength": 16 }),
        Kind::Points => json!({
            "type": "array",
            "minItems": 1,
            "items": { "type": "array", "minItems": 2, "maxItems": 2, "items": { "type": "number", "minimum": 0.0 } }
        }),
    };
    let unit = if key.unit.is_empty() { String::new() } else { format!(" [{}]", key.unit) };
    schema["description"] = format!("{}{unit}: {}", key.meaning, key.range).into();
    if let Presence::Defaults(value) = key.presence {
        // Words in quotes and plain numbers are the same in TOML and JSON.
        schema["default"] = serde_json::from_str(value).unwrap_or_else(|_| value.into());
    }
    schema
}

fn number(low: Limit, high: Limit) -> Value {
    let mut schema = json!({ "type": "number" });
    for (limit, at, beyond) in [(low, "minimum", "exclusiveMinimum"), (high, "maximum", "exclusiveMaximum")] {
        match limit {
            Limit::Free => {}
            Limit::AtLeast(value) | Limit::AtMost(value) => schema[at] = value.into(),
            Limit::Above(value) => schema[beyond] = value.into(),
        }
    }
    schema
}

//! `docs/cases.md`, made from the table of keys.

use std::fmt::Write as _;

use asperity::case::keys::{KEYS, Key, Presence, TABLES};

const HEAD: &str = "\
# Case files

<!-- Made from src/case/keys.rs: ASPERITY_BLESS=1 cargo test --test documents -->

A case file is TOML. `asperity init` writes one with every key explained, `asperity check` prints a case with
every default, `asperity explain KEY` prints an entry of this page, and `asperity schema case` prints a JSON
Schema for editors. A [study file](studies.md) has the same tables under `base`.

Use any consistent system of units: `radius` sets the unit of length and `youngs_modulus` that of stress;
forces are stress times length squared. With millimetres and MPa, forces are in newtons.

Yield stresses and plastic strains are the true stress and the logarithmic strain of a tensile test (strictly,
the Kirchhoff stress: true stress times the ratio of present to original volume).

On the command line, `--set KEY=VALUE` replaces a value. Write the key with dots between its parts; the
segments of the path (the `[[path]]` entries) are numbered from 0: `--set path.0.indentation=0.01`.

In the column *default*, \"none: X\" means that no value is set; a case without the key behaves as X says.

A whole case:

```toml
[sphere]
radius = 1.0

[material]
youngs_modulus = 200e3
poissons_ratio = 0.3

[material.hardening]
law = \"voce\"
yield_stress = 400.0
saturation_stress = 700.0
rate = 20.0

[contact]
friction = 0.3

[mesh]
elements_per_contact_radius = 8

[[path]]
indentation = 0.02

[[path]]
shear = 0.005

[[path]]
shear = -0.005

[[path]]
release = true
```
";

const PATH: &str = "\
Each segment has either `release`, or one or several of `indentation`, `shear`, `twist` and `roll`, which then
move in proportion. In a shear, twist or roll without `indentation`, `hold` says what stays constant.
Displacements and angles are totals from first touch, not increments.

Only the lower hemisphere is modelled, and only its half y >= 0 where the path is symmetric about y = 0. The
segments move its equatorial plane as a [rigid plate](opponents.md). delta_T is the tangential displacement of
this plate over the opponent; in a roll, the centre's travel is subtracted. The axes of a case are fixed; a
DEM engine integrates the same in a [frame that turns with the contact](laws.md#the-frame-of-the-centres).

```toml
[[path]]
indentation = 0.02                      # press

[[path]]
shear = 0.002                           # shear at constant F_N
hold = \"normal-force\"

[[path]]
indentation = 0.025                     # press on and shear further, in proportion
shear = 0.004

[[path]]
release = 0.5                           # unload to half of F_N
```
";

pub fn text() -> String {
    let mut text = HEAD.to_owned();
    for (table, about) in TABLES {
        let brackets = if table == "path" { "[[path]]".to_owned() } else { format!("[{table}]") };
        // Writing to a String cannot fail.
        let _ = write!(text, "\n## {brackets}\n\n{}.\n\n", capital(about));
        if table == "path" {
            text += PATH;
            text.push('\n');
        }
        text += "| key | unit | range | default | meaning |\n|---|---|---|---|---|\n";
        KEYS.iter().filter(|key| key.table == table).for_each(|key| text += &row(key));
    }
    text
}

fn row(key: &Key) -> String {
    let default = match key.presence {
        Presence::Required => "required".to_owned(),
        Presence::Defaults(value) => format!("`{value}`"),
        Presence::Optional(words) => format!("none: {words}"),
    };
    let laws = match key.laws {
        [] => String::new(),
        laws => format!(" (law {})", laws.iter().map(|law| format!("`{law}`")).collect::<Vec<_>>().join(", ")),
    };
    let cells = [&format!("`{}`{laws}", key.name), key.unit, key.range, &default, &capital(key.meaning)];
    // A bar would end the cell.
    format!("| {} |\n", cells.map(|cell| cell.replace('|', "\\|")).join(" | "))
}

fn capital(text: &str) -> String {
    let mut letters = text.chars();
    // A symbol such as `n` in a formula stays as it is.
    match letters.next() {
        Some(first)
            if text.len() > 1
                && text[first.len_utf8()..].starts_with(|c: char| c.is_ascii_lowercase())
                && !text.starts_with("sigma") =>
        {
            first.to_uppercase().chain(letters).collect()
        }
        _ => text.to_owned(),
    }
}

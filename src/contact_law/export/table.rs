//! The table of one material and one friction for engines: as a C constant, and as a file that is
//! read when an engine starts.

use std::fmt::Write as _;

use crate::contact_law::ContactParameters;

/// Version of the table's file.
const VERSION: u32 = 5;

/// What an engine's table is made of.
pub(crate) struct EngineTable {
    /// The update's parameters of a sphere with R = 1 and E = 1.
    pub(crate) parameters: ContactParameters,
    /// nu of the sphere.
    pub(crate) poissons_ratio: f64,
    /// What the sphere is pressed against, in a word: "plane" of any flat.
    pub(crate) body: &'static str,
    /// Whether it is of a sphere on a flat: of a wall.
    pub(crate) plane: bool,
    /// h/R up to which the law was made; 0 where nothing of this material is within its range.
    pub(crate) deepest: f64,
    /// What it is, in words.
    pub(crate) source: String,
    /// What of its deepest contact the law was not made for, in words.
    pub(crate) warnings: Vec<String>,
}

impl EngineTable {
    /// The single numbers by the names that they have in the file.
    fn numbers(&self) -> [(&'static str, f64); 11] {
        let (first, table) = (self.parameters.first_loading(), self.parameters.table());
        [
            // h and the tangential displacement are all of what the two centres move, whatever the
            // sphere meets.
            ("share", 1.0),
            ("poissons_ratio", self.poissons_ratio),
            ("friction", table.friction),
            ("effective_modulus", first.effective_modulus),
            ("effective_radius", first.radius),
            ("deepest", self.deepest),
            ("later", table.later),
            ("first", table.first),
            ("per_step", table.per_step),
            ("level_start", table.level_start),
            ("per_level", table.per_level),
        ]
    }

    /// As a file that `asperity_read_table` reads.
    pub(crate) fn file(&self) -> String {
        let table = self.parameters.table();
        let mut text = format!("asperity-contact-table {VERSION}\nbody {}\n", self.body);
        // Writing to a String cannot fail.
        for (name, value) in self.numbers() {
            let _ = writeln!(text, "{name} {value:?}");
        }
        let row = |values: &[f64]| values.iter().map(|x| format!("{x:?}")).collect::<Vec<_>>().join(" ") + "\n";
        text.push_str("rows\n");
        table.rows.iter().for_each(|values| text.push_str(&row(values)));
        text.push_str("shapes\n");
        table.shapes.iter().flatten().for_each(|values| text.push_str(&row(values)));
        text.push_str("vertex\n");
        table.reach.iter().zip(&table.beyond).for_each(|(&reach, &beyond)| text.push_str(&row(&[reach, beyond])));
        text.push_str("end\n");
        // What comes after the end is for readers, and for engines that warn.
        let _ =
            writeln!(text, "# {}, h/R up to {}; written by asperity {}", self.source, self.deepest, env!("CARGO_PKG_VERSION"));
        for warning in &self.warnings {
            let _ = writeln!(text, "# warning: {warning}");
        }
        text
    }

    /// As a C constant.
    pub(crate) fn header(&self) -> String {
        let table = self.parameters.table();
        let number = |x: f64| format!("ASPERITY_R({x:?})");
        let row = |values: &[f64]| format!("{{{}}}", values.iter().map(|&x| number(x)).collect::<Vec<_>>().join(", "));
        let numbers = self.numbers().map(|(_, value)| number(value)).join(", ");
        let mut text = format!(
            "/* asperity_law.h: {}, h/R up to {}. Written by asperity {}.{} */\n#ifndef ASPERITY_LAW_H\n#define ASPERITY_LAW_H\n\n\
             #include \"asperity_contact.h\"\n\nstatic const asperity_table asperity_law = {{\n    {}, {numbers},\n    {{\n",
            self.source,
            self.deepest,
            env!("CARGO_PKG_VERSION"),
            self.warnings.iter().map(|warning| format!("\n * Warning: {warning}.")).collect::<String>(),
            u8::from(self.plane),
        );
        for values in &table.rows {
            let _ = writeln!(text, "        {},", row(values));
        }
        text.push_str("    },\n    {\n");
        for shapes in &table.shapes {
            let _ = writeln!(text, "        {{{}}},", shapes.iter().map(|values| row(values)).collect::<Vec<_>>().join(", "));
        }
        let _ = writeln!(text, "    }},\n    {},\n    {}", row(&table.reach), row(&table.beyond));
        text.push_str("};\n\n#endif\n");
        text
    }
}

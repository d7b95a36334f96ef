//! The table of one material and one friction for engines: as a C constant, and as a file that is
//! read when an engine starts.

use std::fmt::Write as _;

use crate::contact_law::{COLUMNS, ContactParameters, KNOTS};

/// Version of the table's file.
const VERSION: u32 = 4;

/// Columns of the parameters' table in the order of the header's.
const ORDER: [usize; COLUMNS] = [0, 1, 3, 7, 2, 4, 5, 6];

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
    /// What h and the tangential displacement are of what the two centres move: all of it, whatever
    /// the sphere meets.
    fn share(&self) -> f64 {
        1.0
    }

    /// The cubics from knot to knot as the update reads them: coefficients of 1, u, u^2, u^3 of all
    /// columns, the logarithms first. Of those the first coefficient is the quantity itself, and of
    /// a and delta_T_end all are of the inverse.
    fn knots(&self) -> Vec<[Vec<f64>; 4]> {
        let parameters = &self.parameters;
        let cubic = |i: usize, column: usize| {
            let (value, slope) = (parameters.table[i][column], parameters.knot_slope(column, i));
            let [square, cube] = if i + 1 < KNOTS {
                let (rise, next) = (parameters.table[i + 1][column] - value, parameters.knot_slope(column, i + 1));
                [3.0 * rise - 2.0 * slope - next, slope + next - 2.0 * rise]
            } else {
                [0.0, 0.0]
            };
            let sign = if column == 1 || column == 3 { -1.0 } else { 1.0 };
            let start = if ORDER[..4].contains(&column) { (sign * value).exp() } else { value };
            [start, sign * slope, sign * square, sign * cube]
        };
        (0..KNOTS).map(|i| [0, 1, 2, 3].map(|power| ORDER.iter().map(|&column| cubic(i, column)[power]).collect())).collect()
    }

    /// The single numbers by the names that they have in the file.
    fn numbers(&self) -> [(&'static str, f64); 10] {
        let p = &self.parameters;
        [
            ("share", self.share()),
            ("poissons_ratio", self.poissons_ratio),
            ("friction", p.friction),
            ("effective_modulus", p.effective_modulus),
            ("effective_radius", p.radius),
            ("deepest", self.deepest),
            ("form", p.form),
            ("first", p.log_first.exp()),
            ("log_step", p.log_step),
            ("gentle", p.gentle),
        ]
    }

    /// As a file that `asperity_read_table` reads.
    pub(crate) fn file(&self) -> String {
        let mut text = format!("asperity-contact-table {VERSION}\nbody {}\n", self.body);
        // Writing to a String cannot fail.
        for (name, value) in self.numbers() {
            let _ = writeln!(text, "{name} {value:?}");
        }
        let row = |values: &[f64]| values.iter().map(|x| format!("{x:?}")).collect::<Vec<_>>().join(" ") + "\n";
        text.push_str("knots\n");
        self.knots().iter().flatten().for_each(|values| text.push_str(&row(values)));
        text.push_str("shapes\n");
        self.parameters.shapes.iter().flatten().for_each(|values| text.push_str(&row(values)));
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
        let number = |x: f64| format!("ASPERITY_R({x:?})");
        let row = |values: &[f64]| format!("{{{}}}", values.iter().map(|&x| number(x)).collect::<Vec<_>>().join(", "));
        let numbers = self.numbers().map(|(_, value)| number(value));
        let [share, nu, friction, modulus, curvature, deepest, _, first, log_step, gentle] = numbers;
        let mut text = format!(
            "/* asperity_law.h: {}, h/R up to {}. Written by asperity {}.{} */\n#ifndef ASPERITY_LAW_H\n#define ASPERITY_LAW_H\n\n\
             #include \"asperity_contact.h\"\n\nstatic const asperity_table asperity_law = {{\n    {}, {}, {share}, {nu}, {friction}, {modulus}, {curvature}, \
             {deepest}, {first}, {log_step}, {gentle},\n    {{\n",
            self.source,
            self.deepest,
            env!("CARGO_PKG_VERSION"),
            self.warnings.iter().map(|warning| format!("\n * Warning: {warning}.")).collect::<String>(),
            u8::from(self.plane),
            self.parameters.form,
        );
        for cubics in self.knots() {
            let _ = writeln!(text, "        {{{}}},", cubics.map(|values| row(&values)).join(", "));
        }
        text.push_str("    },\n    {\n");
        for [tangential, normal] in &self.parameters.shapes {
            let _ = writeln!(text, "        {{{}, {}}},", row(tangential), row(normal));
        }
        text.push_str("    }};\n\n#endif\n");
        text
    }
}

//! In which units the axes are: without units, F/(E R^2) and delta/R, or in those of the case,
//! under the user's names for them.

use crate::case::Case;

/// What a quantity is a multiple of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)] // their names say what they are
pub enum Dimension {
    Length,
    Force,
    Stress,
}

/// Which units a user asks for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AxisUnits {
    /// Those of the case where its `[units]` names some, none elsewhere.
    #[default]
    Auto,
    /// None: forces over E R^2, lengths over R, stresses over E.
    Normalised,
    /// Those of the case, whether it names them or not.
    Case,
}

/// One dimension: what its values are divided by, and what that leaves.
#[derive(Clone, Debug, PartialEq)]
struct AxisScale {
    divisor: f64,
    unit: Unit,
}

#[derive(Clone, Debug, PartialEq)]
enum Unit {
    /// None: the divisor in letters.
    Over(&'static str),
    /// The user's.
    Named(String),
}

/// The units of all axes of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Axes {
    length: AxisScale,
    force: AxisScale,
    stress: AxisScale,
}

/// One axis: the factor of its values, and its name.
#[derive(Clone, Debug, PartialEq)]
pub struct Shown {
    /// Values are multiplied by this.
    pub factor: f64,
    /// Words, symbol and unit.
    pub label: String,
    /// Symbol and unit alone.
    pub short: String,
}

impl Axes {
    /// Those of a case.
    pub fn of(case: &Case, units: AxisUnits) -> Self {
        let labelled = match units {
            AxisUnits::Auto => !case.units.is_empty(),
            AxisUnits::Normalised => false,
            AxisUnits::Case => true,
        };
        if !labelled {
            return Self::normalised(case.sphere.radius, case.material.youngs_modulus);
        }
        let named = |label: &Option<String>, what: &str| {
            let name = label.clone().unwrap_or_else(|| format!("case's unit of {what}"));
            AxisScale { divisor: 1.0, unit: Unit::Named(name) }
        };
        let units = &case.units;
        Self {
            length: named(&units.length, "length"),
            force: named(&units.force, "force"),
            stress: named(&units.stress, "stress"),
        }
    }

    /// Without units, for a sphere of this radius and Young's modulus.
    pub fn normalised(radius: f64, youngs_modulus: f64) -> Self {
        let over = |divisor, name| AxisScale { divisor, unit: Unit::Over(name) };
        Self {
            length: over(radius, "R"),
            force: over(youngs_modulus * radius * radius, "(E R^2)"),
            stress: over(youngs_modulus, "E"),
        }
    }

    /// The axis of a quantity: `words` before its `symbol`, values up to `greatest` in magnitude.
    /// Small values without units get a power of ten, which keeps the numbers beside the axis
    /// short.
    pub fn show(&self, dimension: Dimension, words: &str, symbol: &str, greatest: f64) -> Shown {
        let scale = match dimension {
            Dimension::Length => &self.length,
            Dimension::Force => &self.force,
            Dimension::Stress => &self.stress,
        };
        let words = if words.is_empty() { String::new() } else { format!("{words} ") };
        match &scale.unit {
            Unit::Named(name) => {
                let label = format!("{words}{symbol} ({name})").replace("  ", " ");
                Shown { factor: 1.0 / scale.divisor, label, short: format!("{symbol} ({name})") }
            }
            Unit::Over(name) => {
                let value = greatest.abs() / scale.divisor;
                let exponent = [0, 3, 6, 9, 12].into_iter().find(|&exponent| value * 10f64.powi(exponent) >= 0.05);
                let exponent = exponent.filter(|_| value > 0.0 && value.is_finite()).unwrap_or(0);
                let power = if exponent == 0 { String::new() } else { format!("10^{exponent} ") };
                let short = format!("{power}{symbol} / {name}");
                let label = if words.is_empty() { short.clone() } else { format!("{}, {short}", words.trim_end()) };
                Shown { factor: 10f64.powi(exponent) / scale.divisor, label, short }
            }
        }
    }
}

impl Shown {
    /// A number without unit, as it is.
    pub fn plain(label: &str) -> Self {
        Self { factor: 1.0, label: label.to_owned(), short: label.to_owned() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn case(units: &str) -> Case {
        let text = format!("{}\n{units}", include_str!("../../../fixtures/cases/ideal.toml"));
        Case::parse(&text, "case.toml", &[]).unwrap()
    }

    #[test]
    fn axes_are_normalised_unless_the_case_names_its_units() {
        let case = case("");
        let axes = Axes::of(&case, AxisUnits::Auto);
        assert_eq!(axes, Axes::of(&case, AxisUnits::Normalised));
        let force = axes.show(Dimension::Force, "normal force", "F_N", 150.0);
        assert_eq!(force.label, "normal force, 10^3 F_N / (E R^2)");
        assert!((force.factor * 200.0 - 1.0).abs() < 1e-12, "{force:?}");
        assert_eq!(axes.show(Dimension::Length, "", "δ_T", 0.5).label, "δ_T / R");
        assert_eq!(
            Axes::of(&case, AxisUnits::Case).show(Dimension::Stress, "pressure", "p", 1.0).label,
            "pressure p (case's unit of stress)"
        );
    }

    #[test]
    fn labels_name_the_units_and_change_no_number() {
        let case = case("[units]\nlength = \"mm\"\nforce = \"N\"");
        let axes = Axes::of(&case, AxisUnits::Auto);
        let length = axes.show(Dimension::Length, "indentation", "h", 1e-9);
        assert_eq!((length.factor, length.label.as_str(), length.short.as_str()), (1.0, "indentation h (mm)", "h (mm)"));
        assert_eq!(axes.show(Dimension::Force, "", "F", 1.0).label, "F (N)");
        assert!(axes.show(Dimension::Stress, "", "p", 1.0).label.contains("case's unit of stress"));
        assert_eq!(Axes::of(&case, AxisUnits::Normalised), Axes::normalised(case.sphere.radius, case.material.youngs_modulus));
    }
}

//! The hardening laws by name. What the case file calls them, which numbers they have there, and
//! the codes of kernels and exports are made from this table.

/// A hardening law, without its numbers. `shaders/material/hardening.wgsl` and the exports know it
/// by its [`code`](Self::code).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum HardeningLaw {
    /// Never yields.
    Elastic,
    /// sigma_Y.
    Ideal,
    /// sigma_Y + H alpha.
    Linear,
    /// sigma_Y + K alpha^n.
    Power,
    /// sigma_0 eps^(1/m).
    Hollomon,
    /// sigma_Y + (sigma_sat - sigma_Y)(1 - exp(-rate alpha)).
    Voce,
    /// Straight lines between points.
    Table,
}

/// A number of a hardening law.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HardeningParameter {
    /// Its key in a case file.
    pub key: &'static str,
    /// Whether it is a stress; it has no dimension otherwise.
    pub is_stress: bool,
}

const fn stress(key: &'static str) -> HardeningParameter {
    HardeningParameter { key, is_stress: true }
}

const fn number(key: &'static str) -> HardeningParameter {
    HardeningParameter { key, is_stress: false }
}

impl HardeningLaw {
    /// All of them, by their codes.
    pub const ALL: [Self; 7] = [Self::Elastic, Self::Ideal, Self::Linear, Self::Power, Self::Hollomon, Self::Voce, Self::Table];

    /// Their words, likewise.
    pub const WORDS: [&'static str; Self::ALL.len()] = {
        let mut words = [""; Self::ALL.len()];
        let mut i = 0;
        while i < words.len() {
            words[i] = Self::ALL[i].word();
            i += 1;
        }
        words
    };

    /// Its word in a case file.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Elastic => "elastic",
            Self::Ideal => "ideal",
            Self::Linear => "linear",
            Self::Power => "power",
            Self::Hollomon => "hollomon",
            Self::Voce => "voce",
            Self::Table => "table",
        }
    }

    /// Its number in kernels and exports.
    pub const fn code(self) -> u8 {
        self as u8
    }

    /// Its numbers, three at the most, in the order of the exports; a table has points instead.
    pub const fn parameters(self) -> &'static [HardeningParameter] {
        match self {
            Self::Elastic | Self::Table => &[],
            Self::Ideal => const { &[stress("yield_stress")] },
            Self::Linear => const { &[stress("yield_stress"), stress("modulus")] },
            Self::Power => const { &[stress("yield_stress"), stress("coefficient"), number("exponent")] },
            Self::Hollomon => const { &[stress("coefficient"), number("exponent")] },
            Self::Voce => const { &[stress("yield_stress"), stress("saturation_stress"), number("rate")] },
        }
    }
}

/// First yield of Hollomon's law, where sigma_0 eps^(1/m) meets Hooke's line: (sigma_0^m / E)^(1/(m
/// - 1)), written as E (sigma_0/E)^(m/(m - 1)), which does not overflow.
pub fn hollomon_yield_stress(coefficient: f64, exponent: f64, youngs_modulus: f64) -> f64 {
    youngs_modulus * (coefficient / youngs_modulus).powf(exponent / (exponent - 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_law_stands_at_its_code() {
        for (i, law) in HardeningLaw::ALL.into_iter().enumerate() {
            assert_eq!((usize::from(law.code()), law.word()), (i, HardeningLaw::WORDS[i]));
            assert!(law.parameters().len() <= 3);
        }
    }
}

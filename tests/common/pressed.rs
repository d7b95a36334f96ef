//! A soft sphere pressed deep on a few elements: what tests of the plate change.

/// The case file.
pub const CASE: &str = "
[sphere]
radius = 1.0
[material]
youngs_modulus = 1000.0
poissons_ratio = 0.3
[material.hardening]
law = \"ideal\"
yield_stress = 16.67
[contact]
friction = 0.3
[mesh]
elements_per_contact_radius = 5
[solver]
error_estimate = false
[[path]]
indentation = 0.09
";

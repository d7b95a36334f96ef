//! The `[material]` table, of the sphere and of another body.

use super::error::CaseError;
use super::reader::Reader;
use super::{Hardening, Material};

/// Radius and Young's modulus, in the units of the case: between these energies, of the order of E
/// R^3, are neither infinite nor nothing.
pub(super) const MAGNITUDES: std::ops::RangeInclusive<f64> = 1e-75..=1e75;

/// Reads the table.
pub(super) fn read_material(table: &Reader<'_>) -> Result<Material, CaseError> {
    table.only(&["youngs_modulus", "poissons_ratio", "hardening"])?;
    let (stress, ratio) = ("a stress > 0 (from 1e-75 to 1e75)", "a number > -1 and < 0.5");
    let youngs_modulus = table.require("youngs_modulus", stress)?.number(stress, |e| MAGNITUDES.contains(&e))?;
    let poissons_ratio = table.require("poissons_ratio", ratio)?.number(ratio, |nu| nu > -1.0 && nu < 0.5)?;
    let hardening = Hardening::read(&table.require_table("hardening", "a table with law")?, youngs_modulus)?;
    Ok(Material { youngs_modulus, poissons_ratio, hardening })
}

//! The `[opponent]` table: what stands against the body, and which bodies go together.

use std::ops::RangeInclusive;

use super::error::CaseError;
use super::material::{MAGNITUDES, read_material};
use super::reader::Reader;
use super::{Material, Opponent, Sphere};

/// Smallest radius of a rigid sphere over that of the body.
const SMALLEST_RIGID: f64 = 0.05;
/// Radii of another sphere that deforms over that of the body: both are meshed, with elements of
/// one size where they meet.
const DEFORMING_RATIOS: RangeInclusive<f64> = 0.1..=10.0;
/// Young's moduli of the opponent over that of the body: beyond, one of them is rigid.
const MODULUS_RATIOS: RangeInclusive<f64> = 1e-6..=1e6;

/// Reads what stands against the body. One that deforms is as large as the body without a radius,
/// and of the same material without one.
pub(super) fn read(root: &Reader<'_>, sphere: &Sphere, own: &Material) -> Result<Option<Opponent>, CaseError> {
    let opponent = read_table(root, sphere, own)?;
    check(sphere, own, opponent.as_ref(), root)?;
    Ok(opponent)
}

fn read_table(root: &Reader<'_>, sphere: &Sphere, own: &Material) -> Result<Option<Opponent>, CaseError> {
    let Some(field) = root.get("opponent") else { return Ok(None) };
    let table = field.table()?;
    table.only(&["equal", "rigid", "radius", "flat", "material"])?;
    let flag = |name| table.get(name).map_or(Ok(false), |field| field.boolean());
    let (equal, rigid, flat) = (flag("equal")?, flag("rigid")?, flag("flat")?);
    let length = "a length > 0 (from 1e-75 to 1e75)";
    let radius = table.get("radius").map(|field| field.number(length, |radius| MAGNITUDES.contains(&radius))).transpose()?;
    let material = table.get("material").map(|field| read_material(&field.table()?)).transpose()?;
    let refuse = |name: &str, what: &str, allowed: &str| {
        Err(table.get(name).map_or_else(|| table.refuse(what, allowed), |field| field.refuse(what, allowed)))
    };
    if equal && rigid {
        return Err(table.refuse("is both equal and rigid", "one of equal = true and rigid = true"));
    }
    if equal {
        let more = [("radius", radius.is_some()), ("flat", flat), ("material", material.is_some())];
        return match more.into_iter().find(|(_, there)| *there) {
            Some((name, _)) => {
                refuse(name, "stands beside equal = true, which says all", &format!("equal = true alone, or {name} without it"))
            }
            None => Ok(Some(Opponent::Equal)),
        };
    }
    if flat && radius.is_some() {
        return refuse("flat", "is true beside a radius", "one of flat = true and radius");
    }
    if flat && sphere.flat {
        return refuse("flat", "is true for both bodies", "flat = true for one of them");
    }
    if rigid {
        return match material {
            Some(_) => refuse("material", "stands beside rigid = true", "no material, or no rigid"),
            // Rigid without a radius: the plane.
            None => Ok(radius.map(|radius| Opponent::Rigid { radius })),
        };
    }
    if !flat && radius.is_none() && material.is_none() {
        return Ok(None);
    }
    Ok(Some(Opponent::Deforming {
        radius: if flat { None } else { Some(radius.unwrap_or(sphere.radius)) },
        material: material.unwrap_or_else(|| own.clone()),
    }))
}

/// Refuses bodies that do not go together.
fn check(sphere: &Sphere, own: &Material, opponent: Option<&Opponent>, root: &Reader<'_>) -> Result<(), CaseError> {
    let table = root.table("opponent")?;
    let ratio = |radius: f64| radius / sphere.radius;
    let refused = match (sphere.flat, opponent) {
        (true, None | Some(Opponent::Equal)) => {
            let allowed = "flat = true where the opponent is a sphere: [opponent] and its radius, rigid = true or a material";
            let field = root.table("sphere")?.get("flat");
            field.map(|field| field.refuse("is true, and a flat is pressed by a sphere alone", allowed))
        }
        (_, Some(&Opponent::Rigid { radius })) if !(ratio(radius) >= SMALLEST_RIGID) => {
            let least = SMALLEST_RIGID * sphere.radius;
            let allowed = format!("a length of at least {SMALLEST_RIGID} sphere.radius = {least:?}");
            table.get("radius").map(|field| field.refuse(&format!("is {radius:?}"), &allowed))
        }
        (_, Some(&Opponent::Deforming { radius: Some(radius), .. })) if !DEFORMING_RATIOS.contains(&ratio(radius)) => {
            let [low, high] = [DEFORMING_RATIOS.start(), DEFORMING_RATIOS.end()].map(|share| share * sphere.radius);
            let allowed = format!("a length from {low:?} to {high:?}, 0.1 to 10 sphere.radius; or flat = true");
            table.get("radius").map(|field| field.refuse(&format!("is {radius:?}"), &allowed))
        }
        (_, Some(Opponent::Deforming { material, .. }))
            if !MODULUS_RATIOS.contains(&(material.youngs_modulus / own.youngs_modulus)) =>
        {
            let allowed = "a stress from 1e-6 to 1e6 times material.youngs_modulus; beyond that one of the bodies is rigid";
            let field = table.table("material")?.get("youngs_modulus");
            field.map(|field| field.refuse(&format!("is {:?}", material.youngs_modulus), allowed))
        }
        _ => None,
    };
    refused.map_or(Ok(()), Err)
}

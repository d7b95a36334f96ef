//! What is allowed in a case and yet no known material or contact has: most often two systems of
//! units in one file.
//!
//! A case has no units, so it is ratios that are looked at. The limits leave room beyond everything
//! that is known: a doubt is a note, and computes what it is told.

use std::fmt;

use super::{Case, Friction, Hardening, Material, Opponent, Segment, ShearTarget};
use crate::analytical::ElasticSphere;
use crate::analytical::yielding::{critical_indentation, first_yield};

/// E/sigma_Y. Diamond and silica glass have about 10, annealed pure metals up to 10,000; with E in
/// MPa and sigma_Y in GPa a steel has 500,000.
const YIELD_RATIOS: [f64; 2] = [8.0, 50_000.0];
/// Where hardening at a plastic strain of 1 adds no more than this share of sigma_Y, it is as good
/// as none; annealed metals add 1 to 30 times sigma_Y.
const LEAST_HARDENING: f64 = 5e-3;
/// Saturation stress, or the last of a table, over sigma_Y; annealed pure metals have up to 30.
const MOST_HARDENING: f64 = 200.0;
/// Voce's rate, per unit of plastic strain; metals have 1 to 300.
const RATES: [f64; 2] = [0.01, 1e4];
/// Plastic strain of a table's last point: beyond it, it is probably in per cent.
const LARGEST_STRAIN: f64 = 10.0;
/// Ratio of two moduli from which the stiffer body is as good as rigid, and of two radii from which
/// the larger one is as good as flat.
const CONTRAST: f64 = 1000.0;
/// Coefficients of friction of clean metals in vacuum and of rubber stay below.
const LARGEST_FRICTION: f64 = 4.0;
/// Of the indentation of first yield, by the closed form; and of the radius: what is less was
/// pressed to less than any indentation that is allowed, over 1000.
const BELOW_YIELD: f64 = 0.5;
const SHALLOW: f64 = 3e-4;
/// Of the greatest indentation: even a contact that is about to slip everywhere is sheared further.
const SHORTEST_SHEAR: f64 = 1e-3;
/// Young's modulus in Pa, where the case names its unit of stress: from gels to diamond.
const MODULI: [f64; 2] = [1e3, 2e12];
const PASCALS: [(&str, f64); 10] = [
    ("Pa", 1.0),
    ("kPa", 1e3),
    ("MPa", 1e6),
    ("GPa", 1e9),
    ("N/m^2", 1.0),
    ("N/mm^2", 1e6),
    ("N/mm2", 1e6),
    ("N/mm²", 1e6),
    ("psi", 6894.757),
    ("ksi", 6.894757e6),
];

/// Something in a case that is allowed, and probably not meant.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Doubt {
    /// The key to look at.
    pub key: String,
    /// What is odd about its value, and what may be wrong.
    pub what: String,
}

impl fmt::Display for Doubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.key, self.what)
    }
}

impl Case {
    /// What is odd about the case, if anything: for a note, not a refusal.
    pub fn doubts(&self) -> Vec<Doubt> {
        let mut doubts = Vec::new();
        of_material("material", &self.material, &mut doubts);
        self.of_units(&mut doubts);
        self.of_opponent(&mut doubts);
        if let Friction::Coefficient(mu) = self.contact.friction
            && mu > LARGEST_FRICTION
        {
            let what = format!("is {mu:?}, above that of any known pair; it is a ratio of forces, neither an angle nor per cent");
            doubts.push(Doubt { key: "contact.friction".to_owned(), what });
        }
        self.of_path(&mut doubts);
        doubts
    }

    fn of_units(&self, doubts: &mut Vec<Doubt>) {
        let Some(label) = &self.units.stress else { return };
        let Some((_, pascals)) = PASCALS.iter().find(|(name, _)| name == label) else { return };
        let modulus = self.material.youngs_modulus;
        if !within(modulus * pascals, MODULI) {
            let what =
                format!("is {modulus:?} {label}, and known solids have {} to {} Pa; check units.stress", MODULI[0], MODULI[1]);
            doubts.push(Doubt { key: "material.youngs_modulus".to_owned(), what });
        }
    }

    fn of_opponent(&self, doubts: &mut Vec<Doubt>) {
        let radius = match &self.opponent {
            Some(Opponent::Deforming { radius, material }) => {
                of_material("opponent.material", material, doubts);
                let contrast = material.youngs_modulus / self.material.youngs_modulus;
                if !within(contrast, [1.0 / CONTRAST, CONTRAST]) {
                    let what = format!(
                        "is {contrast:.3e} times that of the sphere: the stiffer body is then as good as rigid. Check that both are in one unit"
                    );
                    doubts.push(Doubt { key: "opponent.material.youngs_modulus".to_owned(), what });
                }
                *radius
            }
            Some(Opponent::Rigid { radius }) => Some(*radius),
            None | Some(Opponent::Equal) => None,
        };
        if let Some(radius) = radius
            && !within(radius / self.sphere.radius, [1.0 / CONTRAST, CONTRAST])
        {
            let ratio = radius / self.sphere.radius;
            let what = format!(
                "is {ratio:.3e} times that of the sphere: the larger one is then as good as flat. Check that both are in one unit"
            );
            doubts.push(Doubt { key: "opponent.radius".to_owned(), what });
        }
    }

    fn of_path(&self, doubts: &mut Vec<Doubt>) {
        let Some((at, deepest)) = self.deepest_press() else { return };
        // Of a pair, the closed form knows one body alone; two give way to more.
        if let (Some(yield_stress), None) = (self.material.hardening.yield_stress(self.material.youngs_modulus), &self.opponent) {
            let Material { youngs_modulus, poissons_ratio, .. } = self.material;
            let sphere = ElasticSphere { radius: self.sphere.radius, youngs_modulus, poissons_ratio };
            let first = critical_indentation(&sphere, yield_stress, first_yield(poissons_ratio.max(0.0)).pressure_ratio);
            if deepest < (BELOW_YIELD * first).min(SHALLOW * self.sphere.radius) {
                let what = format!(
                    "is {deepest:?}, the greatest of the path, and the sphere yields first at about {first:.3e}: it stays elastic. \
                     Check that h and radius are in one unit"
                );
                doubts.push(Doubt { key: format!("path.{at}.indentation"), what });
            }
        }
        let shears = self.path.iter().enumerate().filter_map(|(i, segment)| match *segment {
            Segment::Oblique { shear, .. } | Segment::Shear { shear: ShearTarget::Displacement(shear), .. } => {
                Some((i, shear.abs()))
            }
            Segment::Motion { to, .. } => to.shear.map(|[x, y]| (i, x.hypot(y))),
            _ => None,
        });
        let furthest = shears.reduce(|most, next| if next.1 > most.1 { next } else { most });
        let to_slip = self
            .path
            .iter()
            .any(|segment| matches!(segment, Segment::Shear { shear: ShearTarget::FullSlip, .. } | Segment::Slip { .. }));
        if let Some((at, shear)) = furthest.filter(|&(_, shear)| shear > 0.0 && shear < SHORTEST_SHEAR * deepest && !to_slip) {
            let what = format!(
                "is {shear:?}, the furthest of the path, and the sphere is pressed to {deepest:?}: next to nothing slips. \
                 Check that both are in one unit"
            );
            doubts.push(Doubt { key: format!("path.{at}.shear"), what });
        }
    }
}

fn within(ratio: f64, [least, most]: [f64; 2]) -> bool {
    (least..=most).contains(&ratio)
}

/// A material in the table of this name.
fn of_material(table: &str, material: &Material, doubts: &mut Vec<Doubt>) {
    let (modulus, law) = (material.youngs_modulus, &material.hardening);
    let mut doubt = |key: &str, what: String| doubts.push(Doubt { key: format!("{table}.hardening.{key}"), what });
    let Some(yield_stress) = law.yield_stress(modulus) else { return };
    let ratio = modulus / yield_stress;
    if !within(ratio, YIELD_RATIOS) {
        let what = format!(
            "puts E/sigma_Y at {ratio:.3e}; known materials have 10 to 10,000. Check that youngs_modulus and the stresses are in one unit"
        );
        doubt(law.yield_key(), what);
    }
    let Some((key, strength)) = law.strength(yield_stress) else { return };
    if strength > modulus {
        doubt(
            key,
            format!(
                "takes the flow stress to {strength:.3e}, above Young's modulus {modulus:?}. Check that both are in one unit"
            ),
        );
    }
    let added = strength / yield_stress - 1.0;
    if matches!(law, Hardening::Linear { .. } | Hardening::Power { .. }) && added > 0.0 && added < LEAST_HARDENING {
        let what = format!(
            "adds {added:.1e} of the yield stress at a plastic strain of 1: as good as law = \"ideal\". Check that both are in one unit"
        );
        doubt(key, what);
    }
    if matches!(law, Hardening::Voce { .. } | Hardening::Table { .. }) && added > MOST_HARDENING {
        let what =
            format!("is {:.3e} times the yield stress; metals have up to 30. Check that both are in one unit", added + 1.0);
        doubt(key, what);
    }
    match law {
        Hardening::Voce { rate, .. } if !within(*rate, RATES) => {
            doubt("rate", format!("is {rate:?} per unit of plastic strain; metals have 1 to 300. The strain is not in per cent"));
        }
        Hardening::Table { points } if points.last().is_some_and(|point| point[0] > LARGEST_STRAIN) => {
            doubt("points", "go beyond a plastic strain of 10, that is 1000 %. The strain is not in per cent".to_owned());
        }
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CASE: &str = "[sphere]\nradius = 1.0\n[material]\nyoungs_modulus = 210e3\npoissons_ratio = 0.3\n[material.hardening]\nlaw = \"ideal\"\n\
                        yield_stress = 400.0\n[contact]\nfriction = 0.3\n[[path]]\nindentation = 0.02\n[[path]]\nshear = 0.003\n";

    fn keys(sets: &[&str]) -> Vec<String> {
        let sets: Vec<String> = sets.iter().map(|set| (*set).to_owned()).collect();
        let case = Case::parse(CASE, "case.toml", &sets).unwrap_or_else(|error| panic!("{sets:?}: {error}"));
        case.doubts().into_iter().map(|doubt| doubt.key).collect()
    }

    #[test]
    fn units_that_do_not_fit_together_are_noticed() {
        for (sets, key) in [
            (&["material.hardening.yield_stress=0.4"][..], "material.hardening.yield_stress"),
            (&["material.hardening.yield_stress=30e3"], "material.hardening.yield_stress"),
            (&["material.hardening={law=\"linear\",yield_stress=400.0,modulus=1.0}"], "material.hardening.modulus"),
            (&["material.hardening={law=\"linear\",yield_stress=400.0,modulus=300e3}"], "material.hardening.modulus"),
            (
                &["material.hardening={law=\"power\",yield_stress=400.0,coefficient=0.6,exponent=0.3}"],
                "material.hardening.coefficient",
            ),
            (&["material.hardening={law=\"hollomon\",coefficient=0.9,exponent=5.0}"], "material.hardening.coefficient"),
            (
                &["material.hardening={law=\"voce\",yield_stress=50.0,saturation_stress=40e3,rate=10.0}"],
                "material.hardening.saturation_stress",
            ),
            (
                &["material.hardening={law=\"voce\",yield_stress=200.0,saturation_stress=400.0,rate=1e-3}"],
                "material.hardening.rate",
            ),
            (&["material.hardening={law=\"table\",points=[[0.0,400.0],[20.0,700.0]]}"], "material.hardening.points"),
            (&["material.hardening={law=\"table\",points=[[0.0,0.4],[0.2,0.7]]}"], "material.hardening.points"),
            (&["contact.friction=30"], "contact.friction"),
            (&["path=[{indentation=2e-6}]"], "path.0.indentation"),
            (&["path=[{indentation=0.02},{shear=3e-6}]"], "path.1.shear"),
            (&["opponent={rigid=true,radius=2000.0}"], "opponent.radius"),
            (
                &[
                    "opponent={radius=2.0,material={youngs_modulus=70.0,poissons_ratio=0.3,hardening={law=\"ideal\",yield_stress=0.1}}}",
                ],
                "opponent.material.youngs_modulus",
            ),
            (
                &[
                    "opponent={radius=2.0,material={youngs_modulus=70e3,poissons_ratio=0.3,hardening={law=\"ideal\",yield_stress=0.1}}}",
                ],
                "opponent.material.hardening.yield_stress",
            ),
            (&["units.stress=GPa"], "material.youngs_modulus"),
            (
                &["units.stress=Pa", "material={youngs_modulus=210.0,poissons_ratio=0.3,hardening={law=\"elastic\"}}"],
                "material.youngs_modulus",
            ),
        ] {
            assert_eq!(keys(sets), [key], "{sets:?}");
        }
    }

    #[test]
    fn materials_that_there_are_raise_no_doubt() {
        for [modulus, stress] in [
            [210e3, 400.0],
            [210e9, 2.5e9],
            [210.0, 0.25],
            [120e3, 33.0],
            [70e3, 7.0],
            [3e3, 60.0],
            [1140e3, 95e3],
            [16e3, 5.0],
            [410e3, 750.0],
        ] {
            let material = format!(
                "material={{youngs_modulus={modulus:?},poissons_ratio=0.3,hardening={{law=\"ideal\",yield_stress={stress:?}}}}}"
            );
            assert!(keys(&[&material]).is_empty(), "{material}");
        }
        for sets in [
            &["material.hardening={law=\"elastic\"}", "path=[{indentation=1e-6}]"][..],
            &["material.hardening={law=\"voce\",yield_stress=10.0,saturation_stress=210.0,rate=20.0}"],
            &["material.hardening={law=\"linear\",yield_stress=400.0,modulus=2000.0}"],
            &["material.hardening={law=\"power\",yield_stress=60.0,coefficient=530.0,exponent=0.4}"],
            &["contact.friction=1.5"],
            &["contact.friction=0"],
            &["units.stress=MPa"],
            &["units.stress=bananas"],
            &["path=[{indentation=0.02},{shear=1e-6},{shear=\"full-slip\"}]"],
        ] {
            assert!(keys(sets).is_empty(), "{sets:?}: {:?}", keys(sets));
        }
    }

    /// Every case of the repository that a user may look at.
    #[test]
    fn the_fixtures_raise_no_doubt() {
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/cases");
        let mut cases = 0;
        for entry in std::fs::read_dir(&folder).expect("the fixtures") {
            let path = entry.expect("an entry").path();
            if path.extension().is_some_and(|ending| ending == "toml") {
                let case = Case::load(&path, &[]).unwrap_or_else(|error| panic!("{error}"));
                assert_eq!(case.doubts(), [], "{}", path.display());
                cases += 1;
            }
        }
        assert!(cases > 5, "{cases}");
        assert_eq!(Case::parse(&crate::case::starter_case("ideal", "case.toml"), "starter", &[]).expect("a case").doubts(), []);
    }
}

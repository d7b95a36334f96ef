//! Every key of a case file in one table: what it means, its unit, its range and its default.
//!
//! `asperity explain`, `asperity init` and `asperity schema` are made from [`KEYS`]. The tests
//! below hold it against the parser: a key that one of the two lacks fails them.

use Kind::{Components, Material, Number, Points, ShareOrTrue, Text, Truth, Whole, Word};
use Limit::{Above, AtLeast, AtMost, Free};
use Presence::{Defaults, Optional, Required};

use crate::material::HardeningLaw;
use crate::mesh::{FINE_ZONES, FIRST_LAYERS};

/// One key of a case file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Key {
    /// The table in which it stands, dotted; `path` is an array of tables.
    pub table: &'static str,
    /// Its name in that table.
    pub name: &'static str,
    /// What its value is.
    pub kind: Kind,
    /// The unit of its value; empty where it has none.
    pub unit: &'static str,
    /// Whether it has to be there.
    pub presence: Presence,
    /// What its value may be, in words.
    pub range: &'static str,
    /// What it means.
    pub meaning: &'static str,
    /// The hardening laws that take it; empty for all.
    pub laws: &'static [&'static str],
    /// A value that fits the other examples, as TOML.
    pub example: &'static str,
}

/// What a value is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// A number between limits, or one of some words in its place.
    Number(Limit, Limit, &'static [&'static str]),
    /// A whole number from the first to the second.
    Whole(u32, u32),
    /// True or false.
    Truth,
    /// True, or a number between 0 and 1.
    ShareOrTrue,
    /// One of some words.
    Word(&'static [&'static str]),
    /// Any text of the range that the key gives.
    Text,
    /// A number, two of them, or one of some words in their place.
    Components(&'static [&'static str]),
    /// Pairs of numbers.
    Points,
    /// A table with the keys of `[material]`, and below it those of its hardening.
    Material,
}

/// A limit that does not depend on other keys.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Limit {
    /// There is none.
    Free,
    /// This or more.
    AtLeast(f64),
    /// This or less.
    AtMost(f64),
    /// More than this as a lower limit, less as an upper one.
    Above(f64),
}

/// Whether a key has to be there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Presence {
    /// There is no case without it.
    Required,
    /// Without it, this value, as TOML.
    Defaults(&'static str),
    /// Without it, what these words say.
    Optional(&'static str),
}

impl Key {
    /// The key as `--set` and errors name it, `N` for the number of a segment.
    pub fn dotted(&self) -> String {
        let index = if self.table == "path" { ".N" } else { "" };
        format!("{}{index}.{}", self.table, self.name)
    }

    /// Whether a case with this hardening law takes the key.
    pub fn fits(&self, law: &str) -> bool {
        self.laws.is_empty() || self.laws.contains(&law)
    }
}

/// The tables of a case file in the order in which they are written, with what each is about.
pub const TABLES: [(&str, &str); 10] = [
    ("sphere", "the body"),
    ("material", "what the body is made of"),
    ("material.hardening", "yield stress as a function of the equivalent plastic strain alpha"),
    ("contact", "how the sphere meets the plane"),
    ("opponent", "what the sphere is pressed onto, if not a rigid plane"),
    ("mesh", "how finely the bodies are meshed; every key is optional"),
    ("solver", "how the equations are solved; every key is optional"),
    ("output", "what is written besides history and summary; every key is optional"),
    ("units", "units on the axes of pictures, which are normalised without them; results do not change"),
    ("path", "the segments, followed in order; the first one presses"),
];

/// The words of `material.hardening.law`.
pub const LAWS: [&str; HardeningLaw::ALL.len()] = HardeningLaw::WORDS;

const UNIT_LABEL: &str = "1 to 16 letters";
const STRESS: &str = "stress";
const LENGTH: &str = "length";

/// A key without a unit that every law takes.
const fn key(table: &'static str, name: &'static str, kind: Kind, presence: Presence) -> Key {
    Key { table, name, kind, unit: "", presence, range: "", meaning: "", laws: &[], example: "" }
}

const fn hardening(name: &'static str, laws: &'static [&'static str]) -> Key {
    Key { unit: STRESS, laws, ..key("material.hardening", name, Number(Above(0.0), Free, &[]), Required) }
}

/// Every key, table by table.
pub const KEYS: &[Key] = &[
    Key {
        unit: LENGTH,
        range: "> 0, from 1e-75 to 1e75",
        meaning: "radius R of the sphere; it sets the unit of length",
        example: "1.0",
        ..key("sphere", "radius", Number(AtLeast(1e-75), AtMost(1e75), &[]), Required)
    },
    Key {
        range: "true (with a sphere as the opponent) or false",
        meaning: "the body is a flat, not a sphere: half a ball of radius 2 R, pressed on its flat face; R is still the unit \
                  of length",
        example: "true",
        ..key("sphere", "flat", Truth, Optional("a sphere"))
    },
    Key {
        range: "\"clamped\" or \"free\"",
        meaning: "whether the equatorial plane may widen. Clamped, it moves as a rigid plate; free, it widens under load, as \
                  does the mid-plane of a sphere pressed equally from both sides; refused for a flat and where two bodies are \
                  meshed",
        example: "\"free\"",
        ..key("sphere", "equator", Word(&["clamped", "free"]), Defaults("\"clamped\""))
    },
    Key {
        unit: STRESS,
        range: "> 0, from 1e-75 to 1e75",
        meaning: "Young's modulus E; it sets the unit of stress, and forces are stress times length squared",
        example: "200e3",
        ..key("material", "youngs_modulus", Number(AtLeast(1e-75), AtMost(1e75), &[]), Required)
    },
    Key {
        range: "> -1 and < 0.5",
        meaning: "Poisson's ratio nu; above 0.45 runs take longer, at 0.499 twenty times as long",
        example: "0.3",
        ..key("material", "poissons_ratio", Number(Above(-1.0), Above(0.5), &[]), Required)
    },
    Key {
        range: "\"elastic\", \"ideal\", \"linear\", \"power\", \"hollomon\", \"voce\" or \"table\"",
        meaning: "hardening law; it decides which other keys this table has",
        example: "\"ideal\"",
        ..key("material.hardening", "law", Word(&LAWS), Required)
    },
    Key {
        range: "1e-7 E to 0.2 E",
        meaning: "stress sigma_Y at first yield",
        example: "400.0",
        ..hardening("yield_stress", &["ideal", "linear", "power", "voce"])
    },
    Key {
        range: "> 0, at most the stress of the first point",
        meaning: "stress at alpha = 0, if the first point is at alpha > 0",
        presence: Optional("the points begin at alpha = 0"),
        example: "400.0",
        ..hardening("yield_stress", &["table"])
    },
    Key {
        range: ">= 0",
        meaning: "hardening modulus H in sigma_Y + H alpha",
        kind: Number(AtLeast(0.0), Free, &[]),
        example: "2000.0",
        ..hardening("modulus", &["linear"])
    },
    Key {
        range: ">= 0",
        meaning: "K in sigma_Y + K alpha^n",
        kind: Number(AtLeast(0.0), Free, &[]),
        example: "1000.0",
        ..hardening("coefficient", &["power"])
    },
    Key {
        unit: "",
        range: "> 0 and <= 1",
        meaning: "n in sigma_Y + K alpha^n",
        kind: Number(Above(0.0), AtMost(1.0), &[]),
        example: "0.4",
        ..hardening("exponent", &["power"])
    },
    Key {
        range: "> 0, such that (sigma_0^m/E)^(1/(m-1)) is from 1e-7 E to 0.2 E",
        meaning: "sigma_0 in sigma = sigma_0 eps^(1/m), eps the total strain; first yield is where this meets Hooke's line",
        example: "1000.0",
        ..hardening("coefficient", &["hollomon"])
    },
    Key {
        unit: "",
        range: "> 1",
        meaning: "m in sigma = sigma_0 eps^(1/m)",
        kind: Number(Above(1.0), Free, &[]),
        example: "5.0",
        ..hardening("exponent", &["hollomon"])
    },
    Key {
        range: ">= yield_stress",
        meaning: "sigma_inf in sigma_Y + (sigma_inf - sigma_Y) (1 - exp(-k alpha))",
        example: "700.0",
        ..hardening("saturation_stress", &["voce"])
    },
    Key {
        unit: "",
        range: "> 0",
        meaning: "k in sigma_Y + (sigma_inf - sigma_Y) (1 - exp(-k alpha)), per unit of plastic strain",
        example: "20.0",
        ..hardening("rate", &["voce"])
    },
    Key {
        unit: "pairs of a strain and a stress",
        range: "alpha >= 0 and rising, from 0 unless yield_stress is given; stress > 0 and never falling",
        meaning: "points [alpha, stress], joined by straight lines; constant after the last",
        kind: Points,
        example: "[[0.0, 400.0], [0.05, 550.0], [0.3, 700.0]]",
        ..hardening("points", &["table"])
    },
    Key {
        range: ">= 0, or \"stick\"",
        meaning: "Coulomb's coefficient mu, which holds at every point; with \"stick\", points do not slip; only if a step does \
                  not converge may some of them slide",
        example: "0.3",
        ..key("contact", "friction", Number(AtLeast(0.0), Free, &["stick"]), Required)
    },
    Key {
        range: "true or false",
        meaning: "press onto an equal sphere. Displacements and angles in the case and in the results are then relative, those \
                  of one equator with respect to the other: twice those of each sphere if the two move symmetrically (by the \
                  same amount in opposite directions). Both spheres are meshed if the path includes a roll about y, or if it \
                  combines a twist or roll with a shear that has a component along y; otherwise only one is meshed",
        example: "true",
        ..key("opponent", "equal", Truth, Optional("a rigid plane"))
    },
    Key {
        range: "true or false; equal and rigid cannot both be true",
        meaning: "press onto a rigid sphere of the given radius; without a radius, onto the rigid plane",
        example: "true",
        ..key("opponent", "rigid", Truth, Optional("a rigid plane"))
    },
    Key {
        unit: LENGTH,
        range: ">= 0.05 R if the opponent is rigid, else 0.1 R to 10 R",
        meaning: "radius of the opposing sphere; h must stay below 0.3 R* and 0.3 R, with 1/R* = 1/R + 1/radius, or R* = \
                  radius if the body is a flat",
        example: "2.0",
        ..key(
            "opponent",
            "radius",
            Number(AtLeast(1e-75), AtMost(1e75), &[]),
            Optional("as large as the sphere if the opponent has a material, else a rigid plane"),
        )
    },
    Key {
        range: "true (without a radius, and with a sphere as the body) or false",
        meaning: "the opponent is a deformable flat, half a ball of radius 2 R; with rigid = true, it is the rigid plane",
        example: "true",
        ..key("opponent", "flat", Truth, Optional("a sphere if there is a radius or a material, else a rigid plane"))
    },
    Key {
        range: "a table with the keys of [material]; Young's modulus 1e-6 to 1e6 times that of the body",
        meaning: "material of the opponent, which then deforms and is meshed like the body; h and delta_T become relative \
                  displacements",
        example: "{ youngs_modulus = 400e3, poissons_ratio = 0.3, hardening = { law = \"elastic\" } }",
        ..key(
            "opponent",
            "material",
            Material,
            Optional("the body's own, if the opponent is not rigid and either has a radius or is a flat"),
        )
    },
    Key {
        range: "4 to 32",
        meaning: "number of elements along the contact radius. If only this number is given, it applies at the surface too; a \
                  value of 8 then makes a quick run. The computing time grows as the 2.5th power of this number",
        example: "10",
        ..key("mesh", "elements_per_contact_radius", Whole(4, 32), Defaults("10"))
    },
    Key {
        range: "1, 2, 4 or 8 times elements_per_contact_radius, at most 64",
        meaning: "number of elements along the contact radius at the surface, where elements are halved in all directions \
                  up to three times; the accuracy of F_T depends mainly on it",
        example: "20",
        ..key(
            "mesh",
            "surface_elements_per_contact_radius",
            Whole(4, 64),
            Optional("20; if elements_per_contact_radius is given, the same number"),
        )
    },
    Key {
        range: "0.5 to 1.5",
        meaning: "thickness of the first layer of elements under the contact, as a multiple of their width there",
        example: "0.85",
        ..key(
            "mesh",
            "first_layer_thickness",
            Number(AtLeast(*FIRST_LAYERS.start()), AtMost(*FIRST_LAYERS.end()), &[]),
            Optional("0.85 where the elements at the surface are halved, else 1"),
        )
    },
    Key {
        range: "1.1 to 3",
        meaning: "radius of the finely meshed zone as a multiple of contact_radius; if the contact grows beyond the zone, \
                  the run starts over with a larger one",
        example: "1.3",
        ..key("mesh", "fine_zone", Number(AtLeast(*FINE_ZONES.start()), AtMost(*FINE_ZONES.end()), &[]), Defaults("1.3"))
    },
    Key {
        unit: LENGTH,
        range: "0.0005 R to 0.65 R",
        meaning: "expected contact radius, for which the mesh is made",
        example: "0.2",
        ..key("mesh", "contact_radius", Number(Above(0.0), Free, &[]), Optional("the one that closed forms predict"))
    },
    Key {
        range: "\"multigrid\" or \"direct\"",
        meaning: "solver of the linear systems: FGMRES with multigrid, or a sparse direct factorisation, which is slower",
        example: "\"multigrid\"",
        ..key("solver", "linear", Word(&["multigrid", "direct"]), Defaults("\"multigrid\""))
    },
    Key {
        unit: "share of the normal force",
        range: "> 1e-12 and <= 1e-2",
        meaning: "residual at which a step is accepted; at 1e-3, F_T is off by up to 1.5 % in single steps after the path \
                  changes direction",
        example: "1e-4",
        ..key("solver", "tolerance", Number(Above(1e-12), AtMost(1e-2), &[]), Defaults("1e-4"))
    },
    Key {
        range: "1 to 100000",
        meaning: "number of load steps of a press from first touch; a later press that goes deeper, from h_1 to h, gets the \
                  share (h - h_1)/h of these steps, plus two",
        example: "26",
        ..key("solver", "press_steps", Whole(1, 100_000), Optional("set by the mesh, 25 on the default one"))
    },
    Key {
        range: "1 to 100000",
        meaning: "number of steps in the first part of a shear, while slip spreads over the contact. Their length grows from \
                  step to step; later steps are at least as long as the last of these",
        example: "24",
        ..key("solver", "shear_steps", Whole(1, 100_000), Optional("24"))
    },
    Key {
        range: "1 to 1000",
        meaning: "Newton iterations of a step before it is cut in half; if set to 10 or more, a step that is \
                  converging fast may take up to twice as many",
        example: "25",
        ..key("solver", "max_iterations", Whole(1, 1000), Defaults("25"))
    },
    Key {
        range: "0 to 30",
        meaning: "how often a step may be cut in half before the run ends as not converged",
        example: "8",
        ..key("solver", "max_cutbacks", Whole(0, 30), Defaults("8"))
    },
    Key {
        range: "true or false",
        meaning: "whether a coarser run is made first, in an eighth of the time. The coarser run gives the extrapolated limits \
                  and the error estimates, and shows how large the contact becomes, so that the mesh fits. A study makes this \
                  run only if its base sets this key",
        example: "true",
        ..key("solver", "error_estimate", Truth, Defaults("true"))
    },
    Key {
        unit: "GiB",
        range: "> 0",
        meaning: "memory that the mesh and the linear systems may take; a case that needs more is refused before it runs. A \
                  value given here replaces the limit that the system reports. Without this key, and if the system reports \
                  none, the limit is 8 GiB",
        example: "8.0",
        ..key("solver", "max_memory_gib", Number(Above(0.0), Free, &[]), Optional(ROOM))
    },
    Key {
        range: "\"none\", \"contact\", \"segments\" or \"all\"",
        meaning: "which fields (fields/*.vtu) and contact tables (contact/*.csv) are written. \"none\": neither; \"contact\": \
                  contact tables after the last step of each segment; \"segments\": both, after the last step of each \
                  segment; \"all\": both, after every step. If plots are on, \"contact\" and \"segments\" add contact tables \
                  of up to four steps of the first shear, for plots/slip.svg. In a study the default is \"contact\"",
        example: "\"segments\"",
        ..key("output", "fields", Word(&["none", "contact", "segments", "all"]), Defaults("\"segments\""))
    },
    Key {
        range: "true or false",
        meaning: "whether the pictures in plots are drawn; a study draws them only if its base sets this key",
        example: "true",
        ..key("output", "plots", Truth, Defaults("true"))
    },
    Key {
        range: "\"svg\", \"pdf\" or \"png\"",
        meaning: "format of the pictures; a PNG has 300 pixels per inch, but if plot_width is in px, it is that many \
                  pixels wide",
        example: "\"svg\"",
        ..key("output", "plot_format", Word(&["svg", "pdf", "png"]), Optional("svg"))
    },
    Key {
        range: "60 to 10000 px, given in mm, cm, in, pt or px, such as \"85mm\"",
        meaning: "width of the pictures; each is laid out anew, so that its text has the same size at any width",
        example: "\"85mm\"",
        ..key("output", "plot_width", Text, Optional("each has a width of its own"))
    },
    Key {
        range: "true or false",
        meaning: "whether history.parquet is written beside history.csv when the run ends",
        example: "false",
        ..key("output", "parquet", Truth, Optional("history.csv alone"))
    },
    Key {
        range: "true or false",
        meaning: "whether checkpoint.bin (about 1 kB for each element) is kept after the run, so that run --extend can \
                  continue along a longer path; a study never keeps it",
        example: "true",
        ..key("output", "keep_checkpoint", Truth, Optional("it is kept"))
    },
    Key {
        range: UNIT_LABEL,
        meaning: "unit of the radius and of displacements, as in \"mm\"",
        example: "\"mm\"",
        ..key("units", "length", Text, Optional("normalised if no unit is named; \"case's unit of length\" if only others are"))
    },
    Key {
        range: UNIT_LABEL,
        meaning: "unit of forces, as in \"N\"",
        example: "\"N\"",
        ..key("units", "force", Text, Optional("normalised if no unit is named; \"case's unit of force\" if only others are"))
    },
    Key {
        range: UNIT_LABEL,
        meaning: "unit of Young's modulus and of pressures, as in \"MPa\"",
        example: "\"MPa\"",
        ..key("units", "stress", Text, Optional("normalised if no unit is named; \"case's unit of stress\" if only others are"))
    },
    Key {
        unit: LENGTH,
        range: ">= 0; the first press > 0; < 0.3 R, on an unequal sphere < 0.3 R* too; the deepest of the path >= 2.5e-7 \
                R^2/R*",
        meaning: "press to this indentation h, counted from first touch, or unload to it if it is smaller than the present \
                  h",
        example: "0.02",
        ..key("path", "indentation", Number(AtLeast(0.0), Free, &[]), Optional("the segment shears, turns or releases"))
    },
    Key {
        unit: LENGTH,
        range: "-0.5 R to 0.5 R (here R is the smaller of two radii), [x, y] of such lengths, or \"full-slip\"",
        meaning: "shear to this total delta_T, of either sign. One number is along x, and y stays as it is. With [x, y] \
                  the shear has both components, and the hemisphere is meshed instead of its half y >= 0. With \"full-slip\" \
                  the shear continues until points that stick carry at most 0.2 % of F_N and F_T no longer rises",
        example: "\"full-slip\"",
        ..key("path", "shear", Components(&["full-slip"]), Optional("the segment presses, turns or releases"))
    },
    Key {
        unit: "degrees",
        range: "-360 to 360",
        meaning: "direction of shear, as an angle from x towards y: a length in shear is that of the whole vector delta_T, \
                  which then points in this direction; \"full-slip\" goes on from where the plate is",
        example: "30.0",
        ..key(
            "path",
            "shear_direction",
            Number(AtLeast(-360.0), AtMost(360.0), &[]),
            Optional("shear is along x, or has two components"),
        )
    },
    Key {
        unit: "rad",
        range: "-100 to 100",
        meaning: "twist the sphere about the normal to this total angle, of either sign; the hemisphere is then meshed, not \
                  half of it",
        example: "0.05",
        ..key("path", "twist", Number(AtLeast(-100.0), AtMost(100.0), &[]), Optional("the sphere does not turn about the normal"))
    },
    Key {
        unit: "rad",
        range: "-0.5 to 0.5, or [about_x, about_y] of such angles",
        meaning: "roll the sphere to this total angle about y, of either sign, or to two angles about x and y, for \
                  which the hemisphere is meshed, not half of it; the centre travels by (R - h) times the angle, and \
                  the plate with it, so that delta_T does not change; refused for a flat and under full stick",
        example: "0.02",
        ..key("path", "roll", Components(&[]), Optional("the sphere does not roll"))
    },
    Key {
        range: "\"indentation\" or \"normal-force\"",
        meaning: "what a shear, twist or roll keeps constant: h or F_N",
        example: "\"indentation\"",
        ..key("path", "hold", Word(&["indentation", "normal-force"]), Defaults("\"indentation\""))
    },
    Key {
        range: "true, or a share between 0 and 1",
        meaning: "unload until contact is lost, or until F_N has fallen to this share of its value at the start of the \
                  segment; delta_T and the angles do not change",
        example: "true",
        ..key("path", "release", ShareOrTrue, Optional("the segment presses or shears"))
    },
];

/// What stands for `solver.max_memory_gib`.
const ROOM: &str = "what the process may use (machine, container, job, ulimit -v), less a tenth and 64 MiB";

/// The keys that a dotted name may mean: all of it, `path.0.shear` for any segment, a table, or its
/// last parts.
pub fn find(name: &str) -> Vec<&'static Key> {
    let part = |part: &str| if part.parse::<usize>().is_ok() { "N".to_owned() } else { part.to_owned() };
    let wanted = name.split('.').map(part).collect::<Vec<_>>().join(".");
    // The opponent's material has the keys of the body's.
    let wanted = if wanted.starts_with("opponent.material.") { wanted.replacen("opponent.", "", 1) } else { wanted };
    let meant = |key: &Key| {
        let dotted = key.dotted();
        dotted == wanted || key.table == wanted || dotted.ends_with(&format!(".{wanted}"))
    };
    KEYS.iter().filter(|key| meant(key)).collect()
}

/// Whether the value of a dotted key is any number, of which a whole one is only a way to write it.
pub fn takes_decimals(name: &str) -> bool {
    // Strain and stress of a point of a table.
    let within_points = name.split('.').any(|part| part == "points");
    find(name).first().map_or(within_points, |key| matches!(key.kind, Number(..) | Components(_) | ShareOrTrue))
}

/// The known name closest to an unknown one.
pub fn nearest_key(name: &str) -> Option<String> {
    let names: Vec<String> = KEYS.iter().flat_map(|key| [key.dotted(), key.name.to_owned()]).collect();
    super::likeness::nearest(name, &names.iter().map(String::as_str).collect::<Vec<_>>())
}

#[cfg(test)]
mod tests;

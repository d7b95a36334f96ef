//! The resolved case as TOML, every default written out; it reads back as the same case.

use serde::ser::{Serialize, SerializeMap, Serializer};

use super::{Case, Friction, Hold, Motion, Opponent, Output, Segment, ShearTarget, Solver, UnitLabels};

impl Case {
    /// The case as TOML.
    pub fn to_toml(&self) -> String {
        // Every key is a string and no value is null, so there is nothing that TOML could not hold.
        toml::to_string(self).unwrap_or_else(|error| format!("# {error}\n"))
    }
}

impl Case {
    /// The case as TOML without what changes no result: two cases are one if this is the same.
    pub fn identity(&self) -> String {
        let Output { plot_format, plot_width, .. } = Output::default();
        let output = Output { plot_format, plot_width, ..self.output.clone() };
        let solver = Solver { max_memory_gib: None, ..self.solver.clone() };
        Self { units: UnitLabels::default(), output, solver, ..self.clone() }.to_toml()
    }
}

impl Serialize for Friction {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Friction::Coefficient(mu) => serializer.serialize_f64(*mu),
            Friction::Stick => serializer.serialize_str("stick"),
        }
    }
}

impl Serialize for Opponent {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        match self {
            Opponent::Equal => map.serialize_entry("equal", &true)?,
            Opponent::Rigid { radius } => {
                map.serialize_entry("rigid", &true)?;
                map.serialize_entry("radius", radius)?;
            }
            Opponent::Deforming { radius, material } => {
                match radius {
                    Some(radius) => map.serialize_entry("radius", radius)?,
                    None => map.serialize_entry("flat", &true)?,
                }
                map.serialize_entry("material", material)?;
            }
        }
        map.end()
    }
}

impl Serialize for Segment {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        match self {
            Segment::Indentation { indentation } => map.serialize_entry("indentation", indentation)?,
            Segment::Shear { shear, hold } => {
                map.serialize_entry("shear", shear)?;
                map.serialize_entry("hold", hold)?;
            }
            Segment::Oblique { indentation, shear } => {
                map.serialize_entry("indentation", indentation)?;
                map.serialize_entry("shear", shear)?;
            }
            Segment::Motion { to: Motion { indentation, shear, roll, twist }, hold } => {
                if let Some(indentation) = indentation {
                    map.serialize_entry("indentation", indentation)?;
                }
                if let Some(shear) = shear {
                    map.serialize_entry("shear", shear)?;
                }
                if let Some(roll) = roll {
                    map.serialize_entry("roll", roll)?;
                }
                if let Some(twist) = twist {
                    map.serialize_entry("twist", twist)?;
                }
                if indentation.is_none() {
                    map.serialize_entry("hold", hold)?;
                }
            }
            Segment::Slip { direction, hold } => {
                map.serialize_entry("shear", &ShearTarget::FullSlip)?;
                map.serialize_entry("shear_direction", direction)?;
                map.serialize_entry("hold", hold)?;
            }
            Segment::Release { share } if *share > 0.0 => map.serialize_entry("release", share)?,
            Segment::Release { .. } => map.serialize_entry("release", &true)?,
        }
        map.end()
    }
}

impl Serialize for ShearTarget {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            ShearTarget::Displacement(delta) => serializer.serialize_f64(*delta),
            ShearTarget::FullSlip => serializer.serialize_str("full-slip"),
        }
    }
}

impl Serialize for Hold {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(match self {
            Hold::Indentation => "indentation",
            Hold::NormalForce => "normal-force",
        })
    }
}

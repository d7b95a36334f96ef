//! How a run ends.

/// How a run ended.
#[derive(Clone, Debug, PartialEq)]
pub enum Ending {
    /// The whole path was followed.
    Done,
    /// A step did not converge, however short.
    NotConverged(String),
    /// The contact outgrew the finely meshed zone.
    Outgrown(Outgrowth),
    /// The observer asked to stop.
    Interrupted,
}

/// How far a contact reached when it left the finely meshed zone, scaled by R.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outgrowth {
    /// Largest distance of a closed point from the axis, in the undeformed body.
    pub reach: f64,
    /// Contact radius.
    pub contact_radius: f64,
    /// Radius of the finely meshed zone.
    pub fine_radius: f64,
    /// Indentation.
    pub h: f64,
    /// Tangential displacement.
    pub delta_t: f64,
}

impl std::fmt::Display for Outgrowth {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { reach, fine_radius, h, delta_t, .. } = self;
        write!(
            f,
            "the contact reaches {reach:.4} R at h = {h:.5} R, delta_T = {delta_t:.5} R, and the finely meshed zone ends at {fine_radius:.4} R"
        )
    }
}

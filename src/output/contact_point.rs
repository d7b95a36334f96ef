//! A point of the contact surface, in the user's units.

use serde::{Deserialize, Serialize};

/// What a point of the surface does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ContactStatus {
    /// Not in contact.
    Open,
    /// In contact, not moving along the plane.
    Stick,
    /// In contact, sliding along the plane.
    Slip,
}

/// On which half of the contact a point lies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Half {
    /// The meshed one, Y > 0.
    #[default]
    Meshed,
    /// The symmetry plane between them, Y = 0.
    Both,
    /// The other one, Y < 0: the mirror image of the meshed node of the same number.
    Mirrored,
    /// All of the sphere is meshed, and no point has an image; none need lie on Y = 0.
    Whole,
}

impl Half {
    /// Whether a point on this half takes part in what is shown of the meshed or the mirrored one.
    pub fn is_shown_as(self, shown: Self) -> bool {
        matches!(self, Self::Both | Self::Whole) || self == shown
    }
}

/// One point of the surface that can touch the plane.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ContactPoint {
    /// Number of the mesh node, for a mirrored point that of the node whose image it is.
    pub point: usize,
    /// Reference position X, along the shear.
    #[serde(rename = "X")]
    pub reference_x: f64,
    /// Reference position Y, across it; the symmetry plane is Y = 0.
    #[serde(rename = "Y")]
    pub reference_y: f64,
    /// Current position x.
    #[serde(rename = "x")]
    pub current_x: f64,
    /// Current position y.
    #[serde(rename = "y")]
    pub current_y: f64,
    /// Distance from the plane.
    pub gap: f64,
    /// Contact pressure, force over `area`, compression positive.
    pub pressure: f64,
    /// Shear traction on the sphere along x.
    pub traction_x: f64,
    /// Shear traction on the sphere along y.
    pub traction_y: f64,
    /// Reference area that the point stands for.
    pub area: f64,
    /// What it does.
    pub status: ContactStatus,
    /// On which half it lies.
    pub half: Half,
}

impl ContactPoint {
    /// The point's image on the other half.
    fn mirrored(&self) -> Self {
        // 0 - y, not -y: no traction is 0, not -0.
        let [reference_y, current_y, traction_y] = [self.reference_y, self.current_y, self.traction_y].map(|y| 0.0 - y);
        Self { reference_y, current_y, traction_y, half: Half::Mirrored, ..self.clone() }
    }

    /// The whole contact of the points of the meshed half: these, and then the images of those
    /// beside the symmetry plane.
    pub fn whole(mut points: Vec<Self>) -> Vec<Self> {
        let images: Vec<Self> = points.iter().filter(|point| point.half == Half::Meshed).map(Self::mirrored).collect();
        points.extend(images);
        points
    }
}

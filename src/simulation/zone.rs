//! The finely meshed part of the surface, and how it grows when the contact leaves it.

use serde::{Deserialize, Serialize};

use crate::case::CONTACT_RADII;
use crate::mesh::{FINE_ZONES, LARGEST_FINE_RADIUS};

/// Below the smallest the sphere is a half-space anyway; the largest is what the mesh can resolve
/// on a half ball.
const SMALLEST_CONTACT: f64 = CONTACT_RADII.0;
const LARGEST_CONTACT: f64 = CONTACT_RADII.1;
/// Smallest fine zone in contact radii.
const SMALLEST_FINE_ZONE: f64 = *FINE_ZONES.start();
/// Largest fine zone in contact radii; beyond it the contact radius that is meshed for grows too,
/// and with it the elements.
pub const LARGEST_FINE_ZONE: f64 = *FINE_ZONES.end();
/// A zone is made so much larger than the reach along the whole path. Half and twice of what is
/// over 1, of this and of the next: `benches/constants`.
pub const MARGIN: f64 = 1.15;
/// A zone is made so much larger than a reach that will go on growing.
pub const BLIND_MARGIN: f64 = 1.5;

/// The finely meshed zone around the pole, scaled by R.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Zone {
    /// Contact radius that the mesh is made for: it has the case's elements along it.
    pub contact_radius: f64,
    /// Radius of the fine zone over that.
    pub fine_zone: f64,
}

impl Zone {
    /// A zone for this contact radius, as near to it as a mesh can be made.
    pub fn new(contact_radius: f64, fine_zone: f64) -> Self {
        Self { contact_radius: contact_radius.clamp(SMALLEST_CONTACT, LARGEST_CONTACT), fine_zone }
    }

    /// Why no mesh can have been made for this zone, in words.
    pub fn flaw(self) -> Option<String> {
        let Self { contact_radius, fine_zone } = self;
        let sound = (SMALLEST_CONTACT..=LARGEST_CONTACT).contains(&contact_radius) && FINE_ZONES.contains(&fine_zone);
        (!sound).then(|| format!("a zone of {fine_zone:?} contact radii of {contact_radius:?} R"))
    }

    /// The zone as far as a sphere of this radius, the smaller one of two, can have it.
    pub fn within(self, radius: f64) -> Self {
        let contact_radius = self.contact_radius.min((LARGEST_CONTACT * radius).max(SMALLEST_CONTACT));
        Self { contact_radius, ..self }
    }

    /// Distance from the axis to which the zone reaches on the smaller of two spheres, of this
    /// radius.
    pub fn radius_within(&self, radius: f64) -> f64 {
        self.radius().min(LARGEST_FINE_RADIUS * radius)
    }

    /// Distance from the axis to which the zone reaches.
    pub fn radius(&self) -> f64 {
        (self.fine_zone * self.contact_radius).min(LARGEST_FINE_RADIUS)
    }

    /// The zone for a contact that reaches `reach` from the axis and whose radius grows to
    /// `contact_radius`: at least as large as this one in both, and `margin` times as large as the
    /// reach. `None` if no zone is larger than this one.
    ///
    /// The fine zone widens first, which keeps the size of the elements; where it is three contact
    /// radii wide the elements grow too.
    pub fn grown(&self, reach: f64, contact_radius: f64, margin: f64) -> Option<Self> {
        let radius = (margin * reach).max(self.radius());
        let contact_radius = contact_radius.max(self.contact_radius).max(radius / LARGEST_FINE_ZONE).min(LARGEST_CONTACT);
        let fine_zone = (radius / contact_radius).clamp(SMALLEST_FINE_ZONE, LARGEST_FINE_ZONE);
        let grown = Self { contact_radius, fine_zone };
        (grown.radius() > self.radius() * (1.0 + 1e-9)).then_some(grown)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_zone_grows_until_there_is_no_larger_one() {
        let mut zone = Zone::new(0.02, 1.3);
        let mut zones = vec![zone];
        while let Some(grown) = zone.grown(1.05 * zone.radius(), 0.0, MARGIN) {
            assert!(grown.radius() > zone.radius() && grown.contact_radius >= zone.contact_radius, "{zones:?}");
            assert!((SMALLEST_FINE_ZONE..=LARGEST_FINE_ZONE).contains(&grown.fine_zone));
            zones.push(grown);
            zone = grown;
        }
        assert!(zones.len() < 60 && zone.radius() == LARGEST_FINE_RADIUS, "{zones:?}");
        // First the zone widens around elements of the same size.
        assert_eq!(zones[3].contact_radius, 0.02);
    }

    #[test]
    fn a_larger_contact_has_larger_elements() {
        let grown = Zone::new(0.02, 1.3).grown(0.04, 0.035, MARGIN).unwrap();
        assert_eq!(grown.contact_radius, 0.035);
        assert!(grown.radius() >= 0.046 - 1e-12 && grown.fine_zone < 1.4, "{grown:?}");
        assert_eq!(Zone::new(2.0, 1.3).contact_radius, LARGEST_CONTACT);
    }
}

//! From the scaled results of the simulation (lengths by R, stresses by E, the meshed half) to the
//! user's units and the whole sphere.

use super::{ContactPoint, ContactStatus, Half, StepRecord};
use crate::case::{self, Case, Orientation, Scaled};
use crate::contact::coulomb::Status;
use crate::simulation::record;

/// The numbers by which everything is scaled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Units {
    /// Radius R, the unit of length.
    pub radius: f64,
    /// Young's modulus E, the unit of stress.
    pub youngs_modulus: f64,
    /// Number of bodies that deform (see [`Case::bodies`]).
    pub bodies: f64,
    /// How the mesh lies in the user's axes.
    pub orientation: Orientation,
}

impl Units {
    /// Those of a case in the user's units.
    pub fn of(case: &Case) -> Self {
        Self {
            radius: case.sphere.radius,
            youngs_modulus: case.material.youngs_modulus,
            bodies: case.bodies(),
            orientation: case.orientation(),
        }
    }

    /// Unit of force, E R^2.
    pub fn force(&self) -> f64 {
        self.youngs_modulus * self.radius * self.radius
    }

    /// Unit of energy, E R^3.
    pub fn energy(&self) -> f64 {
        self.force() * self.radius
    }

    /// A position or a displacement, scaled and in the mesh's axes, in the user's.
    pub fn vector(&self, scaled: &[f64; 3]) -> [f64; 3] {
        let [x, y] = self.orientation.to_user([scaled[0], scaled[1]]);
        [x, y, scaled[2]].map(|x| x * self.radius)
    }

    /// A stress xx, yy, zz, xy, yz, zx likewise.
    pub fn stress(&self, scaled: &[f64; 6]) -> [f64; 6] {
        self.orientation.tensor_to_user(*scaled).map(|s| s * self.youngs_modulus)
    }
}

impl Scaled<StepRecord> {
    /// The row in the user's units; the scaled one is of the whole sphere already, of one of a
    /// pair.
    pub fn in_units(&self, units: &Units) -> StepRecord {
        let scaled = &self.0;
        let (length, force, energy) = (units.radius, units.force(), units.bodies * units.energy());
        let travel = units.bodies * length;
        let pair = |x: f64, y: f64, unit: f64| units.orientation.to_user([x, y]).map(|part| part * unit);
        let [delta_t, delta_t_y] = pair(scaled.delta_t, scaled.delta_t_y, travel);
        let [delta_t_contact, delta_t_y_contact] = pair(scaled.delta_t_contact, scaled.delta_t_y_contact, travel);
        let [f_t, f_t_y] = pair(scaled.f_t, scaled.f_t_y, force);
        let [roll_x, roll_y] = pair(scaled.roll_x, scaled.roll_y, units.bodies);
        let [m_roll_x, m_roll_y] = pair(scaled.m_roll_x, scaled.m_roll_y, force * length);
        StepRecord {
            h: scaled.h * travel,
            delta_t,
            f_n: scaled.f_n * force,
            f_t,
            a: scaled.a * length,
            stick_radius: scaled.stick_radius * length,
            a_gap: scaled.a_gap * length,
            reach: scaled.reach * length,
            work_external: scaled.work_external * energy,
            energy_elastic: scaled.energy_elastic * energy,
            work_plastic: scaled.work_plastic * energy,
            work_friction: scaled.work_friction * energy,
            h_opponent: scaled.h_opponent * travel,
            work_plastic_opponent: scaled.work_plastic_opponent * energy,
            curvature: scaled.curvature / length,
            k_t: scaled.k_t.map(|stiffness| stiffness * force / travel),
            // It is made from rows in the user's axes.
            f_t_limit: scaled.f_t_limit.map(|limit| limit * force),
            f_n_limit: scaled.f_n_limit.map(|limit| limit * force),
            f_t_error: scaled.f_t_error.map(|error| error * force),
            f_n_error: scaled.f_n_error.map(|error| error * force),
            delta_t_y,
            f_t_y,
            twist: scaled.twist * units.bodies,
            roll_x,
            roll_y,
            m_twist: scaled.m_twist * force * length,
            m_roll_x,
            m_roll_y,
            h_contact: scaled.h_contact * travel,
            delta_t_contact,
            delta_t_y_contact,
            // Counts, indices and ratios have no unit.
            ..*scaled
        }
    }
}

impl ContactPoint {
    /// A point in the user's units. Pressure and tractions are the point's force over its tributary
    /// reference area, exerted by the plane on the sphere: the shear traction resists the motion. A
    /// point without area has none. A point on the symmetry plane has its area of both halves.
    pub fn in_units(scaled: &record::RecordedPoint, units: &Units) -> Self {
        let [reference, current] = [&scaled.reference, &scaled.position].map(|x| units.vector(x));
        let [force_x, force_y] = units.orientation.to_user([scaled.force[0], scaled.force[1]]);
        let length = units.radius;
        let per_area = if scaled.area > 0.0 { units.youngs_modulus / scaled.area } else { 0.0 };
        let (halves, half) = match (scaled.on_symmetry_plane, scaled.is_of_whole) {
            (true, _) => (2.0, Half::Both),
            (false, true) => (1.0, Half::Whole),
            (false, false) => (1.0, Half::Meshed),
        };
        Self {
            point: scaled.node,
            reference_x: reference[0],
            reference_y: reference[1],
            current_x: current[0],
            current_y: current[1],
            gap: scaled.gap * length,
            pressure: scaled.force[2] * per_area,
            traction_x: force_x * per_area,
            traction_y: force_y * per_area,
            area: halves * scaled.area * length * length,
            status: scaled.status.into(),
            half,
        }
    }

    /// The whole contact of a step from the points of its meshed half.
    pub fn whole_of(scaled: &[record::RecordedPoint], units: &Units) -> Vec<Self> {
        Self::whole(scaled.iter().map(|point| Self::in_units(point, units)).collect())
    }
}

impl From<Status> for ContactStatus {
    fn from(status: Status) -> Self {
        match status {
            Status::Open => Self::Open,
            Status::Stick => Self::Stick,
            Status::Slip => Self::Slip,
        }
    }
}

pub(super) fn coefficient(friction: case::Friction) -> Option<f64> {
    match friction {
        case::Friction::Coefficient(mu) => Some(mu),
        case::Friction::Stick => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNITS: Units = Units { radius: 2.0, youngs_modulus: 100.0, bodies: 1.0, orientation: Orientation::ALONG_X };

    #[test]
    fn every_quantity_has_its_own_unit() {
        let scaled = Scaled(StepRecord {
            h: 1.0,
            f_n: 1.0,
            a: 1.0,
            work_plastic: 1.0,
            merit: 1.0,
            max_alpha: 1.0,
            contact_points: 3,
            ..StepRecord::default()
        });
        let row = scaled.in_units(&UNITS);
        assert_eq!((row.h, row.f_n, row.a, row.work_plastic), (2.0, 400.0, 2.0, 800.0));
        assert_eq!((row.merit, row.max_alpha, row.contact_points), (1.0, 1.0, 3));
    }

    #[test]
    fn pressure_times_area_is_the_force() {
        let scaled = record::RecordedPoint {
            node: 9,
            reference: [0.1, 0.2, 0.01],
            position: [0.11, 0.2, 0.0],
            force: [-0.3, 0.0, 1.0],
            area: 0.5,
            gap: 0.0,
            on_symmetry_plane: false,
            is_of_whole: false,
            status: Status::Slip,
        };
        let point = ContactPoint::in_units(&scaled, &UNITS);
        assert_eq!(point.pressure * point.area, 400.0);
        assert_eq!((point.traction_x, point.status, point.point), (-60.0, ContactStatus::Slip, 9));
        assert_eq!((point.reference_x, point.current_x, point.gap), (0.2, 0.22, 0.0));
        // Half of a point on the symmetry plane is meshed.
        let middle = ContactPoint::in_units(&record::RecordedPoint { on_symmetry_plane: true, ..scaled }, &UNITS);
        assert_eq!((middle.pressure, middle.area, middle.half), (point.pressure, 2.0 * point.area, Half::Both));
        assert_eq!(ContactPoint::in_units(&record::RecordedPoint { area: 0.0, ..scaled }, &UNITS).pressure, 0.0);
    }
}

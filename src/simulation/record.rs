//! What is remembered of every accepted step, of the whole sphere.

use serde::{Deserialize, Serialize};

/// One row of the history, of the whole sphere, in the user's units; names are those of the columns
/// of `history.csv`. The simulation shows it as a [`Scaled`](crate::case::Scaled) one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StepRecord {
    /// Counts accepted steps; 0 is the undeformed state.
    pub step: usize,
    /// Index of the path's segment, from 0: the key of its case is `path.0`.
    pub segment: usize,
    /// Indentation h.
    pub h: f64,
    /// Tangential displacement delta_T.
    #[serde(rename = "delta_T")]
    pub delta_t: f64,
    /// Normal force F_N, positive in compression.
    #[serde(rename = "F_N")]
    pub f_n: f64,
    /// Tangential force F_T that the plate exerts in the direction of delta_T.
    #[serde(rename = "F_T")]
    pub f_t: f64,
    /// Contact radius a, from the pressure.
    pub a: f64,
    /// Radius of a disc with the area of the sticking points.
    pub stick_radius: f64,
    /// Newton iterations, those of cut-back attempts included.
    pub newton_iterations: usize,
    /// Attempts that failed and were bisected on the way to this step.
    pub cutbacks: usize,
    /// Contact radius from the gap outside the contact, a check on `a`: the radius at which a node
    /// just touches, up to half an element larger than `a` where the pressure ends abruptly.
    #[serde(default)]
    pub a_gap: f64,
    /// Krylov iterations.
    #[serde(default)]
    pub krylov_iterations: usize,
    /// Final merit over the sum of the normal contact forces.
    #[serde(default)]
    pub merit: f64,
    /// Work of the plate since the start (trapezoidal rule).
    #[serde(default)]
    pub work_external: f64,
    /// Stored elastic energy.
    #[serde(default)]
    pub energy_elastic: f64,
    /// Plastic work.
    #[serde(default)]
    pub work_plastic: f64,
    /// Work dissipated by friction (see [`crate::solver::opponent::dissipation::dissipated`]).
    #[serde(default)]
    pub work_friction: f64,
    /// Closed contact points of the meshed half.
    #[serde(default)]
    pub contact_points: usize,
    /// Of them, those that slip.
    #[serde(default)]
    pub slipping_points: usize,
    /// Largest equivalent plastic strain of any quadrature point.
    #[serde(default)]
    pub max_alpha: f64,
    /// Distance from the sphere's axis to the outermost point in contact, in the undeformed sphere.
    #[serde(default)]
    pub reach: f64,
    /// 1 where the step was accepted above its tolerance, because no step length lowered its merit
    /// any more, or where points under full stick slid in it.
    #[serde(default)]
    pub relaxed: usize,
    /// Under full stick: points that came off in the step and came down again, to carry no
    /// tangential force up to its end.
    #[serde(default)]
    pub landed_again: usize,
    /// With another body that deforms: the part of h that its surface gives way in the middle of
    /// the contact; the rest is the sphere's. As `curvature` of the paraboloid that fits the
    /// interface best, and 0 while fewer than six points touch.
    #[serde(default)]
    pub h_opponent: f64,
    /// With another body that deforms: its share of the plastic work.
    #[serde(default)]
    pub work_plastic_opponent: f64,
    /// With another body that deforms: curvature of the interface, positive where it bends around
    /// the sphere as around a rigid one.
    #[serde(default)]
    pub curvature: f64,
    /// In the row of a shear's first step: the tangential stiffness at its start, a force over a
    /// length (see [`crate::output::Summary::k_t0`]); `None` in others.
    #[serde(default, rename = "k_T")]
    pub k_t: Option<f64>,
    /// F_T in the limit of fine meshes and short steps, from this run and its coarse companion (see
    /// [`crate::output::Limits`]); `None` where there is nothing to compare with, as in the next
    /// three.
    #[serde(default, rename = "F_T_limit")]
    pub f_t_limit: Option<f64>,
    /// F_N in that limit.
    #[serde(default, rename = "F_N_limit")]
    pub f_n_limit: Option<f64>,
    /// Estimated size of what F_T lacks, as a vector.
    #[serde(default, rename = "F_T_error")]
    pub f_t_error: Option<f64>,
    /// Of what `f_n` lacks.
    #[serde(default, rename = "F_N_error")]
    pub f_n_error: Option<f64>,
    /// Tangential displacement along y; `delta_t` is that along x.
    #[serde(default, rename = "delta_T_y")]
    pub delta_t_y: f64,
    /// Tangential force along y, as `f_t` along x.
    #[serde(default, rename = "F_T_y")]
    pub f_t_y: f64,
    /// How far the sphere has been twisted about the normal, in rad.
    #[serde(default)]
    pub twist: f64,
    /// How far it has rolled about x, in rad.
    #[serde(default)]
    pub roll_x: f64,
    /// About y, which takes it along x.
    #[serde(default)]
    pub roll_y: f64,
    /// Moment about the normal that the plate exerts in the direction of `twist`: that of the
    /// tractions about the foot of the perpendicular from the sphere's centre to the plane, or
    /// about the point of the opponent's surface on the line of centres.
    #[serde(default, rename = "M_twist")]
    pub m_twist: f64,
    /// The same about x, in the direction of `roll_x`.
    #[serde(default, rename = "M_roll_x")]
    pub m_roll_x: f64,
    /// About y.
    #[serde(default, rename = "M_roll_y")]
    pub m_roll_y: f64,
    /// h between two half-spaces: less what the bodies give way outside their contact beyond those
    /// (see [`crate::analytical::body`]).
    #[serde(default)]
    pub h_contact: f64,
    /// `delta_t` likewise.
    #[serde(default, rename = "delta_T_contact")]
    pub delta_t_contact: f64,
    /// `delta_t_y` likewise.
    #[serde(default, rename = "delta_T_y_contact")]
    pub delta_t_y_contact: f64,
}

impl StepRecord {
    /// Angles of roll about x and y, and of twist.
    pub fn angles(&self) -> [f64; 3] {
        [self.roll_x, self.roll_y, self.twist]
    }

    /// The tangential force along x and y.
    pub fn tangential_force(&self) -> [f64; 2] {
        [self.f_t, self.f_t_y]
    }

    /// The row as a run without a companion has it.
    pub fn forget_limits(&mut self) {
        (self.f_t_limit, self.f_n_limit, self.f_t_error, self.f_n_error) = (None, None, None, None);
    }

    /// The first number of the row that is infinite or NaN, with the name of its column.
    pub fn not_finite(&self) -> Option<(&'static str, f64)> {
        let numbers = [
            ("h", self.h),
            ("delta_T", self.delta_t),
            ("F_N", self.f_n),
            ("F_T", self.f_t),
            ("a", self.a),
            ("stick_radius", self.stick_radius),
            ("a_gap", self.a_gap),
            ("merit", self.merit),
            ("work_external", self.work_external),
            ("energy_elastic", self.energy_elastic),
            ("work_plastic", self.work_plastic),
            ("work_friction", self.work_friction),
            ("max_alpha", self.max_alpha),
            ("reach", self.reach),
            ("h_opponent", self.h_opponent),
            ("work_plastic_opponent", self.work_plastic_opponent),
            ("curvature", self.curvature),
            ("delta_T_y", self.delta_t_y),
            ("F_T_y", self.f_t_y),
            ("twist", self.twist),
            ("roll_x", self.roll_x),
            ("roll_y", self.roll_y),
            ("M_twist", self.m_twist),
            ("M_roll_x", self.m_roll_x),
            ("M_roll_y", self.m_roll_y),
            ("h_contact", self.h_contact),
            ("delta_T_contact", self.delta_t_contact),
            ("delta_T_y_contact", self.delta_t_y_contact),
        ];
        let optional = [
            ("k_T", self.k_t),
            ("F_T_limit", self.f_t_limit),
            ("F_N_limit", self.f_n_limit),
            ("F_T_error", self.f_t_error),
            ("F_N_error", self.f_n_error),
        ];
        let optional = optional.into_iter().filter_map(|(column, number)| Some((column, number?)));
        numbers.into_iter().chain(optional).find(|(_, number)| !number.is_finite())
    }
}

/// A contact point of a committed state, scaled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RecordedPoint {
    /// Node index.
    pub node: usize,
    /// Reference position.
    pub reference: [f64; 3],
    /// Current position.
    pub position: [f64; 3],
    /// Force of the plane on the point, of the meshed half: what contact exerts, without the pull
    /// of the other half. A point of another body is in that body's own coordinates.
    pub force: [f64; 3],
    /// Gap to the plane, or to the opponent.
    pub gap: f64,
    /// Tributary reference area on the meshed half.
    pub area: f64,
    /// The point lies on the symmetry plane: half of it is meshed.
    pub on_symmetry_plane: bool,
    /// All of the sphere is meshed, and not half of it.
    pub is_of_whole: bool,
    /// Open, sticking or slipping.
    pub status: crate::contact::coulomb::Status,
}

//! One segment of the path: where the plate goes to, and what is held meanwhile.

/// One segment of the path. Targets are totals from the undeformed sphere, not increments.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Segment {
    /// Move the plate to the indentation h; one smaller than the current unloads to it.
    Indentation {
        /// Target h >= 0, a length.
        indentation: f64,
    },
    /// Move the plate along the plane to delta_T.
    Shear {
        /// Where to.
        shear: ShearTarget,
        /// What is constant meanwhile.
        hold: Hold,
    },
    /// Move the plate to both in a straight line, h and delta_T in proportion: oblique loading and
    /// rebound.
    Oblique {
        /// Target h >= 0, a length.
        indentation: f64,
        /// Target delta_T, a length of either sign.
        shear: f64,
    },
    /// Move the plate in several of its degrees of freedom at once, in proportion.
    Motion {
        /// Where to.
        to: Motion,
        /// What is constant meanwhile, if `to` has no indentation.
        hold: Hold,
    },
    /// Move the plate along the plane, in any direction, until every point in contact slips.
    Slip {
        /// In degrees from x towards y.
        direction: f64,
        /// What is constant meanwhile.
        hold: Hold,
    },
    /// Unload.
    Release {
        /// Until F_N has fallen to this share of what it was when the segment began, 0 <= share <
        /// 1; with 0 until contact is lost.
        share: f64,
    },
}

/// Where the plate goes to; what is `None` stays as it is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Target h >= 0, a length.
    pub indentation: Option<f64>,
    /// Target delta_T along x and y, lengths of either sign.
    pub shear: Option<[f64; 2]>,
    /// How far it is to have rolled about x and y, in rad. The centre goes along, so that delta_T,
    /// the displacement of one surface on the other, stays as it is.
    pub roll: Option<[f64; 2]>,
    /// How far it is to have turned about the normal, z, in rad.
    pub twist: Option<f64>,
}

impl Motion {
    /// Whether the plate turns.
    pub fn turns(&self) -> bool {
        self.roll.is_some() || self.twist.is_some()
    }
}

impl Segment {
    /// Whether all of it is even in y, for a plate that so far was: half of the body then tells of
    /// all of it.
    pub fn is_even(&self) -> bool {
        match self {
            Self::Motion { to, .. } => {
                to.twist.is_none() && to.shear.is_none_or(|[_, y]| y == 0.0) && to.roll.is_none_or(|[about_x, _]| about_x == 0.0)
            }
            Self::Slip { direction, .. } => unit(*direction)[1] == 0.0,
            Self::Indentation { .. } | Self::Shear { .. } | Self::Oblique { .. } | Self::Release { .. } => true,
        }
    }

    /// Whether the plate is sheared across the x axis in it.
    pub fn leaves_x(&self) -> bool {
        match self {
            Self::Motion { to, .. } => to.shear.is_some_and(|[_, y]| y != 0.0),
            Self::Slip { direction, .. } => unit(*direction)[1] != 0.0,
            Self::Indentation { .. } | Self::Shear { .. } | Self::Oblique { .. } | Self::Release { .. } => false,
        }
    }

    /// Whether the plate rolls about y in it.
    pub fn rolls_along_x(&self) -> bool {
        matches!(self, Self::Motion { to: Motion { roll: Some([_, about_y]), .. }, .. } if *about_y != 0.0)
    }

    /// Whether the plate turns in it.
    pub fn turns(&self) -> bool {
        matches!(self, Self::Motion { to, .. } if to.turns())
    }
}

/// The unit vector in a direction, in degrees from x towards y; along the axes exactly.
pub fn unit(direction: f64) -> [f64; 2] {
    let quarters = direction / 90.0;
    if quarters.fract() == 0.0 {
        return [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]][quarters.rem_euclid(4.0) as usize % 4];
    }
    let (sin, cos) = direction.to_radians().sin_cos();
    [cos, sin]
}

/// Where a shear segment ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ShearTarget {
    /// At this delta_T, a length, of either sign.
    Displacement(f64),
    /// When every point in contact slips.
    FullSlip,
}

/// What a shear segment keeps constant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Hold {
    /// The indentation h.
    #[default]
    Indentation,
    /// The normal force F_N.
    NormalForce,
}

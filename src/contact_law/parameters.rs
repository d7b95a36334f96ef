//! What the update needs to know of a pair of materials.

use super::cohesion::{Attraction, Cohesion, CohesionState, cohere};
use super::constants::Constants;
use super::prepare::prepare;
use super::state::{ContactResponse, ContactState};
use super::table::{LN_FORCE, LN_RADIUS, LN_STIFFNESS, Table};
use super::turning::{Moments, Turn, TurningState, update_turning};
use super::update::{stored_energy, update};
use super::virgin::{FirstLoading, Virgin};

/// What the update needs to know of a pair of materials, shared by all contacts of the pair; any
/// one consistent system of units.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactParameters {
    /// Coulomb's coefficient mu.
    pub friction: f64,
    first_loading: Box<FirstLoading>,
    /// First loading as it was given, and R and E by which all was scaled.
    unit: Box<FirstLoading>,
    scale: [f64; 2],
    pub(super) table: Box<Table>,
}

impl ContactParameters {
    /// Of first loading and the shear at constant h, with the fitted constants. Takes some
    /// milliseconds.
    pub fn new(first_loading: FirstLoading) -> Self {
        Self::with_constants(first_loading, &Constants::FITTED)
    }

    /// The same with other constants, to fit them.
    pub fn with_constants(first_loading: FirstLoading, constants: &Constants) -> Self {
        let table = Box::new(prepare(&first_loading, constants));
        let (friction, unit) = (first_loading.friction, Box::new(first_loading));
        Self { friction, first_loading: unit.clone(), unit, scale: [1.0; 2], table }
    }

    /// The same contact with other constants.
    #[must_use]
    pub fn refitted(&self, constants: &Constants) -> Self {
        Self::with_constants(self.unit.as_ref().clone(), constants).scaled(self.scale[0], self.scale[1])
    }

    /// First loading and the shear at constant h.
    pub fn first_loading(&self) -> &FirstLoading {
        &self.first_loading
    }

    /// First loading at the indentation `h` > 0.
    pub fn virgin(&self, h: f64) -> Virgin {
        self.first_loading.virgin(h)
    }

    /// The table that the update reads.
    pub(crate) fn table(&self) -> &Table {
        &self.table
    }

    /// All that it is, as numbers, to store it.
    pub fn to_numbers(&self) -> Vec<f64> {
        let [radius, youngs_modulus] = self.scale;
        [vec![radius, youngs_modulus], self.unit.to_numbers()].concat()
    }

    /// What [`to_numbers`](Self::to_numbers) gave; none if there are not as many, or one is not
    /// finite.
    pub fn from_numbers(numbers: &[f64]) -> Option<Self> {
        let (&[radius, youngs_modulus], unit) = numbers.split_first_chunk()?;
        let unit = FirstLoading::from_numbers(unit).map(Self::new)?;
        Some(unit.scaled(radius, youngs_modulus))
    }

    /// What belongs to R = 1 and E = 1 for a sphere of this radius and this Young's modulus.
    #[must_use]
    pub fn scaled(self, radius: f64, youngs_modulus: f64) -> Self {
        let (force, stiffness) = ((youngs_modulus * radius * radius).ln(), (youngs_modulus * radius).ln());
        let mut table = self.table;
        table.first *= radius;
        for row in &mut table.rows {
            row[LN_FORCE] += force;
            row[LN_STIFFNESS] += stiffness;
            row[LN_RADIUS] += radius.ln();
        }
        let first_loading = Box::new(self.first_loading.scaled(radius, youngs_modulus));
        let scale = [self.scale[0] * radius, self.scale[1] * youngs_modulus];
        Self { first_loading, scale, table, ..self }
    }

    /// Moves a contact to the indentation `h` and along the plane by `increment` (two components in
    /// the tangent frame). A pure function of the state before. Where `h` or the increment is not
    /// finite, or the state is not [sound](ContactState::is_sound), nothing in the answer is a
    /// number and the state stays as it was.
    pub fn update(&self, state: &ContactState, h: f64, increment: [f64; 2]) -> (ContactState, ContactResponse) {
        update(&self.table, state, h, increment)
    }

    /// The same of a contact that twists and rolls by `turn` in the increment; the displacement is
    /// what the sphere slips without the roll. Of one that never turned the forces are those of
    /// [`update`](Self::update), to the last bit.
    pub fn update_turning(
        &self,
        (state, turning): (&ContactState, &TurningState),
        h: f64,
        increment: [f64; 2],
        turn: Turn,
    ) -> (ContactState, TurningState, ContactResponse, Moments) {
        update_turning(&self.table, self.first_loading.radius, (state, turning), h, increment, turn)
    }

    /// The attraction of the surfaces: the work of adhesion, energy over area (0: none), and the
    /// distance over which surfaces that do not touch attract each other (0: none, as in soft
    /// contacts).
    pub fn cohesion(&self, work: f64, range: f64) -> Cohesion {
        let undeformed = [self.first_loading.effective_modulus, self.first_loading.radius];
        Cohesion::new(&self.table, undeformed, work, range)
    }

    /// Greatest gap over which surfaces that have met may hold each other, length.
    pub fn greatest_gap(&self, cohesion: &Cohesion) -> f64 {
        cohesion.greatest_gap(&self.table)
    }

    /// What cohesion adds to an increment that [`update`](Self::update) or
    /// [`update_turning`](Self::update_turning) has made of a contact: its states before and after,
    /// what cohesion remembers, and the tangential increment. A pure function. With `work` 0 it
    /// adds nothing.
    pub fn cohere(
        &self,
        cohesion: &Cohesion,
        contact: (&ContactState, &ContactState),
        state: &CohesionState,
        increment: [f64; 2],
    ) -> (CohesionState, Attraction) {
        cohere(&self.table, cohesion, contact, state, increment)
    }

    /// Elastic energy that the contact stores, force times length: no path gives back more than it.
    /// No number where the state is not [sound](ContactState::is_sound).
    pub fn stored_energy(&self, state: &ContactState) -> f64 {
        stored_energy(&self.table, state)
    }
}

//! What the response did.

use cloth_core::math::{Real, Vec3};

/// How far the fail-safe had to go.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum ContactStage {
    /// Nothing was near: the step stands as it was.
    #[default]
    Free,
    /// Impulses were enough.
    Impulses,
    /// Parts of the cloth moved as rigid bodies.
    Zones,
    /// Vertices were held back to ways that are too short to touch anything.
    Held,
}

/// What the last call of [`ClothContacts`](super::ClothContacts) did. All counts are of that step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ContactReport {
    /// How far the fail-safe had to go.
    pub stage: ContactStage,
    /// Vertex–triangle and edge–edge pairs that the broad phase has found.
    pub candidates: usize,
    /// How often the broad phase has searched.
    pub searches: u32,
    /// Contacts of which impulses were computed, those with obstacles included.
    pub contacts: usize,
    /// Continuous tests of pairs.
    pub continuous_tests: u64,
    /// Rounds of finding contacts and solving for the impulses.
    pub rounds: u32,
    /// Sweeps over the contacts, for positions and velocities.
    pub sweeps: u32,
    /// Zones that moved as rigid bodies.
    pub zones: usize,
    /// Vertices of the largest zone.
    pub largest_zone: usize,
    /// Vertices that were held back.
    pub held: usize,
    /// The smallest share of its way (dimensionless) that a vertex that was held back has gone; 1 if there is none.
    pub smallest_share: Real,
    /// Impulse (N·s) that the cloth has received from obstacles.
    pub obstacle_impulse: Vec3,
}

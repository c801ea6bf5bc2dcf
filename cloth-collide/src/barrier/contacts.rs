//! The barrier as the contact of any method.

use super::builder::BarrierBuilder;
use super::minimise::{Minimiser, Stuck};
use crate::error::CollideError;
use crate::obstacle::{BodyWork, ObstacleContacts};
use crate::separation::SeparationProbe;
use cloth_core::contact::{ContactError, ContactSource, ContactStep};
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::TriMesh;
use cloth_core::step::Outcome;

/// Contact by a log barrier, found by an interior-point method (COL-7; S1 (51)–(53)): the cloth never crosses itself or an obstacle. The chapter has
/// the equations and the limits.
///
/// ```
/// use cloth_collide::barrier::BarrierContacts;
/// use cloth_core::contact::{ContactSource, ContactStep};
/// use cloth_core::math::Vec3;
/// use cloth_core::mesh::TriMesh;
///
/// // A triangle (m) of 3 g falls at 100 m/s through one that is held.
/// let corners = [(0.0, 0.0), (0.1, 0.0), (0.0, 0.1)];
/// let at = |z: f64| corners.map(|(x, y)| Vec3::new(x, y, z));
/// let from = [at(0.0), at(0.5)].concat();
/// let mesh = TriMesh::new(from.clone(), vec![[0, 1, 2], [3, 4, 5]])?;
/// let mut contacts = BarrierContacts::builder(&mesh).build()?;
///
/// let step = ContactStep { from: &from, inverse_mass: &[0.0, 0.0, 0.0, 1e3, 1e3, 1e3], dt: 0.01 };
/// let mut positions = [at(0.0), at(-0.5)].concat();
/// let mut velocities = [[Vec3::zeros(); 3], [Vec3::z() * -100.0; 3]].concat();
/// contacts.resolve(&step, &mut positions, &mut velocities)?;
/// assert!(positions[3..].iter().all(|x| x.z > 0.0 && x.z < 0.001));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct BarrierContacts {
    pub(super) minimiser: Minimiser,
    /// None if there are none.
    pub(super) obstacles: Option<ObstacleContacts>,
    pub(super) probe: Option<SeparationProbe>,
    /// Positions (m) known to be free of crossings: those of the last step.
    pub(super) safe: Vec<Vec3>,
    pub(super) accuracy: Real,
    pub(super) most_iterations: u32,
    pub(super) work: BodyWork,
    pub(super) report: BarrierReport,
}

/// What the last step that could be resolved took.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BarrierReport {
    /// Whether the minimum was found. If not, the positions are as safe, but F could be lower.
    pub outcome: Outcome,
    /// Newton steps in all.
    pub newton_steps: u32,
    /// Those of them that had to be cut, to stay in the safe set.
    pub capped_steps: u32,
    /// Pieces that the motion of prescribed vertices and obstacles was cut into; 0 if they did not move.
    pub rounds: u32,
    /// Pairs that push, and vertices that obstacles push.
    pub contacts: usize,
}

impl BarrierContacts {
    /// Contact of the cloth `mesh` with itself: from 1 mm on, with 1e5 N/m³.
    #[must_use]
    pub fn builder(mesh: &TriMesh) -> BarrierBuilder<'_> {
        BarrierBuilder::new(mesh)
    }

    /// What the last step took.
    #[must_use]
    pub fn report(&self) -> BarrierReport {
        self.report
    }

    /// The obstacles, if there are any, where they are at the end of the last step.
    #[must_use]
    pub fn obstacles(&self) -> Option<&ObstacleContacts> {
        self.obstacles.as_ref()
    }

    /// The same, to set how they move in the next step. They must not jump onto the cloth.
    pub fn obstacles_mut(&mut self) -> Option<&mut ObstacleContacts> {
        self.obstacles.as_mut()
    }

    /// Whether the step is one of this cloth, and starts in the safe set.
    fn check(
        &mut self,
        step: &ContactStep<'_>,
        positions: &[Vec3],
        velocities: &[Vec3],
    ) -> Result<(), ContactError> {
        step.check(self.safe.len(), positions, velocities)?;
        if step.from == self.safe {
            return Ok(());
        }
        let Some(probe) = &mut self.probe else {
            return Ok(());
        };
        match probe.measure(step.from) {
            Ok(found) if found.intersecting_pairs > 0 => Err(ContactError::Tangled {
                pairs: found.intersecting_pairs,
            }),
            Ok(_) => Ok(()),
            Err(error) => Err(not_finite(&error, step.from)),
        }
    }

    /// Moves the minimiser to the end of the step.
    fn minimise(&mut self, step: &ContactStep<'_>, aim: &[Vec3]) -> Result<Outcome, Stuck> {
        let minimiser = &mut self.minimiser;
        minimiser.obstacles.clear();
        let obstacles = self.obstacles.iter().flat_map(ObstacleContacts::obstacles);
        minimiser.obstacles.extend(obstacles.cloned());
        minimiser.begin(step.from, aim, step.inverse_mass, step.dt)?;
        if let Some(vertex) = minimiser.not_safe() {
            return Err(Stuck::NoWay(vertex));
        }
        let accuracy = self.accuracy * minimiser.terms.range();
        minimiser.carry(step.dt, accuracy)?;
        minimiser.relax(accuracy, self.most_iterations)
    }
}

impl ContactSource for BarrierContacts {
    fn resolve(
        &mut self,
        step: &ContactStep<'_>,
        positions: &mut [Vec3],
        velocities: &mut [Vec3],
    ) -> Result<(), ContactError> {
        self.check(step, positions, velocities)?;
        self.work.begin(self.obstacles.as_ref(), velocities);
        let outcome = self
            .minimise(step, positions)
            .map_err(|stuck| match stuck {
                Stuck::NoWay(vertex) => ContactError::NoWay { vertex },
                Stuck::Bad(error) => not_finite(&error, positions),
            })?;
        let Minimiser {
            x, weight, counts, ..
        } = &self.minimiser;
        let ends = positions.iter_mut().zip(&mut *velocities);
        for ((position, velocity), (x, weight)) in ends.zip(x.iter().zip(weight)) {
            if *weight > 0.0 {
                *velocity += (x - *position) / step.dt;
                *position = *x;
            }
        }
        // A way over a time may be beyond all numbers.
        step.check(self.safe.len(), positions, velocities)?;
        let bodies = self.obstacles.as_ref();
        self.work.end(bodies, step, positions, velocities);
        // A copy has already been there, so nothing goes wrong here.
        let obstacles = self.obstacles.iter_mut();
        for obstacle in obstacles.flat_map(ObstacleContacts::obstacles_mut) {
            obstacle
                .advance(step.dt)
                .map_err(|_| not_finite(&CollideError::TooFarApart, positions))?;
        }
        self.safe.copy_from_slice(positions);
        self.report = BarrierReport {
            outcome,
            newton_steps: counts.newton_steps,
            capped_steps: counts.capped_steps,
            rounds: counts.rounds,
            contacts: self.minimiser.contact_count(),
        };
        Ok(())
    }

    fn work(&self) -> Real {
        self.work.work()
    }

    fn potential_energy(&self) -> Real {
        self.minimiser.barriers(&self.safe)
    }

    /// All vertices where the search for the minimum was cut short.
    fn held(&self) -> usize {
        match self.report.outcome {
            Outcome::BudgetSpent => self.safe.len(),
            _ => 0,
        }
    }
}

/// The error for coordinates too large to work with.
fn not_finite(error: &CollideError, positions: &[Vec3]) -> ContactError {
    let vertex = match error {
        CollideError::NonFinitePosition { vertex } => *vertex,
        _ => {
            let size = |v: &usize| positions[*v].amax();
            let all = 0..positions.len();
            all.max_by(|a, b| size(a).total_cmp(&size(b))).unwrap_or(0)
        }
    };
    ContactError::NonFinite { vertex }
}

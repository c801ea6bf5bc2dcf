//! The response: what the cloth does where it touches itself or an obstacle (COL-7, COL-8, COL-9).
//!
//! # The order of the fail-safe
//!
//! A method has moved the cloth as if it were alone. [`ClothContacts`] changes the end of the step, in stages of which each is surer and less gentle than the one before:
//!
//! 1. **Impulses** (Bridson, Fedkiw and Anderson 2002). Every contact is an inequality, n · Σ wᵢ xᵢ ≥ h, with n and the wᵢ from the nearest points of the two pieces: where they are at the
//!    start if that is nearer than the thickness h, otherwise where they are when they come to h. The positions are moved to the nearest ones, in the metric of the masses, that satisfy all of them, with
//!    Coulomb friction; then the velocities likewise. All contacts are solved together, because a pile is held by its lowest sheet. Then everything that has moved is tested again, and what is
//!    violated now is added. It nearly always ends here.
//! 2. **Impact zones** (Provot 1997; Bridson 2002). Linearised contacts need not agree: in a crumple one may push a vertex through what another one has not seen. Vertices of pairs that still go through each other become one rigid body, with
//!    its momentum and angular momentum, since inside a rigid body nothing can meet. Zones that meet are joined. A zone with prescribed vertices moves as those do.
//! 3. **Holding back.** Zones end where prescribed vertices or obstacles do not let them be rigid. Then vertices go no further than 0.44 of the distance that their surroundings have to everything else, and so nothing can reach anything, whatever the directions: this needs no
//!    agreement. It takes momentum away, so it is last.
//! 4. **No way.** What is left goes through something that cannot be held: a prescribed vertex, or an obstacle that moves. The step is refused.
//!
//! The motion is tested again after each change, so whatever the stages do, a step that is not refused is free.
//!
//! # What makes it fast
//!
//! - Only pairs that no plane has apart are candidates: in close layers hardly more than those that come as near as the margin.
//! - Candidates are kept while the motion has room in their boxes, apart from what all vertices do together. At rest, and in free fall, the broad phase does not run at all.
//! - A pair that some steady plane keeps apart, the last one that did or that between its nearest points before or after, needs no continuous test. By how much it does so is the way that its
//!   vertices may go before the pair is looked at again: most candidates sleep.
//! - Contacts start with the forces that they had in the last step, and those that have pushed lately are there from the start, so a pile at rest takes one round; a new one is solved with conjugate
//!   directions.
//!
//! # References
//!
//! - R. Bridson, R. Fedkiw and J. Anderson, Robust treatment of collisions, contact and friction for cloth animation, SIGGRAPH 2002. DOI 10.1145/566570.566623
//! - X. Provot, Collision and self-collision handling in cloth model dedicated to design garments, *Computer Animation and Simulation* 1997. DOI 10.1007/978-3-7091-6874-5_13
//! - M. Silcowitz-Hansen, S. Niebe and K. Erleben, A nonsmooth nonlinear conjugate gradient method for interactive contact force problems, *The Visual Computer* 26, 2010
//! - L. Wu, B. Wu, Y. Yang and H. Wang, A safe and fast repulsion method for GPU-based cloth self collisions, *ACM Transactions on Graphics* 40(1), 2020: ways bounded by
//!   half of the distance.

mod builder;
mod cloth;
mod detect;
mod hold;
mod impulses;
mod last_resorts;
mod memory;
pub(crate) mod pair;
mod report;
mod row;
mod sleep;
mod solve;
mod zones;

pub use builder::ContactsBuilder;
pub use report::{ContactReport, ContactStage};
pub(crate) use sleep::mean;

use crate::obstacle::{BodyWork, Obstacle, ObstacleContacts};
use crate::separation::meet_unduly;
use cloth::Cloth;
use cloth_core::contact::{ContactError, ContactSource, ContactStep};
use cloth_core::math::{Real, Vec3};
use hold::Hold;
use memory::Memory;
use row::Row;
use zones::Zones;

/// A step may not bring two pieces nearer than this share of their distance before it, or of the thickness if that is less.
const KEPT: Real = 0.1;
/// Pieces that start nearer than this share of the thickness push along the line between their nearest points then, unless one of these is on a boundary and further than the
/// thickness; others along that when they come to the thickness.
const NEAR: Real = 1.5;
/// The share of what is missing to the thickness that one step makes up.
const RECOVERY: Real = 0.5;
/// The margin of the search for candidates, in thicknesses. What it has more than one lets the motion become another one without a new search: half of that for each vertex. More is fewer
/// searches, of more candidates each; in close layers their number grows with the third power.
const MARGIN: Real = 2.0;
/// Contacts are satisfied to this share of the thickness, and to half of the distance that they work towards where
/// pieces are nearer at rest than that.
const TOLERANCE: Real = 1e-2;
/// Rounds of impulses, at most, before zones take over.
const MOST_ROUNDS: u32 = 10;
/// Rounds after which a free motion is good enough, though some contact may still miss its thickness.
const ENOUGH_ROUNDS: u32 = 3;
/// Rounds of growing zones, at most, before vertices are held back.
const MOST_ZONE_ROUNDS: u32 = 20;

/// Contact of a cloth with itself and with obstacles, for any method (COL-9): after its step, what would pass through something is kept from it.
///
/// # What is promised
///
/// After a resolved step, no two triangles of the cloth meet, at its end and at no time on the straight ways there: every pair that could come near has passed the
/// conservative [`ContinuousTest`](crate::ContinuousTest), or a plane that keeps it apart at both ends. Distances shrink to no less than a tenth in a step, or to no less than a tenth of the
/// thickness; no free vertex gets into an obstacle, or deeper into one, by more than a hundredth of the thickness. What prescribed vertices or moving obstacles make impossible is
/// [`ContactError::NoWay`].
///
/// The start of the step must be free of crossings. It is if the last step ended there; if anything else has moved the cloth since, all pairs of triangles that are near are tested exactly, and
/// crossing ones are [`ContactError::Tangled`].
///
/// # Limits
///
/// - The response does not know what holds the cloth together. It moves vertices after the method has found their places, in the metric of the masses, so a large step into a contact stretches cloth that the
///   method has to pull back in the next. Cloth that is pulled around something comes to a balance of both. Shorter steps leave less of that strain, more iterations of the method do not.
/// - Prescribed vertices may be inside obstacles.
/// - The thickness is worked towards, not promised: half of what is missing is made up in a step. It adds no velocity.
/// - Impulses and zones keep the momentum of the cloth, zones also the angular momentum of its velocities; holding back keeps neither.
///
/// ```
/// use cloth_collide::{ClothContacts, ContactStage};
/// use cloth_core::contact::{ContactSource, ContactStep};
/// use cloth_core::math::Vec3;
/// use cloth_core::mesh::TriMesh;
///
/// // Two triangles (m) 1 cm apart. The upper one is shot down by 1 m, through the lower one.
/// let corners = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)];
/// let at = |z: f64| corners.map(|(x, y)| Vec3::new(x, y, z));
/// let from = [at(0.0), at(0.01)].concat();
/// let mesh = TriMesh::new(from.clone(), vec![[0, 1, 2], [3, 4, 5]])?;
/// let mut contacts = ClothContacts::builder(&mesh).thickness(2e-3).build()?;
///
/// let mut positions = [at(0.0), at(-0.99)].concat();
/// let mut velocities = [[Vec3::zeros(); 3], [Vec3::z() * -60.0; 3]].concat();
/// let step = ContactStep { from: &from, inverse_mass: &[1.0; 6], dt: 1.0 / 60.0 };
/// contacts.resolve(&step, &mut positions, &mut velocities)?;
///
/// assert_eq!(contacts.report().stage, ContactStage::Impulses);
/// for k in 0..3 {
///     assert!(positions[3 + k].z - positions[k].z > 1.9e-3);
///     // Perfectly inelastic: they go on together.
///     assert!((velocities[k].z + 30.0).abs() < 0.1 && (velocities[3 + k].z + 30.0).abs() < 0.1);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct ClothContacts {
    vertex_count: usize,
    thickness: Real,
    friction: Real,
    obstacles: Option<ObstacleContacts>,
    cloth: Option<Cloth>,
    /// Positions (m) at the end of the last resolved step: known to be free of crossings.
    safe: Vec<Vec3>,
    /// Positions (m) that were looked at last.
    seen: Vec<Vec3>,
    /// Whether a vertex has moved since then.
    moved: Vec<bool>,
    rows: Vec<Row>,
    /// Candidates that may pass through each other, in rising order.
    hits: Vec<usize>,
    /// Vertices that get inside an obstacle, and which one.
    entering: Vec<[u32; 2]>,
    zones: Zones,
    /// What impulses alone would do (m), and the ways from there.
    solved: Vec<Vec3>,
    ways: Vec<Vec3>,
    hold: Hold,
    memory: Memory,
    work: BodyWork,
    report: ContactReport,
}

impl ContactSource for ClothContacts {
    fn resolve(
        &mut self,
        step: &ContactStep<'_>,
        positions: &mut [Vec3],
        velocities: &mut [Vec3],
    ) -> Result<(), ContactError> {
        step.check(self.vertex_count, positions, velocities)?;
        self.report = ContactReport {
            smallest_share: 1.0,
            ..ContactReport::default()
        };
        self.work.begin(self.obstacles.as_ref(), velocities);
        if self.cloth.is_none() && self.obstacles.is_none() {
            return Ok(());
        }
        self.rows.clear();
        self.hits.clear();
        self.entering.clear();
        self.prepare(step, positions)?;
        let free = self.impulses(step, positions)?;
        self.change_velocities(step, velocities);
        if !free {
            self.last_resorts(step, positions, velocities)?;
        }
        // Impulses of heavy and light vertices, and ways over times, may be beyond all numbers.
        step.check(self.vertex_count, positions, velocities)?;
        let bodies = self.obstacles.as_ref();
        self.work.end(bodies, step, positions, velocities);
        self.keep(step, positions)
    }

    fn work(&self) -> Real {
        self.work.work()
    }

    fn held(&self) -> usize {
        self.report.held
    }
}

impl ClothContacts {
    /// What the last step has taken.
    #[must_use]
    pub fn report(&self) -> &ContactReport {
        &self.report
    }

    /// The obstacles, if there are any.
    #[must_use]
    pub fn obstacles(&self) -> Option<&ObstacleContacts> {
        self.obstacles.as_ref()
    }

    /// The same, to move them. After each resolved step they have moved on by its time themselves.
    pub fn obstacles_mut(&mut self) -> Option<&mut ObstacleContacts> {
        self.obstacles.as_mut()
    }

    /// Takes over where a step has ended (m) that another method has taken on from the one resolved last: it is free of crossings.
    pub(crate) fn accept(&mut self, positions: &[Vec3]) {
        if let Some(cloth) = &mut self.cloth {
            cloth.travelled(&self.seen, positions);
            self.safe.clear();
            self.safe.extend_from_slice(positions);
        }
        self.seen.copy_from_slice(positions);
    }

    fn tolerance(&self) -> Real {
        let obstacles = self.obstacles.as_ref().map(ObstacleContacts::thickness);
        let thickness = obstacles.filter(|&h| h > 0.0).unwrap_or(self.thickness);
        TOLERANCE * thickness.min(self.thickness)
    }

    /// Makes sure that the candidates are those of the motion, if there are none of a motion with room for this one, and that the start is in order.
    fn prepare(&mut self, step: &ContactStep<'_>, positions: &[Vec3]) -> Result<(), ContactError> {
        if let Some(cloth) = &mut self.cloth {
            cloth.travelled(&self.seen, step.from);
            cloth.travelled(step.from, positions);
        }
        self.seen.copy_from_slice(positions);
        self.moved.fill(true);
        let strayed = |cloth: &Cloth| cloth.strayed(step.from) || cloth.strayed(positions);
        if self.cloth.as_ref().is_some_and(strayed) {
            self.search(step, positions)?;
        }
        let Some(cloth) = &mut self.cloth else {
            return Ok(());
        };
        cloth.forget_rows();
        self.report.candidates = cloth.len();
        if self.safe == step.from {
            return Ok(());
        }
        let triangles = cloth.candidates.triangles();
        let pairs = cloth.candidates.triangle_pairs().iter();
        let meet = |p: &&[u32; 2]| meet_unduly(p.map(|t| triangles[t as usize]), step.from);
        match pairs.filter(meet).count() {
            0 => {
                self.safe.clear();
                self.safe.extend_from_slice(step.from);
                Ok(())
            }
            pairs => Err(ContactError::Tangled { pairs }),
        }
    }

    /// Finds the candidates of the motion.
    fn search(&mut self, step: &ContactStep<'_>, positions: &[Vec3]) -> Result<(), ContactError> {
        self.moved.fill(true);
        // Candidates get new numbers.
        self.hits.clear();
        if let Some(cloth) = &mut self.cloth {
            let margin = MARGIN * self.thickness;
            let found = cloth.search(step.from, positions, margin);
            // Everything is finite, but a box around it need not be.
            found.map_err(|_| ContactError::NonFinite { vertex: 0 })?;
            cloth.recognise(&self.rows);
            self.report.searches += 1;
            self.report.candidates = cloth.len();
        }
        Ok(())
    }

    /// The step is resolved: it ends where the next one may start, and obstacles move on.
    fn keep(&mut self, step: &ContactStep<'_>, positions: &[Vec3]) -> Result<(), ContactError> {
        if let Some(obstacles) = &mut self.obstacles {
            // First of all whether they can.
            let stuck = |obstacle: &Obstacle| obstacle.clone().advance(step.dt).is_err();
            if obstacles.obstacles().any(stuck) {
                return Err(ContactError::NoWay { vertex: 0 });
            }
            for obstacle in obstacles.obstacles_mut() {
                let moved = obstacle.advance(step.dt);
                debug_assert!(moved.is_ok(), "just tried");
            }
        }
        self.memory.replace(&self.rows, step.dt);
        if self.cloth.is_some() {
            self.safe.copy_from_slice(positions);
        }
        Ok(())
    }
}

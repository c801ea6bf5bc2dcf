//! A cloth that passes through itself, pulled apart.
//!
//! # The idea
//!
//! Contact keeps apart what is apart. It cannot help a cloth that starts tangled, because a cloth has no inside that
//! would say which side is wrong. But where it passes through itself there is a curve, the *contour*, and without
//! tangles there is none. So Volino and Magnenat-Thalmann (2006) **shorten the contour**: its length L, a sum over
//! pairs of triangles of the segments in which they meet, has a gradient by the vertices, and cloth that goes down the
//! gradient slips apart the short way, without anybody having decided on sides.
//!
//! The ends of segments are points x at which an edge E passes through a triangle with the normal N. With displacements
//! u of the edge and w of the triangle at x,
//!
//! δx = u + E (N·(w − u))/(N·E),  δL = −Σ r·δx,
//!
//! r being the unit vector from x into its segment. The first follows from x staying on both. On the edge, x = a + s E
//! moves by u, that of its point at a fixed s, and by E δs. In the plane of the triangle, N·(δx − w) = 0, as the point
//! of the triangle that was at x has moved by w. So N·u + δs N·E = N·w, which gives δs. The second is the derivative of
//! a distance: with r from a to b, ‖b − a‖ changes by r·(δb − δa), and r at b is the opposite one.
//!
//! An edge within a cloth has two segments at x, with opposite r where the contour is straight; so the gradient is
//! large where the contour bends or ends, and when the two surfaces are nearly parallel, N·E small, it leads straight
//! away from the surface.
//!
//! An iteration moves each vertex against the gradient, times its inverse mass, by at most a quarter of an edge, and by
//! less where the contour would become longer. A gradient of length g makes a displacement of g/√(g² + 0.1²) of that:
//! nearly all where the contour ends or bends, however large g is between parallel surfaces, and little where it is
//! straight, where g is rounding or a slight bend and has no direction to follow.
//!
//! The gradient lives on the triangles that meet, and going down it alone would crease the cloth there. So
//! displacements are averaged over the edges first, which moves a fold as a whole. A round of averaging takes half of a
//! displacement to the neighbours, so n rounds spread it like a random walk, over about √(n/2) edges: two with the 8
//! rounds that are tried first, one with 2, none without. Less of it is tried only where no step down to 1/10,000
//! shortens the contour.
//!
//! Positions alone are moved; there is no elastic energy in this. An untangled cloth has mostly gone farther than it
//! had to: [`project_back`] takes it back towards where it was as far as contact with a thickness lets it.
//!
//! A simulation need not wait for that. [`StepUntangler`] takes a few iterations before each step, and lets contact
//! leave out the pairs that still cross, while all others keep their guarantee.
//!
//! It also pulls the cloth out of bodies: solids such as an arm, whose surfaces are meshes that do not move in this.
//! Where a sleeve has a hand through it, the contour goes round the arm on the surface of the body and divides that in
//! two. The smaller part, the hand, is taken to be on the wrong side, and the cloth along the contour is pushed over
//! it, with what is around. Cloth inside of a closed body is always wrong, whatever its size. What such a push has
//! moved loses its velocity against it.
//!
//! # Where shortening stalls
//!
//! A contour that goes straight across a cloth, from rim to rim, is as long wherever it is: the gradient only pinches
//! its ends. When an iteration gains less than a twentieth of the length, and the contour cuts something off, we fall
//! back on the global view of Baraff et al. (2003), in the same iteration: without the edges that pass through
//! triangles the cloth falls into components, the largest one is taken to be right, and each of the others is pushed as
//! a whole through the triangles that cut it off. What the step before has gained is kept.
//!
//! An attempt is given up after 30 iterations in which neither the number of pairs nor the length (by a twentieth) has
//! fallen. A push moves by a quarter of an edge in each, so in 30 it goes more than seven edges through the cloth.
//!
//! # Equation → code
//!
//! | equation | code |
//! |---|---|
//! | x = E ∩ triangle, and how it moves | `crossing` |
//! | L, ∂L/∂x | `contour`, [`Untangler::contour_length`] |
//! | components that are cut off, and the direction back | `components` |
//! | displacements averaged over edges | `smooth` |
//! | until no triangles meet | [`Untangler::relax`] |
//! | min ‖x − x₀‖ with layers h apart | [`project_back`] |
//! | iterations before each step of a simulation | [`StepUntangler`] |
//!
//! # Measured
//!
//! `tests/all/garments.rs` has layers pushed through each other, a sleeve through the wall of a torso, a lining turned
//! out of its sleeve, a pocket whose borders lie on the sheet, and a panel rolled up: 300 to 2500 vertices, 64 to 508
//! pairs that cross. They are apart after 1 to 13 iterations. How far the two surfaces have to part is known from how
//! they were made, 1 to 31 mm. After [`project_back`] they have shared it, and no vertex has gone farther than that.
//!
//! # Limits
//!
//! - A contour that only just leads off a body at a rim of the cloth says little about the direction, as for a hand
//!   that is half in a sleeve and half beside it; such starts stall.
//! - Prescribed vertices can make it impossible, and neither method sees far: [`UntangleOutcome::Stalled`] is an
//!   answer. Two tubes or garments through each other from rim to rim stall: either side of each could be the inside.
//!   The positions are then finite, and no more tangled than the report says.
//! - Which component is right is a guess by size, and may be the wrong one.
//! - Pushes can make the contour longer for a while.
//! - Untangled means that no triangles meet, exactly; the distance may be tiny until [`project_back`] has opened it.
//! - Edges in the plane of a triangle have no crossing point, and do not pull.
//!
//! # References
//!
//! - P. Volino and N. Magnenat-Thalmann, Resolving surface collisions through intersection contour minimization, *ACM
//!   Transactions on Graphics* 25(3), 2006. DOI 10.1145/1141911.1142007
//! - D. Baraff, A. Witkin and M. Kass, Untangling cloth, *ACM Transactions on Graphics* 22(3), 2003. DOI
//!   10.1145/882262.882357

mod back;
mod components;
mod contour;
mod crossing;
mod during;
mod smooth;

pub use back::project_back;
pub use during::{CrossingPairs, StepUntangler};

use crate::error::{CollideError, NonFinite};
use crate::potential::PotentialContacts;
use cloth_core::math::{Real, Vec3, gather};
use cloth_core::mesh::TriMesh;
use components::Components;
use contour::Contour;
use smooth::Smoother;

/// Moves a tangled cloth apart by shortening the curves in which it passes through itself.
///
/// ```
/// use cloth_collide::untangle::{UntangleOutcome, Untangler};
/// use cloth_core::math::Vec3;
/// use cloth_core::mesh::TriMesh;
///
/// // A corner (m) of one triangle has gone through another.
/// let floor = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)];
/// let other = [(0.3, 0.3, -0.05), (0.5, 0.3, 0.4), (0.3, 0.5, 0.4)];
/// let mut x: Vec<_> = floor.iter().chain(&other).map(|&(x, y, z)| Vec3::new(x, y, z)).collect();
/// let mesh = TriMesh::new(x.clone(), vec![[0, 1, 2], [3, 4, 5]])?;
/// let report = Untangler::new(&mesh).relax(&mut x, &[1.0; 6], 20, |_| ())?;
/// assert_eq!((report.outcome, report.pairs_after), (UntangleOutcome::Untangled, 0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Untangler {
    contour: Contour,
    components: Components,
    smoother: Smoother,
    /// A quarter of the mean length of the sides of the rest shape (m): no vertex moves by more in an iteration.
    longest_step: Real,
    gradient: Vec<Vec3>,
    trial: Vec<Vec3>,
}

/// How an attempt to untangle ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UntangleOutcome {
    /// No two triangles meet.
    Untangled,
    /// Nothing more can be done: no small motion makes the contour shorter, and nothing is cut off that can be pushed
    /// back with success.
    Stalled,
    /// The iterations were spent before one of these.
    BudgetSpent,
}

/// What an attempt to untangle did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UntangleReport {
    /// Pairs of triangles that met at the start, counted exactly as by [`SeparationProbe`](crate::SeparationProbe).
    pub pairs_before: usize,
    /// Pairs that meet at the end.
    pub pairs_after: usize,
    /// Length of the contour at the start (m).
    pub length_before: Real,
    /// Length at the end (m).
    pub length_after: Real,
    /// Iterations: gradients taken.
    pub iterations: u32,
    /// How it ended.
    pub outcome: UntangleOutcome,
}

/// Where an attempt to untangle is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UntangleProgress {
    /// Iterations so far.
    pub iterations: u32,
    /// Pairs of triangles that meet now.
    pub pairs: usize,
    /// Length of the contour now (m).
    pub length: Real,
}

/// What is around a cloth that is pulled apart.
#[derive(Clone, Copy, Debug, Default)]
struct World<'a> {
    /// Of all vertices (1/kg), 0 for prescribed ones and those of bodies.
    inverse_mass: &'a [Real],
    /// What keeps it from itself and from bodies, in a simulation.
    contacts: Option<&'a PotentialContacts>,
}

impl World<'_> {
    /// Whether two triangles should not meet.
    fn counts(&self, corners: [[u32; 3]; 2]) -> bool {
        let is_free = |&v: &u32| self.inverse_mass[v as usize] > 0.0;
        self.contacts.is_none_or(|contacts| {
            contacts
                .near()
                .keeps_apart(corners, corners.iter().flatten().any(is_free))
        })
    }

    /// Whether a vertex is inside of a body that has an inside.
    fn is_inside(&self, vertex: u32, positions: &[Vec3]) -> bool {
        let contacts = self.contacts;
        contacts.is_some_and(|contacts| contacts.contain(vertex, positions[vertex as usize]))
    }
}

/// Gradients g (dimensionless) become g/√(g² + this²): about 1 long well above this, ten times as long well below.
const SOFT: Real = 0.1;
/// Rounds of averaging, of one descent after the other; the next is tried if no step of this one shortens the contour.
const SMOOTHINGS: [u32; 3] = [8, 2, 0];
/// The same of what is pushed in a simulation, where elasticity pulls back what is moved alone.
const PUSH_SMOOTHINGS: u32 = 40;
/// A step that leaves more than this fraction of the length is not worth while,
const WORTHWHILE: Real = 0.95;
/// and an attempt is given up after this many iterations without fewer pairs or a length worth while.
const STALL_LIMIT: u32 = 30;
/// Shortest step, as a fraction of the longest.
const SHORTEST: Real = 1e-4;

impl Untangler {
    /// For the cloth `mesh`, whose rest shape sets the length of a step.
    #[must_use]
    pub fn new(mesh: &TriMesh) -> Self {
        Self::among(mesh, mesh.vertex_count(), &[])
    }

    /// For the first `cloth` vertices of `mesh`, with pairs of them that are sewn together; what follows
    /// are bodies.
    fn among(mesh: &TriMesh, cloth: usize, sewn: &[[u32; 2]]) -> Self {
        let side = |t: [u32; 3]| {
            let [a, b, c] = gather(mesh.positions(), t);
            ((b - a).norm() + (c - b).norm() + (a - c).norm()) / 3.0
        };
        let own = mesh.triangles().iter().copied();
        let own = own.filter(|t| (t[0] as usize) < cloth).map(side);
        let (count, sum) = own.fold((0, 0.0), |(count, sum), side| (count + 1, sum + side));
        let zeros = vec![Vec3::zeros(); mesh.vertex_count()];
        Self {
            contour: Contour::new(mesh),
            components: Components::new(mesh, sewn),
            smoother: Smoother::new(mesh, sewn),
            longest_step: 0.25 * sum / Real::from(count),
            gradient: zeros.clone(),
            trial: zeros,
        }
    }

    /// Length of the contour (m) at `positions` (m), and into `gradient` its gradient by them (dimensionless).
    ///
    /// # Errors
    /// [`CollideError::NonFinitePosition`].
    ///
    /// # Panics
    /// If there is not one position and one place for a gradient per vertex.
    pub fn contour_length(
        &mut self,
        positions: &[Vec3],
        gradient: &mut [Vec3],
    ) -> Result<Real, CollideError> {
        assert_eq!(gradient.len(), self.trial.len(), "one gradient a vertex");
        self.contour.find(positions, World::default())?;
        self.contour.gradient(gradient);
        Ok(self.contour.length())
    }

    /// The pairs of triangles that met at the positions of the last call: those that an attempt to untangle has left.
    #[must_use]
    pub fn pairs(&self) -> &[[u32; 2]] {
        &self.contour.meeting
    }

    /// Moves `positions` (m) until no two triangles meet, for at most `most_iterations`, and tells `after` about the
    /// start and about every iteration. Vertices with an `inverse_mass` (1/kg) of 0 stay; of the others, heavy ones
    /// move less. Where that does not succeed, the positions are those with the fewest pairs. Equal inputs give equal
    /// results, to the bit.
    ///
    /// # Errors
    /// [`CollideError::NonFinitePosition`]; the positions are as they were.
    ///
    /// # Panics
    /// If there is not one position and one inverse mass per vertex.
    pub fn relax(
        &mut self,
        positions: &mut [Vec3],
        inverse_mass: &[Real],
        most_iterations: u32,
        mut after: impl FnMut(UntangleProgress),
    ) -> Result<UntangleReport, CollideError> {
        assert_eq!(positions.len(), self.trial.len(), "one position a vertex");
        assert_eq!(inverse_mass.len(), self.trial.len(), "one mass a vertex");
        let world = World {
            inverse_mass,
            contacts: None,
        };
        self.contour.find(positions, world)?;
        let mut report = UntangleReport {
            pairs_before: self.contour.meeting.len(),
            pairs_after: self.contour.meeting.len(),
            length_before: self.contour.length(),
            length_after: self.contour.length(),
            iterations: 0,
            outcome: UntangleOutcome::Stalled,
        };
        let mut x = positions.to_vec();
        // When there were fewer pairs, or a length worth while, for the last time; and that length.
        let (mut improved, mut shortest) = (0, report.length_before);
        loop {
            let (pairs, length) = (self.contour.meeting.len(), self.contour.length());
            after(UntangleProgress {
                iterations: report.iterations,
                pairs,
                length,
            });
            if pairs < report.pairs_after || length < WORTHWHILE * shortest {
                (improved, shortest) = (report.iterations, length.min(shortest));
            }
            if pairs < report.pairs_after {
                positions.copy_from_slice(&x);
                (report.pairs_after, report.length_after) = (pairs, length);
            }
            report.outcome = match pairs {
                0 => UntangleOutcome::Untangled,
                _ if report.iterations == most_iterations => UntangleOutcome::BudgetSpent,
                _ if report.iterations - improved >= STALL_LIMIT => UntangleOutcome::Stalled,
                _ => {
                    report.iterations += 1;
                    self.iterate(&mut x, world)?;
                    continue;
                }
            };
            self.contour.find(positions, world)?;
            return Ok(report);
        }
    }

    /// One iteration from positions (m) whose contour has just been found: shortens it, with as much averaging as lets
    /// a step do that, and pushes what is cut off unless that step was worth while.
    fn iterate(&mut self, positions: &mut [Vec3], world: World<'_>) -> Result<(), NonFinite> {
        let before = self.contour.length();
        for rounds in SMOOTHINGS {
            let taken = self.descend(positions, world, rounds, self.longest_step)?;
            if taken.is_some() && self.contour.length() < WORTHWHILE * before {
                return Ok(());
            }
            self.contour.find(positions, world)?;
            if taken.is_some() {
                break;
            }
        }
        self.push(positions, world)?;
        Ok(())
    }
    /// Goes down the gradient, averaged in `rounds` rounds, by `step` (m) or less, so that the contour becomes shorter
    /// or goes away. How far it went, if it does.
    fn descend(
        &mut self,
        positions: &mut [Vec3],
        world: World<'_>,
        rounds: u32,
        step: Real,
    ) -> Result<Option<Real>, NonFinite> {
        self.contour.gradient(&mut self.gradient);
        self.scale(world.inverse_mass);
        self.smoother
            .smooth(&mut self.gradient, world.inverse_mass, rounds);
        let before = self.contour.length();
        let mut step = step;
        while step >= SHORTEST * self.longest_step {
            let all = self.trial.iter_mut().zip(&*positions).zip(&self.gradient);
            for ((trial, x), g) in all {
                *trial = x - g * step;
            }
            self.contour.find(&self.trial, world)?;
            if self.contour.length() < before || self.contour.meeting.is_empty() {
                positions.copy_from_slice(&self.trial);
                return Ok(Some(step));
            }
            step *= 0.5;
        }
        Ok(None)
    }

    /// Makes displacements of the gradient: by mass, and none longer than 1.
    fn scale(&mut self, inverse_mass: &[Real]) {
        let lightest = inverse_mass.iter().copied().fold(0.0, Real::max);
        for (g, w) in self.gradient.iter_mut().zip(inverse_mass) {
            let soft = (g.norm_squared() + SOFT * SOFT).sqrt();
            *g *= if lightest > 0.0 {
                w / lightest / soft
            } else {
                0.0
            };
        }
    }

    /// Pushes what is cut off back by the longest step. Whether anything is, and can move.
    fn push(&mut self, positions: &mut [Vec3], world: World<'_>) -> Result<bool, NonFinite> {
        let is_inside = |vertex| world.is_inside(vertex, positions);
        if !self.components.divide(self.contour.crossings(), is_inside) {
            return Ok(false);
        }
        let is_body = |v| {
            world
                .contacts
                .is_some_and(|contacts| contacts.near().body_of(v).is_some())
        };
        self.components.push(positions, is_body, &mut self.gradient);
        self.scale(world.inverse_mass);
        if world.contacts.is_some() {
            self.smoother
                .smooth(&mut self.gradient, world.inverse_mass, PUSH_SMOOTHINGS);
            let longest = self.gradient.iter().map(|g| g.norm());
            let longest = longest.fold(0.0, Real::max);
            if longest > 0.0 {
                self.gradient.iter_mut().for_each(|g| *g /= longest);
            }
        }
        if self.gradient.iter().all(|g| *g == Vec3::zeros()) {
            return Ok(false);
        }
        for (x, g) in positions.iter_mut().zip(&self.gradient) {
            *x -= g * self.longest_step;
        }
        self.contour.find(positions, world)?;
        Ok(true)
    }
}

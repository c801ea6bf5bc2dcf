//! L-BFGS that starts from the constant matrix (T. Liu, S. Bouaziz, L. Kavan, "Quasi-Newton methods for real-time
//! simulation of hyperelastic materials", 2017, algorithm 2), and its line search.
//!
//! *Direction.* With pairs s = Δx, y = Δ∇G, the newest first: a = s·r/(s·y), r ← r − a y, from r = −∇G; then one global
//! solve, d = A⁻¹ r (and the coarse correction); then, the oldest first, d ← d + (a − y·d/(s·y)) s (the two-loop
//! recursion, Nocedal and Wright 2006, algorithm 7.4; `limited_memory.rs` takes the same products in one pass).
//!
//! *Why the two loops.* Along s the inverse Hessian B has to turn y into s, as it does where `G` is quadratic. BFGS
//! changes the B of before into
//!
//! `B⁺ = (I − s yᵀ/(s·y)) B (I − y sᵀ/(s·y)) + s sᵀ/(s·y)`.
//!
//! B⁺y = s, as the bracket after B is 0 on y. With r′ = r − a y, a = s·r/(s·y), it is rᵀB⁺r = r′ᵀB r′ + (s·r)²/(s·y),
//! so where s·y > 0 and B is positive definite B⁺ is too: for both terms to vanish r = a y and a = 0, hence r = 0. And
//! `B⁺r = B r′ + (a − y·(B r′)/(s·y)) s`: a first loop makes r′ with the newest pair outermost, then comes the B before
//! the oldest pair, A⁻¹, and a second loop adds the rest from the inside out. No matrix is kept. Without pairs it is
//! the plain iteration.
//!
//! *Pairs.* A step begins without any: its x̃, and so its `G`, is another. With pairs of the step before, full steps
//! were often refused, and the line search had to shorten them. A failed direction clears them too. Armijo's condition
//! alone does not make yᵀs positive for a step s and its change y of the gradient; [`LimitedMemory`] leaves out a pair
//! of which it is not, so B stays positive definite.
//!
//! *Line search.* Length 1 first; accepted where G has fallen by 10⁻⁴ ([`ARMIJO`]) of length times slope. The next
//! length is where the parabola through both values and the slope has its minimum, but between a tenth and a half of
//! the last: with the slope g·d < 0 and a rise r of `G` over the length t, `G + (g·d) τ + (r − t g·d) τ²/t²` has it at
//! `τ = −(g·d) t²/(2 (r − t g·d))`. Twelve are tried. A trial costs one evaluation of `G` and `∇G` (a local step) and
//! no solve, and the accepted one is the evaluation that the next iteration needs. So an iteration that does not
//! backtrack costs as much as a plain one, and the products with the pairs.
//!
//! *In contact* the direction is that of `newton.rs`, and no pairs are kept. It does not account for contacts that are
//! not active yet: where cloth is light and soft it can be many times as long as the cloth. Detection then has all of
//! that path to search, and truncation vertex by vertex leaves nothing of its shape. So the whole direction is first
//! scaled down to a trust radius ([`TrustRadius`]). It begins at twice the longest displacement of the step without
//! elasticity; an iteration that is cut below half of what was tried shrinks it to twice what it came to, one that only
//! the radius has cut doubles it.
//!
//! *Where it is slow.* From half of the most iterations of a step on, the direction is that of `newton.rs` without
//! contact too: light cloth that is drawn along by an edge folds anew in each step, and the pairs do not follow. Of
//! twenty steps of a sheet of 33 × 33 vertices whose edge goes from rest to 2 m/s in the first, three do not end within
//! 300 iterations, and so all do (`tests/chapter/step.rs` has a step of that kind). Sooner it takes more time, from two
//! thirds on too few iterations are left.
//!
//! *Where it fails.* A direction that ascends, or twelve lengths in vain: the pairs are cleared, and −A⁻¹∇G is taken,
//! without the coarse grid. With the whole matrix, no contact and no air it lowers G by proof (`objective.rs`) and is
//! not searched. With bending left out, or the drag of the air, it is searched if G rises; if none of twelve lengths
//! will do, the last is taken, at most 2⁻¹¹ of the direction, even if G has risen there. In contact it is always
//! searched; if that fails the step ends where it is, with [`BudgetSpent`](cloth_core::step::Outcome::BudgetSpent).
//!
//! *The weight* w is in E and in A alike ([crate page](crate#idea)): another w is another material. (Hyperelastic
//! energies, which are not here, have a w that shapes A alone; Liu et al. fit it by linear regression to the stress.)
//!
//! *Tried in vain* against missing folds ([limits](crate#limits)): a start extrapolated with the last change of
//! velocity, pairs kept from the step before, hats that are splines, blocks of the Hessian's diagonal as a third term.

mod memory;

use crate::coarse::CoarseGrid;
use crate::contact::{Contact, ContactSystem};
use crate::global::GlobalSystem;
use crate::newton::TruncatedNewton;
use crate::objective::{Objective, Point};
use cloth_core::contact::ContactError;
use cloth_core::math::{Real, Vec3};
use cloth_core::method::line_search::{ARMIJO, Found, Trial, backtrack};
use cloth_core::method::parallel::join;
use cloth_core::method::pieces::Pieces;
use cloth_core::method::trust::{TrustRadius, longest};
use cloth_core::method::vectors::dot;
use memory::Memory;

/// Two values of `G` that differ by less than this fraction of their size cannot be told apart.
pub(crate) const ROUNDING: Real = 1e-12;
/// Fraction of the first slope that the slope at the new point may have, with either sign, where values cannot be told
/// apart: looser than the 0.8 of `cloth-massspring`, which bounds one sign only.
const APPROXIMATE_WOLFE: Real = 0.9;
/// Step lengths tried along one direction, each at most half of the one before. Few, as a plain iteration comes next.
const MAX_TRIALS: u32 = 12;
/// Least number of pairs in a step that was given contacts, none of them active: with one, no pairs are kept.
const CONTACT_HISTORY: usize = 20;
/// First trust radius of a step with contact, over the longest displacement that it would have without elasticity:
/// farther than that a direction may reach, but not the cloth.
const INITIAL_RADIUS_RATIO: Real = 2.0;
/// Where that is below this fraction of the first direction, elasticity or bodies alone move the cloth, and the first
/// radius is infinite.
const MIN_RADIUS_RATIO: Real = 0.01;
/// Factor on the radius after a step that only the radius has shortened.
const RADIUS_GROWTH: Real = 2.0;
/// A step that comes less far than this fraction of what was tried shrinks the radius.
const RADIUS_SHRINK_BELOW: Real = 0.5;

/// The remembered pairs and the working memory.
#[derive(Debug)]
pub(crate) struct QuasiNewton {
    /// Pairs that were asked for.
    requested: usize,
    memory: Memory,
    work: Vec<Vec3>,
    /// The direction of descent (m), and the slope of `G` along it (J).
    direction: Vec<Vec3>,
    slope: Real,
    /// Of each piece `gᵀ B g` (J) with the last direction before anything shortened it, B the inverse Hessian of the
    /// method: the square of the Newton decrement. Empty where it is not known.
    decrements: Vec<Real>,
    /// Pieces that have ended, of several that are not in contact; empty where none has.
    ended: Vec<bool>,
    next: Point,
    /// In steps with contact, from the first direction on; and the first radius (m).
    radius: Option<TrustRadius>,
    first_radius: Real,
    /// Made in the first step with contact; and the fraction of its displacement that each vertex may take
    /// (dimensionless).
    contact_system: Option<ContactSystem>,
    newton: Option<TruncatedNewton>,
    fractions: Vec<Real>,
    /// Iterations in this step, and of these the ones before directions are those of Newton's method anyway.
    iterations: u32,
    before_newton: u32,
}

impl QuasiNewton {
    pub(crate) fn new(history: usize, pieces: &Pieces) -> Self {
        let vertex_count = pieces.vertex_count();
        let zeros = vec![Vec3::zeros(); vertex_count];
        Self {
            requested: history,
            memory: Memory::new(pieces, history),
            work: zeros.clone(),
            direction: zeros,
            slope: 0.0,
            decrements: Vec::new(),
            ended: Vec::new(),
            next: Point::new(vertex_count),
            radius: None,
            first_radius: 0.0,
            contact_system: None,
            newton: None,
            fractions: Vec::new(),
            iterations: 0,
            before_newton: u32::MAX,
        }
    }

    /// Clears all pairs. In a step with contact, which is given by its displacements (m) without elasticity, there are
    /// more of them, if any, and a trust radius. After `before_newton` iterations directions are those of Newton's
    /// method.
    pub(crate) fn begin(&mut self, in_contact: Option<&[Vec3]>, before_newton: u32) {
        (self.iterations, self.before_newton) = (0, before_newton);
        self.ended.clear();
        self.radius = None;
        self.first_radius = INITIAL_RADIUS_RATIO * in_contact.map_or(0.0, longest);
        self.memory.clear_for(match (self.requested, in_contact) {
            (0, _) => 0,
            (requested, Some(_)) => requested.max(CONTACT_HISTORY),
            (requested, None) => requested,
        });
    }

    /// Moves the evaluated `point` to a lower one, evaluated too.
    pub(crate) fn advance(
        &mut self,
        objective: &mut Objective,
        global: &mut GlobalSystem,
        coarse: Option<&mut CoarseGrid>,
        point: &mut Point,
        contact: &mut Contact<'_>,
    ) -> Result<Advance, ContactError> {
        self.linearize_contacts(objective, point, contact);
        let mut done = Advance::default();
        self.iterations += 1;
        if self.uses_newton_direction() {
            done.solves = 1;
            done.linear_iterations = self.find_newton_direction(objective, point, contact);
            if let Some(contact) = contact {
                contact.update_multipliers(&point.positions, &self.direction);
            }
        } else {
            done.solves = self.find_direction(global, coarse, point);
        }
        if !self.ended.is_empty() && !self.uses_newton_direction() {
            objective.pieces.clear(&self.ended, &mut self.direction);
            self.slope = dot(&point.gradient, &self.direction);
        }
        let (gradient, direction) = (&point.gradient, &self.direction);
        let along = |vertex: usize| -gradient[vertex].dot(&direction[vertex]);
        objective.pieces.sum(&mut self.decrements, along);
        if self.slope >= 0.0 {
            self.decrements.clear(); // the pairs mislead
        }
        let found = match contact {
            None => self.search(objective, point, 1.0, contact, &mut done),
            Some(_) => self.search_in_contact(objective, point, contact, &mut done)?,
        };
        if let Some(length) = found {
            self.accept(point, length);
            return Ok(done);
        }
        // The pairs or the coarse grid mislead here, or displacements are truncated so unequally that they ascend.
        // A plain iteration needs no search: it minimises a bound of G, as long as the matrix has all families; where
        // it lacks one that has come to count, because springs beside it are gone, the length that is found is taken,
        // or the last that was tried, which is next to nothing.
        self.memory.clear();
        self.decrements.clear();
        done.solves += self.find_plain_direction(global, point);
        if contact.is_some() {
            self.shorten_to_radius();
            let most = self.limit(point, contact)?;
            self.slope = dot(&point.gradient, &self.direction);
            let found = self.search(objective, point, most, contact, &mut done);
            done.is_stuck = found.is_none();
            if let Some(length) = found {
                self.accept(point, length);
            }
            return Ok(done);
        }
        self.next.move_to(&point.displacement, &self.direction, 1.0);
        objective.evaluate(&mut self.next, contact);
        let rise = self.next.value - point.value;
        let is_higher = rise.is_nan() || rise > ROUNDING * point.size.max(self.next.size);
        let mut length = 1.0;
        if is_higher && (!global.is_whole() || objective.is_dragged()) {
            length = self
                .backtrack(objective, point, 1.0, contact, &mut done)
                .length;
        }
        self.accept(point, length);
        Ok(done)
    }

    /// Searches along the direction as far as it is trusted, with each vertex as far as it alone may follow it, and
    /// where that leads nowhere, with all vertices as far as the last may: what is left of a direction vertex by vertex
    /// need not descend. Returns the length at which a lower point was found.
    fn search_in_contact(
        &mut self,
        objective: &mut Objective,
        point: &Point,
        contact: &mut Contact<'_>,
        done: &mut Advance,
    ) -> Result<Option<Real>, ContactError> {
        let is_shortened = self.shorten_to_radius();
        let tried = longest(&self.direction);
        if self.uses_newton_direction()
            && let Some(newton) = &mut self.newton
        {
            newton.correct(contact, &point.positions, &mut self.direction);
        }
        self.work.copy_from_slice(&self.direction);
        self.limit_each(point, contact)?;
        self.slope = dot(&point.gradient, &self.direction);
        let left = longest(&self.direction);
        let found = self.search(objective, point, 1.0, contact, done);
        let (length, displacement) = match found {
            Some(length) => (length, length * left),
            None => {
                std::mem::swap(&mut self.work, &mut self.direction);
                self.slope = dot(&point.gradient, &self.direction);
                let most = self.limit(point, contact)?;
                match self.search(objective, point, most, contact, done) {
                    Some(length) => (length, length * tried),
                    None => return Ok(None),
                }
            }
        };
        if let Some(radius) = &mut self.radius {
            if displacement < RADIUS_SHRINK_BELOW * tried {
                radius.shorten(displacement);
            } else if is_shortened {
                radius.grow();
            }
        }
        Ok(Some(length))
    }

    /// Keeps the direction within the trust radius. Returns whether it was longer.
    fn shorten_to_radius(&mut self) -> bool {
        let (first, direction) = (self.first_radius, &self.direction);
        let radius = self.radius.get_or_insert_with(|| {
            let is_elastic = first < MIN_RADIUS_RATIO * longest(direction);
            let first = if is_elastic { Real::INFINITY } else { first };
            TrustRadius::new(first, RADIUS_GROWTH)
        });
        let fraction = radius.trust(&self.direction).fraction;
        if fraction < 1.0 {
            self.direction.iter_mut().for_each(|d| *d *= fraction);
        }
        fraction < 1.0
    }

    /// Whether directions are those of Newton's method: a contact was active where the last iteration began, or there
    /// were many.
    pub(crate) fn uses_newton_direction(&self) -> bool {
        let system = self.contact_system.as_ref();
        let is_in_contact = system.is_some_and(|system| !system.rows.is_empty());
        self.requested > 0 && (is_in_contact || self.iterations > self.before_newton)
    }

    /// `direction` by [`TruncatedNewton`]; pairs do not go with it. Returns the number of iterations of conjugate
    /// gradients.
    fn find_newton_direction(
        &mut self,
        objective: &Objective,
        point: &Point,
        contact: &Contact<'_>,
    ) -> u32 {
        self.memory.clear();
        let newton = self
            .newton
            .get_or_insert_with(|| TruncatedNewton::new(objective));
        let iterations = newton.find(objective, contact, point, &mut self.direction);
        self.slope = dot(&point.gradient, &self.direction);
        iterations
    }

    /// The pattern of the Hessian, or what can move, has changed.
    pub(crate) fn forget_hessian(&mut self) {
        self.newton = None;
    }

    /// Elements couple other vertices.
    pub(crate) fn set_pieces(&mut self, pieces: &Pieces) {
        self.memory.set_pieces(pieces);
    }

    /// Linearises the contacts at the point.
    pub(crate) fn linearize_contacts(
        &mut self,
        objective: &Objective,
        point: &Point,
        contact: &Contact<'_>,
    ) {
        let count = point.positions.len();
        if contact.is_some() && self.contact_system.is_none() {
            self.contact_system = Some(ContactSystem::new(count));
        }
        if let Some(contact_system) = &mut self.contact_system {
            contact_system.find(contact, &point.positions, &objective.particles);
        }
    }

    /// The square of the Newton decrement (J) of each piece where the last iteration began, if it is known.
    pub(crate) fn decrements(&self) -> Option<&[Real]> {
        (!self.decrements.is_empty()).then_some(&self.decrements[..])
    }

    /// Leaves pieces where they are from now on in this step, if there are others. What is left of their forces is
    /// rounding, or near it, and pairs of such forces lead anywhere, which the values of all pieces together do not show.
    pub(crate) fn end(&mut self, ended: &[bool]) {
        self.ended.clear();
        if ended.contains(&true) && ended.contains(&false) {
            self.ended.extend_from_slice(ended);
        }
    }

    /// The contacts of the last point, if there can be any.
    pub(crate) fn contact_system(&self) -> Option<&ContactSystem> {
        self.contact_system.as_ref()
    }

    /// One solve without pairs and without the coarse grid: `direction = −(A + contacts)⁻¹ g`. Returns the number of
    /// global solves.
    fn find_plain_direction(&mut self, global: &mut GlobalSystem, point: &Point) -> u32 {
        self.work.copy_from_slice(&point.gradient);
        self.work.iter_mut().for_each(|g| *g = -*g);
        let solves = solve(
            &mut self.contact_system,
            global,
            &self.work,
            &mut self.direction,
        );
        self.slope = dot(&point.gradient, &self.direction);
        solves
    }

    /// Truncates the direction vertex by vertex, so that the path along it is free of intersections.
    fn limit_each(&mut self, point: &Point, contact: &mut Contact<'_>) -> Result<(), ContactError> {
        let Some(contact) = contact else {
            return Ok(());
        };
        self.write_positions(point);
        self.fractions.resize(point.positions.len(), 1.0);
        contact.limit_each(
            &point.positions,
            &mut self.next.positions,
            &mut self.fractions,
        )?;
        for (d, fraction) in self.direction.iter_mut().zip(&self.fractions) {
            if *fraction < 1.0 {
                *d *= *fraction;
            }
        }
        Ok(())
    }

    /// The fraction of the direction that is free of intersections.
    fn limit(&mut self, point: &Point, contact: &mut Contact<'_>) -> Result<Real, ContactError> {
        let Some(contact) = contact else {
            return Ok(1.0);
        };
        self.write_positions(point);
        contact.limit(&point.positions, &self.next.positions)
    }

    /// Fills in the positions (m) at the end of the direction.
    fn write_positions(&mut self, point: &Point) {
        let moves = point.positions.iter().zip(&self.direction);
        let ends = self.next.positions.iter_mut().zip(moves);
        ends.for_each(|(to, (x, d))| *to = x + d);
    }

    /// `direction = −B g` with `B` the inverse Hessian that the pairs make of the first one. Returns the number of
    /// global solves.
    fn find_direction(
        &mut self,
        global: &mut GlobalSystem,
        coarse: Option<&mut CoarseGrid>,
        point: &Point,
    ) -> u32 {
        let mut solves = 0;
        let contact_system = &mut self.contact_system;
        // The grid knows nothing of contacts.
        let has_active_contacts = contact_system.as_ref().is_some_and(|s| !s.rows.is_empty());
        let first_inverse = |r: &[Vec3], z: &mut [Vec3]| {
            let direct = &mut *z;
            let mut solve = || solves = solve(contact_system, global, r, direct);
            match coarse {
                Some(coarse) if coarse.is_ready() && !has_active_contacts => {
                    join(r.len(), solve, || coarse.solve(r));
                    coarse.add_correction(z);
                }
                _ => solve(),
            }
        };
        let (g, work, out) = (&point.gradient, &mut self.work, &mut self.direction);
        self.slope = self.memory.direction(g, work, out, first_inverse);
        solves
    }

    /// Moves `next` along the direction, `most` times it at first, until `G` has fallen enough. Returns the length (a
    /// factor on the direction) at which it has.
    fn search(
        &mut self,
        objective: &mut Objective,
        point: &Point,
        most: Real,
        contact: &Contact<'_>,
        done: &mut Advance,
    ) -> Option<Real> {
        if self.slope.is_nan() || self.slope >= 0.0 {
            return None;
        }
        let found = self.backtrack(objective, point, most, contact, done);
        found.accepted.then_some(found.length)
    }

    /// The search itself; `next` is at the last length that was tried.
    ///
    /// Armijo's condition compares two values of `G`, which near the minimum agree in all digits that are free of
    /// rounding. There the approximate Wolfe condition decides (Hager and Zhang, SIAM J. Optim. 16, 2005).
    fn backtrack(
        &mut self,
        objective: &mut Objective,
        point: &Point,
        most: Real,
        contact: &Contact<'_>,
        done: &mut Advance,
    ) -> Found {
        let (slope, direction, next) = (self.slope, &self.direction, &mut self.next);
        let found = backtrack(slope, most, MAX_TRIALS, |length| {
            next.move_to(&point.displacement, direction, length);
            objective.evaluate(next, contact);
            let rise = next.value - point.value;
            let is_lower = rise <= ARMIJO * length * slope;
            let is_level = rise.abs() <= ROUNDING * point.size.max(next.size);
            let is_flat = || dot(&next.gradient, direction).abs() <= APPROXIMATE_WOLFE * -slope;
            let accepted = is_lower && !is_level || is_level && is_flat();
            Trial { rise, accepted }
        });
        done.backtracks += found.backtracks;
        found
    }

    /// Makes `next`, which is `length` times the direction away, the point, and stores the difference.
    fn accept(&mut self, point: &mut Point, length: Real) {
        std::mem::swap(point, &mut self.next);
        let (old, new) = (&self.next.gradient, &point.gradient);
        let step = (length, self.slope);
        self.memory.push(step, &self.direction, old, new);
    }
}

/// What one iteration took.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Advance {
    /// Step lengths tried in vain.
    pub(crate) backtracks: u32,
    /// Linear systems solved: with the constant matrix, or for a direction of Newton's method; the iterations of the
    /// latter.
    pub(crate) solves: u32,
    pub(crate) linear_iterations: u32,
    /// Whether no lower point was found: the point is where it was.
    pub(crate) is_stuck: bool,
}

/// Solves with the constant matrix and the contacts, for `out` (m). Returns the number of global solves.
fn solve(
    contact_system: &mut Option<ContactSystem>,
    global: &mut GlobalSystem,
    g: &[Vec3],
    out: &mut [Vec3],
) -> u32 {
    if let Some(contact_system) = contact_system {
        return contact_system.solve(global, g, out);
    }
    global.solve(g, out);
    1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::local::{Family, Projections};
    use cloth_core::cloth::{Cloth, Membrane};
    use cloth_core::mesh::generate::{Diagonals, grid};
    use cloth_core::particles::State;
    use cloth_core::step::StepInput;

    /// Stiff hinges, and a matrix that has none of them, so that a plain iteration overshoots; and a pair with a wrong
    /// slope, by which the direction ascends, so that one is taken.
    #[test]
    fn g_falls_where_the_matrix_lacks_a_stiff_family() {
        let mesh = grid(5, 5, 1.0, 1.0, Diagonals::Alternating).unwrap();
        let membrane = Membrane::SpringStiffness(1e-3);
        let cloth = Cloth {
            areal_density: 0.2,
            membrane,
            bending_rigidity: 1.0,
        };
        let model = cloth.on(&mesh).unwrap();
        let families: Vec<Box<dyn Projections>> = vec![
            Box::new(Family::new(model.springs, &model.particles).unwrap()),
            Box::new(Family::new(model.hinges, &model.particles).unwrap()),
        ];
        let mut global = GlobalSystem::new(&model.particles, &families, vec![false, true]).unwrap();
        global.prepare(1.0).unwrap();
        let mut objective = Objective::new(model.particles, families);
        let state = State::at_rest(mesh.positions().to_vec());
        objective
            .begin(&state, &StepInput::new(1.0), false)
            .unwrap();
        let mut point = Point::new(25);
        for (vertex, q) in point.displacement.iter_mut().enumerate() {
            q.z = 0.1 * (vertex as Real).sin();
        }
        objective.evaluate(&mut point, &None);

        let mut plain = Point::new(25);
        let mut direction = vec![Vec3::zeros(); 25];
        global.solve(&point.gradient, &mut direction);
        plain.move_to(&point.displacement, &direction, -1.0);
        objective.evaluate(&mut plain, &None);
        assert!(plain.value > 2.0 * point.value, "{}", plain.value);

        objective.pieces = Pieces::new(&[0; 25]);
        let mut method = QuasiNewton::new(1, &objective.pieces);
        let zeros = vec![Vec3::zeros(); 25];
        let g = &point.gradient;
        method.memory.push((1.0, -1e12), g, &zeros, g);
        let before = point.value;
        let done = method.advance(&mut objective, &mut global, None, &mut point, &mut None);
        assert_eq!(done.unwrap().solves, 2);
        assert!(point.value < before, "{} {before}", point.value);
    }
}

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
//! *In contact* pairs are kept around another first inverse Hessian, and the step is bounded (`in_contact.rs`).
//!
//! *Where it is slow.* From half of the most iterations of a step on, the direction is one of Newton's method where
//! nothing touches: light cloth that is drawn along by an edge folds anew in each step, and the pairs do not follow.
//! Of twenty steps of a sheet of 33 × 33 vertices whose edge goes from rest to 2 m/s in the first, three do not end
//! within 300 iterations, and so all do (`tests/chapter/step.rs` has a step of that kind). Sooner it takes more time,
//! from two thirds on too few iterations are left.
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

mod in_contact;
mod memory;

use crate::coarse::CoarseGrid;
use crate::contact::{Contact, ContactSystem};
use crate::global::GlobalSystem;
use crate::objective::{Objective, Point};
use cloth_core::contact::ContactError;
use cloth_core::math::{Real, Vec3};
use cloth_core::method::line_search::{ARMIJO, Found, Trial, backtrack};
use cloth_core::method::parallel::join;
use cloth_core::method::pieces::Pieces;
use cloth_core::method::trust::longest;
use cloth_core::method::vectors::dot;
use in_contact::InContact;
use memory::Memory;

/// Two values of `G` that differ by less than this fraction of their size cannot be told apart.
pub(crate) const ROUNDING: Real = 1e-12;
/// Fraction of the first slope that the slope at the new point may have, with either sign, where values cannot be told
/// apart: looser than the 0.8 of `cloth-massspring`, which bounds one sign only.
const APPROXIMATE_WOLFE: Real = 0.9;
/// Step lengths tried along one direction, each at most half of the one before. Few, as a plain iteration comes next.
const MAX_TRIALS: u32 = 12;
/// Least number of pairs in a step that was given contacts.
const CONTACT_HISTORY: usize = 10;

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
    /// What conjugate gradients have left out of the square of the decrement (J).
    left: Real,
    /// Of each piece `gᵀ B g` (J) with the last direction before anything shortened it, B the inverse Hessian of the
    /// method: the square of the Newton decrement. Empty where it is not known.
    decrements: Vec<Real>,
    /// Pieces that have ended, of several that are not in contact; empty where none has.
    ended: Vec<bool>,
    next: Point,
    /// Made in the first step with contact.
    contact_system: Option<ContactSystem>,
    in_contact: InContact,
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
            left: 0.0,
            decrements: Vec::new(),
            ended: Vec::new(),
            next: Point::new(vertex_count),
            contact_system: None,
            in_contact: InContact::default(),
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
        self.in_contact.begin(in_contact.map_or(0.0, longest));
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
        if self.uses_hessian() {
            done.solves = 1;
            done.linear_iterations = self.find_hessian_direction(objective, point, contact);
            if let Some(contact) = contact.as_mut().filter(|_| self.in_contact.is_fresh()) {
                contact.update_multipliers(&point.positions, &self.direction);
            }
        } else {
            done.solves = self.find_direction(global, coarse, point);
        }
        if !self.ended.is_empty() && !self.uses_hessian() {
            objective.pieces.clear(&self.ended, &mut self.direction);
            self.slope = dot(&point.gradient, &self.direction);
        }
        let (gradient, direction) = (&point.gradient, &self.direction);
        let along = |vertex: usize| -gradient[vertex].dot(&direction[vertex]);
        objective.pieces.sum(&mut self.decrements, along);
        if self.slope >= 0.0 {
            self.decrements.clear(); // the pairs mislead
        } else if self.uses_hessian() {
            let whole = 1.0 - self.left / self.slope;
            self.decrements.iter_mut().for_each(|of| *of *= whole);
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

    /// The pattern of the Hessian, or what can move, has changed.
    pub(crate) fn forget_hessian(&mut self) {
        self.in_contact.forget_hessian();
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
        if self.makes_a_pair() {
            self.memory.push(step, &self.direction, old, new);
        }
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

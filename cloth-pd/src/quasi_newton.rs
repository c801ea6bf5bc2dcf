//! L-BFGS that starts from the constant matrix (T. Liu, S. Bouaziz, L. Kavan, "Quasi-Newton methods for real-time
//! simulation of hyperelastic materials", 2017, algorithm 2), and its line search.

use crate::coarse::CoarseGrid;
use crate::contact::{Contact, ContactSystem};
use crate::global::GlobalSystem;
use crate::objective::{Objective, Point};
use cloth_core::contact::ContactError;
use cloth_core::math::{Real, Vec3};
use cloth_core::method::chunked::map_reduce;
use cloth_core::method::parallel::join;
use cloth_core::method::trust::{TrustRadius, longest};
use cloth_core::method::vectors::{add, add_and_dot, dot, dot_of_part};

/// Part of the promised decrease that has to be kept (Armijo's constant).
const ARMIJO: Real = 1e-4;
/// Two values of `G` that differ by less than this part of their size cannot be told apart.
pub(crate) const ROUNDING: Real = 1e-12;
/// Part of the first slope that the slope at the new point may have, with either sign, where values cannot be told
/// apart.
const APPROXIMATE_WOLFE: Real = 0.9;
/// Step lengths tried along one direction; each is at most half of the one before.
const MAX_TRIALS: u32 = 12;
/// Least number of pairs in a step with contact, which is stiff, and comes and goes.
const CONTACT_HISTORY: usize = 20;
/// First trust radius of a step with contact, over the longest displacement that it would have without elasticity: what
/// is farther away is touched by a direction only, not by the cloth.
const FIRST_RADIUS: Real = 2.0;
/// Where that is below this part of the first direction, elasticity or bodies alone move the cloth, and nothing is
/// limited at first.
const ELASTIC: Real = 0.01;
/// Factor on the radius after a step that only the radius has shortened.
const RADIUS_GROWTH: Real = 2.0;
/// A step that comes less far than this part of what was tried has been shortened.
const SHORTENED: Real = 0.5;

/// One difference of iterates and of their gradients.
#[derive(Clone, Debug)]
struct Pair {
    /// s (m).
    step: Vec<Vec3>,
    /// y (N).
    change: Vec<Vec3>,
    /// `1/(s·y)` (1/J).
    inverse_product: Real,
}

/// The remembered pairs and the working memory.
#[derive(Debug)]
pub(crate) struct QuasiNewton {
    /// Pairs that were requested for, and that are remembered in this step.
    requested: usize,
    history: usize,
    /// A ring of `history`: the newest is `pairs[newest]`, `len` of them count.
    pairs: Vec<Pair>,
    newest: usize,
    len: usize,
    /// α of the first loop.
    alphas: Vec<Real>,
    work: Vec<Vec3>,
    direction: Vec<Vec3>,
    next: Point,
    /// In steps with contact, from the first direction on; and the first radius (m).
    radius: Option<TrustRadius>,
    first_radius: Real,
    /// Made in the first step with contact; and the fraction of its displacement that each vertex may take
    /// (dimensionless).
    contact_system: Option<ContactSystem>,
    fractions: Vec<Real>,
}

impl QuasiNewton {
    pub(crate) fn new(history: usize, vertex_count: usize) -> Self {
        let zeros = vec![Vec3::zeros(); vertex_count];
        let mut this = Self {
            requested: history,
            history,
            pairs: Vec::new(),
            newest: 0,
            len: 0,
            alphas: Vec::new(),
            work: zeros.clone(),
            direction: zeros,
            next: Point::new(vertex_count),
            radius: None,
            first_radius: 0.0,
            contact_system: None,
            fractions: Vec::new(),
        };
        this.begin(None);
        this
    }

    /// Clears all pairs. In a step with contact, which is given by its displacements (m) without elasticity, there are
    /// more of them, if any, and a trust radius.
    pub(crate) fn begin(&mut self, in_contact: Option<&[Vec3]>) {
        self.len = 0;
        self.radius = None;
        self.first_radius = FIRST_RADIUS * in_contact.map_or(0.0, longest);
        self.history = match (self.requested, in_contact.is_some()) {
            (0, _) => 0,
            (requested, true) => requested.max(CONTACT_HISTORY),
            (requested, false) => requested,
        };
        if self.pairs.len() < self.history {
            let zeros = vec![Vec3::zeros(); self.work.len()];
            let pair = Pair {
                step: zeros.clone(),
                change: zeros,
                inverse_product: 0.0,
            };
            self.pairs.resize(self.history, pair);
            self.alphas.resize(self.history, 0.0);
        }
    }

    /// Moves the evaluated `point` to a lower one, evaluated too.
    pub(crate) fn advance(
        &mut self,
        objective: &mut Objective,
        global: &mut GlobalSystem,
        mut coarse: Option<&mut CoarseGrid>,
        point: &mut Point,
        contact: &mut Contact<'_>,
    ) -> Result<Advance, ContactError> {
        self.linearize_contacts(objective, point, contact);
        if let (Some(coarse), Some(system)) = (&mut coarse, &self.contact_system) {
            coarse.set_contacts(&system.rows);
        }
        let mut done = Advance {
            solves: self.find_direction(global, coarse, point),
            ..Advance::default()
        };
        let is_accepted = match contact {
            None => self
                .search(objective, point, 1.0, contact, &mut done)
                .is_some(),
            Some(_) => self.search_in_contact(objective, point, contact, &mut done)?,
        };
        if is_accepted {
            self.accept(point);
            return Ok(done);
        }
        // The pairs or the coarse grid mislead here, or displacements are truncated so unequally that they ascend.
        // A plain iteration needs no search: it minimises a bound of G, as long as the matrix has all families; where
        // it lacks one that has come to count, because springs beside it are gone, the length that is found is taken,
        // or the last that was tried, which is next to nothing.
        self.len = 0;
        done.solves += self.solve(global, &point.gradient);
        if contact.is_some() {
            self.shorten_to_radius();
            let most = self.limit(point, contact)?;
            let found = self.search(objective, point, most, contact, &mut done);
            done.is_stuck = found.is_none();
            if !done.is_stuck {
                self.accept(point);
            }
            return Ok(done);
        }
        self.next
            .move_to(&point.displacement, &self.direction, -1.0);
        objective.evaluate(&mut self.next, contact);
        let rise = self.next.value - point.value;
        let is_higher = rise.is_nan() || rise > ROUNDING * point.size.max(self.next.size);
        if is_higher && !global.is_whole() {
            let _ = self.search(objective, point, 1.0, contact, &mut done);
        }
        self.accept(point);
        Ok(done)
    }

    /// Searches along the direction as far as it is trusted and each vertex may follow it. Returns whether a lower point
    /// was found.
    fn search_in_contact(
        &mut self,
        objective: &mut Objective,
        point: &Point,
        contact: &mut Contact<'_>,
        done: &mut Advance,
    ) -> Result<bool, ContactError> {
        let is_shortened = self.shorten_to_radius();
        let tried = longest(&self.direction);
        self.limit_each(point, contact)?;
        let left = longest(&self.direction);
        let Some(length) = self.search(objective, point, 1.0, contact, done) else {
            return Ok(false);
        };
        let displacement = length * left;
        if let Some(radius) = &mut self.radius {
            if displacement < SHORTENED * tried {
                radius.shorten(displacement);
            } else if is_shortened {
                radius.grow();
            }
        }
        Ok(true)
    }

    /// Keeps the direction within the trust radius. Returns whether it was longer.
    fn shorten_to_radius(&mut self) -> bool {
        let (first, direction) = (self.first_radius, &self.direction);
        let radius = self.radius.get_or_insert_with(|| {
            let is_elastic = first < ELASTIC * longest(direction);
            let first = if is_elastic { Real::INFINITY } else { first };
            TrustRadius::new(first, RADIUS_GROWTH)
        });
        let fraction = radius.trust(&self.direction).fraction;
        if fraction < 1.0 {
            self.direction.iter_mut().for_each(|p| *p *= fraction);
        }
        fraction < 1.0
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

    /// The contacts of the last point, if there can be any.
    pub(crate) fn contact_system(&self) -> Option<&ContactSystem> {
        self.contact_system.as_ref()
    }

    /// One solve without pairs and without the coarse grid: `direction = (A + contacts)⁻¹ g`. Returns the number of
    /// global solves.
    fn solve(&mut self, global: &mut GlobalSystem, g: &[Vec3]) -> u32 {
        solve(&mut self.contact_system, global, g, &mut self.direction)
    }

    /// Truncates the direction vertex by vertex, so that the path along it is free of intersections.
    fn limit_each(&mut self, point: &Point, contact: &mut Contact<'_>) -> Result<(), ContactError> {
        let Some(contact) = contact else {
            return Ok(());
        };
        self.place(point);
        self.fractions.resize(point.positions.len(), 1.0);
        contact.limit_each(
            &point.positions,
            &mut self.next.positions,
            &mut self.fractions,
        )?;
        for (p, fraction) in self.direction.iter_mut().zip(&self.fractions) {
            if *fraction < 1.0 {
                *p *= *fraction;
            }
        }
        Ok(())
    }

    /// The fraction of the direction that is free of intersections.
    fn limit(&mut self, point: &Point, contact: &mut Contact<'_>) -> Result<Real, ContactError> {
        let Some(contact) = contact else {
            return Ok(1.0);
        };
        self.place(point);
        contact.limit(&point.positions, &self.next.positions)
    }

    /// Fills in the positions (m) at the end of the direction.
    fn place(&mut self, point: &Point) {
        let moves = point.positions.iter().zip(&self.direction);
        let ends = self.next.positions.iter_mut().zip(moves);
        ends.for_each(|(to, (x, p))| *to = x - p);
    }

    /// The two-loop recursion: `direction = H g` with `H` the inverse Hessian that the pairs make of the first one.
    /// Each subtraction is done in one pass with the product that comes next.
    fn find_direction(
        &mut self,
        global: &mut GlobalSystem,
        coarse: Option<&mut CoarseGrid>,
        point: &Point,
    ) -> u32 {
        let history = self.history;
        let (pairs, newest, len) = (&self.pairs, self.newest, self.len);
        // The pair of some age, 0 the newest.
        let pair = |age: usize| (age < len).then(|| (newest + history - age) % history);
        self.work.copy_from_slice(&point.gradient);
        let mut product = pair(0).map_or(0.0, |at| dot(&pairs[at].step, &self.work));
        for age in 0..len {
            let Some(at) = pair(age) else { break };
            let alpha = pairs[at].inverse_product * product;
            self.alphas[at] = alpha;
            let next = pair(age + 1).map(|at| &pairs[at].step[..]);
            let (work, change) = (&mut self.work, &pairs[at].change);
            match next {
                Some(next) => product = add_and_dot(work, -alpha, change, next),
                None => add(work, -alpha, change),
            }
        }
        let (work, direction) = (&self.work[..], &mut self.direction[..]);
        let mut solves = 0;
        let mut solve = || solves = solve(&mut self.contact_system, global, work, direction);
        match coarse {
            Some(coarse) if coarse.is_ready() => {
                join(work.len(), solve, || coarse.solve(work));
                coarse.add_correction(&mut self.direction);
            }
            _ => solve(),
        }
        let oldest = len.checked_sub(1).and_then(pair);
        product = oldest.map_or(0.0, |at| dot(&pairs[at].change, &self.direction));
        for age in (0..len).rev() {
            let Some(at) = pair(age) else { break };
            let factor = self.alphas[at] - pairs[at].inverse_product * product;
            let next = age.checked_sub(1).and_then(pair);
            let next = next.map(|at| &pairs[at].change[..]);
            let (direction, step) = (&mut self.direction, &pairs[at].step);
            match next {
                Some(next) => product = add_and_dot(direction, factor, step, next),
                None => add(direction, factor, step),
            }
        }
        solves
    }

    /// Moves `next` against the direction, `most` times it at first, until `G` has fallen enough. Returns the length
    /// (a factor on the direction) at which it has.
    ///
    /// Armijo's condition compares two values of `G`, which near the minimum agree in all digits that are free of
    /// rounding. There the approximate Wolfe condition decides (Hager and Zhang, SIAM J. Optim. 16, 2005).
    fn search(
        &mut self,
        objective: &mut Objective,
        point: &Point,
        most: Real,
        contact: &Contact<'_>,
        done: &mut Advance,
    ) -> Option<Real> {
        let slope = -dot(&point.gradient, &self.direction);
        if slope.is_nan() || slope >= 0.0 {
            return None;
        }
        let mut length = most;
        for _ in 0..MAX_TRIALS {
            self.next
                .move_to(&point.displacement, &self.direction, -length);
            objective.evaluate(&mut self.next, contact);
            let rise = self.next.value - point.value;
            let is_lower = rise <= ARMIJO * length * slope;
            let is_level = rise.abs() <= ROUNDING * point.size.max(self.next.size);
            if is_lower && !is_level
                || is_level
                    && dot(&self.next.gradient, &self.direction).abs() <= APPROXIMATE_WOLFE * -slope
            {
                return Some(length);
            }
            done.backtracks += 1;
            // The minimum of the parabola through what is known, between a tenth and a half; a rise that is not a
            // number comes out as a tenth.
            let minimum = -0.5 * slope * length * length / (rise - slope * length);
            length = minimum.min(0.5 * length).max(0.1 * length);
        }
        None
    }

    /// Makes `next` the point and remembers the difference.
    fn accept(&mut self, point: &mut Point) {
        std::mem::swap(point, &mut self.next);
        let history = self.history;
        if history == 0 {
            return;
        }
        let slot = (self.newest + 1) % history;
        let (new, old) = (&*point, &self.next);
        let Pair { step, change, .. } = &mut self.pairs[slot];
        let [product] = map_reduce(
            (&mut step[..], &mut change[..]),
            #[inline(always)]
            |start, (step, change)| {
                let (step, change): (&mut [Vec3], &mut [Vec3]) = (step, change);
                for (vertex, (s, y)) in (start..).zip(step.iter_mut().zip(change.iter_mut())) {
                    *s = new.displacement[vertex] - old.displacement[vertex];
                    *y = new.gradient[vertex] - old.gradient[vertex];
                }
                [dot_of_part(step, change)]
            },
        );
        let pair = &mut self.pairs[slot];
        // Where G is not convex along the step, a pair would make H indefinite.
        if product > 0.0 && (1.0 / product).is_finite() {
            pair.inverse_product = 1.0 / product;
            self.newest = slot;
            self.len = (self.len + 1).min(history);
        }
    }
}

/// What one iteration took.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Advance {
    /// Step lengths tried in vain.
    pub(crate) backtracks: u32,
    /// Global solves.
    pub(crate) solves: u32,
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

    /// Stiff hinges, and a matrix that has none of them, so that a plain iteration overshoots; and a pair that makes
    /// the inverse Hessian indefinite, so that one is taken.
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
        objective.begin(&state, &StepInput::new(1.0)).unwrap();
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

        let mut method = QuasiNewton::new(1, 25);
        method.len = 1;
        method.pairs[0].step.copy_from_slice(&point.gradient);
        method.pairs[0].inverse_product = -1e9;
        let before = point.value;
        let done = method.advance(&mut objective, &mut global, None, &mut point, &mut None);
        assert_eq!(done.unwrap().solves, 2);
        assert!(point.value < before, "{} {before}", point.value);
    }
}

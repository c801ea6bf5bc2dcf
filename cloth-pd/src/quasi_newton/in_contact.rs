//! Directions and steps with active contacts.
//!
//! *The direction* is that of L-BFGS around a multigrid cycle for the Hessian with the contacts (`hessian.rs`), taken
//! anew in each of the first four iterations, while contacts come, and in every eighth from then on; the pairs are
//! kept. It does not account for contacts that are not active yet. Once five steps have come to less than a quarter of
//! their directions, directions are those of a truncated Newton method: the Hessian of each iterate, solved to a tenth.
//! What one cycle leaves of the residual would run into the next contact.
//!
//! *The step.* Where cloth is light and soft a direction can be many times as long as the cloth. Detection then has all
//! of that path to search. So the whole direction is first scaled down to a trust radius ([`TrustRadius`]). It begins
//! at twice the longest displacement of the step without elasticity; an iteration that is cut below half of what was
//! tried shrinks it to twice what it came to, one that only the radius has cut doubles it. Then all vertices follow the
//! direction up to the first contact. Where that is next to nothing each vertex goes as far as it alone can.
//!
//! *Tried.* Newton's directions from the first step that is cut on: less time, and a sheet that wraps a ball falls 3 %
//! less far. Never: a fifth more time. Newton's directions once the decrement is small: what is smooth ends with an
//! error of 10⁻⁷ in the place of 10⁻³, but that sheet falls 1 to 2 % less far. Five pairs or twenty, and steps longer
//! than the direction where much of its slope is left: no difference.

use super::{Advance, QuasiNewton};
use crate::contact::Contact;
use crate::hessian::CurrentHessian;
use crate::objective::{Objective, Point};
use cloth_core::contact::ContactError;
use cloth_core::math::Real;
use cloth_core::method::in_contact::{
    FIRST_ITERATIONS, HALVED_BELOW, MAX_SHORTENED_STEPS, REFRESH_INTERVAL, SHORTENED_BELOW,
    VERTEX_BY_VERTEX_BELOW,
};
use cloth_core::method::trust::{TrustRadius, longest};
use cloth_core::method::vectors::dot;

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

/// What is kept of the steps with active contacts.
#[derive(Debug, Default)]
pub(super) struct InContact {
    hessian: Option<CurrentHessian>,
    /// In steps with contact, from the first direction on; and the first radius (m).
    radius: Option<TrustRadius>,
    first_radius: Real,
    /// Of the displacement, what each vertex may take (dimensionless).
    fractions: Vec<Real>,
    /// Iterations of this step since the Hessian was taken; 0 where it was not.
    age: u32,
    /// Steps in this minimisation that were shortened.
    shortened_steps: u32,
    /// Whether the last step was a fraction of the last direction.
    is_along_direction: bool,
}

impl InContact {
    /// A step begins, whose longest displacement without elasticity is so long (m).
    pub(super) fn begin(&mut self, longest: Real) {
        self.radius = None;
        self.first_radius = INITIAL_RADIUS_RATIO * longest;
        (self.age, self.shortened_steps) = (0, 0);
        self.is_along_direction = true;
    }

    /// The pattern of the Hessian, or what can move, has changed.
    pub(super) fn forget_hessian(&mut self) {
        self.hessian = None;
    }

    /// Whether contact shortens steps so often that directions of L-BFGS lead nowhere.
    fn is_often_shortened(&self) -> bool {
        self.shortened_steps >= MAX_SHORTENED_STEPS
    }

    /// Whether the Hessian is that of where the last direction begins.
    pub(super) fn is_fresh(&self) -> bool {
        self.age == 1
    }
}

impl QuasiNewton {
    /// Whether directions are by the Hessian: a contact was active where the last iteration began, or there were many.
    pub(crate) fn uses_hessian(&self) -> bool {
        self.requested > 0 && (self.touches() || self.iterations > self.before_newton)
    }

    /// Whether a contact was active where the last iteration began.
    pub(crate) fn touches(&self) -> bool {
        let system = self.contact_system.as_ref();
        system.is_some_and(|system| !system.rows.is_empty())
    }

    /// Whether directions are those of the truncated Newton method.
    fn uses_newton_direction(&self) -> bool {
        self.uses_hessian() && (!self.touches() || self.in_contact.is_often_shortened())
    }

    /// `direction` by the Hessian. Returns the number of multigrid cycles.
    pub(super) fn find_hessian_direction(
        &mut self,
        objective: &Objective,
        point: &Point,
        contact: &Contact<'_>,
    ) -> u32 {
        let is_newton = self.uses_newton_direction();
        let own = &mut self.in_contact;
        let hessian = own
            .hessian
            .get_or_insert_with(|| CurrentHessian::new(objective));
        let is_new = self.iterations <= FIRST_ITERATIONS || is_newton || own.age == 0;
        if is_new {
            self.memory.clear();
        }
        if is_new || own.age >= REFRESH_INTERVAL {
            hessian.refresh(objective, contact, &point.positions);
            own.age = 0;
        }
        own.age += 1;
        let (gradient, direction) = (&point.gradient, &mut self.direction);
        if is_newton {
            let (left, cycles) = hessian.solve(gradient, direction);
            self.slope = dot(gradient, direction);
            self.left = left;
            return cycles;
        }
        self.left = 0.0;
        let inverse = |r: &[_], z: &mut [_]| hessian.precondition(r, z);
        self.slope = self
            .memory
            .direction(gradient, &mut self.work, direction, inverse);
        1
    }

    /// Whether the step along the last direction makes a pair that tells of the Hessian.
    pub(super) fn makes_a_pair(&self) -> bool {
        !self.uses_hessian()
            || (self.in_contact.is_along_direction
                && self.iterations >= FIRST_ITERATIONS
                && !self.uses_newton_direction())
    }

    /// Searches along the direction as far as it is trusted, with one length for all vertices. Where that leads nowhere,
    /// or next to nowhere, each vertex is followed as far as it alone can go: one pair that is nearly closed would hold
    /// the whole cloth. What is left of a direction vertex by vertex has lost its shape, though, and need not descend.
    /// Returns the length at which a lower point was found.
    pub(super) fn search_in_contact(
        &mut self,
        objective: &mut Objective,
        point: &Point,
        contact: &mut Contact<'_>,
        done: &mut Advance,
    ) -> Result<Option<Real>, ContactError> {
        let whole = longest(&self.direction);
        let is_within_radius = !self.shorten_to_radius();
        let tried = longest(&self.direction);
        self.in_contact.is_along_direction = true;
        let is_fresh = self.uses_hessian() && self.in_contact.is_fresh();
        if let (true, Some(hessian)) = (is_fresh, &mut self.in_contact.hessian) {
            hessian.correct(contact, &point.positions, &mut self.direction);
        }
        self.slope = dot(&point.gradient, &self.direction);
        let free = self.limit(point, contact)?;
        let most = if free < HALVED_BELOW {
            0.5 * free
        } else {
            free
        };
        let mut found = match free >= VERTEX_BY_VERTEX_BELOW {
            true => self.search(objective, point, most, contact, done),
            false => None,
        };
        let mut longest_left = tried;
        if found.is_none() {
            self.work.copy_from_slice(&self.direction);
            self.limit_each(point, contact)?;
            self.slope = dot(&point.gradient, &self.direction);
            longest_left = longest(&self.direction);
            found = self.search(objective, point, 1.0, contact, done);
            self.in_contact.is_along_direction = found.is_none();
        }
        if found.is_none() && free < VERTEX_BY_VERTEX_BELOW {
            std::mem::swap(&mut self.work, &mut self.direction);
            self.slope = dot(&point.gradient, &self.direction);
            longest_left = tried;
            let most = self.limit(point, contact)?;
            found = self.search(objective, point, most, contact, done);
        }
        if let Some(length) = found {
            let own = &mut self.in_contact;
            let displacement = length * longest_left;
            own.shortened_steps += u32::from(displacement < SHORTENED_BELOW * whole);
            if let Some(radius) = &mut own.radius {
                if displacement < RADIUS_SHRINK_BELOW * tried {
                    radius.shorten(displacement);
                } else if !is_within_radius {
                    radius.grow();
                }
            }
        }
        Ok(found)
    }

    /// Keeps the direction within the trust radius. Returns whether it was longer.
    pub(super) fn shorten_to_radius(&mut self) -> bool {
        let own = &mut self.in_contact;
        let (first, direction) = (own.first_radius, &self.direction);
        let radius = own.radius.get_or_insert_with(|| {
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

    /// Truncates the direction vertex by vertex, so that the path along it is free of intersections.
    fn limit_each(&mut self, point: &Point, contact: &mut Contact<'_>) -> Result<(), ContactError> {
        let Some(contact) = contact else {
            return Ok(());
        };
        self.write_positions(point);
        let fractions = &mut self.in_contact.fractions;
        fractions.resize(point.positions.len(), 1.0);
        contact.limit_each(&point.positions, &mut self.next.positions, fractions)?;
        for (d, fraction) in self.direction.iter_mut().zip(fractions) {
            if *fraction < 1.0 {
                *d *= *fraction;
            }
        }
        Ok(())
    }

    /// The fraction of the direction that is free of intersections.
    pub(super) fn limit(
        &mut self,
        point: &Point,
        contact: &mut Contact<'_>,
    ) -> Result<Real, ContactError> {
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
}

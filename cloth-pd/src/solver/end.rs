//! Convergence tests of a step.

use super::{DECREASE_WINDOW, Method, PdSolver};
use crate::contact::Contact;
use crate::objective::{Objective, Point, Squares};
use cloth_core::math::{Real, Vec3};
use cloth_core::step::StepReport;

/// What is left of the forces in a step with contact that is done, over those that it takes to end where it does.
const BALANCE_TOLERANCE: Real = 1e-8;
/// The same over the tolerance of the velocities, in a step that goes on until these are near enough. Where the Hessian
/// of `G` is at least M/Δt² (no compressed elements) the change of velocity by elastic and contact forces, (x − x̃)/Δt,
/// is off by no more than this fraction of it, in the norm of M.
const BALANCED_VELOCITIES: Real = 1e-4;
/// A change of velocity below this fraction of the velocity counts as zero: in free fall forces are rounding.
const NEGLIGIBLE_SPEED: Real = 1e-6;
/// So does, in a step, a way that is this fraction of the distance from the origin: what is stretched and at rest
/// without gravity has no other velocity to compare with, and ends at rounding.
const NEGLIGIBLE_WAY: Real = 1e-10;

/// A piece with an error (squared) below this fraction of what is asked for has ended.
const ENDED: Real = 1e-2;

/// An error beyond this many times what is asked for, after a smaller one than that, is a relapse; and how many errors
/// in a row have to be small from then on.
const RELAPSE: Real = 10.0;
const STEADY: u32 = 5;

/// Errors of a step that came back after they had been small. Where cloth is squeezed between a body and another, a
/// direction that only takes a pair apart again that is much too near has a small decrement, and the next one does not.
#[derive(Debug, Default)]
pub(super) struct Relapses {
    small: u32,
    has_relapsed: bool,
}

impl Relapses {
    /// Whether both errors of an iteration, over what is asked for, are small enough after those before it.
    pub(super) fn accepts(&mut self, [by_decrement, by_decrease]: [Real; 2]) -> bool {
        if by_decrement <= 1.0 {
            self.small += 1;
        } else {
            self.has_relapsed |= self.small > 0 && by_decrement > RELAPSE;
            self.small = 0;
        }
        self.small >= if self.has_relapsed { STEADY } else { 1 } && by_decrease <= 1.0
    }
}

/// What is known of each piece at a point.
#[derive(Debug, Default)]
pub(super) struct PieceNorms {
    /// Empty until somebody has asked for them at this point.
    squares: Vec<Squares>,
    /// Which pieces have ended.
    ended: Vec<bool>,
}

impl PieceNorms {
    /// The point is another one.
    pub(super) fn forget(&mut self) {
        self.squares.clear();
    }

    fn find(&mut self, objective: &Objective, point: &Point) {
        if self.squares.is_empty() {
            objective.find_squares(point, &mut self.squares);
        }
    }
}

impl Squares {
    /// The change of velocity by elastic and contact forces; not less than what counts as zero.
    fn velocity(&self) -> Real {
        let by_speed = NEGLIGIBLE_SPEED.powi(2) * self.speed;
        let by_way = NEGLIGIBLE_WAY.powi(2) * self.way;
        self.forced.max(by_speed).max(by_way)
    }

    fn is_in_free_fall(&self) -> bool {
        self.forced.max(self.left) <= NEGLIGIBLE_SPEED.powi(2) * self.speed
    }
}

impl PdSolver {
    /// Whether the tolerance is met at the point.
    pub(super) fn is_converged(
        &mut self,
        reference: Real,
        report: &mut StepReport,
        contact: &Contact<'_>,
    ) -> bool {
        let Some(tolerance) = self.config.tolerance else {
            return false;
        };
        let mut reference = reference;
        if let Some(contact) = contact {
            // What lands flat is not stretched at x̃.
            let forces = &mut self.velocities;
            forces.fill(Vec3::zeros());
            contact.add_gradient(&self.point.positions, forces);
            reference = reference.max(self.objective.norm(forces));
        }
        let norm = self.objective.norm(&self.point.gradient);
        let residual = if norm > 0.0 { norm / reference } else { 0.0 };
        report.residual = Some(residual);
        residual <= tolerance
    }

    /// Whether the cloth is in free fall: no force but gravity and the load is felt at the point.
    pub(super) fn is_in_free_fall(&mut self) -> bool {
        if self.config.tolerance.is_some() {
            return false;
        }
        self.norms.find(&self.objective, &self.point);
        let PieceNorms { squares, ended } = &mut self.norms;
        ended.clear();
        ended.extend(squares.iter().map(Squares::is_in_free_fall));
        if let Method::QuasiNewton(method) = &mut self.method {
            method.end(ended);
        }
        !ended.contains(&false)
    }

    /// Whether the forces at the point are in balance, in a step with active contacts and without a tolerance: cloth
    /// that lies still is done in a few iterations.
    pub(super) fn is_balanced(&mut self) -> bool {
        if self.config.tolerance.is_some() || !self.has_contact() {
            return false;
        }
        let tolerance = match self.config.iterations {
            Some(_) => BALANCE_TOLERANCE,
            None => BALANCED_VELOCITIES * self.config.velocity_tolerance,
        };
        self.norms.find(&self.objective, &self.point);
        let is_balanced = |of: &Squares| of.left <= tolerance * tolerance * of.forced;
        let mut squares = self.norms.squares.iter();
        squares.all(|of| is_balanced(of) || of.is_in_free_fall())
    }

    /// Whether the forces at the point, in a step with active contacts, are no larger than those that it takes to end
    /// where it does (in the norm of M⁻¹). A direction that only takes pairs apart that are much too near has a small
    /// decrement, while the rest of the cloth is not where it will be.
    pub(super) fn is_near_balance(&mut self) -> bool {
        if !self.has_contact() {
            return true;
        }
        self.norms.find(&self.objective, &self.point);
        let mut squares = self.norms.squares.iter();
        squares.all(|of| of.left <= of.velocity())
    }

    /// How far velocities are from those of the minimum, over what `fraction` of the tolerance asks, squared: first by
    /// the Newton decrement of the last direction, of the piece that is farthest, then by `decrease` (J), that of `G` in
    /// [`DECREASE_WINDOW`] iterations, of all pieces together.
    /// Pairs that do not fit the Hessian can make the first too small. Where no direction leads down any more, as at
    /// the speed at which the air carries a sheet, the gradient bounds it: the Hessian is at least M/Δt².
    ///
    /// Without contact, pieces whose own error is much smaller than asked for do not go on while others do, once there
    /// have been enough iterations.
    pub(super) fn velocity_errors(
        &mut self,
        fraction: Real,
        decrease: Real,
        is_enough: bool,
    ) -> [Real; 2] {
        let is_in_contact = self.has_contact();
        let Method::QuasiNewton(method) = &mut self.method else {
            return [Real::INFINITY; 2];
        };
        self.norms.find(&self.objective, &self.point);
        let PieceNorms { squares, ended } = &mut self.norms;
        let wanted = (fraction * self.config.velocity_tolerance).powi(2);
        let over = |error: Real, velocity: Real| match error == 0.0 {
            true => 0.0,
            false => error / (wanted * velocity),
        };
        let decrements = method.decrements();
        let by_piece = squares.iter().enumerate().map(|(piece, of)| {
            let error = decrements.map_or(of.left, |decrements| decrements[piece]);
            over(error.abs(), of.velocity())
        });
        let farthest = by_piece.clone().fold(0.0, Real::max);
        let all = squares.iter().map(Squares::velocity).sum();
        let by_decrease = over(decrease / DECREASE_WINDOW as Real, all);
        if is_enough || is_in_contact {
            ended.clear();
            ended.extend(by_piece.map(|error| !is_in_contact && error <= ENDED));
            method.end(ended);
        }
        [farthest, by_decrease]
    }

    /// Whether the last direction was one by the Hessian.
    pub(super) fn is_by_hessian(&self) -> bool {
        matches!(&self.method, Method::QuasiNewton(method) if method.uses_hessian())
    }

    /// Whether a contact was active where the last iteration began.
    pub(super) fn has_contact(&self) -> bool {
        match &self.method {
            Method::QuasiNewton(method) => method.touches(),
            _ => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The decrements, over what is asked for, of a step in which cloth was squeezed between a table and a glass: small
    /// ones come between large ones, at a value of G far above the minimum.
    #[test]
    fn small_decrements_between_large_ones_end_no_step() {
        let squeezed = [
            0.6, 0.65, 166.0, 0.6, 0.63, 0.77, 162.0, 0.62, 0.74, 159.0, 0.62, 0.7,
        ];
        let mut relapses = Relapses::default();
        let ends = squeezed.map(|error| relapses.accepts([error, 2.0]));
        assert_eq!(ends, [false; 12]);
        // G has hardly decreased for some iterations: still not.
        assert!(!relapses.accepts([0.7, 0.9]));
        assert!(!relapses.accepts([0.7, 0.9]));
        assert!(relapses.accepts([0.7, 0.9]), "five in a row");
    }

    #[test]
    fn a_first_small_decrement_ends_a_step_that_has_had_none() {
        let mut relapses = Relapses::default();
        let ends = [300.0, 40.0, 1.5, 0.9].map(|error| relapses.accepts([error, 0.5]));
        assert_eq!(ends, [false, false, false, true]);
        // One that is a little larger again is no relapse.
        assert!(!relapses.accepts([3.0, 0.5]));
        assert!(relapses.accepts([0.9, 0.5]));
    }
}

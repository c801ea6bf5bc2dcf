//! A step that linearises the cloth, in contact.

use super::*;
use crate::StartGuess;
use cloth_core::method::block_matrix::BlockMatrix;

/// A step whose cloth is linearised is good enough once the true function has gone down by this fraction of what the
/// linearised one has (the ratio of trust-region methods: Nocedal and Wright, *Numerical Optimization*, 2006, (4.4)).
/// With less, a sheet that falls on a ball gains energy (`cloth-bench/doc/results.md`); with more it is linearised more
/// often for the same fall.
const MIN_REDUCTION_RATIO: Real = 0.75;
/// Linearisations in a step, at most.
const MAX_LINEARIZATIONS: u32 = 8;

impl Minimizer {
    /// Puts prescribed vertices where they were before the step, if free ones are there too. Returns whether any has
    /// moved.
    pub(in crate::implicit) fn put_pins_back(&mut self, task: &Task<'_>) -> bool {
        let positions = &mut self.current.positions;
        let mut pins = (0..positions.len()).filter(|&v| !self.is_free[v]);
        let has_moved = pins.any(|v| positions[v] != task.before[v]);
        if task.config.start != StartGuess::Previous || !has_moved {
            return false;
        }
        self.pin_ends.clone_from(positions);
        for (v, x) in positions.iter_mut().enumerate() {
            if !self.is_free[v] {
                *x = task.before[v];
            }
        }
        true
    }

    /// Adds `H Δx` to the gradient (N), with Δx the way of the prescribed vertices that have been put back.
    pub(in crate::implicit) fn add_pull_of_pins(&mut self, matrix: &BlockMatrix) {
        let Point {
            positions,
            gradient,
            ..
        } = &mut self.current;
        for (v, way) in self.direction.iter_mut().enumerate() {
            *way = self.pin_ends[v] - positions[v];
        }
        matrix.multiply(&self.direction, &mut self.next.gradient);
        for (v, pull) in self.next.gradient.iter().enumerate() {
            if self.is_free[v] {
                gradient[v] += pull;
            }
        }
    }

    /// Puts prescribed vertices that have been put back where they end.
    pub(in crate::implicit) fn put_pins_on(&mut self) {
        for (v, x) in self.current.positions.iter_mut().enumerate() {
            if !self.is_free[v] {
                *x = self.pin_ends[v];
            }
        }
    }

    /// Solves the linearised step as if nothing could touch. Returns whether that is the step: contact presses neither
    /// where it begins nor where it ends, and nothing is in between. Else nothing has moved.
    pub(super) fn solve_apart(
        &mut self,
        task: &Task<'_>,
        observer: &mut Option<&mut dyn Observer>,
        contact: &mut Contact<'_>,
        report: &mut StepReport,
    ) -> Result<bool, StepError> {
        let Some(source) = contact else {
            newton::solve_once(self, task, report)?;
            self.notify(observer, 1);
            return Ok(true);
        };
        self.next.gradient.fill(Vec3::zeros());
        if source.add_gradient(&self.current.positions, &mut self.next.gradient) != 0.0 {
            return Ok(false);
        }
        let mut start = std::mem::take(&mut self.shortened);
        start.clone_from(&self.current.positions);
        let solved = newton::solve_once(self, task, report);
        let end = &self.current.positions;
        let is_apart = solved.and_then(|()| {
            let path = [&start[..], end];
            let is_clear = clear_path::is_clear(task, &mut **source, path, &mut self.direction)?;
            Ok(is_clear && source.add_gradient(end, &mut self.next.gradient) == 0.0)
        });
        match is_apart {
            Ok(true) => self.notify(observer, 1),
            _ => self.current.positions.copy_from_slice(&start),
        }
        self.shortened = start;
        is_apart
    }

    /// Minimises what the linearised cloth and contact make together; linearised anew where that ends, until the
    /// function of the stage itself has gone down by [`MIN_REDUCTION_RATIO`] of what the linearised one promised, and
    /// is not above what it is where the step begins: what contact has truncated starts with much strain.
    pub(super) fn minimize_linearized(
        &mut self,
        task: &Task<'_>,
        observer: &mut Option<&mut dyn Observer>,
        contact: &mut Contact<'_>,
        report: &mut StepReport,
    ) -> Result<(), StepError> {
        let stage = with(task, contact);
        // As `begin_contact` has left it: where the step begins.
        let begun = stage.gradient_into(&self.next.positions, &mut self.next.gradient);
        let mut before = self.value_here(&stage);
        for number in 0..MAX_LINEARIZATIONS {
            let promised =
                self.minimize_linear_cloth(task, observer, contact, report, number == 0)?;
            let after = self.value_here(&with(task, contact));
            let is_little =
                -2.0 * promised <= self.close_enough(task, task.config.tolerance).powi(2);
            let keeps = after - before <= MIN_REDUCTION_RATIO * promised && after <= begun;
            if is_little || keeps {
                return Ok(());
            }
            before = after;
        }
        report.outcome = Outcome::BudgetSpent;
        Ok(())
    }

    /// The function of a stage (J) at the current positions.
    fn value_here(&mut self, stage: &Stage<'_>) -> Real {
        stage.gradient_into(&self.current.positions, &mut self.next.gradient)
    }

    /// Minimises what the cloth linearised at the current positions and contact make together, with prescribed vertices
    /// put back for the linearisation if it `puts_back`. Returns by how much (J, negative) that has changed.
    fn minimize_linear_cloth(
        &mut self,
        task: &Task<'_>,
        observer: &mut Option<&mut dyn Observer>,
        contact: &mut Contact<'_>,
        report: &mut StepReport,
        puts_back: bool,
    ) -> Result<Real, StepError> {
        // Where prescribed vertices have been put back, their way is a part of the displacement.
        let are_back = puts_back && self.put_pins_back(task);
        self.current.evaluate(&task.stage);
        self.gradient_norm(task)?;
        let mut system = self.newton.take().expect("built with the solver");
        let prepared = newton::prepare(self, &mut system, task, report);
        let (mut at, mut buffer) = self.linearized.take().unwrap_or_default();
        at.positions.clone_from(&self.current.positions);
        at.gradient.clone_from(&self.current.gradient);
        if are_back {
            self.put_pins_on();
        }
        buffer.resize(self.is_free.len(), Vec3::zeros());
        let linearized = Linearized::new(&at, system.matrix(), buffer);
        let linear = Task {
            stage: Stage {
                linearized: Some(&linearized),
                ..task.stage
            },
            ..*task
        };
        let end = prepared.and_then(|()| {
            if self.quasi_newton.is_none() {
                let energies = task.stage.potential.energies;
                self.quasi_newton = Some(QuasiNewton::new(energies, self.is_free.clone()));
            }
            let end = self.descend(&linear, contact, observer, report)?;
            Ok((end, self.value_here(&with(&linear, contact)) - self.first))
        });
        let buffer = linearized.into_buffer();
        self.linearized = Some((at, buffer));
        self.newton = Some(system);
        let (end, change) = end?;
        report.outcome = end.outcome();
        Ok(change)
    }
}

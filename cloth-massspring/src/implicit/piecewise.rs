//! Whether every piece of the cloth is near enough to where it will be.

use super::line_search::Point;
use super::stage::Stage;
use cloth_core::math::{Real, Vec3};
use cloth_core::method::block_matrix::BlockPattern;
use cloth_core::method::pieces::Pieces;
use cloth_core::topology::joined;

/// The change of velocity of a piece counts as at least this part of that of all of the cloth (in the norm of M): a
/// piece that flies freely has none.
const SMALLEST: Real = 1e-4;

/// The pieces that elements couple, and sums over each (J).
#[derive(Debug)]
pub(super) struct Piecewise {
    pieces: Pieces,
    changes: Vec<Real>,
    errors: Vec<Real>,
}

impl Piecewise {
    /// Those of the graph that the blocks of a matrix make.
    pub(super) fn new(pattern: &BlockPattern) -> Self {
        Self {
            pieces: Pieces::new(&labels(pattern)),
            changes: Vec::new(),
            errors: Vec::new(),
        }
    }

    /// Whether the Newton decrement of each piece, along a direction (m), is at most `tolerance` times the change of
    /// velocity that the forces on it make, or `least` (√J).
    pub(super) fn is_near(
        &mut self,
        (stage, point): (&Stage<'_>, &Point),
        direction: &[Vec3],
        tolerance: Real,
        least: Real,
    ) -> bool {
        let along = |v: usize| -point.gradient[v].dot(&direction[v]);
        self.are_small((stage, point), along, tolerance, least)
    }

    /// The same of the gradient of each piece, times the step size and in the norm of M⁻¹, which bounds the decrement.
    pub(super) fn is_balanced(
        &mut self,
        (stage, point): (&Stage<'_>, &Point),
        tolerance: Real,
        least: Real,
    ) -> bool {
        let (w, dt) = (stage.potential.particles.inverse_mass(), stage.potential.dt);
        let left = |v: usize| dt * dt * w[v] * point.gradient[v].norm_squared();
        self.are_small((stage, point), left, tolerance, least)
    }

    fn are_small(
        &mut self,
        (stage, point): (&Stage<'_>, &Point),
        error: impl Fn(usize) -> Real,
        tolerance: Real,
        least: Real,
    ) -> bool {
        if self.pieces.count() < 2 {
            return true;
        }
        let g = &stage.potential;
        let (mass, per_time) = (g.particles.mass(), 1.0 / (g.dt * g.dt));
        let change = |v: usize| match g.particles.is_prescribed(v) {
            true => 0.0,
            false => mass[v] * per_time * (point.positions[v] - g.predicted[v]).norm_squared(),
        };
        self.pieces.sum(&mut self.changes, change);
        self.pieces.sum(&mut self.errors, error);
        let negligible = SMALLEST * SMALLEST * self.changes.iter().sum::<Real>();
        let mut pieces = self.errors.iter().zip(&self.changes);
        pieces.all(|(error, change)| {
            let enough = tolerance * tolerance * change.max(negligible);
            *error <= enough.max(least * least)
        })
    }
}

/// The lowest vertex of the piece of each, in the graph that the blocks of a matrix make.
pub(super) fn labels(pattern: &BlockPattern) -> Vec<u32> {
    let count = pattern.row_count();
    let coupled = |row: usize| {
        let columns = pattern.columns()[pattern.row(row)].iter();
        columns.map(move |&column| [row as u32, column])
    };
    joined(count, (0..count).flat_map(coupled))
}

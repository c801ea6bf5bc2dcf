//! Restores the linear momentum of cloth that nothing holds, of which an iteration that ends at its tolerance loses
//! some.
//!
//! Energies that do not change when a component of the cloth is shifted as a whole leave `G` quadratic in that shift:
//! `½ tᵀ (m/s² + Σ D/τ) t + t·Σ ∇G`, with m the mass of the component and D the drag of the air. Its minimum is known,
//! and with it linear momentum is kept to rounding at any tolerance. The iteration starts there too: cloth that falls
//! freely is solved before the first one.

use super::line_search::Point;
use super::piecewise::labels;
use super::stage::Stage;
use cloth_core::math::{Mat3, Vec3};
use cloth_core::method::block_matrix::BlockPattern;
use cloth_core::method::family::Energies;

/// The connected components without a prescribed vertex, and without an element that attaches one vertex to a point.
#[derive(Debug)]
pub(super) struct Unconstrained {
    components: Vec<Vec<u32>>,
}

impl Unconstrained {
    /// Those of the graph that the blocks of a matrix make; `is_unconstrained[v]` says that nothing holds vertex `v`.
    fn of(pattern: &BlockPattern, is_unconstrained: &[bool]) -> Self {
        let labels = labels(pattern);
        let mut components = vec![Vec::new(); labels.len()];
        let mut is_held = vec![false; labels.len()];
        for (vertex, &root) in labels.iter().enumerate() {
            let root = root as usize;
            components[root].push(vertex as u32);
            is_held[root] |= !is_unconstrained[vertex];
        }
        let held = components.into_iter().zip(is_held);
        let unheld = held.filter(|(vertices, is_held)| !is_held && !vertices.is_empty());
        Self {
            components: unheld.map(|(vertices, _)| vertices).collect(),
        }
    }

    /// Those of an energy.
    pub(super) fn of_energies(
        energies: &Energies,
        pattern: &BlockPattern,
        is_free: &[bool],
    ) -> Self {
        let mut is_unconstrained = is_free.to_vec();
        energies.for_each_anchor(|vertex| is_unconstrained[vertex as usize] = false);
        Self::of(pattern, &is_unconstrained)
    }

    /// Shifts each component at an evaluated point to the minimum along its translations, and its gradient with it. The
    /// value stays, and is then too high by the sum of `½ tᵀ (m/s² + Σ D/τ) t` over the components, t their shifts.
    /// That is at most `½ s² ‖∇G‖²`, in the norm of M⁻¹, of the gradient before the shift, as `|Σ ∇G|² ≤ m Σ |∇G|²/mᵢ`.
    /// It counts only where Newton's method goes on from there: its first step may end higher than it should by as
    /// much, and takes the fall of G so far for as much smaller.
    pub(super) fn restore_momentum(&self, stage: &Stage<'_>, point: &mut Point) {
        for component in &self.components {
            shift_to_minimum(component.iter().copied(), stage, point);
        }
    }

    /// The same for components that touch each other and nothing else: all of them are shifted as one. If something
    /// holds a vertex nothing is done.
    pub(super) fn restore_momentum_together(&self, stage: &Stage<'_>, point: &mut Point) -> bool {
        let count: usize = self.components.iter().map(Vec::len).sum();
        let is_all = count == point.positions.len();
        if is_all {
            shift_to_minimum(0..count as u32, stage, point);
        }
        is_all
    }
}

fn shift_to_minimum(
    vertices: impl Iterator<Item = u32> + Clone,
    stage: &Stage<'_>,
    point: &mut Point,
) {
    let g = &stage.potential;
    let per_time = 1.0 / (g.dt * g.dt);
    let (mut stiffness, mut force) = (Mat3::zeros(), Vec3::zeros());
    let of = |vertex: usize| {
        let own = g.particles.mass()[vertex] * per_time;
        let inertia = Mat3::from_diagonal_element(own);
        inertia + stage.air.map_or(Mat3::zeros(), |air| air.stiffness(vertex))
    };
    for vertex in vertices.clone() {
        let vertex = vertex as usize;
        let (own, x) = (g.particles.mass()[vertex], point.positions[vertex]);
        stiffness += of(vertex);
        force -= (x - g.predicted[vertex]) * (own * per_time);
        force -= stage
            .air
            .map_or(Vec3::zeros(), |air| air.gradient(vertex, x));
    }
    let shift = match stage.air {
        Some(_) => stiffness.try_inverse().unwrap_or_else(Mat3::zeros) * force,
        None => force / stiffness.m11,
    };
    for vertex in vertices {
        let vertex = vertex as usize;
        point.positions[vertex] += shift;
        point.gradient[vertex] += of(vertex) * shift;
    }
}

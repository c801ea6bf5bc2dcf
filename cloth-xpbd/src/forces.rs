//! Constraint forces, read from the multipliers: `f = Jᵀλ/h²`.

use crate::solver::XpbdSolver;
use crate::update::Multiplier;
use cloth_core::math::{Real, Vec3};
use cloth_core::step::StepInput;

/// The force of one row in the last substep: its impulse λ/h over h. Of a converged undamped row that is −k C at the
/// *end* of the substep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RowForce<'a> {
    /// Number of the row in its family: element after element in the order in which they were given, row after row.
    pub index: usize,
    /// The vertices of its element.
    pub vertices: &'a [u32],
    /// `∂C/∂x` (unit of C per m) at the end of the substep; one per vertex of the element.
    pub gradient: &'a [Vec3],
    /// `λ/h²` (J per unit of C; N for springs and hinges), positive where it pushes C up: the tension of a
    /// spring is its negative.
    pub magnitude: Real,
}

impl RowForce<'_> {
    /// `∂C/∂xᵢ λ/h²` (N): the force on vertex number `i` of the element.
    ///
    /// # Panics
    /// If the element has no such vertex.
    #[must_use]
    pub fn on(&self, i: usize) -> Vec3 {
        self.gradient[i] * self.magnitude
    }
}

/// Forces of the last substep of the last step. All are zero before the first step and after one that failed.
///
/// They are impulses over the substep divided by h, damping included, contact not: of a converged row `−k C − β k Ċ` at
/// its end. They are only as converged as the sweeps: with one sweep per substep, λ of a row is the Δλ of its one
/// visit.
impl XpbdSolver {
    /// Writes the multipliers λ (kg m² per unit of C; kg m for springs and hinges) of the last substep to
    /// `out`: those of the family that was added as number `family` (from 0), element after element in the
    /// order given, row after row.
    ///
    /// `λ/h²` is the generalised force of the row: the tension of a spring is `−λ/h²` (N).
    ///
    /// # Panics
    /// If there is no such family.
    pub fn multipliers_into(&self, family: usize, out: &mut Vec<Real>) {
        self.families.read_memory(family, out, Multiplier::lambda);
        if self.last.is_none() {
            out.fill(0.0);
        } else if let Some(offsets) = self.offsets.get(family) {
            out.iter_mut()
                .zip(offsets)
                .for_each(|(lambda, offset)| *lambda += offset);
        }
    }

    /// Shows the force `f = Jᵀλ/h²` of every row of the family that was added as number `family` (from 0), in
    /// no particular order.
    ///
    /// # Panics
    /// If there is no such family.
    pub fn each_force(&self, family: usize, mut see: impl FnMut(RowForce<'_>)) {
        let mut multipliers = Vec::new();
        self.multipliers_into(family, &mut multipliers);
        let Some(update) = self.last else {
            return;
        };
        let (w, x) = (self.motion.inverse_mass(), self.motion.positions());
        self.families.inspect(family, w, x, |seen| {
            see(RowForce {
                index: seen.index,
                vertices: seen.vertices,
                gradient: seen.gradient,
                magnitude: update.force(multipliers[seen.index]),
            });
        });
    }

    /// Writes `Σ Jᵀλ/h²` (N) over all constraints to `out`, one per vertex. At a prescribed vertex it is the
    /// load on the support, the negative of its reaction.
    ///
    /// # Panics
    /// If `out` does not have one entry per vertex.
    pub fn vertex_forces_into(&self, out: &mut [Vec3]) {
        assert_eq!(
            out.len(),
            self.motion.vertex_count(),
            "one force per vertex"
        );
        out.fill(Vec3::zeros());
        for family in 0..self.families.len() {
            self.each_force(family, |force| {
                for (i, &vertex) in force.vertices.iter().enumerate() {
                    out[vertex as usize] += force.on(i);
                }
            });
        }
    }

    /// Adds the work of prescribed vertices in a substep, after its sweeps.
    pub(crate) fn count_pin_work(&mut self, input: &mut StepInput<'_>) {
        let mut offsets = self.prescribed_offsets.iter();
        let families = &self.families;
        self.motion.count_pin_work(input, families, |seen| {
            seen.memory.lambda() + offsets.next().unwrap_or(&0.0)
        });
    }
}

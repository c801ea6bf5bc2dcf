//! Forces at prescribed vertices and their work, in a step that has not converged.
//!
//! The elastic force −∂E/∂x at the end of such a step is not the one that has moved the cloth: a stiff edge whose
//! stretch is a little wrong pulls much too hard, or not at all. The force that a plain iteration from there would use
//! is that of its constant matrix, with the projections p of the iterate,
//!
//! f = Σ w Sᵀ(S x⁺ − p) = ∂E/∂x + Σ w SᵀS (x⁺ − x),
//!
//! with x⁺ = x − A⁻¹g. It is in balance at free vertices whatever p is: there A (x⁺ − x) = −g, in which
//! g = M (x − x̃)/Δt² + ∂E/∂x + r. Here r is what else pushes, ∇C of contact and D (v − v₀) of the air where G has
//! them, both at x. With A = M/Δt² + Σ w SᵀS that is M (x⁺ − x̃)/Δt² = −f − r. Of elements whose rows of S sum to zero
//! the f over all vertices add up to zero (attachments and the like push from outside), so f at prescribed vertices is
//! the force with which these move the cloth. x⁺ is near x long before the forces are right, since A knows how stiff
//! the edges are. (What contact does at a prescribed vertex is not counted.)

use crate::contact::Contact;
use crate::solver::PdSolver;
use cloth_core::math::{Real, Vec3};
use cloth_core::step::StepInput;

impl PdSolver {
    /// f·Δx over the prescribed vertices that move in the step which ends at the point (J), and −f (N), where `input`
    /// asks for it; nothing where no vertex moves and nobody asks.
    pub(crate) fn pin_work(
        &mut self,
        contact: &Contact<'_>,
        input: &mut StepInput<'_>,
    ) -> Option<Real> {
        let inverse_mass = self.objective.particles.inverse_mass();
        let moves = |(q, w): (&Vec3, &Real)| *w == 0.0 && *q != Vec3::zeros();
        let is_moved = self.point.displacement.iter().zip(inverse_mass).any(moves);
        if !is_moved && input.pin_forces.is_none() {
            return None;
        }
        if !self.point.is_evaluated {
            self.objective.evaluate(&mut self.point, contact);
        }
        let (forces, back) = (&mut self.fallback.gradient, &mut self.fallback.displacement);
        self.objective.write_forces(&self.point, forces);
        if self.global.is_empty() {
            back.fill(Vec3::zeros()); // no vertex can move
        } else {
            self.global.solve(&self.point.gradient, back);
        }
        let inverse_mass = self.objective.particles.inverse_mass();
        let is_prescribed = |v: usize| inverse_mass[v] == 0.0;
        for (&value, (i, j)) in self.global.stiffness().iter() {
            match [i, j].map(is_prescribed) {
                [true, false] => forces[i] -= back[j] * value,
                [false, true] => forces[j] -= back[i] * value,
                _ => {}
            }
        }
        let mut work = 0.0;
        for v in (0..forces.len()).filter(|&v| is_prescribed(v)) {
            work += forces[v].dot(&self.point.displacement[v]);
            input.add_pin_force(v, -forces[v]);
        }
        is_moved.then_some(work)
    }
}

//! One minimisation: what all implicit integrators have in common.

use super::damper::Damper;
use cloth_core::block_matrix::BlockMatrix;
use cloth_core::element::Convexity;
use cloth_core::math::{Real, Vec3};
use cloth_core::measure::IncrementalPotential;

/// `‖x − x̂‖²_M / (2s²) + E(x) + damping`: inertia towards `x̂`, elasticity, and the resistance to the rate of strain.
///
/// The first two are [`IncrementalPotential`] with a goal `x̂` and a time `s` that depend on the integrator.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stage<'a> {
    pub(super) potential: IncrementalPotential<'a>,
    /// `None` without stiffness-proportional damping.
    pub(super) damper: Option<&'a Damper>,
}

impl Stage<'_> {
    /// The function (J).
    pub(super) fn value(&self, x: &[Vec3]) -> Real {
        let damping = self.damper.map_or(0.0, |damper| damper.value(x));
        self.potential.value(x) + damping
    }

    /// Writes its gradient (N) to `out`, zero at prescribed vertices.
    pub(super) fn gradient_into(&self, x: &[Vec3], out: &mut [Vec3]) {
        self.potential.gradient_into(x, out);
        if let Some(damper) = self.damper {
            damper.add_gradient(x, out);
            let w = self.potential.particles.inverse_mass();
            for (out, _) in out.iter_mut().zip(w).filter(|(_, w)| **w == 0.0) {
                *out = Vec3::zeros();
            }
        }
    }

    /// Norm of a gradient in the metric of `M⁻¹` (N/√kg).
    pub(super) fn gradient_norm(&self, gradient: &[Vec3]) -> Real {
        self.potential.gradient_norm(gradient)
    }

    /// Writes its second derivative (N/m) to `out`, the elastic part as a mixture of these shares.
    pub(super) fn hessian_into(
        &self,
        x: &[Vec3],
        parts: &[(Real, Convexity)],
        out: &mut BlockMatrix,
    ) {
        let g = &self.potential;
        out.clear();
        let inertia = 1.0 / (g.dt * g.dt);
        out.add_diagonal(g.particles.mass().iter().map(|m| m * inertia));
        for &(share, convexity) in parts {
            g.energies.add_hessian(x, share, convexity, out);
        }
        if let Some(damper) = self.damper {
            damper.add_hessian(out);
        }
    }

    /// Writes the exact second derivative times `p` to `out`.
    pub(super) fn hessian_product_into(&self, x: &[Vec3], p: &[Vec3], out: &mut [Vec3]) {
        let g = &self.potential;
        out.fill(Vec3::zeros());
        g.energies.add_hessian_product(x, p, Convexity::Exact, out);
        let inertia = 1.0 / (g.dt * g.dt);
        for ((out, p), m) in out.iter_mut().zip(p).zip(g.particles.mass()) {
            *out += p * (m * inertia);
        }
        if let Some(damper) = self.damper {
            damper.add_product(p, out);
        }
    }
}

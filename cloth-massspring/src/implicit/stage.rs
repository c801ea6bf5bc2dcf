//! One minimisation: what all implicit integrators have in common.

use super::air_drag::AirDrag;
use super::damper::Damper;
use super::linearized::Linearized;
use cloth_core::contact::ContactPotential;
use cloth_core::element::Convexity;
use cloth_core::math::{Real, Vec3};
use cloth_core::measure::IncrementalPotential;
use cloth_core::method::block_matrix::BlockMatrix;
use cloth_core::method::family::Assembly;

/// `‖x − x̂‖²_M / (2s²) + E(x) + damping + drag + contact`: inertia towards `x̂`, elasticity, the resistance to the
/// rate of strain, that of the air, and what the cloth touches.
///
/// The first two are [`IncrementalPotential`] with predicted positions `x̂` and a time `s` that depend on the
/// integrator.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stage<'a> {
    pub(super) potential: IncrementalPotential<'a>,
    /// `None` without stiffness-proportional damping.
    pub(super) damper: Option<&'a Damper>,
    /// `None` without air.
    pub(super) air: Option<AirDrag<'a>>,
    /// In place of all but contact, if that is linearised.
    pub(super) linearized: Option<&'a Linearized<'a>>,
    /// `None` where there is nothing to touch.
    pub(super) contact: Option<&'a dyn ContactPotential>,
}

impl Stage<'_> {
    /// The function (J); writes its gradient (N) to `out`, zero at prescribed vertices.
    pub(super) fn gradient_into(&self, x: &[Vec3], out: &mut [Vec3]) -> Real {
        let mut value = match self.linearized {
            Some(linearized) => linearized.gradient_into(x, out),
            None => self.smooth_gradient_into(x, out),
        };
        if let Some(contact) = self.contact {
            value += contact.add_gradient(x, out);
        }
        let is_whole = self.damper.is_none() && self.air.is_none() && self.linearized.is_none();
        if !is_whole || self.contact.is_some() {
            let w = self.potential.particles.inverse_mass();
            for (out, _) in out.iter_mut().zip(w).filter(|(_, w)| **w == 0.0) {
                *out = Vec3::zeros();
            }
        }
        value
    }

    /// The same of all but contact, whatever is at prescribed vertices.
    fn smooth_gradient_into(&self, x: &[Vec3], out: &mut [Vec3]) -> Real {
        let mut value = self.potential.gradient_into(x, out);
        if let Some(damper) = self.damper {
            damper.add_gradient(x, out);
            value += damper.value(x);
        }
        if let Some(air) = &self.air {
            value += air.add_gradient(x, out);
        }
        value
    }

    /// Norm of a gradient in the metric of `M⁻¹` (N/√kg).
    pub(super) fn gradient_norm(&self, gradient: &[Vec3]) -> Real {
        self.potential.gradient_norm(gradient)
    }

    /// Writes its second derivative (N/m) to `out`, the elastic part as a mixture by these weights.
    pub(super) fn hessian_into(
        &self,
        assembly: &Assembly,
        x: &[Vec3],
        parts: &[(Real, Convexity)],
        out: &mut BlockMatrix,
    ) {
        self.inertia_into(out);
        let energies = self.potential.energies;
        for &(weight, convexity) in parts {
            energies.add_hessian(assembly, x, weight, convexity, out);
        }
        if let Some(damper) = self.damper {
            damper.add_hessian(out);
        }
    }

    /// Writes what the preconditioner of the quasi-Newton method is made of to `out` (N/m): by [`Convexity::Abs`],
    /// lumped as `assembly` says, and with the forces predicted from `mixed` (two positions, m) if there are such.
    pub(super) fn lumped_hessian_into(
        &self,
        assembly: &Assembly,
        x: &[Vec3],
        mixed: Option<[&[Vec3]; 2]>,
        out: &mut BlockMatrix,
    ) {
        self.inertia_into(out);
        let energies = self.potential.energies;
        let (x, mixed) = match self.linearized {
            Some(linearized) => (linearized.place(), None),
            None => (x, mixed),
        };
        match mixed {
            Some([from, to]) => energies.add_mixed_hessian(assembly, x, from, to, out),
            None => energies.add_hessian(assembly, x, 1.0, Convexity::Abs, out),
        }
        if let Some(damper) = self.damper {
            energies.add_hessian(assembly, x, damper.scale(), Convexity::GaussNewton, out);
        }
    }

    /// Inertia and drag, whose blocks are on the diagonal.
    fn inertia_into(&self, out: &mut BlockMatrix) {
        let g = &self.potential;
        out.set_diagonal(g.particles.mass(), 1.0 / (g.dt * g.dt));
        if let Some(air) = &self.air {
            air.add_hessian(out);
        }
    }

    /// Norm (N/√kg) of the gradient that rounding makes at `x`: positions are stored to half a unit in the last place
    /// of their coordinates, and the gradient changes with them as the diagonal blocks of the matrix say.
    pub(super) fn rounding(&self, matrix: &BlockMatrix, x: &[Vec3]) -> Real {
        let pattern = matrix.pattern();
        let mut sum = 0.0;
        let mut largest: Real = 0.0;
        for (vertex, w) in self.potential.particles.inverse_mass().iter().enumerate() {
            let diagonal = &matrix.blocks()[pattern.row(vertex).end - 1];
            sum += w * diagonal.norm_squared();
            largest = largest.max(x[vertex].amax());
        }
        0.5 * Real::EPSILON * largest * sum.sqrt()
    }

    /// By how much (J) rounding of large terms that cancel may change the value at `x`.
    pub(super) fn value_rounding(&self, x: &[Vec3]) -> Real {
        self.damper.map_or(0.0, |damper| damper.rounding(x))
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
        if let Some(air) = &self.air {
            air.add_product(p, out);
        }
    }
}

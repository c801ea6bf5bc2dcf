//! The drag of a substep as a constraint on every vertex, for methods that project positions.
//!
//! It pulls a vertex with `−D (x − a)/h` towards `a = x₀ + h v₀`, where it would come to with the velocity it had: XPBD
//! with the matrix D/h for a stiffness. With λ (kg m) what it has added up, a projection is
//!
//! Δλ = −(I + h w D)⁻¹ (h D (x − a) + λ),   x ← x + w Δλ.

use crate::math::{Mat3, Real, Vec3};

#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Projection {
    h: Real,
    /// w (1/kg), `(I + h w D)⁻¹` (dimensionless) and λ (kg m) of each vertex.
    inverse_mass: Vec<Real>,
    inverses: Vec<Mat3>,
    multipliers: Vec<Vec3>,
}

impl Projection {
    pub(super) fn begin(&mut self, drag: &[Mat3], w: &[Real], h: Real) {
        self.h = h;
        self.inverse_mass.clear();
        self.inverse_mass.extend_from_slice(w);
        self.inverses.clear();
        let each = drag.iter().zip(w);
        self.inverses
            .extend(each.map(|(drag, w)| implicit(drag, w * h)));
        self.multipliers.clear();
        self.multipliers.resize(drag.len(), Vec3::zeros());
    }

    /// Another substep with the same matrices.
    pub(super) fn restart(&mut self) {
        self.multipliers.fill(Vec3::zeros());
    }

    /// `starts` are x₀ (m) and v₀ (m/s).
    pub(super) fn sweep<'a>(
        &mut self,
        drag: &[Mat3],
        starts: impl Iterator<Item = (&'a Vec3, &'a Vec3)>,
        x: &mut [Vec3],
    ) {
        for (vertex, (start, v)) in starts.enumerate() {
            let (w, h) = (self.inverse_mass[vertex], self.h);
            if w == 0.0 {
                continue;
            }
            let lambda = &mut self.multipliers[vertex];
            let offset = x[vertex] - (start + v * h);
            let change = self.inverses[vertex] * -(drag[vertex] * offset * h + *lambda);
            *lambda += change;
            x[vertex] += change * w;
        }
    }
}

/// `(I + s D)⁻¹` for a `drag` D (kg/s) and s (s/kg); it exists because D is positive semidefinite. Where s D
/// overflows, nothing moves.
#[must_use]
pub fn implicit(drag: &Mat3, s: Real) -> Mat3 {
    let matrix = Mat3::identity() + drag * s;
    matrix.try_inverse().unwrap_or_else(Mat3::zeros)
}

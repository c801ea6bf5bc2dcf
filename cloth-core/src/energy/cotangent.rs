//! What the hinges of the cotangent family share: from a rest shape to coefficients and areas, and `z = q x`.

use crate::math::{Real, Vec3, gather};
use crate::mesh::TriMesh;
use crate::topology::HingeTable;

/// The rest shape of a hinge, as far as [`super::CurvatureHinge`], [`super::CurvedHinge`] and [`super::CubicShell`]
/// need it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cotangents {
    /// `q = (cot θ₁ + cot θ₃, cot θ₀ + cot θ₂, −(cot θ₀ + cot θ₁), −(cot θ₂ + cot θ₃))`, dimensionless, sum 0.
    /// The last two are negative, as they are not in some texts; see [`super::CurvatureHinge`], which derives q.
    pub(super) coefficients: [Real; 4],
    /// `cot θ₀ … cot θ₃` (dimensionless): of the first triangle at `x₀` and `x₁`, of the second at `x₀` and `x₁`.
    pub(super) angles: [Real; 4],
    /// `A₀`, `A₁` (m²) of the wings.
    pub(super) areas: [Real; 2],
}

impl Cotangents {
    /// Of an edge `x₀ x₁` with the wing tips `x₂`, `x₃` (m); both wings must have an area.
    pub(super) fn of(rest: &[Vec3; 4]) -> Self {
        let [x0, x1, x2, x3] = *rest;
        let edge = x1 - x0;
        let [c0, c2] = [x2, x3].map(|tip| cotangent(edge, tip - x0));
        let [c1, c3] = [x2, x3].map(|tip| cotangent(-edge, tip - x1));
        Self {
            coefficients: [c1 + c3, c0 + c2, -(c0 + c1), -(c2 + c3)],
            angles: [c0, c1, c2, c3],
            areas: [x2, x3].map(|tip| 0.5 * edge.cross(&(tip - x0)).norm()),
        }
    }

    /// `K = k·3/(A₀ + A₁)` (N/m) for a coefficient k (N·m).
    pub(super) fn stiffness(&self, k: Real) -> Real {
        k * 3.0 / (self.areas[0] + self.areas[1])
    }
}

/// Cotangent (dimensionless) of the angle between two vectors.
fn cotangent(a: Vec3, b: Vec3) -> Real {
    a.dot(&b) / a.cross(&b).norm()
}

/// `z = q x` (m). Differences to one vertex, so that coordinates far from the origin do not cancel; the coefficients
/// sum to zero.
#[inline]
pub(super) fn curvature_vector(q: &[Real; 4], x: &[Vec3; 4]) -> Vec3 {
    (x[1] - x[0]) * q[1] + (x[2] - x[0]) * q[2] + (x[3] - x[0]) * q[3]
}

/// One element on every hinge of a mesh, made by `make` from its vertices and their rest positions (m).
pub(super) fn on_each_hinge<E>(
    mesh: &TriMesh,
    hinges: &HingeTable,
    make: impl Fn([u32; 4], &[Vec3; 4]) -> E,
) -> Vec<E> {
    let each = hinges.hinges().iter();
    each.map(|&vertices| make(vertices, &gather(mesh.positions(), vertices)))
        .collect()
}

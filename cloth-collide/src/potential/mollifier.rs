//! What keeps the energy of two edges smooth where they are parallel.

use cloth_core::math::{Real, Vec3};

/// m(c) of c = ‖u × v‖², for the vectors u, v of two edges: c/ε (2 − c/ε) below ε, 1 from there on (Li et al. 2020,
/// where distances of nearly parallel edges are treated).
///
/// The nearest points of parallel edges are not unique, and the gradient of their distance jumps. m is zero there, so
/// the energy m b(d) is smooth. Nothing gets through meanwhile: between parallel edges an end is as near as any point,
/// and the vertices have barriers of their own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mollifier {
    /// ε (m⁴).
    threshold: Real,
}

/// Squared sine below which two edges of their rest lengths count as nearly parallel.
const PARALLEL: Real = 1e-3;

impl Mollifier {
    /// For edges of these squared rest lengths (m²).
    #[must_use]
    pub fn new(squared_lengths: [Real; 2]) -> Self {
        Self {
            threshold: PARALLEL * squared_lengths[0] * squared_lengths[1],
        }
    }

    /// m and ∂m/∂x_k (1/m) at the ends (m) of the two edges.
    pub(super) fn at(&self, x: &[Vec3; 4]) -> (Real, [Vec3; 4]) {
        let (u, v) = (x[1] - x[0], x[3] - x[2]);
        let n = u.cross(&v);
        let part = n.norm_squared() / self.threshold;
        if part < 1.0 {
            let slope = 2.0 * (1.0 - part) / self.threshold;
            let (by_u, by_v) = (v.cross(&n) * (2.0 * slope), n.cross(&u) * (2.0 * slope));
            (part * (2.0 - part), [-by_u, by_u, -by_v, by_v])
        } else {
            // Also for edges without rest length, whose ratio is not a number.
            (1.0, [Vec3::zeros(); 4])
        }
    }
}

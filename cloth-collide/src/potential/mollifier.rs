//! What keeps the energy of two edges differentiable where they are parallel.

use cloth_core::math::{Blocks, Mat3, Real, Vec3};

/// m(c) of c = ‖u × v‖², for the vectors u, v of two edges: c/ε (2 − c/ε) below ε, 1 from there on (Li et al. 2020,
/// equation 24, in section 6 on distances, with the same ε: a thousandth of the product of the squared rest lengths).
///
/// The nearest points of parallel edges are not unique, and the gradient of their distance jumps. m is zero there, so
/// the energy m ψ(d) has a continuous gradient, but its second derivative jumps at c = ε, and wherever the nearest
/// points change between a face, an edge and a corner. Nothing gets through meanwhile: between parallel edges an end is
/// as near as any point, and the vertices have barriers of their own.
///
/// For methods that project positions m is a factor of the area that a constraint has in a substep: nearly parallel
/// edges have a softer one, parallel edges none. Whether they come too near is tested as for all pairs.
///
/// Too small an ε leaves a force that changes fast with the angle, too large a one takes the barrier from edges that
/// only their insides keep apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mollifier {
    /// ε (m⁴).
    threshold: Real,
}

/// ε over the product of the squared rest lengths: c is that product times sin² of the angle, so edges of their rest
/// lengths count as nearly parallel below 1.8°.
const PARALLEL: Real = 1e-3;

impl Mollifier {
    /// For edges of these squared rest lengths (m²).
    #[must_use]
    pub fn new(squared_lengths: [Real; 2]) -> Self {
        Self {
            threshold: PARALLEL * squared_lengths[0] * squared_lengths[1],
        }
    }

    /// m, and how it changes with c and twice with c; only m if it is 1 around.
    fn parts(&self, c: Real) -> (Real, Option<[Real; 2]>) {
        let part = c / self.threshold;
        if part < 1.0 {
            let slope = 2.0 * (1.0 - part) / self.threshold;
            let bend = -2.0 / (self.threshold * self.threshold);
            (part * (2.0 - part), Some([slope, bend]))
        } else {
            // Also for edges without rest length, whose ratio is not a number.
            (1.0, None)
        }
    }

    /// m and ∂m/∂x_k (1/m) at the ends (m) of the two edges.
    pub(super) fn at(&self, x: &[Vec3; 4]) -> (Real, [Vec3; 4]) {
        let (u, v) = (x[1] - x[0], x[3] - x[2]);
        let n = u.cross(&v);
        let (value, change) = self.parts(n.norm_squared());
        let gradient = match change {
            Some([slope, _]) => {
                let (by_u, by_v) = (v.cross(&n) * (2.0 * slope), n.cross(&u) * (2.0 * slope));
                [-by_u, by_u, -by_v, by_v]
            }
            None => [Vec3::zeros(); 4],
        };
        (value, gradient)
    }

    /// ∂²m/∂x_k∂x_l (1/m²); nothing where it is zero.
    pub(super) fn curvature(&self, x: &[Vec3; 4]) -> Option<Blocks<4>> {
        let (u, v) = (x[1] - x[0], x[3] - x[2]);
        let n = u.cross(&v);
        let [slope, bend] = self.parts(n.norm_squared()).1?;
        let (by_u, by_v) = (v.cross(&n) * 2.0, n.cross(&u) * 2.0);
        let identity = Mat3::identity();
        let (uu, vv, uv) = (u.norm_squared(), v.norm_squared(), u.dot(&v));
        // c = u² v² − (u·v)².
        let second = [
            [
                (identity * vv - v * v.transpose()) * 2.0,
                (u * v.transpose() * 2.0 - identity * uv - v * u.transpose()) * 2.0,
            ],
            [
                (v * u.transpose() * 2.0 - identity * uv - u * v.transpose()) * 2.0,
                (identity * uu - u * u.transpose()) * 2.0,
            ],
        ];
        let first = [by_u, by_v];
        let sign = [-1.0, 1.0, -1.0, 1.0];
        Some(std::array::from_fn(|k| {
            std::array::from_fn(|l| {
                let (a, b) = (k / 2, l / 2);
                let whole = second[a][b] * slope + first[a] * first[b].transpose() * bend;
                whole * (sign[k] * sign[l])
            })
        }))
    }
}

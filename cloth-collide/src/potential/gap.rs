//! The distance of four vertices as a vertex and a triangle, or as two edges, with both derivatives.

use crate::closest::{edge_edge, point_triangle};
use cloth_core::math::{Blocks, Mat3, Real, Vec3};

/// Between the nearest points of two primitives.
///
/// With the weights c_k(s) of the four vertices, which depend on up to two places s along edges, r = Σ c_k x_k goes
/// from one nearest point to the other, and d = min over s of ‖r‖. The minimum is stationary in s, so ∂d/∂x_k = c_k n
/// with n = r/d, and where the weights move, they follow from J ⊥ n.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// Distance d (m).
    pub distance: Real,
    /// From the second nearest point to the first, n (unit length; zero at distance 0).
    pub normal: Vec3,
    /// c_k, dimensionless: positive on the first primitive, negative on the second.
    pub weights: [Real; 4],
    /// ∂c/∂s for each place that is free to move.
    turns: [[Real; 4]; 2],
    /// How many are.
    free: usize,
}

impl Gap {
    /// Of a vertex and a triangle, positions (m) in this order.
    #[must_use]
    pub fn vertex_triangle(x: &[Vec3; 4]) -> Self {
        let nearest = point_triangle(x[0], [x[1], x[2], x[3]]);
        let [a, b, c] = nearest.weights;
        let mut gap = Self::new(nearest.separation, [1.0, -a, -b, -c]);
        // On a corner nothing moves, on an edge the place between its ends, inside two of them.
        let on: [bool; 3] = [a, b, c].map(|w| w > 0.0);
        let mut between = |from: usize, to: usize| {
            let mut turn = [0.0; 4];
            (turn[from + 1], turn[to + 1]) = (1.0, -1.0);
            gap.add(turn);
        };
        match on {
            [true, true, true] => {
                between(0, 1);
                between(0, 2);
            }
            [true, true, false] => between(0, 1),
            [false, true, true] => between(1, 2),
            [true, false, true] => between(2, 0),
            _ => {}
        }
        gap
    }

    /// Of two edges, the ends (m) of one after those of the other.
    #[must_use]
    pub fn edge_edge(x: &[Vec3; 4]) -> Self {
        let nearest = edge_edge([x[0], x[1]], [x[2], x[3]]);
        let [s, t] = nearest.along;
        let mut gap = Self::new(nearest.separation, [1.0 - s, s, t - 1.0, -t]);
        let inside = |place: Real| place > 0.0 && place < 1.0;
        if inside(s) {
            gap.add([-1.0, 1.0, 0.0, 0.0]);
        }
        if inside(t) {
            gap.add([0.0, 0.0, 1.0, -1.0]);
        }
        gap
    }

    fn new(separation: Vec3, weights: [Real; 4]) -> Self {
        let distance = separation.norm();
        let normal = if distance > 0.0 {
            separation / distance
        } else {
            Vec3::zeros()
        };
        Self {
            distance,
            normal,
            weights,
            turns: [[0.0; 4]; 2],
            free: 0,
        }
    }

    fn add(&mut self, turn: [Real; 4]) {
        self.turns[self.free] = turn;
        self.free += 1;
    }

    /// ∂d/∂x_k (dimensionless).
    #[must_use]
    pub fn gradient(&self) -> [Vec3; 4] {
        self.weights.map(|c| self.normal * c)
    }

    /// ∂²d/∂x_k∂x_l (1/m) at the positions (m) that the gap was taken at. Between two regions, where it jumps, that of
    /// one of them; zero for primitives that touch, and where G⁻¹ is beyond all numbers.
    ///
    /// Eliminating the places s from the Hessian of ½ r² leaves, with J_a = Σ ∂c_k/∂s_a x_k, G = JᵀJ, and the projector
    /// T onto what is at right angles to n and all J,
    ///
    /// ∂²d = c_k c_l T/d − Σ (G⁻¹)_ab (∂_a c_k c_l n J_bᵀ + c_k ∂_b c_l J_a nᵀ + d ∂_a c_k ∂_b c_l n nᵀ),
    ///
    /// in which nothing cancels for small d.
    #[must_use]
    pub fn curvature(&self, x: &[Vec3; 4]) -> Blocks<4> {
        let mut blocks = [[Mat3::zeros(); 4]; 4];
        if self.distance == 0.0 {
            return blocks;
        }
        let n = self.normal;
        let along: [Vec3; 2] =
            std::array::from_fn(|a| (0..4).map(|k| x[k] * self.turns[a][k]).sum());
        let Some(inverse) = self.inverse_metric(&along) else {
            return blocks;
        };
        let mut across = Mat3::identity() - n * n.transpose();
        match self.free {
            1 => across -= along[0] * along[0].transpose() * inverse[0][0],
            2 => across = Mat3::zeros(),
            _ => {}
        }
        across /= self.distance;
        for k in 0..4 {
            for l in 0..4 {
                let block = &mut blocks[k][l];
                *block = across * (self.weights[k] * self.weights[l]);
                for a in 0..self.free {
                    for b in 0..self.free {
                        let g = inverse[a][b];
                        let (turn_k, turn_l) = (self.turns[a][k], self.turns[b][l]);
                        *block -= n * along[b].transpose() * (g * turn_k * self.weights[l])
                            + along[a] * n.transpose() * (g * self.weights[k] * turn_l)
                            + n * n.transpose() * (g * self.distance * turn_k * turn_l);
                    }
                }
            }
        }
        blocks
    }

    /// The part of −∂²d (1/m) that is left of it without negative eigenvalues: what a barrier, whose slope is negative,
    /// adds to a convex Hessian.
    ///
    /// Along the two eigenvectors of G, with the eigenvalue λ, −∂²d is (U Uᵀ − Q Qᵀ)/(λ d) with Q = c ⊗ J, P = ∂c ⊗ n
    /// and U = Q + d P. P and Q are at right angles, so that the one positive eigenvalue μ of each comes from a
    /// quadratic equation; −c c T/d has none. The sum of these parts is not smaller than −∂²d.
    #[must_use]
    pub fn convex_part(&self, x: &[Vec3; 4]) -> Blocks<4> {
        let mut blocks = [[Mat3::zeros(); 4]; 4];
        for (turn, along) in self.principal_turns(x).into_iter().take(self.free) {
            let lambda = along.norm_squared();
            let squared = |v: &[Real; 4]| v.iter().map(|c| c * c).sum::<Real>();
            let p = squared(&turn).sqrt() * self.distance;
            let q = (squared(&self.weights) * lambda).sqrt();
            let mu = 0.5 * p * (p + (p * p + 4.0 * q * q).sqrt());
            let size = mu / (lambda * self.distance * (mu * mu + p * p * q * q));
            if !size.is_finite() || p == 0.0 || q == 0.0 {
                continue;
            }
            let (by_p, by_q) = (mu * self.distance / p, p);
            let v: [Vec3; 4] = std::array::from_fn(|k| {
                self.normal * (by_p * turn[k]) + along * (by_q * self.weights[k])
            });
            for (row, a) in blocks.iter_mut().zip(&v) {
                for (block, b) in row.iter_mut().zip(&v) {
                    *block += a * b.transpose() * size;
                }
            }
        }
        blocks
    }

    /// ∂c/∂s and J (m) for places s along the eigenvectors of G; as many of the two mean something as there are free
    /// places.
    fn principal_turns(&self, x: &[Vec3; 4]) -> [([Real; 4], Vec3); 2] {
        let displacement = |turn: &[Real; 4]| (0..4).map(|k| x[k] * turn[k]).sum::<Vec3>();
        let [first, second] = self.turns;
        let (u, v) = (displacement(&first), displacement(&second));
        if self.free < 2 {
            return [(first, u), (second, v)];
        }
        // A rotation that makes J₀ · J₁ zero.
        let angle = 0.5 * (2.0 * u.dot(&v)).atan2(u.norm_squared() - v.norm_squared());
        let (sin, cos) = angle.sin_cos();
        let mix = |a: Real, b: Real| {
            let turn = std::array::from_fn(|k| a * first[k] + b * second[k]);
            (turn, u * a + v * b)
        };
        [mix(cos, sin), mix(-sin, cos)]
    }

    /// The inverse of G; nothing if it has none, or one beyond all numbers, as between edges that are parallel but for
    /// 1e-154.
    fn inverse_metric(&self, along: &[Vec3; 2]) -> Option<[[Real; 2]; 2]> {
        let [u, v] = along;
        let mut inverse = [[0.0; 2]; 2];
        match self.free {
            0 => {}
            1 => inverse[0][0] = 1.0 / u.norm_squared(),
            _ => {
                let determinant = u.cross(v).norm_squared();
                let off = -u.dot(v) / determinant;
                inverse = [
                    [v.norm_squared() / determinant, off],
                    [off, u.norm_squared() / determinant],
                ];
            }
        }
        let finite = inverse.iter().flatten().all(|g| g.is_finite());
        finite.then_some(inverse)
    }
}

//! MINRES: the smallest residual in the Krylov space of a symmetric matrix that need not be definite.
//!
//! C. Paige, M. Saunders, "Solution of sparse indefinite systems of linear equations", SIAM J. Numer. Anal. 12, 1975,
//! <https://doi.org/10.1137/0712047>. GMRES would find the same iterates (the matrix is symmetric), but it has to keep
//! all directions; here three are enough.

use cloth_core::math::Real;

/// Memory for [`Minres::solve`], one dimension.
#[derive(Clone, Debug)]
pub struct Minres {
    /// Lanczos vectors: the one before, the present one, and the next.
    lanczos: [Vec<Real>; 3],
    /// The present one preconditioned, and the next.
    preconditioned: [Vec<Real>; 2],
    /// Search directions: two before, one before.
    directions: [Vec<Real>; 2],
    product: Vec<Real>,
}

/// How a Krylov solve ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KrylovReport {
    /// Products with the matrix.
    pub iterations: u32,
    /// Norm of the residual relative to that of the right-hand side, both in the metric of the preconditioner.
    pub residual: Real,
}

impl Minres {
    /// For matrices with `n` rows.
    #[must_use]
    pub fn new(n: usize) -> Self {
        let zeros = || vec![0.0; n];
        Self {
            lanczos: [zeros(), zeros(), zeros()],
            preconditioned: [zeros(), zeros()],
            directions: [zeros(), zeros()],
            product: zeros(),
        }
    }

    /// Solves `A x = b` from x = 0: until the residual is at most `tolerance` of b, or for at most `most` iterations,
    /// or as far as rounding lets it.
    ///
    /// `apply(x, y)` writes `y = A x`, A symmetric. `precondition(r, z)` writes `z = P⁻¹ r`, P symmetric and positive
    /// definite.
    ///
    /// # Panics
    /// If `b` or `x` does not have n entries.
    pub fn solve(
        &mut self,
        mut apply: impl FnMut(&[Real], &mut [Real]),
        mut precondition: impl FnMut(&[Real], &mut [Real]),
        b: &[Real],
        x: &mut [Real],
        tolerance: Real,
        most: u32,
    ) -> KrylovReport {
        assert!(
            b.len() == self.product.len() && x.len() == b.len(),
            "one entry per row"
        );
        let [before, now, next] = &mut self.lanczos;
        let [z, z_next] = &mut self.preconditioned;
        let [second, first] = &mut self.directions;
        for v in [&mut *before, &mut *second, &mut *first] {
            v.fill(0.0);
        }
        x.fill(0.0);
        now.copy_from_slice(b);
        precondition(now, z);
        let mut length = dot(z, now).max(0.0).sqrt();
        let start = length;
        let mut end = KrylovReport {
            iterations: 0,
            residual: if start > 0.0 { 1.0 } else { 0.0 },
        };
        let mut left = start;
        let mut length_before = 1.0;
        // Cosines and sines of the last two rotations.
        let ([mut c0, mut c1], [mut s0, mut s1]) = ([1.0, 1.0], [0.0, 0.0]);
        while end.iterations < most && end.residual > tolerance && length > 0.0 {
            z.iter_mut().for_each(|z| *z /= length);
            apply(z, &mut self.product);
            let diagonal = dot(&self.product, z);
            for i in 0..next.len() {
                next[i] = self.product[i]
                    - diagonal / length * now[i]
                    - length / length_before * before[i];
            }
            precondition(next, z_next);
            let length_next = dot(z_next, next).max(0.0).sqrt();
            // The column of the tridiagonal matrix, turned by the last two rotations and then by a new one.
            let turned = c1 * diagonal - c0 * s1 * length;
            let radius = turned.hypot(length_next);
            let above = s1 * diagonal + c0 * c1 * length;
            let above_that = s0 * length;
            end.iterations += 1;
            if radius <= Real::EPSILON * (above.abs() + above_that.abs()) || radius.is_nan() {
                break; // singular, and b has a part that no x reaches
            }
            (c0, s0) = (c1, s1);
            (c1, s1) = (turned / radius, length_next / radius);
            for i in 0..x.len() {
                let direction = (z[i] - above_that * second[i] - above * first[i]) / radius;
                second[i] = first[i];
                first[i] = direction;
                x[i] += c1 * left * direction;
            }
            left *= -s1;
            end.residual = left.abs() / start;
            length_before = length;
            length = length_next;
            std::mem::swap(before, now);
            std::mem::swap(now, next);
            std::mem::swap(z, z_next);
        }
        end
    }
}

fn dot(a: &[Real], b: &[Real]) -> Real {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

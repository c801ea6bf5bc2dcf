//! The linear system of a Newton step: masses, and a few stiff pairs.

use super::terms::Terms;
use cloth_core::element::Convexity;
use cloth_core::math::{Mat3, Real, Vec3};

/// Conjugate gradients on H = M/Δt² + Σ (Hessians of the barriers), preconditioned by the inverse of its 3 × 3 diagonal blocks. Nothing is
/// assembled: pairs come and go, and a vertex without one is solved by the preconditioner alone.
#[derive(Debug)]
pub(super) struct NewtonSystem {
    inverse_diagonal: Vec<Mat3>,
    residual: Vec<Vec3>,
    preconditioned: Vec<Vec3>,
    direction: Vec<Vec3>,
    product: Vec<Vec3>,
}

/// The residual is reduced to this part of the first one.
const TOLERANCE: Real = 1e-6;
/// Most iterations; the direction is then the best so far, which goes down too.
const MOST_ITERATIONS: u32 = 1000;

impl NewtonSystem {
    pub(super) fn new(vertex_count: usize) -> Self {
        let zeros = vec![Vec3::zeros(); vertex_count];
        Self {
            inverse_diagonal: vec![Mat3::zeros(); vertex_count],
            residual: zeros.clone(),
            preconditioned: zeros.clone(),
            direction: zeros.clone(),
            product: zeros,
        }
    }

    /// Solves H p = −g for the vertices with a `weight` m/Δt² (N/m), where `weight` is zero for the others. Their p is given: what `p` holds at the start. Whether
    /// H has shown itself positive; if not, `p` is nothing but that. Made convex it is, and where rounding says otherwise (gaps of 1e-8 of
    /// the range), `p` is the best so far, or the preconditioned gradient.
    pub(super) fn solve(
        &mut self,
        terms: &Terms,
        weight: &[Real],
        gradient: &[Vec3],
        p: &mut [Vec3],
        convexity: Convexity,
    ) -> bool {
        let certain = convexity != Convexity::Exact;
        if !self.prepare(terms, weight, certain) {
            return false;
        }
        // The given part of p goes to the right.
        multiply(terms, weight, p, &mut self.product);
        let right = gradient.iter().zip(&self.product).zip(weight);
        let mut slope = 0.0;
        let vectors = self.residual.iter_mut().zip(&mut self.direction);
        let vectors = vectors.zip(&self.inverse_diagonal);
        for (((g, known), w), ((r, d), inverse)) in right.zip(vectors) {
            *r = if *w > 0.0 {
                -(g + known)
            } else {
                Vec3::zeros()
            };
            *d = inverse * *r;
            slope += r.dot(d);
        }
        let first = slope;
        let end = TOLERANCE * TOLERANCE * slope;
        for _ in 0..MOST_ITERATIONS {
            if slope <= end || slope.is_nan() {
                break;
            }
            multiply(terms, weight, &self.direction, &mut self.product);
            let along = self.direction.iter().zip(&self.product);
            let curvature: Real = along
                .zip(weight)
                .filter(|(_, w)| **w > 0.0)
                .map(|((d, q), _)| d.dot(q))
                .sum();
            if curvature <= 0.0 || curvature.is_nan() {
                if certain && slope == first {
                    let free = p.iter_mut().zip(&self.direction).zip(weight);
                    free.filter(|(_, w)| **w > 0.0)
                        .for_each(|((p, d), _)| *p = *d);
                }
                return certain;
            }
            slope = self.advance(slope, slope / curvature, weight, p);
        }
        certain || slope.is_finite()
    }

    /// Goes along the direction and turns to the next. Returns r·D⁻¹r.
    fn advance(&mut self, slope: Real, length: Real, weight: &[Real], p: &mut [Vec3]) -> Real {
        let mut next = 0.0;
        for i in (0..p.len()).filter(|&i| weight[i] > 0.0) {
            p[i] += self.direction[i] * length;
            self.residual[i] -= self.product[i] * length;
            self.preconditioned[i] = self.inverse_diagonal[i] * self.residual[i];
            next += self.residual[i].dot(&self.preconditioned[i]);
        }
        let turn = next / slope;
        for i in (0..p.len()).filter(|&i| weight[i] > 0.0) {
            self.direction[i] = self.preconditioned[i] + self.direction[i] * turn;
        }
        next
    }

    /// Inverts the diagonal blocks; false if one is not positive, unless that can only be rounding, and then it is made so.
    fn prepare(&mut self, terms: &Terms, weight: &[Real], certain: bool) -> bool {
        for (block, w) in self.inverse_diagonal.iter_mut().zip(weight) {
            *block = Mat3::identity() * *w;
        }
        for (vertices, hessian) in &terms.pairs {
            for (k, vertex) in vertices.iter().enumerate() {
                self.inverse_diagonal[*vertex as usize] += hessian[k][k];
            }
        }
        for touch in &terms.touches {
            self.inverse_diagonal[touch.vertex as usize] += touch.hessian;
        }
        for (block, w) in self.inverse_diagonal.iter_mut().zip(weight) {
            if *w == 0.0 {
                *block = Mat3::zeros();
                continue;
            }
            match block.cholesky() {
                Some(factor) => *block = factor.inverse(),
                None if certain => *block = Mat3::identity() / block.trace(),
                None => return false,
            }
        }
        true
    }
}

/// y = H x, rows of prescribed vertices included, which mean nothing.
fn multiply(terms: &Terms, weight: &[Real], x: &[Vec3], y: &mut [Vec3]) {
    for ((y, x), w) in y.iter_mut().zip(x).zip(weight) {
        *y = x * *w;
    }
    for (vertices, hessian) in &terms.pairs {
        let local = vertices.map(|v| x[v as usize]);
        for (row, vertex) in hessian.iter().zip(vertices) {
            let mut sum = Vec3::zeros();
            for (block, x) in row.iter().zip(&local) {
                sum += block * x;
            }
            y[*vertex as usize] += sum;
        }
    }
    for touch in &terms.touches {
        y[touch.vertex as usize] += touch.hessian * x[touch.vertex as usize];
    }
}

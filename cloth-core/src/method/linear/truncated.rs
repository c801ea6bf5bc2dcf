//! Conjugate gradients that end early, around any operator and any preconditioner: the inner loop of truncated Newton
//! methods (S. G. Nash, "A survey of truncated-Newton methods", J. Comput. Appl. Math. 124, 2000,
//! <https://doi.org/10.1016/S0377-0427(00)00426-X>).

use crate::math::{Real, Vec3};
use crate::method::vectors::{add, dot};

/// The working memory.
#[derive(Debug, Default)]
pub struct TruncatedConjugateGradients {
    residual: Vec<Vec3>,
    /// The preconditioned residual (m).
    preconditioned: Vec<Vec3>,
    direction: Vec<Vec3>,
    product: Vec<Vec3>,
}

impl TruncatedConjugateGradients {
    /// Makes room for so many vertices, as the first solve does otherwise.
    pub fn resize(&mut self, vertex_count: usize) {
        let lists = [
            &mut self.residual,
            &mut self.preconditioned,
            &mut self.direction,
            &mut self.product,
        ];
        for list in lists {
            list.resize(vertex_count, Vec3::zeros());
        }
    }

    /// Writes `p = −H⁻¹ g` (m), nearly, to `out` for a gradient g (N), with `multiply` for products with H (N/m),
    /// positive definite, and `inverse` near H⁻¹. It ends where the residual, in the norm of `inverse`, is `tolerance`
    /// times the first, or after `most` iterations. Returns `rᵀ H⁻¹ r` (J) of the residual r that is left, nearly, and
    /// the number of iterations: `gᵀ H⁻¹ g = −gᵀ p + rᵀ H⁻¹ r`. It is 0 where rounding has made `inverse` indefinite.
    pub fn solve(
        &mut self,
        (tolerance, most): (Real, u32),
        mut multiply: impl FnMut(&[Vec3], &mut [Vec3]),
        mut inverse: impl FnMut(&[Vec3], &mut [Vec3]),
        gradient: &[Vec3],
        out: &mut [Vec3],
    ) -> (Real, u32) {
        self.resize(gradient.len());
        let pairs = self.residual.iter_mut().zip(gradient);
        pairs.for_each(|(r, g)| *r = -g);
        inverse(&self.residual, &mut self.preconditioned);
        self.direction.copy_from_slice(&self.preconditioned);
        out.fill(Vec3::zeros());
        let first = dot(&self.residual, &self.preconditioned);
        let mut size = first;
        for iteration in 1..=most {
            multiply(&self.direction, &mut self.product);
            let length = size / dot(&self.direction, &self.product);
            if !(length.is_finite() && length > 0.0) {
                // A gradient of zero, or a matrix that rounding has made indefinite.
                return (size.max(0.0), iteration);
            }
            add(out, length, &self.direction);
            add(&mut self.residual, -length, &self.product);
            inverse(&self.residual, &mut self.preconditioned);
            let next = dot(&self.residual, &self.preconditioned);
            if next <= tolerance * tolerance * first {
                return (next.max(0.0), iteration);
            }
            let ratio = next / size;
            size = next;
            for (p, z) in self.direction.iter_mut().zip(&self.preconditioned) {
                *p = z + *p * ratio;
            }
        }
        (size.max(0.0), most)
    }
}

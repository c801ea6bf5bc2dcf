//! The largest stable step of symplectic Euler, from the fastest oscillation of the cloth.
//!
//! In a small oscillation of angular frequency ω, with `z = Δt ω`, symplectic Euler takes `(x, Δt v)` to
//! `(x + Δt v − z² x, Δt v − z² x)`: a matrix of trace 2 − z² and determinant 1. Its eigenvalues have a product of 1,
//! and both lie on the unit circle as long as the trace is within ±2, so it is stable for `Δt ω < 2`. With damping,
//! `c = Δt (α + β ω²)`, the matrix has the trace 2 − z² − c and the determinant 1 − c; both eigenvalues are below 1 in
//! absolute value while the trace is within ±(2 − c), which is `z² + 2c < 4`. What is asked for is the largest
//! eigenvalue `ω²` of `M⁻¹ K`, with `K` the Hessian of the energy. Lanczos' method finds it from products alone, in the
//! symmetric form `A = M^{-½} K M^{-½}` over the free vertices.
//!
//! Of `K` the negative eigenvalues of each element are dropped ([`Convexity::Clamp`]). They belong to compressed
//! springs that buckle sideways: no oscillation and no overshoot, and no step size prevents it. Dropping them can only
//! raise the largest eigenvalue, so the step that comes out is on the safe side. Stretched springs are stiff across
//! their axis too, by `k (1 − L/l)`, and that counts.
//!
//! By hand, for springs alone: `ω² ≤ max 2 Σ k/m` over the vertices, with the sum over their springs (Gershgorin), so
//! `Δt = √(2m/Σk)` is stable. A long chain has `ω² → 4 k/m`, a grid with diagonals one way and equal k `(4 + 2√2) k/m`,
//! equilateral triangles `6 k/m` (tests). With m = ρ l² on the first grid, Δt = 0.765 l √(ρ/k). The endless grid of
//! alternating diagonals has `6 k/(ρ l²)`, and 288 steps in 1/60 s for a sheet of 64 × 64 vertices, 1 m, 0.2 kg/m² and
//! 10⁴ N/m. The sheet itself needs 369: its corners ask for them, `ω² = 9.86 k/(ρ l²)` where one triangle alone gives
//! the mass of a vertex on full springs.
//!
//! Dispersion. In a chain of spacing l a wave `x_j = e^(i(ξ l j − ωt))` of number ξ has
//! `m ω² = k (2 − 2 cos ξl) = 4k sin²(ξl/2)`, so `ω = (2/l) c sin(ξl/2)` with `c = l √(k/m)`. The continuum has
//! `ω = cξ`: the chain is too slow by the fraction `(ξl)²/24`, of second order in l. A test holds the formula at the
//! shortest wave of a chain of n masses with one end held, `ξl = π (2n − 1)/(2n + 1)`, to 0.05 %
//! (`a_chain_has_the_closed_form_of_its_length` in `tests/chapter/stability.rs`).
//!
//! How other elements scale is told by the largest `ω²` of plane waves on the endless equilateral lattice at rest, of
//! side l and areal density ρ (m = √3/2 ρ l²; that of triangles holds for 0 ≤ ν < 1, found numerically):
//!
//! | element | ω² | stable step |
//! |---|---|---|
//! | springs, `k = √3/2 Y` | `6 Y/(ρ l²)` | `0.816 l √(ρ/Y)` |
//! | [`StvkTriangle`](cloth_core::energy::StvkTriangle) | `16 Y/(3 (1 − ν²) ρ l²)` | `0.866 l √((1 − ν²) ρ/Y)` |
//! | [`CurvatureHinge`](cloth_core::energy::CurvatureHinge) | `48 D/(ρ l⁴)` | `0.289 l² √(ρ/D)` |
//!
//! Triangles of ν = 1/3 and springs are the same there. A wave with the phase differences α = β + γ along the three
//! edges bends the hinges with `ω² m = (16/3) K Σ (cos(α/2) − cos((β − γ)/2))²`, K = 2D/(√3 l²), summed over the three
//! edges (those of β and γ have `α + γ` and `α + β` in the place of `β − γ`), and most where β = γ = 2π/3, by 36 K.
//! Bending takes over where l² < 8 D/Y, l < 0.09 mm for 10⁻⁵ N·m and 10⁴ N/m. The estimate counts all elements; beyond
//! it [`SymplecticEuler`](crate::SymplecticEuler) refuses the step.
//!
//! B. N. Parlett, *The Symmetric Eigenvalue Problem*, SIAM 1998, chapter 13, <https://doi.org/10.1137/1.9781611971163>.

use cloth_core::element::Convexity;
use cloth_core::math::{Real, Vec3};
use cloth_core::method::family::Energies;
use cloth_core::particles::Particles;
use nalgebra::SMatrix;

/// Relative bound on the error of ω² at which the iteration ends.
const ACCURACY: Real = 1e-3;
/// Vectors of the Krylov basis that are kept. When they are spent, the iteration starts again with the best vector in
/// their span.
const BASIS: usize = 16;
/// Starts at most; one is enough when the start vector is the answer to almost the same question.
const MOST_STARTS: usize = 20;

/// Largest stable step `2/ω_max` (s) of symplectic Euler at these positions (m), a little on the safe side: relative to
/// the truth it is at most 0.05 % too small, half of the bound on ω², unless a cloth is so large that the iteration
/// ends before it gets there.
///
/// `None` where there is no stiffness, so that every step is stable.
///
/// The start vector is fixed, so the answer repeats bit for bit.
///
/// Limits: it is valid for small oscillations about these positions. Where springs are stretched during the motion, the
/// limit falls; [`crate::SymplecticEuler`] therefore repeats the estimate as it goes.
///
/// # Panics
/// If the numbers of vertices differ.
#[must_use]
pub fn stable_time_step(
    energies: &Energies,
    particles: &Particles,
    positions: &[Vec3],
) -> Option<Real> {
    assert_eq!(energies.vertex_count(), particles.len(), "number of masses");
    assert_eq!(positions.len(), particles.len(), "number of positions");
    Spectrum::new(particles).stable_time_step(energies, particles, positions)
}

/// Lanczos' method for the largest eigenvalue, and the memory it needs. It remembers the eigenvector, so that the next
/// estimate, at positions not far away, takes a few products only.
#[derive(Clone, Debug)]
pub(crate) struct Spectrum {
    /// Orthonormal vectors, the first of them the start; zero at prescribed vertices.
    basis: Vec<Vec<Vec3>>,
    /// `A` times the last basis vector, and what is left of it outside the basis.
    product: Vec<Vec3>,
    scratch: Vec<Vec3>,
}

/// An approximate eigenvalue of `A` (1/s²), its vector in terms of the basis, and a bound of its distance from a true
/// one.
struct Ritz {
    value: Real,
    vector: [Real; BASIS],
    error: Real,
}

impl Spectrum {
    pub(crate) fn new(particles: &Particles) -> Self {
        let zeros = vec![Vec3::zeros(); particles.len()];
        let mut basis = vec![zeros.clone(); BASIS];
        for (vertex, start) in basis[0].iter_mut().enumerate() {
            if !particles.is_prescribed(vertex) {
                *start = noise(vertex);
            }
        }
        normalize(&mut basis[0]);
        Self {
            basis,
            product: zeros.clone(),
            scratch: zeros,
        }
    }

    /// See [`stable_time_step`].
    pub(crate) fn stable_time_step(
        &mut self,
        energies: &Energies,
        particles: &Particles,
        positions: &[Vec3],
    ) -> Option<Real> {
        let mut square = 0.0;
        for _ in 0..MOST_STARTS {
            let ritz = self.lanczos_cycle(energies, particles, positions);
            self.restart(&ritz);
            // The true eigenvalue is not below the value, and hardly above value + error.
            square = ritz.value + ritz.error;
            if ritz.error <= ACCURACY * ritz.value {
                break;
            }
        }
        (square > 0.0).then(|| 2.0 / square.sqrt())
    }

    /// Builds a basis from its first vector until the largest eigenvalue is known or the basis is full.
    fn lanczos_cycle(
        &mut self,
        energies: &Energies,
        particles: &Particles,
        positions: &[Vec3],
    ) -> Ritz {
        let mut tridiagonal = SMatrix::<Real, BASIS, BASIS>::zeros();
        for step in 0.. {
            self.multiply(step, energies, particles, positions);
            tridiagonal[(step, step)] = dot(&self.basis[step], &self.product);
            let beta = self.orthogonalize(step);
            let ritz = largest(&tridiagonal, beta, step);
            if step + 1 == BASIS || ritz.error <= ACCURACY * ritz.value {
                return ritz;
            }
            self.basis[step + 1].copy_from_slice(&self.product);
            tridiagonal[(step, step + 1)] = beta;
            tridiagonal[(step + 1, step)] = beta;
        }
        unreachable!("the basis is full before")
    }

    /// `product = A · basis[step]`.
    fn multiply(&mut self, step: usize, energies: &Energies, particles: &Particles, x: &[Vec3]) {
        let w = particles.inverse_mass();
        for ((scaled, q), w) in self.scratch.iter_mut().zip(&self.basis[step]).zip(w) {
            *scaled = q * w.sqrt();
        }
        self.product.fill(Vec3::zeros());
        energies.add_hessian_product(x, &self.scratch, Convexity::Clamp, &mut self.product);
        for (product, w) in self.product.iter_mut().zip(w) {
            *product *= w.sqrt();
        }
    }

    /// Takes away what the product has in common with the basis, and scales the rest to length 1; returns the length it
    /// had.
    fn orthogonalize(&mut self, step: usize) -> Real {
        // The recurrence needs the last two vectors only; all of them hold off rounding, at little cost for so few.
        for q in &self.basis[..=step] {
            let common = dot(q, &self.product);
            for (product, q) in self.product.iter_mut().zip(q) {
                *product -= q * common;
            }
        }
        normalize(&mut self.product)
    }

    /// Replaces the first basis vector by the approximate eigenvector.
    fn restart(&mut self, ritz: &Ritz) {
        self.scratch.fill(Vec3::zeros());
        for (q, &part) in self.basis.iter().zip(&ritz.vector) {
            if part != 0.0 {
                for (sum, q) in self.scratch.iter_mut().zip(q) {
                    *sum += q * part;
                }
            }
        }
        if normalize(&mut self.scratch) > 0.0 {
            self.basis[0].copy_from_slice(&self.scratch);
        }
    }
}

/// The largest eigenvalue of a tridiagonal matrix of which `step + 1` rows are known and the rest is zero; `beta`
/// couples it to what is not known.
fn largest(tridiagonal: &SMatrix<Real, BASIS, BASIS>, beta: Real, step: usize) -> Ritz {
    let eigen = tridiagonal.symmetric_eigen();
    let (at, value) = eigen.eigenvalues.argmax();
    let column = eigen.eigenvectors.column(at);
    let vector = std::array::from_fn(|row| if row <= step { column[row] } else { 0.0 });
    Ritz {
        value,
        vector,
        error: beta * vector[step].abs(),
    }
}

/// A vector with coordinates in (−1, 1) that depends on `vertex` only, without pattern (the finaliser of `splitmix64`).
pub(crate) fn noise(vertex: usize) -> Vec3 {
    Vec3::from_fn(|axis, _| {
        let mut bits = (3 * vertex as u64 + axis as u64 + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        bits ^= bits >> 31;
        (bits >> 11) as Real / (1u64 << 52) as Real - 1.0
    })
}

pub(crate) fn dot(a: &[Vec3], b: &[Vec3]) -> Real {
    a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
}

/// Scales to length 1 and returns the length; leaves zero alone.
fn normalize(vector: &mut [Vec3]) -> Real {
    let length = dot(vector, vector).sqrt();
    if length > 0.0 {
        vector.iter_mut().for_each(|v| *v /= length);
    }
    length
}

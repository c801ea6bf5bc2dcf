//! Extreme eigenvalues and condition numbers, out of the numbers that conjugate gradients make anyway.
//!
//! Conjugate gradients and Lanczos' process build the same basis. From the step lengths α of the former, and the
//! fractions β of the last direction in the next one, follows the tridiagonal matrix T of the latter,
//!
//! ```text
//! T_kk = 1/α_k + β_{k−1}/α_{k−1},    T_{k,k+1} = √β_k / α_k
//! ```
//!
//! whose eigenvalues lie between those of `D⁻¹A` and find the outermost ones first. They are bounds from inside: the
//! largest is never too large, the smallest never too small, so the condition number is never overestimated.
//!
//! G. H. Golub, C. F. Van Loan, *Matrix Computations*, 4th ed. 2013, sections 10.1 and 11.3.

use super::conjugate_gradients::{ConjugateGradients, Preconditioner};
use super::solver::{LinearError, LinearSolver, StoppingCriteria};
use crate::math::{Real, Vec3};
use crate::method::block_matrix::BlockMatrix;

/// The outermost eigenvalues, from inside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spectrum {
    /// Not smaller than the smallest eigenvalue.
    pub smallest: Real,
    /// Not larger than the largest eigenvalue.
    pub largest: Real,
}

impl Spectrum {
    /// `largest/smallest`.
    #[must_use]
    pub fn condition_number(&self) -> Real {
        self.largest / self.smallest
    }
}

/// Estimates the outermost eigenvalues of a positive definite matrix over the free vertices, with or without
/// preconditioner: of `D⁻¹A` or of `A`.
///
/// The estimate needs as many products as conjugate gradients need to converge, and is then good to some digits: a
/// dozen for the largest and half of them for the smallest. `max_iterations` limits them.
///
/// # Errors
/// [`LinearError::NotPositiveDefinite`].
///
/// # Panics
/// If `is_free` does not have one entry per row, or no vertex is free, or `max_iterations` is zero.
pub fn spectrum(
    matrix: &BlockMatrix,
    is_free: &[bool],
    preconditioner: Preconditioner,
    max_iterations: u32,
) -> Result<Spectrum, LinearError> {
    assert!(is_free.contains(&true), "no vertex is free");
    let criteria = StoppingCriteria {
        tolerance: 1e-14,
        max_iterations,
    };
    let mut solver =
        ConjugateGradients::new(is_free, preconditioner, criteria).expect("at least one iteration");
    solver.prepare(matrix)?;
    let b: Vec<Vec3> = (0..is_free.len()).map(noise).collect();
    solver.solve(matrix, &b, &mut vec![Vec3::zeros(); b.len()])?;
    Ok(solver
        .spectrum()
        .expect("b is not zero, so there was a step"))
}

/// A vector with a part in every eigenvector: numbers in (−1, 1) without a pattern, the same ones every time.
pub(super) fn noise(vertex: usize) -> Vec3 {
    Vec3::from_fn(|axis, _| {
        // The golden ratio's multiples fall evenly; their product with another irrational number hides the order.
        let place = (3 * vertex + axis + 1) as Real * 0.618_033_988_749_895;
        2.0 * (place.fract() * 97.409_091_034).fract() - 1.0
    })
}

/// The tridiagonal matrix of the present solve.
#[derive(Debug)]
pub(super) struct Tridiagonal {
    diagonal: Vec<Real>,
    /// Squares of the entries beside the diagonal; the last one leads out of the matrix.
    beside_squared: Vec<Real>,
    /// `β/α` of the last step, which the next diagonal entry needs.
    carried: Real,
}

/// More entries than this are not kept: the outermost eigenvalues are found long before.
const MOST: u32 = 2000;

impl Tridiagonal {
    pub(super) fn with_room_for(iterations: u32) -> Self {
        let room = iterations.min(MOST) as usize;
        Self {
            diagonal: Vec::with_capacity(room),
            beside_squared: Vec::with_capacity(room),
            carried: 0.0,
        }
    }

    pub(super) fn clear(&mut self) {
        self.diagonal.clear();
        self.beside_squared.clear();
        self.carried = 0.0;
    }

    /// Adds a step of length α, and β.
    pub(super) fn push(&mut self, length: Real, turn: Real) {
        if self.diagonal.len() < self.diagonal.capacity() {
            self.diagonal.push(1.0 / length + self.carried);
            self.beside_squared.push(turn / (length * length));
            self.carried = turn / length;
        }
    }

    pub(super) fn spectrum(&self) -> Option<Spectrum> {
        let count = self.diagonal.len();
        (count > 0).then(|| Spectrum {
            smallest: self.eigenvalue(0),
            largest: self.eigenvalue(count - 1),
        })
    }

    /// Eigenvalue number `index` in ascending order, by bisection.
    fn eigenvalue(&self, index: usize) -> Real {
        // Gershgorin's circles; all eigenvalues are positive.
        let last = self.diagonal.len() - 1;
        let radius = |k: usize| {
            if k < last {
                self.beside_squared[k].sqrt()
            } else {
                0.0
            }
        };
        let bound = |k: usize| {
            let before = if k > 0 { radius(k - 1) } else { 0.0 };
            self.diagonal[k] + before + radius(k)
        };
        let (mut low, mut high) = (0.0, (0..=last).map(bound).fold(0.0, Real::max));
        loop {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                return middle;
            }
            if self.count_below(middle) > index {
                high = middle;
            } else {
                low = middle;
            }
        }
    }

    /// How many eigenvalues lie below `shift`: the negative pivots of `T − shift` (Sturm).
    fn count_below(&self, shift: Real) -> usize {
        let mut count = 0;
        let mut pivot = 1.0;
        let mut beside_squared = 0.0;
        for (diagonal, next) in self.diagonal.iter().zip(&self.beside_squared) {
            pivot = diagonal - shift - beside_squared / pivot;
            if pivot == 0.0 {
                pivot = Real::EPSILON * diagonal;
            }
            count += usize::from(pivot < 0.0);
            beside_squared = *next;
        }
        count
    }
}

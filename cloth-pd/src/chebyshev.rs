//! The Chebyshev semi-iterative method over the plain iteration (H. Wang, "A Chebyshev semi-iterative approach for
//! accelerating projective and position-based dynamics", 2015, algorithm 1), with a safeguard.
//!
//! With d = A⁻¹∇G at the iterate x and x' the one before it,
//!
//! `x⁺ = x' + ω (x − d − x')`,  ω = 1 in the first [`DELAY`] iterations, then 2/(2 − ρ²), then 4/(4 − ρ² ω),
//!
//! which tends to 2/(1 + √(1 − ρ²)) (no under-relaxation: γ = 1 in the paper).
//!
//! *Why these weights.* Near a minimum a plain iteration multiplies the error of a mode by its μ. A combination of n
//! plain iterates, with coefficients that add up to 1, leaves P(μ) of it, P a polynomial of degree n with P(1) = 1. The
//! smallest over |μ| ≤ ρ is `Pₙ = Tₙ(μ/ρ)/Tₙ(1/ρ)`, Tₙ Chebyshev's. By their recurrence
//! `Tₙ₊₁(y) = 2 y Tₙ(y) − Tₙ₋₁(y)`, at y = μ/ρ and at 1/ρ, `Pₙ₊₁ = Pₙ₋₁ + ωₙ₊₁ (μ Pₙ − Pₙ₋₁)` with
//! `ωₙ₊₁ = 2 Tₙ(1/ρ)/(ρ Tₙ₊₁(1/ρ))`: the iteration above. So ω₂ = 2/(2 − ρ²), and `1/ωₙ₊₁ = 1 − ρ² ωₙ/4`. P₀ and P₁ are
//! the last two iterates of the delay.
//!
//! *Why that is the smallest.* On |μ| ≤ ρ |Pₙ| is at most 1/Tₙ(1/ρ), and it takes this value with alternating signs at
//! the n + 1 points μ = ρ cos(jπ/n). If R, of degree n with R(1) = 1, stayed below that, Pₙ − R would change its sign
//! between each two of them: n zeros there and one at 1, too many for a polynomial of degree n that is not 0. With
//! 1/ρ = cosh a, Tₙ(1/ρ) = cosh(n a), so after n iterations 1/cosh(n a) ≤ 2 e⁻ⁿᵃ is left, `e⁻ᵃ = (1 − √(1 − ρ²))/ρ`.
//! Near ρ = 1 a is about √(2 (1 − ρ)), while a plain iteration has −ln ρ, about 1 − ρ: that is the gain.
//!
//! The μ here lie in [0, ρ], half of that range. Plain increments times γ = 2/(2 − ρ) would have the factors 1 − γ (1 −
//! μ), which go from −ρ' to ρ' = ρ/(2 − ρ), and where ρ is near 1 the iterations to a digit would be fewer by √2. That
//! is not done.
//!
//! *Which ρ.* Near a minimum with a positive definite Hessian 0 < A⁻¹∇²G ≤ 1, so a plain iteration multiplies the error
//! in each mode by a μ in [0, 1), and the accelerated one by the roots t of t² − ω μ t + ω − 1 = 0. Those are below 1
//! in size for every μ < 1 and ω < 2: no ρ < 1 diverges there. Modes with μ ≤ ρ keep √(ω − 1) = (1 − √(1 − ρ²))/ρ, for
//! ρ = 0.9995 0.969 an iteration, so that 73 make a digit and not 4600; a ρ too small leaves the modes above it slower,
//! a ρ too large makes all of them as slow as itself, and they ring. Without a ρ it is the quotient of the sizes
//! ‖A⁻¹∇G‖_A of two plain iterations, which the largest μ bounds from above.
//!
//! *Where it would diverge:* far from a minimum, where the projections turn from one iteration to the next, and where
//! ∇²G is not positive (compressed springs, μ > 1). So an extrapolation that raises G is replaced by the plain iterate,
//! and ω begins at 1 again. The safeguard costs an evaluation only then: else the next iteration needs it anyway.

use crate::global::GlobalSystem;
use crate::objective::{Objective, Point};
use cloth_core::math::{Real, Vec3};

/// Plain iterations before the first extrapolation (S in the paper, which takes 10).
const DELAY: u32 = 3;
/// An estimate is not trusted beyond this: at 1 the method would not converge.
const LARGEST_RADIUS: Real = 0.9999;

/// What the method keeps from one iteration to the next.
#[derive(Debug)]
pub(crate) struct Chebyshev {
    given: Option<Real>,
    /// ρ (dimensionless).
    radius: Real,
    /// ω (dimensionless).
    weight: Real,
    /// Iterations since the method began anew.
    count: u32,
    /// The length of the last plain increment, in the norm of its own matrix (√J).
    last_size: Real,
    /// The displacement before the last (m).
    before: Vec<Vec3>,
    increment: Vec<Vec3>,
    next: Point,
}

impl Chebyshev {
    pub(crate) fn new(given: Option<Real>, vertex_count: usize) -> Self {
        let zeros = vec![Vec3::zeros(); vertex_count];
        Self {
            given,
            radius: given.unwrap_or(0.0),
            weight: 1.0,
            count: 0,
            last_size: 0.0,
            before: zeros.clone(),
            increment: zeros,
            next: Point::new(vertex_count),
        }
    }

    pub(crate) fn begin(&mut self) {
        self.restart();
        self.last_size = 0.0;
        self.radius = self.given.unwrap_or(0.0);
    }

    fn restart(&mut self) {
        (self.weight, self.count) = (1.0, 0);
    }

    /// Moves the evaluated `point` by one iteration. Returns whether an extrapolation was taken back.
    pub(crate) fn advance(
        &mut self,
        objective: &mut Objective,
        global: &mut GlobalSystem,
        point: &mut Point,
    ) -> bool {
        global.solve(&point.gradient, &mut self.increment);
        self.count += 1;
        if self.given.is_none() && self.count <= DELAY {
            // ‖A⁻¹g‖ in the norm of A, in which the plain iteration contracts by its largest eigenvalue.
            let size = cloth_core::method::vectors::dot(&point.gradient, &self.increment)
                .max(0.0)
                .sqrt();
            if self.last_size > 0.0 && size.is_finite() {
                self.radius = (size / self.last_size).min(LARGEST_RADIUS);
            }
            self.last_size = size;
        }
        if self.count <= DELAY {
            self.before.copy_from_slice(&point.displacement);
            let from = &self.before;
            point.move_to(from, &self.increment, -1.0);
            return false;
        }
        let squared = self.radius * self.radius;
        self.weight = match self.count - DELAY {
            1 => 2.0 / (2.0 - squared),
            _ => 4.0 / (4.0 - squared * self.weight),
        };
        for vertex in 0..self.before.len() {
            let (old, now) = (self.before[vertex], point.displacement[vertex]);
            let plain = now - self.increment[vertex];
            self.next.displacement[vertex] = old + (plain - old) * self.weight;
        }
        objective.evaluate(&mut self.next, &None);
        self.before.copy_from_slice(&point.displacement);
        // Not so if the value is not a number.
        if self.next.value <= point.value {
            std::mem::swap(point, &mut self.next);
            return false;
        }
        point.move_to(&self.before, &self.increment, -1.0);
        self.restart();
        true
    }
}

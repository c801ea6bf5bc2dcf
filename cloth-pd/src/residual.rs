//! How far an iterate is from a minimum, at the price of one subtraction.

use cloth_core::math::{Real, Vec3};

/// `‖∇G(x)‖/‖∇G(x̃)‖` in the norm of M⁻¹ (dimensionless).
///
/// `∇G(x⁽ᵏ⁾) = A d⁽ᵏ⁾ − b(x⁽ᵏ⁾)`, and `d⁽ᵏ⁾` came out of `A d⁽ᵏ⁾ = b(x⁽ᵏ⁻¹⁾)`. So the gradient is the difference of two
/// right-hand sides, which are there anyway.
#[derive(Debug)]
pub(crate) struct Residual {
    tolerance: Real,
    /// `‖∇G(x̃)‖` (N/√kg).
    reference: Real,
    /// `b(x⁽ᵏ⁻¹⁾)` (N).
    last_pull: Vec<Vec3>,
    iteration: u32,
    value: Option<Real>,
}

impl Residual {
    pub(crate) fn new(tolerance: Real, vertex_count: usize) -> Self {
        Self {
            tolerance,
            reference: 0.0,
            last_pull: vec![Vec3::zeros(); vertex_count],
            iteration: 0,
            value: None,
        }
    }

    /// Starts a step; `gradient_at_prediction` writes `±∇G(x̃)` (N) to a zeroed vector.
    pub(crate) fn begin(
        &mut self,
        inverse_mass: &[Real],
        gradient_at_prediction: impl FnOnce(&mut [Vec3]),
    ) {
        self.last_pull.fill(Vec3::zeros());
        gradient_at_prediction(&mut self.last_pull);
        self.reference = norm(inverse_mass, self.last_pull.iter().copied());
        self.iteration = 0;
        self.value = self.is_zero_at_prediction().then_some(0.0);
    }

    /// Whether x̃ is a stationary point already.
    pub(crate) fn is_zero_at_prediction(&self) -> bool {
        self.reference == 0.0
    }

    /// Takes `b` (N) at the present iterate; whether the tolerance is met there. Before the first iteration there is nothing to
    /// compare with.
    pub(crate) fn is_met(&mut self, inverse_mass: &[Real], pull: &[Vec3]) -> bool {
        if self.is_zero_at_prediction() {
            return true;
        }
        if self.iteration > 0 {
            let gradient = self.last_pull.iter().zip(pull).map(|(last, b)| last - b);
            self.value = Some(norm(inverse_mass, gradient) / self.reference);
        }
        self.iteration += 1;
        self.last_pull.copy_from_slice(pull);
        self.value.is_some_and(|value| value <= self.tolerance)
    }

    /// The ratio that was measured last.
    pub(crate) fn value(&self) -> Option<Real> {
        self.value
    }
}

/// Norm in the metric of M⁻¹; prescribed vertices do not count.
fn norm(inverse_mass: &[Real], gradient: impl Iterator<Item = Vec3>) -> Real {
    let squares = inverse_mass
        .iter()
        .zip(gradient)
        .map(|(w, g)| w * g.norm_squared());
    squares.sum::<Real>().sqrt()
}

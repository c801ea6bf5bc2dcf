//! How far an iterate is from a minimum, at the price of one subtraction.

use cloth_core::math::{Real, Vec3};

/// `‖∇G(x)‖/‖∇G(x̃)‖` in the norm of M⁻¹ (dimensionless).
///
/// `∇G(x⁽ᵏ⁾) = A d⁽ᵏ⁾ − b(x⁽ᵏ⁾)`, and `d⁽ᵏ⁾` came out of `A d⁽ᵏ⁾ = b(x⁽ᵏ⁻¹⁾)`. So the gradient is the difference of two
/// right-hand sides, which are there anyway; and at x̃, where d = 0, it is `−b(x̃)`.
#[derive(Debug)]
pub(crate) struct Residual {
    tolerance: Real,
    /// `‖∇G(x̃)‖` (N/√kg), once x̃ has been looked at.
    reference: Option<Real>,
    /// `b` (N) at the iterate looked at last.
    last_pull: Vec<Vec3>,
    /// At the iterate looked at last.
    value: Option<Real>,
}

impl Residual {
    pub(crate) fn new(tolerance: Real, vertex_count: usize) -> Self {
        Self {
            tolerance,
            reference: None,
            last_pull: vec![Vec3::zeros(); vertex_count],
            value: None,
        }
    }

    /// Forgets the step before.
    pub(crate) fn begin(&mut self) {
        (self.reference, self.value) = (None, None);
    }

    /// Takes `b` (N) at an iterate, at x̃ first; whether the tolerance is met there. A start other than x̃ did not come out of a solve, and
    /// nothing is known of it.
    pub(crate) fn is_met(&mut self, inverse_mass: &[Real], pull: &[Vec3], iterations: u32) -> bool {
        match self.reference {
            None => {
                let reference = norm(inverse_mass, pull.iter().copied());
                self.reference = Some(reference);
                self.value = Some(if reference > 0.0 { 1.0 } else { 0.0 });
            }
            Some(reference) if iterations > 0 => {
                let gradient = self.last_pull.iter().zip(pull).map(|(last, b)| last - b);
                self.value = Some(norm(inverse_mass, gradient) / reference);
            }
            Some(_) => {}
        }
        self.last_pull.copy_from_slice(pull);
        self.value.is_some_and(|value| value <= self.tolerance)
    }

    /// At the iterate looked at last.
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

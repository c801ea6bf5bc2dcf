//! How far to go along a Newton direction: backtracking with Armijo's condition, and its form for the last digits.
//!
//! **Why the iteration converges**, for springs, hinges with a constant Hessian and no contact, apart from rounding. As
//! `½ k (l − L)² = ½ k l² − k L l + ½ k L²`, and l is a convex function of the positions, a spring is a quadratic
//! function less a convex one. The convex one lies above its tangents, so for all x and p, also where springs are
//! compressed or have no length,
//! ```text
//! G(x + p) ≤ G(x) + ∇G(x)·p + ½ pᵀA₀ p,    A₀ = M/s² + the Hessian of E with all rest lengths 0
//! ```
//! Let `p = −A⁻¹∇G`, the eigenvalues of A lie between μ > 0 and Λ, and those of A₀ up to Λ₀. With the square of the
//! Newton decrement, `J = ∇GᵀA⁻¹∇G`, we have `pᵀA₀ p ≤ Λ₀ ‖p‖² ≤ Λ₀ J/μ`, and so
//! `G(x + t p) − G(x) ≤ −t J + ½ t² Λ₀ J/μ`. Armijo's condition holds where that is at most `−c t J`: for every
//! `t ≤ 2 (1 − c) μ/Λ₀`. As a length is never below a tenth of the one before, t ends at `min(1, 0.2 (1 − c) μ/Λ₀)` or
//! more, the same bound in every iteration, and G falls by `c t J ≥ c t ‖∇G‖²/Λ`. G is never negative, so the sum of
//! all falls is finite, and ∇G tends to 0.
//!
//! By [`Convexity::Clamp`](cloth_core::element::Convexity::Clamp) A has such bounds: across a spring it has
//! `max(0, k (1 − L/l))`, at most k, so that `M/s² ≤ A ≤ A₀`: μ is the least m/s² and Λ = Λ₀. (With `A = A₀` in
//! every iteration t = 1 passes always: that is the iteration of projective dynamics.) The bounds are poor, and the
//! rate that they give, too; they say that no start is too far away, and that every limit is a stationary point, not
//! that it is a minimum. Nothing of the kind holds for other choices. The blend of `system` has no μ of its own, since
//! it is made nearly singular; by absolute values Λ has no bound where l tends to 0; L-BFGS has neither. They need
//! fewer iterations, and where they fail Newton's method or the next blend takes over. In general: Nocedal and Wright,
//! *Numerical Optimization*, 2006, theorem 3.2.

use super::stage::Stage;
use crate::stability::dot;
use cloth_core::math::{Real, Vec3};
use cloth_core::method::line_search::{ARMIJO, Found, Trial, backtrack};

/// `G` may rise by this fraction of itself, and by the rounding of terms that cancel in it, where the slopes show that
/// the minimum comes nearer: two values of `G` that differ by less cannot be told apart (see [`search`]).
const ROUNDING: Real = 1e-10;
/// In that case the slope at the new point may be at most this fraction of the size of the first, the approximate Wolfe
/// condition `φ′(α) ≤ (1 − 2c) |φ′(0)|` with c = 0.1: stricter than [`ARMIJO`]'s c, which would let through steps to
/// almost as far beyond the minimum as they started before it. How steeply `G` still falls there does not matter.
const APPROXIMATE_WOLFE: Real = 0.8;
/// Step lengths tried before giving up, each at most half of the one before: down to 2·10⁻¹⁵ at least, since what
/// comes next is a factorisation. (The twelve of `cloth-pd` are enough there: a plain iteration comes next.)
const MAX_TRIALS: u32 = 50;

/// An iterate, with value and gradient.
#[derive(Clone, Debug, Default)]
pub(super) struct Point {
    /// Positions (m).
    pub(super) positions: Vec<Vec3>,
    /// `∂G/∂x` (N).
    pub(super) gradient: Vec<Vec3>,
    /// `G` (J).
    pub(super) value: Real,
}

impl Point {
    pub(super) fn new(vertex_count: usize) -> Self {
        Self {
            positions: vec![Vec3::zeros(); vertex_count],
            gradient: vec![Vec3::zeros(); vertex_count],
            value: 0.0,
        }
    }

    /// Evaluates `G` and its gradient at the positions.
    pub(super) fn evaluate(&mut self, stage: &Stage<'_>) {
        self.value = stage.gradient_into(&self.positions, &mut self.gradient);
    }
}

/// Moves `to` to `from + α direction`, `slope` (J) being that along the direction, with `α = most` or the first smaller
/// one that is accepted, and evaluates it there.
///
/// With `φ(α) = G(from + α direction)` and `φ'(0) < 0`, `φ(α) = φ(0) + α φ'(0) + O(α²)` is below
/// `φ(0) + c α φ'(0)`, c < 1, for all small α: Armijo's condition passes after some halvings. With q the curvature
/// along the direction, a quadratic passes up to `α = 2 (1 − c) |φ'(0)|/q`; a Newton direction of it has its minimum
/// `|φ'(0)|/q` at 1, so c < ½ lets the full step through.
///
/// Armijo's condition compares two values of `G`. Near the minimum they agree in all digits that are free of rounding,
/// long before the gradient is as small as it can be. There the condition is put in terms of slopes, as Hager and Zhang
/// do (SIAM J. Optim. 16, 2005, <https://doi.org/10.1137/030601880>): for a quadratic and the same c, the slope
/// `φ'(α) ≤ (1 − 2c) |φ'(0)|` says the same as `φ(α) ≤ φ(0) + c α φ'(0)`, as `φ(α) − φ(0) = ½ α (φ'(0) + φ'(α))`,
/// without cancellation. Here c is 0.1 in the first and 10⁻⁴ in the second.
pub(super) fn search(
    stage: &Stage<'_>,
    from: &Point,
    direction: &[Vec3],
    slope: Real,
    most: Real,
    to: &mut Point,
) -> Found {
    backtrack(slope, most, MAX_TRIALS, |length| {
        place(from, direction, length, to);
        to.evaluate(stage);
        let rise = to.value - from.value;
        let enough = rise <= ARMIJO * length * slope;
        let rounding = ROUNDING * from.value.abs();
        let is_told_apart = rise.is_nan()
            || (rise > rounding && rise > rounding + stage.value_rounding(&from.positions));
        let is_flatter = || dot(&to.gradient, direction) <= APPROXIMATE_WOLFE * slope.abs();
        let accepted = enough || (!is_told_apart && is_flatter());
        Trial { rise, accepted }
    })
}

/// Moves `to` to `from + length · direction`.
pub(super) fn place(from: &Point, direction: &[Vec3], length: Real, to: &mut Point) {
    for ((to, from), p) in to.positions.iter_mut().zip(&from.positions).zip(direction) {
        *to = from + p * length;
    }
}

/// Moves `to` along a direction of negative `curvature` (N/m) from a stationary point, and evaluates it there: the
/// first length, halved each time, at which `G` has fallen by half of what the parabola of that curvature,
/// `½ curvature t²`, promises. Returns whether there is one.
pub(super) fn leave_saddle(
    stage: &Stage<'_>,
    from: &Point,
    direction: &[Vec3],
    curvature: Real,
    to: &mut Point,
) -> bool {
    // Any length will do that is neither lost in rounding nor beyond the valley that the direction leads to: from the
    // largest coordinate down.
    let size = |v: &[Vec3]| v.iter().map(Vec3::amax).fold(0.0, Real::max);
    let mut length = size(&from.positions) / size(direction);
    for _ in 0..MAX_TRIALS {
        place(from, direction, length, to);
        to.evaluate(stage);
        if to.value - from.value < 0.25 * curvature * length * length {
            return true;
        }
        length *= 0.5;
    }
    false
}

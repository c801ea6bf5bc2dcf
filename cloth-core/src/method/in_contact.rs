//! What the minimisations of a step with contact have in common: where they begin, when they take the Hessian anew, and
//! how far they follow a direction.

use crate::math::Real;

/// Fraction of the last change of velocity that an extrapolated start expects once more: all of it overshoots where
/// wrinkles oscillate.
pub const EXPECTED_CHANGE: Real = 0.5;

/// Iterations at the start of a step that take the Hessian anew each, while contacts come; and those after which it is
/// taken anew from then on.
pub const FIRST_ITERATIONS: u32 = 4;
/// See [`FIRST_ITERATIONS`].
pub const REFRESH_INTERVAL: u32 = 8;

/// Fraction of a direction below which a step counts as shortened, and the number of such steps after which directions
/// are those of a truncated Newton method.
pub const SHORTENED_BELOW: Real = 0.25;
/// See [`SHORTENED_BELOW`].
pub const MAX_SHORTENED_STEPS: u32 = 5;

/// End of the conjugate gradients for such a direction: their residual, in the norm of the cycle and relative to the
/// first, and the most iterations.
pub const NEWTON_DIRECTION: (Real, u32) = (0.1, 30);

/// Fraction of a direction that is free of intersections, below which one length for all vertices is given up for one
/// each.
pub const VERTEX_BY_VERTEX_BELOW: Real = 0.01;
/// Fraction below which only half of what is free is followed. Where a path turns into a pair, the gap falls with the
/// square of the length: the whole of what is free leaves a fifth of the gap, and the next step is as short; half of it
/// leaves 1 − ¼ · ⅘ = ⅘.
pub const HALVED_BELOW: Real = 0.1;

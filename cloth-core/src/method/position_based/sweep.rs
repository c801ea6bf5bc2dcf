//! The order in which a sweep visits the elements, and the acceleration of a sequence of sweeps.

use super::{Chebyshev, Radius};
use crate::error::OutOfRange;
use crate::math::Real;
use crate::step::BuildError;

/// The order of a sweep.
///
/// The iterates depend on it. Where rows are linear, or none of them turns, sweeps of all kinds converge to the same
/// end; where rows turn each kind ends at a place of its own, since every correction keeps the gradients of its visit.
/// In the straight chain of N equal rigid links, held at one end, one sweep leaves the factor given of the slowest part
/// of the error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sweep {
    /// Gauss–Seidel in the order given, on one thread: an element sees what the one before it moved. Chain:
    /// `cos²(π/2N)`.
    ///
    /// With [`Chebyshev`], Gauss–Seidel sweeps of both kinds are symmetric, forward and backward, at twice the work.
    Sequential,
    /// Gauss–Seidel colour by colour, on rayon's threads where a colour is large enough and the feature
    /// `parallel` is on. The bits do not depend on the number of threads. Chain: `cos²(π/2N)`.
    #[default]
    Colored,
    /// Jacobi with averaging: all elements are solved at the same positions, and each makes the fraction `1/n`
    /// of its correction, with n the largest number of elements that meet in one of its vertices (prescribed
    /// ones not counted). Chain: `cos²(π/4N)`.
    ///
    /// The common variant divides by the number of elements vertex by vertex instead. Then the two ends of a
    /// spring move by different fractions: momentum is not kept, and the multiplier does not match the motion.
    /// With one fraction per element `Σ m x` is kept, XPBD's λ and x go together, and linear rows converge from
    /// anywhere: the sweep is `1 − Σ sⱼPⱼ` with projectors P (in the metric of M) and `Σ sⱼ ≤ 1` at every
    /// vertex.
    Jacobi,
    /// Jacobi without averaging: all corrections are made in full, at once. Chain: `cos(π/2N)`.
    ///
    /// It diverges where more than two stiff elements meet, hence in every cloth, unless the relaxation is
    /// below 2 over that number.
    PlainJacobi,
}

/// Relaxation and extrapolation of a sequence of sweeps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Acceleration {
    /// The relaxation factor ω (dimensionless) of every correction, above 0 and below 2. Below 1 is
    /// under-relaxation; above 1, with a Gauss–Seidel sweep, it is SOR, whose best ω for the straight chain is
    /// `2/(1 + sin(π/2N))`, with the factor `ω − 1` per sweep.
    pub relaxation: Real,
    /// Extrapolation over the sweeps of a substep; none by default.
    pub chebyshev: Option<Chebyshev>,
}

impl Default for Acceleration {
    /// Corrections made in full, no extrapolation.
    fn default() -> Self {
        Self {
            relaxation: 1.0,
            chebyshev: None,
        }
    }
}

impl Acceleration {
    /// Whether the numbers are in their ranges.
    ///
    /// # Errors
    /// [`BuildError::OutOfRange`].
    pub fn check(&self) -> Result<(), BuildError> {
        let refuse = |name, value, range| Err(OutOfRange { name, value, range }.into());
        if !(self.relaxation > 0.0 && self.relaxation < 2.0) {
            let range = "above 0 and below 2";
            return refuse("the relaxation", self.relaxation, range);
        }
        match self.chebyshev {
            Some(Chebyshev {
                radius: Radius::Given(radius),
                ..
            }) if !(0.0..1.0).contains(&radius) => {
                refuse("the spectral radius", radius, "at least 0 and below 1")
            }
            Some(Chebyshev { radius, delay }) => {
                let (least, range) = match radius {
                    Radius::Given(_) => (1, "at least 1"),
                    Radius::Estimated => (2, "at least 2 where the radius is estimated"),
                };
                if delay >= least {
                    return Ok(());
                }
                refuse("the delay of the acceleration", Real::from(delay), range)
            }
            None => Ok(()),
        }
    }
}

//! Settings of the solver: iterations, start, acceleration.

use cloth_core::error::{at_least_one, not_negative, within};
use cloth_core::math::Real;
use cloth_core::method::limited_memory::MOST_PAIRS;
use cloth_core::step::BuildError;

/// Settings of [`PdSolver`](crate::PdSolver).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PdConfig {
    /// `Some(k)`: k iterations in every step (at least 1). With a `tolerance` it may be fewer, and in contact, where
    /// forces balance (below) or no lower point is found.
    ///
    /// `None`: as many as the `tolerance` takes, else as many as [`velocity_tolerance`](Self::velocity_tolerance)
    /// takes. Plain and Chebyshev iterations have no estimate for the second: without a `tolerance` they are ten where
    /// nothing touches.
    ///
    /// A quasi-Newton step from [`StartGuess::Extrapolated`] or `Inertial` that ends above `G(x[0])` is taken again from `x[0]`, with as
    /// many iterations once more.
    pub iterations: Option<u32>,
    /// Most iterations of a step with `iterations: None`; at least 1. In quasi-Newton steps where nothing touches the
    /// second half of them has the directions of a truncated Newton method.
    pub most_iterations: u32,
    /// A step with `iterations: None` and without a `tolerance` ends, as
    /// [`Converged`](cloth_core::step::Outcome::Converged), once `√(∇Gᵀ B ∇G) ≤ ε ‖x − x̃‖_M/Δt`, B the inverse Hessian
    /// that the method has: the Newton decrement, as a speed, over the change of velocity by elastic and contact forces
    /// (x̃ has gravity, the load, and the air at the start of the step). As one iteration can make it small, the last
    /// five must have lowered `G` by no more than `5 (ε ‖x − x̃‖_M/Δt)²` besides, so there are at least six. With τ
    /// this number (dimensionless, at least 0):
    ///
    /// | moving pins, pushed bodies, forces in contact | active contacts | ε | iterations, at least |
    /// |---|---|---|---|
    /// | no | no | τ/2 | 10 |
    /// | no | yes | 0.3 τ, in the first 15 a tenth of it | 6 |
    /// | yes | no | 0.3 τ | 20 |
    /// | yes | yes | 0.3 τ, in the first 15 a tenth of it | 6 |
    ///
    /// With active contacts forces have to be near balance, too: `‖∇G(x)‖ ≤ ‖M (x − x̃)/Δt²‖` in the norm of M⁻¹. Where
    /// pairs are much too near, directions that only take them apart have small decrements: a sheet stretched over two
    /// poles then ended with a tenth to a third of the friction missing, for good.
    ///
    /// All of these are asked of each piece that elements couple (of `G` of all together): a light piece beside a heavy
    /// one hardly counts in a norm over both, and would end wherever it is.
    ///
    /// A method without pairs (`history: 0`, plain, Chebyshev) makes at least 30 iterations in contact, and its ε is
    /// 0.3 τ from the first on. Without contact ε is smaller where pins move because strain that a step leaves where a
    /// pin has pulled adds up over the steps.
    ///
    /// *Why the decrement.* Near the minimum `x*` the gradient is `H (x − x*)`, H the Hessian of `G`. With B = H⁻¹ the
    /// decrement is then `√((x − x*)ᵀ H (x − x*))`. Where H is at least M/Δt² this is `‖x − x*‖_M/Δt` at least, the
    /// error of the velocities; and half of its square is `G(x) − G(x*)`.
    ///
    /// This is an estimate, weaker than a bound on the gradient, and the error is larger than τ: A is too stiff where
    /// cloth bends, so B, and the decrement, come out too small. `Converged` says that the estimate is below ε, and no
    /// more. In a step of a falling sheet of 16 × 16 vertices the change of velocity was off by 2 to 7 τ with a coarse
    /// grid, by 5 to 25 τ without, from τ = 0.1 to 10⁻⁴ (`cloth-massspring`: by 3 τ at most on its sheet).
    ///
    /// With active contacts a step ends, too, once forces balance: `‖∇G(x)‖ ≤ 10⁻⁴ τ ‖M (x − x̃)/Δt²‖` in the norm of
    /// M⁻¹ (10⁻⁸ in the place of 10⁻⁴ τ with `Some(k)` iterations). Where the Hessian of `G` is at least M/Δt², so
    /// without compressed elements, that bounds the error of the change of velocity by 10⁻⁴ τ of it. 0 asks for all
    /// `most_iterations`.
    pub velocity_tolerance: Real,
    /// With `Some(τ)` the iteration ends as soon as `‖∇G(x)‖ ≤ τ max(‖∇G(x̃)‖, ‖∇C(x)‖)` in the norm of M⁻¹ (τ
    /// dimensionless; C is the potential of contact, if there is any), and the report has that ratio as its residual.
    /// `None`: nothing is computed for it. For reference solutions, not for speed: τ = 10⁻⁶ takes 776 iterations at 60
    /// vertices a side and 10⁴ N/m, with a coarse grid of 10 cells (`tests/chapter/minimum.rs`). Raise
    /// `most_iterations` with it: the step ends there if τ is not met.
    ///
    /// *What it guarantees.* Let g be ∇G(x), and the Hessian of `G` at least M/Δt² between x and the minimum `x*` (no
    /// compressed elements). Then `‖x − x*‖²_M/Δt² ≤ gᵀ(x − x*) ≤ ‖g‖ ‖x − x*‖_M` with the norm of M⁻¹ for g
    /// (Cauchy–Schwarz). So the velocities are off by `‖x − x*‖_M/Δt ≤ Δt ‖g‖`, and `G(x) − G(x*) ≤ ½ Δt² ‖g‖²`.
    /// Without contact ‖g‖ is at most τ ‖∇E(x̃)‖, as inertia is in balance at x̃. What stiff springs pull with there is
    /// much more than what is left of it at `x*`, so the relative error of the change of velocity may be much larger
    /// than τ. Where elements are compressed the bound does not hold, and x may be near a saddle point.
    pub tolerance: Option<Real>,
    /// Where the iteration starts.
    pub start: StartGuess,
    /// What is made of a local–global iteration.
    pub acceleration: Acceleration,
}

/// Where the iteration starts. A prescribed vertex is where it will be at the end of the step, in any case.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum StartGuess {
    /// `x[0]`, the positions before the step.
    Previous,
    /// `x[0] + Δt v[0]`: the motion goes on as it was. What gravity adds in a step is mostly taken back by a cloth that
    /// is held, so this is nearer to the end of the step than x̃. Where few iterations end above `G(x[0])` the step may
    /// have gained energy, on which a tangle feeds (or not: an elastic bounce, from v to −v, ends above it too).
    /// [`Acceleration::QuasiNewton`] then takes the step again, from `x[0]`. A component of the cloth that nothing
    /// holds is shifted as a whole besides, so that its momentum is right from the start.
    Inertial,
    /// In a step with contact that continues another one of the same size with contact,
    /// `x[0] + Δt (v[0] + ½ (v[0] − v[−1]))`: half of what the last step changed once more, which turns the velocity
    /// along with the cloth, so that the step begins in the folds that the last one has made. In every other step
    /// `Inertial`, and with what is said there.
    #[default]
    Extrapolated,
    /// `x̃`: where the vertices would go without elasticity.
    Predicted,
}

/// How iterates are combined.
///
/// Which to take: [`QuasiNewton`](Self::QuasiNewton), the default, with a
/// [coarse grid](crate::PdBuilder::coarse_grid) of 12 cells, which the builder does not lay by itself. Without one
/// where the cloth is crumpled at the scale of the cells, which its hat functions cannot follow
/// ([limits](crate#limits)). [`Chebyshev`](Self::Chebyshev) needs about as many iterations as quasi-Newton without a
/// grid ([table](crate#iterations)), but ρ has to be known, the bending stays in the factor, and contact excludes it.
/// [`None`](Self::None) is for comparison and for soft cloth: no search, no pairs, and `G` falls by proof.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Acceleration {
    /// Local and global step alternate as printed. `G` falls in every iteration by proof, without a line search. With
    /// contact, every displacement is bounded and `G` evaluated: these are quasi-Newton iterations without pairs.
    None,
    /// The Chebyshev semi-iterative method (Wang 2015) over the plain iteration: each iterate is extrapolated from the
    /// one before the last. Where `G` would rise, the plain iterate is taken and the method begins anew.
    /// Extrapolated iterates cannot be bounded by contact: a step with contact is one of plain iterations, and counts
    /// among [`chebyshev_fallbacks`](cloth_core::step::StepReport::chebyshev_fallbacks).
    Chebyshev {
        /// Largest factor ρ (dimensionless, at least 0, below 1) by which the plain iteration keeps an error that
        /// counts: less than its spectral radius, where the slowest waves hold little error. `None`: read off the plain
        /// iterations that every step then starts with. That is too small, as the first iterations contract fast; for
        /// stiff cloth give more, as the 0.9995 of the [table](crate#iterations).
        spectral_radius: Option<Real>,
    },
    /// Quasi-Newton (Liu, Bouaziz, Kavan 2017): L-BFGS with the inverse of the constant matrix (without the bending of
    /// thin cloth, which would be most of the factor; and with the coarse grid, if the solver was given one) as the
    /// initial inverse Hessian, and a line search on `G`.
    QuasiNewton {
        /// Pairs of differences that are remembered (m in the paper), 2 by default, at most 32. With 0 each direction
        /// is that of one global solve, with active contacts of up to ten. Else a step that is given contacts remembers
        /// at least ten.
        history: u32,
    },
}

impl Default for PdConfig {
    fn default() -> Self {
        Self {
            iterations: None,
            most_iterations: 300,
            velocity_tolerance: 0.1,
            tolerance: None,
            start: StartGuess::Extrapolated,
            acceleration: Acceleration::QuasiNewton { history: 2 },
        }
    }
}

impl PdConfig {
    /// The method as it was first published: local and global steps alternately, from x̃, ten times.
    #[must_use]
    pub fn plain() -> Self {
        Self {
            iterations: Some(10),
            most_iterations: 300,
            velocity_tolerance: 0.1,
            tolerance: None,
            start: StartGuess::Predicted,
            acceleration: Acceleration::None,
        }
    }

    /// Whether every setting lies in its range.
    pub(crate) fn check(&self) -> Result<(), BuildError> {
        if let Some(iterations) = self.iterations {
            at_least_one("iterations", iterations)?;
        }
        at_least_one("most_iterations", self.most_iterations)?;
        not_negative("velocity_tolerance", self.velocity_tolerance)?;
        if let Some(tolerance) = self.tolerance {
            not_negative("tolerance", tolerance)?;
        }
        match self.acceleration {
            Acceleration::Chebyshev {
                spectral_radius: Some(radius),
            } => {
                let is_right = (0.0..1.0).contains(&radius);
                within(
                    is_right,
                    "spectral_radius",
                    radius,
                    "at least 0 and below 1",
                )?;
            }
            Acceleration::QuasiNewton { history } => {
                let is_right = history as usize <= MOST_PAIRS;
                within(is_right, "history", Real::from(history), "at most 32")?;
            }
            _ => {}
        }
        Ok(())
    }
}

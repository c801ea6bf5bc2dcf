//! Settings of the integrators.

use crate::damping::Damping;
use cloth_core::element::Convexity;
use cloth_core::error::{at_least_one, not_negative};
use cloth_core::math::Real;
use cloth_core::method::linear::{LinearMethod, StoppingCriteria};
use cloth_core::step::BuildError;

/// Settings of [`crate::ExplicitEuler`] and [`crate::SymplecticEuler`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExplicitConfig {
    /// Number of equal substeps in a step; one evaluation of the forces each. A step of Δt needs at least Δt over
    /// [`stable_time_step`](crate::stable_time_step), rounded up.
    pub substeps: u32,
    /// What to do about steps that are too large.
    pub stability: StabilityCheck,
    /// Forces against the motion; none unless set.
    pub damping: Damping,
}

/// What an explicit integrator does about steps that are too large.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum StabilityCheck {
    /// Estimate the largest stable step, refuse larger ones, and end a run that gains energy from nowhere. (What an
    /// element of negative stiffness gives does not come from nowhere: its energy falls without end.)
    #[default]
    Watch,
    /// Nothing, for studying what happens; only a result that is not finite is an error.
    Off,
}

impl Default for ExplicitConfig {
    fn default() -> Self {
        Self {
            substeps: 1,
            stability: StabilityCheck::Watch,
            damping: Damping::default(),
        }
    }
}

impl ExplicitConfig {
    /// Whether every setting lies in its range.
    pub(crate) fn check(&self) -> Result<(), BuildError> {
        at_least_one("substeps", self.substeps)?;
        self.damping.check()
    }
}

/// Settings of [`crate::ImplicitEuler`], [`crate::ImplicitMidpoint`] and [`crate::Bdf2`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImplicitConfig {
    /// Most iterations in a step. Spending them all is no error; the report says so.
    pub max_iterations: u32,
    /// 10⁻³, the default, means: the change of velocity that the forces make in the step is right to a thousandth of
    /// itself (dimensionless). The iteration ends when the Newton decrement is small enough,
    /// `√(∇Gᵀ B⁻¹ ∇G) ≤ tolerance · ‖x − x̂‖_M/s`, or when rounding allows no more; 0 asks for as much as rounding
    /// allows. B is the matrix of the method, M/s² + H or near it. The step is then
    /// [`Converged`](cloth_core::step::Outcome::Converged). For a quadratic with the Hessian B the decrement *is* the
    /// error in the norm of B, and so bounds that in M/s² from above; elsewhere it is an estimate (Boyd and
    /// Vandenberghe, *Convex Optimization*, 2004, section 9.5.1); `G` is then above its minimum by no more than
    /// `tolerance²` of the kinetic energy of that change. The quasi-Newton method has a B that is too stiff where
    /// elements are compressed, so that its true error can be above the estimate; on the hanging sheet it is below
    /// three times the tolerance from 10⁻² to 10⁻⁶ (`the_change_of_velocity_is_right_to_the_tolerance`).
    ///
    /// A test by a norm of `∇G` itself would be worse in two respects. It would weigh stiff directions by their
    /// stiffness. And it needs something to be compared with: `‖∇G(x̂)‖`, at the end of free flight, is too large for
    /// that, as free flight stretches stiff cloth far. From rest it goes Δt² g, 0.1 m in 0.1 s; a spring of 10⁶ N/m
    /// that hangs from a pin is then stretched by 0.1 m and pulls with 10⁵ N. A thousandth of that, 100 N, is 50 times
    /// the weight of a sheet of 1 m² and 0.2 kg/m², so a place where nothing is in balance yet would pass.
    ///
    /// Where the iteration has released much energy, as of cloth crushed to a point, little may be left of the change
    /// of velocity in the end. So the decrement is compared with `10⁻³ √(2 (G_start − G))` if that is more. Where
    /// something touches, a step ends at 0.3 of the tolerance.
    ///
    /// Where seconds of motion have to look right, 10⁻² is enough and takes half of the iterations: after five seconds
    /// of the hanging sheet of 64 × 64 vertices (10⁴ N/m, 1/60 s) the kinetic energy, as a mean over the last hundred
    /// steps, is 0.2 % from that with 10⁻³; of 33 × 33 in steps of 1/120 s it is 5 % off at their end. 10⁻¹ takes as
    /// many iterations as 10⁻³ and loses 24 %: what a step leaves undone is in the way of the next.
    ///
    /// Where nothing touches, every piece that elements couple has to be so near by itself, with no less than 10⁻⁴ of
    /// the change of velocity of all to compare with: a light piece beside a heavy one hardly counts in a norm over
    /// both.
    pub tolerance: Real,
    /// Which second derivative Newton's method uses.
    pub hessian: HessianPolicy,
    /// How the linear systems of Newton's method are solved, with a block of 3 × 3 numbers for each pair of neighbours;
    /// every choice leads to the same minimum. An iterative solver needs no factor, which is the larger part of time
    /// and memory on large sheets; its tolerance is the fraction of the gradient that a Newton step leaves behind (a
    /// constant forcing term), so convergence ends linear, by that factor.
    ///
    /// The default is `LinearMethod::default()`: Cholesky with the feature `cholesky`, without it multigrid with
    /// `StoppingCriteria::default()`. Those are a residual `‖b − A x‖/‖b‖` of 10⁻³ (dimensionless), or 1000 iterations;
    /// any iterative solver takes criteria of your own, as `LinearMethod::ConjugateGradients(criteria)`. After the last
    /// iteration the direction so far is taken. [`ImplicitConfig::linearized`] takes multigrid to 10⁻⁸. The
    /// quasi-Newton method solves no such system: this setting matters to it where Newton's method takes over.
    ///
    /// | solver | cost of an iteration | factor per iteration, κ the condition number of `D⁻¹A` |
    /// |---|---|---|
    /// | Cholesky | refactor and solve, done | |
    /// | multigrid (preconditioned conjugate gradients) | a product and a V-cycle | hardly depends on κ |
    /// | conjugate gradients | a product and two passes over the vectors | `(√κ − 1)/(√κ + 1)` or better |
    /// | Chebyshev–Jacobi | a product and one pass | `(√κ − 1)/(√κ + 1)` |
    /// | Gauss–Seidel | that of a product | `((κ − 1)/(κ + 1))²` for two colours: a chain, a grid without diagonals |
    /// | Jacobi | a product and one pass | `(κ − 1)/(κ + 1)` with the best damping, which is estimated |
    ///
    /// Here A = M/s² + H (s the time of the stage, Δt in implicit Euler without drag), D its diagonal blocks, the
    /// preconditioner of conjugate gradients. κ is of the order of `1 + (s ω_max)²`, the condition of `I + s² M⁻¹H`: it
    /// grows with stiffness, s² and resolution: 4·10⁴, 2·10⁵ and 10⁶ for the hanging sheet of 10⁴ N/m with 32, 64 and
    /// 128 vertices a side at Δt = 1/60 s, where conjugate gradients take 295, 589 and 1385 iterations to a residual of
    /// 10⁻³ and the factorisation is faster at every size up to 256 a side. (`cloth-bench study newton` measures all of
    /// it.) Where κ is smaller the order is reversed; [`ImplicitConfig::linearized`] has times.
    ///
    /// With V vertices on the same sheet ω_max² grows like 1/l², that is like V, as long as the membrane decides
    /// (`stability.rs`), and so does κ at a given Δt. To a given residual conjugate gradients and Chebyshev–Jacobi take
    /// iterations like √κ, Gauss–Seidel and Jacobi like κ, each of V operations: `V^1.5` and `V²` together. Multigrid
    /// takes about V. The factorisation of a sheet takes `V^1.5` operations and a factor of `V log V` numbers by nested
    /// dissection (A. George, SIAM J. Numer. Anal. 10, 1973, <https://doi.org/10.1137/0710032>), and no ordering is
    /// better than that by more than a constant. So Cholesky and conjugate gradients grow alike; what differs is the
    /// factor in front, which for conjugate gradients grows with Δt and √k.
    ///
    /// Only the factorisation *proves* that the matrix is positive definite; conjugate gradients notice negative
    /// curvature that they meet, the others diverge on it. In each case the matrix then gets a smaller part of the
    /// exact Hessian (`implicit/system.rs`).
    pub linear: LinearMethod,
    /// Where the minimisation starts.
    pub start: StartGuess,
    /// Which points with a small gradient are good enough.
    pub accept: Accept,
    /// How much of the minimisation is done.
    pub solve: Solve,
    /// Forces against the motion; none unless set.
    pub damping: Damping,
}

/// How much of the minimisation an implicit step does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Solve {
    /// A quasi-Newton method to the tolerance: limited-memory BFGS around a multigrid cycle on a positive definite
    /// Hessian. It factorises nothing; its iterations are many times cheaper than those of Newton's method, which takes
    /// over where they do not get to the end ([`newton_fallbacks`](cloth_core::step::StepReport::newton_fallbacks)),
    /// and where [`Accept::Minimum`] asks for a minimum.
    #[default]
    QuasiNewton,
    /// Newton's method with line search, to the tolerance.
    Newton,
    /// One Newton step of full length from the start guess: the forces linearised there, and one linear system.
    /// Neither the tolerance nor the most iterations nor [`Accept`] matter, and no residual is computed, unless
    /// something is touched: contact is not linearised, and takes iterations to the tolerance; the cloth is linearised
    /// again where that ends if `G` has not decreased as predicted.
    ///
    /// The cheapest implicit step there is. It integrates linear forces like the full solution. Otherwise its error is
    /// of the order of the integrator's own; midpoint and BDF2 keep their second order where the Hessian is exact or no
    /// spring is compressed, and are of first order elsewhere. Nothing guarantees that the energy goes down: a step
    /// that turns a stiff spring by a large angle stretches it, and the next one starts from there.
    Linearized,
}

/// Which second derivative of the elastic energy Newton's method uses. Nothing but this is changed to make the matrix
/// positive definite: no multiple of M is added to `M/s² + H`.
///
/// Quadratic and linear convergence in one step of the hanging sheet of 12 × 12 vertices: `‖∇G‖/‖∇G(x̃)‖` after each
/// iteration (`dropping_the_indefinite_part_costs_the_quadratic_convergence` in `tests/chapter/newton.rs` prints it).
///
/// | `ExactFirst` | 5·10⁻³ | 5·10⁻³ | 2·10⁻⁵ | 2·10⁻⁷ | 2·10⁻¹² |
/// |---|---|---|---|---|---|
/// | `Always(Clamp)` | 5·10⁻³ | 5·10⁻³ | 5·10⁻⁵ | 1·10⁻⁵ | 5·10⁻⁶, and half of it in each of 20 more |
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum HessianPolicy {
    /// The exact one wherever it makes the matrix positive definite; elsewhere as much of it as possible, blended
    /// with that of [`Convexity::Clamp`]. Robust far from the minimum, quadratic convergence near it.
    #[default]
    ExactFirst,
    /// Always the same. With [`Convexity::Exact`] a step can fail with
    /// [`NotPositiveDefinite`](cloth_core::step::StepError::NotPositiveDefinite); with the others convergence is
    /// linear where springs are compressed.
    Always(Convexity),
}

/// Which points with a small gradient are good enough.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Accept {
    /// All of them, a saddle point too: a solution of ∇G = 0, which is all that implicit Euler asks for. Exactly flat
    /// cloth under forces in its plane then never buckles, other compressed cloth some steps later than it might.
    #[default]
    Stationary,
    /// Minima only, by a factorisation: the exact Hessian of G was positive definite at the point, or at the iterate
    /// before it. (The second is taken as enough, and is no proof: near convergence the last step is too small to leave
    /// the valley of a minimum.) Costs at most one factorisation more where the point is a minimum. A saddle point is
    /// left along a direction of negative curvature; which side the cloth then falls to is decided by a fixed
    /// pseudo-random vector. Needs a linear solver that proves definiteness: `LinearMethod::Cholesky` (feature
    /// `cholesky`).
    Minimum,
}

/// Where the minimisation starts. A prescribed vertex is where it will be at the end of the step, in any case.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum StartGuess {
    /// `x[0]`, the positions before the step.
    Previous,
    /// `x[0] + Δt v[0]`: uniform motion, without gravity and load.
    Inertial,
    /// `x[0] + Δt (v[0] + ½ (v[0] − v[−1]))`: half of what the last step changed once more, which turns the velocity
    /// along with the cloth. The same as `Inertial` in a step that does not continue another of the same size; for the
    /// midpoint rule, whose velocities may ring; and for BDF2 without contact, where `x_b + τ v_b` in the place of `x[0] + Δt v[0]`
    /// goes on with about 2/9 of that change already: with half of it beside that, a sheet that swings and crumples
    /// takes 1.6 times the iterations.
    #[default]
    Extrapolated,
    /// `x̃ = x[0] + Δt v[0] + Δt² a`, the inertial prediction, with gravity and load.
    Predicted,
}

impl Default for ImplicitConfig {
    fn default() -> Self {
        Self {
            max_iterations: 4000,
            tolerance: 1e-3,
            hessian: HessianPolicy::ExactFirst,
            linear: LinearMethod::default(),
            start: StartGuess::Extrapolated,
            accept: Accept::Stationary,
            solve: Solve::QuasiNewton,
            damping: Damping::default(),
        }
    }
}

impl ImplicitConfig {
    /// Settings for one linear solve from `x[0]`, as D. Baraff and A. Witkin take it (SIGGRAPH 1998,
    /// <https://doi.org/10.1145/280814.280821>); the indefinite part of compressed springs is dropped (compare Choi and
    /// Ko 2002), and the system is solved by conjugate gradients around multigrid to 10⁻⁸ (theirs: modified conjugate
    /// gradients, section 5, which filter the constrained directions of each vertex out of residuals and search
    /// directions. Here a pin constrains all three, so its rows and columns leave the matrix).
    ///
    /// Their elements are other ones. A triangle of rest area a has the conditions `a (‖w_u‖ − 1)`, `a (‖w_v‖ − 1)` and
    /// `a w_u·w_v` (sections 4.2 and 4.3) and the energy `½ k C²` of each. With the strain ε of the sheet, small, and
    /// k_s for the third that is `½ a² (k ε₁₁² + k ε₂₂² + 4 k_s ε₁₂²)`: per area a sheet of the modulus `Y = a k` along
    /// u and v with ν = 0, and of the shear modulus `a k_s`. So their k has to grow like 1/a as the mesh is refined.
    /// Here moduli are given, and the elements follow ([`cloth_core::cloth`]). Their damping is that of [`Damping`].
    /// They shorten a step that stretches the cloth too far; no method here does.
    ///
    /// To 10⁻⁸ the step follows that by Cholesky to a micrometre in 20 steps (to 10⁻³: 6 mm), and shifts components
    /// that nothing holds to the momentum of the exact solution. At 128 vertices a side it takes a third of the time of
    /// Cholesky, to 10⁻³ an eighth. Conjugate gradients without multigrid win against Cholesky only where the matrix is
    /// well-conditioned: soft cloth, or steps of a millisecond.
    #[must_use]
    pub fn linearized() -> Self {
        Self {
            solve: Solve::Linearized,
            start: StartGuess::Previous,
            hessian: HessianPolicy::Always(Convexity::Clamp),
            linear: LinearMethod::Multigrid(StoppingCriteria {
                tolerance: 1e-8,
                ..StoppingCriteria::default()
            }),
            ..Self::default()
        }
    }

    /// Settings for a reference solution in studies: a minimum, not a saddle point, to the last digit that rounding
    /// allows or 1e-12, whichever comes first. They need the feature `cholesky`; without it `build` refuses them.
    #[must_use]
    pub fn reference() -> Self {
        Self {
            max_iterations: 1000,
            solve: Solve::Newton,
            tolerance: 1e-12,
            accept: Accept::Minimum,
            ..Self::default()
        }
    }

    /// Whether every setting lies in its range.
    pub(crate) fn check(&self) -> Result<(), BuildError> {
        not_negative("tolerance", self.tolerance)?;
        at_least_one("max_iterations", self.max_iterations)?;
        self.linear.check()?;
        if self.solve != Solve::Linearized
            && self.accept == Accept::Minimum
            && !self.linear.proves_definiteness()
        {
            return Err(BuildError::SettingsConflict {
                one: "accept = Minimum",
                needs: "a linear solver that proves definiteness, Cholesky",
            });
        }
        self.damping.check()
    }
}

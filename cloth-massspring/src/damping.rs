//! Damping: a drag in proportion to mass and velocity, and a resistance to deformation that grows with the stiffness.

use cloth_core::error::not_negative;
use cloth_core::math::Real;
use cloth_core::step::BuildError;

/// Forces against the motion, `f = −α M v − β K v` (Rayleigh damping). An oscillation ω loses energy at the rate
/// `2γ = α + β ω²`: α takes from slow motions as much as from fast ones, β from fast ones most.
///
/// `K` is the material part of the stiffness, `Σ k ∂C ∂Cᵀ`
/// ([`GaussNewton`](cloth_core::element::Convexity::GaussNewton)): it resists the *rate of strain*. What a tense spring
/// feels across its axis is not in it, so that a cloth of springs that turns like a rigid body is not damped
/// (`stiffness_damping_leaves_rigid_motion_alone`). That holds for every C that a rotation leaves alone. `C = q x` of
/// a quadratic hinge turns with the cloth, as a spring of rest length 0 does: of these K is the whole stiffness, and
/// where the cloth is bent it resists turning, too.
///
/// The force is a sum of multiples of `∂C`: no net force on an element, and no net moment, where a rotation leaves C
/// alone, about the positions that K is taken at. In explicit steps these are `x[0]`. In implicit ones they are
/// half-way of uniform motion, or at its end where BDF2 and the midpoint rule need that for their order and the step
/// resolves the motion: a turn that goes on as it was is not damped then. Nor is it half-way by implicit Euler. By the
/// other two it is, as their velocity is not that of the way from where the stage begins: with β = 0.01 s and steps of
/// 1/60 s a turn by 0.02 rad a step loses nothing to damping, one by 0.05 rad 7 % of its angular momentum in a second of
/// BDF2, one by 0.1 rad half of it, and 38 % by the midpoint rule
/// (`damping_of_second_order_brakes_turns_that_are_not_resolved`). K at the end of those too would give cloth that
/// crumples energy. What turns otherwise, by the angle θ in one step, shows as a strain of up to `θ²/2` in that step,
/// which is damped. Both are errors of large steps.
///
/// Of a spring it is a dashpot of βk (N s/m): the force `−βk (n·(v₀ − v₁)) n` at x₀, and the opposite at x₁. In terms
/// of C it is `−β k ∂C Ċ`, as `Ċ = ∂Cᵀ v`: the damping of Baraff and Witkin (1998, section 4.5) with `k_d = βk`.
///
/// Along a mode `x″ + (α + βω²) x′ + ω² x = 0`: for γ < ω it decays like `e^(−γt)`, and its energy like the square of
/// that. As K is positive semi-definite, the power of the force, `−α vᵀM v − β vᵀK v`, is never above zero.
///
/// From a measurement: a mode ω of damping ratio ζ (1 is critical) has `2ζω = α + βω²`, so without drag `β = 2ζ/ω` at
/// the frequency that matters; slower modes are then damped less, faster ones more.
///
/// Numerical damping looks the same. For `z = Δt ω` well below 1 a step of implicit Euler multiplies an amplitude by
/// `1/√(1 + z²)`, about `1 − ½ z²`, and a damping of β = Δt by `e^(−γ Δt)`, about that too, as `γ = ½ Δt ω²`. So a β
/// below Δt hardly shows beside implicit Euler. Forward Euler has `√(1 + z²)`: a negative β of the same size.
///
/// Zero means none: neither is then computed. How exactly each integrator takes them is said there.
///
/// J. W. Strutt (Lord Rayleigh), *The Theory of Sound*, 1877, § 81.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Damping {
    /// α (1/s): every vertex is held back by `α m v`. A drag of `c` N per m/s and m² of cloth is `α = c/ρ`, with ρ the
    /// areal density (kg/m²). It knows neither wind nor the direction of the surface:
    /// [`StepInput::air`](cloth_core::step::StepInput::air) does, with a resistance D of its own, and both may act.
    pub air_drag: Real,
    /// β (s): every element resists its rate of strain with `β` times its stiffness.
    pub stiffness: Real,
}

impl Damping {
    /// Whether every coefficient lies in its range.
    pub(crate) fn check(&self) -> Result<(), BuildError> {
        not_negative("air_drag", self.air_drag)?;
        not_negative("stiffness damping", self.stiffness)?;
        Ok(())
    }

    /// The largest stable step (s) of symplectic Euler whose damping force is that of the start of the step, from the
    /// one without damping, `2/ω`: the step with `(Δt ω)² + 2 Δt (α + β ω²) = 4`, which is the shorter the larger ω.
    pub(crate) fn stable_step(&self, undamped: Option<Real>) -> Option<Real> {
        if *self == Self::default() {
            return undamped;
        }
        let square = undamped.map_or(0.0, |step| (2.0 / step).powi(2));
        let rate = self.air_drag + self.stiffness * square;
        // The positive root, written so that it neither cancels nor divides by a square that is zero.
        let step = 4.0 / (rate + (rate * rate + 4.0 * square).sqrt());
        step.is_finite().then_some(step)
    }
}

//! BDF2: the derivative at the end of the step from a parabola through three points in time.
//!
//! ```text
//! (3 x[1] − 4 x[0] + x[−1]) / (2Δt) = v[1]
//! (3 v[1] − 4 v[0] + v[−1]) / (2Δt) = M⁻¹ f(x[1]) + g
//! ```
//!
//! The slope at the end of the parabola through `x[−1]`, `x[0]`, `x[1]` is the last difference and half of a second one
//! more: `(x[1] − x[0])/Δt + (x[1] − 2x[0] + x[−1])/(2Δt)`, the first line. It is off by `Δt² x‴/3`, hence the second
//! order. Steps of different sizes would have other weights, which are not offered.
//!
//! Solved for the new values that is a stage of `τ = 2Δt/3` from `x_b = (4x[0] − x[−1])/3`, `v_b = (4v[0] − v[−1])/3`.
//!
//! A velocity that jumps has no derivative. A vertex that arrives at a floor with `v[−1] = −1 m/s` and is stopped,
//! `v[0] = 0`, would begin the next stage with `v_b = 1/3 m/s` and with `x_b` behind the floor: it would bounce, and
//! cloth that snaps taut would gain energy. So the step after one in which
//!
//! ```text
//! ‖v[1] − 2 v[0] + v[−1]‖²_M > 0.1 (‖v[0]‖²_M + ‖Δt a‖²_M),   a the external acceleration,
//! ```
//!
//! is one of implicit Euler, which knows nothing of `v[−1]`. (A step of implicit Euler is not tested: the second
//! difference after it has the jump before it in it, too.) For an oscillation ω the left side is `(4 sin²(Δt ω/2))²`
//! times `‖v[0]‖²_M`: 0.06 times at Δt ω = 0.5, no jump, and above 0.1 from Δt ω = 0.57 on, about 11 steps a period or
//! fewer. Where most of the motion is there, and no external acceleration stands beside it, each step of BDF2 may jump,
//! so that every other one is of implicit Euler, and λ ([`Bdf2`]) is not the damping. The second term on the right
//! keeps small motions of cloth at rest from counting. (A limitation: velocities are those in the frame of the scene.
//! Of cloth that is towed or flies fast only larger jumps count.)
//!
//! The step with the jump is one of BDF2 itself, unless contact pushes at its end. With a floor at 0, `x[0] = s` and
//! `x[−1] = s + v Δt`, it would end at 0 with the velocity `v/2 − 3s/(2Δt)`, between −v and v/2: what falls flat would
//! rebound with up to half of its speed. So it is taken again by implicit Euler, and what falls flat lies there, with
//! the impulse that its fall had. (A limitation: smaller jumps pass, such as that of one corner of a sheet.) Where all
//! forces are linear and nothing touches, no oscillation grows, resolved or not ([why](Bdf2)), and the test is left
//! out.
//!
//! Nor does a parabola fit where a load sets in or ends. That is known before the step: after `v[0] = v[−1] + Δt a` a
//! step without the load would begin with `v_b = v[0] + Δt a/3`, the next with a third of this more, and so on,
//! `Δt a/2` together; where it sets in, as much is lost. So a step whose load differs from the last one by more than
//! half of the larger of the two, in the norm `‖M⁻¹f‖_M`, is one of implicit Euler too: the impulse of the load is then
//! exact to rounding.
//!
//! C. F. Curtiss, J. O. Hirschfelder, "Integration of stiff equations", PNAS 38(3), 1952,
//! <https://doi.org/10.1073/pnas.38.3.235>; for cloth, with one linear solve a step
//! ([`Solve::Linearized`](crate::Solve::Linearized)): K.-J. Choi, H.-S. Ko, 2002,
//! <https://doi.org/10.1145/566570.566624>.

use super::damper::Damper;
use super::{Implicit, ImplicitBuilder, Interval, TimePoint};
use cloth_core::math::{Real, Vec3};
use cloth_core::particles::{Particles, State};
use cloth_core::step::{StepError, StepInput, StepReport, Stepper};

/// Square of the second difference of velocities, over that of the velocities, above which they have jumped.
const JUMP: Real = 0.1;

/// BDF2: second order, stable for any step, and much less damped than [`ImplicitEuler`](crate::ImplicitEuler).
///
/// An oscillation ω changes by `λ = 1/(2 − √(1 + 2iz))` a step, `z = Δt ω`, a root of `(3 − 2iz) λ² − 4 λ + 1 = 0`: for
/// small `z` it shrinks by `z⁴/4`, where implicit Euler takes `z²/2`; for large `z` it goes like `1/√(2z)`, so that
/// stiff modes still die out. The other root, `1/(2 + √(1 + 2iz))`, is near 1/3 for small z, and what it multiplies is
/// gone in a few steps.
///
/// *No oscillation grows:* with `a + ib = √(1 + 2iz)`, a > 0, the real part gives a² − b² = 1, so a ≥ 1. Then
/// `|2 + a + ib| ≥ 3`, and `|2 − a − ib|² = (2 − a)² + a² − 1 = 1 + 2 (a − 1)²` is 1 or more: |λ| ≤ 1 for both roots,
/// equal to 1 only for z = 0. (By `2a² = 1 + √(1 + 4z²)`, a is about `1 + z²/2` for small z: hence `|λ|⁻² ≈ 1 + z⁴/2`
/// and the z⁴/4. For large z `√(1 + 2iz)` is all that counts, of modulus `√(2z)`.) Nor does a damped one, `u′ = σu`
/// with Re σ ≤ 0, which has Δt σ in the place of iz: there a ≥ 0 and b² ≥ a² − 1, so `|2 − a − ib|² ≥ 1 + 2 (a − 1)²`
/// and `|2 + a + ib| ≥ 2` (A-stable; and L-stable like implicit Euler, as λ tends to 0 with growing |Δt σ|: the
/// midpoint rule is A-stable only).
///
/// Linear momentum is kept as in [`ImplicitEuler`](crate::ImplicitEuler), angular momentum is not.
///
/// It needs the state before the last one. The solver keeps it, together with a copy of the state that it produced;
/// when a step starts from another state, or with another Δt, it *starts again* with one step of implicit Euler, which
/// [`StepReport::restarts`] tells. One step of first order does not lower the order of the run: its error is of the order of Δt² and is made once, not in
/// each of T/Δt steps. (Where every other step starts again, the run is of first order.) So the state may be changed
/// between two steps, but whoever changes it before every step gets implicit Euler. Velocities of prescribed vertices
/// may change: moving a pin is no restart. A jump of velocities is a restart, measured over the whole cloth: where
/// contact stops it or it snaps taut, and so is a load that sets in or ends; and, unless all forces are linear, where
/// most of its motion has Δt ω above 0.57, about 11 steps a period or fewer, and gravity and load are small beside it.
/// (A step in which contact stops it is taken twice, the second time by implicit Euler.)
/// Such cloth, and what slides and folds, takes up to every other step by implicit Euler, to which the λ above does not
/// apply.
///
/// Damping: drag and stiffness act at the end of the step, both with second order.
///
/// Errors and residual are those of [`ImplicitEuler`](crate::ImplicitEuler).
#[derive(Debug)]
pub struct Bdf2 {
    implicit: Implicit,
    /// Positions (m) and velocities (m/s) before the last step.
    before: [Vec<Vec3>; 2],
    /// Those after it.
    after: [Vec<Vec3>; 2],
    /// Its size (s), if it succeeded.
    dt: Option<Real>,
    /// Whether velocities have jumped in it.
    has_jumped: bool,
    /// Load and air at its end (N); nothing if there was neither.
    force: Vec<Vec3>,
    /// Its load alone (N); nothing if there was none.
    load: Vec<Vec3>,
}

impl Bdf2 {
    /// Starts the description of a solver for these particles.
    #[must_use]
    pub fn builder(particles: &Particles) -> ImplicitBuilder<Self> {
        ImplicitBuilder::new(particles, |mut implicit| {
            let damper = implicit.damper.as_mut();
            damper.into_iter().for_each(Damper::expect_second_order);
            let zeros = || vec![Vec3::zeros(); implicit.particles.len()];
            Self {
                before: [zeros(), zeros()],
                after: [zeros(), zeros()],
                dt: None,
                has_jumped: false,
                force: Vec::new(),
                load: Vec::new(),
                implicit,
            }
        })
    }

    /// Whether the state is the one that the last step produced, and this step has the same size.
    fn continues(&self, state: &State, dt: Real) -> bool {
        let free = |vertex: &usize| !self.implicit.particles.is_prescribed(*vertex);
        let [positions, velocities] = &self.after;
        self.dt == Some(dt)
            && state.positions == *positions
            && (0..velocities.len())
                .filter(free)
                .all(|vertex| state.velocities[vertex] == velocities[vertex])
    }

    /// `‖Δt a‖²_M` (kg m²/s²) of the step.
    fn fall(&self, input: &StepInput<'_>) -> Real {
        let particles = &self.implicit.particles;
        let both = particles.mass().iter().zip(particles.inverse_mass());
        let squares = both.enumerate().map(|(vertex, (m, w))| {
            let a = input.external_acceleration(vertex, *w);
            m * (a * input.dt).norm_squared()
        });
        squares.sum()
    }

    /// Whether velocities (m/s) jump in the step to them that goes on from the memory, beside those before it and a
    /// step of [`fall`](Self::fall).
    fn jumps(&self, velocity: impl Fn(usize) -> Vec3, fall: Real) -> bool {
        let particles = &self.implicit.particles;
        let ([_, older], [_, old]) = (&self.before, &self.after);
        let (mut jump, mut all) = (0.0, fall);
        for (vertex, m) in particles.mass().iter().enumerate() {
            if !particles.is_prescribed(vertex) {
                let (v, new) = (old[vertex], velocity(vertex));
                jump += m * (new - v * 2.0 + older[vertex]).norm_squared();
                all += m * v.norm_squared();
            }
        }
        jump > JUMP * all
    }

    /// Whether the load differs from that of the last step by more than half of the larger of the two.
    fn load_jumps(&self, input: &StepInput<'_>) -> bool {
        if input.load.is_none() && self.load.is_empty() {
            return false;
        }
        let (mut change, mut before, mut now) = (0.0, 0.0, 0.0);
        for (vertex, &w) in self.implicit.particles.inverse_mass().iter().enumerate() {
            let old = self.load.get(vertex).copied().unwrap_or_default();
            let new = input.load.map_or(Vec3::zeros(), |load| load[vertex]);
            change += w * (new - old).norm_squared();
            before += w * old.norm_squared();
            now += w * new.norm_squared();
        }
        change > 0.25 * Real::max(before, now)
    }

    /// Upper bound on the work (J) of load and air in a step that ended in `state`: by the velocity at the end, where
    /// the load acts, or by the displacement and the mean of the forces at both ends, of second order. Where a load
    /// changes with time, as that of the air does, they differ.
    fn work_of(&self, input: &StepInput<'_>, state: &State) -> Real {
        let particles = &self.implicit.particles;
        let [start, _] = &self.after;
        let (mut by_velocity, mut by_displacement) = (0.0, 0.0);
        for vertex in (0..particles.len()).filter(|&v| !particles.is_prescribed(v)) {
            let force = force(input, vertex);
            let mean = 0.5 * (force + self.force.get(vertex).unwrap_or(&force));
            by_velocity += force.dot(&state.velocities[vertex]) * input.dt;
            by_displacement += mean.dot(&(state.positions[vertex] - start[vertex]));
        }
        by_velocity.max(by_displacement)
    }

    fn remember(&mut self, state: &State) {
        let [positions, velocities] = &mut self.after;
        positions.copy_from_slice(&state.positions);
        velocities.copy_from_slice(&state.velocities);
    }
}

/// The report of a step, with the work of an attempt that was given up.
fn with_attempt(report: StepReport, tried: StepReport) -> StepReport {
    StepReport {
        outcome: report.outcome,
        unfinished: report.unfinished,
        pin_work: report.pin_work,
        tells_pin_forces: report.tells_pin_forces,
        load_work: report.load_work,
        ..tried.and(report)
    }
}

/// The report of a step by implicit Euler.
fn restarted(report: StepReport) -> StepReport {
    StepReport {
        restarts: 1,
        ..report
    }
}

/// Load and air (N) at the end of a step.
fn force(input: &StepInput<'_>, vertex: usize) -> Vec3 {
    let load = input.load.map_or(Vec3::zeros(), |load| load[vertex]);
    let air = input.air.as_ref().map(|air| air.forces()[vertex]);
    load + air.unwrap_or_default()
}

impl Stepper for Bdf2 {
    fn name(&self) -> &'static str {
        "bdf2"
    }

    fn step(
        &mut self,
        state: &mut State,
        mut input: StepInput<'_>,
    ) -> Result<StepReport, StepError> {
        input.check(state, self.implicit.particles.len())?;
        let dt = input.dt;
        let has_load = input.load.is_some() || input.air.is_some();
        let is_linear = input.contacts.is_none() && self.implicit.energies.are_quadratic();
        let fall = (!is_linear).then(|| self.fall(&input));
        let mut has_jumped = false;
        let has_jumped_before = self.has_jumped || self.load_jumps(&input);
        let report = if self.continues(state, dt) && !has_jumped_before {
            let [positions, velocities] = &self.before;
            let third = |now: Vec3, before: Vec3| now + (now - before) / 3.0;
            let interval = Interval {
                tau: 2.0 / 3.0 * dt,
                at: TimePoint::End,
            };
            let tried = self
                .implicit
                .solve(state, &mut input, interval, |vertex, x, v| {
                    [third(x, positions[vertex]), third(v, velocities[vertex])]
                })?;
            let end = |vertex| self.implicit.end(vertex, state, dt, interval)[1];
            has_jumped = fall.is_some_and(|fall| self.jumps(end, fall));
            if has_jumped && self.implicit.is_touching(&mut input) {
                self.dt = None;
                let report = self.implicit.advance_euler(state, &mut input)?;
                restarted(with_attempt(report, tried))
            } else {
                let mut report = self.implicit.finish(state, &mut input, interval, tried)?;
                // By the force at the end it would be of first order only.
                report.pin_work = None;
                report.load_work = has_load.then(|| self.work_of(&input, state));
                report
            }
        } else {
            self.dt = None;
            self.remember(state);
            restarted(self.implicit.advance_euler(state, &mut input)?)
        };
        self.has_jumped = has_jumped;
        self.force.clear();
        if has_load {
            let vertices = 0..self.implicit.particles.len();
            self.force.extend(vertices.map(|v| force(&input, v)));
        }
        self.load.clear();
        self.load.extend(input.load.into_iter().flatten());
        std::mem::swap(&mut self.before, &mut self.after);
        self.remember(state);
        self.dt = Some(dt);
        Ok(report)
    }
}

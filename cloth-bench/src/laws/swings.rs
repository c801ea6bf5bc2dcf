//! Swings: the pendulum at any angle, and the small swings of a chain.

use super::prelude::*;
use crate::bisection::bisected;
use cloth_massspring::{Bdf2, ImplicitConfig, ImplicitMidpoint};
use std::f64::consts::PI;

const GRAVITY: Real = 9.81;

law! {
    PENDULUM = "pendulum" within 2e-6,
    "period of a pendulum of 1 m over that of small swings (dimensionless): (2/π) K(sin θ/2); extrapolated from two step sizes";
    pendulum(PendulumSettings {
        angle_deg: Real = 90 "degrees" in Between(0.0, 180.0), "angle from which it is let go";
        method: Scheme = "implicit-midpoint", "implicit-midpoint or bdf2, which are of second order";
        steps: u32 = 400 in AtLeast(8.0), "steps per period of small swings; a second run takes twice as many";
    })
}

law! {
    CHAIN_SWING = "chain-swing" within 1e-6,
    "angular frequency (rad/s) of a small swing of N equal masses on N links of 0.2 m: √(g x/l), x a zero of the Laguerre polynomial L_N; extrapolated from two step sizes";
    chain_swing(ChainSwingSettings {
        links: u32 = 5 in AtLeast(1.0), "number of links N";
        mode: u32 = 1 in AtLeast(1.0), "which swing, 1 for the slowest, up to N";
        method: Scheme = "implicit-midpoint", "implicit-midpoint or bdf2, which are of second order";
        steps: u32 = 400 in AtLeast(8.0), "steps per period of small swings; a second run takes twice as many";
    })
}

crate::choices! {
    /// What takes the step.
    enum Scheme { Midpoint = "implicit-midpoint", Bdf2 = "bdf2" }
}

/// Something let go at rest, held at vertex 0.
struct Swing {
    particles: Particles,
    springs: Vec<Spring>,
    start: State,
}

impl Swing {
    /// Time (s) until the last vertex first passes below the support.
    fn quarter(&self, scheme: Scheme, dt: Real) -> Result<Real, BenchError> {
        let sharp = ImplicitConfig {
            tolerance: 0.0,
            ..Default::default()
        };
        let (particles, springs) = (&self.particles, self.springs.clone());
        let mut solver: Box<dyn Stepper> = match scheme {
            Scheme::Midpoint => Box::new(
                ImplicitMidpoint::builder(particles)
                    .elements(vec![Elements::Springs(springs)])
                    .config(sharp)
                    .build()?,
            ),
            Scheme::Bdf2 => Box::new(
                Bdf2::builder(particles)
                    .elements(vec![Elements::Springs(springs)])
                    .config(sharp)
                    .build()?,
            ),
        };
        let mut state = self.start.clone();
        let tip = state.positions.len() - 1;
        for step in 0..1_000_000 {
            let (x0, v0) = (state.positions[tip].x, state.velocities[tip].x);
            let input = StepInput::new(dt).gravity(Vec3::z() * -GRAVITY);
            solver.step(&mut state, input)?;
            let (x1, v1) = (state.positions[tip].x, state.velocities[tip].x);
            if x1 <= 0.0 {
                return Ok((Real::from(step) + crossing([x0, x1], [v0 * dt, v1 * dt])) * dt);
            }
        }
        Err(BenchError::Failed("it does not swing back".into()))
    }

    /// The same without the error of second order, from steps of `dt` and `dt/2` (s); and that of the longer step
    /// alone.
    fn extrapolated(&self, scheme: Scheme, dt: Real) -> Result<[Real; 2], BenchError> {
        let [coarse, fine] = [self.quarter(scheme, dt)?, self.quarter(scheme, 0.5 * dt)?];
        Ok([(4.0 * fine - coarse) / 3.0, coarse])
    }
}

/// Where in (0, 1) the cubic with values `x` and slopes `v` at 0 and 1 passes zero.
fn crossing([x0, x1]: [Real; 2], [v0, v1]: [Real; 2]) -> Real {
    let value = |s: Real| {
        let r = 1.0 - s;
        r * r * (1.0 + 2.0 * s) * x0 + s * r * r * v0 + s * s * (3.0 - 2.0 * s) * x1
            - s * s * r * v1
    };
    let [low, high] = bisected([0.0, 1.0], 60, |s| value(s) > 0.0);
    0.5 * (low + high)
}

/// The arithmetic-geometric mean. K(k) is `π/2` over that of 1 and `√(1 − k²)`.
fn agm(mut a: Real, mut b: Real) -> Real {
    for _ in 0..40 {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    a
}

fn pendulum(own: &PendulumSettings) -> Result<Evaluation, BenchError> {
    let (scheme, steps) = (*own.method, *own.steps);
    within_reach(4e3 * Real::from(steps))?;
    let angle = own.angle_deg.to_radians();
    let mut particles = Particles::new(vec![1.0; 2])?;
    particles.prescribe(0)?;
    let positions = vec![Vec3::zeros(), Vec3::new(angle.sin(), 0.0, -angle.cos())];
    // The rod stretches by some 1e-9 of itself.
    let swing = Swing {
        springs: Spring::along(&positions, &[[0, 1]], 1e9 * GRAVITY),
        particles,
        start: State::at_rest(positions),
    };
    let small = 2.0 * PI / GRAVITY.sqrt();
    let [quarter, coarse] = swing.extrapolated(scheme, small / Real::from(steps))?;
    let expected = 1.0 / agm(1.0, (0.5 * angle).cos());
    Ok(Evaluation::new(expected, 4.0 * quarter / small)
        .detail("longer_step_alone", 4.0 * coarse / small))
}

fn chain_swing(own: &ChainSwingSettings) -> Result<Evaluation, BenchError> {
    let (links, steps) = (*own.links, *own.steps);
    let (n, of_steps) = (Real::from(links), Real::from(steps));
    within_reach(10.0 * n.powi(3) + 2e3 * n * of_steps)?;
    let links = links as usize;
    let mode = *own.mode as usize;
    if mode > links {
        return Err(BenchError::Usage(format!(
            "mode is {mode}, but {links} links have only {links} swings"
        )));
    }
    let scheme = *own.method;
    let (length, mass, stiffness) = (0.2, 0.1, 1e3);
    let zero = laguerre_zeros(links)[mode - 1];
    let expected = (GRAVITY * zero / length).sqrt();
    // The shape of the swing: values of L_0, L_1, … from the tip upwards.
    let mut shape = vec![1.0, 1.0 - zero];
    for i in 1..links {
        let n = i as Real;
        let next = ((2.0 * n + 1.0 - zero) * shape[i] - n * shape[i - 1]) / (n + 1.0);
        shape.push(next);
    }
    let largest = shape.iter().copied().map(Real::abs).fold(0.0, Real::max);
    let place = |i: usize| {
        let x = match i {
            0 => 0.0,
            _ => 1e-6 * length * shape[links - i] / largest,
        };
        Vec3::new(x, 0.0, -(i as Real) * length)
    };
    // Each link hangs at its full length under its own load, so that only the swing moves.
    let load = |i: usize| (links - i) as Real * mass * GRAVITY;
    let springs = (0..links).map(|i| Spring {
        vertices: [i as u32, i as u32 + 1],
        rest_length: length - load(i) / stiffness,
        stiffness,
    });
    let mut particles = Particles::new(vec![mass; links + 1])?;
    particles.prescribe(0)?;
    let swing = Swing {
        particles,
        springs: springs.collect(),
        start: State::at_rest((0..=links).map(place).collect()),
    };
    let period = 2.0 * PI / expected;
    let [quarter, coarse] = swing.extrapolated(scheme, period / Real::from(steps))?;
    Ok(Evaluation::new(expected, 0.5 * PI / quarter)
        .detail("longer_step_alone", 0.5 * PI / coarse)
        .detail("laguerre_zero", zero))
}

/// The zeros of the Laguerre polynomial `L_n`, ascending: the eigenvalues of its recurrence.
fn laguerre_zeros(n: usize) -> Vec<Real> {
    let recurrence = nalgebra::DMatrix::from_fn(n, n, |i, j| match i.abs_diff(j) {
        0 => 2.0 * i as Real + 1.0,
        1 => i.max(j) as Real,
        _ => 0.0,
    });
    let mut zeros: Vec<Real> = recurrence.symmetric_eigenvalues().iter().copied().collect();
    zeros.sort_by(Real::total_cmp);
    zeros
}

//! A cantilever under its own weight, at any deflection.
//!
//! The strip is that of `super::strip`, with triangles three times as high along the strip as wide across it: what is
//! left of Poisson's ratio makes it up to 0.15 % softer than its rigidity says, and the rim, whose vertices have fewer
//! hinges, about as much again. The rest is the resolution, of second order. Relative error of H/W with 5 vertices
//! across, quadratic hinges:
//!
//! | rows along the strip | Γ = 0.1 | 1 | 10 | 100 | 1000 |
//! |---|---|---|---|---|---|
//! | 32 | 0.19 % | 0.19 % | 0.20 % | 0.59 % | 4.0 % |
//! | 64 | 0.25 % | 0.25 % | 0.22 % | 0.26 % | 1.5 % |
//! | 128 | 0.27 % | 0.27 % | 0.24 % | 0.19 % | 0.46 % |
//!
//! At Γ = 1000 the strip bends within `L/√Γ` of the clamp, four rows of 128. Hinges by angle have a smaller error
//! there, 0.08 %, as `2 sin(θ/2)` is less than θ. The triangles matter: equilateral ones make the same strip of 5
//! vertices across 15 % too soft or more.

use super::models::{Model, ModelSetting};
use super::prelude::*;
use super::strip::{Equilibrium, Shape, Strip};
use crate::bisection::bisected;
use cloth_massspring::Accept;
use std::f64::consts::FRAC_PI_2;

law! {
    ELASTICA = "elastica" within 0.01,
    "drop over span H/W of a clamped strip under its own weight (dimensionless): θ″ + Γ(1 − s) cos θ = 0, for any bending model";
    elastica(ElasticaSettings {
        gamma: Real = 10 in Above(0.0),
            "weight over rigidity, ρ_A g L³/D, up to 1e5; above 1000 it takes more than 128 rows";
        resolution: u32 = 128 in AtLeast(4.0), "rows of vertices along the strip";
        across: u32 = 5 in AtLeast(2.0), "vertices across the strip";
        elongation: Real = 3 in Above(0.0), "height of the triangles along the strip over their base across it";
    } and ModelSetting)
}

/// Span W and drop H of the heavy elastica, over its length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Profile {
    /// W (dimensionless).
    pub span: Real,
    /// H (dimensionless).
    pub drop: Real,
}

/// Steps of the Runge–Kutta method from the tip to the clamp.
const STEPS: usize = 4000;

/// The exact solution of `θ″ + Γ(1 − s) cos θ = 0`, `θ(0) = 0`, `θ′(1) = 0`.
///
/// From the tip, with `u = 1 − s` and `δ = π/2 − θ`, it is `δ″ = Γ u sin δ`, `δ′(0) = 0`, and δ only grows. The unknown
/// is `ln δ(0)`: for a large Γ the strip hangs almost straight down, δ(0) falls like `exp(−⅔ √Γ)`, and an angle near
/// π/2 would not keep a digit of it.
pub fn exact(gamma: Real) -> Profile {
    // δ(1) grows with δ(0), and at least as fast as it would without gravity: δ(0) ≤ π/2.
    let ends = [-gamma.sqrt() - 10.0, FRAC_PI_2.ln()];
    let is_below = |tip: Real| integrate(gamma, tip.exp()).0 <= FRAC_PI_2;
    let [low, high] = bisected(ends, 64, is_below);
    integrate(gamma, (0.5 * (low + high)).exp()).1
}

/// δ at the clamp and the profile, for δ at the tip; δ beyond π is not followed. Classical Runge–Kutta of fourth order
/// in `(δ, δ′, W, H)`.
fn integrate(gamma: Real, tip: Real) -> (Real, Profile) {
    let h = 1.0 / STEPS as Real;
    let slope = |u: Real, y: [Real; 4]| {
        let (sin, cos) = y[0].sin_cos();
        [y[1], gamma * u * sin, sin, cos]
    };
    let mut y = [tip, 0.0, 0.0, 0.0];
    for step in 0..STEPS {
        let u = step as Real * h;
        let moved = |k: [Real; 4], by: Real| std::array::from_fn(|i| y[i] + by * k[i]);
        let k1 = slope(u, y);
        let k2 = slope(u + 0.5 * h, moved(k1, 0.5 * h));
        let k3 = slope(u + 0.5 * h, moved(k2, 0.5 * h));
        let k4 = slope(u + h, moved(k3, h));
        y = std::array::from_fn(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]));
        if y[0] > std::f64::consts::PI {
            break;
        }
    }
    let [angle, _, span, drop] = y;
    (angle, Profile { span, drop })
}

/// How much the membrane may stretch (dimensionless): it only has to keep the length.
const STRETCH: Real = 1e-4;

/// Above this the strip bends within a third of a hundredth of its length.
const MOST_GAMMA: Real = 1e5;

/// A strip at rest under its own weight.
#[derive(Clone, Debug)]
pub(crate) struct Sagged {
    pub(crate) strip: Strip,
    pub(crate) rest: Equilibrium,
    pub(crate) profile: Profile,
}

/// Lets a strip with a bending model come to rest, starting flat.
pub(crate) fn sag(gamma: Real, model: Model, shape: Shape) -> Result<Sagged, BenchError> {
    // With L = D = ρ_A = 1, g is Γ, and the pull at the clamp is at most Γ.
    let strip = Strip::new(shape, model, gamma.max(1.0) / STRETCH)?;
    let gravity = Vec3::z() * -gamma;
    let rest = strip.rest(strip.mesh.positions(), gravity, Accept::Minimum)?;
    let tip = strip.tip(&rest.positions);
    let profile = Profile {
        span: tip.x,
        drop: -tip.z,
    };
    Ok(Sagged {
        strip,
        rest,
        profile,
    })
}

/// The shape that settings ask for.
fn shape(own: &ElasticaSettings) -> Result<Shape, BenchError> {
    let shape = Shape {
        cells: *own.resolution as usize - 2,
        across: *own.across as usize,
        elongation: *own.elongation,
    };
    shape.check()?;
    Ok(shape)
}

fn elastica(own: &ElasticaSettings, model: &ModelSetting) -> Result<Evaluation, BenchError> {
    let gamma = *own.gamma;
    if gamma > MOST_GAMMA {
        return Err(BenchError::Usage(format!(
            "gamma is {gamma}, but the strip shows no more than a fold above {MOST_GAMMA:e}"
        )));
    }
    let model = *model.model;
    let shape = shape(own)?;
    let Profile { span, drop } = exact(gamma);
    let sagged = sag(gamma, model, shape)?;
    let measured = sagged.profile;
    Ok(Evaluation::new(drop / span, measured.drop / measured.span)
        .detail("vertices", sagged.strip.mesh.vertex_count() as Real)
        .detail("span", measured.span)
        .detail("span_expected", span)
        .detail("drop", measured.drop)
        .detail("drop_expected", drop)
        .detail("free_rigidity", shape.free_rigidity())
        .detail("force_left", sagged.rest.residual)
        .detail("force_left_by_rounding", sagged.rest.rounding)
        .detail("last_move", sagged.rest.last_move)
        .detail("newton_iterations", Real::from(sagged.rest.iterations)))
}

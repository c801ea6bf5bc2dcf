//! One mass and one plane.

use super::point_mass::PointMass;
use super::prelude::*;
use cloth_collide::obstacle::{HalfSpace, ImpactLaw, Obstacle};
use cloth_core::element::{Convexity, Element, Energy};
use cloth_core::math::Blocks;
use cloth_massspring::{ImplicitConfig, ImplicitEuler, StartGuess};

const GRAVITY: Real = 9.81;

law! {
    INCLINE = "incline" within 1e-12,
    "way (m) that a block slides from rest down an incline: ½ g (sin α − μ cos α) t² if tan α > μ, else none";
    incline(InclineSettings {
        angle_deg: Real = 30 "°" in Within(0.0, 90.0), "inclination of the plane";
        friction: Real = 0.3 in AtLeast(0.0), "coefficient of friction";
        steps: u32 = 120 in AtLeast(1.0), "number of steps of 1/60 s";
    })
}

law! {
    BOUNCE = "bounce" within 1e-12,
    "height (m) of a ball after n bounces, e²ⁿ h";
    bounce(BounceSettings {
        restitution: Real = 0.8 in Within(0.0, 1.0), "coefficient of restitution";
        height: Real = 1 "m" in Above(0.0), "height of the fall";
        bounces: u32 = 3 in AtLeast(1.0), "number of bounces n";
    })
}

law! {
    BARRIER_GAP = "barrier-gap" within 1e-9,
    "gap d (m) between a plane and a mass that rests on its log barrier: κ b′(d) = −m g";
    barrier_gap(BarrierGapSettings {
        mass: Real = 0.001 "kg" in Above(0.0), "mass";
        stiffness: Real = 100 "N/m" in Above(0.0), "stiffness κ of the barrier";
        range: Real = 0.01 "m" in Above(0.0), "distance at which the barrier begins";
    })
}

fn incline(own: &InclineSettings) -> Result<Evaluation, BenchError> {
    let degrees = *own.angle_deg;
    let friction = *own.friction;
    let law = ImpactLaw::new(friction, 0.0).map_err(BenchError::usage)?;
    let steps = *own.steps;
    within_reach(1e3 * Real::from(steps))?;
    let angle = degrees.to_radians();
    let plane = Obstacle::new(HalfSpace::inclined(angle).map_err(BenchError::usage)?);
    let dt = 1.0 / 60.0;
    let mut block = PointMass {
        position: Vec3::zeros(),
        velocity: Vec3::zeros(),
        mass: 1.0,
    };
    let gravity = Vec3::z() * -GRAVITY;
    for _ in 0..steps {
        block.advance(&plane, law, 0.0, gravity, 0.0, dt);
    }
    let time = steps as Real * dt;
    let fall = 0.5 * GRAVITY * time * time;
    let pull = (angle.sin() - friction * angle.cos()).max(0.0);
    let expected = fall * pull;
    let downhill = Vec3::new(angle.cos(), 0.0, -angle.sin());
    let evaluation = Evaluation::new(expected, block.position.dot(&downhill))
        .detail("tangent", angle.tan())
        .detail("speed", block.velocity.norm());
    // The way is the small difference of a pull and a friction that are each rounded, step by step.
    Ok(if pull > 0.0 {
        evaluation.rounding(4.0 * steps as Real * Real::EPSILON / pull)
    } else {
        evaluation
    })
}

fn bounce(own: &BounceSettings) -> Result<Evaluation, BenchError> {
    let restitution = *own.restitution;
    let law = ImpactLaw::new(0.0, restitution).map_err(BenchError::usage)?;
    let height = *own.height;
    let bounces = *own.bounces;
    within_reach(1e5 * Real::from(bounces))?;
    let floor = Obstacle::new(HalfSpace::new(Vec3::z()).map_err(BenchError::usage)?);
    // The nth rise ends at t₀ (1 + 2e + … + 2eⁿ⁻¹ + eⁿ), with the time t₀ of the first fall.
    let fall = (2.0 * height / GRAVITY).sqrt();
    let (mut end, mut power) = (1.0, 1.0);
    for n in 1..=bounces {
        power *= restitution;
        end += if n < bounces { 2.0 * power } else { power };
    }
    let end = end * fall;
    let steps = (end * 60.0).ceil();
    let mut ball = PointMass {
        position: Vec3::z() * height,
        velocity: Vec3::zeros(),
        mass: 1.0,
    };
    let gravity = Vec3::z() * -GRAVITY;
    for _ in 0..steps as usize {
        ball.advance(&floor, law, 0.0, gravity, 0.0, end / steps);
    }
    let expected = height * power * power;
    let evaluation = Evaluation::new(expected, ball.position.z).detail("speed", ball.velocity.z);
    // Each impact is found to a few roundings of the height.
    Ok(if expected > 0.0 {
        evaluation.rounding(64.0 * bounces as Real * Real::EPSILON / (power * power))
    } else {
        evaluation
    })
}

fn barrier_gap(own: &BarrierGapSettings) -> Result<Evaluation, BenchError> {
    let mass = *own.mass;
    let stiffness = *own.stiffness;
    let range = *own.range;
    // b′(d) = −(d − h) (2 ln(d/h) + (d − h)/d) rises from −∞ to 0; with d = h q it is h times a function of q.
    let pressed = |q: Real| stiffness * range * (q - 1.0) * (2.0 * q.ln() + (q - 1.0) / q);
    let (mut low, mut high): (Real, Real) = (0.0, 1.0);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if pressed(middle) > mass * GRAVITY {
            low = middle;
        } else {
            high = middle;
        }
    }
    let expected = range * high;

    let barrier = LogBarrier { stiffness, range };
    let particles = Particles::new(vec![mass])?;
    let config = ImplicitConfig {
        tolerance: 0.0,
        // Before the barrier; where the velocity leads may be behind it.
        start: StartGuess::Previous,
        ..Default::default()
    };
    let mut solver = ImplicitEuler::builder(&particles)
        .energy(vec![barrier])
        .config(config)
        .build()?;
    let mut state = State::at_rest(vec![Vec3::z() * range]);
    // Implicit Euler takes the energy out of the motion: steps much longer than the swing about the rest leave a tenth
    // of it.
    let dt = 10.0 * (mass / barrier.derivatives(expected)[1]).sqrt();
    for _ in 0..200 {
        let input = StepInput::new(dt).gravity(Vec3::z() * -GRAVITY);
        solver.step(&mut state, input)?;
    }
    let measured = state.positions[0].z;
    Ok(Evaluation::new(expected, measured).detail("speed", state.velocities[0].z))
}

/// E = −k (z − h)² ln(z/h) (J) of a vertex at the height z below h, nothing above: the barrier of M. Li et al.,
/// Incremental potential contact, *ACM Transactions on Graphics* 39(4), 2020, DOI 10.1145/3386569.3392425, its equation
/// (6). Twice continuously differentiable at h, and convex.
#[derive(Clone, Copy, Debug)]
pub struct LogBarrier {
    /// k (N/m).
    pub stiffness: Real,
    /// h (m).
    pub range: Real,
}

impl LogBarrier {
    /// E′ (N) and E″ (N/m) at the height `z` (m); where it is passed, those just before it.
    pub fn derivatives(&self, z: Real) -> [Real; 2] {
        if z >= self.range {
            return [0.0; 2];
        }
        let z = z.max(1e-12 * self.range);
        let (past, logarithm) = (z - self.range, (z / self.range).ln());
        let ratio = past / z;
        [
            -self.stiffness * past * (2.0 * logarithm + ratio),
            self.stiffness * (ratio * ratio - 4.0 * ratio - 2.0 * logarithm),
        ]
    }
}

impl Element<1> for LogBarrier {
    fn vertices(&self) -> [u32; 1] {
        [0]
    }
}

impl Energy<1> for LogBarrier {
    fn value(&self, [x]: &[Vec3; 1]) -> Real {
        let depth = self.range - x.z;
        match x.z {
            _ if depth <= 0.0 => 0.0,
            z if z <= 0.0 => Real::INFINITY,
            z => -self.stiffness * depth * depth * (z / self.range).ln(),
        }
    }

    fn gradient(&self, [x]: &[Vec3; 1]) -> [Vec3; 1] {
        [Vec3::z() * self.derivatives(x.z)[0]]
    }

    fn hessian(&self, [x]: &[Vec3; 1], _: Convexity) -> Blocks<1> {
        [[Vec3::z() * Vec3::z().transpose() * self.derivatives(x.z)[1]]]
    }
}

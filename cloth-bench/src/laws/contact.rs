//! One mass and one plane.

use super::prelude::*;
use super::within_reach;
use cloth_collide::obstacle::{
    HalfSpace, ImpactLaw, Obstacle, PenaltyLaw, PlanePenalty, PointMass,
};
use cloth_massspring::{ImplicitConfig, ImplicitEuler, StartGuess};

const GRAVITY: Real = 9.81;

const ANGLE: Parameter = parameter("angle_deg", "30", "inclination of the plane (°), 0 to 90");
const FRICTION: Parameter = parameter("friction", "0.3", "coefficient of friction, 0 or more");
const STEPS: Parameter = parameter("steps", "120", "number of steps of 1/60 s");

pub(super) const INCLINE: Law = Law {
    name: "incline",
    about: "way (m) that a block slides from rest down an incline: ½ g (sin α − μ cos α) t² if tan α > μ, else none",
    parameters: &[ANGLE, FRICTION, STEPS],
    tolerance: 1e-12,
    evaluate: incline,
};

const RESTITUTION: Parameter =
    parameter("restitution", "0.8", "coefficient of restitution, 0 to 1");
const HEIGHT: Parameter = parameter("height", "1", "height of the fall (m)");
const BOUNCES: Parameter = parameter("bounces", "3", "number of bounces n");

pub(super) const BOUNCE: Law = Law {
    name: "bounce",
    about: "height (m) of a ball after n bounces, e²ⁿ h",
    parameters: &[RESTITUTION, HEIGHT, BOUNCES],
    tolerance: 1e-12,
    evaluate: bounce,
};

const MASS: Parameter = parameter("mass", "0.001", "kg");
const STIFFNESS: Parameter = parameter("stiffness", "100", "stiffness κ of the barrier (N/m)");
const RANGE: Parameter = parameter("range", "0.01", "distance at which the barrier begins (m)");

pub(super) const BARRIER_GAP: Law = Law {
    name: "barrier-gap",
    about: "gap d (m) between a plane and a mass that rests on its log barrier: κ b′(d) = −m g",
    parameters: &[MASS, STIFFNESS, RANGE],
    tolerance: 1e-9,
    evaluate: barrier_gap,
};

fn incline(settings: &Settings) -> Result<Evaluation, BenchError> {
    let degrees = settings.number(&ANGLE)?;
    if !(0.0..=90.0).contains(&degrees) {
        return Err(BenchError::Usage(format!(
            "angle_deg is {degrees}, but it has to be between 0 and 90"
        )));
    }
    let friction = settings.number(&FRICTION)?;
    let law = ImpactLaw::new(friction, 0.0).map_err(BenchError::usage)?;
    let steps = settings.count(&STEPS, 1)?;
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

fn bounce(settings: &Settings) -> Result<Evaluation, BenchError> {
    let restitution = settings.number(&RESTITUTION)?;
    let law = ImpactLaw::new(0.0, restitution).map_err(BenchError::usage)?;
    let height = settings.positive(&HEIGHT)?;
    let bounces = settings.count(&BOUNCES, 1)?;
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

fn barrier_gap(settings: &Settings) -> Result<Evaluation, BenchError> {
    let mass = settings.positive(&MASS)?;
    let stiffness = settings.positive(&STIFFNESS)?;
    let range = settings.positive(&RANGE)?;
    let law = PenaltyLaw::barrier(stiffness, range).map_err(BenchError::usage)?;
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

    let barrier = PlanePenalty {
        vertex: 0,
        normal: Vec3::z(),
        offset: 0.0,
        law,
    };
    let particles = Particles::new(vec![mass])?;
    let config = ImplicitConfig {
        tolerance: 0.0,
        // Before the barrier; where the velocity leads may be behind it.
        start: StartGuess::Previous,
        ..Default::default()
    };
    let mut solver = ImplicitEuler::builder(&particles)
        .energy(vec![barrier])
        .and_then(|b| b.config(config).build())?;
    let mut state = State::at_rest(vec![Vec3::z() * range]);
    // Implicit Euler takes the energy out of the motion: steps much longer than the swing about the rest leave a tenth
    // of it.
    let dt = 10.0 * (mass / law.curvature(expected)).sqrt();
    for _ in 0..200 {
        let input = StepInput::new(dt).gravity(Vec3::z() * -GRAVITY);
        solver.step(&mut state, input)?;
    }
    let measured = state.positions[0].z;
    Ok(Evaluation::new(expected, measured).detail("speed", state.velocities[0].z))
}

//! Time integration: one oscillator, and free fall.

use super::prelude::*;
use crate::method::Method;
use crate::scene;
use cloth_core::energy::Attachment;
use cloth_massspring::{
    Bdf2, ExplicitConfig, ExplicitEuler, ImplicitConfig, ImplicitEuler, ImplicitMidpoint,
    StabilityCheck, SymplecticEuler,
};
use cloth_pd::{PdConfig, PdSolver};
use cloth_xpbd::{XpbdConfig, XpbdSolver};
use nalgebra::Complex;

law! {
    OSCILLATOR = "oscillator" within 1e-11,
    "amplification per step of x″ = −ω²x (dimensionless); phase per step (rad) as a detail";
    oscillator(OscillatorSettings {
        scheme: Scheme = "implicit-euler",
            "explicit-euler, symplectic-euler, implicit-euler, linear-implicit, implicit-midpoint, bdf2; xpbd and pd, \
             which are implicit Euler here";
        z: Real = 0.5 in Above(0.0), "step size times angular frequency, z = Δt ω";
    })
}

law! {
    FREE_FALL = "free-fall" within 1e-12,
    "fall (m) of a free sheet after n steps of 1/60 s, without any change of shape";
    free_fall(FreeFallSettings {
        method: String = "xpbd", "any method";
        n: u32 = 17 in AtLeast(2.0), "vertices a side";
        steps: u32 = 60 in AtLeast(1.0), "number of steps";
    })
}

crate::choices! {
    /// What takes the step.
    #[derive(PartialEq, Eq)]
    enum Scheme {
        Explicit = "explicit-euler",
        Symplectic = "symplectic-euler",
        Implicit = "implicit-euler",
        Linear = "linear-implicit",
        Midpoint = "implicit-midpoint",
        Bdf2 = "bdf2",
        Xpbd = "xpbd",
        Pd = "pd",
    }
}

impl Scheme {
    /// Amplification and phase (rad) per step in closed form.
    fn closed_form(self, z: Real) -> (Real, Real) {
        match self {
            Self::Explicit => ((1.0 + z * z).sqrt(), z.atan()),
            Self::Symplectic if z <= 2.0 => (1.0, 2.0 * (z / 2.0).asin()),
            Self::Symplectic => {
                let half = z * z / 2.0 - 1.0;
                (half + (half * half - 1.0).sqrt(), std::f64::consts::PI)
            }
            Self::Midpoint => (1.0, 2.0 * (z / 2.0).atan()),
            Self::Bdf2 => {
                let root = Complex::new(1.0, 2.0 * z).sqrt();
                (Complex::new(2.0, 0.0) - root).inv().to_polar()
            }
            Self::Implicit | Self::Linear | Self::Xpbd | Self::Pd => {
                (1.0 / (1.0 + z * z).sqrt(), z.atan())
            }
        }
    }

    /// A mass of 1 kg on a spring of stiffness `k` (N/m) to the origin.
    fn solver(self, k: Real) -> Result<Box<dyn Stepper>, BenchError> {
        let particles = Particles::new(vec![1.0])?;
        let spring = vec![Attachment {
            vertex: 0,
            target: Vec3::zeros(),
            stiffness: k,
        }];
        let unchecked = ExplicitConfig {
            stability: StabilityCheck::Off,
            ..Default::default()
        };
        let tight = ImplicitConfig {
            tolerance: 0.0,
            ..Default::default()
        };
        macro_rules! built {
            ($kind:ident, $config:expr) => {{
                let builder = $kind::builder(&particles).energy(spring);
                Box::new(builder.config($config).build()?)
            }};
        }
        let xpbd = XpbdConfig {
            substeps: 1,
            iterations: 1,
            ..Default::default()
        };
        let pd = PdConfig {
            iterations: Some(1),
            ..Default::default()
        };
        Ok(match self {
            Self::Explicit => built!(ExplicitEuler, unchecked),
            Self::Symplectic => built!(SymplecticEuler, unchecked),
            Self::Implicit => built!(ImplicitEuler, tight),
            Self::Linear => built!(ImplicitEuler, ImplicitConfig::linearized()),
            Self::Midpoint => built!(ImplicitMidpoint, tight),
            Self::Bdf2 => built!(Bdf2, tight),
            Self::Xpbd => built!(XpbdSolver, xpbd),
            Self::Pd => built!(PdSolver, pd),
        })
    }
}

fn oscillator(own: &OscillatorSettings) -> Result<Evaluation, BenchError> {
    let (scheme, z) = (*own.scheme, *own.z);
    let (amplification, phase) = match scheme {
        Scheme::Bdf2 => two_step_map(z)?,
        _ => one_step_map(scheme.solver(z * z)?)?,
    };
    let (expected, expected_phase) = scheme.closed_form(z);
    Ok(Evaluation::new(expected, amplification)
        .detail("phase_expected", expected_phase)
        .detail("phase_measured", phase))
}

/// Largest amplification and its phase (rad) of a solver that knows nothing but the state.
fn one_step_map(mut solver: Box<dyn Stepper>) -> Result<(Real, Real), BenchError> {
    // One step of size 1 is a linear map of (x, v); its columns are what it does to (1, 0) and (0, 1).
    let mut column = |x: Real, v: Real| -> Result<[Real; 2], BenchError> {
        let mut state = State::at_rest(vec![Vec3::new(x, 0.0, 0.0)]);
        state.velocities[0].x = v;
        solver.step(&mut state, StepInput::new(1.0))?;
        Ok([state.positions[0].x, state.velocities[0].x])
    };
    let [a, c] = column(1.0, 0.0)?;
    let [b, d] = column(0.0, 1.0)?;
    let half_trace = 0.5 * (a + d);
    let determinant = a * d - b * c;
    let discriminant = half_trace * half_trace - determinant;
    Ok(if discriminant < 0.0 {
        (determinant.sqrt(), (-discriminant).sqrt().atan2(half_trace))
    } else {
        let root = discriminant.sqrt();
        let (one, other) = (half_trace + root, half_trace - root);
        let largest = if one.abs() > other.abs() { one } else { other };
        (
            largest.abs(),
            if largest < 0.0 {
                std::f64::consts::PI
            } else {
                0.0
            },
        )
    })
}

/// The same of BDF2. For `u = x + iv/ω` its step is `u[2] = p u[1] + q u[0] + c f[2]`; the first step, with a load f and
/// without, makes two pairs `u[0]`, `u[1]` that tell p and q apart, and two loads of the second step tell c. (These are
/// so near to that of the first that it is no restart.)
fn two_step_map(z: Real) -> Result<(Real, Real), BenchError> {
    let run = |first: Real, second: Real| -> Result<[Complex<Real>; 2], BenchError> {
        let mut solver = Scheme::Bdf2.solver(z * z)?;
        let mut state = State::at_rest(vec![Vec3::x()]);
        let mut reached = |load: Real| {
            let load = [Vec3::x() * load];
            solver.step(&mut state, StepInput::new(1.0).load(&load))?;
            Ok::<_, BenchError>(Complex::new(
                state.positions[0].x,
                state.velocities[0].x / z,
            ))
        };
        Ok([reached(first)?, reached(second)?])
    };
    let force = 1.0 + z * z;
    let ([a1, a2], [b1, b2]) = (run(0.0, 0.0)?, run(force, force)?);
    let [_, less] = run(force, 0.6 * force)?;
    let by_load = (b2 - less) / 0.4;
    let p = (b2 - by_load - a2) / (b1 - a1);
    let q = a2 - p * a1;
    let root = (p * p + q * 4.0).sqrt();
    let [one, other] = [p + root, p - root].map(|twice| twice * 0.5);
    let largest = if one.norm() > other.norm() {
        one
    } else {
        other
    };
    // u turns clockwise.
    Ok((largest.norm(), -largest.arg()))
}

fn free_fall(own: &FreeFallSettings) -> Result<Evaluation, BenchError> {
    let method = Method::find(&own.method)?;
    let (steps, side) = (*own.steps, *own.n);
    within_reach(5e3 * Real::from(side).powi(2) * Real::from(steps))?;
    let sheet = Settings::default().with("n", side).with("pins", "none");
    let scene = scene::build("drop", None, &sheet)?;
    let mut solver = method.build(&scene, &Settings::default(), scene.dt)?;
    let mut state = scene.start.clone();
    for _ in 0..steps {
        let input = StepInput::new(scene.dt).gravity(scene.gravity);
        solver.step(&mut state, input)?;
    }
    let strain = cloth_core::measure::Strain::of(&scene.model.springs, &state.positions);
    let substeps = method.substeps(&scene, &Settings::default(), scene.dt)?;
    let n = steps * substeps;
    let h = scene.dt / Real::from(substeps);
    let expected = 0.5 * 9.81 * h * h * method.free_fall(n);
    // The fall of the vertex whose displacement is farthest from the law: a change of shape is an error, too.
    let moved = scene
        .start
        .positions
        .iter()
        .zip(&state.positions)
        .map(|(from, to)| from - to);
    let off = |d: &Vec3| (d - Vec3::z() * expected).norm();
    let worst = moved
        .max_by(|a, b| off(a).total_cmp(&off(b)))
        .unwrap_or_default();
    let fall = expected + off(&worst) * (worst.z - expected).signum();
    // A method that solves for positions with a matrix knows them to ε times its condition, k Δt²/m at most.
    let particles = &scene.model.particles;
    let ends = |s: &Spring| {
        s.stiffness
            * s.vertices
                .map(|v| particles.inverse_mass()[v as usize])
                .iter()
                .sum::<Real>()
    };
    let condition = scene.model.springs.iter().map(ends).fold(0.0, Real::max) * scene.dt * scene.dt;
    Ok(Evaluation::new(expected, fall)
        .rounding(Real::EPSILON * condition)
        .detail("largest_strain", strain.max.max(-strain.min)))
}

//! Every method by name, with its published setting: one for all scenes.

mod position_based;

use crate::error::BenchError;
use crate::names;
use crate::scene::Scene;
use crate::settings::{Parameter, Settings, parameter};
use cloth_core::math::Real;
use cloth_core::step::Stepper;
use cloth_massspring::{
    Bdf2, Damping, ExplicitConfig, ExplicitEuler, ImplicitConfig, ImplicitEuler, ImplicitMidpoint,
    StartGuess, SymplecticEuler, stable_time_step,
};
use cloth_pbd::{Limited, PbdConfig, PbdSolver, StiffnessRule};
use cloth_pd::{PdConfig, PdSolver, Start};
use cloth_xpbd::{XpbdConfig, XpbdSolver};
use position_based::{
    CHEBYSHEV, CHEBYSHEV_DELAY, HIERARCHY, RELAXATION, STRAIN_LIMIT, STRAIN_LIMIT_PASSES, SWEEP,
    acceleration, hierarchy, strain_limiter, sweep,
};

/// A method that can be named.
#[derive(Clone, Copy, Debug)]
pub struct Method {
    /// Its name.
    pub name: &'static str,
    /// What it is.
    pub about: &'static str,
    /// What can be set, with the published setting.
    pub parameters: &'static [Parameter],
    kind: Kind,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Explicit,
    Symplectic,
    Implicit,
    LinearImplicit,
    Midpoint,
    Bdf2,
    Pbd,
    Xpbd,
    Pd,
}

/// More parts of a step than this are a slip of the pen.
const MOST_SUBSTEPS: Real = 1e6;

const EXPLICIT_SUBSTEPS: Parameter = parameter(
    "substeps",
    "auto",
    "parts of a step; auto: as many as half the stable step of the start asks for",
);
const MAX_ITERATIONS: Parameter = parameter("iterations", "100", "most Newton iterations per step");
const TOLERANCE: Parameter = parameter(
    "tolerance",
    "1e-6",
    "relative gradient norm at which a step is done",
);
const START: Parameter = parameter(
    "start",
    "inertial",
    "first guess: previous, inertial or predicted",
);
const AIR_DRAG: Parameter = parameter("air_drag", "0", "drag per mass α (1/s): a force −α m v");
const STIFFNESS_DAMPING: Parameter = parameter(
    "stiffness_damping",
    "0",
    "stiffness-proportional damping β (s): a force −β K v",
);
const PBD_ITERATIONS: Parameter = parameter("iterations", "20", "sweeps per substep");
const PBD_SUBSTEPS: Parameter = parameter("substeps", "1", "parts of a step");
const PBD_STIFFNESS: Parameter = parameter(
    "projection",
    "material",
    "stiffness of the projections: material (one constraint alone shows its k), or a number from 0 to 1",
);
const XPBD_ITERATIONS: Parameter = parameter("iterations", "1", "sweeps per substep");
const XPBD_SUBSTEPS: Parameter = parameter("substeps", "20", "parts of a step");
const PD_ITERATIONS: Parameter = parameter("iterations", "10", "local–global iterations per step");
const PD_TOLERANCE: Parameter = parameter(
    "tolerance",
    "none",
    "relative gradient norm at which a step is done, or none",
);
const PD_START: Parameter = parameter("start", "predicted", "first guess: previous or predicted");

const NEWTON: &[Parameter] = &[
    MAX_ITERATIONS,
    TOLERANCE,
    START,
    AIR_DRAG,
    STIFFNESS_DAMPING,
    STRAIN_LIMIT,
    STRAIN_LIMIT_PASSES,
];

/// Every method.
pub const METHODS: [Method; 9] = [
    Method {
        name: "explicit-euler",
        about: "forward Euler: forces at the start of the step",
        parameters: &[
            EXPLICIT_SUBSTEPS,
            AIR_DRAG,
            STIFFNESS_DAMPING,
            STRAIN_LIMIT,
            STRAIN_LIMIT_PASSES,
        ],
        kind: Kind::Explicit,
    },
    Method {
        name: "symplectic-euler",
        about: "semi-implicit Euler: forces first, then positions with the new velocities",
        parameters: &[
            EXPLICIT_SUBSTEPS,
            AIR_DRAG,
            STIFFNESS_DAMPING,
            STRAIN_LIMIT,
            STRAIN_LIMIT_PASSES,
        ],
        kind: Kind::Symplectic,
    },
    Method {
        name: "implicit-euler",
        about: "implicit Euler as a minimisation, by Newton with line search and sparse Cholesky",
        parameters: NEWTON,
        kind: Kind::Implicit,
    },
    Method {
        name: "linear-implicit",
        about: "implicit Euler with one linear solve a step (Baraff and Witkin)",
        parameters: &[
            AIR_DRAG,
            STIFFNESS_DAMPING,
            STRAIN_LIMIT,
            STRAIN_LIMIT_PASSES,
        ],
        kind: Kind::LinearImplicit,
    },
    Method {
        name: "implicit-midpoint",
        about: "implicit midpoint rule: second order, no damping of its own",
        parameters: NEWTON,
        kind: Kind::Midpoint,
    },
    Method {
        name: "bdf2",
        about: "two-step backward differences: second order, little damping",
        parameters: NEWTON,
        kind: Kind::Bdf2,
    },
    Method {
        name: "pbd",
        about: "position-based dynamics",
        parameters: &[
            PBD_ITERATIONS,
            PBD_SUBSTEPS,
            PBD_STIFFNESS,
            HIERARCHY,
            SWEEP,
            RELAXATION,
            CHEBYSHEV,
            CHEBYSHEV_DELAY,
            STRAIN_LIMIT,
            STRAIN_LIMIT_PASSES,
        ],
        kind: Kind::Pbd,
    },
    Method {
        name: "xpbd",
        about: "extended position-based dynamics, small steps",
        parameters: &[
            XPBD_ITERATIONS,
            XPBD_SUBSTEPS,
            SWEEP,
            RELAXATION,
            CHEBYSHEV,
            CHEBYSHEV_DELAY,
            STRAIN_LIMIT,
            STRAIN_LIMIT_PASSES,
        ],
        kind: Kind::Xpbd,
    },
    Method {
        name: "pd",
        about: "projective dynamics",
        parameters: &[
            PD_ITERATIONS,
            PD_TOLERANCE,
            PD_START,
            STRAIN_LIMIT,
            STRAIN_LIMIT_PASSES,
        ],
        kind: Kind::Pd,
    },
];

impl Method {
    /// The method of that name.
    ///
    /// # Errors
    /// [`BenchError::Usage`] that names the nearest known one.
    pub fn find(name: &str) -> Result<&'static Self, BenchError> {
        METHODS
            .iter()
            .find(|method| method.name == name)
            .ok_or_else(|| {
                let known: Vec<&str> = METHODS.iter().map(|m| m.name).collect();
                BenchError::Usage(names::unknown("method", name, &known))
            })
    }

    /// A solver for a scene and a step size `dt` (s), with strain limiting if the settings ask for it.
    ///
    /// # Errors
    /// [`BenchError::Usage`] for a setting out of range.
    pub fn build(
        &self,
        scene: &Scene,
        settings: &Settings,
        dt: Real,
    ) -> Result<Box<dyn Stepper>, BenchError> {
        let solver = self.solver(scene, settings, dt)?;
        Ok(match strain_limiter(scene, settings)? {
            Some(limiter) => Box::new(Limited::new(solver, limiter)),
            None => solver,
        })
    }

    fn solver(
        &self,
        scene: &Scene,
        settings: &Settings,
        dt: Real,
    ) -> Result<Box<dyn Stepper>, BenchError> {
        let model = &scene.model;
        let (springs, hinges) = (model.springs.clone(), model.hinges.clone());
        let particles = &model.particles;
        macro_rules! mass_spring {
            ($kind:ident, $config:expr) => {{
                let config = $config;
                let built = $kind::builder(particles)
                    .energy(springs)
                    .and_then(|b| b.energy(hinges))
                    .and_then(|b| b.config(config).build());
                Box::new(built.map_err(BenchError::usage)?)
            }};
        }
        Ok(match self.kind {
            Kind::Explicit => mass_spring!(ExplicitEuler, self.explicit(scene, settings, dt)?),
            Kind::Symplectic => mass_spring!(SymplecticEuler, self.explicit(scene, settings, dt)?),
            Kind::Implicit => mass_spring!(ImplicitEuler, newton(settings)?),
            Kind::LinearImplicit => mass_spring!(ImplicitEuler, linearized(settings)?),
            Kind::Midpoint => mass_spring!(ImplicitMidpoint, newton(settings)?),
            Kind::Bdf2 => mass_spring!(Bdf2, newton(settings)?),
            Kind::Pbd => {
                let config = PbdConfig {
                    iterations: settings.count(&PBD_ITERATIONS, 1)?,
                    substeps: settings.count(&PBD_SUBSTEPS, 1)?,
                    sweep: sweep(settings)?,
                    acceleration: acceleration(settings)?,
                    stiffness: match settings.text(&PBD_STIFFNESS) {
                        "material" => StiffnessRule::Material,
                        _ => StiffnessRule::Fixed(settings.number(&PBD_STIFFNESS)?),
                    },
                };
                let builder = PbdSolver::builder(&model.particles)
                    .energy(springs)
                    .energy(hinges);
                let solver = builder.config(config).build().map_err(BenchError::usage)?;
                Box::new(match hierarchy(scene, settings)? {
                    Some(hierarchy) => solver
                        .with_hierarchy(hierarchy)
                        .map_err(BenchError::usage)?,
                    None => solver,
                })
            }
            Kind::Xpbd => {
                let config = XpbdConfig {
                    iterations: settings.count(&XPBD_ITERATIONS, 1)?,
                    substeps: settings.count(&XPBD_SUBSTEPS, 1)?,
                    sweep: sweep(settings)?,
                    acceleration: acceleration(settings)?,
                };
                let builder = XpbdSolver::builder(&model.particles)
                    .energy(springs)
                    .energy(hinges);
                Box::new(builder.config(config).build().map_err(BenchError::usage)?)
            }
            Kind::Pd => {
                let config = PdConfig {
                    iterations: settings.count(&PD_ITERATIONS, 1)?,
                    tolerance: match settings.text(&PD_TOLERANCE) {
                        "none" => None,
                        _ => Some(settings.number(&PD_TOLERANCE)?),
                    },
                    start: settings.choice(
                        &PD_START,
                        &[
                            ("previous", Start::Previous),
                            ("predicted", Start::Predicted),
                        ],
                    )?,
                };
                let builder = PdSolver::builder(&model.particles)
                    .energy(springs)
                    .energy(hinges);
                Box::new(builder.config(config).build().map_err(BenchError::usage)?)
            }
        })
    }

    fn explicit(
        &self,
        scene: &Scene,
        settings: &Settings,
        dt: Real,
    ) -> Result<ExplicitConfig, BenchError> {
        Ok(ExplicitConfig {
            substeps: self.substeps(scene, settings, dt)?,
            damping: damping(settings)?,
            ..Default::default()
        })
    }

    /// Into how many parts the method cuts a step of `dt` (s) on a scene.
    ///
    /// # Errors
    /// [`BenchError::Usage`] for a setting out of range.
    pub fn substeps(
        &self,
        scene: &Scene,
        settings: &Settings,
        dt: Real,
    ) -> Result<u32, BenchError> {
        match self.kind {
            Kind::Implicit | Kind::LinearImplicit | Kind::Midpoint | Kind::Bdf2 | Kind::Pd => Ok(1),
            Kind::Pbd => settings.count(&PBD_SUBSTEPS, 1),
            Kind::Xpbd => settings.count(&XPBD_SUBSTEPS, 1),
            Kind::Explicit | Kind::Symplectic if settings.text(&EXPLICIT_SUBSTEPS) != "auto" => {
                settings.count(&EXPLICIT_SUBSTEPS, 1)
            }
            Kind::Explicit | Kind::Symplectic => {
                let energies = scene.model.energies().map_err(BenchError::usage)?;
                let stable =
                    stable_time_step(&energies, &scene.model.particles, &scene.start.positions);
                let wanted = stable.map_or(1.0, |stable| (2.0 * dt / stable).ceil().max(1.0));
                if wanted <= MOST_SUBSTEPS {
                    return Ok(wanted as u32);
                }
                Err(BenchError::Usage(format!(
                    "a stable step of {} needs {wanted:.1e} substeps of {dt} s, more than {MOST_SUBSTEPS:e}",
                    self.name
                )))
            }
        }
    }

    /// Whether the method, solved exactly, takes the step of implicit Euler, so that its error can be measured against the minimiser of `G`. The second-order
    /// rules take another step.
    #[must_use]
    pub fn aims_at_implicit_euler(&self) -> bool {
        !matches!(self.kind, Kind::Midpoint | Kind::Bdf2)
    }

    /// How far free fall leads in `n` equal (sub)steps of size h, in units of `½ g h²`.
    #[must_use]
    pub fn free_fall(&self, n: u32) -> Real {
        let count = Real::from(n);
        match self.kind {
            // The velocity of a step is that at its start, in its middle or at its end.
            Kind::Explicit => count * (count - 1.0),
            Kind::Midpoint => count * count,
            // Exact but for what the first step, of implicit Euler, leaves: errors stay or shrink to a third.
            Kind::Bdf2 => count * count + 1.5 * (1.0 - (1.0 / 3.0 as Real).powf(count)),
            _ => count * (count + 1.0),
        }
    }
}

/// Settings of the methods that iterate with Newton's method.
fn newton(settings: &Settings) -> Result<ImplicitConfig, BenchError> {
    Ok(ImplicitConfig {
        max_iterations: settings.count(&MAX_ITERATIONS, 1)?,
        tolerance: settings.number(&TOLERANCE)?,
        start: settings.choice(
            &START,
            &[
                ("previous", StartGuess::Previous),
                ("inertial", StartGuess::Inertial),
                ("predicted", StartGuess::Predicted),
            ],
        )?,
        damping: damping(settings)?,
        ..Default::default()
    })
}

fn linearized(settings: &Settings) -> Result<ImplicitConfig, BenchError> {
    Ok(ImplicitConfig {
        damping: damping(settings)?,
        ..ImplicitConfig::linearized()
    })
}

fn damping(settings: &Settings) -> Result<Damping, BenchError> {
    Ok(Damping {
        air_drag: settings.number(&AIR_DRAG)?,
        stiffness: settings.number(&STIFFNESS_DAMPING)?,
    })
}

//! Every method by name, with its published setting: one for all scenes.

use crate::error::BenchError;
use crate::names;
use crate::scene::Scene;
use crate::settings::{Parameter, Settings, parameter};
use cloth_core::math::Real;
use cloth_core::position_based::Sweep;
use cloth_core::step::Stepper;
use cloth_massspring::{
    ExplicitConfig, ExplicitEuler, ImplicitConfig, ImplicitEuler, StartGuess, SymplecticEuler,
    stable_time_step,
};
use cloth_pbd::{PbdConfig, PbdSolver, StiffnessRule};
use cloth_pd::{PdConfig, PdSolver, Start};
use cloth_xpbd::{XpbdConfig, XpbdSolver};

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
    Pbd,
    Xpbd,
    Pd,
}

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
const PBD_ITERATIONS: Parameter = parameter("iterations", "20", "sweeps per substep");
const PBD_SUBSTEPS: Parameter = parameter("substeps", "1", "parts of a step");
const PBD_STIFFNESS: Parameter = parameter(
    "projection",
    "material",
    "stiffness of the projections: material (one constraint alone shows its k), or a number from 0 to 1",
);
const SWEEP: Parameter = parameter(
    "sweep",
    "colored",
    "order of the sweep: colored or sequential",
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

/// Every method.
pub const METHODS: [Method; 6] = [
    Method {
        name: "explicit-euler",
        about: "forward Euler: forces at the start of the step",
        parameters: &[EXPLICIT_SUBSTEPS],
        kind: Kind::Explicit,
    },
    Method {
        name: "symplectic-euler",
        about: "semi-implicit Euler: forces first, then positions with the new velocities",
        parameters: &[EXPLICIT_SUBSTEPS],
        kind: Kind::Symplectic,
    },
    Method {
        name: "implicit-euler",
        about: "implicit Euler as a minimisation, by Newton with line search and sparse Cholesky",
        parameters: &[MAX_ITERATIONS, TOLERANCE, START],
        kind: Kind::Implicit,
    },
    Method {
        name: "pbd",
        about: "position-based dynamics",
        parameters: &[PBD_ITERATIONS, PBD_SUBSTEPS, PBD_STIFFNESS, SWEEP],
        kind: Kind::Pbd,
    },
    Method {
        name: "xpbd",
        about: "extended position-based dynamics, small steps",
        parameters: &[XPBD_ITERATIONS, XPBD_SUBSTEPS, SWEEP],
        kind: Kind::Xpbd,
    },
    Method {
        name: "pd",
        about: "projective dynamics",
        parameters: &[PD_ITERATIONS, PD_TOLERANCE, PD_START],
        kind: Kind::Pd,
    },
];

const SWEEPS: [(&str, Sweep); 2] = [
    ("colored", Sweep::Colored),
    ("sequential", Sweep::Sequential),
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

    /// A solver for a scene and a step size `dt` (s).
    ///
    /// # Errors
    /// [`BenchError::Usage`] for a setting out of range.
    pub fn build(
        &self,
        scene: &Scene,
        settings: &Settings,
        dt: Real,
    ) -> Result<Box<dyn Stepper>, BenchError> {
        let model = &scene.model;
        let (springs, hinges) = (model.springs.clone(), model.hinges.clone());
        Ok(match self.kind {
            Kind::Explicit => {
                let config = self.explicit(scene, settings, dt)?;
                let builder = ExplicitEuler::builder(&model.particles).energy(springs);
                let built = builder
                    .and_then(|b| b.energy(hinges))
                    .and_then(|b| b.config(config).build());
                Box::new(built.map_err(BenchError::usage)?)
            }
            Kind::Symplectic => {
                let config = self.explicit(scene, settings, dt)?;
                let builder = SymplecticEuler::builder(&model.particles).energy(springs);
                let built = builder
                    .and_then(|b| b.energy(hinges))
                    .and_then(|b| b.config(config).build());
                Box::new(built.map_err(BenchError::usage)?)
            }
            Kind::Implicit => {
                let config = ImplicitConfig {
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
                    ..Default::default()
                };
                let builder = ImplicitEuler::builder(&model.particles).energy(springs);
                let built = builder
                    .and_then(|b| b.energy(hinges))
                    .and_then(|b| b.config(config).build());
                Box::new(built.map_err(BenchError::usage)?)
            }
            Kind::Pbd => {
                let config = PbdConfig {
                    iterations: settings.count(&PBD_ITERATIONS, 1)?,
                    substeps: settings.count(&PBD_SUBSTEPS, 1)?,
                    sweep: settings.choice(&SWEEP, &SWEEPS)?,
                    stiffness: match settings.text(&PBD_STIFFNESS) {
                        "material" => StiffnessRule::Material,
                        _ => StiffnessRule::Fixed(settings.number(&PBD_STIFFNESS)?),
                    },
                };
                let builder = PbdSolver::builder(&model.particles)
                    .energy(springs)
                    .energy(hinges);
                Box::new(builder.config(config).build().map_err(BenchError::usage)?)
            }
            Kind::Xpbd => {
                let config = XpbdConfig {
                    iterations: settings.count(&XPBD_ITERATIONS, 1)?,
                    substeps: settings.count(&XPBD_SUBSTEPS, 1)?,
                    sweep: settings.choice(&SWEEP, &SWEEPS)?,
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
            Kind::Implicit | Kind::Pd => Ok(1),
            Kind::Pbd => settings.count(&PBD_SUBSTEPS, 1),
            Kind::Xpbd => settings.count(&XPBD_SUBSTEPS, 1),
            Kind::Explicit | Kind::Symplectic if settings.text(&EXPLICIT_SUBSTEPS) != "auto" => {
                settings.count(&EXPLICIT_SUBSTEPS, 1)
            }
            Kind::Explicit | Kind::Symplectic => {
                let energies = scene.model.energies().map_err(BenchError::usage)?;
                let stable =
                    stable_time_step(&energies, &scene.model.particles, &scene.start.positions);
                Ok(stable.map_or(1, |stable| (2.0 * dt / stable).ceil().max(1.0) as u32))
            }
        }
    }

    /// How many of n equal substeps of free fall the new velocity leads the position: a fall is `½ g h² n (n + lead)`.
    #[must_use]
    pub fn velocity_lead(&self) -> Real {
        if self.kind == Kind::Explicit {
            -1.0
        } else {
            1.0
        }
    }
}

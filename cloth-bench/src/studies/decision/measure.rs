//! What is measured of a method, and on which sheets.

use super::super::stability::{self, StableUpTo};
use super::super::{Scope, locking, scale, sheets};
use crate::studies::pictures::coordinates;
use crate::studies::prelude::*;
use std::time::{Duration, Instant};

/// Vertices a side of the two sheets whose steps are timed.
pub(super) fn sides(scope: Scope) -> [u32; 2] {
    scope.pick([24, 48], [64, 128])
}

/// Vertices a side of the sheets of [`Step`] and of [`Contact`], and steps of the latter.
pub(super) fn small(scope: Scope) -> (u32, u32, u32) {
    scope.pick((13, 9, 12), (33, 25, 30))
}

/// Cells a side of the sheet that hangs over an edge.
pub(super) const FOLDED: u32 = 8;

/// Time that a run may take.
fn budget(scope: Scope) -> Duration {
    scope.pick(Duration::from_secs(2), Duration::from_secs(20))
}

/// Steps of the hanging sheet that are timed, or fewer if one takes longer than [`long`].
const TIMED: [u32; 2] = [3, 16];

/// A long step (ms).
fn long(scope: Scope) -> Real {
    scope.pick(30.0, 300.0)
}

/// What a step takes.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Cost {
    /// Vertices a side.
    pub sides: [u32; 2],
    /// Time of a step (ms) at either size.
    pub ms: [Option<Real>; 2],
    /// Peak of the process (B) at the larger size.
    pub memory: Option<Real>,
}

impl Cost {
    pub(super) fn measure(scope: Scope, method: &str) -> Result<Self, BenchError> {
        let sides = sides(scope);
        let mut cost = Self {
            sides,
            ..Self::default()
        };
        // `run` gives pbd as many substeps as xpbd; here it has the same setting in every column.
        let settings = if method == "pbd" { "substeps=1" } else { "" };
        // The larger size of the slowest method takes forty seconds.
        let budget = 3 * budget(scope);
        for (side, ms) in sides.into_iter().zip(&mut cost.ms) {
            let [few, many] = TIMED;
            let Ok(mut size) = scale::alone(method, side, few, settings, budget)? else {
                continue;
            };
            if size.ms_per_step < long(scope)
                && let Ok(longer) = scale::alone(method, side, many, settings, budget)?
            {
                size = longer;
            }
            *ms = Some(size.ms_per_step);
            cost.memory = size.memory.map(|bytes| bytes as Real);
        }
        Ok(cost)
    }
}

/// What a method makes of a step, a stiff sheet and a fold: the same on every machine.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Step {
    /// `(G − G*)/(G(x̃) − G*)` (dimensionless); none of methods that solve another step.
    pub error: Option<Real>,
    /// Largest strain of an edge of the hanging sheet (dimensionless).
    pub stretch: Option<Real>,
    /// The largest stiffness (N/m), by decades.
    pub stable: StableUpTo,
    /// Angle over the exact one (dimensionless).
    pub fold: Option<Real>,
    /// Why a number is missing.
    pub reasons: Vec<String>,
}

impl Step {
    /// Measures a method; one that fails says so in the reasons.
    pub fn measure(scope: Scope, method: &Method) -> Result<Self, BenchError> {
        let mut step = Self {
            stable: stability::stable_up_to(method.name, stable_steps(scope))?,
            ..Self::default()
        };
        let error = method
            .aims_at_implicit_euler()
            .then(|| error_of_a_step(small(scope).0, method));
        let fold = locking::fold_angle(method.name, FOLDED as usize);
        step.error = error.and_then(|found| or_reason(found, &mut step.reasons));
        let (_, n, steps) = small(scope);
        let hang = scene::build("hang", None, &Settings::default().with("n", n))?;
        let settings = method.by_default(Settings::default());
        let hung = run::from_start(&hang, method, &settings, hang.dt, steps, |_, _, _| Ok(()));
        let stretch = hung.map(|(summary, _)| summary.max_stretch);
        step.stretch = or_reason(stretch, &mut step.reasons);
        step.fold = or_reason(fold, &mut step.reasons);
        Ok(step)
    }
}

fn or_reason(found: Result<Real, BenchError>, reasons: &mut Vec<String>) -> Option<Real> {
    found
        .map_err(|error| reasons.push(error.to_string()))
        .ok()
        .filter(|value| value.is_finite())
}

fn stable_steps(scope: Scope) -> u32 {
    scope.pick(20, 60)
}

fn error_of_a_step(n: u32, method: &Method) -> Result<Real, BenchError> {
    let settings = sheets::hanging(n, sheets::STIFFNESS);
    let scene = scene::build("hang", None, &settings)?;
    let problem = sheets::sixteenth_step(&settings)?;
    let by_default = method.by_default(Settings::default());
    let mut solver = method.build(&scene, &by_default, scene.dt)?;
    // Not below what the reference itself has to rounding.
    Ok(problem.solve(&mut *solver)?.0.objective.max(1e-15))
}

/// What becomes of the method of which no step is stable: that, in two words; the error it ends with is foretold.
pub fn hopeless(scope: Scope) -> Result<String, BenchError> {
    let stable = stability::stable_up_to(scale::WITHOUT, stable_steps(scope))?;
    Ok(stable
        .stable
        .map_or("never, as expected".into(), super::columns::power))
}

/// The memory (B) of the method of which no step is stable.
pub(super) fn hopeless_memory(scope: Scope) -> Result<Option<Real>, BenchError> {
    let [_, large] = sides(scope);
    let size = scale::alone(scale::WITHOUT, large, TIMED[0], "", budget(scope))?;
    let memory = size.map_err(BenchError::Failed)?.memory;
    Ok(memory.map(|bytes| bytes as Real))
}

/// A sheet in contact after half a second, and the same sheet hanging.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Contact {
    pub(super) hanging_ms: Option<Real>,
    pub(super) drape: Drape,
}

/// A sheet that has fallen on a sphere.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(super) struct Drape {
    pub(super) ms: Option<Real>,
    /// Largest strain of an edge (dimensionless).
    pub(super) stretch: Option<Real>,
    /// Pairs that cross at the end.
    pub(super) crossings: Option<Real>,
    /// Energy from nowhere over what was given (dimensionless).
    pub(super) excess: Option<Real>,
    /// Positions (m).
    pub(super) positions: Vec<[Real; 3]>,
    /// Why there is none.
    pub(super) reason: Option<String>,
}

impl Contact {
    /// Whether it has been ended because it would have taken too long.
    pub(super) fn is_too_long(&self) -> bool {
        let reason = self.drape.reason.as_deref();
        reason.is_some_and(|reason| reason.contains("longer than"))
    }

    pub(super) fn measure(scope: Scope, method: &Method) -> Result<Self, BenchError> {
        let (_, n, steps) = small(scope);
        let settings = Settings::default().with("n", n);
        let hang = scene::build("hang", None, &settings)?;
        let defaults = method.by_default(Settings::default());
        let hanging = until(scope, |check| {
            run::from_start(&hang, method, &defaults, hang.dt, steps, |_, _, _| check())
        });
        let hanging = hanging.ok().map(|(summary, _)| summary);
        Ok(Self {
            hanging_ms: hanging.map(|s| s.ms_per_step_median),
            drape: Drape::measure(&draped(scope)?, scope, method, &defaults)?,
        })
    }
}

impl Drape {
    /// [So many steps](steps) of a method on a scene.
    pub(super) fn measure(
        scene: &Scene,
        scope: Scope,
        method: &Method,
        settings: &Settings,
    ) -> Result<Self, BenchError> {
        let (dt, steps) = (scene.dt, steps(scope));
        let ran = until(scope, |check| {
            run::from_start(scene, method, settings, dt, steps, |_, _, _| check())
        });
        Ok(match ran {
            Ok((summary, end)) => Self {
                ms: Some(summary.ms_per_step_median),
                stretch: Some(summary.max_stretch),
                crossings: summary
                    .intersections
                    .map(|own| (own + summary.obstacle_intersections.unwrap_or(0)) as Real),
                excess: Some(summary.energy_excess / summary.energy_given.max(Real::MIN_POSITIVE)),
                positions: coordinates(end.positions),
                reason: None,
            },
            Err(error) => Self {
                reason: Some(error.to_string()),
                ..Self::default()
            },
        })
    }
}

/// The sheet above the sphere.
pub(super) fn draped(scope: Scope) -> Result<Scene, BenchError> {
    scene::build(
        "drape-sphere",
        None,
        &Settings::default().with("n", small(scope).1),
    )
}

/// Steps of the sheet on the sphere.
pub(super) fn steps(scope: Scope) -> u32 {
    small(scope).2
}

/// What `work` finds, if it does so within its time: it has to call what it is given after every step.
fn until<T>(
    scope: Scope,
    work: impl FnOnce(&dyn Fn() -> Result<(), BenchError>) -> Result<T, BenchError>,
) -> Result<T, BenchError> {
    let (started, budget) = (Instant::now(), budget(scope));
    work(&|| match started.elapsed() > budget {
        true => Err(BenchError::Failed(format!(
            "longer than {} s",
            budget.as_secs()
        ))),
        false => Ok(()),
    })
}

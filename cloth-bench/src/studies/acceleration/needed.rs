//! How many sweeps a variant of the sweep needs, and how long they take.

use crate::studies::interleaved::timed;
use crate::studies::prelude::*;
use crate::yardstick::StepProblem;
use cloth_core::step::Observer;
use std::sync::Arc;

/// The error that is asked for.
const WANTED: Real = 0.01;

/// Where the step should end.
pub(super) enum Target {
    /// At these places (m); errors are relative to `fallen` (m).
    Places { places: Vec<Vec3>, fallen: Real },
    /// At the minimum of `G`.
    ImplicitEuler(Arc<StepProblem>),
}

impl Target {
    /// The error of some positions (m): 1 for the prediction.
    fn error(&self, x: &[Vec3]) -> Real {
        match self {
            Self::Places { places, fallen } => {
                let squares = x.iter().zip(places).map(|(x, p)| (x - p).norm_squared());
                (squares.sum::<Real>() / x.len() as Real).sqrt() / fallen
            }
            Self::ImplicitEuler(problem) => problem.error(x).objective,
        }
    }
}

/// An estimate of more than so many times the sweeps allowed is not improved.
const HOPELESS: Real = 4.0;

/// A number of sweeps.
#[derive(Clone, Copy, Debug)]
pub(super) struct Needed {
    pub(super) sweeps: Real,
    /// Whether so many were made; else it is what the rate so far leads to.
    pub(super) measured: bool,
}

impl Needed {
    /// Whole sweeps.
    fn count(&self) -> u32 {
        self.sweeps.ceil() as u32
    }
}

/// Looks at every sweep up to the hundredth, then at one in a hundred.
struct Watch<'a> {
    target: &'a Target,
    next: Real,
    /// Sweep and error.
    seen: Vec<(u32, Real)>,
}

impl Observer for Watch<'_> {
    fn iteration(&mut self, sweep: u32, x: &[Vec3]) {
        let reached = self.seen.last().is_some_and(|&(_, error)| error <= WANTED);
        if !reached && Real::from(sweep) >= self.next {
            self.seen.push((sweep, self.target.error(x)));
            self.next = (Real::from(sweep) * 1.01).max(Real::from(sweep) + 1.0);
        }
    }
}

fn solver(scene: &Scene, variant: &Variant, sweeps: u32) -> Result<Box<dyn Stepper>, BenchError> {
    let settings = variant.settings.clone().with("iterations", sweeps);
    Method::find(variant.method())?.build(scene, &settings, scene.dt)
}

/// Sweeps of a variant until the error is small, counted up to `most` of them.
pub(super) fn sweeps(
    scene: &Scene,
    state: &State,
    target: &Target,
    variant: &Variant,
    most: u32,
) -> Result<Needed, BenchError> {
    let mut allowed = most.min(250);
    loop {
        let mut watch = Watch {
            target,
            next: 1.0,
            seen: Vec::new(),
        };
        let input = StepInput::new(scene.dt)
            .gravity(scene.gravity)
            .observer(&mut watch);
        solver(scene, variant, allowed)?.step(&mut state.clone(), input)?;
        let Some(&(last, error)) = watch.seen.last() else {
            return Err(BenchError::Failed("no sweep was seen".into()));
        };
        if error <= WANTED {
            return Ok(Needed {
                sweeps: Real::from(last),
                measured: true,
            });
        }
        if allowed == most {
            return extrapolated(&watch.seen);
        }
        // Errors fall more slowly the longer it takes: what is far away now is not within reach.
        if 4 * allowed >= most
            && let Ok(estimate) = extrapolated(&watch.seen)
            && estimate.sweeps > HOPELESS * Real::from(most)
        {
            return Ok(estimate);
        }
        allowed = (4 * allowed).min(most);
    }
}

/// What the rate of the second half of the sweeps leads to.
fn extrapolated(seen: &[(u32, Real)]) -> Result<Needed, BenchError> {
    let stalled = || BenchError::Failed("the error does not fall".into());
    let &(last, error) = seen.last().ok_or_else(stalled)?;
    let middle = seen.iter().find(|(sweep, _)| 2 * sweep >= last);
    let &(from, before) = middle.ok_or_else(stalled)?;
    let rate = (before / error).ln() / Real::from(last - from);
    // A floor rather than a slow descent: as many again would take less than a hundredth of the error.
    let falls = rate * Real::from(last) > 0.01;
    if !falls {
        return Err(BenchError::Failed(format!(
            "the error is {error:.2e} after {last} sweeps and falls no further"
        )));
    }
    Ok(Needed {
        sweeps: Real::from(last) + (error / WANTED).ln() / rate,
        measured: false,
    })
}

/// How long (s) the sweeps of one variant take, and one of them on the mean.
#[derive(Clone, Copy, Debug)]
pub(super) struct Time {
    pub(super) seconds: Real,
    pub(super) per_sweep: Real,
}

const ROUNDS: usize = 15;
/// Sweeps that are timed at most; a multiple of those between two corrections of a hierarchy.
const TIMED: u32 = 200;

/// The smallest times of some repetitions, all `runs` in turn.
pub(super) fn times<'a>(
    scene: impl Fn(&Variant) -> &'a Scene,
    state: &State,
    runs: &[(&Variant, Needed)],
) -> Result<Vec<Time>, BenchError> {
    // One sweep, with what a step costs besides; and as many as are needed, or many.
    let mut solvers = Vec::with_capacity(runs.len());
    for (variant, needed) in runs {
        let many = needed.count().min(1 + TIMED);
        let make = |count| solver(scene(variant), variant, count);
        solvers.push([make(1)?, make(many)?]);
    }
    let mut best = vec![[Real::INFINITY; 2]; runs.len()];
    for _ in 0..=ROUNDS {
        for ((solvers, best), (variant, _)) in solvers.iter_mut().zip(&mut best).zip(runs) {
            let scene = scene(variant);
            for (solver, best) in solvers.iter_mut().zip(best) {
                let mut state = state.clone();
                let input = StepInput::new(scene.dt).gravity(scene.gravity);
                *best = best.min(timed(|| solver.step(&mut state, input))?);
            }
        }
    }
    Ok(runs
        .iter()
        .zip(best)
        .map(|((_, needed), [one, many])| {
            let sweeps = needed.count();
            let timed = sweeps.min(1 + TIMED);
            if timed == 1 {
                return Time {
                    seconds: one,
                    per_sweep: one,
                };
            }
            let per_sweep = (many - one) / Real::from(timed - 1);
            Time {
                seconds: one + per_sweep * Real::from(sweeps - 1),
                per_sweep,
            }
        })
        .collect())
}

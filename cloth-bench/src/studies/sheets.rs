//! The cloth of a study that compares methods: the hanging sheet in some sizes, or a scene file of one's own.

use crate::scene::file;
use crate::studies::prelude::*;
use crate::yardstick::{Sample, StepProblem};
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

/// Spring stiffness (N/m) of the scene `hang`, if it is not set.
pub const STIFFNESS: Real = 1e4;

/// Settings of the scene `hang` with so many vertices a side, and with springs of so many N/m.
pub fn hanging(n: u32, stiffness: Real) -> Settings {
    let settings = Settings::default();
    settings.with("n", n).with("stiffness", stiffness)
}

/// The steps that [`sixteenth_step`] has found.
static FOUND: Mutex<Vec<(Settings, Arc<StepProblem>)>> = Mutex::new(Vec::new());

/// The sixteenth step of the scene `hang` with some settings. Several studies look at it, and on a large sheet Newton's
/// method takes a minute to get there, so it is kept.
pub fn sixteenth_step(settings: &Settings) -> Result<Arc<StepProblem>, BenchError> {
    // Whoever panicked while holding it had not touched it yet, or had finished.
    let found = || FOUND.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((_, problem)) = found().iter().find(|(known, _)| known == settings) {
        return Ok(Arc::clone(problem));
    }
    let scene = scene::build("hang", None, settings)?;
    let problem = Arc::new(StepProblem::after(&scene, 15, scene.dt)?);
    found().push((settings.clone(), Arc::clone(&problem)));
    Ok(problem)
}

/// Traces a step with a solver that has taken one, the first of the scene under `gravity` (m/s²): what is done once,
/// such as the matrix of projective dynamics, an analysis or coarse levels, has been done. Without gravity a method
/// that looks at its gradient has nothing else to do.
pub(super) fn trace_warm(
    scene: &Scene,
    gravity: Vec3,
    problem: &StepProblem,
    solver: &mut dyn Stepper,
) -> Result<Vec<Sample>, BenchError> {
    let input = StepInput::new(scene.dt).gravity(gravity);
    solver.step(&mut scene.start.clone(), input)?;
    problem.trace(solver)
}

/// A cloth to compare methods on.
#[derive(Debug)]
pub(super) struct TestSheet {
    /// What it is called in sentences: `33 × 33`, or the name of the scene.
    pub(super) name: String,
    /// The same in a column of sizes.
    pub(super) size: Cell,
    /// The same in names of files.
    pub(super) file: String,
    /// Whether it is a scene of one's own.
    pub(super) is_own: bool,
    pub(super) scene: Scene,
    /// Of the hanging sheet.
    settings: Option<Settings>,
}

impl TestSheet {
    /// The hanging sheet with so many vertices a side, or the scene that the run was started with.
    pub(super) fn of_study(cases: &Cases<'_>, sides: &[u32]) -> Result<Vec<Self>, BenchError> {
        if let Some(path) = cases.own_scene() {
            return Ok(vec![Self::own(path)?]);
        }
        sides.iter().map(|&n| Self::hanging(n)).collect()
    }

    fn hanging(n: u32) -> Result<Self, BenchError> {
        let settings = hanging(n, STIFFNESS);
        Ok(Self {
            name: format!("{n} × {n}"),
            size: Cell::from(n as usize),
            file: n.to_string(),
            is_own: false,
            scene: scene::build("hang", None, &settings)?,
            settings: Some(settings),
        })
    }

    /// The scene of a file; none with contact, air or moving pins, with which the references cannot be compared.
    pub(super) fn own(path: &Path) -> Result<Self, BenchError> {
        let scene = file::build(path, &Settings::default())?;
        if !scene.is_plain() {
            return Err(BenchError::Usage(format!(
                "{}: this scene has contact, air or moving pins, with which the references of the studies cannot be compared",
                path.display()
            )));
        }
        let letters = scene.name.chars();
        Ok(Self {
            name: scene.name.to_owned(),
            size: Cell::from(scene.name),
            // Names of scenes may have blanks and slashes, those of files better not.
            file: letters
                .map(|c| if c.is_alphanumeric() { c } else { '-' })
                .collect(),
            is_own: true,
            scene,
            settings: None,
        })
    }

    /// Its sixteenth step.
    pub(super) fn sixteenth_step(&self) -> Result<Arc<StepProblem>, BenchError> {
        match &self.settings {
            Some(settings) => sixteenth_step(settings),
            None => Ok(Arc::new(StepProblem::after(
                &self.scene,
                15,
                self.scene.dt,
            )?)),
        }
    }

    /// What it is, as a part of a sentence.
    pub(super) fn what(&self) -> String {
        if self.is_own {
            format!("the scene `{}`", self.name)
        } else {
            "the hanging sheet".into()
        }
    }

    /// What it is, with its size.
    pub(super) fn which(&self) -> String {
        if self.is_own {
            self.what()
        } else {
            format!("the {} sheet", self.name)
        }
    }
}

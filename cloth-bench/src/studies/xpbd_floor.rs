//! How far converged XPBD is from the implicit Euler step, against the step size.

use crate::studies::prelude::*;
use crate::yardstick::StepProblem;
use cloth_core::cloth::Elements;
use cloth_core::method::position_based::Sweep;
use cloth_xpbd::direct::{DirectConfig, DirectXpbd};
use cloth_xpbd::{XpbdConfig, XpbdSolver};

pub(super) const STUDY: Study = Study {
    name: "xpbd-floor",
    question: "How far from the implicit Euler step does XPBD end when its sweeps have converged, and how does that depend on the step size?",
    about: "A chain of ten links of 0.1 m and 0.1 kg, let go sideways; the step is the one after 0.3 s of implicit Euler with the same step size. The reference is Newton's \
        method to rounding; the error is (G − G*)/(G(x̃) − G*) and ‖∇G‖/‖∇G(x̃)‖. The sweeps make C + α̃λ zero, with the gradients of the places where each correction \
        was made; the direct solver keeps the equation of the positions and ends at the reference. Expect the floor to fall with the step and no number of sweeps to change it; what surprises is that with long steps the stiffer chain has the lower floor. `order` is that of the line above it to this one.",
    run,
};

/// Links of the chain, and sweeps: a stiff chain of N links keeps cos²(π/2N) of its error per sweep, so this leaves
/// rounding.
const LINKS: u32 = 10;
const SWEEPS: u32 = 8000;
/// When the step is taken (s).
const TIME: Real = 0.3;

/// Steps per second.
fn rates(scope: Scope) -> &'static [u32] {
    scope.pick(&[30, 60, 120, 240], &[30, 60, 120, 240, 480, 960, 1920])
}

/// Stiffness of the links (N/m).
const STIFFNESSES: [Real; 2] = [200.0, 1e4];

/// A chain of this stiffness and a step.
#[derive(Default, Serialize)]
struct Point {
    #[serde(rename = "stiffness (N/m)")]
    stiffness: Real,
    steps_per_second: u32,
}

impl Point {
    fn dt(&self) -> Real {
        1.0 / Real::from(self.steps_per_second)
    }
}

/// What the sweeps leave, and the direct solver.
#[derive(Default, Serialize, Deserialize)]
struct Floor {
    #[serde(rename = "sweeps: objective error")]
    objective: Real,
    /// Found when the line above is known.
    order: Option<Real>,
    #[serde(rename = "sweeps: gradient error")]
    gradient: Real,
    #[serde(rename = "sweeps: largest C + α̃λ (m)")]
    residual: Real,
    #[serde(rename = "direct: objective error")]
    direct_objective: Real,
    #[serde(rename = "direct: gradient error")]
    direct_gradient: Real,
}

fn run(study: &mut StudyRun<'_>) -> Result<(), BenchError> {
    let rates = rates(study.scope);
    let of_stiffness = |stiffness| {
        rates.iter().map(move |&steps_per_second| Point {
            stiffness,
            steps_per_second,
        })
    };
    let mut rows = study.grid(
        STIFFNESSES.into_iter().flat_map(of_stiffness),
        |point| {
            format!(
                "k = {} N/m, 1/{} s",
                point.stiffness, point.steps_per_second
            )
        },
        |point| {
            let settings = format!(
                "n={LINKS} link=0.1 mass=0.1 tip_mass=0.1 stiffness={}",
                point.stiffness
            );
            floor(
                &scene::build("chain", None, &Settings::of(&settings))?,
                point.dt(),
            )
        },
    );
    for line in 1..rows.len() {
        let [(before, above), (point, floor)] = &rows[line - 1..=line] else {
            continue;
        };
        if before.stiffness == point.stiffness {
            let order = (above.objective / floor.objective).ln() / (before.dt() / point.dt()).ln();
            rows[line].1.order = Some(order);
        }
    }
    let falls = STIFFNESSES.into_iter().filter_map(|k| {
        let ours = || rows.iter().filter(|(point, _)| point.stiffness == k);
        let ((first, floor), (last, least)) = (ours().next()?, ours().next_back()?);
        Some(format!(
            "with k = {k} N/m {:.1e} with steps of {:.4} s and {:.1e} with {:.5} s",
            floor.objective,
            first.dt(),
            least.objective,
            last.dt()
        ))
    });
    let falls = format!(
        "Converged sweeps of XPBD do not end at the implicit Euler step: what is left of the objective is {}.",
        falls.collect::<Vec<_>>().join(", and ")
    );
    study
        .findings
        .answer("What does XPBD's floor cost?", falls.clone());
    study.findings.section.verdict =
        Some(falls + " The direct solver of the same constraints ends at the step.");
    study.findings.table(
        "xpbd-floor",
        "Converged sweeps of XPBD and the direct solver beside the implicit Euler step",
        Table::of(&rows),
    );
    let both = rows.iter().flat_map(|(point, floor)| {
        [("objective", floor.objective), ("gradient", floor.gradient)].map(|(name, error)| {
            (
                format!("{name}, k = {}", point.stiffness),
                (point.dt(), error),
            )
        })
    });
    let plot = Plot::new(
        "What converged sweeps leave of the implicit Euler step",
        Axis::log("step size (s)"),
        Axis::log("relative error (dimensionless)"),
    );
    study
        .findings
        .plot("xpbd-floor", &plot.with(curves(both, |point| point)));
    Ok(())
}

fn floor(scene: &Scene, dt: Real) -> Result<Floor, BenchError> {
    let problem = StepProblem::after(scene, (TIME / dt).round() as u32, dt)?;
    let model = &scene.model;
    let mut sweeps = XpbdSolver::builder(&model.particles)
        .elements(vec![Elements::Springs(model.springs.clone())])
        .config(XpbdConfig {
            iterations: SWEEPS,
            substeps: 1,
            sweep: Sweep::Sequential,
            ..XpbdConfig::default()
        })
        .build()?;
    let mut direct = DirectXpbd::builder(&model.particles)
        .elements(vec![Elements::Springs(model.springs.clone())])
        .config(DirectConfig {
            tolerance: 1e-13,
            ..DirectConfig::default()
        })
        .build()?;
    let mut state = problem.state().clone();
    let input = StepInput::new(dt).gravity(scene.gravity);
    sweeps.step(&mut state, input)?;
    let (swept, direct) = (
        problem.error(&state.positions),
        problem.solve(&mut direct)?.0,
    );
    Ok(Floor {
        objective: swept.objective,
        order: None,
        gradient: swept.gradient,
        residual: sweeps.compliance_residual(&state.positions),
        direct_objective: direct.objective,
        direct_gradient: direct.gradient,
    })
}

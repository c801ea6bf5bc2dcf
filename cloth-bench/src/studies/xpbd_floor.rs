//! How far converged XPBD is from the implicit Euler step, against the step size.

use crate::studies::prelude::*;
use crate::yardstick::{StepError, StepProblem};
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

/// One step size: what the sweeps leave of C + α̃λ (m), and both errors.
#[derive(Default, Serialize, Deserialize)]
struct Floor {
    residual: Real,
    sweeps: StepError,
    direct: StepError,
}

fn run(study: &mut StudyRun<'_>) -> Result<(), BenchError> {
    let scope = study.scope;
    let mut table = Table::new(&[
        "stiffness (N/m)",
        "steps per second",
        "sweeps: objective error",
        "order",
        "sweeps: gradient error",
        "sweeps: largest C + α̃λ (m)",
        "direct: objective error",
        "direct: gradient error",
    ]);
    let mut series = Vec::new();
    let mut falls = Vec::new();
    for stiffness in STIFFNESSES {
        let settings = Settings::of(&format!(
            "n={LINKS} link=0.1 mass=0.1 tip_mass=0.1 stiffness={stiffness}"
        ));
        let scene = scene::build("chain", None, &settings)?;
        let (mut points, mut gradients) = (Vec::new(), Vec::new());
        let mut before = None;
        for &rate in rates(scope) {
            let dt = 1.0 / Real::from(rate);
            let case = format!("k = {stiffness} N/m, 1/{rate} s");
            let Some(floor) = study.case(&case, || floor(&scene, dt)) else {
                continue;
            };
            let objective = floor.sweeps.objective;
            let order = before
                .map(|(larger, error): (Real, Real)| (error / objective).ln() / (larger / dt).ln());
            before = Some((dt, objective));
            table.push([
                Cell::from(stiffness),
                Cell::from(rate as usize),
                Cell::from(objective),
                order.map_or(Cell::Missing, Cell::from),
                Cell::from(floor.sweeps.gradient),
                Cell::from(floor.residual),
                Cell::from(floor.direct.objective),
                Cell::from(floor.direct.gradient),
            ]);
            points.push((dt, objective));
            gradients.push((dt, floor.sweeps.gradient));
        }
        if let (Some(first), Some(last)) = (points.first(), points.last()) {
            falls.push(format!(
                "with k = {stiffness} N/m {:.1e} with steps of {:.4} s and {:.1e} with {:.5} s",
                first.1, first.0, last.1, last.0
            ));
        }
        series.push(Series::new(&format!("objective, k = {stiffness}"), points));
        series.push(Series::new(
            &format!("gradient, k = {stiffness}"),
            gradients,
        ));
    }
    let falls = format!(
        "Converged sweeps of XPBD do not end at the implicit Euler step: what is left of the objective is {}.",
        falls.join(", and ")
    );
    study
        .findings
        .answer("What does XPBD's floor cost?", falls.clone());
    study.findings.section.verdict =
        Some(falls + " The direct solver of the same constraints ends at the step.");
    study.findings.table(
        "xpbd-floor",
        "Converged sweeps of XPBD and the direct solver beside the implicit Euler step",
        table,
    );
    study.findings.plot(
        "xpbd-floor",
        &Plot {
            title: "What converged sweeps leave of the implicit Euler step".into(),
            x: Axis::log("step size (s)"),
            y: Axis::log("relative error (dimensionless)"),
            series,
            note: String::new(),
        },
    );
    Ok(())
}

fn floor(scene: &Scene, dt: Real) -> Result<Floor, BenchError> {
    let problem = StepProblem::after(scene, (TIME / dt).round() as u32, dt)?;
    let model = &scene.model;
    let mut sweeps = XpbdSolver::builder(&model.particles)
        .energy(model.springs.clone())
        .config(XpbdConfig {
            iterations: SWEEPS,
            substeps: 1,
            sweep: Sweep::Sequential,
            ..XpbdConfig::default()
        })
        .build()?;
    let mut direct = DirectXpbd::builder(&model.particles)
        .energy(model.springs.clone())
        .config(DirectConfig {
            tolerance: 1e-13,
            ..DirectConfig::default()
        })
        .build()?;
    let mut state = problem.state().clone();
    let input = StepInput::new(dt).gravity(scene.gravity);
    sweeps.step(&mut state, input)?;
    Ok(Floor {
        residual: sweeps.compliance_residual(&state.positions),
        sweeps: problem.error(&state.positions),
        direct: problem.solve(&mut direct)?.0,
    })
}

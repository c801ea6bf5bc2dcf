//! How stiff a material is as simulated, against iterations and step size.

use crate::laws::{Stretched, fixed_projection};
use crate::studies::prelude::*;
use cloth_core::cloth::ClothModel;

pub(super) const STUDY: Study = Study {
    name: "stiffness",
    question: "Is the stiffness that a method shows the one that was asked for, or does it depend on iterations and step size?",
    about: "One constraint: a mass of 1 kg on a spring of 100 N/m, one step; the stiffness follows from how much of the stretch is left. \
        The dashed curves are ((1 − s)⁻ⁿ − 1)/(Δt² w) for PBD with a fixed projection s, and k. The chain: 20 links of 1 kg and 1e4 N/m hang at rest, and the stretch \
        of the whole chain is compared with n(n + 1)mg/2k. There the methods that are exact for one constraint part company: a sweep \
        carries a force one link further, so few iterations leave the chain soft. PBD from the material stays soft however many there are: each projection is stiff \
        against a mass that moves alone, not against one that its neighbours hold.",
    run,
};

/// Stiffness of the spring (N/m) in the one-constraint measurements.
const STIFFNESS: Real = 100.0;
const FIXED: [Real; 3] = [0.1, 0.5, 0.9];
/// Methods on the chain, and what their effort is called.
fn on_chain() -> impl Iterator<Item = (&'static str, &'static str)> {
    [
        ("pbd", "iterations"),
        ("xpbd", "iterations"),
        ("xpbd", "substeps"),
        ("pd", "iterations"),
    ]
    .into_iter()
    .chain(iterating_own().map(|own| (own.name, "iterations")))
}

const EFFORTS: [&[u32]; 2] = [
    &[1, 2, 4, 8, 16, 32, 64, 128],
    &[
        1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128, 256, 512, 1024,
    ],
];

const STEP_SIZES: [Real; 7] = [1e-3, 2e-3, 5e-3, 1e-2, 2e-2, 5e-2, 1e-1];

fn run(study: &mut StudyRun<'_>) -> Result<(), BenchError> {
    let dt = 1e-2;
    let efforts = study.scope.of(EFFORTS)[..8].iter();
    let by_iterations = efforts.map(|&n| (Real::from(n), n, dt)).collect_vec();
    let stiffness = Axis::log("effective stiffness (N/m)").within(1.0, 1e10);
    let title = "Stiffness of one constraint against iterations, Δt = 0.01 s";
    let iterations = Axis::log("iterations per step (dimensionless)");
    let plot = Plot::new(title, iterations, stiffness.clone()).note(
        "Dashed: the closed forms. PBD with a fixed projection s has no stiffness of its own.",
    );
    let mut rows = one_constraint(study, "iterations", &by_iterations, plot);
    let title = "Stiffness of one constraint against step size, 4 iterations";
    let plot = Plot::new(title, Axis::log("Δt (s)"), stiffness);
    let by_step = STEP_SIZES.map(|dt| (dt, 4, dt));
    rows.extend(one_constraint(study, "dt", &by_step, plot));
    study.data("stiffness-one-constraint", &rows);
    // Where rounding leaves six digits.
    let is_exact = |row: &&Row| Stretched::rounding(row.closed_form, row.dt) < 1e-6;
    let exact = rows.iter().filter(is_exact);
    let errors = exact.map(|row| (row.stiffness / row.closed_form - 1.0).abs());
    let worst = errors.fold(0.0, Real::max);
    chain(study, worst)
}

/// What is measured on one constraint: a variant, and s where the projection is fixed.
fn on_one_constraint() -> Vec<(Variant, Option<Real>)> {
    let fixed = FIXED.into_iter().flat_map(|s| {
        let variant = Variant::list(&format!("pbd, s = {s}: projection={s}"));
        variant.into_iter().map(move |variant| (variant, Some(s)))
    });
    let exact = Variant::list(
        "pbd
        xpbd: substeps=1
        pd
        implicit-euler: tolerance=0",
    );
    let own = iterating_own().map(Variant::uncut);
    let exact = exact.into_iter().chain(own);
    fixed.chain(exact.map(|variant| (variant, None))).collect()
}

/// A method on one constraint.
#[derive(Default, Serialize)]
struct Row {
    method: String,
    iterations: u32,
    #[serde(rename = "dt (s)")]
    dt: Real,
    #[serde(rename = "effective stiffness (N/m)")]
    stiffness: Real,
    #[serde(rename = "closed form (N/m)")]
    closed_form: Real,
}

/// One constraint at some points `(x, iterations, Δt)`, drawn against x beside the closed forms.
fn one_constraint(
    study: &mut StudyRun<'_>,
    against: &str,
    points: &[(Real, u32, Real)],
    plot: Plot,
) -> Vec<Row> {
    let case = format!("one constraint against {against}");
    let measured = study.case(&case, || measure(points)).unwrap_or_default();
    let (mut rows, mut shown, mut exact) = (Vec::new(), Vec::new(), Vec::new());
    for ((variant, fixed), measured) in on_one_constraint().into_iter().zip(measured) {
        let law = |n: u32, dt: Real| fixed.map_or(STIFFNESS, |s| fixed_projection(s, n, dt));
        let label = &variant.label;
        let found = || points.iter().zip(&measured);
        let points_shown = found().map(|(&(x, ..), k)| (x, k.0));
        shown.push(Series::new(label, points_shown.collect()));
        if fixed.is_some() {
            let curve = points.iter().map(|&(x, n, dt)| (x, law(n, dt)));
            exact.push(Series::new(&format!("{label}, exact"), curve.collect()));
        }
        rows.extend(found().map(|(&(_, iterations, dt), stiffness)| Row {
            method: label.clone(),
            iterations,
            dt,
            stiffness: stiffness.0,
            closed_form: law(iterations, dt),
        }));
    }
    let k = points.iter().map(|&(x, ..)| (x, STIFFNESS));
    let plot = plot.points(shown).exact_curves(exact).exact("k, exact", k);
    study.plot(&format!("stiffness-{against}"), &plot);
    rows
}

/// Stiffness (N/m) that every method shows at some points `(x, iterations, Δt)`, in the order of [`on_one_constraint`].
fn measure(points: &[(Real, u32, Real)]) -> Result<Vec<Vec<Number>>, BenchError> {
    let stretched = Stretched::new(STIFFNESS)?;
    let model = ClothModel {
        particles: stretched.particles.clone(),
        springs: vec![stretched.spring],
        hinges: Vec::new(),
        others: Vec::new(),
    };
    let positions = vec![Vec3::zeros(), Vec3::x()];
    let scene = Scene::new("chain", model, positions, None, Vec3::zeros());
    let measure = |(variant, _): (Variant, Option<Real>)| {
        let at = |&(_, iterations, dt): &(Real, u32, Real)| {
            let settings = variant.settings.clone().with("iterations", iterations);
            let mut solver = Method::find(variant.method())?.build(&scene, &settings, dt)?;
            stretched.effective_stiffness(&mut *solver, dt).map(Number)
        };
        points.iter().map(at).collect()
    };
    on_one_constraint().into_iter().map(measure).collect()
}

const LINKS: u32 = 20;
const CHAIN_STIFFNESS: Real = 1e4;

/// What is told of a chain at rest, or still moving after the last step.
const CHAIN: [&str; 7] = [
    "method",
    "effort",
    "count",
    "stretch of the chain (m)",
    "exact (m)",
    "stiffness / k",
    "steps to rest",
];

fn chain(study: &mut StudyRun<'_>, worst: Real) -> Result<(), BenchError> {
    let settings = format!("n={LINKS} link=1 mass=1 tip_mass=1 stiffness={CHAIN_STIFFNESS}");
    let mut scene = scene::build("chain", None, &Settings::of(&settings))?;
    for p in &mut scene.start.positions {
        *p = Vec3::new(0.0, 0.0, -p.x);
    }
    let n = Real::from(LINKS);
    let exact = n * (n + 1.0) * 9.81 / (2.0 * CHAIN_STIFFNESS);
    let efforts = study.scope.of(EFFORTS);
    let found = study.grid(
        iproduct!(on_chain(), efforts.iter().copied()),
        |((name, effort), count)| format!("chain, {name} with {count} {effort}"),
        |&((name, effort), count)| {
            let settings = match effort {
                "substeps" => format!("substeps={count} iterations=1"),
                _ if ["pbd", "xpbd"].contains(&name) => format!("substeps=1 iterations={count}"),
                _ => format!("iterations={count}"),
            };
            let settings = Settings::of(&settings);
            at_rest(
                &scene,
                &mut *Method::find(name)?.build(&scene, &settings, scene.dt)?,
            )
        },
    );
    let row = |&(at, (stretch, steps)): &(_, (Real, Option<u32>))| {
        let steps = steps.map_or("not at rest".into(), |steps| Cell::Int(steps.into()));
        (at, [stretch, exact, exact / stretch], steps)
    };
    let rows = found.iter().map(row).collect_vec();
    let at_rest = || {
        let at_rest = found.iter().filter(|(_, (_, steps))| steps.is_some());
        at_rest.map(|&(((method, effort), count), (stretch, _))| {
            (method, effort, count, exact / stretch)
        })
    };
    let series = curves(at_rest(), |(method, effort, count, shown)| {
        (format!("{method}, {effort}"), (Real::from(count), shown))
    });
    let plot = Plot::new(
        "Stiffness of a hanging chain of 20 links against effort, Δt = 1/60 s",
        Axis::log("iterations or substeps per step (dimensionless)"),
        Axis::log("stiffness shown / k (dimensionless)"),
    )
    .with(series)
    .exact(
        "asked for",
        efforts.iter().map(|&count| (Real::from(count), 1.0)),
    )
    .note("Implicit Euler solved to tolerance lies on the dashed line (law hanging-chain).");
    study.plot("stiffness-chain", &plot);
    let table = Table::named(&CHAIN, &rows);
    study.table("stiffness-chain", "A hanging chain at rest", table);
    let single = if worst < 1e-6 {
        "One constraint alone follows its closed form"
    } else {
        "One constraint alone does NOT follow its closed form everywhere"
    };
    let mut told =
        at_rest()
            .filter(|(.., count, _)| *count == 16)
            .map(|(method, effort, _, shown)| {
                format!("{method} with 16 {effort} shows {shown:.3} of k")
            });
    study.section.verdict = Some(format!(
        "{single} (largest distance {worst:.1e}): only PBD with a fixed projection depends on iterations and step size.\nThe stiffness is k at any iteration count and step size for XPBD, PD, implicit Euler, and PBD with the projection made from \
         the material; for PBD with a fixed projection a stiffness that grows by orders of magnitude with iterations and with smaller steps. A chain \
         of 20 links at rest: {}.",
        told.join("; ")
    ));
    Ok(())
}

/// Stretch (m) of the chain when nothing moves any more, and the steps that took; `None` if it still moved after the
/// last.
fn at_rest(scene: &Scene, solver: &mut dyn Stepper) -> Result<(Real, Option<u32>), BenchError> {
    let mut state = scene.start.clone();
    let steps = run::to_rest(scene, solver, &mut state, scene.dt, 6000, 1e-8)?;
    let last = state.positions.len() - 1;
    Ok((-state.positions[last].z - Real::from(LINKS), steps))
}

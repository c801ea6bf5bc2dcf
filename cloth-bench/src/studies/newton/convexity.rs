//! What is done about negative eigenvalues: Newton's method on one vertex between two compressed springs, where one can
//! see it, and on sheets.

use crate::studies::prelude::*;
use crate::studies::sheets::{STIFFNESS, hanging};
use crate::yardstick::{Sample, StepProblem};
use cloth_core::element::{Convexity, Energy};
use cloth_core::energy::Spring;
use cloth_core::math::Mat3;
use cloth_core::method::linear::LinearMethod;
use cloth_massspring::{HessianPolicy, ImplicitConfig, ImplicitEuler, Solve};

const DT: Real = 1.0 / 60.0;
/// Half the distance of the ends and rest length of either spring (m), its stiffness (N/m), and the mass (kg) between.
const HALF: Real = 0.09;
const LENGTH: Real = 0.1;
const K: Real = 1e3;
const MASS: Real = 0.01;
/// Where Newton's method starts (m from the middle).
const START: Real = 2e-3;

/// What is made of the Hessian of a spring, and what that is called.
pub const POLICIES: [(&str, Convexity); 4] = [
    ("none (exact)", Convexity::Exact),
    ("clamp", Convexity::Clamp),
    ("absolute", Convexity::Abs),
    ("Gauss–Newton", Convexity::GaussNewton),
];

/// Two springs that are too long for the distance of their ends, with those: `G` of a step of the vertex between them
/// that starts at rest in the middle has a saddle point there, and a minimum on either side.
fn springs() -> [(Spring, Vec3); 2] {
    let spring = Spring {
        vertices: [0, 1],
        rest_length: LENGTH,
        stiffness: K,
    };
    [-HALF, HALF].map(|x| (spring, x * Vec3::x()))
}

/// `G` (J) at `y` (m) from the middle.
pub fn value(y: Real) -> Real {
    let elastic = springs().map(|(spring, end)| spring.value(&[end, y * Vec3::y()]));
    0.5 * MASS * y * y / (DT * DT) + elastic.iter().sum::<Real>()
}

/// Where the minima are (m from the middle): the springs as long as inertia lets them be.
pub fn minimum() -> Real {
    let length = LENGTH / (1.0 + MASS / (2.0 * K * DT * DT));
    (length * length - HALF * HALF).sqrt()
}

/// Places (m from the middle) of Newton's method with full steps.
pub fn newton(convexity: Convexity) -> Vec<Real> {
    let inertia = MASS / (DT * DT);
    let next = |x: &Vec3| {
        let (mut gradient, mut hessian) = (inertia * x, inertia * Mat3::identity());
        for (spring, end) in springs() {
            let (of_spring, block) = spring.at_corner(&[end, *x], 1, convexity);
            gradient += of_spring;
            hessian += block;
        }
        Some(x - hessian.try_inverse()? * gradient)
    };
    let places = std::iter::successors(Some(START * Vec3::y()), next);
    places.take(21).map(|x| x.y).collect()
}

/// Draws the energy of the one vertex and what each policy makes of it.
fn one_vertex(findings: &mut Findings) -> String {
    let (rest, middle) = (minimum(), value(0.0));
    let at = |y: Real| (1e3 * y, 1e3 * (value(y) - middle));
    let energy = (-60..=60).map(|mm| at(1e-3 * Real::from(mm)));
    let mark = |label: &str, y: &[Real]| Series::new(label, y.iter().map(|&y| at(y)).collect());
    let plot = Plot::new(
        "One step of a vertex between two compressed springs",
        Axis::linear("displacement sideways (mm)"),
        Axis::linear("G above the straight springs (mJ)"),
    )
    .with([Series::new("G", energy.collect()).styled(Style::Line)])
    .points([mark("two minima", &[-rest, rest]), mark("saddle point", &[0.0])])
    .note("Both minima solve the step, and so does the straight line between them, where ∇G = 0 too: which one a solver ends at depends on where it starts and on what it does about negative eigenvalues.");
    findings.plot("newton-two-minima", &plot);
    let traces = POLICIES.map(|(label, convexity)| (label, newton(convexity)));
    let plot = Plot::new(
        "Newton's method beside a saddle point, full steps",
        Axis::linear("iterations (dimensionless)"),
        Axis::linear("displacement sideways (mm)").within(-5.0, 45.0),
    )
    .with(traces.iter().map(|(label, places)| {
        let points = places.iter().take(13).enumerate();
        Series::new(label, points.map(|(i, &y)| (i as Real, 1e3 * y)).collect())
    }))
    .exact("minimum", [(0.0, 1e3 * rest), (12.0, 1e3 * rest)])
    .exact("saddle point", [(0.0, 0.0), (12.0, 0.0)])
    .note("Across a compressed spring the Hessian is negative. As it is, Newton's method climbs to the saddle point; without the negative part it goes down, by as much as inertia alone allows; with its absolute value it goes down in shorter steps.");
    findings.plot("newton-saddle", &plot);
    let mut told = traces.iter().map(|(label, places)| {
        let near = |goal: Real| places.last().is_some_and(|y| (y - goal).abs() < 1e-6);
        let there = match (near(0.0), near(rest)) {
            (true, _) => "the saddle point",
            (_, true) => "a minimum",
            _ => "neither in 20 iterations",
        };
        format!("{label} to {there}")
    });
    format!(
        "One vertex between compressed springs, {} mm beside the saddle point, goes with negative eigenvalues by {}.",
        1e3 * START,
        told.join(", ")
    )
}

/// A sheet whose step is taken, what is done about negative eigenvalues, and how Newton's method gets on. The error is
/// that of the last iteration: below 0 in a lower minimum than that of the reference.
const COLUMNS: [&str; 6] = [
    "sheet",
    "negative eigenvalues",
    "iterations to a gradient of 1e-3",
    "iterations to a gradient of 1e-8",
    "objective error",
    "remark",
];

/// Iterations and their errors; none, and why, where the matrix was of no use.
pub type Traced = (Vec<Sample>, String);

const SHEETS: [&str; 2] = ["hanging", "compressed"];

/// Takes the sixteenth step of the hanging sheet, or the first of one that is pressed together by a tenth.
pub fn take(sheet: &str, side: u32, hessian: HessianPolicy) -> Result<Traced, BenchError> {
    let mut scene = scene::build("hang", None, &hanging(side, STIFFNESS))?;
    let mut steps = 15;
    if sheet == "compressed" {
        steps = 0;
        let mut random = SplitMix64::new(1);
        for x in &mut scene.start.positions {
            *x = Vec3::new(0.9 * x.x, x.y, x.z + 1e-4 * random.symmetric());
        }
    }
    let problem = StepProblem::after(&scene, steps, scene.dt)?;
    let config = ImplicitConfig {
        solve: Solve::Newton,
        linear: LinearMethod::Cholesky,
        max_iterations: 300,
        tolerance: 0.0,
        hessian,
        ..Default::default()
    };
    let model = &scene.model;
    let builder = ImplicitEuler::builder(&model.particles).elements(model.families());
    let mut solver = builder.config(config).build()?;
    Ok(match problem.trace(&mut solver) {
        Ok(trace) => (trace, String::new()),
        Err(error) => {
            let told = error.to_string();
            let is_kept = matches!(hessian, HessianPolicy::Always(Convexity::Exact));
            // Here it is not for stiffness beside mass.
            let why = match told.split_once(" to rounding: ").filter(|_| is_kept) {
                Some((matrix, _)) => {
                    format!("{matrix}: negative eigenvalues of compressed springs are in it")
                }
                None => told,
            };
            (Vec::new(), why)
        }
    })
}

/// Measures and draws all, and says what comes of it.
pub(super) fn run(study: &mut StudyRun<'_>) -> String {
    let told = one_vertex(&mut study.findings);
    let side = study.scope.pick(16, 32);
    let blended = ("exact where it serves", HessianPolicy::ExactFirst);
    let always = POLICIES.map(|(label, convexity)| (label, HessianPolicy::Always(convexity)));
    let policies = || [blended].into_iter().chain(always);
    let found = study.grid_side_by_side(
        iproduct!(SHEETS, policies()),
        |(sheet, (policy, _))| format!("negative eigenvalues, {sheet}, {policy}"),
        |&(sheet, (_, hessian))| take(sheet, side, hessian),
    );
    for sheet in SHEETS {
        let of_sheet = found.iter().filter(|((of, _), _)| *of == sheet);
        let samples = of_sheet.flat_map(|((_, (policy, _)), (trace, _))| {
            trace.iter().map(|sample| (*policy, sample))
        });
        let curves = curves(samples, |(policy, sample)| {
            (
                policy,
                (Real::from(sample.iteration), sample.error.gradient),
            )
        });
        let plot = Plot::new(
            format!("What is done about negative eigenvalues: a {sheet} sheet, {side} × {side}"),
            Axis::log("iterations of Newton's method (dimensionless)"),
            Axis::log("‖∇G‖/‖∇G(x̃)‖ (dimensionless)"),
        );
        study.plot(&format!("newton-convexity-{sheet}"), &plot.with(curves));
    }
    let row = |((sheet, (policy, _)), (trace, remark)): ((_, (_, HessianPolicy)), Traced)| {
        let within = |goal: Real| {
            let sample = trace.iter().find(|sample| sample.error.gradient <= goal);
            sample.map(|sample| sample.iteration)
        };
        let end = trace.last().map(|sample| sample.error.objective);
        (sheet, policy, [1e-3, 1e-8].map(within), end, remark)
    };
    let rows = found.into_iter().map(row).collect_vec();
    let caption = format!(
        "Newton's method by what it does about negative eigenvalues, {side} × {side} vertices"
    );
    study.table("newton-convexity", &caption, Table::named(&COLUMNS, &rows));
    told
}

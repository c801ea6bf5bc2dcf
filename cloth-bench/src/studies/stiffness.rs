//! How stiff a material is as simulated, against iterations, step size and resolution.

use super::meshes_and_steps::range;
use crate::laws::{Stretched, fixed_projection};
use crate::studies::prelude::*;
use cloth_core::cloth::ClothModel;

pub(super) const STUDY: Study = Study {
    name: "stiffness",
    question: "Is the stiffness that a method shows the one that was asked for, or does it depend on iterations, step size and resolution?",
    about: "One constraint: a mass of 1 kg on a spring of 100 N/m, one step; the stiffness follows from how much of the stretch is left. \
        The dashed curves are ((1 − s)⁻ⁿ − 1)/(Δt² w) for PBD with a fixed projection s, and k. The chain: 20 links of 1 m, 1 kg and 1e4 N/m hang at rest, and the stretch \
        of the whole chain is compared with n(n + 1)mg/2k: with more and more effort, with every step, and of the same rope cut into fewer and more links, by every method at its published setting. There the methods that are exact for one constraint part company: a sweep \
        carries a force one link further, so few iterations leave the chain soft. With one iteration a substep PBD and XPBD are the same method, and both come to k with more substeps. With more iterations of one substep XPBD comes to k, and PBD from the material to another stiffness: each projection is stiff \
        against a mass that moves alone, not against one that its neighbours hold.",
    run,
};

/// Stiffness of the spring (N/m) in the one-constraint measurements.
const STIFFNESS: Real = 100.0;
const FIXED: [Real; 3] = [0.1, 0.5, 0.9];
/// Methods on the chain, and what their effort is called.
fn on_chain() -> impl Iterator<Item = (&'static str, &'static str)> {
    [
        ("implicit-euler", "iterations"),
        ("bdf2", "iterations"),
        ("pbd", "iterations"),
        ("pbd", "substeps"),
        ("xpbd", "iterations"),
        ("xpbd", "substeps"),
        ("xpbd-direct", "iterations"),
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

/// Steps per second, and links, of the chain.
const RATES: [&[u32]; 2] = [&[15, 60, 240], &[15, 30, 60, 120, 240, 480]];
const CUTS: [&[u32]; 2] = [&[5, 20, 40], &[5, 10, 20, 40, 80]];

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

/// Length (m) of the chain, which weighs as many kilograms, and its links where they do not change.
const LINKS: u32 = 20;
const CHAIN_STIFFNESS: Real = 1e4;
const RATE: u32 = 60;

/// A chain at rest by a method, and what is changed of it.
#[derive(Default, Serialize)]
struct Point {
    method: Variant,
    changed: &'static str,
    value: u32,
    links: u32,
    steps_per_second: u32,
}

impl Point {
    /// Every method with more and more effort, with every step, and with fewer and more links.
    fn all(scope: Scope) -> Vec<Self> {
        let point = |method, changed, value| Self {
            method,
            changed,
            value,
            links: LINKS,
            steps_per_second: RATE,
        };
        let efforts = iproduct!(on_chain(), scope.of(EFFORTS));
        let efforts = efforts.map(|((name, effort), &count)| {
            let settings = match effort {
                "substeps" => format!("substeps={count} iterations=1"),
                _ if ["pbd", "xpbd"].contains(&name) => format!("substeps=1 iterations={count}"),
                _ => format!("iterations={count}"),
            };
            let (label, settings) = (format!("{name}, {effort}"), Settings::of(&settings));
            point(Variant { label, settings }, "effort", count)
        });
        let published = || {
            let stable = method::all().filter(|method| !method.is_never_stable());
            stable.map(published)
        };
        let rates = iproduct!(published(), scope.of(RATES)).map(|(method, &rate)| Self {
            steps_per_second: rate,
            ..point(method, "steps per second", rate)
        });
        let cuts = iproduct!(published(), scope.of(CUTS)).map(|(method, &links)| Self {
            links,
            ..point(method, "links", links)
        });
        efforts.chain(rates).chain(cuts).collect()
    }
}

/// A method at its published setting, with drag (1/s) where it damps nothing and would never rest.
pub fn published(method: &Method) -> Variant {
    let mut variant = Variant::published(method);
    if ["symplectic-euler", "implicit-midpoint"].contains(&method.name) {
        variant.label.push_str(", with drag");
        variant.settings = Settings::of("air_drag=10");
    }
    variant
}

/// A rope of 20 m and 20 kg, cut into so many links, hangs by a method with so many steps per second.
pub fn hang(variant: &Variant, links: u32, steps_per_second: u32) -> Result<Hung, BenchError> {
    let link = Real::from(LINKS) / Real::from(links);
    let stiffness = CHAIN_STIFFNESS / link;
    let settings =
        format!("n={links} link={link} mass={link} tip_mass={link} stiffness={stiffness}");
    let mut scene = scene::build("chain", None, &Settings::of(&settings))?;
    for p in &mut scene.start.positions {
        *p = Vec3::new(0.0, 0.0, -p.x);
    }
    let dt = 1.0 / Real::from(steps_per_second);
    let method = Method::find(variant.method())?;
    let mut solver = method.build(&scene, &variant.settings, dt)?;
    let mut state = scene.start.clone();
    let steps = run::to_rest(&scene, &mut *solver, &mut state, dt, 6000, 1e-8)?;
    let n = Real::from(links);
    let exact = n * (n + 1.0) * link * 9.81 / (2.0 * stiffness);
    let stretch = -state.positions[links as usize].z - Real::from(LINKS);
    Ok(Hung {
        stretch: Number(stretch),
        exact: Number(exact),
        shown: steps.map(|_| Number(exact / stretch)),
        steps_to_rest: steps,
    })
}

/// A chain at rest, or what it was like after the last step.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Hung {
    #[serde(rename = "stretch of the chain (m)")]
    stretch: Number,
    #[serde(rename = "exact (m)")]
    exact: Number,
    /// None if it does not come to rest.
    #[serde(rename = "stiffness / k")]
    pub shown: Option<Number>,
    steps_to_rest: Option<u32>,
}

fn chain(study: &mut StudyRun<'_>, worst: Real) -> Result<(), BenchError> {
    let rows = study.grid_side_by_side(
        Point::all(study.scope),
        |point| {
            format!(
                "chain, {}, {} {}",
                point.method.label, point.value, point.changed
            )
        },
        |point| hang(&point.method, point.links, point.steps_per_second),
    );
    let shown = |changed: &'static str| {
        let of = rows
            .iter()
            .filter(move |(point, _)| point.changed == changed);
        of.filter_map(|(point, hung)| Some((&*point.method.label, point.value, hung.shown?.0)))
    };
    for (changed, name, title, x) in [
        (
            "effort",
            "stiffness-chain",
            "of 20 links against effort, Δt = 1/60 s",
            "iterations or substeps per step (dimensionless)",
        ),
        (
            "steps per second",
            "stiffness-chain-step",
            "of 20 links against the step",
            "steps per second (1/s)",
        ),
        (
            "links",
            "stiffness-chain-links",
            "of 20 m against resolution, Δt = 1/60 s",
            "links (dimensionless)",
        ),
    ] {
        let series = curves(shown(changed), |(label, x, shown)| {
            (label, (Real::from(x), shown))
        });
        let all = rows.iter().filter(|(point, _)| point.changed == changed);
        let values = all.map(|(point, _)| point.value).sorted().dedup();
        let asked = values.map(|x| (Real::from(x), 1.0));
        let y = Axis::log("stiffness shown / k (dimensionless)");
        let plot = Plot::new(
            format!("Stiffness of a hanging chain {title}"),
            Axis::log(x),
            y,
        );
        study.plot(name, &plot.with(series).exact("asked for", asked));
    }
    study.table("stiffness-chain", "A hanging chain at rest", &rows);
    let single = if worst < 1e-6 {
        "One constraint alone follows its closed form"
    } else {
        "One constraint alone does NOT follow its closed form everywhere"
    };
    let sixteen = shown("effort").filter(|(_, count, _)| *count == 16);
    let mut sixteen = sixteen.map(|(label, _, shown)| format!("{label} {shown:.3}"));
    let ranges = |changed| {
        let all = curves(shown(changed), |(label, x, shown)| {
            (label, (Real::from(x), shown))
        });
        let told = all.iter().map(|curve| {
            let range = range(curve.points.iter().map(|(_, shown)| *shown));
            format!("{} {range}", curve.label)
        });
        told.collect_vec().join(", ")
    };
    // The largest number that both were asked for.
    let ends = ["substeps", "iterations"].map(|effort| {
        ["pbd", "xpbd"].map(|name| {
            let label = format!("{name}, {effort}");
            let own = shown("effort").filter(|(of, ..)| **of == *label);
            own.max_by_key(|(_, count, _)| *count)
                .map(|(_, count, shown)| (count, format!("{shown:.3}")))
        })
    });
    let ends = match ends {
        [
            [Some((substeps, pbd_cut)), Some((_, xpbd_cut))],
            [Some((iterations, pbd)), Some((_, xpbd))],
        ] => {
            format!(
                " With {substeps} substeps of one iteration PBD shows {pbd_cut} and XPBD {xpbd_cut} of k, with {iterations} iterations of one substep PBD {pbd} and XPBD {xpbd}."
            )
        }
        _ => String::new(),
    };
    study.section.verdict = Some(format!(
        "{single} (largest distance {worst:.1e}): there only PBD with a fixed projection depends on iterations and step size. In a chain whatever sweeps does.{ends}\nFor one constraint the stiffness is k at any iteration count and step size for XPBD, PD, implicit Euler, and PBD with the projection made from \
         the material; for PBD with a fixed projection a stiffness that grows by orders of magnitude with iterations and with smaller steps. A chain \
         of 20 links at rest shows, as a part of k, with 16 of each effort: {}; with every step at the published settings: {}; of fewer and more links: {}.",
        sixteen.join(", "),
        ranges("steps per second"),
        ranges("links")
    ));
    study.section.rests_on = "figure-stiffness-chain".into();
    Ok(())
}

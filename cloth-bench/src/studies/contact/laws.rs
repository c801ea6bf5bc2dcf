//! Closed forms of contact, through every method's own view of it.

use super::cylinder::{self, polygon};
use crate::studies::prelude::*;
use std::f64::consts::PI;

/// Acceleration of free fall (m/s²).
pub(crate) const G: Real = 9.81;
/// Coefficient of friction.
pub const MU: Real = 0.3;
/// Height of the top of a cylinder above the free ends of a strip over the radius.
const HEIGHT: Real = 3.0;
/// Thickness (m) and stiffness (Pa/m) of contact, the defaults of scenes.
pub(crate) const THICKNESS: Real = 2e-3;
pub(super) const KAPPA: Real = 1e6;
/// Areal density (kg/m²) at which meshes are compared.
pub const HEAVY: Real = 20.0;
/// Steps of 1/60 s that a sheet slides, and within which it settles.
const SLIDE: u32 = 30;
const SETTLE: u32 = 40;
/// What still swings by then faster (m/s) than the first is brought to rest, which is below the second, if so many
/// steps more do it.
const SWINGS: Real = 1e-4;
const RESTS: Real = 1e-6;
const CALM: u32 = 400;

/// Who is asked.
pub fn methods() -> Vec<&'static str> {
    method::with_own(&[
        "symplectic-euler",
        "implicit-euler",
        "linear-implicit",
        "implicit-midpoint",
        "bdf2",
        "pbd",
        "xpbd",
        "xpbd-direct",
        "pd",
    ])
}

/// The same without the direct solver, which takes as long as all others together, in the quick scope.
fn asked(scope: Scope) -> Vec<&'static str> {
    let slow = scope.pick("xpbd-direct", "");
    methods().into_iter().filter(|name| *name != slow).collect()
}

/// Meshes on which a sheet comes to rest.
pub const MESHES: [&str; 7] = [
    "grid:9x9:one-way",
    "grid:9x9:alternating",
    "grid:9x9:crossed",
    "equilateral:9x9",
    "irregular:9",
    "disk:4",
    "holes:12:2",
];

/// The mesh of a sheet, unless meshes are compared.
pub const SQUARE: &str = "grid:9x9:alternating";

/// A sheet with a mesh above a floor, at the gap (m), under gravity that is inclined by an angle (rad).
fn sheet(
    mesh: &str,
    density: Real,
    angle: Real,
    friction: Real,
    gap: Real,
) -> Result<Scene, BenchError> {
    let floor = gap - 2.0 * THICKNESS;
    let settings = Settings::of(&format!(
        "density={density} friction={friction} thickness={THICKNESS} contact_stiffness={KAPPA} floor={floor}"
    ));
    let mut scene = scene::build("drop", Some(mesh), &settings)?;
    scene.gravity = Vec3::new(angle.sin(), 0.0, -angle.cos()) * G;
    Ok(scene)
}

/// The gap (m) at which the pressure p = ρ g cos α carries the weight: h − p/κ, or κ h²/(4 p) in the barrier below h/2.
fn gap(density: Real, angle: Real) -> Real {
    let pressure = density * G * angle.cos();
    match THICKNESS - pressure / KAPPA {
        gap if gap >= 0.5 * THICKNESS => gap,
        _ => KAPPA * THICKNESS * THICKNESS / (4.0 * pressure),
    }
}

/// What gravity has left against friction (m/s²).
fn pull(angle: Real, friction: Real) -> Real {
    G * (angle.sin() - friction * angle.cos()).max(0.0)
}

/// What a closed form says, and what a method makes of it.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Measured {
    /// By the closed form.
    pub expected: Number,
    /// By the method.
    pub measured: Number,
}

impl Measured {
    pub(super) fn new(expected: Real, measured: Real) -> Self {
        let [expected, measured] = [expected, measured].map(Number);
        Self { expected, measured }
    }
}

/// How far (m) a sheet slides from rest, and the closed form of the method's own steps, as of its free fall; and the
/// part of its weight times the thickness that it loses of its energy, to friction and to the method's own steps.
pub fn slide(name: &str, degrees: Real, friction: Real) -> Result<[Measured; 2], BenchError> {
    let angle = degrees.to_radians();
    let density = 0.2;
    let scene = sheet(SQUARE, density, angle, friction, gap(density, angle))?;
    let method = Method::find(name)?;
    let settings = method.by_default(Settings::default());
    let (summary, end) = run::simulate(&scene, method, &settings, scene.dt, SLIDE)?;
    let count = end.positions.len() as Real;
    let both = end.positions.iter().zip(&scene.start.positions);
    let measured = both.map(|(b, a)| b.x - a.x).sum::<Real>() / count;
    let substeps = method.substeps(&scene, &settings, scene.dt)?;
    let h = scene.dt / Real::from(substeps);
    let steps = SLIDE * substeps;
    let acceleration = pull(angle, friction);
    let expected = 0.5 * acceleration * h * h * method.free_fall(steps);
    let speed = acceleration * h * Real::from(steps);
    let lost = (G * angle.sin() * expected - 0.5 * speed * speed) / (G * THICKNESS);
    Ok([
        Measured::new(expected, measured),
        Measured::new(lost, energy_lost(&scene, &summary)),
    ])
}

/// Energy that a sheet has lost over its weight times the thickness.
fn energy_lost(scene: &Scene, end: &run::Summary) -> Real {
    let lost = end.contact_energy_at_start - end.kinetic_energy - end.potential_energy;
    let mass: Real = scene.model.particles.mass().iter().sum();
    lost / (mass * G * THICKNESS)
}

/// The gap (m) at which a sheet with a mesh ([`MESHES`]) and an areal density (kg/m²) comes to rest with so many steps a
/// second; and the part of its weight times the thickness that it has lost of its energy when it rests where it first
/// touched.
pub fn rest(name: &str, mesh: &str, density: Real, rate: u32) -> Result<[Measured; 2], BenchError> {
    let scene = sheet(mesh, density, 0.0, MU, THICKNESS)?;
    let method = Method::find(name)?;
    let settings = method.by_default(Settings::default());
    let start = scene.start.positions.iter().map(|x| x.z).sum::<Real>();
    let (dt, steps) = (1.0 / Real::from(rate), SETTLE * rate / 60);
    let (summary, mut end) = run::simulate(&scene, method, &settings, dt, steps)?;
    if end.velocities.iter().any(|v| v.amax() > SWINGS) {
        let mut stepper = method.build(&scene, &settings, dt)?;
        let mut rested = end.clone();
        let steps = run::to_rest(&scene, stepper.as_mut(), &mut rested, dt, CALM, RESTS)?;
        if steps.is_some() {
            end = rested;
        }
    }
    let count = end.positions.len() as Real;
    let sunk = (start - end.positions.iter().map(|x| x.z).sum::<Real>()) / count;
    Ok([
        Measured::new(gap(density, 0.0), THICKNESS - sunk),
        Measured::new(half_a_sinking(density), energy_lost(&scene, &summary)),
    ])
}

/// The spring of contact has taken half of the work of gravity when a sheet rests.
fn half_a_sinking(density: Real) -> Real {
    0.5 * density * G / (KAPPA * THICKNESS)
}

/// A closed form, by its name.
type Form = (&'static str, fn(Real) -> Real);

struct Law {
    name: &'static str,
    title: &'static str,
    x: &'static str,
    y: &'static str,
    /// Closed forms, that of continuous cloth first.
    exact: &'static [Form],
    /// In the quick scope and in the full one.
    points: [&'static [Real]; 2],
    measure: fn(&str, Real) -> Result<Measured, BenchError>,
}

const LAWS: [Law; 12] = [
    Law {
        name: "slide",
        title: "How far a sheet slides within 0.5 s down a slope, μ = 0.3",
        x: "slope (°)",
        y: "way (m)",
        exact: &[("½ g (sin α − μ cos α) t²", |degrees| {
            0.125 * pull(degrees.to_radians(), MU)
        })],
        points: [
            &[10.0, 20.0, 40.0],
            &[
                5.0, 10.0, 15.0, 16.5, 17.0, 18.0, 20.0, 25.0, 30.0, 40.0, 50.0, 60.0,
            ],
        ],
        measure: |name, degrees| Ok(slide(name, degrees, MU)?[0]),
    },
    Law {
        name: "gap",
        title: "The gap at which a sheet lies on a floor, κ = 1e6 Pa/m",
        x: "areal density (kg/m²)",
        y: "gap (m)",
        exact: &[("h − ρ g/κ", |density| gap(density, 0.0))],
        // From 102 on the cloth is pressed to less than half its thickness, where the law is another.
        points: [&[0.2, 20.0], &[0.2, 1.0, 5.0, 20.0, 50.0, 80.0]],
        measure: |name, density| Ok(rest(name, SQUARE, density, 60)?[0]),
    },
    Law {
        name: "gap-size",
        title: "The same of a sheet of 20 kg/m² on every mesh",
        x: "vertices a side (dimensionless)",
        y: "gap (m)",
        exact: &[("h − ρ g/κ", |_| gap(HEAVY, 0.0))],
        points: [&[3.0, 9.0], &[3.0, 5.0, 9.0, 17.0, 33.0]],
        measure: |name, n| Ok(rest(name, &format!("grid:{n}x{n}:alternating"), HEAVY, 60)?[0]),
    },
    Law {
        name: "gap-step",
        title: "The same with every step",
        x: "steps per second (1/s)",
        y: "gap (m)",
        exact: &[("h − ρ g/κ", |_| gap(HEAVY, 0.0))],
        points: [&[30.0], &[30.0, 60.0, 120.0, 240.0, 480.0]],
        measure: |name, rate| Ok(rest(name, SQUARE, HEAVY, rate as u32)?[0]),
    },
    Law {
        name: "rest-energy",
        title: "What a sheet has lost of its energy when it rests on the floor on which it was laid",
        x: "areal density (kg/m²)",
        y: "energy over weight times h (dimensionless)",
        exact: &[("ρ g/(2 κ h)", half_a_sinking)],
        points: [&[20.0], &[0.2, 1.0, 5.0, 20.0, 50.0, 80.0]],
        measure: |name, density| Ok(rest(name, SQUARE, density, 60)?[1]),
    },
    Law {
        name: "slide-energy",
        title: "What a sheet loses of its energy within 0.5 s on a slope, μ = 0.3",
        x: "slope (°)",
        y: "energy over weight times h (dimensionless)",
        exact: &[("μ cos α s/h", |degrees| {
            let angle = degrees.to_radians();
            0.125 * pull(angle, MU) * MU * angle.cos() / THICKNESS
        })],
        points: [
            &[20.0],
            &[0.0, 10.0, 15.0, 18.0, 20.0, 25.0, 30.0, 40.0, 50.0, 60.0],
        ],
        measure: |name, degrees| Ok(slide(name, degrees, MU)?[1]),
    },
    Law {
        name: "stack",
        title: "The force of a floor under sheets that lie on each other, over the weight of one",
        x: "sheets (dimensionless)",
        y: "force over one weight (dimensionless)",
        exact: &[("N", |sheets| sheets)],
        points: [&[2.0], &[1.0, 2.0, 3.0, 5.0, 10.0]],
        measure: cylinder::stack,
    },
    Law {
        name: "stack-gap",
        title: "The force through a gap within three such sheets, over the weight of one",
        x: "sheets above the gap (dimensionless)",
        y: "force over one weight (dimensionless)",
        exact: &[("j", |above| above)],
        points: [&[2.0], &[1.0, 2.0, 3.0]],
        measure: cylinder::carried,
    },
    Law {
        name: "capstan",
        title: "The ratio of the forces at its ends at which a strip slips on a cylinder",
        x: "coefficient of friction (dimensionless)",
        y: "ratio (dimensionless)",
        exact: &[
            ("e^μπ", |friction| (friction * PI).exp()),
            ("of the polygon", |friction| polygon(180.0, friction)),
        ],
        points: [&[0.3], &[0.1, 0.2, 0.3, 0.4, 0.5]],
        measure: |name, friction| cylinder::slip(name, 180.0, friction),
    },
    Law {
        name: "wrap",
        title: "The same with μ = 0.3 by the angle of contact",
        x: "angle of contact (°)",
        y: "ratio (dimensionless)",
        exact: &[
            ("e^μθ", |degrees| (MU * degrees.to_radians()).exp()),
            ("of the polygon", |degrees| polygon(degrees, MU)),
        ],
        points: [&[90.0], &[45.0, 90.0, 135.0, 180.0]],
        measure: |name, degrees| cylinder::slip(name, degrees, MU),
    },
    Law {
        name: "pressure",
        title: "The pressure on top of a cylinder under a strip that hangs down on both sides, over that of its weight",
        x: "height of the top above the ends over the radius (dimensionless)",
        y: "pressure over ρ g (dimensionless)",
        exact: &[("1 + H/R", |height| 1.0 + height)],
        points: [&[3.0], &[1.0, 2.0, 3.0, 4.0, 6.0]],
        measure: |name, height| cylinder::press(name, height, 0.0),
    },
    Law {
        name: "pressure-side",
        title: "The same beside the top, H = 3 R",
        x: "angle from the top (°)",
        y: "pressure over ρ g (dimensionless)",
        exact: &[("H/R − 1 + 2 cos φ", |degrees| {
            HEIGHT - 1.0 + 2.0 * degrees.to_radians().cos()
        })],
        points: [&[45.0], &[0.0, 22.5, 45.0, 67.5]],
        measure: |name, degrees| cylinder::press(name, HEIGHT, degrees),
    },
];

pub(super) fn run(study: &mut StudyRun<'_>) {
    let mut rows: Vec<Row> = Vec::new();
    let asked = asked(study.scope);
    let mut nearness = Table::about("law", asked.iter().map(|&name| name.to_owned()));
    for law in LAWS {
        let points = study.scope.of(law.points);
        let found = study.grid_side_by_side(
            iproduct!(asked.iter().copied(), points.iter().copied()),
            |(method, x)| format!("{} at {x} by {method}", law.name),
            |&(method, x)| (law.measure)(method, x),
        );
        let row = |((method, x), found): (_, Measured)| Row {
            law: law.name,
            method,
            x,
            closed_form: found.expected.0,
            measured: found.measured.0,
            error: found.measured.0 - found.expected.0,
        };
        let ours = found.into_iter().map(row).collect_vec();
        let measured = curves(&ours, |row| (row.method, (row.x, row.measured)));
        let exact = law.exact.iter().map(|(label, form)| {
            let curve = points.iter().map(|&x| (x, form(x)));
            Series::new(label, curve.collect())
        });
        let plot = Plot::new(law.title, Axis::linear(law.x), Axis::linear(law.y));
        let plot = plot.points(measured).exact_curves(exact);
        study.plot(&format!("contact-{}", law.name), &plot);
        let worst = asked.iter().map(|&method| {
            let ours = ours.iter().filter(|row| row.method == method);
            let parts = ours.clone().map(|row| [row.error, row.closed_form]);
            let [error, most] = parts.fold([0.0, 0.0], |[error, most], [e, c]| {
                [Real::max(error, e.abs()), Real::max(most, c.abs())]
            });
            match ours.count() {
                0 => Cell::Missing,
                _ => Cell::said(significant(error / most, 2)),
            }
        });
        nearness.line(format!("{}: {}", law.name, law.exact[0].0), worst);
        rows.extend(ours);
    }
    study.data("contact-laws", &rows);
    study.answer(
        "How well does each method keep the laws of contact?",
        "The largest distance from the closed form, over the largest value of that; what slides in the method's own steps, what slips for the polygon of the strip:".into(),
        Some(nearness),
        "figure-contact-gap",
    );
    on_every_mesh(study);
}

/// The gap has nothing to do with the triangles.
fn on_every_mesh(study: &mut StudyRun<'_>) {
    let rows = study.grid_side_by_side(
        iproduct!(MESHES, asked(study.scope)),
        |(mesh, method)| format!("a sheet at rest, {mesh}, by {method}"),
        |&(mesh, method)| {
            let [Measured { expected, measured }, _] = rest(method, mesh, HEAVY, 60)?;
            Ok(Gap {
                expected,
                measured,
                off: Number((measured.0 - expected.0).abs()),
            })
        },
    );
    study.table(
        "contact-meshes",
        "The gap at which a sheet of 20 kg/m² lies on a floor, on meshes of every pattern",
        Table::named(&["mesh", "method"], &rows),
    );
}

/// A sheet at rest.
#[derive(Debug, Default, Serialize, Deserialize)]
struct Gap {
    #[serde(rename = "h − ρ g/κ (m)")]
    expected: Number,
    #[serde(rename = "gap (m)")]
    measured: Number,
    #[serde(rename = "distance between the two (m)")]
    off: Number,
}

/// A method at one point of a law.
#[derive(Default, Serialize)]
struct Row {
    law: &'static str,
    method: &'static str,
    x: Real,
    closed_form: Real,
    measured: Real,
    error: Real,
}

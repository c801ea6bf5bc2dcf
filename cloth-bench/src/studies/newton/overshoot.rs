//! Overshoot: what one step makes of a mass on a spring that is stretched, and of one that turns.

use crate::studies::prelude::*;
use cloth_massspring::{ExplicitConfig, StabilityCheck, SymplecticEuler};

/// z of the spring that turns: it is stiff.
const STIFF: Real = 100.0;
/// Part of the rest length by which the other one is stretched.
const STRETCH: Real = 0.1;

/// How the step is taken. Iterations are those of one constraint, which is all that there is.
pub const METHODS: &str = "symplectic-euler
    linear-implicit
    implicit-euler: tolerance=1e-12
    pd: iterations=100
    xpbd: substeps=1
    xpbd, 20 substeps: substeps=20";

/// Where a mass of 1 kg on a spring of 1 m is (m from the other end) after one step of 1 s with ω = z (1/s), from a
/// stretch (m) along x and with a velocity (m/s) across.
fn step(variant: &Variant, z: Real, stretch: Real, across: Real) -> Result<Vec3, BenchError> {
    let settings = format!("n=1 link=1 tip_mass=1 stiffness={} gravity=0", z * z);
    let mut scene = scene::build("chain", None, &Settings::of(&settings))?;
    scene.start.positions[1].x += stretch;
    scene.start.velocities[1].z = across;
    let mut stepper = match variant.method() {
        // A step that explodes is what is to be seen.
        "symplectic-euler" => {
            let config = ExplicitConfig {
                stability: StabilityCheck::Off,
                ..Default::default()
            };
            let builder = SymplecticEuler::builder(&scene.model.particles).config(config);
            Box::new(builder.elements(scene.model.families()).build()?)
        }
        name => Method::find(name)?.build(&scene, &variant.settings, 1.0)?,
    };
    let mut state = scene.start.clone();
    stepper.step(&mut state, StepInput::new(1.0))?;
    Ok(state.positions[1] - state.positions[0])
}

/// Stretch along x over what it was, after a step of a stretched spring.
pub fn along(variant: &Variant, z: Real) -> Result<Real, BenchError> {
    Ok((step(variant, z, STRETCH, 0.0)?.x - 1.0) / STRETCH)
}

/// Stretch after a step of a spring at rest whose end moves across by so much of its length.
pub fn across(variant: &Variant, z: Real, turn: Real) -> Result<Real, BenchError> {
    Ok(step(variant, z, 0.0, turn)?.norm() - 1.0)
}

/// Draws both pictures, and says what they show.
pub(super) fn draw(findings: &mut Findings) -> Result<String, BenchError> {
    let variants = Variant::list(METHODS);
    let places = || (0..=72).map(|i| 10.0_f64.powf(-1.0 + Real::from(i) / 36.0));
    let measured = |stretch: &dyn Fn(&Variant, Real) -> Result<Real, BenchError>| {
        let curve = |variant: &Variant| {
            let points = places().map(|x| Ok::<_, BenchError>((x, stretch(variant, x)?)));
            Ok::<_, BenchError>(Series::new(&variant.label, points.try_collect()?))
        };
        variants.iter().map(curve).try_collect::<_, Vec<_>, _>()
    };
    let stretched = measured(&along)?;
    let plot = Plot::new(
        "One step of a mass on a stretched spring",
        Axis::log("z = ωΔt (dimensionless)"),
        Axis::linear("stretch after over before (dimensionless)").within(-3.0, 1.2),
    )
    .with(stretched)
    .exact("exact, cos z", places().map(|z| (z, z.cos())))
    .exact("symplectic-euler, 1 − z²", places().map(|z| (z, 1.0 - z * z)))
    .exact("implicit-euler, 1/(1 + z²)", places().map(|z| (z, 1.0 / (1.0 + z * z))))
    .note("Below 0 the step has gone past the rest length, below −1 it has more energy than before: an explicit step overshoots where z > 1 and explodes where z > 2. An implicit one stops short, however long it is.");
    findings.plot("newton-overshoot-along", &plot);
    let turned = measured(&|variant, turn| across(variant, STIFF, turn))?;
    let tangent = |turn: Real| turn.hypot(1.0) - 1.0;
    let plot = Plot::new(
        format!("One step of a mass that turns on a spring of z = {STIFF}"),
        Axis::log("distance of one step over the length of the spring (dimensionless)"),
        Axis::log("stretch after the step (dimensionless)").within(1e-9, 1e1),
    )
    .with(turned)
    .exact("linear-implicit, √(1 + φ²) − 1", places().map(|turn| (turn, tangent(turn))))
    .exact("implicit-euler, (√(1 + φ²) − 1)/(1 + z²)", places().map(|turn| {
        (turn, tangent(turn) / (1.0 + STIFF * STIFF))
    }))
    .note("The spring is at rest and the mass moves across it. Linearised where the step begins, a spring resists nothing across, so the mass leaves along the tangent, however stiff the spring; what solves the step turns with it.");
    findings.plot("newton-overshoot-across", &plot);
    let [linear, solved] = ["linear-implicit", "implicit-euler: tolerance=1e-12"]
        .map(|line| across(&Variant::list(line)[0], STIFF, 1.0));
    Ok(format!(
        "A mass that moves across a stiff spring by its length in one step stretches it by {} if that step is linearised, and by {} if it is solved.",
        significant(linear?, 3),
        significant(solved?, 3)
    ))
}

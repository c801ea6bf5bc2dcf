//! Sheets and strips in contact, by any method.

use super::prelude::*;
use crate::method::Method;
use crate::run;
use crate::scene::file;
use crate::settings::Setting;
use crate::studies::contact::laws::{Measured, SQUARE, rest, slide};
use crate::studies::contact::{cylinder, laws};
use std::path::Path;

law! {
    INCLINE = "incline" within 1e-3,
    "way (m) that a sheet slides from rest down a slope in 30 steps of 1/60 s: ½ a t² and what the steps of the method \
     add to it, a = g (sin α − μ cos α), if tan α > μ, else none";
    incline(InclineSettings {
        method: String = "xpbd",
            "any method but explicit-euler, which is unstable, and implicit-midpoint, which gains energy in contact";
        angle_deg: Real = 30 "°" in Within(0.0, 89.0), "inclination of the slope";
        friction: Real = 0.3 in AtLeast(0.0), "coefficient of friction";
    })
}

law! {
    BOUNCE = "bounce" within 1e-2,
    "height (m) of a flat sheet after n bounces, e²ⁿ h";
    bounce(BounceSettings {
        method: String = "xpbd", "explicit methods, pbd, xpbd or xpbd-direct";
        restitution: Real = 0.8 in Within(0.0, 1.0), "coefficient of restitution";
        height: Real = 1 "m" in Above(0.0), "height of the fall";
        bounces: u32 = 1 in AtLeast(1.0), "number of bounces n";
    })
}

law! {
    BARRIER_GAP = "barrier-gap" within 1e-3,
    "gap d (m) at which a sheet rests on a floor: −φ′(d) = ρ g, with the potential φ of contact, κ = 1e6 Pa/m, h = 2 mm";
    barrier_gap(BarrierGapSettings {
        method: String = "xpbd", "any method";
        density: Real = 20 "kg/m²" in Above(0.0),
            "areal density ρ; from 102 on the gap is below h/2, in the barrier, and from 1019 on below h/20, where \
             constraints (of xpbd, pbd and explicit methods) push no harder";
    })
}

law! {
    STACK = "stack" within 3e-3,
    "force of a floor under sheets that lie on each other, over the weight of one (dimensionless): their number";
    stack(StackSettings {
        method: String = "xpbd", "any method but explicit-euler, which is unstable";
        sheets: u32 = 3 in Within(1.0, 10.0), "number of sheets";
    })
}

law! {
    CAPSTAN = "capstan" within 8e-2,
    "ratio of the forces at its ends at which a strip slips on a cylinder (dimensionless), that of its polygon: e^μθ for \
     a smooth one; the force at one end grows by 0.4 % a step until the strip is seen to slip";
    capstan(CapstanSettings {
        method: String = "xpbd",
            "any method but explicit-euler, which is unstable, linear-implicit, which is 10 % off, and pbd, whose strip \
             never slips";
        friction: Real = 0.3 in Within(0.0, 1.0), "coefficient of friction";
        angle_deg: Real = 180 "°" in Within(11.25, 180.0), "angle of contact, a multiple of 11.25°";
    })
}

law! {
    PRESSURE = "pressure" within 5e-3,
    "pressure of a strip that hangs over a cylinder without friction, over that of its weight (dimensionless): \
     H/R − 1 + 2 cos φ";
    pressure(PressureSettings {
        method: String = "xpbd", "any method but explicit-euler, which is unstable, and pbd, which is 21 % off";
        height: Real = 3 in Within(1.0, 10.0), "height of the top above the ends over the radius, H/R";
        angle_deg: Real = 0 "°" in Within(0.0, 67.5), "angle φ from the top, a multiple of 11.25°";
    })
}

fn told(Measured { expected, measured }: Measured) -> Evaluation {
    Evaluation::new(expected.0, measured.0)
}

fn incline(own: &InclineSettings) -> Result<Evaluation, BenchError> {
    let [way, _] = slide(&own.method, *own.angle_deg, *own.friction)?;
    Ok(told(way))
}

fn barrier_gap(own: &BarrierGapSettings) -> Result<Evaluation, BenchError> {
    let [gap, _] = rest(&own.method, SQUARE, *own.density, 60)?;
    Ok(told(gap))
}

fn stack(own: &StackSettings) -> Result<Evaluation, BenchError> {
    Ok(told(cylinder::stack(&own.method, Real::from(*own.sheets))?))
}

/// Angle (°) that an edge of the strip takes on a cylinder.
const EDGE: Real = 11.25;

/// Refuses an angle that is not that of whole edges.
fn of_whole_edges(angle_deg: &Setting<Real>) -> Result<(), BenchError> {
    let below = EDGE * (**angle_deg / EDGE).floor();
    if **angle_deg == below {
        return Ok(());
    }
    Err(angle_deg.refuse(format!(
        "angle_deg is {}, but it has to be a multiple of {EDGE}, the angle of an edge of the strip: give {below} or {}",
        **angle_deg,
        below + EDGE
    )))
}

fn capstan(own: &CapstanSettings) -> Result<Evaluation, BenchError> {
    of_whole_edges(&own.angle_deg)?;
    Ok(told(cylinder::slip(
        &own.method,
        *own.angle_deg,
        *own.friction,
    )?))
}

fn pressure(own: &PressureSettings) -> Result<Evaluation, BenchError> {
    of_whole_edges(&own.angle_deg)?;
    Ok(told(cylinder::press(
        &own.method,
        *own.height,
        *own.angle_deg,
    )?))
}

/// Parts of a fall from the height: what a bounce is resolved to.
const PARTS: Real = 2000.0;

fn bounce(own: &BounceSettings) -> Result<Evaluation, BenchError> {
    let (restitution, height, bounces) = (*own.restitution, *own.height, *own.bounces);
    within_reach(1e8 * Real::from(bounces))?;
    let text = format!(
        "[[mesh]]\ngenerator = \"grid:3x3:alternating\"\ntranslate = [0, 0, {:?}]\n[[obstacle]]\nshape = \"plane\"\n\
         [contact]\nrestitution = {restitution:?}\nthickness = {:?}\n",
        height + laws::THICKNESS,
        laws::THICKNESS
    );
    let scene = file::build_text(Path::new("bounce.toml"), &text, &Settings::default())?;
    let fall = (2.0 * height / laws::G).sqrt();
    // Rise after rise, until the middle of the last one.
    let rises = (1..=bounces as i32)
        .map(|n| if n < bounces as i32 { 2.0 } else { 1.0 } * restitution.powi(n));
    let steps = PARTS * (1.0 + rises.sum::<Real>()) + 0.02 * PARTS;
    let method = Method::find(&own.method)?;
    method.check_restitution(&scene)?;
    let settings = Settings::of("substeps=1");
    let dt = fall / PARTS;
    let (mut rising, mut impacts, mut highest) = (false, 0, 0.0);
    let look = |_: u32, state: &State, _: &_| {
        let speed: Real = state.velocities.iter().map(|v| v.z).sum();
        impacts += u32::from(speed > 0.0 && !rising);
        rising = speed > 0.0;
        if impacts == bounces {
            let mean = state.positions.iter().map(|x| x.z).sum::<Real>() / 9.0;
            highest = Real::max(highest, mean - laws::THICKNESS);
        }
        Ok(())
    };
    run::from_start(&scene, method, &settings, dt, steps as u32, look)?;
    Ok(Evaluation::new(
        height * restitution.powi(2 * bounces as i32),
        highest,
    ))
}

//! A strip that hangs over a cylinder: how friction holds it, and how it presses.

use super::laws::{G, KAPPA, Measured, THICKNESS};
use crate::run::{Plan, Solver};
use crate::studies::prelude::*;
use cloth_collide::potential::ContactForces;
use std::f64::consts::PI;
use std::path::Path;

/// Radius of the cylinder (m), cells half-way around it, and areal density (kg/m²).
const RADIUS: Real = 0.1;
pub(super) const TURNS: usize = 16;
const DENSITY: Real = 0.2;
/// Force (N) at one end of the strip on every vertex, where the other one pulls harder and harder.
const PULL: Real = 0.05;
/// A strip that goes so far (m) in so many steps slips: ten times what the friction of potentials, which is
/// smooth, gives way.
const SLIPPED: Real = 1e-3;
const WITHIN: usize = 5;
/// Steps in which the strip settles, and part of the ratio by which the force grows in every one after that.
const SETTLE: usize = 10;
const GROWTH: Real = 4e-3;

/// A strip one cell wide that lies on top of a cylinder along y and goes straight on, on both sides.
struct Strip {
    scene: Scene,
    /// Edge (m) along the strip, cells that go around the cylinder, and those that go straight on each side.
    side: Real,
    turns: usize,
    tail: usize,
    /// Where the strip leaves the cylinder on its right: the way on from there.
    away: Vec3,
}

impl Strip {
    fn new(turns: usize, tail: usize, friction: Real, gravity: Real) -> Result<Self, BenchError> {
        let turn = PI / TURNS as Real;
        // Vertices are at the thickness from the cylinder.
        let around = RADIUS + THICKNESS;
        let side = 2.0 * around * (0.5 * turn).sin();
        let cells = turns + 2 * tail;
        let length = side * cells as Real;
        let text = format!(
            "gravity = [0, 0, {:?}]\n[[mesh]]\ngenerator = \"grid:{}x2:alternating\"\nscale = {length:?}\n\
            [cloth]\ndensity = {DENSITY:?}\nstiffness = 1e4\nrigidity = 1e-5\n\
            [[obstacle]]\nshape = \"capsule\"\nradius = {RADIUS:?}\nlength = 1\nrotate = [{:?}, 0, 0]\n\
            [contact]\nself = false\nthickness = {THICKNESS:?}\ncontact_stiffness = {KAPPA:?}\nfriction = {friction:?}\n",
            -gravity,
            cells + 1,
            0.5 * PI,
        );
        let mut scene =
            scene::file::build_text(Path::new("strip.toml"), &text, &Settings::default())?;
        let half = 0.5 * turns as Real;
        let last = turn * half;
        for x in &mut scene.start.positions {
            // Cells from the top, to the right.
            let number = (x.x / side).round() - 0.5 * cells as Real;
            let turned = number.clamp(-half, half);
            let [sin, cos] = [(turn * turned).sin(), (turn * turned).cos()];
            let on = side * (number - turned);
            let down = on.abs() * last.sin();
            *x = Vec3::new(around * sin + on * last.cos(), x.y, around * cos - down);
        }
        let away = Vec3::new(last.cos(), 0.0, -last.sin());
        Ok(Self {
            scene,
            side,
            turns,
            tail,
            away,
        })
    }

    /// Vertices of a row across the strip, by its number from one end.
    fn row(&self, number: usize) -> Vec<usize> {
        let mesh = self.scene.mesh.as_ref();
        let flat = mesh
            .map_or(&[][..], |mesh| mesh.positions())
            .iter()
            .enumerate();
        let is_there = |x: &Vec3| (x.x / self.side).round() == number as Real;
        flat.filter(|(_, x)| is_there(x)).map(|(v, _)| v).collect()
    }

    fn cells(&self) -> usize {
        self.turns + 2 * self.tail
    }

    /// The row on top.
    fn top(&self) -> Vec<usize> {
        self.row(self.cells() / 2)
    }
}

/// The ratio of the forces at which the polygon of a strip slips that goes around by an angle (°): each of its corners
/// turns by δ, the first and the last by half of that, and a corner that turns by 2 a bears (1 + μ tan a)/(1 − μ tan a).
pub(super) fn polygon(degrees: Real, friction: Real) -> Real {
    let corner = |half: Real| (1.0 + friction * half.tan()) / (1.0 - friction * half.tan());
    let half = 0.5 * PI / TURNS as Real;
    corner(half).powi(turns_of(degrees) as i32 - 1) * corner(0.5 * half).powi(2)
}

fn turns_of(degrees: Real) -> usize {
    (degrees / 180.0 * TURNS as Real).round() as usize
}

/// The ratio of the forces at both ends at which a strip without weight slips that goes around the cylinder by so many
/// degrees, of which a cell takes 11.25, the force at one end growing slowly; infinite if it holds at one and a half
/// times that of its polygon, which is expected.
pub fn slip(name: &str, degrees: Real, friction: Real) -> Result<Measured, BenchError> {
    let turns = turns_of(degrees);
    let strip = Strip::new(turns, 6, friction, 0.0)?;
    let scene = &strip.scene;
    let (ends, top) = ([strip.row(0), strip.row(strip.cells())], strip.top());
    let mirrored = Vec3::new(-strip.away.x, 0.0, strip.away.z);
    let ways = [mirrored, strip.away];
    let method = Method::find(name)?;
    let mut stepper = method.build(scene, &method.by_default(Settings::default()), scene.dt)?;
    let mut contacts = scene.contacts()?;
    let mut state = scene.start.clone();
    let mut load = vec![Vec3::zeros(); state.positions.len()];
    let expected = polygon(degrees, friction);
    let mut from = [Vec3::zeros(); WITHIN];
    let (mut ratio, mut step) = (1.0, 0);
    while ratio < 1.5 * expected {
        from[step % WITHIN] = state.positions[top[0]];
        if step >= SETTLE {
            ratio += GROWTH * expected;
        }
        for ((end, way), pull) in ends.iter().zip(ways).zip([PULL, PULL * ratio]) {
            end.iter().for_each(|&v| load[v] = way * pull);
        }
        let parts = stepper.preferred_substeps();
        for _ in 0..parts {
            let mut input = StepInput::new(scene.dt / Real::from(parts)).load(&load);
            if let Some(contacts) = &mut contacts {
                input = input.contacts(contacts);
            }
            stepper.step(&mut state, input)?;
        }
        step += 1;
        if step > SETTLE && (state.positions[top[0]] - from[step % WITHIN]).norm() > SLIPPED {
            return Ok(Measured::new(expected, ratio));
        }
    }
    Ok(Measured::new(expected, Real::INFINITY))
}

/// What contact does in the second half of so many steps, on average (N).
fn mean_force(
    scene: &Scene,
    name: &str,
    steps: u32,
    of: impl Fn(&ContactForces) -> Real,
) -> Result<Real, BenchError> {
    let method = Method::find(name)?;
    let settings = method.by_default(Settings::default());
    let mut solver = Solver::new(method, &settings, scene, scene.dt)?;
    let mut state = scene.start.clone();
    let plan = Plan {
        forces: true,
        ..Plan::new(scene.dt, steps)
    };
    let mut sum = 0.0;
    run::run_changing(scene, &mut solver, &mut state, plan, |moment| {
        let late = moment.forces.filter(|_| moment.step > steps / 2);
        sum += late.map_or(0.0, &of);
        Ok(())
    })?;
    Ok(sum / Real::from(steps - steps / 2))
}

/// The pressure on the cylinder at an angle (°) from its top, over that of the weight alone, of a strip that hangs down
/// without friction so that its ends are so many radii below its top. Expected is that of the height that its cells come
/// to.
pub fn press(name: &str, height_over_radius: Real, degrees: Real) -> Result<Measured, BenchError> {
    let cells = turns_of(degrees);
    let around = RADIUS + THICKNESS;
    let side = 2.0 * around * (0.5 * PI / TURNS as Real).sin();
    let tail = ((height_over_radius - 1.0) * around / side).round();
    let strip = Strip::new(TURNS, tail as usize, 0.0, G)?;
    let angle = cells as Real * PI / TURNS as Real;
    // On both sides: without friction nothing holds the strip at the top, and whatever is not quite symmetric grows.
    let top = strip.cells() / 2;
    let sides = [(top + cells, angle), (top - cells, -angle)];
    let sides = sides.map(|(row, angle)| {
        (
            strip.row(row),
            Vec3::new(angle.sin(), 0.0, angle.cos()) * 0.5,
        )
    });
    let force = mean_force(&strip.scene, name, 60, |forces| {
        let of = |(row, outwards): &(Vec<usize>, Vec3)| -> Real {
            row.iter().map(|&v| forces.normal[v].dot(outwards)).sum()
        };
        sides.iter().map(of).sum()
    })?;
    let height = (around + tail * side) / around;
    Ok(Measured::new(
        height - 1.0 + 2.0 * angle.cos(),
        force / (side * side * DENSITY * G),
    ))
}

/// Sheets that lie on each other on a floor, and the weight (N) of one.
fn stacked(sheets: Real) -> Result<(Scene, Real), BenchError> {
    let settings = Settings::of("n=6").with("sheets", sheets);
    let scene = scene::build("stack", None, &settings)?;
    let weight = scene.model.particles.mass().iter().sum::<Real>() * G / sheets;
    Ok((scene, weight))
}

/// The force of a floor under sheets that lie on each other, over the weight of one.
pub fn stack(name: &str, sheets: Real) -> Result<Measured, BenchError> {
    let (scene, weight) = stacked(sheets)?;
    let force = mean_force(&scene, name, 120, |forces| {
        -forces.bodies.iter().map(|body| body.force.z).sum::<Real>()
    })?;
    Ok(Measured::new(sheets, force / weight))
}

/// Sheets of the stack within which pressure is looked at.
const SHEETS: Real = 3.0;

/// The force through the gap below so many sheets, the upper ones of three, over the weight of one.
pub fn carried(name: &str, above: Real) -> Result<Measured, BenchError> {
    let (scene, weight) = stacked(SHEETS)?;
    let count = scene.start.positions.len();
    let first = count - (above / SHEETS * count as Real).round() as usize;
    let force = mean_force(&scene, name, 120, |forces| {
        forces.normal[first..].iter().map(|force| force.z).sum()
    })?;
    Ok(Measured::new(above, force / weight))
}

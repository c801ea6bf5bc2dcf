//! What becomes of energy and momentum over ten seconds.

use crate::studies::prelude::*;
use cloth_core::measure::{
    angular_momentum, gravitational_energy, kinetic_energy, linear_momentum,
};

pub(super) const STUDY: Study = Study {
    name: "energy",
    question: "What do the methods do to energy and momentum over 10 s that no force of the scene does?",
    about: "Oscillator: one mass on one spring, period 1 s, along the spring; energy kept is E(10 s)/E(0), expected the closed form, (1 + z²)^−n for implicit Euler and what comes down to it on one spring, with z = ωh and n (sub)steps of h, and 1 for the midpoint rule. Explicit Euler multiplies it by 1 + z² every step and is refused. \
        Free: a sheet without gravity or pins that flies, turns and vibrates; energy is what is left of elastic and kinetic energy without that of the flight, momenta are the largest change in 10 s over the value at the start. \
        Forces between vertices change no linear momentum, whatever the method, so anything but rounding there is a bug; angular momentum is kept by symplectic Euler and by the implicit midpoint rule, and by no other rule here, however well it is solved. \
        Held: a sheet held at two corners falls and swings; energy left is (E(10 s) − E_rest)/(E(0) − E_rest), 1 if nothing is lost, 0 at rest; most is the largest of it on the way, above 1 where a method makes energy. \
        Losses are the method's own, there is no damping in the scene. What surprises: the midpoint rule, which keeps the energy of one spring to rounding, gains energy without bound on a stiff sheet that is held, however well its step is solved. One might expect more Newton iterations or a stiffer cloth to keep more: neither does, the step size decides.",
    run,
};

const SECONDS: Real = 10.0;
const SAMPLES: u32 = 100;
/// Angular frequency (1/s) of the oscillator: period 1 s.
const OMEGA: Real = std::f64::consts::TAU;

/// Vertices a side of a sheet, and steps per second.
type Setting = (u32, u32);
const SETTINGS: [&[Setting]; 2] = [&[(5, 60)], &[(17, 60), (9, 60), (9, 240)]];
/// What they are called as columns.
const COLUMNS: [&str; 2] = ["vertices a side", "steps per second"];

/// Label, method, tolerance.
type Solver = (String, &'static str, Option<Real>);

/// Every method at its published setting, and the midpoint rule solved to rounding.
fn methods() -> Vec<Solver> {
    let published = |method: &Method| (method.published(), method.name, None);
    let mut all: Vec<_> = method::all().map(published).collect();
    let exactly = "implicit-midpoint, solved to 1e-12";
    all.push((exactly.to_owned(), "implicit-midpoint", Some(1e-12)));
    all
}

/// What a run of ten seconds kept.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Kept {
    /// Energy (J) at the start and after every hundredth of the time.
    energy: Vec<Number>,
    /// Changes over the values at the start, at the same times: of the linear momentum, by anything but gravity, and
    /// of the angular momentum about the origin.
    momenta: [Vec<Number>; 2],
}

impl Kept {
    fn share(&self, sample: usize, floor: Real) -> Real {
        (self.energy[sample].0 - floor) / (self.energy[0].0 - floor)
    }

    fn is_whole(&self) -> bool {
        self.energy.len() == SAMPLES as usize + 1
    }

    /// Largest changes of linear and of angular momentum.
    pub fn drift(&self) -> [Real; 2] {
        let momenta = self.momenta.each_ref();
        momenta.map(|changes| largest(changes.iter().map(|change| change.0)))
    }

    /// Fraction of the energy that is left after ten seconds.
    pub fn left(&self, floor: Real) -> Real {
        self.share(SAMPLES as usize, floor)
    }

    /// The fraction over time (s).
    fn curve(&self, label: &str, floor: Real) -> Series {
        let samples = 0..self.energy.len();
        over_seconds(label, samples.map(|sample| self.share(sample, floor)))
    }
}

/// Values at the start and after every hundredth of the time.
fn over_seconds(label: &str, values: impl Iterator<Item = Real>) -> Series {
    let time = |sample: usize| sample as Real * SECONDS / Real::from(SAMPLES);
    let points = values
        .enumerate()
        .map(|(sample, value)| (time(sample), value));
    Series::new(label, points.collect())
}

/// Follows a method for ten seconds. Energy that the centre of mass carries is left out where the scene has no gravity.
pub fn follow(
    scene: &Scene,
    name: &str,
    tolerance: Option<Real>,
    steps_per_second: u32,
) -> Result<Kept, BenchError> {
    let dt = 1.0 / Real::from(steps_per_second);
    let steps = (SECONDS * Real::from(steps_per_second)).round() as u32;
    let published = Settings::default();
    let settings = match tolerance {
        Some(tolerance) => published.with("tolerance", tolerance),
        None => published,
    };
    let mut stepper = Method::find(name)?.build(scene, &settings, dt)?;
    let energies = scene.model.energies()?;
    let particles = &scene.model.particles;
    let mass: Real = particles.mass().iter().sum();
    let is_free = scene.gravity == Vec3::zeros() && particles.free_count() == particles.len();
    let energy = |state: &State| {
        let flight = linear_momentum(particles, &state.velocities).norm_squared() / (2.0 * mass);
        energies.value(&state.positions)
            + kinetic_energy(particles, &state.velocities)
            + gravitational_energy(particles, &state.positions, scene.gravity)
            - if is_free { flight } else { 0.0 }
    };
    let mut state = scene.start.clone();
    let momenta = |state: &State, time: Real| {
        [
            linear_momentum(particles, &state.velocities) - mass * time * scene.gravity,
            angular_momentum(particles, state),
        ]
    };
    let at_start = momenta(&state, 0.0);
    let mut drifts = [vec![Number(0.0)], vec![Number(0.0)]];
    let mut kept = vec![Number(energy(&state))];
    for step in 1..=steps {
        let input = StepInput::new(dt).gravity(scene.gravity);
        stepper.step(&mut state, input)?;
        if step % (steps / SAMPLES) == 0 {
            kept.push(Number(energy(&state)));
            let now = momenta(&state, Real::from(step) * dt);
            for ((now, before), drift) in now.iter().zip(at_start).zip(&mut drifts) {
                drift.push(Number((now - before).norm() / before.norm()));
            }
        }
    }
    Ok(Kept {
        energy: kept,
        momenta: drifts,
    })
}

/// A mass of 1 kg on a spring that is pulled by a tenth of its length.
pub fn oscillator() -> Result<Scene, BenchError> {
    let settings = Settings::default()
        .with("n", 1)
        .with("link", 1)
        .with("tip_mass", 1)
        .with("stiffness", OMEGA * OMEGA)
        .with("gravity", 0);
    let mut scene = scene::build("chain", None, &settings)?;
    scene.start.positions[1].x += 0.1;
    Ok(scene)
}

/// What the oscillator keeps of its energy, where a closed form says so.
pub fn exact(method: &Method, substeps: u32, steps_per_second: u32) -> Option<Real> {
    let count = SECONDS * Real::from(steps_per_second) * Real::from(substeps);
    method.kept_by_an_oscillator(OMEGA * SECONDS / count, count)
}

/// A sheet that flies freely, turns, and shakes.
pub fn free(n: u32) -> Result<Scene, BenchError> {
    let settings = Settings::of(&format!("n={n} stiffness=1e3 gravity=0"));
    let mut scene = scene::build("drop", None, &settings)?;
    let (flight, turn) = (Vec3::new(1.0, 0.5, 0.2), Vec3::new(1.0, -0.5, 2.0));
    for (v, x) in scene
        .start
        .velocities
        .iter_mut()
        .zip(&scene.start.positions)
    {
        let shake = Vec3::new(
            (3.0 * x.y).sin(),
            (2.0 * x.x).cos(),
            (5.0 * x.x - 4.0 * x.y).sin(),
        );
        *v = flight + turn.cross(x) + 0.3 * shake;
    }
    Ok(scene)
}

fn held(n: u32) -> Result<Scene, BenchError> {
    let settings = Settings::default().with("n", n).with("stiffness", 1e3);
    scene::build("hang", None, &settings)
}

/// Energy (J) of the held sheet at rest.
fn at_rest(scene: &Scene) -> Result<Number, BenchError> {
    let dt = 1.0 / 60.0;
    let mut newton = Method::find("implicit-euler")?.build(scene, &Settings::default(), dt)?;
    let mut state = scene.start.clone();
    run::to_rest(scene, newton.as_mut(), &mut state, dt, 2000, 1e-4)?
        .ok_or_else(|| BenchError::Failed("the held sheet does not come to rest".into()))?;
    let energies = scene.model.energies()?;
    let raised = gravitational_energy(&scene.model.particles, &state.positions, scene.gravity);
    Ok(Number(energies.value(&state.positions) + raised))
}

fn run(study: &mut StudyRun<'_>) -> Result<(), BenchError> {
    let law = oscillators(study)?;
    let (kept, momentum) = free_sheets(study)?;
    let left = held_sheets(study)?;
    study.section.verdict = Some(format!("{law}\n{kept} {momentum} {left}"));
    Ok(())
}

#[derive(Default, Serialize)]
struct OscillatorRow {
    method: String,
    substeps: u32,
    energy_kept: Real,
    expected: Option<Real>,
    error: Option<Real>,
}

fn oscillators(study: &mut StudyRun<'_>) -> Result<String, BenchError> {
    const RATE: u32 = 60;
    let scene = oscillator()?;
    let mut found = study.grid_side_by_side(
        methods(),
        |(label, ..)| format!("oscillator, {label}"),
        |&(_, name, tolerance)| follow(&scene, name, tolerance, RATE),
    );
    found.retain(|(_, kept)| kept.is_whole());
    let dt = 1.0 / Real::from(RATE);
    let row = |((label, name, _), kept): &(Solver, Kept)| {
        let method = Method::find(name)?;
        let substeps = method.substeps(&scene, &Settings::default(), dt)?;
        let (kept, expected) = (kept.left(0.0), exact(method, substeps, RATE));
        Ok(OscillatorRow {
            method: label.clone(),
            substeps,
            energy_kept: kept,
            expected,
            error: expected.map(|expected| (kept / expected - 1.0).abs()),
        })
    };
    let rows: Vec<OscillatorRow> = found.iter().map(row).collect::<Result<_, BenchError>>()?;
    let curves = found
        .iter()
        .map(|((label, ..), kept)| kept.curve(label, 0.0));
    let exact = |sign: Real| {
        let z = OMEGA / Real::from(RATE);
        let times = (0..=50).map(|k| 0.2 * Real::from(k));
        times.map(move |time| (time, (1.0 + z * z).powf(sign * time * Real::from(RATE))))
    };
    let plot = over_time("Energy of one oscillator of 1 s, steps of 1/60 s")
        .with(curves)
        .exact("(1 + z²)^−n", exact(-1.0))
        .exact("1", exact(0.0));
    study.plot("energy-oscillator", &plot);
    study.table("energy-oscillator", "One oscillator", &rows);
    let worst = largest(rows.iter().filter_map(|row| row.error));
    Ok(format!(
        "One oscillator keeps what the closed forms say to {worst:.0e}."
    ))
}

fn over_time(title: &str) -> Plot {
    let energy = Axis::log("energy left (dimensionless)").within(1e-3, 1e3);
    Plot::new(title, Axis::linear("time (s)"), energy).note(
        "1 is the energy at the start. The scene has no damping: what is lost, the method takes, and what is gained, it makes.",
    )
}

fn name_of((n, rate): Setting) -> String {
    format!("{n} × {n} vertices, 1/{rate} s")
}

/// The names of all methods on the first sheet, and what they keep there.
fn told<R>(rows: &[(Setting, R)], of: fn(&R) -> (&String, Real)) -> String {
    let of_first = rows.iter().filter(|((n, _), _)| *n == rows[0].0.0);
    let mut told = of_first.map(|(_, row)| {
        let (label, share) = of(row);
        format!("{label} {}", significant(share, 3))
    });
    told.join(", ")
}

#[derive(Default, Serialize)]
struct FreeRow {
    method: String,
    energy_kept: Real,
    change_of_linear_momentum: Real,
    change_of_angular_momentum: Real,
    #[serde(skip)]
    keeps_angular: bool,
}

/// What the free sheets keep, and what of the momenta; as sentences.
fn free_sheets(study: &mut StudyRun<'_>) -> Result<(String, String), BenchError> {
    let mut rows: Vec<(Setting, FreeRow)> = Vec::new();
    for &setting in study.scope.of(SETTINGS) {
        let (n, rate) = setting;
        let scene = free(n)?;
        let mut found = study.grid_side_by_side(
            methods(),
            |(label, ..)| format!("free, {}, {label}", name_of(setting)),
            |&(_, name, tolerance)| follow(&scene, name, tolerance, rate),
        );
        found.retain(|(_, kept)| kept.is_whole());
        let title = format!("A free sheet, {}", name_of(setting));
        let curves = found
            .iter()
            .map(|((label, ..), kept)| kept.curve(label, 0.0));
        let name = format!("energy-free-{n}-{rate}");
        study.plot(&name, &over_time(&title).with(curves));
        for (place, momentum) in ["linear", "angular"].into_iter().enumerate() {
            let curves = found.iter().map(|((label, ..), kept)| {
                let mut curve =
                    over_seconds(label, kept.momenta[place].iter().map(|change| change.0));
                // At the start nothing has changed.
                curve.points.remove(0);
                curve
            });
            let change = Axis::log("change over the value at the start (dimensionless)");
            let seconds = Axis::linear("time (s)");
            let plot = Plot::new(format!("{title}: {momentum} momentum"), seconds, change)
                .with(curves)
                .note("No force acts from outside. What stays below 1e-9 is rounding, of many steps and substeps.");
            study.plot(&format!("{name}-{momentum}"), &plot);
        }
        rows.extend(found.into_iter().map(|((method, ..), kept)| {
            // A sheet that has gained energy moves faster, and rounds as much more.
            let shares = (0..kept.energy.len()).map(|sample| kept.share(sample, 0.0));
            let louder = shares.fold(1.0, Real::max).sqrt();
            let [linear, angular] = kept.drift();
            let row = FreeRow {
                method,
                energy_kept: kept.left(0.0),
                change_of_linear_momentum: linear,
                change_of_angular_momentum: angular,
                keeps_angular: angular < ROUNDING * louder,
            };
            (setting, row)
        }));
    }
    let table = Table::named(&COLUMNS, &rows);
    study.table("energy-free", "A free sheet for 10 s", table);
    let kept = told(&rows, |row| (&row.method, row.energy_kept));
    let linear = largest(rows.iter().map(|(_, row)| row.change_of_linear_momentum));
    let lose = rows.iter().map(|(_, row)| row);
    let lose = lose.filter(|row| row.change_of_linear_momentum >= ROUNDING);
    let mut lose = lose.map(|row| &row.method).dedup();
    let linear = if linear < ROUNDING {
        format!("All keep linear momentum to rounding ({linear:.0e})")
    } else {
        let lose = lose.join(", ");
        format!("All keep linear momentum to rounding but {lose}: it changes by {linear:.0e}")
    };
    let (exact, others): (Vec<_>, Vec<_>) = rows.iter().partition(|(_, row)| row.keeps_angular);
    let angular = largest(others.iter().map(|(_, row)| row.change_of_angular_momentum));
    // Those that keep it on every sheet, each once.
    let is_always = |method: &&String| others.iter().all(|(_, other)| other.method != **method);
    let always = exact.iter().map(|(_, row)| &row.method);
    let always = always.filter(is_always).unique().join(" and ");
    Ok((
        format!("Of the energy of a free sheet is left after 10 s: {kept}."),
        format!(
            "{linear}; angular momentum is kept to 1e-9, of what the motion has grown to, by {always} alone, the others change it by up to {angular:.0e}."
        ),
    ))
}

/// Changes of momentum below this part are rounding, of up to 10⁵ (sub)steps.
const ROUNDING: Real = 1e-9;

#[derive(Default, Serialize)]
struct HeldRow {
    method: String,
    energy_left: Real,
    most: Real,
}

fn held_sheets(study: &mut StudyRun<'_>) -> Result<String, BenchError> {
    let mut rows: Vec<(Setting, HeldRow)> = Vec::new();
    for &setting in study.scope.of(SETTINGS) {
        let (n, rate) = setting;
        let scene = held(n)?;
        let mut found = study.grid_side_by_side(
            methods(),
            |(label, ..)| format!("held, {}, {label}", name_of(setting)),
            |&(_, name, tolerance)| {
                let kept = follow(&scene, name, tolerance, rate)?;
                Ok((kept, at_rest(&scene)?))
            },
        );
        found.retain(|(_, (kept, _))| kept.is_whole());
        let curves = found
            .iter()
            .map(|((label, ..), (kept, floor))| kept.curve(label, floor.0));
        let curves = curves.collect_vec();
        for (((method, ..), (kept, floor)), curve) in found.into_iter().zip(&curves) {
            let row = HeldRow {
                method,
                energy_left: kept.left(floor.0),
                most: largest(curve.points.iter().map(|point| point.1)),
            };
            rows.push((setting, row));
        }
        let title = format!("A held sheet, {}", name_of(setting));
        let name = format!("energy-held-{n}-{rate}");
        study.plot(&name, &over_time(&title).with(curves));
    }
    let table = Table::named(&COLUMNS, &rows);
    study.table("energy-held", "A sheet held at two corners for 10 s", table);
    let left = told(&rows, |row| (&row.method, row.energy_left));
    Ok(format!("Of what a held sheet can lose is left: {left}."))
}

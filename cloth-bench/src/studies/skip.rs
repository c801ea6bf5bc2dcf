//! What the features cost that a scene does not use: time, memory, dependencies, build.

pub mod memory;

use super::interleaved::{interleaved, timed};
use crate::studies::prelude::*;
use cloth_collide::potential::PotentialContacts;
use cloth_core::contact::ContactSource;
use cloth_core::step::Observer;
use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

pub(super) const STUDY: Study = Study {
    name: "skip",
    question: "What does a feature cost where a scene does not use it?",
    about: "Expect a ratio of 1 for whatever is there but unused. Time: a step of the hanging sheet without the feature, with the feature there but not used (a bending rigidity of 0, a contact hook with nothing to touch, an observer that does nothing), and with it in use. \
        Many rounds of one step each, and of their ratios to the step without the feature the median: what slows the machine for a while slows a whole round. How far that can be trusted stands beside it: the step without the feature is measured twice. Contact in use is self-collision of a sheet that does not touch itself, resolved once a step. \
        Memory: bytes that scene, solver and contact hold after their first step on one thread, and how often they have asked for memory until then, beside the same without the feature; every method that has it. Unused is a value that says so, a bending rigidity or a damping of 0, or a hook with nothing to do; of settings of a method their text is copied and given back, in two or three allocations. \
        Dependencies: other crates that a crate of this workspace brings in, with all of its features and with the fewest; seconds are those of building it alone from nothing, its dependencies included.",
    run,
};

const FEATURES: [&str; 3] = ["bending", "contact", "observer"];
const CRATES: [(&str, &str); 8] = [
    ("cloth-core", "--no-default-features"),
    ("cloth-massspring", "--no-default-features"),
    ("cloth-pbd", "--no-default-features"),
    ("cloth-pbd", "default"),
    ("cloth-xpbd", "--no-default-features"),
    ("cloth-xpbd", "--features direct,single"),
    ("cloth-pd", "--no-default-features"),
    ("cloth-collide", "default"),
];

fn methods() -> Vec<&'static str> {
    method::with_own(&["pbd", "xpbd", "pd", "linear-implicit"])
}

/// Vertices a side.
const SIDES: [u32; 2] = [33, 128];

/// Median time of a step without a feature, and ratios to it.
#[derive(Default, Serialize, Deserialize)]
struct Times {
    #[serde(rename = "without (ms)")]
    without: Real,
    #[serde(rename = "without again / without")]
    again: Real,
    #[serde(rename = "unused / without")]
    unused: Real,
    #[serde(rename = "in use / without")]
    used: Real,
}

/// What a crate with some features brings in.
#[derive(Default, Serialize, Deserialize)]
struct Weight {
    crates_it_brings_in: usize,
    /// Not for the small scope.
    seconds_to_build: Option<Real>,
}

fn run(study: &mut StudyRun<'_>) -> Result<(), BenchError> {
    let scope = study.scope;
    let times = study.grid(
        iproduct!(FEATURES, methods()),
        |(feature, method)| format!("{feature}, {method}"),
        |(feature, method)| times(scope, feature, method),
    );
    let n = scope.of(SIDES);
    study.table(
        "skip-time",
        &format!("Time of a step of the {n} × {n} sheet with and without a feature"),
        Table::named(&["feature", "method"], &times),
    );
    let memory = memory::run(study);
    let weights = study.grid(
        CRATES,
        |(name, features)| format!("{name}, {features}"),
        |(name, features)| weight(scope, name, features),
    );
    let table = Table::named(&["crate", "features"], &weights);
    study.table("skip-crates", "Dependencies of each crate alone", table);
    let most = times.iter().map(|(_, t)| t.unused).fold(0.0, Real::max);
    let noise = times.iter().map(|(_, t)| (t.again - 1.0).abs());
    let noise = noise.fold(0.0, Real::max);
    let beyond = times.iter().filter(|(_, t)| t.unused - 1.0 > noise);
    let mut beyond = beyond.map(|((feature, method), _)| format!("{feature} with {method}"));
    let costs = match beyond.join(", ") {
        none if none.is_empty() => "costs no time beyond the noise".to_owned(),
        some => format!("costs no time beyond the noise, but for {some}"),
    };
    let mut verdict = format!(
        "A feature that is there but unused {costs}: it makes a step at most {most:.3} times as long, and the same step measured twice differs by up to {:.1} %.\n{memory}",
        100.0 * noise
    );
    let mut fewest = weights.iter().filter_map(|((name, features), weight)| {
        let is_alone = *features == "--no-default-features";
        is_alone.then(|| format!("{name} {}", weight.crates_it_brings_in))
    });
    let fewest = fewest.join(", ");
    if !fewest.is_empty() {
        verdict +=
            &format!(" With the fewest features the crates bring in so many others: {fewest}.");
    }
    study.section.verdict = Some(verdict);
    Ok(())
}

/// An observer that does nothing.
struct Idle;

impl Observer for Idle {
    fn iteration(&mut self, _: u32, _: &[Vec3]) {}
}

/// How a feature is there.
#[derive(Clone, Copy, PartialEq)]
enum Presence {
    Absent,
    Unused,
    InUse,
}

/// One variant of taking steps.
struct Variant<'a> {
    scene: Scene,
    stepper: Box<dyn Stepper>,
    contacts: Option<Box<dyn ContactSource + 'a>>,
    observer: Option<Idle>,
}

/// Settings of the sheet and of the method.
fn settings(n: u32, feature: &str, used: Presence) -> Result<[Settings; 2], BenchError> {
    let known = memory::FEATURES.iter().find(|known| known.0 == feature);
    let unknown = || BenchError::Failed(format!("`{feature}` is no feature of this study"));
    let &(_, of_method, settings) = known.ok_or_else(unknown)?;
    let own = Settings::of(settings[used as usize]);
    let sheet = Settings::default().with("n", n);
    Ok(match of_method {
        true => [sheet, own],
        false => [sheet.then(&own), Settings::default()],
    })
}

impl Variant<'_> {
    fn new(
        [sheet, own]: &[Settings; 2],
        feature: &str,
        method: &str,
        used: Presence,
    ) -> Result<Self, BenchError> {
        let mut scene = scene::build("hang", None, sheet)?;
        if Method::find(method)?.is_never_stable() {
            // What is held does not depend on the step.
            scene.dt = 1e-6;
        }
        let mut contacts: Option<Box<dyn ContactSource>> = None;
        if let (Some(mesh), "contact", true) = (&scene.mesh, feature, used != Presence::Absent) {
            let builder = PotentialContacts::builder(mesh).self_collision(used == Presence::InUse);
            contacts = Some(Box::new(builder.build()?));
        } else if scene.can_touch() {
            contacts = scene.contacts()?.map(|contacts| Box::new(contacts) as _);
        }
        Ok(Self {
            stepper: Method::find(method)?.build(&scene, own, scene.dt)?,
            scene,
            contacts,
            observer: (feature == "observer" && used != Presence::Absent).then_some(Idle),
        })
    }

    /// Time (s) of one step from the start of the scene: the work is the same every time.
    fn step(&mut self) -> Result<Real, BenchError> {
        let mut state = self.scene.start.clone();
        self.step_from(&mut state)
    }

    fn step_from(&mut self, state: &mut State) -> Result<Real, BenchError> {
        let mut input = StepInput::new(self.scene.dt).gravity(self.scene.gravity);
        if let Some(contacts) = &mut self.contacts {
            input = input.contacts(&mut **contacts);
        }
        if let Some(observer) = &mut self.observer {
            input = input.observer(observer);
        }
        Ok(timed(|| self.stepper.step(state, input))?)
    }
}

fn times(scope: Scope, feature: &str, method: &str) -> Result<Times, BenchError> {
    let variant = |used| {
        let settings = settings(scope.of(SIDES), feature, used)?;
        Variant::new(&settings, feature, method, used)
    };
    let mut variants = [
        variant(Presence::Absent)?,
        variant(Presence::Absent)?,
        variant(Presence::Unused)?,
        variant(Presence::InUse)?,
    ];
    let least = scope.pick(0.15, 4.0);
    let times = interleaved(least, |variant| variants[variant].step())?;
    let [_, again, unused, used] = times.ratios;
    let without = 1e3 * times.seconds[0];
    Ok(Times {
        without,
        again,
        unused,
        used,
    })
}

/// Number of crates that a crate brings in, and the seconds that building all of it takes; no seconds for the small
/// scope.
fn weight(scope: Scope, name: &str, features: &str) -> Result<Weight, BenchError> {
    let cargo = || {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let mut command = Command::new("cargo");
        command.current_dir(root);
        command
    };
    let features = features.split_whitespace();
    let features = features.filter(|word| *word != "default").collect_vec();
    let tree = cargo()
        .args(["tree", "--offline", "-p", name])
        .args(["-e", "normal", "--prefix", "none"])
        .args(&features)
        .output()
        .map_err(|error| BenchError::Failed(format!("cargo: {error}")))?;
    let refused = |output: &[u8]| {
        let text = String::from_utf8_lossy(output);
        let told = text.lines().find(|line| line.starts_with("error"));
        BenchError::Failed(format!("cargo: {}", told.unwrap_or(text.trim())))
    };
    if !tree.status.success() {
        return Err(refused(&tree.stderr));
    }
    let text = String::from_utf8_lossy(&tree.stdout);
    let name_of = |line: &'_ str| line.split_whitespace().next().map(str::to_owned);
    let others: BTreeSet<String> = text.lines().filter_map(name_of).collect();
    let brought = |seconds_to_build| Weight {
        crates_it_brings_in: others.len() - 1,
        seconds_to_build,
    };
    if scope == Scope::Quick {
        return Ok(brought(None));
    }
    let target = std::env::temp_dir().join(format!("cloth-skip-{}", std::process::id()));
    let started = Instant::now();
    let built = cargo()
        .args(["build", "--offline", "--release", "-p", name])
        .arg("--target-dir")
        .arg(&target)
        .args(&features)
        // As for those who depend on the crate; names for profilers are of this workspace.
        .env("CARGO_PROFILE_RELEASE_DEBUG", "none")
        .output();
    let seconds = started.elapsed().as_secs_f64();
    // What is left behind there is of no use to anybody.
    let _ = std::fs::remove_dir_all(&target);
    match built {
        Ok(built) if built.status.success() => Ok(brought(Some(seconds))),
        Ok(built) => Err(refused(&built.stderr)),
        Err(error) => Err(BenchError::Failed(format!("cargo: {error}"))),
    }
}

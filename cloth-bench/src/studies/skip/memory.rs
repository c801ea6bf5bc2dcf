//! What a feature costs in memory: everything that a scene, its solver, its contact and the first step ask for.

use super::super::scale;
use super::{Presence, Variant, settings};
use crate::memory::{Allocated, allocated};
use crate::studies::prelude::*;
use std::time::Duration;

/// Vertices a side of the sheet that is held.
const SIDE: [u32; 2] = [9, 33];

/// Names, whether settings are those of the method, and the settings without the feature, with it unused and in use.
/// Without any: a hook of the step.
#[rustfmt::skip] // a table is read by rows
pub(super) const FEATURES: [(&str, bool, [&str; 3]); 13] = [
    ("bending", false, ["bending=none", "rigidity=0", ""]),
    ("contact", false, [""; 3]),
    ("observer", false, [""; 3]),
    ("contact of the scene", false, ["contact=none", "self=no", "self=yes"]),
    ("compression", false, ["", "compression=1", "compression=0.01"]),
    ("slack", false, ["", "slack=none", "slack=0.99,1.01"]),
    ("coarse level", false, ["", "level=0", "level=1"]),
    ("strain limiting", true, ["", "strain_limit=none", "strain_limit=0.05"]),
    ("air drag", true, ["", "air_drag=0", "air_drag=1"]),
    ("stiffness damping", true, ["", "stiffness_damping=0", "stiffness_damping=1e-6"]),
    ("damping of constraints", true, ["", "damping=0", "damping=1e-4"]),
    ("Chebyshev", true, ["iterations=20", "iterations=20 chebyshev=none", "iterations=20 chebyshev=0.9"]),
    ("coarse levels of PBD", true, ["", "hierarchy=none", "hierarchy=1"]),
];

/// Bytes that are held after a first step, and how often memory was asked for until then.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Held {
    #[serde(rename = "without (bytes)")]
    without: i64,
    /// In excess of that without the feature, where it is set to do nothing (bytes).
    #[serde(rename = "unused − without (bytes)")]
    pub unused: i64,
    /// The same in allocations.
    #[serde(rename = "unused − without (allocations)")]
    pub unused_count: i64,
    /// In excess of that without the feature, where it is in use (bytes).
    #[serde(rename = "in use − without (bytes)")]
    pub used: i64,
    /// The same in allocations.
    #[serde(rename = "in use − without (allocations)")]
    pub used_count: i64,
    /// Allocations of a second step, where the feature is set to do nothing.
    #[serde(rename = "second step, unused (allocations)")]
    pub later: i64,
}

/// What a sheet of so many vertices a side holds with a feature.
pub fn held(n: u32, feature: &str, method: &str) -> Result<Held, BenchError> {
    // One thread, so that nothing is asked for by another.
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    alone.install(|| {
        let of = |used| -> Result<(Allocated, Allocated), BenchError> {
            let settings = settings(n, feature, used)?;
            let first = || {
                let mut variant = Variant::new(&settings, feature, method, used)?;
                variant.step()?;
                Ok::<_, BenchError>(variant)
            };
            // What is made once in a program, whoever asks first.
            drop(first()?);
            let (variant, all) = allocated(first);
            let mut variant = variant?;
            let mut state = variant.scene.start.clone();
            let (stepped, later) = allocated(|| variant.step_from(&mut state));
            stepped?;
            Ok((all, later))
        };
        let (without, _) = of(Presence::Absent)?;
        let (unused, later) = of(Presence::Unused)?;
        let (used, _) = of(Presence::InUse)?;
        Ok(Held {
            without: without.bytes,
            unused: unused.bytes - without.bytes,
            unused_count: unused.count - without.count,
            used: used.bytes - without.bytes,
            used_count: used.count - without.count,
            later: later.count,
        })
    })
}

/// Every feature with the name of every method that has it.
pub fn features() -> impl Iterator<Item = (&'static str, &'static str)> {
    let has = |&((_, of_method, settings), method): &((_, bool, [&str; 3]), &Method)| {
        let used = Settings::of(settings[2]);
        !of_method || used.among(&method.parameters()) == used
    };
    let all = iproduct!(FEATURES, method::all().collect_vec());
    all.filter(has)
        .map(|((feature, ..), method)| (feature, method.name))
}

/// Peaks (MB) of processes that take a step without a feature, with it unused, and with it in use; none where the
/// system does not tell.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Resident {
    #[serde(rename = "without (MB)")]
    without: Option<Real>,
    #[serde(rename = "unused − without (MB)")]
    unused: Option<Real>,
    #[serde(rename = "in use − without (MB)")]
    used: Option<Real>,
}

/// Those of a sheet of `n` vertices a side with a feature that is settings.
fn resident(n: u32, feature: &str, method: &str) -> Result<Resident, BenchError> {
    let known = FEATURES.iter().find(|known| known.0 == feature);
    let (_, _, settings) = known.copied().unwrap_or_default();
    let mut peaks = [None; 3];
    for (peak, settings) in peaks.iter_mut().zip(settings) {
        let size = scale::alone(method, n, 1, settings, Duration::from_secs(60))?;
        let bytes = size.map_err(BenchError::Failed)?.memory;
        *peak = bytes.map(|bytes| bytes as Real / 1e6);
    }
    let [without, unused, used] = peaks;
    let more = |peak: Option<Real>| Some(peak? - without?);
    Ok(Resident {
        without,
        unused: more(unused),
        used: more(used),
    })
}

/// All features and methods at a glance: what is held where nothing is used, allocated and resident.
fn at_a_glance(study: &mut StudyRun<'_>, rows: &[((&str, &str), Held)]) -> String {
    let n = study.scope.pick(24, 128);
    let is_setting = |&(feature, _): &(&str, &str)| {
        let mut known = FEATURES.iter().filter(|known| known.0 == feature);
        known.any(|(_, _, settings)| *settings != [""; 3])
    };
    let peaks = study.grid(
        features().filter(is_setting),
        |(feature, method)| format!("resident, {feature}, {method}"),
        |(feature, method)| resident(n, feature, method),
    );
    let peak = |row: (&str, &str)| {
        let found = peaks.iter().find(|(of, _)| *of == row);
        found.and_then(|(_, peak)| peak.unused)
    };
    let names: Vec<&str> = method::all().map(|method| method.name).collect();
    let mut table = Table::about("feature", names.iter().map(|name| (*name).to_owned()));
    for (feature, ..) in FEATURES {
        let cells = names.iter().map(|method| {
            let mut rows = rows.iter();
            let row = rows.find(|(of, _)| *of == (feature, *method));
            row.map_or(Cell::Missing, |(of, held)| {
                let resident = peak(*of).map_or(String::new(), |mb| format!(", {mb:+.1} MB"));
                Cell::said(format!("{} B{resident}", held.unused))
            })
        });
        table.line(feature, cells);
    }
    let caption = format!(
        "What a feature that is not used takes: bytes held by a sheet of {0} × {0} vertices, and how the peak of a process differs, {n} × {n} (– : the method does not have it)",
        study.scope.of(SIDE)
    );
    let shown = ("skip-features".to_owned(), caption, table);
    study.section.tables.push(shown);
    let caption = format!("Peaks of processes that take one step of the {n} × {n} sheet");
    study.table(
        "skip-resident",
        &caption,
        Table::named(&["feature", "method"], &peaks),
    );
    let unused = peaks.iter().filter_map(|(_, peak)| peak.unused);
    let most = unused.fold(0.0, |most: Real, mb| most.max(mb.abs()));
    format!("The peak of a process differs by {most:.1} MB at most where a feature is unused.")
}

/// Measures all, and says what is not free.
pub(super) fn run(study: &mut StudyRun<'_>) -> String {
    let n = study.scope.of(SIDE);
    let rows = study.grid(
        features(),
        |(feature, method)| format!("memory, {feature}, {method}"),
        |(feature, method)| held(n, feature, method),
    );
    let caption =
        format!("Memory of the {n} × {n} sheet with and without a feature, after one step");
    let peaks = at_a_glance(study, &rows);
    let table = Table::named(&["feature", "method"], &rows);
    study.table("skip-memory", &caption, table);
    let costly = rows.iter().filter(|(_, held)| held.unused != 0);
    let costly = costly
        .map(|((feature, _), _)| *feature)
        .dedup()
        .collect_vec();
    let most = rows.iter().map(|(_, held)| held.unused).max().unwrap_or(0);
    format!(
        "Of {} features {} hold no memory where they are not used; the others ({}) up to {:.0} kB, which a contact hook holds for the mesh that it was made for. {peaks}",
        FEATURES.len(),
        FEATURES.len() - costly.len(),
        costly.join(", "),
        1e-3 * most as Real
    )
}

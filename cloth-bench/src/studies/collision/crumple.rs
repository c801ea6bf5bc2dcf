//! A crumpled sheet: what the search for candidates costs, and contact itself, as the sheet gets finer.

use crate::crumpled::{BROAD_PHASES, NewBroadPhase, accordion, boxes};
use crate::studies::interleaved::timed;
use crate::studies::prelude::*;
use cloth_collide::potential::PotentialContacts;
use cloth_collide::{Bounds, BroadPhase, ClothCandidates, Hierarchy};
use cloth_core::contact::{ContactStep, Projection};
use cloth_core::mesh::TriMesh;

const DT: Real = 1.0 / 600.0;
/// Every time is the shortest of so many.
const REPETITIONS: usize = 5;
/// Layers are this far apart, in thicknesses.
const GAP: Real = 1.1;
/// What the height of the pile is pressed to.
const PRESSED: Real = 0.9;

const SIDES: [&[usize]; 2] = [&[33], &[33, 129, 321]];

/// The accordion with `side` vertices a side. The distance of the layers shrinks with the triangles, so that a vertex
/// has as many neighbours in a fine sheet as in a coarse one. Also gives the thickness (m) of such a cloth.
fn crumpled(side: usize) -> Result<(TriMesh, Vec<Vec3>, Real), BenchError> {
    let thickness = 0.256 / side as Real;
    let (mesh, positions) = accordion(side, GAP * thickness)?;
    Ok((mesh, positions, thickness))
}

/// The shortest time (ms) of some runs of `work`, which tells itself how long it took (s).
fn shortest(mut work: impl FnMut() -> Result<Real, BenchError>) -> Result<Real, BenchError> {
    let mut least = Real::INFINITY;
    for _ in 0..REPETITIONS {
        least = least.min(1e3 * work()?);
    }
    Ok(least)
}

/// How long (s) `work` takes, which cannot fail.
fn seconds<T>(work: impl FnOnce() -> T) -> Result<Real, BenchError> {
    timed(|| Ok(work()))
}

/// Times (ms) of making the tree, letting it follow its boxes, and searching it.
type Tree = (usize, Real, Real, Real);
const TREE: [&str; 4] = ["triangles", "build (ms)", "refit (ms)", "search (ms)"];

fn tree_alone(triangles: usize, boxes: &[Bounds]) -> Result<Tree, BenchError> {
    let mut tree = Hierarchy::over(boxes);
    let build = shortest(|| seconds(|| Hierarchy::over(boxes)))?;
    let refit = shortest(|| seconds(|| tree.refit(boxes.iter().copied())))?;
    let mut pairs = Vec::new();
    let query = shortest(|| {
        pairs.clear();
        seconds(|| tree.visit_overlapping(|a, b| pairs.push([a, b])))
    })?;
    Ok((triangles, build, refit, query))
}

/// A broad phase: its first search, memory and the shape of a tree included, a later one, and all from positions to
/// sorted candidates.
type Search = (usize, String, Real, Real, usize, Real, usize, Real);
const SEARCH: [&str; 8] = [
    "triangles",
    "broad phase",
    "first (ms)",
    "again (ms)",
    "pairs of triangles",
    "candidates (ms)",
    "candidates",
    "candidates, ns a triangle",
];

fn search(
    (name, new): (&str, NewBroadPhase),
    mesh: &TriMesh,
    positions: &[Vec3],
    boxes: &[Bounds],
    margin: Real,
) -> Result<Search, BenchError> {
    let mut pairs = Vec::new();
    let first = shortest(|| {
        let mut fresh = new();
        seconds(|| fresh.overlapping(boxes, &mut pairs))
    })?;
    let mut warm = new();
    let again = shortest(|| seconds(|| warm.overlapping(boxes, &mut pairs)))?;
    let mut candidates = ClothCandidates::new(mesh, new());
    let all = shortest(|| Ok(timed(|| candidates.update(positions, positions, margin))?))?;
    let found = candidates.vertex_triangle().len() + candidates.edge_edge().len();
    let triangles = mesh.triangle_count();
    let each = 1e6 * all / triangles as Real;
    let (name, pairs) = (name.to_owned(), pairs.len());
    Ok((triangles, name, first, again, pairs, all, found, each))
}

/// Sweeps over the contacts of a step.
const SWEEPS: u32 = 4;

/// A step in which nothing moves.
fn stay(
    contacts: &mut PotentialContacts,
    from: &[Vec3],
    inverse_mass: &[Real],
) -> Result<(), BenchError> {
    let step = ContactStep {
        from,
        inverse_mass,
        dt: DT,
    };
    let mut velocities = vec![Vec3::zeros(); from.len()];
    let x = &mut from.to_vec();
    let stayed = Projection::default().step(contacts, &step, SWEEPS, x, &mut velocities);
    stayed.map_err(BenchError::failed)
}

/// Time (ms) of resolving a step from `from` to where `end` (m) takes each position.
fn resolve(
    contacts: &mut PotentialContacts,
    from: &[Vec3],
    end: impl Fn(&Vec3) -> Vec3,
) -> Result<Real, BenchError> {
    let inverse_mass = vec![1e4; from.len()];
    let mut projection = Projection::default();
    shortest(|| {
        // Where the last step ended, the next one may start without a look at all pairs of triangles: so it is in a
        // simulation.
        stay(contacts, from, &inverse_mass)?;
        let mut positions = from.iter().map(&end).collect_vec();
        let velocities = positions.iter().zip(from).map(|(a, b)| (a - b) / DT);
        let mut velocities = velocities.collect_vec();
        let step = ContactStep {
            from,
            inverse_mass: &inverse_mass,
            dt: DT,
        };
        let (x, v) = (&mut positions, &mut velocities);
        Ok(timed(|| projection.step(contacts, &step, SWEEPS, x, v))?)
    })
}

/// Time (ms) of a step of a hanging sheet of the same size, without contact.
fn step(method: &str, side: usize) -> Result<Real, BenchError> {
    let scene = scene::build("hang", None, &Settings::default().with("n", side))?;
    let mut stepper = Method::find(method)?.build(&scene, &Settings::default(), scene.dt)?;
    let mut state = scene.start.clone();
    shortest(|| {
        let input = StepInput::new(scene.dt).gravity(scene.gravity);
        Ok(timed(|| stepper.step(&mut state, input))?)
    })
}

/// What contact costs, beside steps where these were taken.
#[derive(Default, Serialize, Deserialize)]
struct Cost {
    triangles: usize,
    #[serde(rename = "moves as one (ms)")]
    together: Real,
    #[serde(rename = "pressed (ms)")]
    pressed: Real,
    pairs_looked_at: usize,
    rows: usize,
    #[serde(rename = "pressed, µs a triangle")]
    per_triangle: Real,
    #[serde(rename = "XPBD step (ms)")]
    xpbd: Option<Real>,
    #[serde(rename = "PD step (ms)")]
    pd: Option<Real>,
    #[serde(rename = "pressed / XPBD step")]
    in_xpbd: Option<Real>,
    #[serde(rename = "pressed / PD step")]
    in_pd: Option<Real>,
}

/// What a sheet of so many vertices a side costs.
fn measure(side: usize) -> Result<(Tree, Vec<Search>, Cost), BenchError> {
    let (mesh, from, thickness) = crumpled(side)?;
    let triangles = mesh.triangle_count();
    let margin = 2.0 * thickness;
    let boxes = boxes(&mesh, &from, margin);
    let tree = tree_alone(triangles, &boxes)?;
    let searches = BROAD_PHASES.into_iter();
    let searches = searches.map(|phase| search(phase, &mesh, &from, &boxes, margin));
    let searches = searches.try_collect()?;
    let builder = PotentialContacts::builder(&mesh);
    let mut contacts = builder.thickness(thickness).friction(0.3).build()?;
    let shift = Vec3::new(0.01, 0.0, 0.02);
    let together = resolve(&mut contacts, &from, |x| x + shift)?;
    let pressed = resolve(&mut contacts, &from, |x| Vec3::new(x.x, x.y, PRESSED * x.z))?;
    let report = contacts.constraint_report();
    // At the finest size the factor of PD alone takes longer than all the rest.
    let [xpbd, pd] = match side < 200 {
        true => [Some(step("xpbd", side)?), Some(step("pd", side)?)],
        false => [None; 2],
    };
    let cost = Cost {
        triangles,
        together,
        pressed,
        pairs_looked_at: report.queries as usize,
        rows: report.constraints as usize,
        per_triangle: 1e3 * pressed / triangles as Real,
        xpbd,
        pd,
        in_xpbd: xpbd.map(|step| pressed / step),
        in_pd: pd.map(|step| pressed / step),
    };
    Ok((tree, searches, cost))
}

/// Adds the tables, and says what contact costs.
pub(super) fn run(study: &mut StudyRun<'_>) -> Option<String> {
    let found = study.grid(
        study.scope.of(SIDES).iter().copied(),
        |side| format!("crumpled sheet, {side} × {side}"),
        |&side| measure(side),
    );
    let found = found.into_iter().map(|(_, found)| found);
    let (tree, searches, costs): (Vec<_>, Vec<_>, Vec<_>) = found.multiunzip();
    study.table(
        "collision-broad-phase",
        "Candidates of a crumpled sheet, from three broad phases that find the same ones",
        Table::named(&SEARCH, &searches.concat()),
    );
    study.table(
        "collision-tree",
        "The tree of boxes (parry's Bvh) alone, over the triangles of the same sheet",
        Table::named(&TREE, &tree),
    );
    study.table(
        "collision-cost",
        "One resolved step of a crumpled sheet, beside a step of a method without contact",
        &costs,
    );
    let growth = match &costs[..] {
        [smallest, .., largest] => format!(
            "; per triangle the largest sheet takes {:.1} times as long as the smallest",
            largest.per_triangle / smallest.per_triangle
        ),
        _ => String::new(),
    };
    let compared = costs
        .iter()
        .rev()
        .find_map(|cost| Some((cost.triangles, cost.in_xpbd?, cost.in_pd?)));
    let (triangles, xpbd, pd) = compared?;
    Some(format!(
        "In a pile of sixteen layers, {triangles} triangles in all, resolving a step costs {xpbd:.1} steps of XPBD or {pd:.1} of PD{growth}."
    ))
}

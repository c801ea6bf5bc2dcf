//! A crumpled sheet: what the search for candidates costs, and contact itself, as the sheet gets finer.

use super::super::{Findings, Scope};
use crate::crumpled::{BROAD_PHASES, NewBroadPhase, accordion, boxes};
use crate::studies::prelude::*;
use cloth_collide::potential::PotentialContacts;
use cloth_collide::{Bounds, BroadPhase, ClothCandidates, Hierarchy};
use cloth_core::contact::{ContactStep, Projection};
use cloth_core::mesh::TriMesh;
use std::time::Instant;

const DT: Real = 1.0 / 600.0;
/// Every time is the shortest of so many.
const REPETITIONS: usize = 5;
/// Layers are this far apart, in thicknesses.
const GAP: Real = 1.1;
/// What the height of the pile is pressed to.
const PRESSED: Real = 0.9;

fn sides(scope: Scope) -> &'static [usize] {
    scope.pick(&[33], &[33, 129, 321])
}

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

/// How long (s) `work` takes.
fn timed<T>(work: impl FnOnce() -> T) -> Real {
    let started = Instant::now();
    std::hint::black_box(work());
    started.elapsed().as_secs_f64()
}

/// The row of the tree: making it, letting it follow its boxes, and searching it.
fn tree_alone(triangles: usize, boxes: &[Bounds]) -> Result<[(&'static str, Cell); 4], BenchError> {
    let mut tree = Hierarchy::over(boxes);
    let build = shortest(|| Ok(timed(|| Hierarchy::over(boxes))))?;
    let refit = shortest(|| Ok(timed(|| tree.refit(boxes.iter().copied()))))?;
    let mut pairs = Vec::new();
    let query = shortest(|| {
        pairs.clear();
        Ok(timed(|| tree.visit_overlapping(|a, b| pairs.push([a, b]))))
    })?;
    Ok([
        ("triangles", Cell::from(triangles)),
        ("build (ms)", Cell::from(build)),
        ("refit (ms)", Cell::from(refit)),
        ("search (ms)", Cell::from(query)),
    ])
}

/// The row of a broad phase: its first search, memory and the shape of a tree included, a later one, and all from
/// positions to sorted candidates.
fn search(
    name: &str,
    new: NewBroadPhase,
    mesh: &TriMesh,
    positions: &[Vec3],
    boxes: &[Bounds],
    margin: Real,
) -> Result<[(&'static str, Cell); 8], BenchError> {
    let mut pairs = Vec::new();
    let first = shortest(|| {
        let mut fresh = new();
        Ok(timed(|| fresh.overlapping(boxes, &mut pairs)))
    })?;
    let mut warm = new();
    let again = shortest(|| Ok(timed(|| warm.overlapping(boxes, &mut pairs))))?;
    let mut candidates = ClothCandidates::new(mesh, new());
    let all = shortest(|| {
        let started = Instant::now();
        candidates.update(positions, positions, margin)?;
        Ok(started.elapsed().as_secs_f64())
    })?;
    let found = candidates.vertex_triangle().len() + candidates.edge_edge().len();
    let triangles = mesh.triangle_count();
    Ok([
        ("triangles", Cell::from(triangles)),
        ("broad phase", Cell::from(name)),
        ("first (ms)", Cell::from(first)),
        ("again (ms)", Cell::from(again)),
        ("pairs of triangles", Cell::from(pairs.len())),
        ("candidates (ms)", Cell::from(all)),
        ("candidates", Cell::from(found)),
        (
            "candidates, ns a triangle",
            Cell::from(1e6 * all / triangles as Real),
        ),
    ])
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
        let mut positions: Vec<_> = from.iter().map(&end).collect();
        let mut velocities: Vec<_> = positions
            .iter()
            .zip(from)
            .map(|(a, b)| (a - b) / DT)
            .collect();
        let step = ContactStep {
            from,
            inverse_mass: &inverse_mass,
            dt: DT,
        };
        let started = Instant::now();
        let (x, v) = (&mut positions, &mut velocities);
        projection.step(contacts, &step, SWEEPS, x, v)?;
        Ok(started.elapsed().as_secs_f64())
    })
}

/// Time (ms) of a step of a hanging sheet of the same size, without contact.
fn step(method: &str, side: usize) -> Result<Real, BenchError> {
    let scene = scene::build("hang", None, &Settings::default().with("n", side))?;
    let mut stepper = Method::find(method)?.build(&scene, &Settings::default(), scene.dt)?;
    let mut state = scene.start.clone();
    shortest(|| {
        let started = Instant::now();
        let input = StepInput::new(scene.dt).gravity(scene.gravity);
        stepper.step(&mut state, input)?;
        Ok(started.elapsed().as_secs_f64())
    })
}

/// What contact costs at the finest size where it was compared with steps.
#[derive(Clone, Copy, Debug, Default)]
struct Cost {
    triangles: usize,
    /// Resolving a pressed pile, in steps of XPBD and of PD.
    in_steps: [Real; 2],
}

/// Adds both tables, and says what contact costs.
pub(super) fn run(
    scope: Scope,
    findings: &mut Findings,
    progress: &mut dyn FnMut(&str),
) -> Result<String, BenchError> {
    let mut searches = Table::default();
    let mut tree = Table::default();
    let mut costs = Table::default();
    let mut cost = Cost::default();
    let mut each = Vec::new();
    for &side in sides(scope) {
        let (mesh, from, thickness) = crumpled(side)?;
        let triangles = mesh.triangle_count();
        progress(&format!(
            "collision: crumpled sheet of {triangles} triangles"
        ));
        let margin = 2.0 * thickness;
        let boxes = boxes(&mesh, &from, margin);
        tree.push(tree_alone(triangles, &boxes)?);
        for (name, new) in BROAD_PHASES {
            searches.push(search(name, new, &mesh, &from, &boxes, margin)?);
        }
        let builder = PotentialContacts::builder(&mesh)
            .thickness(thickness)
            .friction(0.3);
        let mut contacts = builder.build()?;
        let shift = Vec3::new(0.01, 0.0, 0.02);
        let together = resolve(&mut contacts, &from, |x| x + shift)?;
        let pressed = resolve(&mut contacts, &from, |x| Vec3::new(x.x, x.y, PRESSED * x.z))?;
        // At the finest size the factor of PD alone takes longer than all the rest.
        let steps = (side < 200)
            .then(|| Ok::<_, BenchError>([step("xpbd", side)?, step("pd", side)?]))
            .transpose()?;
        if let Some(steps) = steps {
            (cost.triangles, cost.in_steps) = (triangles, steps.map(|step| pressed / step));
        }
        let per_triangle = pressed / triangles as Real;
        each.push(per_triangle);
        costs.push([
            ("triangles", Cell::from(triangles)),
            ("moves as one (ms)", Cell::from(together)),
            ("pressed (ms)", Cell::from(pressed)),
            (
                "pairs looked at",
                Cell::from(contacts.constraint_report().looked as usize),
            ),
            (
                "rows",
                Cell::from(contacts.constraint_report().rows as usize),
            ),
            ("pressed, µs a triangle", Cell::from(1e3 * per_triangle)),
            ("XPBD step (ms)", Cell::from(steps.map(|s| s[0]))),
            ("PD step (ms)", Cell::from(steps.map(|s| s[1]))),
            (
                "pressed / XPBD step",
                Cell::from(steps.map(|s| pressed / s[0])),
            ),
            (
                "pressed / PD step",
                Cell::from(steps.map(|s| pressed / s[1])),
            ),
        ]);
    }
    findings.table(
        "collision-broad-phase",
        "Candidates of a crumpled sheet, from three broad phases that find the same ones",
        searches,
    );
    findings.table(
        "collision-tree",
        "The tree of boxes (parry's Bvh) alone, over the triangles of the same sheet",
        tree,
    );
    findings.table(
        "collision-cost",
        "One resolved step of a crumpled sheet, beside a step of a method without contact",
        costs,
    );
    let [xpbd, pd] = cost.in_steps;
    let growth = match each[..] {
        [smallest, .., largest] => format!(
            "; per triangle the largest sheet takes {:.1} times as long as the smallest",
            largest / smallest
        ),
        _ => String::new(),
    };
    Ok(format!(
        "In a pile of sixteen layers, {} triangles in all, resolving a step costs {xpbd:.1} steps of XPBD or {pd:.1} of PD{growth}.",
        cost.triangles
    ))
}

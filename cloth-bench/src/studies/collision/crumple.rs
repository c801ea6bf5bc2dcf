//! A crumpled sheet: what the search for candidates costs, and contact itself, as the sheet gets finer.

use super::super::{Findings, Scope};
use crate::error::BenchError;
use crate::method::Method;
use crate::report::table::{Cell, Table};
use crate::scene;
use crate::settings::Settings;
use cloth_collide::{
    BroadPhase, ClothCandidates, ClothContacts, Hierarchy, MortonGrid, SpatialHash,
};
use cloth_core::contact::{ContactSource, ContactStep};
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{Diagonals, grid};
use cloth_core::step::StepInput;
use std::time::Instant;

const DT: Real = 1.0 / 600.0;
/// Every time is the shortest of so many.
const REPETITIONS: usize = 5;
/// Layers are this far apart, in thicknesses.
const GAP: Real = 2.0;

fn sides(scope: Scope) -> &'static [usize] {
    match scope {
        Scope::Quick => &[33],
        Scope::Full => &[33, 129, 321],
    }
}

/// Number of progress reports.
pub(super) fn cases(scope: Scope) -> usize {
    sides(scope).len()
}

/// Back and forth over `width` (m), and up by `gap` (m) each time.
fn folded(x: Real, width: Real, gap: Real) -> (Real, Real) {
    let layer = (x / width).floor();
    let part = x / width - layer;
    let along = if layer % 2.0 == 0.0 { part } else { 1.0 - part };
    (along * width, gap * (layer + part))
}

/// A sheet of 1 m × 1 m with `side` vertices a side, and its positions (m) folded as an accordion in both directions, eight layers and four piles of those, with noise. The distance of the layers shrinks
/// with the triangles, so that a vertex has as many neighbours in a fine sheet as in a coarse one. Also gives the thickness (m) of such a cloth.
fn crumpled(side: usize) -> Result<(TriMesh, Vec<Vec3>, Real), BenchError> {
    let mesh = grid(side, side, 1.0, 1.0, Diagonals::Alternating).map_err(BenchError::failed)?;
    let thickness = 0.256 / side as Real;
    let gap = GAP * thickness;
    let noise = |i: usize, k: Real| 0.1 * gap * (12.9898 * i as Real + 78.233 * k).sin();
    let place = |(i, x): (usize, &Vec3)| {
        let (along, up) = folded(x.x, 0.125, gap);
        let (across, above) = folded(x.y, 0.25, 10.0 * gap);
        Vec3::new(along, across, up + above)
            + Vec3::new(noise(i, 1.0), noise(i, 2.0), noise(i, 3.0))
    };
    let positions = mesh.positions().iter().enumerate().map(place).collect();
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

/// Time (ms) of finding the candidates with a broad phase, its first build not included.
fn search<B: BroadPhase>(
    kind: B,
    mesh: &TriMesh,
    positions: &[Vec3],
    margin: Real,
) -> Result<(Real, usize), BenchError> {
    let mut candidates = ClothCandidates::new(mesh, kind);
    let time = shortest(|| {
        let started = Instant::now();
        let found = candidates.update(positions, positions, margin);
        found.map_err(BenchError::failed)?;
        Ok(started.elapsed().as_secs_f64())
    })?;
    let pairs = candidates.vertex_triangle().len() + candidates.edge_edge().len();
    Ok((time, pairs))
}

/// Time (ms) of resolving a step from `from` to where `end` (m) takes each position.
fn resolve(
    contacts: &mut ClothContacts,
    from: &[Vec3],
    end: impl Fn(&Vec3) -> Vec3,
) -> Result<Real, BenchError> {
    let inverse_mass = vec![1e4; from.len()];
    shortest(|| {
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
        let resolved = contacts.resolve(&step, &mut positions, &mut velocities);
        resolved.map_err(BenchError::failed)?;
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
        stepper
            .step(&mut state, input)
            .map_err(BenchError::failed)?;
        Ok(started.elapsed().as_secs_f64())
    })
}

/// What contact costs at the finest size where it was compared with steps.
#[derive(Clone, Copy, Debug, Default, serde::Serialize, serde::Deserialize)]
pub(super) struct Cost {
    pub(super) triangles: usize,
    /// Resolving a pressed pile, in steps of XPBD and of PD.
    pub(super) in_steps: [Real; 2],
    /// Time per triangle at the finest size over that at the coarsest.
    pub(super) growth: Real,
}

/// Adds both tables.
pub(super) fn run(
    scope: Scope,
    findings: &mut Findings,
    progress: &mut dyn FnMut(&str),
) -> Result<Cost, BenchError> {
    let mut searches = Table::new(&[
        "triangles",
        "candidates",
        "tree (ms)",
        "hashed cells (ms)",
        "cells along a curve (ms)",
        "tree, ns a triangle",
    ]);
    let mut costs = Table::new(&[
        "triangles",
        "moves as one (ms)",
        "pressed (ms)",
        "contacts",
        "pressed, µs a triangle",
        "XPBD step (ms)",
        "PD step (ms)",
        "pressed / XPBD step",
        "pressed / PD step",
    ]);
    let mut cost = Cost::default();
    let mut each = Vec::new();
    for &side in sides(scope) {
        let (mesh, from, thickness) = crumpled(side)?;
        let triangles = mesh.triangle_count();
        progress(&format!(
            "collision: crumpled sheet of {triangles} triangles"
        ));
        let margin = 2.0 * thickness;
        let (tree, pairs) = search(Hierarchy::new(), &mesh, &from, margin)?;
        let (hash, _) = search(SpatialHash::new(), &mesh, &from, margin)?;
        let (curve, _) = search(MortonGrid::new(), &mesh, &from, margin)?;
        searches.push([
            Cell::from(triangles),
            Cell::from(pairs),
            Cell::from(tree),
            Cell::from(hash),
            Cell::from(curve),
            Cell::from(1e6 * tree / triangles as Real),
        ]);
        let builder = ClothContacts::builder(&mesh)
            .thickness(thickness)
            .friction(0.3);
        let mut contacts = builder.build().map_err(BenchError::failed)?;
        let shift = Vec3::new(0.01, 0.0, 0.02);
        let together = resolve(&mut contacts, &from, |x| x + shift)?;
        let pressed = resolve(&mut contacts, &from, |x| Vec3::new(x.x, x.y, 0.99 * x.z))?;
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
            Cell::from(triangles),
            Cell::from(together),
            Cell::from(pressed),
            Cell::from(contacts.report().contacts),
            Cell::from(1e3 * per_triangle),
            Cell::from(steps.map(|s| s[0])),
            Cell::from(steps.map(|s| s[1])),
            Cell::from(steps.map(|s| pressed / s[0])),
            Cell::from(steps.map(|s| pressed / s[1])),
        ]);
    }
    cost.growth = each[each.len() - 1] / each[0];
    findings.table(
        "collision-broad-phase",
        "Candidates of a crumpled sheet, from three broad phases that find the same ones",
        searches,
    );
    findings.table(
        "collision-cost",
        "One resolved step of a crumpled sheet, beside a step of a method without contact",
        costs,
    );
    Ok(cost)
}

//! A sheet folded as an accordion, and the broad phases: what searching and contact are measured with.

use crate::error::BenchError;
use cloth_collide::{Bounds, BroadPhase, Hierarchy, MortonGrid, SpatialHash};
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{Diagonals, grid};

/// Layers of the accordion.
pub const LAYERS: u32 = 16;

/// Back and forth over `width` (m), and up by `gap` (m) each time.
fn folded(x: Real, width: Real, gap: Real) -> (Real, Real) {
    let layer = (x / width).floor();
    let part = x / width - layer;
    let along = if layer % 2.0 == 0.0 { part } else { 1.0 - part };
    (along * width, gap * (layer + part))
}

/// A sheet of 1 m × 1 m with `side` vertices a side, and its positions (m) folded in one direction into [`LAYERS`]
/// layers, `gap` (m) apart on average, with noise of a fiftieth of that. Pleats that are folded again, in the other
/// direction, would pass through each other at the crease.
pub fn accordion(side: usize, gap: Real) -> Result<(TriMesh, Vec<Vec3>), BenchError> {
    let mesh = grid(side, side, 1.0, 1.0, Diagonals::Alternating)?;
    let noise = |i: usize, k: Real| 0.02 * gap * (12.9898 * i as Real + 78.233 * k).sin();
    let place = |(i, x): (usize, &Vec3)| {
        let (along, up) = folded(x.x, 1.0 / Real::from(LAYERS), gap);
        Vec3::new(along, x.y, up) + Vec3::new(noise(i, 1.0), noise(i, 2.0), noise(i, 3.0))
    };
    let positions = mesh.positions().iter().enumerate().map(place).collect();
    Ok((mesh, positions))
}

/// The box of each triangle at `positions` (m), moved outwards by half of the margin (m).
pub fn boxes(mesh: &TriMesh, positions: &[Vec3], margin: Real) -> Vec<Bounds> {
    let half = Vec3::repeat(0.5 * margin);
    let around = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| positions[v as usize]);
        Bounds {
            lower: a.inf(&b).inf(&c) - half,
            upper: a.sup(&b).sup(&c) + half,
        }
    };
    mesh.triangles().iter().map(around).collect()
}

/// Makes a broad phase.
pub type NewBroadPhase = fn() -> Box<dyn BroadPhase>;

/// Every broad phase, by name.
pub const BROAD_PHASES: [(&str, NewBroadPhase); 3] = [
    ("hierarchy", || Box::new(Hierarchy::default())),
    ("spatial hash", || Box::new(SpatialHash::default())),
    ("morton grid", || Box::new(MortonGrid::default())),
];

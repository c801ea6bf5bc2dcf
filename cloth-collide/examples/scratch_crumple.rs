//! scratch
#![allow(missing_docs, clippy::all)]
use cloth_collide::*;
use cloth_core::contact::{ContactSource, ContactStep};
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{Diagonals, grid};
use std::time::Instant;
const DT: Real = 1.0 / 600.0;
const REPETITIONS: usize = 5;
const GAP: Real = 2.0;
/// Back and forth over `width` (m), and up by `gap` (m) each time.
fn folded(x: Real, width: Real, gap: Real) -> (Real, Real) {
    let layer = (x / width).floor();
    let part = x / width - layer;
    let along = if layer % 2.0 == 0.0 { part } else { 1.0 - part };
    (along * width, gap * (layer + part))
}

/// A sheet of 1 m × 1 m with `side` vertices a side, and its positions (m) folded as an accordion of sixteen layers, with noise. The distance of the layers shrinks
/// with the triangles, so that a vertex has as many neighbours in a fine sheet as in a coarse one. Also gives the thickness (m) of such a cloth.
fn crumpled(side: usize) -> Result<(TriMesh, Vec<Vec3>, Real), String> {
    let mesh = grid(side, side, 1.0, 1.0, Diagonals::Alternating).map_err(|e| e.to_string())?;
    let thickness = 0.256 / side as Real;
    let gap = GAP * thickness;
    let noise = |i: usize, k: Real| 0.02 * gap * (12.9898 * i as Real + 78.233 * k).sin();
    let place = |(i, x): (usize, &Vec3)| {
        let (along, up) = folded(x.x, 1.0 / 16.0, gap);
        Vec3::new(along, x.y, up) + Vec3::new(noise(i, 1.0), noise(i, 2.0), noise(i, 3.0))
    };
    let positions = mesh.positions().iter().enumerate().map(place).collect();
    Ok((mesh, positions, thickness))
}

/// The shortest time (ms) of some runs of `work`, which tells itself how long it took (s).
fn shortest(mut work: impl FnMut() -> Result<Real, String>) -> Result<Real, String> {
    let mut least = Real::INFINITY;
    for _ in 0..REPETITIONS {
        least = least.min(1e3 * work()?);
    }
    Ok(least)
}

/// Time (ms) of resolving a step from `from` to where `end` (m) takes each position.
fn resolve(
    contacts: &mut ClothContacts,
    from: &[Vec3],
    end: impl Fn(&Vec3) -> Vec3,
) -> Result<Real, String> {
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
        resolved.map_err(|e| e.to_string())?;
        Ok(started.elapsed().as_secs_f64())
    })
}

fn main() {
    for side in [33, 129] {
        let (mesh, from, thickness) = crumpled(side).unwrap();
        println!(
            "{side}: crossings {:?}",
            SeparationProbe::new(&mesh).measure(&from).unwrap()
        );
        let mut c = ClothContacts::builder(&mesh)
            .thickness(thickness)
            .friction(0.3)
            .build()
            .unwrap();
        let shift = Vec3::new(0.01, 0.0, 0.02);
        println!("together {:?} ms", resolve(&mut c, &from, |x| x + shift));
        println!(
            "pressed {:?} ms {:?}",
            resolve(&mut c, &from, |x| Vec3::new(x.x, x.y, 0.99 * x.z)),
            c.report()
        );
    }
}

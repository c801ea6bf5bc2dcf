//! What locking looks like: one sheet, folded along the diagonals of its mesh and across them.

use super::fold::{self, Axis};
use super::sheet::Kind;
use crate::error::BenchError;
use crate::report::html::Picture;
use crate::report::render::{Surface, View, render_row};
use crate::studies::Findings;
use cloth_core::math::Vec3;

const CELLS: usize = 16;
/// Y (N/m) and D (N·m): a thin cloth that would hang down almost straight.
const STIFFNESS: [f64; 2] = [1e6, 2e-4];

pub(super) fn draw(
    findings: &mut Findings,
    progress: &mut dyn FnMut(&str),
) -> Result<(), BenchError> {
    let mut shapes = Vec::new();
    for (name, axis, kind) in [
        ("along the diagonals", Axis::Along, Kind::Springs),
        ("across them", Axis::Across, Kind::Springs),
        ("across, on edge midpoints", Axis::Across, Kind::Midpoints),
    ] {
        progress(&format!("locking: picture, {name}"));
        let folded = fold::fold(axis, "one-way", CELLS, kind, STIFFNESS)?;
        // All folds are seen along their axis.
        let vertices = folded.sheet.vertices(&folded.rest.points);
        let away = axis.directions()[1];
        let along = Vec3::z().cross(&away); // the same hand for both
        let turned: Vec<Vec3> = vertices
            .iter()
            .map(|p| Vec3::new(p.dot(&away), p.dot(&along), p.z))
            .collect();
        let middle = turned.iter().sum::<Vec3>() / turned.len() as f64;
        let centred: Vec<Vec3> = turned
            .iter()
            .map(|p| Vec3::new(p.x - middle.x, p.y - middle.y, p.z))
            .collect();
        let exact = folded.exact.exact_angle();
        shapes.push((name, centred, folded.sheet.mesh, folded.angle, exact));
    }
    let surfaces: Vec<[Surface<'_>; 1]> = shapes
        .iter()
        .map(|(_, positions, mesh, ..)| [Surface::cloth(positions, mesh.triangles())])
        .collect();
    let tiles: Vec<&[Surface<'_>]> = surfaces.iter().map(|s| &s[..]).collect();
    let view = View {
        width: 400,
        height: 360,
        direction: Vec3::new(-0.35, 0.85, -0.35),
        wire: 0.5,
        ..View::default()
    };
    let told: Vec<String> = shapes
        .iter()
        .map(|(name, _, _, angle, exact)| {
            format!("{name} (its corners hang {angle:.0}° below the clamp; an inextensible cloth {exact:.0}°)")
        })
        .collect();
    findings.section.pictures.push(Picture {
        png: render_row(&tiles, &view).map_err(BenchError::failed)?,
        caption: format!(
            "One sheet of {CELLS} × {CELLS} cells with one-way diagonals and stiff springs, held along its middle and hanging under its own weight. From left to right: folded {}.",
            told.join("; ")
        ),
    });
    Ok(())
}

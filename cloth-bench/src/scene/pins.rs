//! Which vertices are held.

use crate::error::BenchError;
use cloth_core::math::{Real, Vec3};
use cloth_core::particles::ParticleError;

/// A vertex counts as one of the highest if it is no farther below the top than this fraction of the height.
const HIGHEST: Real = 0.01;

/// The vertices that `text` names: `none`, `corners` (of the sheet seen along `up`, both at one end of it), `highest`,
/// or numbers.
pub fn chosen(text: &str, positions: &[Vec3], up: Vec3) -> Result<Vec<usize>, BenchError> {
    match text {
        "none" => Ok(Vec::new()),
        "corners" => Ok(corners(positions, up)),
        "highest" => Ok(highest(positions, up)),
        numbers => numbers
            .split(',')
            .map(|number| numbered(number, text, positions.len()))
            .collect(),
    }
}

fn numbered(number: &str, text: &str, vertex_count: usize) -> Result<usize, BenchError> {
    let vertex: usize = number.trim().parse().map_err(|_| {
        BenchError::Usage(format!(
            "pins is `{text}`, but it has to be none, corners, highest, or vertex numbers such as 0,32"
        ))
    })?;
    if vertex < vertex_count {
        return Ok(vertex);
    }
    Err(BenchError::usage(ParticleError::NoSuchVertex {
        vertex,
        vertex_count,
    }))
}

fn highest(positions: &[Vec3], up: Vec3) -> Vec<usize> {
    let height = |p: &Vec3| p.dot(&up);
    let top = positions
        .iter()
        .map(height)
        .fold(Real::NEG_INFINITY, Real::max);
    let bottom = positions.iter().map(height).fold(Real::INFINITY, Real::min);
    let limit = top - HIGHEST * (top - bottom);
    (0..positions.len())
        .filter(|&v| height(&positions[v]) >= limit)
        .collect()
}

/// The two vertices that lie farthest out in the two diagonal directions on one side of the sheet: where up is z on
/// that of the largest y, where it is y on that of the smallest z, and where it is x on that of the largest z.
pub fn corners(positions: &[Vec3], up: Vec3) -> Vec<usize> {
    let across = if up.x.abs() > 0.5 {
        Vec3::y()
    } else {
        Vec3::x()
    };
    let along = up.cross(&across);
    let farthest = |direction: Vec3| {
        (0..positions.len()).max_by(|&a, &b| {
            positions[a]
                .dot(&direction)
                .total_cmp(&positions[b].dot(&direction))
                .then(b.cmp(&a))
        })
    };
    let mut found: Vec<usize> = [along - across, along + across]
        .into_iter()
        .filter_map(farthest)
        .collect();
    found.dedup();
    found
}

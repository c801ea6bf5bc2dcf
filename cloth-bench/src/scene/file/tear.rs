//! `[[event]]` that tears: triangles vanish.

use super::document::Section;
use super::event::refuse_motion;
use super::gas::{self, Inside};
use super::keys::{Deed, Event, Selection};
use super::material::Material;
use super::selection;
use crate::error::BenchError;
use crate::scene::{Change, ChangeKind};
use crate::settings::Setting;
use cloth_core::math::{Real, Vec3, gather};
use cloth_core::mesh::TriMesh;

/// A line that goes along an edge is moved to its left by this part of a triangle's size.
const ASIDE: Real = 1e-3;

/// Where triangles are torn out.
enum Place {
    /// Its lowest and its highest corner (m).
    Box([Vec3; 2]),
    /// Its ends (m).
    Line([Vec3; 2]),
}

impl Place {
    /// Whether a triangle with these corners (m) is there: its middle in the box; or the line across it, seen along its
    /// normal, no farther from its plane than it is large.
    fn has(&self, x: [Vec3; 3]) -> bool {
        let [a, b] = match self {
            Self::Box([low, high]) => {
                let middle = x.iter().sum::<Vec3>() / 3.0;
                return (0..3).all(|axis| (low[axis]..=high[axis]).contains(&middle[axis]));
            }
            Self::Line(ends) => *ends,
        };
        let normal = (x[1] - x[0]).cross(&(x[2] - x[0]));
        let size = normal.norm().sqrt();
        let along = b - a;
        let Some(left) = normal.cross(&along).try_normalize(0.0) else {
            return false;
        };
        let a = a + left * (ASIDE * size);
        // The part of the line that is on the inner side of every edge.
        let (mut begin, mut end): (Real, Real) = (0.0, 1.0);
        for k in 0..3 {
            let inward = normal.cross(&(x[(k + 1) % 3] - x[k]));
            let (height, slope) = (inward.dot(&(a - x[k])), inward.dot(&along));
            let zero = -height / slope;
            if slope > 0.0 {
                begin = begin.max(zero);
            } else if slope < 0.0 {
                end = end.min(zero);
            } else if height < 0.0 {
                return false;
            }
        }
        let middle = a + along * (0.5 * (begin + end));
        let distance = normal.dot(&(middle - x[0])).abs() / normal.norm();
        begin < end && distance <= size
    }
}

/// The tears of a mesh, in the order of their times. It is joined of pieces of so many vertices (`counts`); `name` has
/// the number that a vertex had in it then.
pub(super) fn tears(
    sections: &[Section<'_>],
    material: &Material,
    (mesh, counts): (&TriMesh, &[usize]),
    inside: &[Inside],
    name: impl Fn(usize) -> usize,
) -> Result<Vec<Change>, BenchError> {
    let mut timed = Vec::new();
    for section in sections {
        let (own, chosen) = (section.read::<Event>()?, section.read::<Selection>()?);
        if own.deed(section)? != Deed::Tear {
            continue;
        }
        refuse_motion(section, "for a tear")?;
        chosen.select.refuse_given("for a tear")?;
        chosen.vertices.refuse_given("for a tear")?;
        let (place, key) = match (*chosen.corners, *own.line) {
            (Some([a, b]), None) => (Place::Box([a.inf(&b), a.sup(&b)]), chosen.corners.bare()),
            (None, Some(ends)) => (Place::Line(ends), own.line.bare()),
            _ => return Err(section.refuse_table("a tear needs a box or a line")),
        };
        let piece = selection::range(&chosen, counts)?;
        timed.push((own.time(section)?, place, key, piece));
    }
    timed.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut is_left = vec![true; mesh.triangles().len()];
    let mut changes = Vec::new();
    for (time, place, key, piece) in timed {
        let mut count = 0;
        for (left, corners) in is_left.iter_mut().zip(mesh.triangles()) {
            let is_chosen = *left && piece.contains(&name(corners[0] as usize));
            if is_chosen && place.has(gather(mesh.positions(), *corners)) {
                if material.is_solid(corners[0]) {
                    return Err(key.refuse("a solid is there, which cannot be torn"));
                }
                *left = false;
                count += 1;
            }
        }
        if count == 0 {
            let there = if key.name() == "line" {
                "on the line"
            } else {
                "in the box"
            };
            let message = format!("there is no triangle {there}, or it has been torn out before");
            return Err(key.refuse(message));
        }
        let kept = mesh.triangles().iter().zip(&is_left);
        let kept: Vec<[u32; 3]> = kept.filter(|(_, left)| **left).map(|(t, _)| *t).collect();
        refuse_lonely(&key, &kept, mesh)?;
        let rest = mesh.with_triangles(kept);
        let rest = rest.map_err(|error| key.refuse(error))?;
        let model = material.cut(mesh, |triangle| is_left[triangle])?;
        let (gases, volumes) = gas::left(inside, &is_left);
        changes.push(Change {
            time,
            kind: ChangeKind::Tear {
                mesh: rest,
                model: Box::new(model),
                gases,
                volumes,
            },
        });
    }
    Ok(changes)
}

/// Refuses to leave a vertex without any triangle that had one.
fn refuse_lonely(key: &Setting<()>, kept: &[[u32; 3]], mesh: &TriMesh) -> Result<(), BenchError> {
    let mut has_triangle = vec![false; mesh.vertex_count()];
    for vertex in kept.iter().flatten() {
        has_triangle[*vertex as usize] = true;
    }
    let mut all = mesh.triangles().iter().flatten();
    let lonely = all.find(|vertex| !has_triangle[**vertex as usize]);
    lonely.map_or(Ok(()), |vertex| {
        let x = mesh.positions()[*vertex as usize];
        let message = format!(
            "the vertex at ({}, {}, {}) m would be left without a triangle: {}",
            x.x,
            x.y,
            x.z,
            match key.name() {
                "line" => "move the line by a row of triangles away from the border",
                _ => "a box may be no wider than a row of triangles",
            }
        );
        Err(key.refuse(message))
    })
}

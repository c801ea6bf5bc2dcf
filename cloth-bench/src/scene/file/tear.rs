//! `[[tear]]`: triangles that vanish at a time.

use super::document::Section;
use super::gas::{self, Inside};
use super::keys::Tear;
use super::material::Material;
use crate::error::BenchError;
use crate::scene::{Change, ChangeKind};
use cloth_core::math::Vec3;
use cloth_core::mesh::TriMesh;

/// The tears of a mesh, in the order of their times.
pub(super) fn tears(
    sections: &[Section<'_>],
    material: &Material,
    mesh: &TriMesh,
    inside: &[Inside],
) -> Result<Vec<Change>, BenchError> {
    let mut timed = Vec::new();
    for section in sections {
        let own = section.read::<Tear>()?;
        let time = own
            .time
            .ok_or_else(|| section.refuse_table("needs a time"))?;
        let corners = own
            .corners
            .ok_or_else(|| section.refuse_table("needs a box"))?;
        timed.push((time, corners, (section, own)));
    }
    timed.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut is_left = vec![true; mesh.triangles().len()];
    let mut changes = Vec::new();
    for (time, [a, b], (section, own)) in timed {
        let (low, high) = (a.inf(&b), a.sup(&b));
        let is_torn = |corners: [u32; 3]| {
            let sum: Vec3 = corners.map(|v| mesh.positions()[v as usize]).iter().sum();
            let middle = sum / 3.0;
            (0..3).all(|axis| (low[axis]..=high[axis]).contains(&middle[axis]))
        };
        let mut count = 0;
        for (left, corners) in is_left.iter_mut().zip(mesh.triangles()) {
            if *left && is_torn(*corners) {
                *left = false;
                count += 1;
            }
        }
        if count == 0 {
            let message = "there is no triangle in the box, or it has been torn out before";
            return Err(own.corners.refuse(message));
        }
        let kept = mesh.triangles().iter().zip(&is_left);
        let kept: Vec<[u32; 3]> = kept.filter(|(_, left)| **left).map(|(t, _)| *t).collect();
        refuse_lonely(&own, &kept, mesh)?;
        let rest = TriMesh::new(mesh.positions().to_vec(), kept);
        let rest = rest.map_err(|error| section.refuse_table(error))?;
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

/// Refuses to leave a vertex without any triangle.
fn refuse_lonely(own: &Tear, kept: &[[u32; 3]], mesh: &TriMesh) -> Result<(), BenchError> {
    let mut has_triangle = vec![false; mesh.vertex_count()];
    for vertex in kept.iter().flatten() {
        has_triangle[*vertex as usize] = true;
    }
    let lonely = has_triangle.iter().position(|has| !has);
    lonely.map_or(Ok(()), |vertex| {
        let x = mesh.positions()[vertex];
        let message = format!(
            "the vertex at ({}, {}, {}) m would be left without a triangle: make the box narrower",
            x.x, x.y, x.z
        );
        Err(own.corners.refuse(message))
    })
}

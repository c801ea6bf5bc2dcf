//! The vertices that a table chooses, by name, number or place.

use super::document::Section;
use super::keys::Selection;
use crate::bounds::bounds;
use crate::error::BenchError;
use crate::names;
use crate::scene::pins;
use cloth_core::math::Vec3;
use cloth_core::mesh::TriMesh;
use cloth_core::topology::EdgeTable;
use std::ops::Range;

const WAYS: &str = "one of the keys select, vertices and box";

/// All pieces in one mesh, in the caller's order.
pub(super) struct Pieces<'a> {
    pub(super) mesh: &'a TriMesh,
    /// Numbers of vertices.
    pub(super) counts: &'a [usize],
    pub(super) up: Vec3,
}

impl Pieces<'_> {
    /// The vertices of each of these tables, in the caller's numbers.
    pub(super) fn chosen_by(
        &self,
        sections: &[Section<'_>],
    ) -> Result<Vec<Vec<usize>>, BenchError> {
        let chosen = sections.iter().map(|section| self.chosen(section));
        chosen.collect()
    }

    /// The vertices of a table, in the caller's numbers.
    pub(super) fn chosen(&self, section: &Section<'_>) -> Result<Vec<usize>, BenchError> {
        let own = section.read::<Selection>()?;
        let range = range(&own, self.counts)?;
        let positions = &self.mesh.positions()[range.clone()];
        let found = match (own.select.as_deref(), own.vertices.as_deref(), *own.corners) {
            (Some("border"), None, None) => return self.border(&own, range),
            (Some(name @ ("corners" | "highest")), None, None) => {
                pins::chosen(name, positions, self.up)?
            }
            (Some(name), None, None) => {
                let known = ["corners", "highest", "border"];
                let message = names::unknown("selection", name, &known);
                return Err(own.select.refuse(message));
            }
            (None, Some([]), None) => return Err(own.vertices.refuse("names no vertex")),
            (None, Some(numbers), None) => {
                let count = positions.len();
                if let Some(beyond) = numbers.iter().find(|&&n| n as usize >= count) {
                    let message = names::beyond("vertex", *beyond, count);
                    return Err(own.vertices.refuse(message));
                }
                let mut chosen: Vec<usize> = numbers.iter().map(|&n| n as usize).collect();
                chosen.sort_unstable();
                chosen.dedup();
                chosen
            }
            (None, None, Some([a, b])) => {
                let (low, high) = (a.inf(&b), a.sup(&b));
                let is_inside =
                    |x: &Vec3| (0..3).all(|axis| (low[axis]..=high[axis]).contains(&x[axis]));
                let numbered = positions.iter().enumerate();
                let inside = numbered.filter(|(_, x)| is_inside(x));
                inside.map(|(v, _)| v).collect()
            }
            (None, None, None) => return Err(section.refuse_table(format!("needs {WAYS}"))),
            _ => return Err(section.refuse_table(format!("takes only {WAYS}"))),
        };
        if found.is_empty() {
            let [low, high] = bounds(positions.iter().copied());
            return Err(own.corners.refuse(format!(
                "there is no vertex in the box; they are in [{}, {}, {}] to [{}, {}, {}] m",
                low.x, low.y, low.z, high.x, high.y, high.z
            )));
        }
        Ok(found.into_iter().map(|v| range.start + v).collect())
    }

    /// All of these vertices that are on edges of one triangle alone.
    fn border(&self, own: &Selection, range: Range<usize>) -> Result<Vec<usize>, BenchError> {
        let edges = EdgeTable::build(self.mesh).map_err(|error| own.select.refuse(error))?;
        let numbered = edges.ends().iter().enumerate();
        let border = numbered.filter(|(edge, _)| edges.is_boundary(*edge));
        let ends = border.flat_map(|(_, ends)| ends.map(|v| v as usize));
        let mut vertices: Vec<usize> = ends.filter(|v| range.contains(v)).collect();
        vertices.sort_unstable();
        vertices.dedup();
        if vertices.is_empty() {
            return Err(own.select.refuse("a closed mesh has no border"));
        }
        Ok(vertices)
    }
}

/// The numbers of the vertices to choose from, of pieces of so many.
pub(super) fn range(own: &Selection, counts: &[usize]) -> Result<Range<usize>, BenchError> {
    let Some(number) = *own.mesh else {
        return Ok(0..counts.iter().sum());
    };
    let piece = number as usize;
    if piece >= counts.len() {
        let message = names::beyond("mesh", number, counts.len());
        return Err(own.mesh.refuse(message));
    }
    let start = counts[..piece].iter().sum();
    Ok(start..start + counts[piece])
}

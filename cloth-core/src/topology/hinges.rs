//! Pairs of triangles that share an edge: where cloth bends.

use super::edges::{EdgeTable, runs_along};
use crate::mesh::TriMesh;

/// All hinges of a mesh: an inner edge with the two vertices opposite to it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HingeTable {
    hinges: Vec<[u32; 4]>,
}

impl HingeTable {
    /// One hinge per inner edge, in the order of `edges`.
    ///
    /// # Panics
    /// If `edges` was built from a mesh with more triangles.
    #[must_use]
    pub fn build(mesh: &TriMesh, edges: &EdgeTable) -> Self {
        let inner = (0..edges.len()).filter(|&edge| !edges.is_boundary(edge));
        let hinges = inner.map(|edge| {
            let ends = edges.ends()[edge];
            let [first, second] = edges.sides()[edge].map(|t| mesh.triangles()[t as usize]);
            // Where the winding turns over, both or none run along the edge: the lower triangle
            // number is then taken first, which `sides` already does.
            let swap = !runs_along(first, ends) && runs_along(second, ends);
            let [left, right] = if swap {
                [second, first]
            } else {
                [first, second]
            };
            [
                ends[0],
                ends[1],
                opposite(left, ends),
                opposite(right, ends),
            ]
        });
        Self {
            hinges: hinges.collect(),
        }
    }

    /// `[edge0, edge1, wing0, wing1]` of each hinge.
    ///
    /// `edge0 < edge1` are the ends of the shared edge. `wing0` completes the triangle that runs
    /// from `edge0` to `edge1`: seen from the front it lies left of that arrow, and `wing1` lies
    /// right. Where the two triangles are wound against each other there is no such choice, and
    /// `wing0` belongs to the triangle of the lower number, `sides()[edge][0]`.
    #[must_use]
    pub fn hinges(&self) -> &[[u32; 4]] {
        &self.hinges
    }

    /// Number of hinges, E − E_b.
    #[must_use]
    pub fn len(&self) -> usize {
        self.hinges.len()
    }

    /// Whether no two triangles share an edge.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.hinges.is_empty()
    }
}

/// The corner of `triangle` that is not one of `ends`.
fn opposite([a, b, c]: [u32; 3], ends: [u32; 2]) -> u32 {
    match (ends.contains(&a), ends.contains(&b)) {
        (false, _) => a,
        (_, false) => b,
        _ => c,
    }
}

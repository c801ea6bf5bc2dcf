//! The boundary as closed walks.

use super::edges::{EdgeTable, NONE, runs_along, triangle_edges};
use crate::mesh::TriMesh;

/// Closed walks along the boundary, each as its vertices in order, the first not repeated at the end.
///
/// A walk follows the winding of the triangle it starts in, so on a consistently wound mesh the
/// surface always lies on its left, seen from the front. It starts at the lowest edge number that no earlier
/// walk has passed. At a bow-tie vertex the walk stays with the fan of triangles it came along:
/// the vertex then stands in several walks, or several times in one, but no walk jumps from one
/// fan to the other.
///
/// # Panics
/// If `edges` was built from another mesh.
#[must_use]
pub fn boundary_loops(mesh: &TriMesh, edges: &EdgeTable) -> Vec<Vec<u32>> {
    let of_triangle = triangle_edges(mesh, edges);
    let mut passed = vec![false; edges.len()];
    let mut loops = Vec::new();
    for first in 0..edges.len() {
        if passed[first] || !edges.is_boundary(first) {
            continue;
        }
        let [low, high] = edges.ends()[first];
        let triangle = edges.sides()[first][0];
        let forward = runs_along(mesh.triangles()[triangle as usize], [low, high]);
        let (mut from, mut to) = if forward { (low, high) } else { (high, low) };
        let mut edge = first;
        let mut walk = Vec::new();
        // Every end of a boundary edge is joined to exactly one other end by the fan between
        // them, so the walk comes back to its first edge and nowhere else.
        while !passed[edge] {
            passed[edge] = true;
            walk.push(from);
            edge = turn(edges, &of_triangle, edge, to);
            let [a, b] = edges.ends()[edge];
            (from, to) = (to, if a == to { b } else { a });
        }
        loops.push(walk);
    }
    loops
}

/// Turns around `pivot` from one boundary edge through its fan of triangles to the other.
fn turn(edges: &EdgeTable, of_triangle: &[[u32; 3]], from: usize, pivot: u32) -> usize {
    let mut edge = from;
    let mut triangle = edges.sides()[edge][0];
    loop {
        let candidates = of_triangle[triangle as usize].map(|e| e as usize);
        let next = candidates
            .into_iter()
            .find(|&e| e != edge && edges.ends()[e].contains(&pivot));
        // Two of the three edges of a triangle end at each corner, so there always is one.
        let Some(next) = next else { return from };
        let [first, second] = edges.sides()[next];
        if second == NONE {
            return next;
        }
        triangle = if first == triangle { second } else { first };
        edge = next;
    }
}

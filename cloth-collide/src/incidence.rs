//! Who has which vertex and which edge, and who faces whom across an edge.

use crate::sets::Sets;
use cloth_core::mesh::TriMesh;

/// Which of its own corners and edges a triangle represents. Edge k goes from corner k to the next one.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Owned {
    pub(crate) vertices: [bool; 3],
    pub(crate) edges: [bool; 3],
}

/// The two corners of edge k of a triangle.
pub(crate) fn ends(k: usize) -> [usize; 2] {
    [k, (k + 1) % 3]
}

/// Gives each vertex and each edge to the first triangle that has it.
pub(crate) fn owned(mesh: &TriMesh) -> Vec<Owned> {
    let mut owned = vec![Owned::default(); mesh.triangle_count()];
    let mut taken = vec![false; mesh.vertex_count()];
    for (owned, corners) in owned.iter_mut().zip(mesh.triangles()) {
        owned.vertices = corners.map(|v| !std::mem::replace(&mut taken[v as usize], true));
    }
    let sides = sorted_sides(mesh.triangles());
    for same in sides.chunk_by(|a, b| a.ends == b.ends) {
        owned[same[0].triangle as usize].edges[same[0].k] = true;
    }
    owned
}

/// The two vertices of each edge, in rising order, and the three edges of each triangle: edge k of a triangle goes from
/// corner k to the next one.
pub(crate) fn edge_numbers(triangles: &[[u32; 3]]) -> (Vec<[u32; 2]>, Vec<[u32; 3]>) {
    let mut edges = Vec::new();
    let mut of_triangle = vec![[0; 3]; triangles.len()];
    let sides = sorted_sides(triangles);
    for (number, same) in (0..).zip(sides.chunk_by(|a, b| a.ends == b.ends)) {
        edges.push(same[0].ends);
        for side in same {
            of_triangle[side.triangle as usize][side.k] = number;
        }
    }
    (edges, of_triangle)
}

/// Pairs (vertex, triangle) across inner edges; if there are none, of each triangle and the next.
pub(crate) fn facing(triangles: &[[u32; 3]]) -> Vec<(u32, u32)> {
    let sides = sorted_sides(triangles);
    let across: Vec<_> = sides
        .windows(2)
        .filter(|two| two[0].ends == two[1].ends)
        .map(|two| (two[1].opposite(triangles), two[0].triangle))
        .collect();
    if !across.is_empty() {
        return across;
    }
    // No two triangles have the same three vertices, so the next one has a vertex that this one has not.
    (0..)
        .zip(triangles.windows(2))
        .flat_map(|(t, two)| {
            let elsewhere = move |v: &u32| !two[0].contains(v);
            two[1].into_iter().filter(elsewhere).map(move |v| (v, t))
        })
        .collect()
}

/// One edge of one triangle.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Side {
    /// The two vertices, the smaller number first.
    ends: [u32; 2],
    triangle: u32,
    k: usize,
}

impl Side {
    fn opposite(self, triangles: &[[u32; 3]]) -> u32 {
        triangles[self.triangle as usize][(self.k + 2) % 3]
    }
}

/// All edges of all triangles, those between the same two vertices next to each other.
fn sorted_sides(triangles: &[[u32; 3]]) -> Vec<Side> {
    let mut sides: Vec<Side> = (0..)
        .zip(triangles)
        .flat_map(|(triangle, corners)| {
            (0..3).map(move |k| {
                let [a, b] = ends(k).map(|k| corners[k]);
                Side {
                    ends: [a.min(b), a.max(b)],
                    triangle,
                    k,
                }
            })
        })
        .collect();
    sides.sort_unstable();
    sides
}

/// A number for each vertex, the same for those that are connected.
pub(crate) fn pieces(mesh: &TriMesh) -> Vec<u32> {
    let mut sets = Sets::default();
    sets.reset(mesh.vertex_count());
    for &[a, b, c] in mesh.triangles() {
        sets.join(a, b);
        sets.join(b, c);
    }
    (0..mesh.vertex_count() as u32)
        .map(|v| sets.of(v))
        .collect()
}

//! The sorted edge list: which edges there are, and which triangles meet there.

use crate::mesh::{MeshError, TriMesh};

/// Stands where an edge has no second triangle.
pub const NONE: u32 = u32::MAX;

/// All edges of a mesh and the triangles beside them.
///
/// Edges are sorted by their lower vertex, then by their higher one, so an edge number depends on
/// the triangles only, not on how they were visited.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EdgeTable {
    ends: Vec<[u32; 2]>,
    sides: Vec<[u32; 2]>,
}

impl EdgeTable {
    /// Builds the table of all edges of `mesh` in linear time (a bucket per lower vertex, each
    /// sorted on its own).
    ///
    /// # Errors
    /// [`MeshError::NonManifoldEdge`] for the first edge with more than two triangles,
    /// [`MeshError::TooManyTriangles`] if an edge number would not fit.
    pub fn build(mesh: &TriMesh) -> Result<Self, MeshError> {
        Self::from_triangles(mesh.vertex_count(), mesh.triangles())
    }

    /// The same from bare triangles, whose vertex numbers are all below `vertex_count`.
    pub(crate) fn from_triangles(
        vertex_count: usize,
        triangles: &[[u32; 3]],
    ) -> Result<Self, MeshError> {
        let limit = u32::MAX as usize / 3;
        if triangles.len() > limit {
            return Err(MeshError::TooManyTriangles {
                count: triangles.len(),
                limit,
            });
        }
        let (sides_of_vertex, starts) = bucket(vertex_count, triangles);
        // A closed mesh has 3F/2 edges, one with a boundary a few more.
        let guess = triangles.len() / 2 * 3;
        let mut table = Self {
            ends: Vec::with_capacity(guess),
            sides: Vec::with_capacity(guess),
        };
        for (low, range) in starts.windows(2).enumerate() {
            let bucket = &sides_of_vertex[range[0] as usize..range[1] as usize];
            table.append(low as u32, bucket)?;
        }
        Ok(table)
    }

    /// Appends the edges whose lower vertex is `low`; `bucket` holds (higher vertex, triangle)
    /// pairs, sorted.
    fn append(&mut self, low: u32, bucket: &[u64]) -> Result<(), MeshError> {
        for edge in bucket.chunk_by(|a, b| a >> 32 == b >> 32) {
            let ends = [low, (edge[0] >> 32) as u32];
            // The cast keeps the lower half, which is the triangle.
            match *edge {
                [only] => self.sides.push([only as u32, NONE]),
                [first, second] => self.sides.push([first as u32, second as u32]),
                [a, b, c, ..] => {
                    return Err(MeshError::NonManifoldEdge {
                        ends,
                        triangles: [a, b, c].map(|side| side as u32 as usize),
                    });
                }
                [] => continue,
            }
            self.ends.push(ends);
        }
        Ok(())
    }

    /// The two vertices of each edge, the lower number first.
    #[must_use]
    pub fn ends(&self) -> &[[u32; 2]] {
        &self.ends
    }

    /// The triangles at each edge, the lower number first; at the boundary the second is [`NONE`].
    #[must_use]
    pub fn sides(&self) -> &[[u32; 2]] {
        &self.sides
    }

    /// Number of edges E.
    #[must_use]
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// Whether there is no edge; a table built from a mesh always has some.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// Whether only one triangle meets the edge.
    ///
    /// # Panics
    /// If there is no such edge.
    #[must_use]
    pub fn is_boundary(&self, edge: usize) -> bool {
        self.sides[edge][1] == NONE
    }

    /// Number of boundary edges E_b.
    #[must_use]
    pub fn boundary_edge_count(&self) -> usize {
        self.sides.iter().filter(|side| side[1] == NONE).count()
    }

    /// Number of the edge between two vertices, in either order, by binary search.
    #[must_use]
    pub fn find(&self, a: u32, b: u32) -> Option<usize> {
        self.ends.binary_search(&[a.min(b), a.max(b)]).ok()
    }
}

/// The directed sides of a triangle: side `k` runs from corner `k` to corner `k + 1`.
pub(super) fn directed_sides([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}

/// All triangle sides as packed (higher vertex, triangle), grouped by lower vertex and sorted
/// within each group, together with where each group starts.
///
/// Grouping by counting and sorting groups of about three entries is several times faster than
/// one sort of all sides, and gives the same list.
fn bucket(vertex_count: usize, triangles: &[[u32; 3]]) -> (Vec<u64>, Vec<u32>) {
    let mut starts = vec![0_u32; vertex_count + 1];
    for &corners in triangles {
        for [a, b] in directed_sides(corners) {
            starts[a.min(b) as usize + 1] += 1;
        }
    }
    for vertex in 0..vertex_count {
        starts[vertex + 1] += starts[vertex];
    }
    let mut next = starts.clone();
    let mut packed = vec![0_u64; 3 * triangles.len()];
    for (triangle, &corners) in triangles.iter().enumerate() {
        for [a, b] in directed_sides(corners) {
            let slot = &mut next[a.min(b) as usize];
            packed[*slot as usize] = (u64::from(a.max(b)) << 32) | triangle as u64;
            *slot += 1;
        }
    }
    for range in starts.windows(2) {
        packed[range[0] as usize..range[1] as usize].sort_unstable();
    }
    (packed, starts)
}

/// The three edge numbers of every triangle; entry `k` is the edge from corner `k` to corner
/// `k + 1` (mod 3).
///
/// # Panics
/// If `edges` was built from another mesh.
#[must_use]
pub fn triangle_edges(mesh: &TriMesh, edges: &EdgeTable) -> Vec<[u32; 3]> {
    let mut result = vec![[NONE; 3]; mesh.triangle_count()];
    for (edge, (&ends, &sides)) in edges.ends.iter().zip(&edges.sides).enumerate() {
        for triangle in sides.into_iter().filter(|&t| t != NONE) {
            let corners = mesh.triangles()[triangle as usize];
            for (k, [a, b]) in directed_sides(corners).into_iter().enumerate() {
                if [a.min(b), a.max(b)] == ends {
                    result[triangle as usize][k] = edge as u32;
                }
            }
        }
    }
    assert!(
        result.iter().flatten().all(|&edge| edge != NONE),
        "the edge table belongs to another mesh"
    );
    result
}

/// Whether `triangle` runs from `ends[0]` to `ends[1]`, not the other way round.
pub(super) fn runs_along(triangle: [u32; 3], ends: [u32; 2]) -> bool {
    directed_sides(triangle).contains(&ends)
}

/// Inner edges that both triangles run through in the same direction, so that front and back
/// change places there. The winding is consistent if there is none.
///
/// # Panics
/// If `edges` was built from a mesh with more triangles.
#[must_use]
pub fn inconsistently_oriented_edges(mesh: &TriMesh, edges: &EdgeTable) -> Vec<u32> {
    let along = |triangle: u32, ends| runs_along(mesh.triangles()[triangle as usize], ends);
    let inner = (0..edges.len()).filter(|&edge| !edges.is_boundary(edge));
    inner
        .filter(|&edge| {
            let ends = edges.ends[edge];
            let [first, second] = edges.sides[edge];
            along(first, ends) == along(second, ends)
        })
        .map(|edge| edge as u32)
        .collect()
}

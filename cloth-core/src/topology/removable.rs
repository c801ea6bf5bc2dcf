//! A subset of the edges that leaves a sheet more freedom: triangles joined in pairs by dropping the edge between them.

use super::edges::{EdgeTable, NONE, triangle_edges};
use crate::math::Real;
use crate::mesh::TriMesh;

/// Inner edges in the order in which they are to be dropped so that at most one edge of every triangle goes: dropping
/// all of them turns the sheet into quads and a few triangles, dropping the first n is a subset on the way there.
///
/// Greedy: an edge counts by its square over that of the longest edge of its triangles, the smaller of the two numbers;
/// the largest comes first, which on a grid takes the diagonals and nothing else. Equal ones come in a scrambled order,
/// so that the first of them are spread over the whole sheet. An edge whose triangles have both kept all edges so far
/// is dropped. So every triangle keeps at least two edges, and the sheet does not fall into pieces.
///
/// With every dropped edge `3V − E` grows by 1, and a disk has close to V of them: from 3 + E_b its freedom grows to
/// about a third of its coordinates.
///
/// # Panics
/// If `edges` was built from another mesh.
#[must_use]
pub fn removable_edges(mesh: &TriMesh, edges: &EdgeTable) -> Vec<u32> {
    let x = mesh.positions();
    let squared: Vec<Real> = edges
        .ends()
        .iter()
        .map(|&[a, b]| (x[a as usize] - x[b as usize]).norm_squared())
        .collect();
    let longest: Vec<Real> = triangle_edges(mesh, edges)
        .iter()
        .map(|sides| {
            sides
                .iter()
                .map(|&e| squared[e as usize])
                .fold(0.0, Real::max)
        })
        .collect();
    let inner = (0..edges.len()).filter(|&edge| !edges.is_boundary(edge));
    let mut ordered: Vec<(u64, u32, u32)> = inner
        .map(|edge| {
            let relative = |t: u32| squared[edge] / longest[t as usize];
            let [first, second] = edges.sides()[edge].map(relative);
            // Rounded, so that equal lengths are equal whatever their last bits.
            let shortfall = ((1.0 - first.min(second)) * 1e9).round() as u64;
            (shortfall, scrambled(edge as u32), edge as u32)
        })
        .collect();
    ordered.sort_unstable();
    let mut is_whole = vec![true; mesh.triangle_count()];
    ordered.retain(|&(_, _, edge)| {
        let sides = edges.sides()[edge as usize].map(|t| t as usize);
        debug_assert!(sides[1] != NONE as usize);
        let both = sides.iter().all(|&t| is_whole[t]);
        if both {
            sides.into_iter().for_each(|t| is_whole[t] = false);
        }
        both
    });
    ordered.into_iter().map(|(_, _, edge)| edge).collect()
}

/// A number without a pattern for every number, no two the same: multiplication by an odd number and a fold of the high
/// bits, twice.
fn scrambled(number: u32) -> u32 {
    let fold = |n: u32| (n ^ (n >> 16)).wrapping_mul(0x9E37_79B1);
    let n = fold(fold(number.wrapping_add(1)));
    n ^ (n >> 15)
}

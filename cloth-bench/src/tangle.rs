//! Where a cloth passes through itself, in words.

use crate::bounds::bounds;
use cloth_core::math::Vec3;
use cloth_core::mesh::TriMesh;

/// Where the cloth `mesh` at `x` (m) still passes through itself or through bodies, in these pairs of triangles. Those
/// of bodies are counted on from those of the cloth; `name` has the number and the body of each, from 0.
pub(crate) fn describe(
    mesh: &TriMesh,
    x: &[Vec3],
    pairs: &[[u32; 2]],
    name: impl Fn(usize) -> Option<String>,
) -> String {
    let own = mesh.triangles();
    let is_own = |t: &u32| (*t as usize) < own.len();
    let places = pairs.iter().flatten().copied().filter(is_own);
    let places = places.flat_map(|t| own[t as usize]);
    let [low, high] = bounds(places.map(|v| x[v as usize]));
    let point = |p: Vec3| format!("({:.4}, {:.4}, {:.4})", p.x, p.y, p.z);
    let name = |t: u32| {
        let of_body = (t as usize).checked_sub(own.len()).and_then(&name);
        of_body.unwrap_or_else(|| t.to_string())
    };
    let (count, first) = (pairs.len(), pairs.first().copied().unwrap_or_default());
    let [a, b] = first.map(name);
    let with_bodies = pairs.iter().filter(|pair| !pair.iter().all(is_own)).count();
    let of_which = match with_bodies {
        0 => String::new(),
        some => format!(", {some} of them of the cloth and a body"),
    };
    format!(
        "{count} pairs of triangles still pass through each other{of_which}, all between {} and {} m; \
         the first are triangles {a} and {b} (from 0)",
        point(low),
        point(high)
    )
}

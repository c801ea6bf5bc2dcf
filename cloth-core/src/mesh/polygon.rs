//! Polygons of files, cut into triangles.
//!
//! A polygon becomes a fan around its first corner, if every triangle of the fan looks to the side to which the polygon
//! does: that is so where the first corner sees all of it, as any corner of a convex one. Any other polygon is cut by
//! ears (G. H. Meisters, "Polygons have ears", American Mathematical Monthly 82 (6), 1975): two successive edges with
//! no other corner in the triangle that they span. The side of a polygon is that of Newell's normal, the sum of the
//! cross products of successive corners; corners need not be in a plane.

use crate::math::{Real, Vec3, gather, is_finite};

/// A triangle is flat whose height is less than this fraction of its longest edge.
const FLAT: Real = 1e-9;

/// A polygon as a fan around its first corner.
pub(super) fn fan(corners: &[u32]) -> impl Iterator<Item = [u32; 3]> + '_ {
    let (first, rest) = corners.split_at(corners.len().min(1));
    rest.windows(2).map(|pair| [first[0], pair[0], pair[1]])
}

/// Cuts those fans anew that leave their polygon; successive triangles are of one polygon where `face` has the same
/// number for them. What [`TriMesh::new`](super::TriMesh::new) refuses in a fan stays as it is.
///
/// # Errors
/// The first triangle of a polygon that crosses itself.
pub(super) fn cut_concave(
    positions: &[Vec3],
    triangles: &mut [[u32; 3]],
    face: impl Fn(usize) -> usize,
) -> Result<(), usize> {
    let mut first = 0;
    while first < triangles.len() {
        let same = (first..triangles.len())
            .take_while(|&t| face(t) == face(first))
            .count();
        let fan = &mut triangles[first..first + same];
        if fan.len() > 1 {
            recut(positions, fan).ok_or(first)?;
        }
        first += same;
    }
    Ok(())
}

/// Cuts one polygon, given as a fan; nothing if that is impossible.
fn recut(positions: &[Vec3], fan: &mut [[u32; 3]]) -> Option<()> {
    let [a, b, _] = fan[0];
    let mut corners: Vec<u32> = [a, b].into_iter().chain(fan.iter().map(|t| t[2])).collect();
    let is_known = |v: &u32| positions.get(*v as usize).is_some_and(is_finite);
    let mut sorted = corners.clone();
    sorted.sort_unstable();
    let repeats = sorted.windows(2).any(|pair| pair[0] == pair[1]);
    if repeats || !corners.iter().all(is_known) {
        return Some(());
    }
    let origin = positions[a as usize];
    let edges = corners.iter().zip(corners.iter().cycle().skip(1));
    let from_origin = |v: &u32| positions[*v as usize] - origin;
    let newell: Vec3 = edges
        .map(|(p, q)| from_origin(p).cross(&from_origin(q)))
        .sum();
    let normal = newell.try_normalize(0.0)?;
    // Twice the area of a triangle as seen along the normal, over its longest edge squared.
    let side = |corners: [u32; 3]| {
        let [p, q, r] = gather(positions, corners);
        let longest = [q - p, r - q, p - r].map(|edge| edge.norm_squared());
        let longest = longest.into_iter().fold(Real::MIN_POSITIVE, Real::max);
        (q - p).cross(&(r - p)).dot(&normal) / longest
    };
    if fan.iter().all(|&triangle| side(triangle) > FLAT) {
        return Some(());
    }
    for triangle in fan {
        let count = corners.len();
        let around = |k: usize| [k + count - 1, k, k + 1].map(|k| corners[k % count]);
        let is_ear = |(k, _): &(usize, Real)| {
            let [before, at, after] = around(*k);
            let holds = |v: &&u32| {
                let inside = [[before, at, **v], [at, after, **v], [after, before, **v]];
                ![before, at, after].contains(*v)
                    && inside.into_iter().map(side).all(|s| s >= -FLAT)
            };
            !corners.iter().any(|v| holds(&v))
        };
        let sides = (0..count).map(|k| (k, side(around(k))));
        let mut tips: Vec<(usize, Real)> = sides.filter(|(_, side)| *side > FLAT).collect();
        tips.sort_by(|a, b| b.1.total_cmp(&a.1).then(b.0.cmp(&a.0)));
        let (tip, _) = tips.into_iter().find(is_ear)?;
        *triangle = around(tip);
        corners.remove(tip);
    }
    Some(())
}

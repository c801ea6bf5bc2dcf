//! `[[link]]`: links between vertices, which keep the length that they have at rest, or are ropes of that length.

use super::document::Section;
use super::keys::Link;
use crate::error::BenchError;
use crate::names;
use cloth_core::cloth::Elements;
use cloth_core::energy::{Spring, StrainLimitSpring};
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::TriMesh;
use cloth_core::method::ordering::Order;
use std::ops::Range;

/// A joint is held by three of so many vertices that are nearest to it.
const AROUND: usize = 12;

/// Directions whose spatial product is below this lie in a plane.
const FLAT: Real = 1e-3;

/// The links of a `[[link]]` on pieces of so many vertices.
pub(super) fn links(
    section: &Section<'_>,
    counts: &[usize],
    mesh: &TriMesh,
) -> Result<Elements, BenchError> {
    let own = section.read::<Link>()?;
    let meshes = own.meshes.as_deref();
    let &[first, second] = meshes.ok_or_else(|| section.refuse_table("needs meshes"))? else {
        let message = "meshes has to be two numbers such as [0, 1]";
        return Err(own.meshes.refuse(message));
    };
    let piece = |number: u32| {
        if number as usize >= counts.len() {
            let message = names::beyond("mesh", number, counts.len());
            return Err(own.meshes.refuse(message));
        }
        let number = number as usize;
        let start = counts[..number].iter().sum();
        Ok::<_, BenchError>(start..start + counts[number])
    };
    let pieces = [piece(first)?, piece(second)?];
    let ends = match (&*own.first, &*own.second, *own.at) {
        (Some(first), Some(second), None) => pairs(&own, [first, second], &pieces)?,
        (None, None, Some(point)) => joint(&own, point, &pieces, mesh.positions())?,
        _ => return Err(section.refuse_table("needs first and second, or at")),
    };
    let springs = Spring::along(mesh.positions(), &ends, own.stiffness.number());
    if let Some(spring) = springs.iter().find(|spring| spring.rest_length == 0.0) {
        let [a, b] = spring.vertices;
        let message =
            format!("vertices {a} and {b} of all are in the same place: a link needs a length");
        return Err(section.refuse_table(message));
    }
    if !*own.slack {
        return Ok(Elements::Links(springs));
    }
    let stiffness = own.stiffness.number();
    if stiffness.is_infinite() {
        return Err(own
            .slack
            .refuse("a link with slack needs a stiffness (N/m)"));
    }
    let ropes = StrainLimitSpring::along(mesh.positions(), &ends, [0.0, 1.0], stiffness);
    Ok(Elements::SlackLinks(ropes))
}

/// The links where vertices are in another order.
pub(super) fn reorder(links: &mut [Elements], order: &Order) {
    let moved = |ends: [u32; 2]| order.renumber(ends);
    for family in links {
        match family {
            Elements::Links(all) => all.iter_mut().for_each(|s| s.vertices = moved(s.vertices)),
            Elements::SlackLinks(all) => {
                all.iter_mut().for_each(|s| s.vertices = moved(s.vertices))
            }
            _ => {}
        }
    }
}

/// Vertices that are given by their numbers.
fn pairs(
    own: &Link,
    lists: [&[u32]; 2],
    pieces: &[Range<usize>; 2],
) -> Result<Vec<[u32; 2]>, BenchError> {
    let count = lists[0].len();
    if lists[1].len() != count {
        let message = format!(
            "there are {count} first vertices and {} second ones, but every link needs both",
            lists[1].len()
        );
        return Err(own.second.refuse(message));
    }
    let keys = [&own.first, &own.second];
    let vertex = |side: usize, number: u32| {
        let Range { start, end } = pieces[side];
        if (number as usize) < end - start {
            return Ok(start as u32 + number);
        }
        let message = format!("there is no vertex {number}, only 0 to {}", end - start - 1);
        Err(keys[side].refuse(message))
    };
    let both = lists[0].iter().zip(lists[1]);
    both.map(|(&a, &b)| Ok([vertex(0, a)?, vertex(1, b)?]))
        .collect()
}

/// The nearest vertex of the second piece, linked to three of the first around it: three distances hold a point.
fn joint(
    own: &Link,
    point: Vec3,
    [first, second]: &[Range<usize>; 2],
    x: &[Vec3],
) -> Result<Vec<[u32; 2]>, BenchError> {
    if first == second {
        return Err(own.at.refuse("a joint is between two pieces"));
    }
    let mut others: Vec<usize> = second.clone().collect();
    others.sort_by(|&a, &b| (x[a] - point).norm().total_cmp(&(x[b] - point).norm()));
    let end = others[0];
    let mut near: Vec<usize> = first.clone().collect();
    near.sort_by(|&a, &b| (x[a] - x[end]).norm().total_cmp(&(x[b] - x[end]).norm()));
    near.truncate(AROUND);
    // Directions that span as much space as there is hold the point best.
    let direction = |v: usize| (x[v] - x[end]).try_normalize(0.0).unwrap_or_default();
    let mut best = (FLAT, None);
    for (i, &a) in near.iter().enumerate() {
        for (j, &b) in near.iter().enumerate().skip(i + 1) {
            for &c in &near[j + 1..] {
                let span = direction(a).cross(&direction(b)).dot(&direction(c)).abs();
                if span > best.0 {
                    best = (span, Some([a, b, c]));
                }
            }
        }
    }
    let message = "the first piece has no three vertices around the point that would hold it";
    let anchors = best.1.ok_or_else(|| own.at.refuse(message))?;
    Ok(anchors.map(|anchor| [anchor as u32, end as u32]).to_vec())
}

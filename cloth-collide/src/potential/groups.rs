//! How far vertices go, relative to the part of the cloth that they belong to.

use crate::bounds::{Bounds, farthest, longest};
use cloth_core::math::{Real, Vec3};
use cloth_core::method::pieces::Pieces;

/// So many components are told apart, at most.
const MOST: usize = 32;

/// Components that a path may bring together, and how they move.
#[derive(Clone, Copy, Debug)]
struct Group {
    /// Around the path of a component.
    bounds: Bounds,
    /// The component with the lowest number of the group.
    lowest: usize,
    /// The sum of the displacements (m), and how many they are.
    sum: Vec3,
    vertices: Real,
}

/// How far (m) a vertex goes on a path, at most, relative to the mean motion of its component and of those that come
/// within `range` (m) of its box. Pieces that pass by far from each other have no path between them to test.
pub(super) fn longest_of_groups(
    components: &Pieces,
    [from, to]: [&[Vec3]; 2],
    range: Real,
) -> Real {
    let count = components.count();
    if !(2..=MOST).contains(&count) {
        return longest([from, to]);
    }
    let mut groups: [Option<Group>; MOST] = [None; MOST];
    for ((a, b), &component) in from.iter().zip(to).zip(components.of_each()) {
        let bounds = Bounds::around([*a, *b]);
        let group = groups[component as usize].get_or_insert(Group {
            bounds,
            lowest: component as usize,
            sum: Vec3::zeros(),
            vertices: 0.0,
        });
        group.bounds = group.bounds.joined(&bounds);
        group.sum += b - a;
        group.vertices += 1.0;
    }
    for one in 0..count {
        for other in 0..one {
            join(&mut groups[..count], [other, one], range);
        }
    }
    let mean = |component: u32| {
        let group = |number: usize| groups[number].as_ref();
        let lowest = group(component as usize).map_or(0, |own| own.lowest);
        group(lowest).map_or(Vec3::zeros(), |all| all.sum / all.vertices)
    };
    let mut most: Real = 0.0;
    let mut first = 0;
    for run in components.of_each()[..from.len()].chunk_by(|a, b| a == b) {
        let vertices = first..first + run.len();
        first = vertices.end;
        let (from, to) = (&from[vertices.clone()], &to[vertices]);
        most = most.max(farthest(from, to, mean(run[0])));
    }
    most
}

/// Joins the groups of two components whose boxes are near each other.
fn join(groups: &mut [Option<Group>], pair: [usize; 2], range: Real) {
    let [Some(a), Some(b)] = pair.map(|number| groups[number]) else {
        return;
    };
    let (low, high) = (a.lowest.min(b.lowest), a.lowest.max(b.lowest));
    if low == high || a.bounds.axis_gap(&b.bounds) > range {
        return;
    }
    let Some(gone) = groups[high] else {
        return;
    };
    if let Some(kept) = &mut groups[low] {
        kept.sum += gone.sum;
        kept.vertices += gone.vertices;
    }
    let of_high = groups.iter_mut().flatten();
    of_high
        .filter(|group| group.lowest == high)
        .for_each(|group| group.lowest = low);
}

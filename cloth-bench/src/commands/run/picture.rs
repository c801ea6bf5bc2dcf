//! The picture of a scene.

use crate::bounds::bounds;
use crate::error::BenchError;
use crate::report::render::{Surface, View, render};
use crate::scene::Scene;
use cloth_core::cloth::Elements;
use cloth_core::math::{Mat3, Real, Vec3, gather};
use cloth_core::mesh::TriMesh;
use cloth_core::particles::State;

/// Radius of a link, in parts of the box around the cloth.
const LINK: Real = 2e-3;

/// A PNG file of the cloth `mesh` in a state of the scene, with its links and bodies; seen along a direction, if one is
/// given.
pub(super) fn of(
    scene: &Scene,
    mesh: &TriMesh,
    state: &State,
    look: Option<Vec3>,
) -> Result<Vec<u8>, BenchError> {
    let obstacles = scene.obstacle_surfaces(state.time);
    let (ends, sides) = links(scene, &state.positions);
    let mut surfaces = vec![
        Surface::cloth(&state.positions, mesh.triangles()),
        Surface::obstacle(&ends, &sides),
    ];
    let seen = |(positions, triangles)| Surface::obstacle(positions, triangles);
    surfaces.extend(obstacles.iter().map(|(x, t)| seen((&x[..], *t))));
    let view = view(scene, state);
    let direction = look.unwrap_or(view.direction);
    // Up and down have an up of their own: the axis that is farthest from them.
    let is_upright = direction.cross(&view.up).norm() > 1e-6 * direction.norm();
    let up = match is_upright {
        true => view.up,
        false => Vec3::ith((direction.iamax() + 2) % 3, 1.0),
    };
    let view = View {
        direction,
        up,
        ..view
    };
    Ok(render(&surfaces, &view)?)
}

/// Links as prisms: their vertices (m), of the cloth at `x` (m), and their triangles.
fn links(scene: &Scene, x: &[Vec3]) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let [low, high] = bounds(x.iter().copied());
    let radius = LINK * (high - low).norm();
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    let mut ends: Vec<[u32; 2]> = Vec::new();
    for family in &scene.model.others {
        match family {
            Elements::Links(links) => ends.extend(links.iter().map(|link| link.vertices)),
            Elements::SlackLinks(links) => ends.extend(links.iter().map(|link| link.vertices)),
            _ => {}
        }
    }
    for ends in ends {
        let [a, b] = gather(x, ends);
        let Some(along) = (b - a).try_normalize(0.0) else {
            continue;
        };
        let aside = along.cross(&Vec3::ith(along.iamin(), 1.0)).normalize() * radius;
        let below = along.cross(&aside);
        let first = positions.len() as u32;
        for corner in [
            aside,
            below * 0.866 - aside * 0.5,
            below * -0.866 - aside * 0.5,
        ] {
            positions.extend([a + corner, b + corner]);
        }
        for side in 0..3 {
            let [one, next] = [side, (side + 1) % 3].map(|side| first + 2 * side);
            triangles.extend([[one, next, next + 1], [one, next + 1, one + 1]]);
        }
    }
    (positions, triangles)
}

/// A camera that looks at the scene from the front and a little above, gravity pointing down. Planes have no end: it
/// frames the cloth and the other bodies.
fn view(scene: &Scene, state: &State) -> View {
    let up = -scene.gravity.try_normalize(0.0).unwrap_or(-Vec3::z());
    let view = View::default();
    // The default camera has z up; another up takes the camera along.
    let turn = turned(up);
    let bodies = scene.touch.iter();
    let bodies = bodies.flat_map(|touch| touch.bounded_surfaces(state.time));
    let bodies: Vec<Vec<Vec3>> = bodies.collect();
    // A box has corners where there is nothing to see: only where it keeps something out.
    let has_planes = bodies.len() < scene.obstacle_surfaces(state.time).len();
    let cloth = state.positions.iter();
    let seen = cloth.chain(bodies.iter().flatten()).copied();
    View {
        direction: turn * view.direction,
        up,
        bounds: has_planes.then(|| bounds(seen)),
        ..view
    }
}

fn turned(up: Vec3) -> Mat3 {
    let (right, back) = match up {
        up if up.x.abs() > 0.5 => (Vec3::y(), Vec3::z()),
        up if up.y.abs() > 0.5 => (Vec3::x(), Vec3::z()),
        _ => (Vec3::x(), -Vec3::y()),
    };
    Mat3::from_columns(&[right, -back, up])
}

//! Forces on the vertices of a cloth from outside: gas, and those of the scene.

use crate::scene::{Change, ChangeKind, Scene};
use cloth_core::enclosure::Pressure;
use cloth_core::math::{Real, Vec3};

/// A force of the scene that acts now.
pub(super) struct Push {
    /// Vertices and what acts on each (N).
    pub(super) forces: Vec<(usize, Vec3)>,
    /// When it ends (s).
    pub(super) until: Option<Real>,
}

/// The force that begins with a change, if one does.
pub(super) fn push_of(change: &Change, scene: &Scene) -> Option<Push> {
    let ChangeKind::Push {
        vertices,
        force,
        until,
    } = &change.kind
    else {
        return None;
    };
    let mass = scene.model.particles.mass();
    let whole: Real = vertices.iter().map(|&v| mass[v]).sum();
    let part = |&vertex: &usize| (vertex, force * (mass[vertex] / whole));
    Some(Push {
        forces: vertices.iter().map(part).collect(),
        until: *until,
    })
}

/// The forces (N) of gas and of the scene on a cloth at `x` (m), if there are any. `all` is room for their sum.
pub(super) fn load<'a>(
    (gases, pushes): (&[Pressure], &[Push]),
    all: &'a mut Vec<Vec3>,
    x: &[Vec3],
) -> Option<&'a [Vec3]> {
    if gases.is_empty() && pushes.is_empty() {
        return None;
    }
    all.clear();
    all.resize(x.len(), Vec3::zeros());
    for gas in gases {
        gas.add_load(x, all);
    }
    for (vertex, force) in pushes.iter().flat_map(|push| &push.forces) {
        all[*vertex] += force;
    }
    Some(all)
}

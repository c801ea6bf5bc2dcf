//! Pictures of where several methods bring the same scene, all seen by one camera.

use crate::report::html::Picture;
use crate::report::render::{Surface, View, render};
use crate::studies::prelude::*;

/// A cloth to be seen.
pub(super) struct Shot {
    /// What stands below its picture.
    pub(super) caption: String,
    /// Positions (m), at a time (s) that says where bodies are.
    pub(super) positions: Vec<Vec3>,
    pub(super) time: Real,
}

impl Shot {
    /// None of a run that has not been finished.
    pub(super) fn of(caption: String, positions: &[[Real; 3]], time: Real) -> Option<Self> {
        let shot = Self {
            caption,
            positions: vectors(positions),
            time,
        };
        (!positions.is_empty()).then_some(shot)
    }
}

/// Positions as results keep them, and as vectors (m).
pub(super) fn coordinates(positions: Vec<Vec3>) -> Vec<[Real; 3]> {
    positions.into_iter().map(Into::into).collect()
}

/// Positions (m) that [`coordinates`] has taken apart.
pub(super) fn vectors(positions: &[[Real; 3]]) -> Vec<Vec3> {
    positions.iter().copied().map(Vec3::from).collect()
}

/// A picture of each, on the background of the page, with the bodies of the scene.
pub(super) fn pictures(
    scene: &Scene,
    shots: &[Shot],
    view: &View,
) -> Result<Vec<Picture>, BenchError> {
    let Some(mesh) = &scene.mesh else {
        return Ok(Vec::new());
    };
    let view = View {
        background: None,
        ..view.clone()
    };
    let picture = |shot: &Shot| {
        let bodies = scene.obstacle_surfaces(shot.time);
        let bodies = bodies.iter().map(|(x, t)| Surface::obstacle(x, t));
        let cloth = Surface::cloth(&shot.positions, mesh.triangles());
        let surfaces = bodies.chain([cloth]).collect_vec();
        Ok(Picture {
            png: render(&surfaces, &view)?,
            caption: shot.caption.clone(),
        })
    };
    shots.iter().map(picture).collect()
}

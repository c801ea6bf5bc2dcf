//! What happens to a cloth on the way: vertices are held, pushed and released, triangles torn out, borders sewn
//! together.

use super::Scene;
use crate::error::BenchError;
use cloth_core::cloth::ClothModel;
use cloth_core::energy::Seam;
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::TriMesh;
use cloth_core::particles::State;
use nalgebra::{Rotation3, Unit};
use std::sync::Arc;

/// Something that happens to the cloth of a scene at a time.
#[derive(Clone, Debug)]
pub struct Change {
    /// When (s since the start): before the first step that begins then or later.
    pub time: Real,
    /// What.
    pub kind: ChangeKind,
}

/// What can happen to a cloth.
#[derive(Clone, Debug)]
pub enum ChangeKind {
    /// Vertices are held from now on, and move from where they are.
    Hold {
        /// Their numbers.
        vertices: Vec<usize>,
        /// How they move.
        motion: Motion,
    },
    /// Vertices are released, with the velocity that they have.
    Release {
        /// Their numbers.
        vertices: Vec<usize>,
    },
    /// Vertices are drawn to others, or to points of edges, from the distance that they have.
    Sew {
        /// The stitches, closed ones.
        seam: Seam,
        /// When they have closed (s since the start).
        until: Real,
    },
    /// A force acts on vertices from now on, spread over them by their masses.
    Push {
        /// Their numbers.
        vertices: Vec<usize>,
        /// On all of them together (N).
        force: Vec3,
        /// When it ends (s since the start): it acts in steps that begin before.
        until: Option<Real>,
    },
    /// Triangles vanish, with all elements that need them. Masses and stitches stay.
    Tear {
        /// What is left of the mesh, with all its vertices.
        mesh: TriMesh,
        /// What is left of the elements.
        model: Box<ClothModel>,
    },
}

/// A turn about an axis and a shift at the same time, at a constant rate.
#[derive(Clone, Copy, Debug)]
pub struct Motion {
    /// The whole shift (m).
    pub shift: Vec3,
    /// The whole rotation (rad): its direction is the axis, its length the angle.
    pub turn: Vec3,
    /// A point on the axis (m).
    pub centre: Vec3,
    /// How long it takes (s), above 0; rest after it.
    pub duration: Real,
}

impl Motion {
    /// Rest.
    pub const NONE: Self = Self {
        shift: Vec3::new(0.0, 0.0, 0.0),
        turn: Vec3::new(0.0, 0.0, 0.0),
        centre: Vec3::new(0.0, 0.0, 0.0),
        duration: 1.0,
    };

    /// Where (m) a point is at a time (s) that is at `from` (m) until the time `since` (s).
    pub fn path(self, from: Vec3, since: Real) -> impl Fn(Real) -> Vec3 + Send + Sync + 'static {
        let axis = Unit::try_new_and_get(self.turn, 0.0);
        let from_centre = from - self.centre;
        move |time| {
            let part = ((time - since) / self.duration).clamp(0.0, 1.0);
            let turned = match &axis {
                Some((axis, angle)) => Rotation3::from_axis_angle(axis, part * angle) * from_centre,
                None => from_centre,
            };
            self.centre + turned + self.shift * part
        }
    }
}

impl Scene {
    /// The scene after a change of its cloth, which is in this state; the state of held vertices changes with it.
    ///
    /// # Errors
    /// [`BenchError::Failed`] for a vertex that does not exist.
    pub(crate) fn after(&self, change: &Change, state: &mut State) -> Result<Self, BenchError> {
        let mut scene = self.clone();
        match &change.kind {
            ChangeKind::Hold { vertices, motion } => {
                let mut pins = scene.pins.as_deref().cloned().unwrap_or_default();
                for &vertex in vertices {
                    let path = motion.path(state.positions[vertex], state.time);
                    let particles = &mut scene.model.particles;
                    let held = pins.follow(particles, vertex, path);
                    held.map_err(BenchError::failed)?;
                    state.velocities[vertex] = Vec3::zeros();
                }
                scene.pins = Some(Arc::new(pins));
            }
            ChangeKind::Release { vertices } => {
                let mut pins = scene.pins.as_deref().cloned().unwrap_or_default();
                for &vertex in vertices {
                    let particles = &mut scene.model.particles;
                    let released = pins.release(particles, vertex);
                    released.map_err(BenchError::failed)?;
                }
                scene.pins = Some(Arc::new(pins)).filter(|pins| !pins.is_empty());
            }
            ChangeKind::Sew { seam, until } => {
                let times = [state.time, *until];
                let seam = seam.clone().closing(&state.positions, times);
                scene.model.sew(seam);
            }
            ChangeKind::Push { .. } => {}
            ChangeKind::Tear { mesh, model } => {
                let seam = scene.model.seam();
                let particles = scene.model.particles;
                scene.mesh = Some(mesh.clone());
                scene.model = ClothModel {
                    particles,
                    ..(**model).clone()
                };
                scene.model.sew(seam);
            }
        }
        Ok(scene)
    }
}

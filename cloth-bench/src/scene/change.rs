//! What happens to a cloth on the way: vertices are held, pushed and released, triangles torn out, borders sewn
//! together, bodies driven and let go.

use super::Scene;
use super::held::HeldMotion;
use crate::error::BenchError;
use cloth_core::cloth::{ClothModel, Elements};
use cloth_core::enclosure::{ClosedVolume, Pressure};
use cloth_core::energy::{Seam, SoftPin};
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::TriMesh;
use cloth_core::particles::State;
use cloth_core::pin::PinMotion;
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
        motion: HeldMotion,
    },
    /// Vertices are released, with the velocity that they have.
    Release {
        /// Their numbers.
        vertices: Vec<usize>,
    },
    /// Vertices are tied by springs to points that are where they are, and move from there.
    Tie {
        /// Their numbers.
        vertices: Vec<usize>,
        /// Stiffness of each spring (N/m).
        stiffness: Real,
        /// How the points move.
        motion: PinMotion,
    },
    /// The ties of vertices vanish.
    Untie {
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
    /// A body that moves as it is told has other velocities from now on.
    Drive {
        /// Its number in contact.
        body: usize,
        /// Its velocity (m/s), and its angular velocity (rad/s) about its position.
        velocities: [Vec3; 2],
    },
    /// A body that the cloth pushes, and that has been held until now, is let go.
    LetGo {
        /// Its number in contact.
        body: usize,
    },
    /// Triangles vanish, with all elements that need them. Masses, links, stitches and ties stay.
    Tear {
        /// What is left of the mesh, with all its vertices.
        mesh: TriMesh,
        /// What is left of the elements.
        model: Box<ClothModel>,
        /// Gases that are left inside of closed pieces.
        gases: Vec<Pressure>,
        /// Sealed volumes that are left.
        volumes: Vec<ClosedVolume>,
    },
}

impl Scene {
    /// The scene after a change of its cloth, which is in this state; the state of held vertices changes with it.
    pub(crate) fn after(&self, change: &Change, state: &mut State) -> Result<Self, BenchError> {
        let mut scene = self.clone();
        match &change.kind {
            ChangeKind::Hold { vertices, motion } => {
                scene.hold(vertices, *motion, state)?;
                for &vertex in vertices {
                    state.velocities[vertex] = Vec3::zeros();
                }
            }
            ChangeKind::Release { vertices } => {
                let mut pins = scene.pins.as_deref().cloned().unwrap_or_default();
                for &vertex in vertices {
                    let particles = &mut scene.model.particles;
                    let released = pins.release(particles, vertex);
                    released.map_err(BenchError::failed)?;
                }
                let is_left = |(vertex, _): &(usize, usize)| !vertices.contains(vertex);
                scene.carried.retain(is_left);
                scene.pins = Some(Arc::new(pins)).filter(|pins| !pins.is_empty());
            }
            ChangeKind::Tie {
                vertices,
                stiffness,
                motion,
            } => {
                let (x, now) = (&state.positions, state.time);
                let tie = |&v: &usize| SoftPin::new(v as u32, *stiffness, x[v], *motion, now);
                let pins = Elements::SoftPins(vertices.iter().map(tie).collect());
                scene.model.fasten([pins]);
            }
            ChangeKind::Untie { vertices } => {
                let is_held = |pin: &SoftPin| !vertices.contains(&(pin.vertex() as usize));
                for family in &mut scene.model.others {
                    if let Elements::SoftPins(pins) = family {
                        pins.retain(is_held);
                    }
                }
            }
            ChangeKind::Sew { seam, until } => {
                let times = [state.time, *until];
                let seam = seam.clone().closing(&state.positions, times);
                scene.model.sew(seam);
            }
            ChangeKind::Push { .. } => {}
            ChangeKind::Drive { body, velocities } => {
                if let Some(touch) = &mut scene.touch {
                    touch.drive(*body, *velocities, state.time)?;
                    let number = touch.body_numbers()[*body];
                    scene.carry_on(number, state)?;
                }
            }
            ChangeKind::LetGo { body } => {
                let touch = scene.touch.iter_mut();
                touch.for_each(|touch| touch.held.retain(|held| held != body));
            }
            ChangeKind::Tear {
                mesh,
                model,
                gases,
                volumes,
            } => {
                scene.gases.clone_from(gases);
                scene.volumes.clone_from(volumes);
                let fastenings: Vec<Elements> = scene.model.fastenings().cloned().collect();
                let particles = scene.model.particles;
                scene.mesh = Some(mesh.clone());
                scene.model = ClothModel {
                    particles,
                    ..(**model).clone()
                };
                scene.model.fasten(fastenings);
            }
        }
        Ok(scene)
    }
}

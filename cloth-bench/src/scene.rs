//! The physical scenes, stated once in SI units. Every method simulates the same one.

mod build;
mod change;
mod cloth;
mod contact;
pub mod file;
mod midpoints;
mod pins;
mod touching;

pub use build::build;
pub use change::{Change, ChangeKind, Motion};
pub use contact::ContactSetup;

use crate::error::BenchError;
use crate::settings::{Parameter, parameter};
use cloth_collide::SeparationProbe;
use cloth_collide::potential::PotentialContacts;
use cloth_collide::untangle::StepUntangler;
use cloth_core::air::Air;
use cloth_core::cloth::{ClothModel, Elements};
use cloth_core::element::Element;
use cloth_core::enclosure::{ClosedVolume, Enclosed, Pressure};
use cloth_core::energy::{Spring, Stitch};
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::TriMesh;
use cloth_core::method::family::Energies;
use cloth_core::particles::State;
use cloth_core::pin::Pins;
use cloth_core::step::BuildError;
use cloth_core::topology::EdgeTable;
use contact::{TOUCHING, TOUCHING_ALONE};
use std::sync::Arc;

/// What is simulated: the same masses, elements, pins and start for every method.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Its name.
    pub name: &'static str,
    /// Masses (pins included) and elements.
    pub model: ClothModel,
    /// Where it starts.
    pub start: State,
    /// The mesh at rest, for pictures and for counting crossings; a chain has none.
    pub mesh: Option<TriMesh>,
    /// Acceleration of free fall (m/s²).
    pub gravity: Vec3,
    /// Step size Δt (s) unless the caller wants another.
    pub dt: Real,
    /// Number of steps unless the caller wants another.
    pub steps: u32,
    /// How held vertices move; those of which it does not know stay where they are.
    pub pins: Option<Arc<Pins>>,
    /// What happens to the cloth on the way, in the order of time.
    pub changes: Vec<Change>,
    /// What the cloth can touch; nothing unless the scene says so.
    pub touch: Option<ContactSetup>,
    /// Gas of constant pressure inside closed pieces of it.
    pub gases: Vec<Pressure>,
    /// What resists a change of its volume inside closed pieces of it.
    pub volumes: Vec<ClosedVolume>,
    /// The air around it; without it no code for air runs.
    pub air: Option<Air>,
    /// Which vertex of the caller's mesh each vertex is, where vertices were renumbered.
    pub order: Option<cloth_core::method::ordering::Order>,
}

impl Scene {
    /// What resolves contact, if the scene has anything to touch, and keeps volumes, if it has any.
    ///
    /// # Errors
    /// [`BenchError::Usage`] for a mesh that does not serve.
    pub fn contacts(&self) -> Result<Option<Enclosed<PotentialContacts>>, BenchError> {
        let Some(mesh) = &self.mesh else {
            return Ok(None);
        };
        let touching = match &self.touch {
            Some(touch) => touch.source(mesh, &self.sewn())?,
            None => None,
        };
        let contacts = match touching {
            Some(contacts) => contacts,
            None if self.volumes.is_empty() => return Ok(None),
            None => {
                let nothing = PotentialContacts::builder(mesh).self_collision(false);
                nothing.build().map_err(BenchError::usage)?
            }
        };
        Ok(Some(Enclosed::new(self.volumes.clone(), contacts)))
    }

    /// What counts the crossings of the cloth and measures its distances, if it has a mesh.
    #[must_use]
    pub fn separation_probe(&self) -> Option<SeparationProbe> {
        let mesh = self.mesh.as_ref()?;
        let touch = self.touch.as_ref();
        let probe = touch.map_or_else(
            || SeparationProbe::new(mesh),
            |touch| touch.separation_probe(mesh),
        );
        Some(probe.sew(&self.sewn()))
    }

    /// Pairs of vertices that are sewn together, or are being drawn together.
    #[must_use]
    pub fn sewn(&self) -> Vec<[u32; 2]> {
        self.model.stitches().map(Element::vertices).collect()
    }

    /// Largest distance (m) between two vertices that are sewn together, if any are.
    #[must_use]
    pub fn max_seam_gap(&self, state: &State) -> Option<Real> {
        let x = |vertex: u32| state.positions[vertex as usize];
        let pairs = self.sewn().into_iter();
        pairs.map(|[a, b]| (x(a) - x(b)).norm()).reduce(Real::max)
    }

    /// Largest change of a sealed volume (dimensionless, of its rest volume), if there is any.
    #[must_use]
    pub fn max_volume_change(&self, state: &State) -> Option<Real> {
        let change = |v: &ClosedVolume| (v.volume(&state.positions) / v.rest_volume() - 1.0).abs();
        self.volumes.iter().map(change).reduce(Real::max)
    }

    /// Whether a seam closes in the step of `dt` (s) that has ended at `time` (s).
    pub(crate) fn is_closing(&self, time: Real, dt: Real) -> bool {
        let changes = |s: &Stitch| s.rest_length_at(time) != s.rest_length_at(time - dt);
        self.model.stitches().any(changes)
    }

    /// What pulls the cloth apart during a run, if the scene wants that.
    #[must_use]
    pub fn untangler(&self) -> Option<StepUntangler> {
        let touch = self.touch.as_ref().zip(self.mesh.as_ref());
        touch.and_then(|(touch, mesh)| touch.untangler(mesh))
    }

    /// Whether there is anything that the cloth can touch.
    #[must_use]
    pub fn can_touch(&self) -> bool {
        self.touch.as_ref().is_some_and(|touch| !touch.is_idle())
    }

    /// How far the cloth can fall before it lands (m): its distance from the obstacle that is farthest away; 0 where
    /// there is none.
    #[must_use]
    pub fn fall(&self) -> Real {
        let touch = self.touch.iter().filter(|touch| !touch.is_idle());
        let farthest = touch.flat_map(ContactSetup::obstacles).map(|obstacle| {
            let clearance = |&x: &Vec3| obstacle.signed_distance(x, 0.0).value;
            let places = self.start.positions.iter();
            places.map(clearance).fold(Real::INFINITY, Real::min)
        });
        farthest.fold(0.0, Real::max)
    }

    /// The largest tension (N/m) by what is inside of closed pieces, where the cloth starts.
    #[must_use]
    pub fn lasting_tension(&self) -> Real {
        let x = &self.start.positions;
        let gases = self.gases.iter().map(|gas| gas.tension(x));
        let all = gases.chain(self.volumes.iter().map(|volume| volume.tension(x)));
        all.fold(0.0, Real::max)
    }

    /// Whether springs or links are hard constraints, of infinite stiffness.
    #[must_use]
    pub fn is_hard(&self) -> bool {
        let springs = self.model.all_springs();
        springs.map(|s| s.stiffness).any(Real::is_infinite)
    }

    /// The elastic energy; hard constraints store none.
    ///
    /// # Errors
    /// [`BuildError`] if an element names a vertex that does not exist.
    pub fn elastic(&self) -> Result<Energies, BuildError> {
        if !self.is_hard() {
            return self.model.energies();
        }
        let mut soft = self.model.clone();
        let is_soft = |spring: &Spring| spring.stiffness.is_finite();
        soft.springs.retain(is_soft);
        for family in &mut soft.others {
            if let Elements::Springs(springs) = family {
                springs.retain(is_soft);
            }
        }
        soft.energies()
    }

    /// Into how many equal parts a run cuts a step of `dt` (s): 1, or more where the cloth pushes a body.
    #[must_use]
    pub fn parts(&self, dt: Real) -> u32 {
        self.touch.as_ref().map_or(1, |touch| touch.parts(dt))
    }

    /// Whether a step is nothing but the elastic one: nothing to touch, no air or gas, pins at rest, no seams,
    /// nothing that changes.
    #[must_use]
    pub fn is_plain(&self) -> bool {
        self.pins.is_none()
            && self.air.is_none()
            && self.gases.is_empty()
            && self.changes.is_empty()
            && self.model.stitches().next().is_none()
            && self.volumes.is_empty()
            && !self.can_touch()
    }

    /// Surfaces of the obstacles, for pictures: their vertices (m) at a time (s), and their triangles.
    #[must_use]
    pub fn obstacle_surfaces(&self, time: Real) -> Vec<(Vec<Vec3>, &[[u32; 3]])> {
        self.touch
            .iter()
            .flat_map(|touch| touch.surfaces(time))
            .collect()
    }

    /// Springs to measure stretch by: those of the model, or one on every edge of a sheet whose membrane is made of
    /// triangles.
    ///
    /// # Errors
    /// [`BenchError::Failed`] if an edge of the mesh is not manifold.
    pub fn gauges(&self) -> Result<Vec<Spring>, BenchError> {
        match &self.mesh {
            Some(mesh) if self.model.springs.is_empty() => {
                let edges = EdgeTable::build(mesh).map_err(BenchError::failed)?;
                Ok(Spring::along(mesh.positions(), edges.ends(), 0.0))
            }
            _ => Ok(self.model.springs.clone()),
        }
    }
}

/// A scene that can be named.
#[derive(Clone, Copy, Debug)]
pub struct SceneInfo {
    /// Its name.
    pub name: &'static str,
    /// What it is.
    pub about: &'static str,
    /// What can be set, in groups.
    groups: &'static [&'static [Parameter]],
}

impl SceneInfo {
    /// What can be set, in groups.
    #[must_use]
    pub fn groups(&self) -> &'static [&'static [Parameter]] {
        self.groups
    }
}

pub(crate) const DENSITY: Parameter = parameter("density", "0.2", "areal density (kg/m²)");
pub(crate) const STIFFNESS: Parameter = parameter(
    "stiffness",
    "1e4",
    "stiffness k of every spring (N/m), at least 0, or inf: hard constraints, with xpbd alone",
);
pub(crate) const MODULUS: Parameter = parameter(
    "modulus",
    "none",
    "membrane modulus Y (N/m) in the place of the stiffness of springs, or none",
);
pub(crate) const MEMBRANE: Parameter = parameter(
    "membrane",
    "springs",
    "elements that resist stretching: springs, stvk or arap; triangles get the modulus that springs of the given stiffness have",
);
pub(crate) const POISSON: Parameter = parameter(
    "poisson",
    "0.3333333333333333",
    "Poisson's ratio of stvk, from −1 to 1; springs have 1/3",
);
pub(crate) const SHEAR: Parameter = parameter(
    "shear",
    "none",
    "stiffness of springs along both diagonals of rectangular cells (N/m), or none: one diagonal, as stiff as the other edges",
);
pub(crate) const BENDING: Parameter = parameter(
    "bending",
    "quadratic",
    "elements that resist bending: quadratic, dihedral, bridson (a moment with sin θ/2), cubic, curved, spring (across hinges) or none",
);
pub(crate) const BENDING_STIFFNESS: Parameter = parameter(
    "bending_stiffness",
    "1",
    "stiffness of springs across hinges (N/m)",
);
pub(crate) const RIGIDITY: Parameter = parameter("rigidity", "1e-5", "bending rigidity D (N·m)");
pub(crate) const GRAVITY: Parameter =
    parameter("gravity", "9.81", "acceleration of free fall (m/s²)");
pub(crate) const SIZE: Parameter = parameter("n", "33", "vertices a side");
pub(crate) const PATTERN: Parameter = parameter(
    "pattern",
    "alternating",
    "diagonals: one-way, alternating or crossed",
);
pub(crate) const PINS: Parameter = parameter(
    "pins",
    "default",
    "held vertices: default (corners of a grid, highest of a file), corners, highest, none, or numbers such as 0,32",
);
pub(crate) const UP: Parameter = parameter(
    "up",
    "default",
    "axis against gravity: x, y or z (default z, for a file y)",
);
pub(crate) const LINKS: Parameter = parameter("n", "20", "number of free masses");
pub(crate) const LINK_LENGTH: Parameter = parameter("link", "0.05", "length of a link (m)");
pub(crate) const LINK_MASS: Parameter = parameter("mass", "0.01", "mass of a vertex (kg)");
pub(crate) const TIP_MASS: Parameter =
    parameter("tip_mass", "0.01", "mass of the last vertex (kg)");
pub(crate) const ASPECT: Parameter =
    parameter("length", "1", "length of the strip (m), 0.2 m wide");
pub(crate) const STRIP_SIZE: Parameter = parameter("n", "8", "cells across the strip");
pub(crate) const STRIP_RIGIDITY: Parameter =
    parameter("rigidity", "0.1", "bending rigidity D (N·m)");

pub(crate) const FLOOR: Parameter = parameter(
    "floor",
    "none",
    "how far below the lowest vertex there is a floor (m), or none",
);
pub(crate) const TURNS: Parameter =
    parameter("turns", "4", "full turns of one end against the other");
pub(crate) const ROPE: Parameter = parameter(
    "rope",
    "0.025",
    "radius (m) of the rope that the towel becomes: its ends come together by so much that a strand at this radius keeps its length",
);
pub(crate) const SHEETS: Parameter = parameter("sheets", "10", "number of sheets");

/// What can be set of a sheet that the scene makes and places itself.
const OWN_SHEET: &[Parameter] = &[
    SIZE,
    PATTERN,
    DENSITY,
    STIFFNESS,
    MODULUS,
    MEMBRANE,
    POISSON,
    SHEAR,
    RIGIDITY,
    BENDING,
    BENDING_STIFFNESS,
    GRAVITY,
];

/// What can be set of a sheet.
const SHEET: &[Parameter] = &[
    SIZE,
    PATTERN,
    DENSITY,
    STIFFNESS,
    MODULUS,
    MEMBRANE,
    POISSON,
    SHEAR,
    cloth::COMPRESSION,
    cloth::SLACK,
    cloth::EDGES,
    cloth::LEVEL,
    cloth::FINE_SHARE,
    RIGIDITY,
    BENDING,
    BENDING_STIFFNESS,
    GRAVITY,
    PINS,
    UP,
];

/// Every scene.
pub const SCENES: [SceneInfo; 9] = [
    SceneInfo {
        name: "hang",
        about: "a sheet of 1 m × 1 m held at two corners, starting horizontal; with --mesh any OBJ or PLY file, held at its highest vertices",
        groups: &[SHEET, &[midpoints::POINTS], TOUCHING_ALONE],
    },
    SceneInfo {
        name: "drop",
        about: "the same sheet in free fall, held nowhere: it must not deform; or onto a floor",
        groups: &[SHEET, TOUCHING_ALONE, &[FLOOR]],
    },
    SceneInfo {
        name: "drape-sphere",
        about: "the same sheet, or with --mesh any, falls on a sphere of 0.3 m",
        groups: &[SHEET, TOUCHING],
    },
    SceneInfo {
        name: "drape-box",
        about: "the same on a cube of 0.5 m that turns by 2 rad/s",
        groups: &[SHEET, TOUCHING],
    },
    SceneInfo {
        name: "fold",
        about: "a ribbon of 1 m × 0.25 m, upright on a floor, falls down on itself",
        groups: &[OWN_SHEET, TOUCHING],
    },
    SceneInfo {
        name: "twist",
        about: "a narrow towel of 1 m × 0.1 m whose ends are turned against each other within 4 s, and come nearer as it becomes a rope; with n = 33 its edges are as long as the rope is thick, and layers hook into each other; with 65 rarely",
        groups: &[OWN_SHEET, TOUCHING, &[TURNS, ROPE]],
    },
    SceneInfo {
        name: "stack",
        about: "sheets of 0.5 m × 0.5 m, each turned by 0.1 rad against the one below, on a floor: they stay where they are",
        groups: &[OWN_SHEET, TOUCHING, &[SHEETS]],
    },
    SceneInfo {
        name: "chain",
        about: "a chain of equal links held at one end, starting horizontal",
        groups: &[&[LINKS, LINK_LENGTH, LINK_MASS, TIP_MASS, STIFFNESS, GRAVITY]],
    },
    SceneInfo {
        name: "cantilever",
        about: "a strip clamped at one end, bending under its own weight",
        groups: &[&[
            STRIP_SIZE,
            ASPECT,
            PATTERN,
            DENSITY,
            STIFFNESS,
            MODULUS,
            MEMBRANE,
            POISSON,
            SHEAR,
            cloth::COMPRESSION,
            cloth::SLACK,
            cloth::EDGES,
            cloth::LEVEL,
            cloth::FINE_SHARE,
            STRIP_RIGIDITY,
            BENDING,
            BENDING_STIFFNESS,
            GRAVITY,
        ]],
    },
];

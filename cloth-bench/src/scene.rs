//! The physical scenes, stated once in SI units. Every method simulates the same one.

mod build;
mod change;
mod cloth;
mod contact;
mod drives;
pub mod file;
mod gauges;
mod held;
mod inside;
mod load;
mod loose;
mod midpoints;
pub mod pins;
mod touching;

pub use build::build;
pub use change::{Change, ChangeKind};
pub use contact::{BodySurface, ContactSetup};
pub use held::HeldMotion;

use crate::error::BenchError;
use crate::settings::{Parameter, Range::*, Settings, Table};
use cloth::{EdgeSprings, Material, Stiffness};
use cloth_collide::SeparationProbe;
use cloth_collide::potential::PotentialContacts;
use cloth_collide::untangle::StepUntangler;
use cloth_core::air::Air;
use cloth_core::cloth::{ClothModel, Elements};
use cloth_core::enclosure::{ClosedVolume, Enclosed, Pressure};
use cloth_core::energy::{Spring, Stitch};
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::Diagonals;
use cloth_core::method::family::Energies;
use cloth_core::particles::State;
use cloth_core::pin::{PinMotion, Pins};
use cloth_core::step::BuildError;
use contact::{Contact, Surface};
use midpoints::Midpoints;
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
    /// Those of them that go with a body, and its number in the scene.
    pub carried: Vec<(usize, usize)>,
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
    /// Masses (kg) beside its own, each on these vertices together.
    pub added_masses: Vec<(Vec<usize>, Real)>,
    /// Which vertex of the caller's mesh each vertex is, where vertices were renumbered.
    pub order: Option<cloth_core::method::ordering::Order>,
    /// What is seldom meant of what it was built from, a sentence each.
    pub hints: Vec<String>,
    /// Its file, as errors begin; empty for a scene of the program.
    pub file: String,
    /// Where that has the first hard constraints, as errors begin; empty without any.
    pub hard_place: String,
    /// Where its file has what happens on the way, and the time (s) of that.
    pub event_times: Vec<(String, Real)>,
    /// What its file says of methods, by the names of these.
    pub methods: Vec<(&'static str, Settings)>,
}

impl Scene {
    /// A cloth at rest at `positions` (m), with the steps of all named scenes and nothing else around it.
    pub(crate) fn new(
        name: &'static str,
        model: ClothModel,
        positions: Vec<Vec3>,
        mesh: Option<TriMesh>,
        gravity: Vec3,
    ) -> Self {
        Self {
            name,
            model,
            start: State::at_rest(positions),
            mesh,
            gravity,
            dt: 1.0 / 60.0,
            steps: 300,
            pins: None,
            carried: Vec::new(),
            changes: Vec::new(),
            touch: None,
            gases: Vec::new(),
            volumes: Vec::new(),
            air: None,
            added_masses: Vec::new(),
            order: None,
            hints: Vec::new(),
            file: String::new(),
            hard_place: String::new(),
            event_times: Vec::new(),
            methods: Vec::new(),
        }
    }

    /// The settings of a method that stand in the file of the scene.
    pub fn settings_of(&self, method: &str) -> Settings {
        let own = self.methods.iter().find(|(name, _)| *name == method);
        own.map_or_else(Settings::default, |(_, settings)| settings.clone())
    }

    /// What resolves contact, if the scene has anything to touch, and keeps volumes, if it has any.
    pub fn contacts(&self) -> Result<Option<Enclosed<PotentialContacts>>, BenchError> {
        self.contacts_from(0.0)
    }

    /// The same for steps that begin at a time (s).
    pub(crate) fn contacts_from(
        &self,
        time: Real,
    ) -> Result<Option<Enclosed<PotentialContacts>>, BenchError> {
        let Some(mesh) = &self.mesh else {
            return Ok(None);
        };
        let touching = match &self.touch {
            Some(touch) => touch.source(mesh, &self.model.seam(), time)?,
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
    pub fn separation_probe(&self) -> Option<SeparationProbe> {
        let mesh = self.mesh.as_ref()?;
        let touch = self.touch.as_ref();
        let probe = touch.map_or_else(
            || SeparationProbe::new(mesh),
            |touch| touch.separation_probe(mesh),
        );
        let seam = self.model.seam();
        Some(probe.sew(&seam.sewn_pairs(), &seam.sewn_onto_edges()))
    }

    /// Pairs of vertices that are sewn together, or are being drawn together.
    pub fn sewn(&self) -> Vec<[u32; 2]> {
        self.model.seam().sewn_pairs()
    }

    /// Largest distance (m) of a vertex from the one that it is sewn to, or from its point of an edge, if any is sewn.
    pub fn max_seam_gap(&self, state: &State) -> Option<Real> {
        let seam = self.model.seam();
        let gaps = seam.gaps(&state.positions).map(|gap| gap.norm());
        gaps.reduce(Real::max)
    }

    /// Largest change of a sealed volume (dimensionless, of its rest volume), if there is any.
    pub fn max_volume_change(&self, state: &State) -> Option<Real> {
        let change = |v: &ClosedVolume| (v.volume(&state.positions) / v.rest_volume() - 1.0).abs();
        self.volumes.iter().map(change).reduce(Real::max)
    }

    /// Whether a seam closes, or the point of a soft pin moves, in the step of `dt` (s) that has ended at `time` (s).
    pub(crate) fn is_driven(&self, time: Real, dt: Real) -> bool {
        fn changes<const N: usize>(stitch: &Stitch<N>, [a, b]: [Real; 2]) -> bool {
            stitch.rest_length_at(a) != stitch.rest_length_at(b)
        }
        let times = [time - dt, time];
        self.model.stitches().any(|stitch| changes(stitch, times))
            || self
                .model
                .edge_stitches()
                .any(|stitch| changes(stitch, times))
            || self
                .model
                .soft_pins()
                .any(|pin| pin.target_at(times[0]) != pin.target_at(time))
    }

    /// What pulls the cloth of `contacts` apart during a run, if the scene wants that.
    pub fn untangler(&self, contacts: &PotentialContacts) -> Option<StepUntangler> {
        let wanted = self.touch.as_ref().filter(|touch| touch.untangles());
        wanted.and_then(|_| StepUntangler::new(contacts))
    }

    /// Whether there is anything that the cloth can touch.
    pub fn can_touch(&self) -> bool {
        self.touch.as_ref().is_some_and(|touch| !touch.is_idle())
    }

    /// Whether springs or links are hard constraints, of infinite stiffness.
    pub fn is_hard(&self) -> bool {
        let springs = self.model.all_springs();
        springs.map(|s| s.stiffness).any(Real::is_infinite)
    }

    /// Whether they are links alone, if there are any.
    pub(crate) fn is_hard_by_links(&self) -> bool {
        let own = self.model.others.iter().filter_map(|family| match family {
            Elements::Springs(springs) => Some(&springs[..]),
            _ => None,
        });
        let springs = own.flatten().chain(&self.model.springs);
        !springs.map(|s| s.stiffness).any(Real::is_infinite)
    }

    /// The elastic energy; hard constraints store none.
    pub fn elastic(&self) -> Result<Energies, BuildError> {
        if !self.is_hard() {
            return self.model.energies();
        }
        let mut soft = self.model.clone();
        let is_soft = |spring: &Spring| spring.stiffness.is_finite();
        soft.springs.retain(is_soft);
        for family in &mut soft.others {
            if let Elements::Springs(springs) | Elements::Links(springs) = family {
                springs.retain(is_soft);
            }
        }
        soft.energies()
    }

    /// Into how many equal parts a run cuts a step of `dt` (s): 1, or more where the cloth pushes a body.
    pub fn parts(&self, dt: Real) -> u32 {
        self.touch.as_ref().map_or(1, |touch| touch.parts(dt))
    }

    /// Whether a step is nothing but the elastic one: nothing to touch, no air or gas, pins at rest, no seams,
    /// nothing that changes.
    pub fn is_plain(&self) -> bool {
        self.pins.is_none()
            && self.air.is_none()
            && self.gases.is_empty()
            && self.changes.is_empty()
            && self.model.stitches().next().is_none()
            && self.model.edge_stitches().next().is_none()
            && self
                .model
                .soft_pins()
                .all(|pin| *pin.motion() == PinMotion::NONE)
            && self.volumes.is_empty()
            && !self.can_touch()
    }

    /// Surfaces of the obstacles, for pictures: their vertices (m) at a time (s), and their triangles.
    pub fn obstacle_surfaces(&self, time: Real) -> Vec<(Vec<Vec3>, &[[u32; 3]])> {
        self.touch
            .iter()
            .flat_map(|touch| touch.surfaces(time))
            .collect()
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
    groups: &'static [&'static [&'static [Parameter]]],
}

impl SceneInfo {
    /// What can be set, in groups.
    pub fn groups(&self) -> Vec<&'static [Parameter]> {
        self.groups.concat()
    }

    /// Where the defaults are others than those of the parameters: `key=value` pairs.
    pub(crate) fn defaults(&self) -> &'static str {
        match self.name {
            "cantilever" => "rigidity=0.1",
            "fold" | "twist" | "stack" | "drape-sphere" | "drape-box" => "self=yes",
            _ => "",
        }
    }
}

crate::settings! {
    /// Of a sheet that the scene makes itself.
    pub(crate) struct Grid {
        n: u32 = 33 in AtLeast(2.0), "vertices a side";
        pattern: Diagonals = "alternating", "diagonals: one-way, alternating or crossed";
    }
    /// Of the strip of `cantilever`.
    pub(crate) struct Strip {
        n: u32 = 8 in AtLeast(1.0), "cells across the strip";
        length: Real = 1 "m" in Above(0.0), "length of the strip, 0.2 m wide";
        pattern: Diagonals = "alternating", "diagonals: one-way, alternating or crossed";
    }
    /// Of every scene.
    pub(crate) struct Weight {
        gravity: Real = 9.81 "m/s²", "acceleration of free fall";
    }
    /// Of a sheet that may be any mesh.
    pub(crate) struct Placed {
        pins: String = "default",
            "held vertices: default (corners of a grid, highest of a file), corners, highest, none, or numbers such as \
             0,32";
        up: Axis = "default", "axis against gravity: x, y or z (default z, for a file y)";
    }
}

crate::choices! {
    /// An axis of space.
    #[derive(PartialEq)]
    pub(crate) enum Axis { Default = "default", X = "x", Y = "y", Z = "z" }
}

crate::settings! {
    /// Of a chain.
    pub(crate) struct Chain {
        n: u32 = 20 in Within(1.0, MOST_LINKS), "number of free masses";
        link: Real = 0.05 "m" in Above(0.0), "length of a link";
        mass: Real = 0.01 "kg", "mass of a vertex";
        tip_mass: Real = 0.01 "kg", "mass of the last vertex";
    }
}

/// A longer chain is a slip of the pen.
const MOST_LINKS: Real = 1e7;

crate::settings! {
    /// Of `drop`.
    pub(crate) struct Floor {
        floor: Option<Real> = "none" "m", "depth of a floor, two thicknesses more, below the lowest vertex, or none";
    }
    /// Of `twist`.
    pub(crate) struct Twist {
        turns: Real = 4, "full turns of one end against the other";
        rope: Real = 0.025 "m",
            "radius of the rope that the towel becomes: its ends come together by so much that a strand at this radius \
             keeps its length";
    }
    /// Of `stack`.
    pub(crate) struct Stack {
        sheets: u32 = 10 in AtLeast(1.0), "number of sheets";
    }
}

/// What can be set of a sheet that the scene makes and places itself, with contact.
const OWN_SHEET: &[&[Parameter]] = &[
    Grid::PARAMETERS,
    Stiffness::PARAMETERS,
    Material::PARAMETERS,
    Weight::PARAMETERS,
    Surface::PARAMETERS,
    Contact::PARAMETERS,
];

/// What else can be set of a sheet that may be any mesh.
const SHEET: &[&[Parameter]] = &[EdgeSprings::PARAMETERS, Placed::PARAMETERS];

/// Every scene.
pub const SCENES: [SceneInfo; 9] = [
    SceneInfo {
        name: "hang",
        about: "a sheet of 1 m × 1 m held at two corners, starting horizontal; with --mesh any OBJ or PLY file, held at its highest vertices",
        groups: &[OWN_SHEET, SHEET, &[Midpoints::PARAMETERS]],
    },
    SceneInfo {
        name: "drop",
        about: "the same sheet in free fall, held nowhere: it must not deform; or onto a floor",
        groups: &[OWN_SHEET, SHEET, &[Floor::PARAMETERS]],
    },
    SceneInfo {
        name: "drape-sphere",
        about: "the same sheet, or with --mesh any, falls on a sphere of 0.3 m",
        groups: &[OWN_SHEET, SHEET],
    },
    SceneInfo {
        name: "drape-box",
        about: "the same on a cube of 0.5 m that turns by 2 rad/s",
        groups: &[OWN_SHEET, SHEET],
    },
    SceneInfo {
        name: "fold",
        about: "a ribbon of 1 m × 0.25 m, upright on a floor, falls down on itself",
        groups: &[OWN_SHEET],
    },
    SceneInfo {
        name: "twist",
        about: "a narrow towel of 1 m × 0.1 m whose ends are turned against each other within 4 s, and come nearer as it becomes a rope; with n = 33 its edges are as long as the rope is thick, and layers hook into each other; with 65 rarely",
        groups: &[OWN_SHEET, &[Twist::PARAMETERS]],
    },
    SceneInfo {
        name: "stack",
        about: "sheets of 0.5 m × 0.5 m, each turned by 0.1 rad against the one below, on a floor: they stay where they are",
        groups: &[OWN_SHEET, &[Stack::PARAMETERS]],
    },
    SceneInfo {
        name: "chain",
        about: "a chain of equal links held at one end, starting horizontal",
        groups: &[&[Chain::PARAMETERS, Stiffness::PARAMETERS, Weight::PARAMETERS]],
    },
    SceneInfo {
        name: "cantilever",
        about: "a strip clamped at one end, bending under its own weight",
        groups: &[&[
            Strip::PARAMETERS,
            Stiffness::PARAMETERS,
            Material::PARAMETERS,
            EdgeSprings::PARAMETERS,
            Weight::PARAMETERS,
        ]],
    },
];

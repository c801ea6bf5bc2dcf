//! Crossings and distances after every step.

use crate::error::BenchError;
use crate::scene::Scene;
use cloth_collide::{BodyProbe, SeparationProbe};
use cloth_core::math::Real;
use cloth_core::particles::State;
use serde::{Deserialize, Serialize};

/// What [`SeparationWatch`] has seen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Watched {
    /// Steps after which triangles of the cloth crossed each other.
    pub crossed_steps: u32,
    /// Steps after which triangles of the cloth crossed those of a body.
    pub obstacle_crossed_steps: u32,
    /// Largest number of crossing pairs of triangles after a step.
    pub most_intersections: usize,
    /// Largest number of pairs of a triangle of the cloth and one of a body that cross after a step.
    pub most_obstacle_intersections: usize,
    /// Smallest distance (m) after a step between parts that share no vertex.
    pub min_distance: Option<Real>,
    /// Smallest distance (m) after a step of a vertex from a body, negative inside a rigid one and without a sign from
    /// an animated one.
    pub min_clearance: Option<Real>,
}

/// Looks at the cloth after every step: a crossing that comes and goes leaves no trace at the end.
#[derive(Debug)]
pub struct SeparationWatch {
    probe: Option<SeparationProbe>,
    bodies: Option<BodyProbe>,
    /// Of triangles and of stitches: another probe is needed where these change.
    counts: [usize; 2],
    seen: Watched,
}

impl SeparationWatch {
    /// For a run of this scene.
    pub fn new(scene: &Scene) -> Result<Self, BenchError> {
        Ok(Self {
            probe: scene.separation_probe(),
            bodies: body_probe(scene)?,
            counts: counts(scene),
            seen: Watched::default(),
        })
    }

    /// Looks at a state of the scene as it is by now.
    pub fn look(&mut self, scene: &Scene, state: &State) -> Result<(), BenchError> {
        if self.counts != counts(scene) {
            let seen = self.seen;
            *self = Self::new(scene)?;
            self.seen = seen;
        }
        let least = |a: Option<Real>, b: Option<Real>| a.into_iter().chain(b).reduce(Real::min);
        self.seen.min_clearance = least(self.seen.min_clearance, min_clearance(scene, state));
        if let Some(now) = crossed_bodies(scene, &mut self.bodies, state)? {
            let most = &mut self.seen.most_obstacle_intersections;
            *most = now.max(*most);
            self.seen.obstacle_crossed_steps += u32::from(now > 0);
        }
        if let Some(probe) = &mut self.probe {
            let now = probe.measure(&state.positions)?;
            self.seen.crossed_steps += u32::from(now.intersecting_pairs > 0);
            self.seen.most_intersections = self.seen.most_intersections.max(now.intersecting_pairs);
            self.seen.min_distance = least(self.seen.min_distance, now.min_distance);
        }
        Ok(())
    }

    /// What was seen so far.
    pub fn seen(&self) -> Watched {
        self.seen
    }
}

fn counts(scene: &Scene) -> [usize; 2] {
    let mesh = scene.mesh.as_ref();
    let triangles = mesh.map_or(0, |mesh| mesh.triangles().len());
    let model = &scene.model;
    let stitches = model.stitches().count() + model.edge_stitches().count();
    [triangles, stitches]
}

/// What counts triangles that go through bodies, where that can be.
pub(super) fn body_probe(scene: &Scene) -> Result<Option<BodyProbe>, BenchError> {
    match (&scene.touch, &scene.mesh) {
        (Some(touch), Some(mesh)) => touch.probe(mesh),
        _ => Ok(None),
    }
}

/// How many it finds.
pub(super) fn crossed_bodies(
    scene: &Scene,
    probe: &mut Option<BodyProbe>,
    state: &State,
) -> Result<Option<usize>, BenchError> {
    match (probe, &scene.touch) {
        (Some(probe), Some(touch)) => touch.count(probe, &state.positions, state.time).map(Some),
        _ => Ok(None),
    }
}

/// Smallest distance (m) of a vertex from a body, where the bodies are at the time of the state.
pub(super) fn min_clearance(scene: &Scene, state: &State) -> Option<Real> {
    let touch = scene.touch.as_ref()?;
    touch.min_clearance(&state.positions, state.time)
}

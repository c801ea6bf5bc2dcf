//! A cloth that starts tangled, pulled apart on the way.

use super::Summary;
use super::timed::Timed;
use crate::error::BenchError;
use crate::scene::Scene;
use crate::tangle;
use cloth_collide::untangle::{CrossingPairs, StepUntangler};
use cloth_core::particles::State;

/// What pulls it apart, and what has crossed so far.
#[derive(Debug, Default)]
pub(super) struct Untangling {
    /// None unless the scene wants one.
    untangler: Option<StepUntangler>,
    /// What crossed before each step, until nothing did.
    found: Vec<CrossingPairs>,
    /// Whether that of the step that has begun is not among them yet.
    is_new: bool,
}

impl Untangling {
    pub(super) fn new(scene: &Scene, contacts: Option<&Timed>) -> Self {
        Self {
            untangler: contacts.and_then(|timed| scene.untangler(&timed.source.contacts)),
            ..Self::default()
        }
    }

    /// Goes on with other contacts, or other seams, if it is not done.
    pub(super) fn renew(&mut self, scene: &Scene, timed: &Timed) {
        if self.is_on() {
            self.untangler = scene.untangler(&timed.source.contacts);
        }
    }

    /// Whether there is anything to be done.
    pub(super) fn is_on(&self) -> bool {
        self.untangler.as_ref().is_some_and(|u| !u.is_done())
    }

    /// A step begins, of one part or several.
    pub(super) fn begin_step(&mut self) {
        self.is_new = self.is_on();
        // The last part of the step before may have found that nothing crosses any more.
        if !self.is_new && self.found.last().is_some_and(|last| last.count() > 0) {
            self.found.push(CrossingPairs::default());
        }
    }

    /// Before a part of a step: pulls the cloth apart, until it is done. Returns whether it has to be looked after in
    /// this part.
    pub(super) fn begin_part(
        &mut self,
        scene: &Scene,
        contacts: Option<&mut Timed>,
        state: &mut State,
    ) -> Result<bool, BenchError> {
        let untangler = self.untangler.as_mut().filter(|u| !u.is_done());
        let (Some(untangler), Some(timed)) = (untangler, contacts) else {
            return Ok(false);
        };
        let w = scene.model.particles.inverse_mass();
        let contacts = &mut timed.source.contacts;
        let found =
            untangler.begin_step(contacts, w, &mut state.positions, &mut state.velocities)?;
        if std::mem::take(&mut self.is_new) {
            self.found.push(found);
        }
        Ok(true)
    }

    /// What crossed before step `step`, from 1, if that was looked at.
    pub(super) fn before(&self, step: u32) -> Option<CrossingPairs> {
        self.found.get(step as usize - 1).copied()
    }

    /// Enters what crossed before each step, and what is left of it in a cloth that has come to `state` after `steps`
    /// steps, although it should be untangled by now.
    pub(super) fn report(self, scene: &Scene, state: &State, summary: &mut Summary) {
        let ends = [summary.intersections, summary.obstacle_intersections];
        let is_free = ends.into_iter().flatten().all(|pairs| pairs == 0);
        let last = self.found.iter().rposition(|found| found.count() > 0);
        let first_free = last.map_or(0, |last| last + 1);
        if !self.found.is_empty() && (is_free || first_free < self.found.len()) {
            summary.untangled_after = Some(first_free as u32);
        }
        summary.tangled_pairs = self.found.iter().map(|found| found.own).collect();
        summary.tangled_obstacle_pairs = self.found.iter().map(|found| found.bodies).collect();
        let left = self.untangler.as_ref().zip(scene.mesh.as_ref());
        let left = left.filter(|_| !is_free).and_then(|(untangler, mesh)| {
            let since = untangler.unimproved_since()?;
            let name = |t: usize| scene.touch.as_ref()?.body_triangle(t);
            let left = tangle::describe(mesh, &state.positions, untangler.pairs(), name);
            Some(format!(
                "untangling has not come to its end, and has been no nearer to it since step {}: {left}",
                since + 1
            ))
        });
        summary.tangled = left;
    }
}

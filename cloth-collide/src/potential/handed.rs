//! Shapes of a body that are not known in advance: a character that somebody plays.

use super::surfaces::{PotentialContacts, Surface, SurfaceMotion, Surfaces};
use crate::obstacle::{AnimatedMesh, ObstacleError};
use cloth_core::error::{OutOfRange, positive};
use cloth_core::math::{Real, Vec3, is_finite};

/// The way of a surface from one shape to the next.
#[derive(Clone, Debug)]
pub(super) struct Handed {
    /// Its vertices (m) at both ends.
    from: Vec<Vec3>,
    to: Vec<Vec3>,
    /// When it begins, and how long it takes (s).
    since: Real,
    within: Real,
}

impl Handed {
    /// `animation` has been what moves it until `since` (s).
    pub(super) fn after(animation: &AnimatedMesh, since: Real) -> Self {
        let mut from = vec![Vec3::zeros(); animation.vertex_count()];
        animation.interpolate(since, &mut from);
        Self {
            to: from.clone(),
            from,
            since,
            within: 1.0,
        }
    }

    fn fraction(&self, time: Real) -> Real {
        ((time - self.since) / self.within).clamp(0.0, 1.0)
    }

    /// Writes where the vertices are at `time` (s) to `out` (m).
    pub(super) fn place(&self, time: Real, out: &mut [Vec3]) {
        let fraction = self.fraction(time);
        for ((x, a), b) in out.iter_mut().zip(&self.from).zip(&self.to) {
            *x = a + (b - a) * fraction;
        }
    }

    /// From `since` (s) on it goes to the shape `to` (m), which it has after `within` (s).
    fn go_to(&mut self, to: &[Vec3], since: Real, within: Real) {
        let fraction = self.fraction(since);
        for (a, b) in self.from.iter_mut().zip(&self.to) {
            *a += (b - *a) * fraction;
        }
        self.to.copy_from_slice(to);
        (self.since, self.within) = (since, within);
    }
}

impl Surfaces {
    /// How many bodies have shapes.
    pub(super) fn animated_count(&self) -> usize {
        let is_own = |s: &&Surface| matches!(s.motion, SurfaceMotion::Own(..));
        self.list.iter().filter(is_own).count()
    }

    /// The body of this number of those that have shapes.
    pub(super) fn animated(&self, number: usize) -> Option<&Surface> {
        let is_own = |s: &&Surface| matches!(s.motion, SurfaceMotion::Own(..));
        self.list.iter().filter(is_own).nth(number)
    }

    /// The way of that body from one shape to the next, which begins at `time` (s) if it had an animation until then.
    pub(super) fn handed(&mut self, number: usize, time: Real) -> Option<&mut Handed> {
        let own = self.list.iter_mut().filter_map(|s| match &s.motion {
            SurfaceMotion::Own(animation, _) => Some((animation, &mut s.handed)),
            SurfaceMotion::Obstacle(_) => None,
        });
        let (animation, handed) = { own }.nth(number)?;
        Some(handed.get_or_insert_with(|| Handed::after(animation, time)))
    }
}

impl PotentialContacts {
    /// The animated body of this number (counted as in [`ContactForces::bodies`](super::ContactForces::bodies): the
    /// obstacles have the first numbers) goes from where it is straight to `positions` (m), one per vertex of its mesh,
    /// which it reaches `within` (s) of the beginning of the next step; it stays there until it is handed the next
    /// shape. What it was told before, by its [`AnimatedMesh`] too, holds no more.
    ///
    /// For a body whose shapes are not known in advance: build it by
    /// [`animated`](super::PotentialBuilder::animated) with an animation of one shape, the first, and hand it the next
    /// one before each step, with the size of that as `within`. A step that is cut into several, each a step of its
    /// own, needs no more than that. Cloth meets it with the velocities that follow, (new − old)/`within`: a shape that
    /// is far from the last one is fast.
    ///
    /// After a step that has failed or was [taken back](Self::take_back), the body begins where that has begun, and is
    /// on its way to the same shape; to hand it another one is to begin from there.
    ///
    /// # Errors
    /// [`ObstacleError::OutOfRange`] if no animated body has this number, there is not one position per vertex, or
    /// `within` is not positive and finite; [`ObstacleError::NonFinite`] for a position. Nothing has changed then.
    pub fn set_shape(
        &mut self,
        body: usize,
        positions: &[Vec3],
        within: Real,
    ) -> Result<(), ObstacleError> {
        let refused = |name, value: usize, range| {
            let value = value as Real;
            Err(ObstacleError::OutOfRange(OutOfRange { name, value, range }))
        };
        let obstacles = self.contacts.bodies.len();
        let number = body.checked_sub(obstacles);
        let Some(surface) = number.and_then(|n| self.surfaces.animated(n)) else {
            return refused("number of an animated body", body, "one that has shapes");
        };
        let count = surface.mesh.vertex_count();
        if positions.len() != count {
            return refused(
                "number of positions of a shape",
                positions.len(),
                "that of its vertices",
            );
        }
        if !positions.iter().all(is_finite) {
            let name = "vertex of a shape";
            return Err(ObstacleError::NonFinite { name });
        }
        let within = positive("time until a body has its next shape (s)", within)?;
        self.close();
        let time = self.surfaces.time;
        if let Some(handed) = number.and_then(|n| self.surfaces.handed(n, time)) {
            handed.go_to(positions, time, within);
        }
        Ok(())
    }
}

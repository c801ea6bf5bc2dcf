//! Substeps in which nothing can come near: one pass over the positions tells, and nothing else is done.

use cloth_core::math::{Real, Vec3};
use cloth_core::method::parallel::wide;

/// Vertices whose mean displacement is taken for that of all.
const SAMPLES: usize = 16;

/// Where the cloth was when it was known that nothing is near, and how far it may go.
#[derive(Clone, Debug, Default)]
pub(super) struct CulledSubsteps {
    /// Positions (m); none while something may be near.
    place: Vec<Vec3>,
    /// How far (m) a vertex may go relative to the mean motion before the cloth touches itself; how far that and the
    /// mean motion may go, each, before it touches triangles of a body that rests; and how far a vertex may go at all.
    relative: [Real; 2],
    whole: Real,
    /// Whether the present substep began with nothing near.
    pub(super) is_on: bool,
}

impl CulledSubsteps {
    /// Nothing is near the cloth at `x` (m) as long as no vertex goes further than that (m).
    pub(super) fn begin(&mut self, x: &[Vec3], relative: [Real; 2], whole: Real) {
        x.clone_into(&mut self.place);
        (self.relative, self.whole) = (relative, whole);
    }

    /// From now on nothing is known. Returns whether something was.
    pub(super) fn end(&mut self) -> bool {
        self.is_on = false;
        let was_known = !self.place.is_empty();
        self.place.clear();
        was_known
    }

    /// Whether nothing is near at `x` (m), of which all but the first `moving` vertices are where they were. If so, all
    /// numbers of these are finite.
    pub(super) fn holds(&self, x: &[Vec3], moving: usize) -> bool {
        if self.place.is_empty() {
            return false;
        }
        let (x, place) = (&x[..moving], &self.place[..moving]);
        let every = place.len().div_ceil(SAMPLES);
        let samples = x.iter().zip(place).step_by(every);
        let shift = samples.map(|(x, place)| x - place).sum::<Vec3>();
        let shift = shift / place.len().div_ceil(every) as Real;
        let [own, bodies] = self.relative;
        // Relative to the mean motion, what rests moves the other way.
        if moving < self.place.len() && shift.norm() > bodies {
            return false;
        }
        let most = own.min(bodies).min(self.whole - shift.norm());
        let most = (most / Real::sqrt(3.0)).min(Real::MAX);
        wide(|| all_within(x, place, shift, most))
    }
}

/// Whether no coordinate of `x − place − shift` is larger than `most` (m).
#[inline(always)]
fn all_within(x: &[Vec3], place: &[Vec3], shift: Vec3, most: Real) -> bool {
    const LANES: usize = 4;
    let far = |(x, place): (&Vec3, &Vec3)| {
        let displacement = x - place - shift;
        // Not the other comparison: NaN compares false, and is not within.
        let within = (displacement.x.abs() <= most)
            & (displacement.y.abs() <= most)
            & (displacement.z.abs() <= most);
        !within
    };
    let (xs, places) = (x.chunks_exact(LANES), place.chunks_exact(LANES));
    let rest = xs.remainder().iter().zip(places.remainder());
    let mut any = rest.fold(false, |any, pair| any | far(pair));
    for (x, place) in xs.zip(places) {
        any |= x.iter().zip(place).fold(false, |any, pair| any | far(pair));
    }
    !any
}

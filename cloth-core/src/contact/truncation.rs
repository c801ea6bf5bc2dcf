//! Truncation of a displacement by contact that hardly strains the cloth.
//!
//! Where cloth lands, vertices that are stopped beside others that fly on stretch it to many times its energy, which a
//! minimisation takes long to lower. If all vertices were stopped together, one that touches would take the velocity of
//! the whole sheet. In between, the displacement fades towards what is stopped, no faster than a strain allows.
//!
//! H. Zhao, "A fast sweeping method for eikonal equations", Mathematics of Computation 74, 2005.

use super::{ContactError, ContactPotential, ContactStep};
use crate::math::{Real, Vec3};

/// Strain of an edge that a truncation may make (dimensionless).
const STRAIN: Real = 0.03;

/// The truncation, and its memory.
#[derive(Clone, Debug, Default)]
pub struct FadingTruncation {
    fractions: Vec<Real>,
    whole: Vec<Vec3>,
}

impl FadingTruncation {
    /// Begins a step with contact, and truncates the path to where its iteration starts (m), which each prescribed
    /// vertex reaches. `feasible` becomes the positions (m) free of crossings from where that was done.
    ///
    /// # Errors
    /// Those of [`ContactPotential::begin`] and [`ContactPotential::limit_each`].
    pub fn begin<N: IntoIterator<Item = usize>>(
        &mut self,
        contact: &mut dyn ContactPotential,
        step: &ContactStep<'_>,
        feasible: &mut [Vec3],
        start: &mut [Vec3],
        neighbours: impl Fn(usize) -> N,
    ) -> Result<(), ContactError> {
        for (v, x) in feasible.iter_mut().enumerate() {
            *x = match step.inverse_mass[v] == 0.0 {
                true => start[v],
                false => step.from[v],
            };
        }
        contact.begin(step, feasible)?;
        self.limit(contact, feasible, start, neighbours)
    }

    /// Truncates the displacements of vertices on their straight paths from `from` to `to` (m) until all paths
    /// together are safe, as [`limit_each`](ContactPotential::limit_each) does, but fading: what is taken of the paths
    /// of two neighbours is made to differ by at most 3 % of their distance. A vertex that is cut for that may be in
    /// the way of another, so `limit_each` is called a second time. What it cuts then is not faded any more: there two
    /// neighbours may differ by more. `neighbours(v)` are those of vertex v; of two neighbours it is enough if one has
    /// the other. Does not allocate after the first call.
    ///
    /// # Errors
    /// [`ContactError::NonFinite`].
    pub fn limit<N: IntoIterator<Item = usize>>(
        &mut self,
        contact: &mut dyn ContactPotential,
        from: &[Vec3],
        to: &mut [Vec3],
        neighbours: impl Fn(usize) -> N,
    ) -> Result<(), ContactError> {
        let Self { fractions, whole } = self;
        fractions.resize(from.len(), 1.0);
        whole.clear();
        whole.extend_from_slice(to);
        contact.limit_each(from, to, fractions)?;
        if fractions.iter().all(|&fraction| fraction == 1.0) {
            return Ok(());
        }
        fade(fractions, from, whole, neighbours);
        for (v, to) in to.iter_mut().enumerate() {
            // A displacement that is not truncated keeps all digits.
            *to = match fractions[v] < 1.0 {
                true => from[v] + (whole[v] - from[v]) * fractions[v],
                false => whole[v],
            };
        }
        contact.limit_each(from, to, fractions)
    }
}

/// Lowers the fractions of paths until what is taken of two neighbours' paths hardly differs. Sweeps in alternating
/// order carry a fraction as far as it reaches, so that few are needed.
fn fade<N: IntoIterator<Item = usize>>(
    fractions: &mut [Real],
    from: &[Vec3],
    to: &[Vec3],
    neighbours: impl Fn(usize) -> N,
) {
    let length = |v: usize| (to[v] - from[v]).norm();
    let count = fractions.len();
    let mut is_done = false;
    while !is_done {
        is_done = true;
        for v in (0..count).chain((0..count).rev()) {
            for u in neighbours(v) {
                let [a, b] = [fractions[v], fractions[u]];
                if a == b {
                    continue;
                }
                let longest = length(v).max(length(u));
                let most = a.min(b) + STRAIN * (from[v] - from[u]).norm() / longest;
                if a.max(b) > most {
                    (fractions[v], fractions[u]) = (a.min(most), b.min(most));
                    is_done = false;
                }
            }
        }
    }
}

//! Truncation of a displacement by contact that hardly strains the cloth.
//!
//! Where cloth lands, vertices that are stopped beside others that fly on stretch it to many times its energy, which a
//! minimisation takes long to lower. If all vertices were stopped together, one that touches would take the velocity of
//! the whole sheet. In between, the displacement fades towards what is stopped, no faster than a strain allows.
//!
//! A piece that flies has all of its displacement in common, but for a little. Its folds may be in contact with each
//! other, and what is stopped by that must not be left behind in space: so the common part comes first, for the whole
//! piece, and only what is left is truncated.
//!
//! H. Zhao, "A fast sweeping method for eikonal equations", Mathematics of Computation 74, 2005.

use super::{ContactError, ContactPotential, ContactStep};
use crate::math::{Real, Vec3};
use crate::topology::joined;

/// Strain of an edge that a truncation may make (dimensionless).
const STRAIN: Real = 0.03;
/// A piece flies if the squares of its displacements without their mean come to less than this fraction of themselves,
/// and those of its prescribed vertices, each by itself, to less than this fraction of that of the mean.
const BESIDES: Real = 0.05;

/// The truncation, and its memory.
#[derive(Clone, Debug, Default)]
pub struct FadingTruncation {
    fractions: Vec<Real>,
    whole: Vec<Vec3>,
    pieces: Pieces,
}

/// The connected parts of the cloth, each by one of its vertices, and their motions.
#[derive(Clone, Debug, Default)]
struct Pieces {
    roots: Vec<u32>,
    /// Whether all fly together, as one piece with the number 0.
    are_one: bool,
    flights: Vec<Flight>,
}

/// How a piece moves in a step.
#[derive(Clone, Copy, Debug, Default)]
struct Flight {
    count: Real,
    /// Sum of the displacements (m), and of their squares (m²).
    sum: Vec3,
    squares: Real,
    is_stopped: bool,
    is_held: bool,
}

impl Flight {
    fn mean(&self) -> Vec3 {
        self.sum / self.count
    }
}

impl Pieces {
    /// Finds the pieces, if there are not as many vertices as there were.
    fn find<N: IntoIterator<Item = usize>>(
        &mut self,
        count: usize,
        neighbours: impl Fn(usize) -> N,
    ) {
        if self.roots.len() == count {
            return;
        }
        let around = |v: usize| neighbours(v).into_iter().map(move |u| [v as u32, u as u32]);
        self.roots = joined(count, (0..count).flat_map(around));
    }

    /// Finds how the pieces move in a step that would end at `to` (m): together, or else each by itself.
    fn fly(&mut self, step: &ContactStep<'_>, to: &[Vec3]) {
        self.are_one = true;
        self.measure(step, to);
        if self.flights.first().is_some_and(|all| all.is_stopped) {
            self.are_one = false;
            self.measure(step, to);
        }
    }

    fn measure(&mut self, step: &ContactStep<'_>, to: &[Vec3]) {
        let mut flights = std::mem::take(&mut self.flights);
        flights.clear();
        flights.resize(self.roots.len(), Flight::default());
        let displacements = || step.from.iter().zip(to).map(|(from, to)| to - from);
        for (vertex, displacement) in displacements().enumerate() {
            let flight = &mut flights[self.number(vertex)];
            flight.count += 1.0;
            flight.sum += displacement;
            flight.squares += displacement.norm_squared();
        }
        let all = displacements().zip(step.inverse_mass).enumerate();
        for (vertex, (displacement, _)) in all.filter(|(_, (_, w))| **w == 0.0) {
            let flight = &mut flights[self.number(vertex)];
            let mean = flight.mean();
            let besides = (displacement - mean).norm_squared();
            flight.is_held = true;
            flight.is_stopped |= besides > BESIDES * mean.norm_squared();
        }
        for flight in flights.iter_mut().filter(|flight| flight.count > 0.0) {
            let common = flight.count * flight.mean().norm_squared();
            flight.is_stopped |= flight.squares - common > BESIDES * flight.squares;
        }
        self.flights = flights;
    }

    fn number(&self, vertex: usize) -> usize {
        match self.are_one {
            true => 0,
            false => self.roots[vertex] as usize,
        }
    }

    /// What the displacement (m) of a vertex has in common with those of its piece, if that flies: one that `is_held`
    /// by prescribed vertices, or one that is not.
    fn common(&self, vertex: usize, is_held: bool) -> Vec3 {
        let flight = &self.flights[self.number(vertex)];
        match flight.is_stopped || flight.is_held != is_held {
            true => Vec3::zeros(),
            false => flight.mean(),
        }
    }
}

impl FadingTruncation {
    /// Begins a step with contact, and truncates the path to where its iteration starts (m), which each prescribed
    /// vertex reaches. `feasible` becomes the positions (m) free of crossings from where that was done: those at the
    /// start of the step, or where pieces that fly have gone by then: with their prescribed vertices, or if nothing is
    /// in the way of any. `neighbours(v)` are those of vertex v; of two neighbours it is enough if one has the other.
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
        self.pieces.find(start.len(), &neighbours);
        self.pieces.fly(step, start);
        for (v, x) in feasible.iter_mut().enumerate() {
            *x = match step.inverse_mass[v] == 0.0 {
                true => start[v],
                false => step.from[v] + self.pieces.common(v, true),
            };
        }
        contact.begin(step, feasible)?;
        self.fly(contact, feasible)?;
        self.limit(contact, feasible, start, neighbours)
    }

    /// Takes the pieces that fly by themselves to where they go (m), if nothing is in the way. As far as something is
    /// would not do: it would press what touches.
    fn fly(
        &mut self,
        contact: &mut dyn ContactPotential,
        feasible: &mut [Vec3],
    ) -> Result<(), ContactError> {
        let Self { whole, pieces, .. } = self;
        whole.clear();
        let places = feasible.iter().enumerate();
        whole.extend(places.map(|(v, x)| x + pieces.common(v, false)));
        if *feasible != whole[..] && contact.limit(feasible, whole)? == 1.0 {
            feasible.copy_from_slice(whole);
        }
        Ok(())
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
        let Self {
            fractions, whole, ..
        } = self;
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

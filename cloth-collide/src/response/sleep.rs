//! Pairs that need no look until their vertices have come some way.

use cloth_core::math::{Real, Vec3};

/// More than the rounding of a way, of a sum of four, and of the difference of two such sums, each relative to its
/// size.
const ROUNDING: Real = 16.0 * Real::EPSILON;

/// How far the vertices have come, and how far those of each candidate have to come before it is looked at again.
///
/// If a plane has two pieces apart by d at both ends of a motion, and their four vertices then go ways whose sum is s, the plane still has them apart by d − s. So a pair with room to spare
/// sleeps until that sum, for its four vertices and both ends, has used up the room. Most candidates of a pile at rest sleep all the time.
///
/// Ways are rounded up and what is left of the room down, so that this holds however little room there is.
#[derive(Debug, Default)]
pub(super) struct Sleep {
    /// Length of the way (m) of each vertex since the candidates were found, without the shift of all of them, which brings nothing nearer to anything.
    travel: Vec<Real>,
    /// Sum of these ways (m) at which each candidate wakes up.
    wake: Vec<Real>,
}

impl Sleep {
    /// For so many vertices, and no candidates.
    pub(super) fn new(vertex_count: usize) -> Self {
        Self {
            travel: vec![0.0; vertex_count],
            wake: Vec::new(),
        }
    }

    /// New candidates, all of them awake.
    pub(super) fn reset(&mut self, candidates: usize) {
        self.travel.fill(0.0);
        self.wake.clear();
        self.wake.resize(candidates, 0.0);
    }

    /// The vertices have gone from positions `from` to positions `to` (m).
    pub(super) fn travelled(&mut self, from: &[Vec3], to: &[Vec3]) {
        let shift = mean(to) - mean(from);
        for (travel, (from, to)) in self.travel.iter_mut().zip(from.iter().zip(to)) {
            let way = to - from;
            *travel += (way - shift).norm() + ROUNDING * (way.norm() + shift.norm() + *travel);
        }
    }

    fn sum(&self, vertices: [u32; 4]) -> Real {
        let [a, b, c, d] = vertices.map(|v| self.travel[v as usize]);
        a + b + c + d
    }

    /// Whether candidate `index`, of these vertices, is awake.
    pub(super) fn is_over(&self, index: usize, vertices: [u32; 4]) -> bool {
        let sum = self.sum(vertices);
        sum >= self.wake[index] || sum.is_nan()
    }

    /// Lets candidate `index`, of these vertices, sleep until they have gone `room` (m).
    pub(super) fn send(&mut self, index: usize, vertices: [u32; 4], room: Real) {
        let sum = self.sum(vertices);
        self.wake[index] = sum + (room - ROUNDING * (sum + room));
    }
}

/// The mean of some positions (m).
pub(crate) fn mean(positions: &[Vec3]) -> Vec3 {
    positions.iter().sum::<Vec3>() / positions.len().max(1) as Real
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pair_wakes_up_when_its_ways_use_up_the_room() {
        let mut sleep = Sleep::new(5);
        sleep.reset(1);
        let pair = [0, 1, 2, 3];
        assert!(sleep.is_over(0, pair));
        sleep.send(0, pair, 0.1);
        assert!(!sleep.is_over(0, pair));
        let at = |x: Real| {
            [
                Vec3::zeros(),
                Vec3::x() * x,
                Vec3::zeros(),
                Vec3::zeros(),
                Vec3::x() * -x,
            ]
        };
        sleep.travelled(&at(0.0), &at(0.09));
        assert!(!sleep.is_over(0, pair));
        // There and back is a way too: it is not known where a pair was in between.
        sleep.travelled(&at(0.09), &at(0.07));
        assert!(sleep.is_over(0, pair));
    }

    #[test]
    fn common_shift_wakes_nobody_and_nonsense_everybody() {
        let mut sleep = Sleep::new(4);
        sleep.reset(1);
        sleep.send(0, [0, 1, 2, 3], 1e-9);
        let from = [Vec3::x(), Vec3::y(), Vec3::z(), Vec3::zeros()];
        sleep.travelled(&from, &from.map(|x| x + Vec3::new(1.0, 2.0, -3.0)));
        assert!(!sleep.is_over(0, [0, 1, 2, 3]));
        sleep.travelled(&from, &from.map(|x| x * Real::MAX));
        sleep.travelled(&from, &[Vec3::repeat(Real::MAX); 4]);
        assert!(sleep.is_over(0, [0, 1, 2, 3]));
    }
}

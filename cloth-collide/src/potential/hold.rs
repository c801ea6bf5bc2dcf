//! Paths so short that nothing is in reach.

use super::rows::KEPT;
use crate::pair::{Pair, nearest};
use cloth_core::contact::ContactStep;
use cloth_core::math::{Real, Vec3, gather};

/// Vertices that are held back.
///
/// Let b be the smallest distance at the start between a vertex's surroundings (its triangles and edges) and all other
/// pieces. If every vertex of a pair goes less than half of its b, then the two pieces cannot meet, whatever they do:
/// each point of them goes less than half of their distance. So a vertex that is held back needs no other vertex to
/// agree, apart from those of the pairs that it is in.
#[derive(Debug, Default)]
pub(super) struct Hold {
    /// How far each vertex may go (m).
    bounds: Vec<Real>,
    held: Vec<bool>,
}

impl Hold {
    /// Begins a step in which nobody is held back.
    pub(super) fn start(&mut self, step: &ContactStep<'_>) {
        self.held.clear();
        self.held.resize(step.from.len(), false);
        self.bounds.clear();
        self.bounds.resize(step.from.len(), Real::INFINITY);
    }

    /// Finds out how far the vertices of these pairs may go.
    pub(super) fn learn(&mut self, pairs: impl Iterator<Item = Pair>, step: &ContactStep<'_>) {
        for pair in pairs {
            let distance = nearest(pair.kind, &gather(step.from, pair.vertices)).distance;
            for v in pair.vertices {
                let bound = &mut self.bounds[v as usize];
                // Two such paths leave a little more than the share that has to be kept.
                *bound = bound.min(0.49 * (1.0 - KEPT) * distance);
            }
        }
    }

    /// Holds back the vertices of a pair. Returns how many were not held before, or not enough.
    pub(super) fn pair(
        &mut self,
        vertices: [u32; 4],
        step: &ContactStep<'_>,
        positions: &mut [Vec3],
    ) -> usize {
        let mut count = 0;
        for v in vertices.map(|v| v as usize) {
            let bound = self.bounds[v];
            let is_short = (positions[v] - step.from[v]).norm() <= bound;
            if step.inverse_mass[v] != 0.0 && !(self.held[v] && is_short) {
                self.shorten(v, bound, step, positions);
                count += 1;
            }
        }
        count
    }

    /// Leaves a vertex where it was. Returns how many were not there before: one or none.
    pub(super) fn stop(
        &mut self,
        vertex: u32,
        step: &ContactStep<'_>,
        positions: &mut [Vec3],
    ) -> usize {
        let v = vertex as usize;
        let moves = positions[v] != step.from[v];
        self.shorten(v, 0.0, step, positions);
        usize::from(moves)
    }

    /// Lets vertex `v` go no further than `bound` (m).
    fn shorten(&mut self, v: usize, bound: Real, step: &ContactStep<'_>, positions: &mut [Vec3]) {
        let displacement = positions[v] - step.from[v];
        let length = displacement.norm();
        if length > bound {
            let share = bound / length;
            positions[v] = step.from[v] + displacement * share;
            // Paths below the spacing of numbers are rounded up, for ever; none is not.
            if (positions[v] - step.from[v]).norm() > bound {
                positions[v] = step.from[v];
            }
        }
        self.held[v] = true;
    }

    /// Number of vertices held back.
    pub(super) fn count(&self) -> usize {
        self.held.iter().filter(|&&held| held).count()
    }
}

#[cfg(test)]
mod tests {
    use super::super::last_resort::pairs;
    use super::*;
    use crate::SeparationProbe;
    use crate::broad_phase::{ClothCandidates, Hierarchy};
    use crate::random::Random;
    use cloth_core::mesh::TriMesh;
    use cloth_core::mesh::generate::{Diagonals, grid};

    /// Pieces nearer to each other than the spacing of their coordinates: there is no path short enough but none, and
    /// that ends the search.
    #[test]
    fn what_all_but_touches_stays_where_it_is() {
        let corners = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)];
        let at = |z: Real| corners.map(|(x, y)| Vec3::new(1.0 + x, 1.0 + y, z));
        let from = [at(1.0), at(1.0 + Real::EPSILON)].concat();
        let rest = [at(1.0), at(1.1)].concat();
        let mesh = TriMesh::new(rest, vec![[0, 1, 2], [3, 4, 5]]).unwrap();
        let mut to: Vec<_> = from.iter().map(|x| x + Vec3::new(0.3, 0.1, 0.2)).collect();
        let mut cloth = ClothCandidates::new(&mesh, Hierarchy::new());
        cloth.update(&from, &to, 0.0).unwrap();
        let mut hold = Hold::default();
        let step = ContactStep {
            from: &from,
            inverse_mass: &[1.0; 6],
            dt: 1.0,
        };
        hold.start(&step);
        hold.learn(pairs(Some(&cloth)), &step);
        let mut hold_all = || -> usize {
            let all = pairs(Some(&cloth)).map(|pair| pair.vertices);
            all.map(|pair| hold.pair(pair, &step, &mut to)).sum()
        };
        assert_eq!(hold_all(), 6);
        assert_eq!(hold_all(), 0);
        assert_eq!(to, from);
    }

    /// A crumpled sheet whose vertices would all fly through each other.
    #[test]
    fn what_is_held_back_crosses_nothing() {
        let sheet = grid(7, 7, 0.6, 0.6, Diagonals::Alternating).unwrap();
        for seed in 0..20 {
            let mut random = Random::new(seed);
            let crumple = |x: &Vec3| {
                Vec3::new(
                    (9.0 * x.x).sin() * (0.05 + x.x),
                    x.y,
                    (9.0 * x.x).cos() * (0.05 + x.x),
                )
            };
            let from: Vec<_> = sheet.positions().iter().map(crumple).collect();
            let mesh = TriMesh::new(from.clone(), sheet.triangles().to_vec()).unwrap();
            let mut probe = SeparationProbe::new(&mesh);
            assert_eq!(probe.measure(&from).unwrap().intersecting_pairs, 0);
            let mut to: Vec<_> = from.iter().map(|x| x + random.point(1.0)).collect();
            let mut cloth = ClothCandidates::new(&mesh, Hierarchy::new());
            cloth.update(&from, &to, 0.0).unwrap();
            let mut hold = Hold::default();
            let inverse_mass = vec![1.0; from.len()];
            let step = ContactStep {
                from: &from,
                inverse_mass: &inverse_mass,
                dt: 1.0,
            };
            hold.start(&step);
            hold.learn(pairs(Some(&cloth)), &step);
            for pair in pairs(Some(&cloth)) {
                hold.pair(pair.vertices, &step, &mut to);
            }
            assert_eq!(hold.count(), from.len());
            for tenths in 1..=10 {
                let part = f64::from(tenths) / 10.0;
                let between = from.iter().zip(&to).map(|(a, b)| a.lerp(b, part));
                let found = probe.measure(&between.collect::<Vec<_>>()).unwrap();
                assert_eq!(found.intersecting_pairs, 0, "seed {seed}, {part}");
            }
        }
    }
}

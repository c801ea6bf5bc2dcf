//! Impact zones: parts of the cloth that move as rigid bodies for one step.
//!
//! With the masses m, positions x and velocities u of the vertices of a zone, M = Σ m, the centre c = Σ m x/M, the
//! momentum P = Σ m u, the angular momentum L = Σ m (x − c) × u, and the inertia I = Σ m (‖x − c‖² 1 − (x − c)(x −
//! c)ᵀ), all move with v = P/M and ω = I⁻¹ L, which keeps P and L: u ← v + ω × (x − c). On a path from x₀, u is the
//! displacement x − x₀, and x ← c₀ + v + R(ω) (x₀ − c₀), with the rotation R by the vector ω.

use cloth_core::math::{Mat3, Real, Vec3};
use cloth_core::topology::DisjointSets;
use nalgebra::Rotation3;

/// No zone turns further than this in a step (rad). On the straight paths of its vertices distances inside it shrink by
/// the cosine of half of it.
const MOST_TURN: Real = 1.0;

/// The zones of one step.
#[derive(Clone, Debug, Default)]
pub(super) struct Zones {
    sets: DisjointSets,
    member: Vec<bool>,
    /// (zone, vertex), in rising order, once sorted.
    members: Vec<[u32; 2]>,
}

impl Zones {
    pub(super) fn reset(&mut self, vertex_count: usize) {
        self.sets.reset(vertex_count);
        self.member.clear();
        self.member.resize(vertex_count, false);
        self.members.clear();
    }

    /// Puts the four vertices of a pair, and the zones that they are in, into one zone. Returns whether they were not
    /// in one before.
    pub(super) fn join(&mut self, vertices: [u32; 4]) -> bool {
        let mut joined = false;
        for v in vertices {
            joined |= self.sets.root(v) != self.sets.root(vertices[0]);
            self.sets.join(vertices[0], v);
            self.member[v as usize] = true;
        }
        joined
    }

    /// Lists the members, zone by zone.
    pub(super) fn sort(&mut self) {
        self.members.clear();
        let inside = (0..self.member.len() as u32).filter(|&v| self.member[v as usize]);
        let named = inside.map(|v| [self.sets.root(v), v]);
        self.members.extend(named);
        self.members.sort_unstable();
    }

    /// The vertices of each zone, as pairs (zone, vertex).
    pub(super) fn each(&self) -> impl Iterator<Item = &[[u32; 2]]> {
        self.members.chunk_by(|a, b| a[0] == b[0])
    }
}

/// How a zone moves: the rigid motion with the momentum and the angular momentum that the vertices have, or if some of
/// them are prescribed, with those of the prescribed ones alone, for unit masses.
#[derive(Clone, Copy, Debug)]
struct Rigid {
    /// A place in the zone (m), and the centre seen from there: far from the origin of space their sum would be
    /// rounded, and a fast turn would give that momentum.
    place: Vec3,
    centre: Vec3,
    shift: Vec3,
    turn: Vec3,
}

impl Rigid {
    fn arm(&self, x: Vec3) -> Vec3 {
        x - self.place - self.centre
    }
}

/// Fits a rigid motion to the `displacements` (m or m/s) of the vertices at `places` (m).
fn rigid(
    zone: &[[u32; 2]],
    places: &[Vec3],
    displacement: &[Vec3],
    inverse_mass: &[Real],
) -> Rigid {
    let prescribed = zone.iter().any(|&[_, v]| inverse_mass[v as usize] == 0.0);
    let weighted = || {
        zone.iter().filter_map(move |&[_, v]| {
            let w = inverse_mass[v as usize];
            match prescribed {
                true => (w == 0.0).then_some((v as usize, 1.0)),
                false => Some((v as usize, 1.0 / w)),
            }
        })
    };
    let mean = |of: &dyn Fn(usize) -> Vec3| {
        let (sum, mass) = weighted().fold((Vec3::zeros(), 0.0), |(sum, mass), (v, m)| {
            (sum + of(v) * m, mass + m)
        });
        sum / mass
    };
    let place = places[zone[0][1] as usize];
    let mut motion = Rigid {
        place,
        centre: mean(&|v| places[v] - place),
        shift: mean(&|v| displacement[v]),
        turn: Vec3::zeros(),
    };
    let (mut momentum, mut inertia) = (Vec3::zeros(), Mat3::zeros());
    for (v, m) in weighted() {
        let arm = motion.arm(places[v]);
        momentum += arm.cross(&(displacement[v] - motion.shift)) * m;
        inertia += (Mat3::from_diagonal_element(arm.norm_squared()) - arm * arm.transpose()) * m;
    }
    motion.turn = divided(momentum, inertia);
    motion
}

/// I⁻¹ L, without turns about an axis that has no inertia.
fn divided(momentum: Vec3, inertia: Mat3) -> Vec3 {
    let eigen = inertia.symmetric_eigen();
    let smallest = 1e-9 * eigen.eigenvalues.amax();
    let mut turn = Vec3::zeros();
    for (axis, &value) in eigen.eigenvectors.column_iter().zip(&eigen.eigenvalues) {
        if value > smallest {
            turn += axis * (axis.dot(&momentum) / value);
        }
    }
    turn
}

/// Moves the free vertices of a zone from `from` as one body instead of to `positions` (m), keeping momentum and
/// angular momentum.
pub(super) fn move_rigidly(
    zone: &[[u32; 2]],
    from: &[Vec3],
    positions: &mut [Vec3],
    displacements: &mut [Vec3],
    inverse_mass: &[Real],
) {
    for &[_, v] in zone {
        displacements[v as usize] = positions[v as usize] - from[v as usize];
    }
    let motion = rigid(zone, from, displacements, inverse_mass);
    let turn = motion.turn * (MOST_TURN / motion.turn.norm().max(MOST_TURN));
    let rotation = Rotation3::new(turn);
    for &[_, v] in zone {
        let v = v as usize;
        if inverse_mass[v] != 0.0 {
            positions[v] =
                motion.place + (motion.centre + motion.shift) + rotation * motion.arm(from[v]);
        }
    }
}

/// Gives the free vertices of a zone the velocities (m/s) of one body, keeping momentum and angular momentum about its
/// place at `positions` (m).
pub(super) fn make_velocities_rigid(
    zone: &[[u32; 2]],
    positions: &[Vec3],
    velocities: &mut [Vec3],
    inverse_mass: &[Real],
) {
    let motion = rigid(zone, positions, velocities, inverse_mass);
    for &[_, v] in zone {
        let v = v as usize;
        if inverse_mass[v] != 0.0 {
            velocities[v] = motion.shift + motion.turn.cross(&motion.arm(positions[v]));
        }
    }
}

#[cfg(test)]
#[path = "../../tests/unit/potential_zones.rs"]
mod tests;

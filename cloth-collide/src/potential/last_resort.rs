//! The last resort, for a motion that the sweeps have found and that is not safe. It has three stages, and tests
//! everything again in each round of each:
//!
//! 1. *Pushes*, up to 40 rounds. Every pair that comes nearer than a tenth of its distance at the start, or of the
//!    thickness if that is less, is a *hit*, and is pushed to half of it, one after the other.
//! 2. *Impact zones*, up to 20 rounds. The vertices of pairs that still come too near become one rigid body, with their
//!    momentum and angular momentum, since inside a rigid body nothing can meet; zones that meet are joined. Vertices
//!    that get into a body are moved out of it, with their zones. A zone turns by at most 1 rad on its path; where its
//!    angular momentum says more, the velocities have it and the places do not.
//! 3. *Truncation.* Where prescribed vertices or bodies do not let zones be rigid, vertices stay where they were. Each
//!    round stops at least one more of the finitely many, or the step is refused, so the rounds end.
//!
//! So a step is safe or refused, whatever the two numbers of rounds: they are limits on the cost, as each round
//! searches the whole cloth. A push goes on from layer to layer by one a round, since the next pair is a hit only in
//! the detection after it: 40 rounds go through a stack of about as many layers.
//!
//! Why a push ends at half. Let d be the distance at the start. A pair that was pushed to d/10, where the test begins,
//! would be a hit again as soon as a neighbour is pushed towards it by anything. One that was pushed to d would have
//! its gap as before, so the second layer would move as far as the first, and so on through the stack. At d/2
//! neighbours may take back 0.4 d before the pair is a hit again, and each gap has taken up d/2 of the motion.
//!
//! What a push does to the energy. It adds Δx/Δt to velocities, so they stay (x − x₀)/Δt. With the points of the pair
//! a₀ apart along n at the start, its speed along n rises from s to s′ = (d/2 − a₀)/Δt, and the kinetic energy changes
//! by (s′² − s²)/(2K), K = Σ c_k²/m_k (`rebound` has why). Where n does not turn, a₀ ≥ d (or h, whose half it is pushed
//! to if that is less): so s < s′ < 0, and energy is lost. A pair that turns or slides on its path may have a₀ < d/2,
//! and then gain up to s′²/(2K). Elastic energy is not looked at.
//!
//! Bridson et al. 2002 (see the [chapter](super#references)) take three stages after each step: repulsions, impulses,
//! rigid impact zones (Provot 1997, see the [crate](crate#references)). Here the potential in the solve takes the place
//! of repulsions; pushes and zones run only where it was not enough.
//!
//! # Bodies
//!
//! A vertex that starts at the signed distance f > 0 of a body keeps f/10, or h/10 if that is less, but for a tolerance
//! of h/100, and never ends inside. One that starts inside may end deeper by h/100 in each substep that the last resort
//! ends.

use super::bodies::Substep;
use super::constraints::KEPT;
use super::near::Near;
use super::zones::{Zones, make_velocities_rigid, move_rigidly};
use crate::bounds::mean;
use crate::broad_phase::{ClothCandidates, OfKind};
use crate::ccd::Query;
use crate::obstacle::{Obstacle, VertexPath, first_contact};
use crate::pair::{Gap, Pair, ends, weighted};
use cloth_core::contact::{ContactError, ContactStep};
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::TriMesh;

/// Rounds in which pairs are pushed apart one by one.
const PUSHES: u32 = 40;
/// Rounds of growing zones, at most, before paths are truncated.
const MOST_ROUNDS: u32 = 20;

/// What brings a substep to an end when nothing else does.
#[derive(Clone, Debug, Default)]
pub(super) struct LastResort {
    /// None if there are no pairs that can touch.
    pub(super) mesh: Option<TriMesh>,
    /// Made when first needed.
    candidates: Option<ClothCandidates<OfKind>>,
    zones: Zones,
    /// Pairs that pass through each other, or come too near.
    hits: Vec<Hit>,
    /// Vertices that get into a body, its number, and what moves them out (m).
    entering: Vec<([u32; 2], Vec3)>,
    /// Where no feasible path was found: vertices of the cloth, and bodies that block it.
    pub(super) blocked: Vec<[u32; 2]>,
    /// Where vertices would go without zones (m), and their displacements.
    free: Vec<Vec3>,
    displacements: Vec<Vec3>,
}

/// A pair that comes too near on its path.
#[derive(Clone, Copy, Debug)]
struct Hit {
    pair: Pair,
    /// When (0..=1).
    time: Real,
    /// What it pushes to (m): half of the distance at the start, or of the thickness; the module has why.
    distance: Real,
}

impl Hit {
    /// Pushes the two primitives apart, along the line between their nearest points where they come too near; both
    /// positions (m) and velocities (m/s).
    fn push(&self, step: &ContactStep<'_>, x: &mut [Vec3], v: &mut [Vec3]) {
        let path = Query::of(self.pair, step.from, x);
        let near = Gap::new(path.kind, &path.at(self.time));
        let ends = || ends(self.pair.vertices, near.weights);
        let inverse_effective_mass: Real = ends().map(|(v, w)| w * w * step.inverse_mass[v]).sum();
        let point = weighted(self.pair.vertices, near.weights, x);
        let missing = self.distance - near.normal.dot(&point);
        if missing <= 0.0 || inverse_effective_mass == 0.0 {
            return;
        }
        for (vertex, weight) in ends() {
            let displacement = near.normal
                * (missing / inverse_effective_mass * weight * step.inverse_mass[vertex]);
            x[vertex] += displacement;
            v[vertex] += displacement / step.dt;
        }
    }
}

impl LastResort {
    /// Changes the end `x` (m) of a step, with the velocities `v` (m/s) there, until the straight paths from
    /// `step.from` are safe. Returns the number of vertices whose path was truncated for it: they have not gone as far
    /// as contact would let them, and have lost momentum.
    ///
    /// # Errors
    /// [`ContactError::Infeasible`], [`ContactError::NonFinite`]; `x` and `v` are of no use then.
    pub(super) fn resolve(
        &mut self,
        substep: &Substep<'_>,
        x: &mut [Vec3],
        v: &mut [Vec3],
    ) -> Result<usize, ContactError> {
        let step = &substep.step;
        self.displacements.resize(x.len(), Vec3::zeros());
        for _ in 0..PUSHES {
            if self.detect(substep, x)? {
                break;
            }
            self.hits.iter().for_each(|hit| hit.push(step, x, v));
        }
        self.zones.reset(x.len());
        x.clone_into(&mut self.free);
        for _ in 0..MOST_ROUNDS {
            self.detect(substep, x)?;
            let zones = &mut self.zones;
            let joined = self
                .hits
                .iter()
                .filter(|hit| zones.join(hit.pair.vertices))
                .count();
            zones.sort();
            if joined == 0 && self.entering.is_empty() {
                break;
            }
            for &([vertex, _], out) in &self.entering {
                let zone = zones
                    .each()
                    .find(|zone| zone.iter().any(|m| m[1] == vertex));
                let alone = [[0, vertex]];
                for &[_, member] in zone.unwrap_or(&alone) {
                    if step.inverse_mass[member as usize] != 0.0 {
                        self.free[member as usize] += out;
                        v[member as usize] += out / step.dt;
                    }
                }
            }
            x.copy_from_slice(&self.free);
            for zone in zones.each() {
                move_rigidly(
                    zone,
                    step.from,
                    x,
                    &mut self.displacements,
                    step.inverse_mass,
                );
            }
        }
        for zone in self.zones.each() {
            make_velocities_rigid(zone, x, v, step.inverse_mass);
        }
        let truncated = match self.detect(substep, x)? {
            true => 0,
            false => self.truncate(substep, x, v)?,
        };
        let numbers = x.iter().zip(v.iter());
        let mut finite =
            numbers.map(|(x, v)| cloth_core::math::is_finite(x) && cloth_core::math::is_finite(v));
        if let Some(vertex) = finite.position(|is| !is) {
            return Err(ContactError::NonFinite { vertex });
        }
        Ok(truncated)
    }

    /// Leaves vertices where they were until nothing passes through anything. Returns how many.
    fn truncate(
        &mut self,
        substep: &Substep<'_>,
        x: &mut [Vec3],
        v: &mut [Vec3],
    ) -> Result<usize, ContactError> {
        let step = &substep.step;
        self.free.copy_from_slice(x);
        loop {
            let pairs = self.hits.iter().flat_map(|hit| hit.pair.vertices);
            let entering = self.entering.iter().map(|([vertex, _], _)| *vertex);
            // The vertices of bodies have the last numbers.
            let (mut first, mut is_stopped) = (u32::MAX, false);
            for vertex in pairs.chain(entering) {
                first = first.min(vertex);
                let vertex = vertex as usize;
                if step.inverse_mass[vertex] != 0.0 && x[vertex] != step.from[vertex] {
                    x[vertex] = step.from[vertex];
                    is_stopped = true;
                }
            }
            if !is_stopped {
                self.find_blocked(substep);
                let own = self.blocked.iter().find(|[vertex, _]| *vertex == first);
                let blocked = own.or(self.blocked.first());
                return Err(ContactError::Infeasible {
                    vertex: first,
                    is_prescribed: step.inverse_mass[first as usize] == 0.0,
                    body: blocked.map(|[_, body]| *body as usize),
                });
            }
            if self.detect(substep, x)? {
                break;
            }
        }
        let mut truncated = 0;
        for ((v, x), free) in v.iter_mut().zip(x).zip(&self.free) {
            truncated += usize::from(x != free);
            *v += (*x - free) / step.dt;
        }
        Ok(truncated)
    }

    /// Tells which bodies block what.
    fn find_blocked(&mut self, substep: &Substep<'_>) {
        let near = substep.near;
        self.blocked.clear();
        for hit in &self.hits {
            let vertices = hit.pair.vertices;
            let body = vertices.iter().find_map(|&v| near.body_of(v));
            let own = vertices.iter().filter(|&&v| near.body_of(v).is_none());
            let pairs = body.map(|body| own.map(move |&v| [v, body as u32]));
            self.blocked.extend(pairs.into_iter().flatten());
        }
        let entering = self.entering.iter().map(|(pair, _)| *pair);
        self.blocked.extend(entering);
    }

    /// Finds what is not safe on the path to `x` (m). Returns whether all is.
    fn detect(&mut self, substep: &Substep<'_>, x: &[Vec3]) -> Result<bool, ContactError> {
        let Substep { near, bodies, step } = substep;
        self.hits.clear();
        if let Some(mesh) = &self.mesh {
            let new = || ClothCandidates::new(mesh, OfKind::new(near.own.broad_phase));
            let candidates = self.candidates.get_or_insert_with(new);
            // The mean motion brings nothing nearer to anything.
            let shift = mean(x) - mean(step.from);
            for (end, x) in self.displacements.iter_mut().zip(x) {
                *end = x - shift;
            }
            // Everything is finite, but a box around it need not be.
            candidates.search(step.from, &self.displacements, near.law.range())?;
            let all = candidates.pairs().filter(|pair| near.meets(pair.vertices));
            self.hits
                .extend(all.filter_map(|pair| hit(pair, near, step, x)));
        }
        self.entering.clear();
        for (vertex, (&from, &to)) in (0u32..).zip(step.from.iter().zip(x)) {
            if step.inverse_mass[vertex as usize] != 0.0 {
                for (number, (body, _)) in bodies.iter().enumerate() {
                    let v = vertex as usize;
                    if !near.pinched.passes(v, number)
                        && let Some(out) =
                            displacement_out(body, near.law_at(v).range(), [from, to], step.dt)
                    {
                        self.entering.push(([vertex, number as u32], out));
                    }
                }
            }
        }
        Ok(self.hits.is_empty() && self.entering.is_empty())
    }
}

/// What moves a vertex (m) out of a body that it comes too near to on its path between two `ends` (m) in `dt` (s): to
/// the thickness from the tangent plane where they meet, moved on with the body. None where it keeps a tenth of its
/// distance (or of the thickness, if that is less) up to a hundredth of the thickness, and at least 0; or its depth, up
/// to the same, if it starts inside.
fn displacement_out(body: &Obstacle, thickness: Real, ends: [Vec3; 2], dt: Real) -> Option<Vec3> {
    let start = body.signed_distance(ends[0], 0.0).value;
    let spared = 1e-2 * thickness;
    let depth = if start > 0.0 {
        (KEPT * start.min(thickness) - spared).max(0.0)
    } else {
        start - spared
    };
    let path = VertexPath::straight(ends[0], ends[1], dt);
    first_contact(body, &path, 0.0, dt, depth)?;
    let hit = first_contact(body, &path, 0.0, dt, thickness);
    let (time, at, position) = match hit {
        Some(hit) if hit.time < dt => (hit.time, hit.distance, path.position(hit.time)),
        _ => (dt, body.signed_distance(ends[1], dt), ends[1]),
    };
    let velocity = body.motion().velocity_at(position, time);
    let surface = position - at.normal * at.value + velocity * (dt - time);
    let offset = at.normal.dot(&surface) + thickness;
    let missing = offset - at.normal.dot(&ends[1]);
    Some(at.normal * missing.max(0.0))
}

/// When a pair comes nearer on its path to `x` (m) than the fraction of its distance, or of the thickness if that is
/// less, that a step has to keep.
fn hit(pair: Pair, near: &Near, step: &ContactStep<'_>, x: &[Vec3]) -> Option<Hit> {
    let path = Query::of(pair, step.from, x);
    let start = Gap::new(pair.kind, &path.from);
    let distance = start.distance.min(near.thickness_between(pair.vertices));
    let kept = KEPT * distance;
    if path.is_shift(start.distance) || path.is_apart_along(&start.normal, kept) {
        return None;
    }
    Some(Hit {
        pair,
        time: path.time_at(kept)?,
        distance: 0.5 * distance,
    })
}

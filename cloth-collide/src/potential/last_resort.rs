//! The last resort: impact zones, then paths so short that nothing is in reach.
//!
//! What sweeps have not brought to an end in which nothing passes through anything comes here, with the motion that
//! they have found. Vertices that get into a body are moved out of it. Vertices of pairs that go through each other
//! become one rigid body (an impact zone), with their momentum and angular momentum, since inside a rigid body nothing
//! can meet; zones that meet are joined. Where prescribed vertices or bodies do not let zones be rigid, vertices are
//! held back. Everything is tested again after each change, so a step is free or refused.
//!
//! - X. Provot, Collision and self-collision handling in cloth model dedicated to design garments, *Computer Animation
//!   and Simulation* 1997. DOI 10.1007/978-3-7091-6874-5_13
//! - R. Bridson, R. Fedkiw and J. Anderson, Robust treatment of collisions, contact and friction for cloth animation,
//!   SIGGRAPH 2002. DOI 10.1145/566570.566623
//! - L. Wu, B. Wu, Y. Yang and H. Wang, A safe and fast repulsion method for GPU-based cloth self collisions, *ACM
//!   Transactions on Graphics* 40(1), 2020: paths bounded by half of the distance.

use super::hold::Hold;
use super::near::Near;
use super::rows::KEPT;
use super::zones::{Zones, make_velocities_rigid, move_rigidly};
use crate::bounds::mean;
use crate::broad_phase::{BroadPhase, ClothCandidates};
use crate::ccd::QueryKind;
use crate::obstacle::{BodyWork, ObstacleContacts, VertexPath, first_contact};
use crate::pair::{Motion, Pair, apart_along, first_contact as first_contact_of_pair, nearest};
use cloth_core::contact::{ContactError, ContactStep};
use cloth_core::math::{Real, Vec3, gather};
use cloth_core::mesh::TriMesh;

/// Rounds in which pairs are pushed apart one by one.
const PUSHES: u32 = 40;
/// Rounds of growing zones, at most, before vertices are held back.
const MOST_ROUNDS: u32 = 20;

/// What brings a substep to an end when nothing else does.
#[derive(Debug)]
pub(super) struct LastResort {
    thickness: Real,
    /// None if there are no pairs that can touch.
    mesh: Option<TriMesh>,
    /// Made when first needed.
    candidates: Option<ClothCandidates<Box<dyn BroadPhase>>>,
    zones: Zones,
    hold: Hold,
    /// Pairs that pass through each other, or come too near.
    hits: Vec<Hit>,
    /// Vertices that get into a body, and what moves them out (m).
    entering: Vec<(u32, Vec3)>,
    /// Where vertices would go without zones (m), and their displacements.
    free: Vec<Vec3>,
    displacements: Vec<Vec3>,
    work: BodyWork,
}

/// A pair that comes too near.
#[derive(Clone, Copy, Debug)]
struct Hit {
    pair: Pair,
    /// When (0..=1).
    time: Real,
    /// What it pushes to (m).
    distance: Real,
}

impl Hit {
    /// Pushes the two pieces apart, along the line between their nearest points where they come too near; both
    /// positions (m) and velocities (m/s).
    fn push(&self, step: &ContactStep<'_>, x: &mut [Vec3], v: &mut [Vec3]) {
        let Pair { kind, vertices } = self.pair;
        let [from, to] = [step.from, &*x].map(|x| gather(x, vertices));
        let near = nearest(kind, &Motion { from, to }.at(self.time));
        let ends = || vertices.iter().map(|&v| v as usize).zip(near.weights);
        let ease: Real = ends().map(|(v, w)| w * w * step.inverse_mass[v]).sum();
        let point: Vec3 = ends().map(|(v, w)| x[v] * w).sum();
        let missing = self.distance - near.normal.dot(&point);
        if missing <= 0.0 || ease == 0.0 {
            return;
        }
        for (vertex, weight) in ends() {
            let displacement = near.normal * (missing / ease * weight * step.inverse_mass[vertex]);
            x[vertex] += displacement;
            v[vertex] += displacement / step.dt;
        }
    }
}

impl LastResort {
    pub(super) fn new(mesh: &TriMesh, thickness: Real, has_pairs: bool) -> Self {
        Self {
            thickness,
            mesh: has_pairs.then(|| mesh.clone()),
            candidates: None,
            zones: Zones::default(),
            hold: Hold::default(),
            hits: Vec::new(),
            entering: Vec::new(),
            free: Vec::new(),
            displacements: Vec::new(),
            work: BodyWork::default(),
        }
    }

    /// Changes the end `x` (m) of a step, with the velocities `v` (m/s) there, until the straight paths from
    /// `step.from` are free. Returns the number of vertices that were held back for it: safe, but behind where contact
    /// should let them go, and with less momentum.
    ///
    /// # Errors
    /// [`ContactError::Infeasible`], [`ContactError::NonFinite`]; `x` and `v` are of no use then.
    pub(super) fn resolve(
        &mut self,
        near: &Near,
        bodies: Option<&ObstacleContacts>,
        step: &ContactStep<'_>,
        x: &mut [Vec3],
        v: &mut [Vec3],
    ) -> Result<usize, ContactError> {
        self.work.begin(bodies, v);
        self.displacements.resize(x.len(), Vec3::zeros());
        for _ in 0..PUSHES {
            self.look(near, bodies, step, x)?;
            if self.is_free() {
                break;
            }
            self.hits.iter().for_each(|hit| hit.push(step, x, v));
        }
        self.zones.reset(x.len());
        self.free.clear();
        self.free.extend_from_slice(x);
        for _ in 0..MOST_ROUNDS {
            self.look(near, bodies, step, x)?;
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
            for &(vertex, out) in &self.entering {
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
        self.look(near, bodies, step, x)?;
        let held = if self.is_free() {
            0
        } else {
            self.hold_back(near, bodies, step, x, v)?
        };
        let numbers = x.iter().zip(v.iter());
        let mut finite =
            numbers.map(|(x, v)| cloth_core::math::is_finite(x) && cloth_core::math::is_finite(v));
        if let Some(vertex) = finite.position(|is| !is) {
            return Err(ContactError::NonFinite { vertex });
        }
        self.work.end(bodies, step, x, v);
        Ok(held)
    }

    /// Work (J) that moving bodies did in the last step that was resolved.
    pub(super) fn work(&self) -> Real {
        self.work.work()
    }

    fn is_free(&self) -> bool {
        self.hits.is_empty() && self.entering.is_empty()
    }

    /// Holds vertices back until nothing passes through anything. Returns how many.
    fn hold_back(
        &mut self,
        near: &Near,
        bodies: Option<&ObstacleContacts>,
        step: &ContactStep<'_>,
        x: &mut [Vec3],
        v: &mut [Vec3],
    ) -> Result<usize, ContactError> {
        self.free.copy_from_slice(x);
        self.hold.start(step);
        while !self.is_free() {
            let all = pairs(self.candidates.as_ref());
            self.hold
                .learn(all.filter(|pair| near.meets(pair.vertices)), step);
            let mut vertex = 0;
            let mut newly_held = 0;
            for hit in &self.hits {
                // The vertices of bodies have the last numbers.
                vertex = hit.pair.vertices.into_iter().min().unwrap_or_default();
                newly_held += self.hold.pair(hit.pair.vertices, step, x);
            }
            for &(entering, _) in &self.entering {
                vertex = entering;
                newly_held += self.hold.stop(vertex, step, x);
            }
            if newly_held == 0 {
                return Err(ContactError::Infeasible { vertex });
            }
            self.look(near, bodies, step, x)?;
        }
        for ((v, x), free) in v.iter_mut().zip(x).zip(&self.free) {
            *v += (*x - free) / step.dt;
        }
        Ok(self.hold.count())
    }

    /// Finds what is not free on the path to `x` (m).
    fn look(
        &mut self,
        near: &Near,
        bodies: Option<&ObstacleContacts>,
        step: &ContactStep<'_>,
        x: &[Vec3],
    ) -> Result<(), ContactError> {
        self.hits.clear();
        if let Some(mesh) = &self.mesh {
            let new = || ClothCandidates::new(mesh, near.broad_phase.create());
            let candidates = self.candidates.get_or_insert_with(new);
            // What all vertices do together brings nothing nearer to anything.
            let shift = mean(x) - mean(step.from);
            for (end, x) in self.displacements.iter_mut().zip(x) {
                *end = x - shift;
            }
            // Everything is finite, but a box around it need not be.
            let found = candidates.update(step.from, &self.displacements, self.thickness);
            found.map_err(|_| ContactError::NonFinite { vertex: 0 })?;
            let thickness = self.thickness;
            let all = pairs(self.candidates.as_ref());
            let all = all.filter(|pair| near.meets(pair.vertices));
            self.hits
                .extend(all.filter_map(|pair| hit(pair, thickness, step, x)));
        }
        self.entering.clear();
        let Some(bodies) = bodies else {
            return Ok(());
        };
        for (vertex, (&from, &to)) in (0u32..).zip(step.from.iter().zip(x)) {
            if step.inverse_mass[vertex as usize] == 0.0 {
                continue;
            }
            for number in 0..bodies.pairs().len() {
                // Only where it can come near at all.
                let Some(contact) = bodies.contact_of(number, vertex, [from, to], step.dt) else {
                    continue;
                };
                if self.enters(bodies, number, [from, to], step.dt) {
                    let missing = contact.offset - contact.normal.dot(&to);
                    self.entering
                        .push((vertex, contact.normal * missing.max(0.0)));
                }
            }
        }
        Ok(())
    }

    /// Whether a vertex on its path between two `ends` (m) in `dt` (s) gets inside a body, or deeper inside if it was
    /// there before, by more than a hundredth of the thickness.
    fn enters(&self, bodies: &ObstacleContacts, number: usize, ends: [Vec3; 2], dt: Real) -> bool {
        let body = &bodies.pairs()[number].0;
        let start = body.signed_distance(ends[0], 0.0).value;
        let kept = if start > 0.0 {
            KEPT * start.min(bodies.thickness())
        } else {
            start
        };
        let path = VertexPath::straight(ends[0], ends[1], dt);
        let depth = kept - 1e-2 * self.thickness;
        first_contact(body, &path, 0.0, dt, depth).is_some()
    }
}

/// The candidates, as pairs.
pub(super) fn pairs<B: BroadPhase>(
    candidates: Option<&ClothCandidates<B>>,
) -> impl Iterator<Item = Pair> + '_ {
    candidates.into_iter().flat_map(|candidates| {
        let corners = |t: u32| candidates.triangles()[t as usize];
        let ends = |e: u32| candidates.edges()[e as usize];
        let vertex_triangle = candidates.vertex_triangle().iter().map(move |&[v, t]| {
            let [a, b, c] = corners(t);
            (QueryKind::VertexTriangle, [v, a, b, c])
        });
        let edge_edge = candidates.edge_edge().iter().map(move |&[e, f]| {
            let ([a, b], [c, d]) = (ends(e), ends(f));
            (QueryKind::EdgeEdge, [a, b, c, d])
        });
        let both = vertex_triangle.chain(edge_edge);
        both.map(|(kind, vertices)| Pair { kind, vertices })
    })
}

/// When a pair comes nearer on its path to `x` (m) than the share of its distance, or of the thickness if that is less,
/// that a step has to keep.
fn hit(pair: Pair, thickness: Real, step: &ContactStep<'_>, x: &[Vec3]) -> Option<Hit> {
    let motion = Motion {
        from: gather(step.from, pair.vertices),
        to: gather(x, pair.vertices),
    };
    let start = nearest(pair.kind, &motion.from);
    let distance = start.distance.min(thickness);
    let kept = KEPT * distance;
    if motion.is_shift(start.distance) || apart_along(pair.kind, &start.normal, &motion, kept) {
        return None;
    }
    let time = first_contact_of_pair(pair.kind, &motion, kept)?;
    Some(Hit {
        pair,
        time,
        distance: 0.5 * distance,
    })
}

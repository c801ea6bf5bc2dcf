//! Which contacts does a motion make, and is it free?

use super::memory::Memory;
use super::pair::{Motion, Nearest, Pair, apart_along, first_contact, nearest};
use super::row::{Row, RowMaker};
use super::{KEPT, NEAR, RECOVERY};
use crate::ccd::QueryKind;
use crate::obstacle::{ObstacleContacts, VertexPath, first_contact as first_obstacle_contact};
use crate::{ClothCandidates, Hierarchy};
use cloth_core::math::{Real, Vec3, gather};
use cloth_core::mesh::TriMesh;

/// The cloth and who is near whom in it.
#[derive(Debug)]
pub(super) struct Cloth {
    pub(super) candidates: ClothCandidates<Hierarchy>,
    rest: Vec<Vec3>,
    /// The piece that each vertex belongs to.
    piece: Vec<u32>,
    /// What is known of each candidate.
    known: Vec<Known>,
    /// Distance that is worked towards (m).
    thickness: Real,
    pub(super) continuous_tests: u64,
}

/// What is known of a candidate from looking at it before.
#[derive(Clone, Copy, Debug, Default)]
struct Known {
    /// Whether the nearest points at the start have their row already.
    has_row: bool,
    /// The last direction between the nearest points: a plane across it may still have the pieces apart, whatever they do.
    normal: Vec3,
    /// The distance (m) that is worked towards, if it has been asked for.
    thickness: Option<Real>,
}

impl Cloth {
    pub(super) fn new(mesh: &TriMesh, thickness: Real) -> Self {
        Self {
            candidates: ClothCandidates::new(mesh, Hierarchy::new()),
            rest: mesh.positions().to_vec(),
            piece: pieces(mesh),
            known: Vec::new(),
            thickness,
            continuous_tests: 0,
        }
    }

    /// Takes all candidates for unseen: there are new ones.
    pub(super) fn forget(&mut self) {
        self.known.clear();
        self.known.resize(self.len(), Known::default());
    }

    /// Takes all candidates to have no row: a step begins.
    pub(super) fn forget_rows(&mut self) {
        for known in &mut self.known {
            known.has_row = false;
        }
    }

    /// Number of candidates.
    pub(super) fn len(&self) -> usize {
        self.candidates.vertex_triangle().len() + self.candidates.edge_edge().len()
    }

    /// Candidate `index`: those of a vertex and a triangle come first.
    pub(super) fn pair(&self, index: usize) -> Pair {
        let vertex_triangle = self.candidates.vertex_triangle();
        if let Some(&[v, t]) = vertex_triangle.get(index) {
            let [a, b, c] = self.candidates.triangles()[t as usize];
            return Pair {
                kind: QueryKind::VertexTriangle,
                vertices: [v, a, b, c],
            };
        }
        let [e, f] = self.candidates.edge_edge()[index - vertex_triangle.len()];
        let [a, b] = self.candidates.edges()[e as usize];
        let [c, d] = self.candidates.edges()[f as usize];
        Pair {
            kind: QueryKind::EdgeEdge,
            vertices: [a, b, c, d],
        }
    }

    /// The distance (m) that is worked towards for candidate `index`: the thickness, or for two parts of one piece their distance at rest if that is less. So what is
    /// finer than the thickness is not pushed away from its rest.
    fn thickness_of(&mut self, index: usize, pair: &Pair) -> Real {
        if let Some(thickness) = self.known[index].thickness {
            return thickness;
        }
        let [a, .., d] = pair.vertices.map(|v| self.piece[v as usize]);
        let thickness = if a == d {
            let rest = nearest(pair.kind, &gather(&self.rest, pair.vertices));
            rest.distance.min(self.thickness)
        } else {
            self.thickness
        };
        self.known[index].thickness = Some(thickness);
        thickness
    }

    /// Looks at candidate `index`: hands its contact, if it needs one, to `add`. Returns whether the pair may pass through each other or come too near.
    pub(super) fn examine(
        &mut self,
        index: usize,
        look: &Look<'_>,
        mut add: impl FnMut(Row),
    ) -> bool {
        let pair = self.pair(index);
        let motion = Motion {
            from: gather(look.make.from, pair.vertices),
            to: gather(look.to, pair.vertices),
        };
        let clear = NEAR * self.thickness;
        if apart_along(pair.kind, &self.known[index].normal, &motion, clear) {
            return false;
        }
        let start = nearest(pair.kind, &motion.from);
        self.known[index].normal = start.normal;
        if apart_along(pair.kind, &start.normal, &motion, clear) {
            return false;
        }
        if start.distance > self.thickness && motion.is_shift(start.distance) {
            return false;
        }
        let thickness = self.thickness_of(index, &pair);
        let cloth = |at: &Nearest, offset| look.make.cloth(pair.vertices, at, offset);
        let reach = if start.is_at_boundary() { 1.0 } else { NEAR };
        let verdict = if start.distance <= reach * thickness {
            if self.known[index].has_row {
                Verdict::Satisfied
            } else {
                let missing = (thickness - start.distance).max(0.0);
                let offset = thickness - (1.0 - RECOVERY) * missing;
                let mut row = cloth(&start, offset);
                if let Some(row) = &mut row {
                    row.key = Some(self.key(index));
                }
                // A boundary that only passes by at a distance is no obstacle.
                let passes_by = || nearest(pair.kind, &motion.to).distance >= offset;
                let verdict = match look.judge(row, &mut add) {
                    Verdict::Postponed if !look.first && passes_by() => Verdict::Satisfied,
                    Verdict::Postponed if !look.first => look.insist(row, &mut add),
                    verdict => verdict,
                };
                self.known[index].has_row = verdict == Verdict::Added;
                verdict
            }
        } else {
            self.continuous_tests += 1;
            let Some(time) = first_contact(pair.kind, &motion, thickness) else {
                return false;
            };
            let at = nearest(pair.kind, &motion.at(time));
            look.judge_or_insist(cloth(&at, thickness), &mut add)
        };
        if verdict != Verdict::Satisfied && !look.certify {
            return true;
        }
        let Some(time) = self.hit(index, &pair, &motion, &start) else {
            return false;
        };
        if verdict == Verdict::Satisfied {
            let at = nearest(pair.kind, &motion.at(time));
            let offset = at.distance + RECOVERY * (thickness - at.distance).max(0.0);
            look.judge_or_insist(cloth(&at, offset), &mut add);
        }
        true
    }

    /// What contact `index` is remembered by. Numbers of vertices, edges and triangles have 31 bits at most.
    fn key(&self, index: usize) -> u64 {
        let vertex_triangle = self.candidates.vertex_triangle();
        let (kind, [a, b]) = match vertex_triangle.get(index) {
            Some(&pair) => (0, pair),
            None => (
                1,
                self.candidates.edge_edge()[index - vertex_triangle.len()],
            ),
        };
        kind << 62 | u64::from(a) << 31 | u64::from(b)
    }

    /// When the pair, nearest at `start` first, comes nearer than the share of that distance, or of the thickness if it is less, that a step has to keep.
    fn hit(&mut self, index: usize, pair: &Pair, motion: &Motion, start: &Nearest) -> Option<Real> {
        let kept = |thickness: Real| KEPT * start.distance.min(thickness);
        if motion.is_shift(start.distance)
            || apart_along(pair.kind, &start.normal, motion, kept(self.thickness))
        {
            return None;
        }
        self.continuous_tests += 1;
        let kept = kept(self.thickness_of(index, pair));
        first_contact(pair.kind, motion, kept)
    }

    /// Whether candidate `index` may pass through each other, or come too near, on the way to `to` (m).
    pub(super) fn hits(&mut self, index: usize, from: &[Vec3], to: &[Vec3]) -> bool {
        let pair = self.pair(index);
        let motion = Motion {
            from: gather(from, pair.vertices),
            to: gather(to, pair.vertices),
        };
        let start = nearest(pair.kind, &motion.from);
        self.hit(index, &pair, &motion, &start).is_some()
    }
}

/// A number for each vertex, the same for those that are connected.
fn pieces(mesh: &TriMesh) -> Vec<u32> {
    let mut sets = super::sets::Sets::default();
    sets.reset(mesh.vertex_count());
    for &[a, b, c] in mesh.triangles() {
        sets.join(a, b);
        sets.join(b, c);
    }
    (0..mesh.vertex_count() as u32)
        .map(|v| sets.of(v))
        .collect()
}

/// What a look at a motion is made with.
#[derive(Clone, Copy, Debug)]
pub(super) struct Look<'a> {
    pub(super) make: RowMaker<'a>,
    /// Where the motion ends (m).
    pub(super) to: &'a [Vec3],
    /// By how much (m) a contact may be violated.
    pub(super) tolerance: Real,
    /// Contacts of the last step.
    pub(super) memory: &'a Memory,
    /// Whether this is the first look of the step: contacts of the last one are taken over, and those with the boundary of a triangle or the end of an edge are left for later. Most
    /// boundaries have a neighbour that is the better one to push, and would only get in the way of what slides over them.
    pub(super) first: bool,
    /// Whether it matters if a pair with a violated contact only comes too near, or passes through.
    pub(super) certify: bool,
}

/// What becomes of a possible contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Verdict {
    /// Not violated.
    Satisfied,
    /// It is violated and has a row now, or it had a row and pushed in the last step.
    Added,
    /// It is violated, but with a boundary.
    Postponed,
}

impl Look<'_> {
    /// Hands a row to `add` if it is violated, or if its contact pushed in the last step.
    fn judge(&self, row: Option<Row>, add: &mut impl FnMut(Row)) -> Verdict {
        let Some(row) = row else {
            return Verdict::Satisfied;
        };
        let recalled = self
            .memory
            .recall(&row, self.make.dt)
            .filter(|_| self.first);
        if recalled.is_none() && row.excess(self.to) >= -self.tolerance {
            return Verdict::Satisfied;
        }
        if recalled.is_none() && row.is_at_boundary {
            return Verdict::Postponed;
        }
        add(recalled.unwrap_or(row));
        Verdict::Added
    }

    /// The same for a row that is known to be violated.
    fn insist(&self, row: Option<Row>, add: &mut impl FnMut(Row)) -> Verdict {
        if let Some(row) = row {
            add(row);
        }
        Verdict::Added
    }

    /// Postpones contacts with a boundary at the first look only.
    fn judge_or_insist(&self, row: Option<Row>, add: &mut impl FnMut(Row)) -> Verdict {
        match self.judge(row, add) {
            Verdict::Postponed if !self.first => self.insist(row, add),
            verdict => verdict,
        }
    }

    /// What a vertex does to obstacle `number`: hands the row that keeps it out, if it needs one, to `add`, and returns whether it gets inside.
    pub(super) fn obstacle(
        &self,
        obstacles: &ObstacleContacts,
        number: usize,
        vertex: u32,
        mut add: impl FnMut(Row),
    ) -> bool {
        let way = [self.make.from, self.to].map(|x| x[vertex as usize]);
        let Some(contact) = obstacles.contact_of(number, vertex, way, self.make.dt) else {
            return false;
        };
        let law = &obstacles.pairs()[number].1;
        let mut row = self.make.obstacle(&contact, law.restitution());
        if let Some(row) = &mut row {
            row.key = Some(2 << 62 | u64::from(vertex) << 31 | number as u64);
        }
        let verdict = self.judge(row, &mut add);
        verdict != Verdict::Satisfied && !self.certify || self.enters(obstacles, number, way)
    }

    /// Whether a vertex on its `way` (m) gets inside an obstacle, or deeper inside if it was there before, by more than the tolerance.
    fn enters(&self, obstacles: &ObstacleContacts, number: usize, way: [Vec3; 2]) -> bool {
        let obstacle = &obstacles.pairs()[number].0;
        let start = obstacle.clearance(way[0], 0.0).value;
        let kept = if start > 0.0 {
            KEPT * start.min(obstacles.thickness())
        } else {
            start
        };
        let path = VertexPath::straight(way[0], way[1], self.make.dt);
        first_obstacle_contact(obstacle, &path, 0.0, self.make.dt, kept - self.tolerance).is_some()
    }
}

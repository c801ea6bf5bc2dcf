//! Which contacts does a motion make, and is it free?

use super::pair::{Motion, Nearest, Pair, apart_along, first_contact, nearest};
use super::row::{Row, RowMaker};
use super::{KEPT, NEAR, RECOVERY};
use crate::ccd::QueryKind;
use crate::obstacle::{ObstacleContacts, VertexPath, first_contact as first_obstacle_contact};
use crate::{ClothCandidates, Hierarchy};
use cloth_core::contact::ContactStep;
use cloth_core::math::{Real, Vec3, gather};
use cloth_core::mesh::TriMesh;

/// The cloth and who is near whom in it.
#[derive(Debug)]
pub(super) struct Cloth {
    pub(super) candidates: ClothCandidates<Hierarchy>,
    rest: Vec<Vec3>,
    /// The piece that each vertex belongs to.
    piece: Vec<u32>,
    /// Whether the nearest points of a candidate at the start have their row already.
    has_row: Vec<bool>,
    /// Distance that is worked towards (m).
    thickness: Real,
    pub(super) continuous_tests: u64,
}

impl Cloth {
    pub(super) fn new(mesh: &TriMesh, thickness: Real) -> Self {
        Self {
            candidates: ClothCandidates::new(mesh, Hierarchy::new()),
            rest: mesh.positions().to_vec(),
            piece: pieces(mesh),
            has_row: Vec::new(),
            thickness,
            continuous_tests: 0,
        }
    }

    /// Takes all candidates for unseen.
    pub(super) fn forget_rows(&mut self) {
        self.has_row.clear();
        self.has_row.resize(self.len(), false);
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

    /// The distance (m) that is worked towards for a pair: the thickness, or for two parts of one piece their distance at rest if that is less. So what is
    /// finer than the thickness is not pushed away from its rest.
    fn thickness_of(&self, pair: &Pair) -> Real {
        let [a, .., d] = pair.vertices.map(|v| self.piece[v as usize]);
        if a != d {
            return self.thickness;
        }
        let rest = nearest(pair.kind, &gather(&self.rest, pair.vertices));
        rest.distance.min(self.thickness)
    }

    /// Looks at candidate `index` on the way to `to` (m): hands its contact, if it needs one, to `add`. Returns whether the pair may pass through each other or come too near.
    pub(super) fn examine(
        &mut self,
        index: usize,
        make: &RowMaker<'_>,
        to: &[Vec3],
        tolerance: Real,
        mut add: impl FnMut(Row),
    ) -> bool {
        let pair = self.pair(index);
        let motion = Motion {
            from: gather(make.from, pair.vertices),
            to: gather(to, pair.vertices),
        };
        let start = nearest(pair.kind, &motion.from);
        if apart_along(pair.kind, &start.normal, &motion, NEAR * self.thickness) {
            return false;
        }
        if motion.is_shift() && start.distance > self.thickness {
            return false;
        }
        let thickness = self.thickness_of(&pair);
        let mut keep = |row: Option<Row>| match row {
            Some(row) if row.excess(to) < -tolerance => {
                add(row);
                true
            }
            _ => false,
        };
        let mut found = false;
        if start.distance <= NEAR * thickness {
            if !self.has_row[index] {
                let missing = (thickness - start.distance).max(0.0);
                let offset = thickness - (1.0 - RECOVERY) * missing;
                found = keep(make.cloth(pair.vertices, &start, offset));
                self.has_row[index] = found;
            }
        } else {
            self.continuous_tests += 1;
            let Some(time) = first_contact(pair.kind, &motion, thickness) else {
                return false;
            };
            let at = nearest(pair.kind, &motion.at(time));
            found = keep(make.cloth(pair.vertices, &at, thickness));
        }
        let Some(time) = self.hit(&pair, &motion, &start) else {
            return false;
        };
        if !found {
            let at = nearest(pair.kind, &motion.at(time));
            let offset = at.distance + RECOVERY * (thickness - at.distance).max(0.0);
            keep(make.cloth(pair.vertices, &at, offset));
        }
        true
    }

    /// When the pair, nearest at `start` first, comes nearer than the share of that distance, or of the thickness if it is less, that a step has to keep.
    fn hit(&mut self, pair: &Pair, motion: &Motion, start: &Nearest) -> Option<Real> {
        let kept = |thickness: Real| KEPT * start.distance.min(thickness);
        if motion.is_shift() || apart_along(pair.kind, &start.normal, motion, kept(self.thickness))
        {
            return None;
        }
        self.continuous_tests += 1;
        first_contact(pair.kind, motion, kept(self.thickness_of(pair)))
    }

    /// Whether candidate `index` may pass through each other, or come too near, on the way to `to` (m).
    pub(super) fn hits(&mut self, index: usize, from: &[Vec3], to: &[Vec3]) -> bool {
        let pair = self.pair(index);
        let motion = Motion {
            from: gather(from, pair.vertices),
            to: gather(to, pair.vertices),
        };
        let start = nearest(pair.kind, &motion.from);
        self.hit(&pair, &motion, &start).is_some()
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

/// What a vertex does to obstacle `number` on its way to `to` (m): the row that keeps it out, if it needs one, and whether it gets inside.
pub(super) fn examine_obstacle(
    obstacles: &ObstacleContacts,
    number: usize,
    vertex: u32,
    make: &RowMaker<'_>,
    to: &[Vec3],
    tolerance: Real,
) -> (Option<Row>, bool) {
    let way = [make.from, to].map(|x| x[vertex as usize]);
    let Some(contact) = obstacles.contact_of(number, vertex, way, make.dt) else {
        return (None, false);
    };
    let law = &obstacles.pairs()[number].1;
    let row = make
        .obstacle(&contact, law.restitution())
        .filter(|row| row.excess(to) < -tolerance);
    let step = ContactStep {
        from: make.from,
        inverse_mass: make.inverse_mass,
        dt: make.dt,
    };
    (row, enters(obstacles, number, vertex, &step, to, tolerance))
}

/// Whether a vertex on its way to `to` (m) gets inside an obstacle, or deeper inside if it was there before, by more than the tolerance (m).
pub(super) fn enters(
    obstacles: &ObstacleContacts,
    number: usize,
    vertex: u32,
    step: &ContactStep<'_>,
    to: &[Vec3],
    tolerance: Real,
) -> bool {
    let [from, to] = [step.from, to].map(|x| x[vertex as usize]);
    let obstacle = &obstacles.pairs()[number].0;
    let start = obstacle.clearance(from, 0.0).value;
    let kept = if start > 0.0 {
        KEPT * start.min(obstacles.thickness())
    } else {
        start
    };
    let path = VertexPath::straight(from, to, step.dt);
    first_obstacle_contact(obstacle, &path, 0.0, step.dt, kept - tolerance).is_some()
}

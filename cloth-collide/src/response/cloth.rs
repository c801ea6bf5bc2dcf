//! The cloth, its candidates and what is known of them.

use super::pair::{Pair, nearest};
use super::row::Row;
use super::sleep::{Sleep, mean};
use crate::broad_phase::{ClothCandidates, Hierarchy};
use crate::ccd::QueryKind;
use crate::error::CollideError;
use crate::incidence::pieces;
use cloth_core::math::{Real, Vec3, gather};
use cloth_core::mesh::TriMesh;

/// The cloth and who is near whom in it.
#[derive(Debug)]
pub(super) struct Cloth {
    pub(super) candidates: ClothCandidates<Hierarchy>,
    rest: Vec<Vec3>,
    /// The piece that each vertex belongs to.
    piece: Vec<u32>,
    /// The vertices of each candidate.
    vertices: Vec<[u32; 4]>,
    /// What is known of each candidate.
    pub(super) known: Vec<Known>,
    pub(super) sleep: Sleep,
    /// Where the motion ends (m), without what all vertices do together.
    ends: Vec<Vec3>,
    /// The mean (m) of all positions when the candidates were found.
    middle: Vec3,
    /// Number of the step, from 1.
    pub(super) step: u32,
    /// Distance that is worked towards (m).
    pub(super) thickness: Real,
    pub(super) continuous_tests: u64,
}

/// What is known of a candidate from looking at it before.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Known {
    /// The step in which the nearest points at the start last had a row.
    pub(super) row_step: u32,
    /// The last direction between the nearest points: a plane across it may still have the pieces apart, whatever they do.
    pub(super) normal: Vec3,
    /// The distance (m) that is worked towards, if it has been asked for.
    thickness: Option<Real>,
}

impl Cloth {
    pub(super) fn new(mesh: &TriMesh, thickness: Real) -> Self {
        Self {
            candidates: ClothCandidates::new(mesh, Hierarchy::new()),
            rest: mesh.positions().to_vec(),
            piece: pieces(mesh),
            vertices: Vec::new(),
            known: Vec::new(),
            sleep: Sleep::new(mesh.vertex_count()),
            ends: Vec::new(),
            middle: Vec3::zeros(),
            step: 0,
            thickness,
            continuous_tests: 0,
        }
    }

    /// Finds the candidates of the motion from `from` to `to` (m), all of them unseen. What all vertices do together is left out: it brings nothing nearer to anything.
    pub(super) fn search(
        &mut self,
        from: &[Vec3],
        to: &[Vec3],
        margin: Real,
    ) -> Result<(), CollideError> {
        let middle = mean(from);
        let shift = mean(to) - middle;
        self.ends.clear();
        self.ends.extend(to.iter().map(|x| x - shift));
        self.candidates.update(from, &self.ends, margin)?;
        self.middle = middle;
        self.forget();
        Ok(())
    }

    /// Whether a vertex may have come so far from where it was expected that there are pairs that nobody has looked for. What all vertices do together makes none.
    pub(super) fn strayed(&self, positions: &[Vec3]) -> bool {
        // Half of the margin is around the box, half of the thickness is needed there.
        let slack = Vec3::repeat(0.5 * self.thickness);
        let shift = mean(positions) - self.middle;
        let boxes = self.candidates.vertex_boxes().iter().zip(positions);
        boxes.into_iter().any(|(bounds, x)| {
            let x = x - shift;
            let inside = x - slack >= bounds.lower && x + slack <= bounds.upper;
            !inside
        })
    }

    fn forget(&mut self) {
        let Self {
            candidates,
            vertices,
            ..
        } = self;
        vertices.clear();
        let corners = |t: u32| candidates.triangles()[t as usize];
        vertices.extend(candidates.vertex_triangle().iter().map(|&[v, t]| {
            let [a, b, c] = corners(t);
            [v, a, b, c]
        }));
        let ends = |e: u32| candidates.edges()[e as usize];
        vertices.extend(candidates.edge_edge().iter().map(|&[e, f]| {
            let ([a, b], [c, d]) = (ends(e), ends(f));
            [a, b, c, d]
        }));
        self.known.clear();
        self.known.resize(self.len(), Known::default());
        self.sleep.reset(self.len());
    }

    /// Takes all candidates to have no row: a step begins.
    pub(super) fn forget_rows(&mut self) {
        self.step = self.step.wrapping_add(1);
        if self.step == 0 {
            // Steps of long ago have had the same numbers.
            self.forget();
            self.step = 1;
        }
    }

    /// The cloth has gone from positions `from` to positions `to` (m).
    pub(super) fn travelled(&mut self, from: &[Vec3], to: &[Vec3]) {
        self.sleep.travelled(from, to);
    }

    /// Number of candidates.
    pub(super) fn len(&self) -> usize {
        self.candidates.vertex_triangle().len() + self.candidates.edge_edge().len()
    }

    /// Candidate `index`: those of a vertex and a triangle come first.
    pub(super) fn pair(&self, index: usize) -> Pair {
        let kind = if index < self.candidates.vertex_triangle().len() {
            QueryKind::VertexTriangle
        } else {
            QueryKind::EdgeEdge
        };
        Pair {
            kind,
            vertices: self.vertices[index],
        }
    }

    /// Whether candidate `index` has to be looked at: one of its vertices has `moved`, and they have come far enough.
    pub(super) fn is_due(&self, index: usize, moved: &[bool]) -> bool {
        let vertices = self.vertices[index];
        self.sleep.is_over(index, vertices) && vertices.iter().any(|&v| moved[v as usize])
    }

    /// The distance (m) that is worked towards for candidate `index`: the thickness, or for two parts of one piece their distance at rest if that is less. So what is
    /// finer than the thickness is not pushed away from its rest.
    pub(super) fn thickness_of(&mut self, index: usize, pair: &Pair) -> Real {
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

    /// The candidate that is remembered by `key`, the other way round; nothing for a contact with an obstacle.
    fn index_of(&self, key: u64) -> Option<usize> {
        const NUMBER: u64 = (1 << 31) - 1;
        let pair = [(key >> 31 & NUMBER) as u32, (key & NUMBER) as u32];
        let vertex_triangle = self.candidates.vertex_triangle();
        match key >> 62 {
            0 => vertex_triangle.binary_search(&pair).ok(),
            1 => {
                let place = self.candidates.edge_edge().binary_search(&pair).ok()?;
                Some(vertex_triangle.len() + place)
            }
            _ => None,
        }
    }

    /// Marks the candidates that have one of the `rows` of this step, which were found among other candidates.
    pub(super) fn recognise(&mut self, rows: &[Row]) {
        for key in rows.iter().filter_map(|row| row.key) {
            if let Some(index) = self.index_of(key) {
                self.known[index].row_step = self.step;
            }
        }
    }

    /// What contact `index` is remembered by. Numbers of vertices, edges and triangles have 31 bits at most.
    pub(super) fn key(&self, index: usize) -> u64 {
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
}

//! What the parts of a cloth stand for in contact: areas, laws, and who is free.

use super::mollifier::Mollifier;
use crate::broad_phase::{ClothCandidates, Hierarchy};
use crate::error::CollideError;
use crate::incidence::{edge_numbers, pieces};
use crate::obstacle::PenaltyLaw;
use cloth_core::math::{Real, Vec3, gather};
use cloth_core::mesh::TriMesh;

/// Areas, laws and freedom of the parts of a cloth.
#[derive(Debug)]
pub(super) struct Near {
    law: PenaltyLaw,
    /// A third of the rest area of the triangles around each vertex, and around each edge (m²).
    pub(super) vertex_area: Vec<Real>,
    pub(super) edge_area: Vec<Real>,
    rest: Vec<Vec3>,
    /// The connected piece that each vertex belongs to.
    pub(super) piece: Vec<u32>,
    pub(super) is_free: Vec<bool>,
    /// Prescribed vertices that have not been seen to move: nothing is looked for between them.
    resting: Vec<u32>,
    pub(super) is_resting: Vec<bool>,
    /// None if the cloth cannot touch itself.
    candidates: Option<ClothCandidates<Hierarchy>>,
}

impl Near {
    pub(super) fn new(mesh: &TriMesh, law: PenaltyLaw, self_collision: bool) -> Self {
        let (edges, triangle_edges) = edge_numbers(mesh.triangles());
        let mut vertex_area = vec![0.0; mesh.vertex_count()];
        let mut edge_area = vec![0.0; edges.len()];
        let around = mesh.triangles().iter().zip(&triangle_edges);
        for ((corners, edges), area) in around.zip(mesh.areas()) {
            for (vertex, edge) in corners.iter().zip(edges) {
                vertex_area[*vertex as usize] += area / 3.0;
                edge_area[*edge as usize] += area / 3.0;
            }
        }
        Self {
            law,
            vertex_area,
            edge_area,
            rest: mesh.positions().to_vec(),
            piece: pieces(mesh),
            is_free: vec![true; mesh.vertex_count()],
            resting: Vec::new(),
            is_resting: vec![false; mesh.vertex_count()],
            candidates: self_collision.then(|| ClothCandidates::new(mesh, Hierarchy::new())),
        }
    }

    /// Takes over which vertices are prescribed, by their inverse masses (1/kg), and tells whether they were others before.
    pub(super) fn begin(&mut self, inverse_mass: &[Real]) -> bool {
        let mut changed = false;
        for (free, w) in self.is_free.iter_mut().zip(inverse_mass) {
            changed |= std::mem::replace(free, *w > 0.0) != *free;
        }
        if changed {
            let held = (0u32..).zip(&self.is_free).filter(|(_, free)| !**free);
            self.resting.clear();
            self.resting.extend(held.map(|(vertex, _)| vertex));
            let held = self.is_resting.iter_mut().zip(&self.is_free);
            held.for_each(|(resting, free)| *resting = !free);
        }
        changed
    }

    /// Takes notice of prescribed vertices that begin to move, from `from` to `to` (m). Returns whether there are any: what was found without them is not all.
    pub(super) fn sets_out(&mut self, from: &[Vec3], to: &[Vec3]) -> bool {
        let count = self.resting.len();
        let is_resting = &mut self.is_resting;
        self.resting.retain(|&vertex| {
            let v = vertex as usize;
            is_resting[v] = from[v] == to[v];
            is_resting[v]
        });
        self.resting.len() < count
    }

    pub(super) fn law(&self) -> PenaltyLaw {
        self.law
    }

    /// m of two edges.
    pub(super) fn mollifier(&self, vertices: [u32; 4]) -> Mollifier {
        let [a, b, c, d] = gather(&self.rest, vertices);
        Mollifier::new([(b - a).norm_squared(), (d - c).norm_squared()])
    }

    /// The same at `x` (m).
    pub(super) fn mollified(&self, vertices: [u32; 4], x: &[Vec3; 4]) -> Real {
        self.mollifier(vertices).at(x).value
    }

    /// Finds all candidates of a cloth that rests at `x` (m).
    pub(super) fn find_all(&mut self, x: &[Vec3]) -> Result<(), CollideError> {
        let h = self.law.range();
        let candidates = self.candidates.as_mut();
        candidates.map_or(Ok(()), |candidates| candidates.update(x, x, h))
    }

    /// How many pairs of near triangles `meet` at `x` (m), the place of the last search.
    pub(super) fn crossing(
        &self,
        x: &[Vec3],
        meet: impl Fn([[u32; 3]; 2], &[Vec3]) -> bool,
    ) -> usize {
        let crossing = self.candidates.iter().flat_map(|candidates| {
            let triangles = candidates.triangles();
            let pairs = candidates.triangle_pairs().iter();
            pairs.filter(|pair| meet(pair.map(|t| triangles[t as usize]), x))
        });
        crossing.count()
    }

    /// The law of a pair: for two parts of one piece it begins no farther than they are apart at rest, so that nothing is pushed away from its
    /// rest.
    pub(super) fn law_of(
        &self,
        vertices: [u32; 4],
        distance: impl Fn(&[Vec3; 4]) -> Real,
    ) -> PenaltyLaw {
        let [a, .., d] = vertices.map(|v| self.piece[v as usize]);
        if a != d {
            return self.law;
        }
        let rest = distance(&gather(&self.rest, vertices));
        if rest >= self.law.range() || rest <= 0.0 {
            self.law
        } else {
            self.law.with_range(rest)
        }
    }
}

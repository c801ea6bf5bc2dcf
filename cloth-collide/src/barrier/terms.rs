//! All barriers that act on a cloth: which pairs have one, their energy, and its derivatives.

use crate::broad_phase::{ClothCandidates, Hierarchy};
use crate::incidence::edge_numbers;
use crate::obstacle::{Obstacle, PenaltyLaw};
use crate::potential::Gap;
use crate::potential::Mollifier;
use crate::potential::{EdgeEdgeContact, VertexTriangleContact};
use cloth_core::element::{Convexity, Element, Energy};
use cloth_core::math::{Blocks, Mat3, Real, Vec3, gather};
use cloth_core::mesh::TriMesh;

/// The obstacles at one moment.
#[derive(Clone, Copy, Debug)]
pub(super) struct Surroundings<'a> {
    pub(super) obstacles: &'a [Obstacle],
    /// When (s), on their own clocks.
    pub(super) time: Real,
}

/// The barrier of one vertex against one obstacle, linearised in the motion of both.
#[derive(Clone, Copy, Debug)]
pub(super) struct Touch {
    pub(super) vertex: u32,
    /// A b″ ∂φ ∂φᵀ (N/m).
    pub(super) hessian: Mat3,
    /// Velocity of the surface there (m/s).
    pub(super) surface_velocity: Vec3,
}

/// Barriers of all pairs in reach, and what they are made from.
#[derive(Debug)]
pub(super) struct Terms {
    law: PenaltyLaw,
    /// Distance φ at which an obstacle begins (m).
    thickness: Real,
    /// A third of the rest area of the triangles around each vertex, and around each edge (m²).
    vertex_area: Vec<Real>,
    edge_area: Vec<Real>,
    /// Whether obstacles push a vertex: prescribed ones may be anywhere.
    is_free: Vec<bool>,
    /// Squared rest length of each edge (m²).
    edge_squared: Vec<Real>,
    vertex_triangle: Vec<VertexTriangleContact>,
    edge_edge: Vec<EdgeEdgeContact>,
    /// Hessians (N/m) of the pairs that act at the last [`Terms::linearise`].
    pub(super) pairs: Vec<([u32; 4], Blocks<4>)>,
    pub(super) touches: Vec<Touch>,
}

impl Terms {
    pub(super) fn new(mesh: &TriMesh, law: PenaltyLaw, thickness: Real) -> Self {
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
        let squared = |&ends: &[u32; 2]| {
            let [a, b] = gather(mesh.positions(), ends);
            (b - a).norm_squared()
        };
        Self {
            law,
            thickness,
            is_free: vec![true; mesh.vertex_count()],
            vertex_area,
            edge_area,
            edge_squared: edges.iter().map(squared).collect(),
            vertex_triangle: Vec::new(),
            edge_edge: Vec::new(),
            pairs: Vec::new(),
            touches: Vec::new(),
        }
    }

    /// Distance from which on there is no force (m).
    pub(super) fn range(&self) -> Real {
        self.law.range()
    }

    /// Takes over which vertices are prescribed, by their inverse masses (1/kg).
    pub(super) fn set_free(&mut self, inverse_mass: &[Real]) {
        for (free, w) in self.is_free.iter_mut().zip(inverse_mass) {
            *free = *w > 0.0;
        }
    }

    pub(super) fn forget_pairs(&mut self) {
        self.vertex_triangle.clear();
        self.edge_edge.clear();
    }

    /// Takes over the candidates as pairs with a barrier, but for those that cannot move.
    pub(super) fn take_pairs(
        &mut self,
        candidates: &ClothCandidates<Hierarchy>,
        inverse_mass: &[Real],
    ) {
        self.forget_pairs();
        let can_move = |vertices: &[u32; 4]| {
            let mut free = vertices.iter().filter(|v| inverse_mass[**v as usize] > 0.0);
            free.next().is_some()
        };
        for &[vertex, triangle] in candidates.vertex_triangle() {
            let [a, b, c] = candidates.triangles()[triangle as usize];
            let vertices = [vertex, a, b, c];
            if can_move(&vertices) {
                self.vertex_triangle.push(VertexTriangleContact {
                    vertices,
                    area: self.vertex_area[vertex as usize],
                    law: self.law,
                });
            }
        }
        for &pair in candidates.edge_edge() {
            let [[a, b], [c, d]] = pair.map(|e| candidates.edges()[e as usize]);
            let vertices = [a, b, c, d];
            if can_move(&vertices) {
                let [first, second] = pair.map(|e| self.edge_area[e as usize]);
                self.edge_edge.push(EdgeEdgeContact {
                    vertices,
                    area: first.min(second),
                    law: self.law,
                    mollifier: Mollifier::new(pair.map(|e| self.edge_squared[e as usize])),
                });
            }
        }
    }

    /// Energy of all barriers (J) at `positions` (m).
    pub(super) fn energy(&self, positions: &[Vec3], around: Surroundings<'_>) -> Real {
        let mut sum = 0.0;
        for pair in &self.vertex_triangle {
            sum += pair.value(&gather(positions, pair.vertices));
        }
        for pair in &self.edge_edge {
            sum += pair.value(&gather(positions, pair.vertices));
        }
        for obstacle in around.obstacles {
            let free = positions.iter().zip(&self.vertex_area).zip(&self.is_free);
            for ((x, area), _) in free.filter(|(_, free)| **free) {
                let gap = obstacle.clearance(*x, around.time).value - self.thickness;
                sum += area * self.law.energy(gap);
            }
        }
        sum
    }

    /// A vertex of something that touches at `positions` (m), or is inside an obstacle.
    pub(super) fn first_touching(
        &self,
        positions: &[Vec3],
        around: Surroundings<'_>,
    ) -> Option<u32> {
        let touches = |gap: Gap| gap.distance <= 0.0;
        let vertex_triangle = self.vertex_triangle.iter().map(|pair| pair.vertices);
        let first = vertex_triangle
            .map(|v| (v[0], Gap::vertex_triangle(&gather(positions, v))))
            .find(|(_, gap)| touches(*gap));
        let edge_edge = self.edge_edge.iter().map(|pair| pair.vertices);
        let first = first.or_else(|| {
            edge_edge
                .map(|v| (v[0], Gap::edge_edge(&gather(positions, v))))
                .find(|(_, gap)| touches(*gap))
        });
        let inside = |(x, free): (&Vec3, &bool)| {
            let gap = |o: &Obstacle| o.clearance(*x, around.time).value - self.thickness;
            *free && around.obstacles.iter().any(|o| gap(o) <= 0.0)
        };
        let mut all = positions.iter().zip(&self.is_free);
        first
            .map(|(vertex, _)| vertex)
            .or_else(|| all.position(inside).map(|v| v as u32))
    }

    /// Adds the gradient of the energy (N), and replaces the list of Hessians.
    pub(super) fn linearise(
        &mut self,
        positions: &[Vec3],
        around: Surroundings<'_>,
        convexity: Convexity,
        gradient: &mut [Vec3],
    ) {
        self.pairs.clear();
        self.touches.clear();
        for pair in &self.vertex_triangle {
            add_pair(pair, positions, convexity, gradient, &mut self.pairs);
        }
        for pair in &self.edge_edge {
            add_pair(pair, positions, convexity, gradient, &mut self.pairs);
        }
        for obstacle in around.obstacles {
            let free = (0u32..).zip(positions).zip(&self.is_free);
            for ((vertex, x), _) in free.filter(|(_, free)| **free) {
                let at = obstacle.clearance(*x, around.time);
                let gap = at.value - self.thickness;
                if gap >= self.range() {
                    continue;
                }
                let (area, g) = (self.vertex_area[vertex as usize], at.gradient());
                gradient[vertex as usize] += g * (area * self.law.slope(gap));
                self.touches.push(Touch {
                    vertex,
                    hessian: g * g.transpose() * (area * self.law.curvature(gap)),
                    surface_velocity: obstacle.velocity_at(*x, around.time),
                });
            }
        }
    }
}

/// Adds the gradient (N) and the Hessian of a pair, if it acts.
fn add_pair<E: Energy<4> + Element<4>>(
    pair: &E,
    positions: &[Vec3],
    convexity: Convexity,
    gradient: &mut [Vec3],
    hessians: &mut Vec<([u32; 4], Blocks<4>)>,
) {
    let vertices = pair.vertices();
    let x = gather(positions, vertices);
    if pair.value(&x) == 0.0 {
        return;
    }
    for (vertex, g) in vertices.iter().zip(pair.gradient(&x)) {
        gradient[*vertex as usize] += g;
    }
    hessians.push((vertices, pair.hessian(&x, convexity)));
}

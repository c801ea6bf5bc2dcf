//! The elements at every vertex, for methods that move one vertex at a time.

use crate::element::{Convexity, Energy};
use crate::math::{Mat3, Real, Vec3, gather};
use crate::method::chunked::map_reduce;
use std::collections::BTreeMap;

/// Which elements of an [`Energies`](super::Energies) each vertex belongs to, and as which of their corners.
#[derive(Clone, Debug)]
pub struct Incidence {
    families: Vec<FamilyIncidence>,
}

impl Incidence {
    pub(super) fn new(families: impl Iterator<Item = FamilyIncidence>) -> Self {
        Self {
            families: families.collect(),
        }
    }

    pub(super) fn families(&self) -> &[FamilyIncidence] {
        &self.families
    }
}

/// A corner of an element.
#[derive(Clone, Copy, Debug, Default)]
struct Corner {
    element: u32,
    corner: u32,
}

/// What one family contributes at each vertex: entries `starts[v]..starts[v + 1]` for vertex v.
#[derive(Clone, Debug)]
pub(super) struct FamilyIncidence {
    starts: Vec<u32>,
    terms: Terms,
}

#[derive(Clone, Debug)]
enum Terms {
    /// The elements of the vertex, ascending.
    Corners(Vec<Corner>),
    /// A quadratic energy whose Hessian has multiples of the identity for blocks, summed over all elements: the row of
    /// each vertex as columns and factors (N/m), the diagonal first, and its gradient (N) where all positions are zero.
    /// A vertex has some 19 columns with hinges, but 48 corners of the hinges that it belongs to.
    Quadratic {
        row: Vec<(u32, Real)>,
        at_zero: Vec<Vec3>,
    },
}

/// What is added up at some vertices: ∂E/∂x_v (N) and ∂²E/∂x_v² (N/m), one of each per entry of `vertices`.
pub(super) struct VertexTerms<'a> {
    pub(super) vertices: &'a [u32],
    pub(super) gradient: &'a mut [Vec3],
    pub(super) hessian: &'a mut [Mat3],
}

impl FamilyIncidence {
    pub(super) fn of<const N: usize, E: Energy<N>>(elements: &[E], vertex_count: usize) -> Self {
        let mut starts = vec![0; vertex_count + 1];
        for vertex in elements.iter().flat_map(|element| element.vertices()) {
            starts[vertex as usize + 1] += 1;
        }
        for v in 0..vertex_count {
            starts[v + 1] += starts[v];
        }
        let mut corners = vec![Corner::default(); elements.len() * N];
        let mut next = starts.clone();
        for (element, stencil) in (0..).zip(elements) {
            for (corner, vertex) in (0..).zip(stencil.vertices()) {
                let place = &mut next[vertex as usize];
                corners[*place as usize] = Corner { element, corner };
                *place += 1;
            }
        }
        let of_elements = Self {
            starts,
            terms: Terms::Corners(corners),
        };
        of_elements.summed(elements).unwrap_or(of_elements)
    }

    /// The quadratic form of the whole family, if that is what it is.
    fn summed<const N: usize, E: Energy<N>>(&self, elements: &[E]) -> Option<Self> {
        let Terms::Corners(corners) = &self.terms else {
            return None;
        };
        if !E::HESSIAN_IS_CONSTANT {
            return None;
        }
        let zeros = [Vec3::zeros(); N];
        let (mut starts, mut row, mut at_zero) = (vec![0], Vec::new(), Vec::new());
        for (vertex, range) in (0..).zip(self.starts.windows(2)) {
            let mut columns = BTreeMap::from([(vertex, 0.0)]);
            let mut gradient = Vec3::zeros();
            for at in &corners[range[0] as usize..range[1] as usize] {
                let element = &elements[at.element as usize];
                let corner = at.corner as usize;
                gradient += element.gradient(&zeros)[corner];
                let blocks = element.hessian(&zeros, Convexity::Exact)[corner];
                for (column, block) in element.vertices().into_iter().zip(blocks) {
                    if block != Mat3::from_diagonal_element(block[(0, 0)]) {
                        return None;
                    }
                    *columns.entry(column).or_default() += block[(0, 0)];
                }
            }
            row.extend(columns.remove_entry(&vertex));
            row.extend(columns);
            starts.push(row.len() as u32);
            at_zero.push(gradient);
        }
        Some(Self {
            starts,
            terms: Terms::Quadratic { row, at_zero },
        })
    }

    pub(super) fn add<const N: usize, E: Energy<N>>(
        &self,
        elements: &[E],
        x: &[Vec3],
        convexity: Convexity,
        out: VertexTerms<'_>,
    ) {
        map_reduce(
            ((out.vertices, out.gradient), out.hessian),
            #[inline(always)]
            |_, ((vertices, gradient), hessian): ((&[u32], &mut [Vec3]), &mut [Mat3])| {
                for ((&vertex, gradient), hessian) in vertices.iter().zip(gradient).zip(hessian) {
                    let vertex = vertex as usize;
                    let range = self.starts[vertex] as usize..self.starts[vertex + 1] as usize;
                    match &self.terms {
                        Terms::Corners(corners) => {
                            for at in &corners[range] {
                                let element = &elements[at.element as usize];
                                let local = gather(x, element.vertices());
                                let corner = at.corner as usize;
                                let (slope, block) = element.at_corner(&local, corner, convexity);
                                *gradient += slope;
                                *hessian += block;
                            }
                        }
                        Terms::Quadratic { row, at_zero } => {
                            let row = &row[range];
                            let mut sum = at_zero[vertex];
                            for &(column, factor) in row {
                                sum += x[column as usize] * factor;
                            }
                            *gradient += sum;
                            for axis in 0..3 {
                                hessian[(axis, axis)] += row[0].1;
                            }
                        }
                    }
                }
                []
            },
        );
    }
}

#[cfg(test)]
mod tests {
    use crate::cloth::{Cloth, Membrane};
    use crate::element::Convexity;
    use crate::energy::StvkTriangle;
    use crate::math::{Mat3, Vec3};
    use crate::mesh::generate::{Diagonals, grid};
    use crate::method::family::Energies;

    /// A crumpled sheet with springs, hinges and triangles.
    fn sheet() -> (Energies, Vec<Vec3>) {
        let mesh = grid(9, 7, 1.0, 0.8, Diagonals::Alternating).unwrap();
        let cloth = Cloth {
            areal_density: 0.2,
            membrane: Membrane::Modulus(1e3),
            bending_rigidity: 1e-3,
        };
        let model = cloth.on(&mesh).unwrap();
        let triangles = StvkTriangle::on(&mesh, 300.0, 0.3);
        let energies = model.energies().unwrap().with(triangles).unwrap();
        let crumpled = |p: &Vec3| p + Vec3::new((7.0 * p.y).sin(), 0.3, (9.0 * p.x).cos()) * 0.05;
        let x = mesh.positions().iter().map(crumpled).collect();
        (energies, x)
    }

    #[test]
    fn vertex_terms_are_the_gradient_and_the_diagonal_blocks_of_the_whole() {
        let (energies, x) = sheet();
        let incidence = energies.incidence();
        let mut whole = vec![Vec3::zeros(); x.len()];
        energies.add_gradient(&x, &mut whole);
        let vertices: Vec<u32> = (0..x.len() as u32).rev().collect();
        for convexity in [
            Convexity::Exact,
            Convexity::Clamp,
            Convexity::Abs,
            Convexity::GaussNewton,
        ] {
            let matrix = energies.hessian(&x, convexity);
            let mut gradient = vec![Vec3::zeros(); x.len()];
            let mut hessian = vec![Mat3::zeros(); x.len()];
            energies.add_at_vertices(
                &incidence,
                &vertices,
                &x,
                convexity,
                &mut gradient,
                &mut hessian,
            );
            for (i, &v) in vertices.iter().enumerate() {
                let slot = matrix.pattern().slot(v, v).unwrap() as usize;
                let block = matrix.blocks()[slot];
                assert!(
                    (gradient[i] - whole[v as usize]).norm()
                        < 1e-12 * whole[v as usize].norm().max(1.0)
                );
                assert!((hessian[i] - block).norm() < 1e-12 * block.norm());
            }
        }
    }

    #[test]
    fn no_two_vertices_of_a_color_belong_to_one_element() {
        let (energies, x) = sheet();
        let colors = energies.vertex_colors();
        let mut color_of = vec![None; x.len()];
        for (color, vertices) in colors.iter().enumerate() {
            for &v in vertices {
                assert_eq!(color_of[v as usize].replace(color), None);
            }
        }
        assert!(color_of.iter().all(Option::is_some));
        let pattern = energies.assembly();
        let pattern = pattern.pattern();
        for v in 0..x.len() {
            for &u in &pattern.columns()[pattern.row(v)] {
                assert!(u as usize == v || color_of[u as usize] != color_of[v]);
            }
        }
        // A hinge joins vertices two edges apart: 3 × 3 vertices and the wings beyond.
        assert!(colors.len() <= 12, "{} colours", colors.len());
    }
}

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

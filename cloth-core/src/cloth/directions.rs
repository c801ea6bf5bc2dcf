//! How much stiffer than asked for springs are along one direction, and softer along another.

use super::{edge_weight, modulus_per_stiffness};
use crate::math::{Real, Vec3};
use crate::mesh::TriMesh;
use crate::topology::EdgeTable;
use nalgebra::{SMatrix, SVector};
use std::f64::consts::{FRAC_PI_3, SQRT_2};

/// A symmetric matrix of 3 × 3 as a vector: `n nᵀ`, and strain (dimensionless).
type Strain = SVector<Real, 6>;
/// A stiffness that takes strain to stress.
type Stiffness = SMatrix<Real, 6, 6>;

/// Fraction of the stiffness that is added against every strain, out of the plane too, so that it can be inverted.
const FILLER: Real = 1e-4;

/// Young's modulus of a mesh of springs along one of its edges; see [`Piece::directional_moduli`].
///
/// Equal springs of length L along n, n nᵀ written as a vector, have the stiffness `C = Σ k L² (n nᵀ)(n nᵀ)ᵀ/A` in the
/// mean over the mesh, and along n Young's modulus `1/(n nᵀ·C⁻¹ n nᵀ)`. It is compared with that of the isotropic sheet
/// in the place of every triangle, so that the mesh may be curved. Exact on a plane where all vertices move as the mean
/// strain says; springs of an irregular mesh are a quarter softer in all directions
/// ([`Membrane::Modulus`](super::Membrane::Modulus)).
///
/// [`Piece::directional_moduli`]: super::Piece::directional_moduli
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectionalModulus {
    /// Direction of the edge (unit length).
    pub direction: Vec3,
    /// Over the modulus that was asked for (dimensionless): 1 of an isotropic mesh.
    pub ratio: Real,
}

impl DirectionalModulus {
    /// That along the softest and along the stiffest edge; none for a mesh without edges.
    pub(super) fn extremes(mesh: &TriMesh, edges: &EdgeTable) -> Option<[Self; 2]> {
        let x = mesh.positions();
        let along = |&[a, b]: &[u32; 2]| x[b as usize] - x[a as usize];
        let add = |stiffness: &mut Stiffness, n: &Vec3, weight: Real| {
            let row = strain_along(n);
            *stiffness += row * row.transpose() * weight;
        };
        let mut springs = Stiffness::zeros();
        let k = 1.0 / modulus_per_stiffness(mesh, edges);
        for (edge, ends) in edges.ends().iter().enumerate() {
            let way = along(ends);
            let weight = k * edge_weight(edges, edge) * way.norm_squared();
            add(&mut springs, &way.normalize(), weight);
        }
        // 3 Y A times the mean of (n nᵀ)(n nᵀ)ᵀ over all directions, which is that over three of them.
        let mut sheet = Stiffness::zeros();
        for (&[a, b, c], area) in mesh.triangles().iter().zip(mesh.areas()) {
            let first = along(&[a, b]).normalize();
            let across = first.cross(&along(&[a, c])).normalize().cross(&first);
            for number in 0..3 {
                let (sin, cos) = (Real::from(number) * FRAC_PI_3).sin_cos();
                add(&mut sheet, &(first * cos + across * sin), area);
            }
        }
        let compliance = |stiffness: Stiffness| {
            let filler = Stiffness::identity() * (FILLER * stiffness.trace());
            (stiffness + filler).try_inverse()
        };
        let (springs, sheet) = (compliance(springs)?, compliance(sheet)?);
        let all = edges.ends().iter().map(|ends| {
            let direction = along(ends).normalize();
            let row = strain_along(&direction);
            let ratio = row.dot(&(sheet * row)) / row.dot(&(springs * row));
            Self { direction, ratio }
        });
        let least = all.clone().min_by(|a, b| a.ratio.total_cmp(&b.ratio))?;
        let most = all.max_by(|a, b| a.ratio.total_cmp(&b.ratio))?;
        Some([least, most])
    }
}

/// `n nᵀ`.
fn strain_along(n: &Vec3) -> Strain {
    let sides = [n.x * n.x, n.y * n.y, n.z * n.z];
    let shears = [n.y * n.z, n.z * n.x, n.x * n.y].map(|product| SQRT_2 * product);
    Strain::from_iterator(sides.into_iter().chain(shears))
}

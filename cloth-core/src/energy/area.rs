//! A triangle that wants to keep its area.
//!
//! M. Teschner, B. Heidelberger, M. Müller, M. Gross, "A versatile and robust model for geometrically complex
//! deformable solids", Computer Graphics International 2004: their potential for the preservation of area, here with
//! `k = K/A₀`.

use crate::element::{Constraint, Convexity, Element, Row};
use crate::error::{OutOfRange, finite, number};
use crate::math::{Blocks, Mat3, Real, Vec3, gather, length_and_direction, make_semidefinite};
use crate::mesh::TriMesh;

/// The area constraint: `C = A − A₀` (m²), `E = ½ k C²` (J), with `A = ½ ‖(x₁ − x₀) × (x₂ − x₀)‖`.
///
/// With `k = K/A₀` it costs `½ K (A/A₀ − 1)²` per rest area: K (N/m) is the area modulus, what the sheet resists an
/// equal stretch in all directions with, and shear at constant area is free. Its gradient is `∂A/∂xᵢ = ½ n × oᵢ`, n the
/// unit normal and `oᵢ` the edge opposite to the vertex, run through in the direction of the triangle.
///
/// Where the three vertices lie on a line, n is not defined; any direction across the longest edge is a limit of nearby
/// normals, and one is taken that depends on the vertex numbers only, so a flattened triangle can open again. Where
/// they coincide the gradient is zero, and a position-based method leaves the element alone.
///
/// Limits: the area has no sign. A triangle turned over is at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AreaTriangle {
    /// Its three corners.
    pub vertices: [u32; 3],
    /// Rest area A₀ (m²).
    pub rest_area: Real,
    /// k (N/m³).
    pub stiffness: Real,
}

impl AreaTriangle {
    /// One element on every triangle of the mesh, for an area modulus K (N/m).
    #[must_use]
    pub fn on(mesh: &TriMesh, modulus: Real) -> Vec<Self> {
        let triangles = mesh.triangles().iter();
        triangles
            .map(|&v| Self::new(v, &gather(mesh.positions(), v), modulus))
            .collect()
    }

    /// The element at rest at `rest` (m), which must have an area, for K (N/m).
    #[must_use]
    pub fn new(vertices: [u32; 3], rest: &[Vec3; 3], modulus: Real) -> Self {
        let rest_area = 0.5 * (rest[1] - rest[0]).cross(&(rest[2] - rest[0])).norm();
        Self {
            vertices,
            rest_area,
            stiffness: modulus / rest_area,
        }
    }

    /// Twice the area (m²) and the unit normal.
    fn normal(&self, opposite: &[Vec3; 3]) -> (Real, Vec3) {
        let product = opposite[1].cross(&opposite[2]);
        let (twice_area, n) = length_and_direction(product, [self.vertices[0], self.vertices[1]]);
        if twice_area > 0.0 {
            return (twice_area, n);
        }
        // Across the line that the triangle has become, if it is not a point.
        let mut longest = opposite[0];
        for o in opposite {
            if o.norm_squared() > longest.norm_squared() {
                longest = *o;
            }
        }
        let (length, along) = length_and_direction(longest, [self.vertices[0], self.vertices[1]]);
        let across = n - along * along.dot(&n);
        if length > 0.0 && across.norm_squared() > 1e-4 {
            return (0.0, across.normalize());
        }
        let axis = Vec3::ith(along.iamin(), 1.0);
        (0.0, (axis - along * along.dot(&axis)).normalize())
    }
}

/// For each vertex the edge opposite to it, run through in the direction of the triangle; they sum to zero.
#[inline]
fn opposite_edges(x: &[Vec3; 3]) -> [Vec3; 3] {
    [x[2] - x[1], x[0] - x[2], x[1] - x[0]]
}

impl Element<3> for AreaTriangle {
    #[inline]
    fn vertices(&self) -> [u32; 3] {
        self.vertices
    }

    fn check(&self) -> Result<(), OutOfRange> {
        finite("rest area (m²)", self.rest_area)?;
        number("stiffness", self.stiffness)?;
        Ok(())
    }
}

impl Constraint<3> for AreaTriangle {
    type Rows = [Row<3>; 1];

    #[inline]
    fn rows(&self, x: &[Vec3; 3]) -> [Row<3>; 1] {
        let opposite = opposite_edges(x);
        let (twice_area, n) = self.normal(&opposite);
        [Row {
            value: 0.5 * twice_area - self.rest_area,
            gradient: opposite.map(|o| n.cross(&o) * 0.5),
            stiffness: self.stiffness,
        }]
    }

    /// With `N = 2A n`: `∂²A/∂xᵢ∂xⱼ = ½ ([oᵢ]ᵀ (I − n nᵀ)[oⱼ]/‖N‖ + n·∂²N)`, the last term `∓[n]` between neighbours,
    /// brackets meaning the matrix of the cross product. Its eigenvalues have no closed form here, so convexity is made
    /// numerically.
    fn curvature(&self, x: &[Vec3; 3], convexity: Convexity) -> Blocks<3> {
        let opposite = opposite_edges(x);
        let (twice_area, n) = self.normal(&opposite);
        let scale = 0.5 * self.stiffness * (0.5 * twice_area - self.rest_area);
        let mut sum = [[Mat3::zeros(); 4]; 4];
        if twice_area > 0.0 {
            let across = (Mat3::identity() - n * n.transpose()) / twice_area;
            let cross = opposite.map(|o| o.cross_matrix());
            let turn = n.cross_matrix();
            for i in 0..3 {
                for j in 0..3 {
                    sum[i][j] += cross[i].transpose() * across * cross[j] * scale;
                }
                let next = (i + 1) % 3;
                sum[i][next] -= turn * scale;
                sum[next][i] += turn * scale;
            }
        } // else no second derivative exists; the rank-one part stands alone
        let sum = make_semidefinite(&sum, convexity);
        std::array::from_fn(|i| std::array::from_fn(|j| sum[i][j]))
    }
}

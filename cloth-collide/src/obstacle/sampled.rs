//! Signed distance looked up in a grid.

use super::{Distance, ObstacleError, SignedDistance, not_negative, positive, within};
use crate::bounds::Bounds;
use cloth_core::math::{Real, Vec3};
use std::fmt;

/// Most samples that a grid may have: half a gigabyte of them.
const MOST_SAMPLES: Real = 67_108_864.0;

/// Largest Σ |w| ‖d‖ (spacings) over the nodes, w their weights in φ with those of c, d their distances from the point:
/// half-way between all nodes.
const FARTHEST: Real = 1.82;

/// The signed distance of another shape, taken at the nodes of a regular grid once; in between it is a quadratic
/// B-spline. A query costs 27 look-ups, however many triangles the shape has.
///
/// Along an axis, t spacings after the nearest node, −½ ≤ t ≤ ½, the node before it, it and the node after it have the
/// weights ½ (½ − t)², ¾ − t², ½ (½ + t)², and all weights have continuous derivatives: so has φ, which energies of
/// contact need. The mean of the places of the nodes by the weights is the point, and the variance is ¼ of the spacing
/// squared everywhere. So the spline of the samples themselves would be right where the distance is linear, and off by
/// ⅛ of the spacing squared times its Laplacian elsewhere. That much, by second differences, is taken from the samples
/// first: c = φ − ⅛ Σ (φ₋ − 2φ + φ₊) over the axes. The spline of c is right for quadratic functions, and off by the
/// third power of the spacing where the surface is smooth.
///
/// **What is approximate.** Inside the grid, φ differs from the shape's own by at most [`SignedDistance::error_bound`],
/// 1.82 spacings; in tests by up to a quarter of one, at edges, which come out rounded. The gradient is that of this φ,
/// so its length, [`Distance::slope`], is not quite 1.
///
/// **Outside the grid** nothing is known but what follows from the samples: with q the nearest point of the grid's box
/// and r the distance from it, φ = √(r² + max(φ(q), 0)²). No point of the shape is nearer than that (to the same
/// bound), because all of it is on the other side of q; it may be farther by more. The answer is continuous across the
/// border where φ is not negative there. A padding of the thickness of contact and a spacing has all that touches
/// inside.
pub struct SampledDistance {
    /// The box in which φ is known.
    lower: Vec3,
    upper: Vec3,
    spacing: Real,
    /// Number of nodes along each axis, at least 4: one row lies outside of the box on each side.
    nodes: [usize; 3],
    /// c (m), the one for x last to change.
    coefficients: Vec<Real>,
    lipschitz: Real,
    error_bound: Real,
    shape_bounds: Bounds,
}

impl SampledDistance {
    /// Samples `shape` on a grid of the given `spacing` (m) that reaches at least `padding` (m) beyond it on all sides.
    ///
    /// # Errors
    /// [`ObstacleError::OutOfRange`] for the spacing, the padding or the number of samples,
    /// [`ObstacleError::Unbounded`] for a shape without end.
    pub fn new(
        shape: &dyn SignedDistance,
        spacing: Real,
        padding: Real,
    ) -> Result<Self, ObstacleError> {
        positive("spacing of the grid (m)", spacing)?;
        not_negative("padding of the grid (m)", padding)?;
        let shape_bounds = shape.bounds().ok_or(ObstacleError::Unbounded)?;
        let lower = shape_bounds.lower.add_scalar(-padding);
        let extent = shape_bounds.upper.add_scalar(padding) - lower;
        // Two rows more than the box has on each side.
        let counts = extent.map(|x| (x / spacing).ceil().max(1.0) + 5.0);
        let count = counts.product();
        let name = "number of samples of the grid";
        within(count <= MOST_SAMPLES, name, count, "at most 2²⁶")?;
        let [nx, ny, nz] = [counts.x as usize, counts.y as usize, counts.z as usize];
        let first = lower.add_scalar(-2.0 * spacing);
        let mut samples = Vec::with_capacity(nx * ny * nz);
        for z in 0..nz {
            for y in 0..ny {
                for x in 0..nx {
                    let step = Vec3::new(x as Real, y as Real, z as Real) * spacing;
                    samples.push(shape.signed_distance(first + step).value);
                }
            }
        }
        let mut coefficients = Vec::with_capacity((nx - 2) * (ny - 2) * (nz - 2));
        for z in 1..nz - 1 {
            for y in 1..ny - 1 {
                for x in 1..nx - 1 {
                    let at = x + nx * (y + ny * z);
                    let around = [1, nx, nx * ny].map(|k| samples[at - k] + samples[at + k]);
                    coefficients.push(1.75 * samples[at] - 0.125 * around.iter().sum::<Real>());
                }
            }
        }
        let mut sampled = Self {
            lower,
            upper: lower + counts.add_scalar(-5.0) * spacing,
            spacing,
            nodes: [nx - 2, ny - 2, nz - 2],
            coefficients,
            lipschitz: 1.0,
            error_bound: FARTHEST * spacing * shape.lipschitz(),
            shape_bounds,
        };
        sampled.lipschitz = sampled.steepest();
        Ok(sampled)
    }

    /// The 27 coefficients around a node, the one for x last to change: `[z][y][x]`.
    fn around(&self, node: [usize; 3]) -> [[[Real; 3]; 3]; 3] {
        let [nx, ny, _] = self.nodes;
        let row = |y: usize, z: usize| {
            let first = node[0] - 1 + nx * (node[1] + y - 1 + ny * (node[2] + z - 1));
            [0, 1, 2].map(|x| self.coefficients[first + x])
        };
        std::array::from_fn(|z| std::array::from_fn(|y| row(y, z)))
    }

    /// φ (m) and ∂φ/∂x at a point (m) inside the box.
    fn interpolate(&self, point: Vec3) -> (Real, Vec3) {
        let place = ((point - self.lower) / self.spacing).add_scalar(1.0);
        let node: [usize; 3] =
            std::array::from_fn(|k| (place[k].round() as usize).clamp(1, self.nodes[k] - 2));
        let t: [Real; 3] = std::array::from_fn(|k| (place[k] - node[k] as Real).clamp(-0.5, 0.5));
        let [x, y, z] = t.map(|t| {
            let (before, after) = (0.5 - t, 0.5 + t);
            [0.5 * before * before, 0.75 - t * t, 0.5 * after * after]
        });
        let [slope_x, slope_y, slope_z] = t.map(|t| [t - 0.5, -2.0 * t, t + 0.5]);
        let dot = |a: &[Real; 3], b: &[Real; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let c = self.around(node);
        let along_x = c.map(|plane| plane.map(|row| dot(&row, &x)));
        let along_y = along_x.map(|row| dot(&row, &y));
        let gradient = Vec3::new(
            dot(
                &c.map(|plane| dot(&plane.map(|row| dot(&row, &slope_x)), &y)),
                &z,
            ),
            dot(&along_x.map(|row| dot(&row, &slope_y)), &z),
            dot(&along_y, &slope_z),
        );
        (dot(&along_y, &z), gradient / self.spacing)
    }

    /// The steepest that φ can be anywhere: around a node, each coordinate of the gradient is a mean of differences of
    /// neighbours.
    fn steepest(&self) -> Real {
        let mut squared: Real = 1.0;
        for z in 1..self.nodes[2] - 1 {
            for y in 1..self.nodes[1] - 1 {
                for x in 1..self.nodes[0] - 1 {
                    let v = self.around([x, y, z]);
                    let mut most = [0.0; 3];
                    for i in 0..3 {
                        for j in 0..3 {
                            for k in 0..2 {
                                let differences = [
                                    v[i][j][k + 1] - v[i][j][k],
                                    v[i][k + 1][j] - v[i][k][j],
                                    v[k + 1][i][j] - v[k][i][j],
                                ];
                                for (most, difference) in most.iter_mut().zip(differences) {
                                    *most = Real::max(*most, difference.abs());
                                }
                            }
                        }
                    }
                    let sum: Real = most.iter().map(|d| d * d).sum();
                    squared = squared.max(sum / (self.spacing * self.spacing));
                }
            }
        }
        // A little more, because differences are rounded.
        squared.sqrt() * (1.0 + 1e-12)
    }
}

impl SignedDistance for SampledDistance {
    fn signed_distance(&self, point: Vec3) -> Distance {
        let inside = point.sup(&self.lower).inf(&self.upper);
        let (value, gradient) = self.interpolate(inside);
        let beyond = point - inside;
        if beyond == Vec3::zeros() {
            return with_gradient(value, gradient);
        }
        // On the border φ is not negative; moving on along an axis that is left already does not change q.
        let value = value.max(0.0);
        let total = (beyond.norm_squared() + value * value).sqrt();
        let still = beyond.zip_map(&gradient, |b, g| if b == 0.0 { g } else { 0.0 });
        with_gradient(total, (beyond + still * value) / total)
    }

    fn lipschitz(&self) -> Real {
        self.lipschitz
    }

    fn error_bound(&self) -> Real {
        self.error_bound
    }

    fn bounds(&self) -> Option<Bounds> {
        Some(self.shape_bounds.inflated(self.error_bound))
    }
}

fn with_gradient(value: Real, gradient: Vec3) -> Distance {
    let slope = gradient.norm();
    // On a crest of φ no direction is better than another.
    let normal = if slope > 0.0 {
        gradient / slope
    } else {
        Vec3::z()
    };
    Distance {
        value,
        normal,
        slope,
    }
}

impl fmt::Debug for SampledDistance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("SampledDistance")
            .field("spacing", &self.spacing)
            .field("nodes", &self.nodes)
            .finish_non_exhaustive()
    }
}

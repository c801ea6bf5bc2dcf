//! Signed distance looked up in a grid.

use super::{Distance, ObstacleError, SignedDistance, not_negative, positive};
use crate::bounds::Bounds;
use cloth_core::math::{Real, Vec3};
use std::fmt;

/// Most samples that a grid may have: half a gigabyte of them.
const MOST_SAMPLES: usize = 1 << 26;

/// The signed distance of another shape, taken at the nodes of a regular grid once; in between it is interpolated,
/// linearly along each axis. A query costs eight look-ups, however many triangles the shape has.
///
/// **What is approximate.** Inside the grid, φ differs from the shape's own by at most
/// [`SampledDistance::error_bound`], √3/2 of the spacing; far less where the surface is smooth, more than a little only
/// at edges, which come out rounded. The gradient is that of the interpolated φ, so its length, [`Distance::slope`],
/// is not quite 1, and it jumps from cell to cell.
///
/// **Outside the grid** nothing is known but what follows from the samples: with q the nearest point of the grid's box
/// and r the distance from it, φ = √(r² + φ(q)²). No point of the shape is nearer than that (to the same bound),
/// because all of it is on the other side of q. The answer is continuous across the border of the grid.
pub struct SampledDistance {
    lower: Vec3,
    upper: Vec3,
    spacing: Real,
    /// Number of nodes along each axis, at least 2.
    nodes: [usize; 3],
    samples: Vec<Real>,
    lipschitz: Real,
    error_bound: Real,
    shape_bounds: Bounds,
}

impl SampledDistance {
    /// Samples `shape` on a grid of the given `spacing` (m) that reaches at least `padding` (m) beyond it on all sides.
    ///
    /// # Errors
    /// [`ObstacleError::OutOfRange`] for the spacing or the padding,
    /// [`ObstacleError::Unbounded`] for a shape without end, [`ObstacleError::TooManySamples`].
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
        let counts = extent.map(|x| (x / spacing).ceil().max(1.0) + 1.0);
        let count = counts.product();
        if count > MOST_SAMPLES as Real {
            return Err(ObstacleError::TooManySamples {
                count,
                limit: MOST_SAMPLES,
            });
        }
        let nodes = [counts.x as usize, counts.y as usize, counts.z as usize];
        let mut samples = Vec::with_capacity(nodes.iter().product());
        for z in 0..nodes[2] {
            for y in 0..nodes[1] {
                for x in 0..nodes[0] {
                    let step = Vec3::new(x as Real, y as Real, z as Real) * spacing;
                    samples.push(shape.signed_distance(lower + step).value);
                }
            }
        }
        let mut sampled = Self {
            lower,
            upper: lower + counts.add_scalar(-1.0) * spacing,
            spacing,
            nodes,
            samples,
            lipschitz: 1.0,
            error_bound: 0.75f64.sqrt() * spacing * shape.lipschitz(),
            shape_bounds,
        };
        sampled.lipschitz = sampled.steepest();
        Ok(sampled)
    }

    /// How far φ may be from that of the shape that was sampled (m).
    #[must_use]
    pub fn error_bound(&self) -> Real {
        self.error_bound
    }

    /// The eight samples around a cell, the one for x last to change: `[z][y][x]`.
    fn corners(&self, cell: [usize; 3]) -> [[[Real; 2]; 2]; 2] {
        let [nx, ny, _] = self.nodes;
        let at = |x: usize, y: usize, z: usize| {
            self.samples[cell[0] + x + nx * (cell[1] + y + ny * (cell[2] + z))]
        };
        std::array::from_fn(|z| std::array::from_fn(|y| std::array::from_fn(|x| at(x, y, z))))
    }

    /// φ (m) and ∂φ/∂x at a point (m) inside the grid.
    fn interpolate(&self, point: Vec3) -> (Real, Vec3) {
        let place = (point - self.lower) / self.spacing;
        let cell: [usize; 3] =
            std::array::from_fn(|k| (place[k].max(0.0) as usize).min(self.nodes[k] - 2));
        let t: [Real; 3] = std::array::from_fn(|k| (place[k] - cell[k] as Real).clamp(0.0, 1.0));
        let v = self.corners(cell);
        let mix = |[a, b]: [Real; 2], t: Real| a + (b - a) * t;
        let along_x = v.map(|plane| plane.map(|row| mix(row, t[0])));
        let along_y = along_x.map(|row| mix(row, t[1]));
        let slope_x = v.map(|plane| mix(plane.map(|[a, b]| b - a), t[1]));
        let slope_y = along_x.map(|[a, b]| b - a);
        let gradient = Vec3::new(
            mix(slope_x, t[2]),
            mix(slope_y, t[2]),
            along_y[1] - along_y[0],
        );
        (mix(along_y, t[2]), gradient / self.spacing)
    }

    /// The steepest that φ can be anywhere: in a cell, each coordinate of the gradient is a mean of four differences of
    /// neighbours.
    fn steepest(&self) -> Real {
        let mut squared: Real = 1.0;
        for z in 0..self.nodes[2] - 1 {
            for y in 0..self.nodes[1] - 1 {
                for x in 0..self.nodes[0] - 1 {
                    let v = self.corners([x, y, z]);
                    let mut most = [0.0; 3];
                    for [i, j] in [[0, 0], [0, 1], [1, 0], [1, 1]] {
                        let differences = [
                            v[i][j][1] - v[i][j][0],
                            v[i][1][j] - v[i][0][j],
                            v[1][i][j] - v[0][i][j],
                        ];
                        for k in 0..3 {
                            most[k] = Real::max(most[k], differences[k].abs());
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

    fn bounds(&self) -> Option<Bounds> {
        Some(Bounds {
            lower: self.shape_bounds.lower.add_scalar(-self.error_bound),
            upper: self.shape_bounds.upper.add_scalar(self.error_bound),
        })
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

//! The frame of a patch: where it is and how it is turned.

use cloth_core::math::{Mat3, Real, Vec3};

/// Directions that are as good as parallel have a sine below this.
const PARALLEL: Real = 1e-3;

/// The centre of some vertices (m), the mean, and axes that turn with them: a rotation.
///
/// Any rotation will do for the bounds that follow from it: one that does not fit makes them large, not wrong.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    pub(super) centre: Vec3,
    pub(super) axes: Mat3,
}

/// Coordinates (m) of four vertices side by side.
pub(super) type Four = [[Real; 4]; 3];

/// Vertices of a patch, four side by side; the last four may name one twice.
#[derive(Clone, Copy, Debug)]
pub(super) struct Group {
    vertices: [u32; 4],
    /// The weight that each has in the centre (dimensionless), and where it is at rest along the two longest directions
    /// of the patch (m), from the centre: 0 for one that is there twice.
    weights: [Real; 4],
    along: [[Real; 4]; 2],
}

/// The vertices of a patch, which is `x` (m) at rest, in groups. The directions in which it reaches farthest are the
/// eigenvectors of the covariance of its vertices.
pub(super) fn groups(vertices: &[u32], x: &[Vec3]) -> Vec<Group> {
    let at = |v: u32| x[v as usize];
    let weight = 1.0 / vertices.len() as Real;
    let centre = vertices.iter().map(|&v| at(v)).sum::<Vec3>() * weight;
    let arms = vertices.iter().map(|&v| at(v) - centre);
    let covariance: Mat3 = arms.map(|arm| arm * arm.transpose()).sum();
    let eigen = covariance.symmetric_eigen();
    let least = eigen.eigenvalues.imin();
    let axes = [1, 2].map(|k| eigen.eigenvectors.column((least + k) % 3).into_owned());
    let group = |four: &[u32]| {
        let mut group = Group {
            vertices: [four[0]; 4],
            weights: [0.0; 4],
            along: [[0.0; 4]; 2],
        };
        for (k, &v) in four.iter().enumerate() {
            group.vertices[k] = v;
            group.weights[k] = weight;
            for (along, axis) in group.along.iter_mut().zip(&axes) {
                along[k] = axis.dot(&(at(v) - centre));
            }
        }
        group
    };
    vertices.chunks(4).map(group).collect()
}

impl Frame {
    pub(super) const NOWHERE: Self = Self {
        centre: Vec3::new(0.0, 0.0, 0.0),
        axes: Mat3::new(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0),
    };

    /// Takes the centre of vertices at `x` (m), which go to `arms`, from the centre.
    #[inline(always)]
    pub(super) fn place(&mut self, groups: &[Group], x: &[Vec3], arms: &mut [Four]) {
        let mut sum = [[0.0; 4]; 3];
        for (group, arms) in groups.iter().zip(&mut *arms) {
            for (k, &v) in group.vertices.iter().enumerate() {
                let x = &x[v as usize];
                (arms[0][k], arms[1][k], arms[2][k]) = (x.x, x.y, x.z);
            }
            add(&mut sum, &group.weights, arms);
        }
        self.centre = total(&sum);
        for arms in arms {
            for axis in 0..3 {
                for k in 0..4 {
                    arms[axis][k] -= self.centre[axis];
                }
            }
        }
    }

    /// Turns as vertices do that are at `arms` (m), from the centre.
    #[inline(always)]
    pub(super) fn turn(&mut self, groups: &[Group], arms: &[Four]) {
        let (mut first, mut second) = ([[0.0; 4]; 3], [[0.0; 4]; 3]);
        for (group, arms) in groups.iter().zip(arms) {
            add(&mut first, &group.along[0], arms);
            add(&mut second, &group.along[1], arms);
        }
        self.axes = axes(total(&first), total(&second)).unwrap_or(Self::NOWHERE.axes);
    }
}

/// Adds four vectors with their weights, side by side.
#[inline(always)]
fn add(sum: &mut Four, weights: &[Real; 4], x: &Four) {
    for axis in 0..3 {
        for k in 0..4 {
            sum[axis][k] += weights[k] * x[axis][k];
        }
    }
}

/// The sum of four vectors.
#[inline(always)]
fn total(x: &Four) -> Vec3 {
    let sum = |lanes: &[Real; 4]| (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]);
    Vec3::new(sum(&x[0]), sum(&x[1]), sum(&x[2]))
}

/// The rotation to which two directions belong, both alike: its first two axes are between them and across. None if
/// they are parallel, or one is zero.
#[inline(always)]
fn axes(first: Vec3, second: Vec3) -> Option<Mat3> {
    let (first, second) = (first.try_normalize(0.0)?, second.try_normalize(0.0)?);
    let along = (first + second).try_normalize(PARALLEL)?;
    let across = (first - second).try_normalize(PARALLEL)?;
    Some(Mat3::from_columns(&[along, across, along.cross(&across)]))
}

/// ‖A − B‖₂ of two rotations, 2 sin(θ/2) for the angle θ between them; the singular values of the difference are this
/// twice, and 0.
#[inline(always)]
pub(super) fn tilt(a: &Mat3, b: &Mat3) -> Real {
    (a - b).norm() * std::f64::consts::FRAC_1_SQRT_2
}

/// Four vectors times a matrix.
#[inline(always)]
pub(super) fn times(m: &Mat3, x: &Four) -> Four {
    let mut out = [[0.0; 4]; 3];
    for axis in 0..3 {
        for k in 0..4 {
            out[axis][k] = m[(axis, 0)] * x[0][k] + m[(axis, 1)] * x[1][k] + m[(axis, 2)] * x[2][k];
        }
    }
    out
}

/// Takes the larger of each of four numbers (m²) and the squared length of a − b.
#[inline(always)]
pub(super) fn farthest(most: &mut [Real; 4], a: &Four, b: &Four) {
    let mut squared = [0.0; 4];
    for axis in 0..3 {
        for k in 0..4 {
            let apart = a[axis][k] - b[axis][k];
            squared[k] += apart * apart;
        }
    }
    for k in 0..4 {
        most[k] = if squared[k] > most[k] {
            squared[k]
        } else {
            most[k]
        };
    }
}

/// The root of the largest of four squares.
#[inline(always)]
pub(super) fn root(most: [Real; 4]) -> Real {
    most.into_iter().fold(0.0, Real::max).sqrt()
}

//! What is known of all patches at one moment, and of two of them.

use super::frame::{Four, Frame, tilt};
use cloth_core::math::{Mat3, Real, Vec3};

/// Of each patch, at one moment.
#[derive(Clone, Debug, Default)]
pub(super) struct Motions {
    /// Centre (m) and axes; its vertices, from the centre (m); the distance (m) of the farthest of them; and the
    /// spread (m).
    pub(super) frames: Vec<Frame>,
    pub(super) arms: Vec<Four>,
    pub(super) radii: Vec<Real>,
    pub(super) spreads: Vec<Real>,
    /// How far (m) a vertex has gone relative to the centre, at most in each substep, added up over the substeps.
    pub(super) paths: Vec<Real>,
    /// The same, and the displacements of the centre besides that of the mean (m): never less than before, and two
    /// patches move relative to each other by no more than the sum of both grows.
    pub(super) clocks: Vec<Real>,
    /// The clock of every patch that rests.
    pub(super) still: Real,
    /// Mean of the centres of the cloth (m).
    pub(super) mean: Vec3,
}

/// Where one patch is as seen from another: its centre (m) and its axes in the frame of the other; and its radius (m).
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pose {
    centre: Vec3,
    axes: Mat3,
    radius: Real,
}

impl Pose {
    /// By how much (m) distances between points of the two have changed, at most, from this one to another, besides
    /// what their spreads have grown.
    #[inline]
    pub(super) fn change(&self, other: &Self) -> Real {
        (other.centre - self.centre).norm() + tilt(&self.axes, &other.axes) * self.radius
    }
}

impl Motions {
    /// Of so many patches with so many groups of vertices, which are nowhere yet.
    pub(super) fn new(count: usize, groups: usize) -> Self {
        Self {
            arms: vec![[[0.0; 4]; 3]; groups],
            frames: vec![Frame::NOWHERE; count],
            radii: vec![0.0; count],
            spreads: vec![0.0; count],
            paths: vec![0.0; count],
            clocks: vec![0.0; count],
            still: 0.0,
            mean: Vec3::zeros(),
        }
    }

    /// Takes over everything of another, in the memory that is there.
    pub(super) fn copy(&mut self, other: &Self) {
        self.frames.clone_from(&other.frames);
        self.arms.clone_from(&other.arms);
        self.radii.clone_from(&other.radii);
        self.spreads.clone_from(&other.spreads);
        self.paths.clone_from(&other.paths);
        self.clocks.clone_from(&other.clocks);
        self.still = other.still;
        self.mean = other.mean;
    }

    /// Difference of the centres (m), and sum of the paths (m).
    #[inline]
    pub(super) fn of(&self, patches: [u32; 2]) -> (Vec3, Real) {
        let [p, q] = patches.map(|p| p as usize);
        let apart = self.frames[p].centre - self.frames[q].centre;
        (apart, self.paths[p] + self.paths[q])
    }

    /// Sum of the spreads (m).
    #[inline]
    pub(super) fn spread(&self, [p, q]: [u32; 2]) -> Real {
        self.spreads[p as usize] + self.spreads[q as usize]
    }

    /// The second patch as seen from the first.
    #[inline]
    pub(super) fn pose(&self, patches: [u32; 2]) -> Pose {
        let [p, q] = patches.map(|p| p as usize);
        let (p, other) = (&self.frames[p], &self.frames[q]);
        Pose {
            centre: p.axes.tr_mul(&(other.centre - p.centre)),
            axes: p.axes.tr_mul(&other.axes),
            radius: self.radii[q],
        }
    }
}

//! Where patches are, and how far they have come.

use super::PatchPair;
use cloth_core::math::{Real, Vec3};

/// Of each patch, at one moment.
#[derive(Clone, Debug, Default)]
pub(super) struct Motions {
    /// Centre (m) and spread (m).
    pub(super) centres: Vec<Vec3>,
    pub(super) spreads: Vec<Real>,
    /// How far (m) a vertex has gone relative to the centre, at most in each substep, added up over the substeps.
    pub(super) paths: Vec<Real>,
    /// The same, and the displacements of the centre besides that of the mean (m): never less than before, and two
    /// patches move relative to each other by no more than the sum of both grows.
    pub(super) clocks: Vec<Real>,
    /// Mean of the centres of the cloth (m).
    pub(super) mean: Vec3,
}

impl Motions {
    /// Of so many patches, which are nowhere yet.
    pub(super) fn new(count: usize) -> Self {
        Self {
            centres: vec![Vec3::zeros(); count],
            spreads: vec![0.0; count],
            paths: vec![0.0; count],
            clocks: vec![0.0; count],
            mean: Vec3::zeros(),
        }
    }

    /// All patches have been told, of which the first `cloth` are the cloth's.
    pub(super) fn finish(&mut self, cloth: usize) {
        self.mean = self.centres[..cloth].iter().sum::<Vec3>() / cloth.max(1) as Real;
    }

    /// Takes over where another is.
    pub(super) fn copy(&mut self, other: &Self) {
        self.centres.clone_from(&other.centres);
        self.spreads.clone_from(&other.spreads);
        self.mean = other.mean;
    }

    /// Difference of the centres (m), and sum of the paths (m).
    #[inline]
    pub(super) fn of(&self, patches: [u32; 2]) -> (Vec3, Real) {
        let [p, q] = patches.map(|p| p as usize);
        let apart = self.centres[p] - self.centres[q];
        (apart, self.paths[p] + self.paths[q])
    }

    #[inline]
    pub(super) fn clock(&self, [p, q]: [u32; 2]) -> Real {
        self.clocks[p as usize] + self.clocks[q as usize]
    }

    /// The bound on what two patches have moved relative to each other (m).
    #[inline]
    pub(super) fn bound(&self, pair: &PatchPair) -> Real {
        let [p, q] = pair.patches.map(|p| p as usize);
        let apart = self.centres[p] - self.centres[q] - pair.apart;
        apart.norm() + self.spreads[p] + self.spreads[q] - pair.spread
    }
}

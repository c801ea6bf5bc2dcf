//! How a vertex follows its parents on the next coarser level.
//!
//! The weights are exact for linear functions of the rest positions, so that coarse levels represent translations,
//! rotations of small angle and constant strain; they differ as little as that allows from what each parent weighs by
//! its distance.

use crate::math::{Mat3, Real, Vec3};

/// Part of a vertex's squared mean distance to its parents below which their spread along an axis is none.
const FLAT: Real = 1e-3;

/// Turns what each parent of a vertex weighs by its distance (any unit) into its weight (dimensionless, sum 1), and
/// gives how far the vertex is from the weighted mean of the parents, relative to their mean distance; infinity where
/// there are none. `place` (m) is where vertices are at rest.
///
/// `w = b (1 + β·(r − m))` with b what was given over its sum, r the displacements to the parents, m their mean
/// weighted by b, and `cov β = −m` as far as the parents spread. No weight is below `least · b`, with `least` at most
/// 0.
pub(super) fn linear_weights(
    vertex: usize,
    parents: &mut [(u32, Real)],
    place: &[Vec3],
    least: Real,
) -> Real {
    let away = |parent: u32| place[parent as usize] - place[vertex];
    let count = parents.len() as Real;
    let distances = parents.iter().map(|&(p, _)| away(p).norm());
    let nearest = distances.clone().fold(Real::INFINITY, Real::min);
    if parents.is_empty() {
        return Real::INFINITY;
    }
    if nearest == 0.0 {
        // Nothing to measure by: the places coincide.
        parents.iter_mut().for_each(|(_, w)| *w = 1.0 / count);
        return 0.0;
    }
    let distance = distances.sum::<Real>() / count;
    let total: Real = parents.iter().map(|(_, b)| b).sum();
    parents.iter_mut().for_each(|(_, b)| *b /= total);
    let mean: Vec3 = parents.iter().map(|&(p, b)| away(p) * b).sum();
    let mut covariance = Mat3::zeros();
    for &(p, b) in parents.iter() {
        let r = away(p) - mean;
        covariance += r * r.transpose() * b;
    }
    let eigen = covariance.symmetric_eigen();
    let mut beta = Vec3::zeros();
    for axis in 0..3 {
        if eigen.eigenvalues[axis] > FLAT * distance * distance {
            let n: Vec3 = eigen.eigenvectors.column(axis).into();
            beta -= n * (n.dot(&mean) / eigen.eigenvalues[axis]);
        }
    }
    let slope = |p: u32| beta.dot(&(away(p) - mean));
    let slopes = parents.iter().map(|&(p, _)| slope(p));
    let steepest = slopes.fold(0.0, Real::min);
    let part = if steepest < least - 1.0 {
        (least - 1.0) / steepest
    } else {
        1.0
    };
    for (p, w) in parents.iter_mut() {
        *w *= (1.0 + part * slope(*p)).max(least);
    }
    let aside: Vec3 = parents.iter().map(|&(p, w)| away(p) * w).sum();
    aside.norm() / distance
}

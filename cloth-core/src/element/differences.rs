//! The geometric stiffness of any constraint, by finite differences of its gradients.

use super::{Constraint, Convexity};
use crate::math::{Blocks, Mat3, Real, Vec3};

/// `−Σ λ ∂²C` by central differences over `ε^⅓` of the size of the element; zero where they overflow, and for an
/// element of no size.
pub(super) fn geometric_stiffness<const N: usize, C: Constraint<N>>(
    constraint: &C,
    x: &[Vec3; N],
    multipliers: &[Real],
    convexity: Convexity,
) -> Blocks<N> {
    let mut blocks = [[Mat3::zeros(); N]; N];
    let size = x.iter().map(|p| (p - x[0]).amax()).fold(0.0, Real::max);
    if convexity == Convexity::GaussNewton || size == 0.0 || multipliers.iter().all(|&l| l == 0.0) {
        return blocks;
    }
    let step = size * Real::EPSILON.cbrt();
    for j in 0..N {
        for axis in 0..3 {
            let at = |shift: Real| {
                let mut moved = *x;
                moved[j][axis] += shift;
                (constraint.rows(&moved), moved[j][axis])
            };
            let ((above, high), (below, low)) = (at(step), at(-step));
            let rows = above.as_ref().iter().zip(below.as_ref());
            for ((above, below), multiplier) in rows.zip(multipliers) {
                for i in 0..N {
                    let slope = (above.gradient[i] - below.gradient[i]) / (high - low);
                    let mut column = blocks[i][j].column_mut(axis);
                    column -= slope * *multiplier;
                }
            }
        }
    }
    let finite = |block: &Mat3| block.iter().all(|number| number.is_finite());
    if !blocks.iter().flatten().all(finite) {
        return [[Mat3::zeros(); N]; N];
    }
    symmetrize(&mut blocks);
    match convexity {
        Convexity::Clamp => filter_eigenvalues(blocks, |value| value.max(0.0)),
        Convexity::Abs => filter_eigenvalues(blocks, Real::abs),
        Convexity::Exact | Convexity::GaussNewton => blocks,
    }
}

fn symmetrize<const N: usize>(blocks: &mut Blocks<N>) {
    for i in 0..N {
        for j in 0..=i {
            let mean = (blocks[i][j] + blocks[j][i].transpose()) * 0.5;
            blocks[i][j] = mean;
            blocks[j][i] = mean.transpose();
        }
    }
}

/// Sweeps of Jacobi's method; it squares the error of each once it is near.
const MOST_SWEEPS: usize = 30;

/// The matrix with its eigenvalues replaced, by Jacobi's rotations: slow and exact, and it allocates for no N.
/// [`make_semidefinite`](crate::math::make_semidefinite) does with nine dimensions for the elements
/// it fits: four vertices, and an energy that no translation changes.
fn filter_eigenvalues<const N: usize>(mut a: Blocks<N>, map: impl Fn(Real) -> Real) -> Blocks<N> {
    let mut vectors: Blocks<N> = [[Mat3::zeros(); N]; N];
    for i in 0..N {
        vectors[i][i] = Mat3::identity();
    }
    let n = 3 * N;
    let get = |m: &Blocks<N>, r: usize, c: usize| m[r / 3][c / 3][(r % 3, c % 3)];
    let whole: Real = a.iter().flatten().map(Mat3::norm_squared).sum();
    for _ in 0..MOST_SWEEPS {
        let mut beside = 0.0;
        for p in 0..n {
            for q in p + 1..n {
                let entry = get(&a, p, q);
                beside += entry * entry;
                if entry == 0.0 {
                    continue;
                }
                let theta = (get(&a, q, q) - get(&a, p, p)) / (2.0 * entry);
                let t = 1.0_f64.copysign(theta) / (theta.abs() + theta.hypot(1.0));
                let c = 1.0 / t.hypot(1.0);
                let s = t * c;
                let turn = |m: &mut Blocks<N>, at: fn(usize, usize) -> (usize, usize), k: usize| {
                    let ((rp, cp), (rq, cq)) = (at(p, k), at(q, k));
                    let (x, y) = (get(m, rp, cp), get(m, rq, cq));
                    m[rp / 3][cp / 3][(rp % 3, cp % 3)] = c * x - s * y;
                    m[rq / 3][cq / 3][(rq % 3, cq % 3)] = s * x + c * y;
                };
                for k in 0..n {
                    turn(&mut a, |i, k| (k, i), k);
                }
                for k in 0..n {
                    turn(&mut a, |i, k| (i, k), k);
                    turn(&mut vectors, |i, k| (k, i), k);
                }
            }
        }
        if beside <= 1e-30 * whole {
            break;
        }
    }
    let mut out = [[Mat3::zeros(); N]; N];
    for r in 0..n {
        for c in 0..=r {
            let mut sum = 0.0;
            for k in 0..n {
                sum += map(get(&a, k, k)) * get(&vectors, r, k) * get(&vectors, c, k);
            }
            out[r / 3][c / 3][(r % 3, c % 3)] = sum;
            out[c / 3][r / 3][(c % 3, r % 3)] = sum;
        }
    }
    out
}

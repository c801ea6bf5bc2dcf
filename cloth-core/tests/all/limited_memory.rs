//! What quasi-Newton methods remember.

use cloth_core::math::{Real, Vec3};
use cloth_core::method::limited_memory::{LimitedMemory, Stored};

/// A quadratic with the Hessian `diag(1 … n)` and coupled neighbours, descended along exact lengths with a diagonal
/// first inverse: the directions are those of the textbook's two loops with the same pairs in double precision.
#[test]
fn directions_are_those_of_the_two_loops() {
    follows_the_two_loops::<f32>(1e-5);
    follows_the_two_loops::<f64>(1e-13);
}

fn follows_the_two_loops<T: Stored>(tolerance: Real) {
    const N: usize = 70;
    const KEPT: usize = 3;
    let hessian = |x: &[Vec3], out: &mut [Vec3]| {
        for v in 0..N {
            let left = if v > 0 { x[v - 1] } else { Vec3::zeros() };
            let right = if v + 1 < N { x[v + 1] } else { Vec3::zeros() };
            out[v] = x[v] * (3.0 + v as Real) - left - right;
        }
    };
    let first = |r: &[Vec3], z: &mut [Vec3]| {
        let scaled = r.iter().enumerate().map(|(v, r)| r / (1.0 + v as Real));
        z.iter_mut().zip(scaled).for_each(|(z, r)| *z = r);
    };
    let product = |a: &[Vec3], b: &[Vec3]| -> Real { a.iter().zip(b).map(|(a, b)| a.dot(b)).sum() };
    let zeros = || vec![Vec3::zeros(); N];
    let mut memory = LimitedMemory::<T>::new(N, KEPT);
    let mut pairs: Vec<(Vec<Vec3>, Vec<Vec3>)> = Vec::new();
    let mut gradient: Vec<Vec3> = (0..N)
        .map(|v| Vec3::new((v as Real).sin(), 1.0, (0.3 * v as Real).cos()))
        .collect();
    for _ in 0..8 {
        let mut expected = gradient.clone();
        let mut alphas = Vec::new();
        for (s, y) in pairs.iter().rev() {
            let alpha = product(s, &expected) / product(s, y);
            expected
                .iter_mut()
                .zip(y)
                .for_each(|(q, y)| *q -= y * alpha);
            alphas.push(alpha);
        }
        let mut z = zeros();
        first(&expected, &mut z);
        for ((s, y), alpha) in pairs.iter().zip(alphas.into_iter().rev()) {
            let beta = product(y, &z) / product(s, y);
            z.iter_mut()
                .zip(s)
                .for_each(|(z, s)| *z += s * (alpha - beta));
        }

        let (mut work, mut direction) = (zeros(), zeros());
        let slope = memory.direction(&gradient, &mut work, &mut direction, first);
        let apart = direction.iter().zip(&z).map(|(p, z)| (p + z).amax());
        let largest = z.iter().map(Vec3::amax).fold(0.0, Real::max);
        let error = apart.fold(0.0, Real::max) / largest;
        assert!(error < tolerance, "{error:e}");
        assert!((slope - product(&direction, &gradient)).abs() < 1e-12 * slope.abs());

        let mut bent = zeros();
        hessian(&direction, &mut bent);
        let length = -slope / product(&direction, &bent);
        let before = gradient.clone();
        gradient
            .iter_mut()
            .zip(&bent)
            .for_each(|(g, h)| *g += h * length);
        memory.push(length, slope, &direction, &before, &gradient);
        let step = direction.iter().map(|p| p * length).collect();
        let change = gradient.iter().zip(&before).map(|(a, b)| a - b).collect();
        pairs.push((step, change));
        if pairs.len() > KEPT {
            pairs.remove(0);
        }
    }
}

/// A pair along which the gradient falls would make the inverse Hessian indefinite.
#[test]
fn pairs_of_negative_curvature_are_left_out() {
    let mut memory = LimitedMemory::<f32>::new(1, 2);
    memory.push(1.0, -1.0, &[Vec3::x()], &[-Vec3::x()], &[-2.0 * Vec3::x()]);
    assert!(memory.is_empty());
    memory.push(1.0, -1.0, &[Vec3::x()], &[-Vec3::x()], &[Vec3::zeros()]);
    assert!(!memory.is_empty());
}

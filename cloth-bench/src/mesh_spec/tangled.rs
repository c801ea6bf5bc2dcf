//! Garments that start tangled.

use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::generate::{Diagonals, grid, join, tube};
use cloth_core::mesh::{MeshError, TriMesh};

/// A sheet of n × n vertices around the origin (m), moved.
fn sheet(n: usize, size: Real, place: impl Fn(Vec3) -> Vec3) -> Result<TriMesh, MeshError> {
    let flat = grid(n, n, size, size, Diagonals::Alternating)?;
    let middle = Vec3::new(0.5, 0.5, 0.0) * size;
    moved(&flat, |x| place(x - middle))
}

fn moved(mesh: &TriMesh, place: impl Fn(Vec3) -> Vec3) -> Result<TriMesh, MeshError> {
    let positions = mesh.positions().iter().map(|&x| place(x)).collect();
    mesh.moved(positions)
}

/// Two level layers `gap` (m) apart, the middle of the upper one pushed through the lower one by `depth` (m).
pub(crate) fn layers(depth: Real, gap: Real) -> Result<TriMesh, MeshError> {
    let lower = sheet(25, 0.48, |x| x + Vec3::new(0.0031, 0.0047, 0.0))?;
    let pushed = |x: Vec3| if x.xy().amax() < 0.13 { -depth } else { gap };
    let upper = sheet(25, 0.48, |x| x + Vec3::z() * pushed(x))?;
    join(&[lower, upper])
}

/// A sleeve through the wall of a torso, by `depth` (m): the end is inside, where the torso is a tube of 0.2 m radius.
pub(crate) fn sleeve(depth: Real) -> Result<TriMesh, MeshError> {
    let torso = tube(60, 30, 0.2, 0.5)?;
    let [low, high] = [0, 2].map(|k| {
        let along = |x: &Vec3| x.z;
        let all = torso.positions().iter().map(along);
        if k == 0 {
            all.fold(Real::INFINITY, Real::min)
        } else {
            all.fold(Real::NEG_INFINITY, Real::max)
        }
    });
    let middle = 0.5 * (low + high);
    let arm = tube(31, 20, 0.06, 0.3)?;
    let first = arm
        .positions()
        .iter()
        .map(|x| x.z)
        .fold(Real::INFINITY, Real::min);
    let arm = moved(&arm, |x| {
        Vec3::new(
            0.2 - depth + (x.z - first),
            x.x + 0.0013,
            middle + x.y + 0.0021,
        )
    })?;
    join(&[torso, arm])
}

/// A lining in a sleeve, turned so that it comes out of it at both ends.
pub(crate) fn lining(angle: Real) -> Result<TriMesh, MeshError> {
    let outer = tube(40, 24, 0.06, 0.3)?;
    let inner = tube(37, 22, 0.055, 0.28)?;
    let middle =
        |mesh: &TriMesh| mesh.positions().iter().sum::<Vec3>() / mesh.vertex_count() as Real;
    let (c, d) = (middle(&outer), middle(&inner));
    let (sin, cos) = angle.sin_cos();
    let inner = moved(&inner, |x| {
        let x = x - d;
        c + Vec3::new(x.x * cos + x.z * sin, x.y, x.z * cos - x.x * sin)
    })?;
    join(&[outer, inner])
}

/// A dress of any size and its lining, 4 mm inside of it, `around` vertices around and `along` cells along each. The
/// lining is pushed through the dress by up to 6 mm in spots of 3 cm on a spiral, and the dress has no other holes.
pub(crate) fn dress(around: usize, along: usize) -> Result<TriMesh, MeshError> {
    const LENGTH: Real = 1.0;
    const SPOTS: u32 = 40;
    let straight = tube(around, along, 1.0, LENGTH)?;
    // A wide hem below, a waist above.
    let layer = |gap: Real, push: Real| {
        moved(&straight, |x| {
            let angle = x.y.atan2(x.x);
            let radius = 0.15 + 0.2 * (1.0 - x.z / LENGTH).powi(2);
            let spot = |k: u32| {
                // The ends, where it may be held, stay clear.
                let along = 0.04 + 0.92 * Real::from(k) / Real::from(SPOTS);
                let turned = (angle - 2.4 * Real::from(k)).rem_euclid(std::f64::consts::TAU);
                let aside = turned.min(std::f64::consts::TAU - turned) * radius;
                let squared = aside.powi(2) + (x.z - along * LENGTH).powi(2);
                (-squared / (2.0 * 0.015_f64.powi(2))).exp()
            };
            let pushed = (0..SPOTS).map(spot).fold(0.0, Real::max);
            let radius = radius - gap + push * pushed;
            Vec3::new(radius * angle.cos(), radius * angle.sin(), x.z)
        })
    };
    join(&[layer(0.0, 0.0)?, layer(4e-3, 0.01)?])
}

/// A pocket on a sheet, whose lower and side borders lie `lift` (m) above it, vertex on vertex, and which goes through
/// it in waves.
pub(crate) fn pocket(lift: Real) -> Result<TriMesh, MeshError> {
    let body = sheet(31, 0.3, |x| x)?;
    let side = 0.06;
    let pocket = sheet(13, 2.0 * side, |x| {
        let is_sewn = x.x.abs() > side - 1e-9 || x.y < -side + 1e-9;
        let wave = 0.01 * (x.x * 60.0).sin() + 0.004;
        let inner = Vec3::new(0.0007, 0.0004, wave);
        x + if is_sewn { Vec3::z() * lift } else { inner }
    })?;
    join(&[body, pocket])
}

/// Two panels whose borders lie on each other, vertex on vertex, without being joined; a third one stands on the seam.
pub(crate) fn seams() -> Result<TriMesh, MeshError> {
    let half = |x: Vec3| x + Vec3::x() * 0.1;
    let right = sheet(11, 0.2, half)?;
    let left = sheet(11, 0.2, |x| x - Vec3::x() * 0.1)?;
    let standing = sheet(11, 0.2, |x| Vec3::new(0.0, x.y, x.x + 0.1))?;
    join(&[right, left, standing])
}

/// A panel rolled into a tube whose two borders lie on each other.
pub(crate) fn rolled() -> Result<TriMesh, MeshError> {
    let flat = grid(33, 9, 0.4, 0.1, Diagonals::Alternating)?;
    let around = std::f64::consts::TAU / 0.4;
    let radius = 1.0 / around;
    let last = 0.4 - 1e-12;
    moved(&flat, |x| {
        let angle = if x.x > last { 0.0 } else { x.x * around };
        Vec3::new(radius * angle.cos(), radius * angle.sin(), x.y)
    })
}

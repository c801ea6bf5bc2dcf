//! Positions in single precision relative to an origin, and their changes added back in double precision.

use cloth_core::math::{Real, Vec3};
use wide::f32x4;

/// Padding vertices: the ends of the springs that fill up a pack, at most three.
pub(super) const PADDING: usize = 6;

/// Relative positions and inverse masses, and their values when they were last synchronised with double precision.
#[derive(Debug)]
pub(super) struct Positions {
    /// (y, w): m and 1/kg, one per vertex, then the padding.
    now: Vec<f32x4>,
    before: Vec<f32x4>,
    origin: Vec3,
}

impl Positions {
    pub(super) fn new(vertex_count: usize) -> Self {
        // Apart from one another, and prescribed.
        let empty = |i| f32x4::new([i as f32, 0.0, 0.0, 0.0]);
        let mut now = vec![f32x4::splat(0.0); vertex_count];
        now.extend((0..PADDING).map(empty));
        Self {
            before: now.clone(),
            now,
            origin: Vec3::zeros(),
        }
    }

    /// Sets the origin to the centre of the bounding box of `x` (m), and returns it.
    pub(super) fn center(&mut self, x: &[Vec3]) -> Vec3 {
        if let Some(&first) = x.first() {
            let (low, high) = x
                .iter()
                .fold((first, first), |(low, high), x| (low.inf(x), high.sup(x)));
            self.origin = low + (high - low) * 0.5;
        }
        self.origin
    }

    /// Rounds `x` (m) with the inverse masses `w` (1/kg).
    pub(super) fn round(&mut self, x: &[Vec3], w: &[Real]) {
        for ((now, x), &w) in self.now.iter_mut().zip(x).zip(w) {
            let y = x - self.origin;
            *now = f32x4::new([y.x as f32, y.y as f32, y.z as f32, w as f32]);
        }
        self.before.copy_from_slice(&self.now);
    }

    pub(super) fn as_slice(&self) -> &[f32x4] {
        &self.now
    }

    pub(super) fn as_mut_slice(&mut self) -> &mut [f32x4] {
        &mut self.now
    }

    /// Adds to `x` (m) the change since the last synchronisation.
    pub(super) fn add_change(&mut self, x: &mut [Vec3]) {
        let pairs = self.now.iter().zip(&mut self.before);
        for ((now, before), x) in pairs.zip(x) {
            let [dx, dy, dz, _] = (*now - *before).to_array().map(Real::from);
            *x += Vec3::new(dx, dy, dz);
            *before = *now;
        }
    }
}

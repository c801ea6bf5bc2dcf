//! Buffers for what only reads contact.

use cloth_core::math::Vec3;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// A place (m) with its gradient (N).
#[derive(Debug)]
pub(super) struct Shared(Mutex<[Vec<Vec3>; 2]>);

impl Shared {
    pub(super) fn new(buffers: [Vec<Vec3>; 2]) -> Self {
        Self(Mutex::new(buffers))
    }

    pub(super) fn lock(&self) -> MutexGuard<'_, [Vec<Vec3>; 2]> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The same with the cloth at `x` (m).
    pub(super) fn at(&self, x: &[Vec3]) -> MutexGuard<'_, [Vec<Vec3>; 2]> {
        let mut buffers = self.lock();
        buffers[0][..x.len()].copy_from_slice(x);
        buffers
    }
}

impl Clone for Shared {
    fn clone(&self) -> Self {
        Self(Mutex::new(self.lock().clone()))
    }
}

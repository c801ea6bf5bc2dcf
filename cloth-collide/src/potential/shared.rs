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
}

impl Clone for Shared {
    fn clone(&self) -> Self {
        Self(Mutex::new(self.lock().clone()))
    }
}

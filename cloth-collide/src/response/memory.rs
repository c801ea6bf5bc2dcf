//! Which contacts pushed in the last step, and how hard: a good first guess for this one.

use super::row::Row;
use cloth_core::math::{Real, Vec3};

/// A contact at the end of a step.
#[derive(Clone, Copy, Debug)]
struct Kept {
    key: u64,
    /// Normal force (N).
    pressure: Real,
    /// Friction (N).
    friction: Vec3,
}

/// The contacts of the last step.
#[derive(Clone, Debug, Default)]
pub(super) struct Memory {
    /// By rising key, each once.
    kept: Vec<Kept>,
}

impl Memory {
    /// Replaces what is remembered by the `rows` of a step of `dt` (s); their multipliers are impulses (N·s).
    pub(super) fn replace(&mut self, rows: &[Row], dt: Real) {
        self.kept.clear();
        for row in rows {
            let pressure = row.normal.dot(&row.multiplier);
            if let Some(key) = row.key.filter(|_| pressure > 0.0) {
                self.kept.push(Kept {
                    key,
                    pressure: pressure / dt,
                    friction: (row.multiplier - row.normal * pressure) / dt,
                });
            }
        }
        // Rows come in the order in which they were found. A key is there once, but for obstacles, and there any will do.
        self.kept.sort_unstable_by_key(|kept| kept.key);
        self.kept.dedup_by_key(|kept| kept.key);
    }

    /// The row, with the multiplier (kg·m) that its contact had, if it had one.
    pub(super) fn recall(&self, row: &Row, dt: Real) -> Option<Row> {
        let key = row.key?;
        let place = self.kept.binary_search_by_key(&key, |kept| kept.key);
        let kept = self.kept[place.ok()?];
        let across = kept.friction - row.normal * row.normal.dot(&kept.friction);
        Some(Row {
            multiplier: (row.normal * kept.pressure + across) * (dt * dt),
            ..*row
        })
    }
}

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
    /// Steps since it pushed.
    idle: u32,
}

/// A contact is remembered for so many steps after it last pushed. In a pile at rest those that share a load take turns, and the set of contacts that is solved for would change all the time.
const MOST_IDLE: u32 = 4;

/// The contacts of the last step.
#[derive(Clone, Debug, Default)]
pub(super) struct Memory {
    /// By rising key, each once.
    kept: Vec<Kept>,
}

impl Memory {
    /// Replaces what is remembered by the `rows` of a step of `dt` (s); their multipliers are impulses (N·s).
    pub(super) fn replace(&mut self, rows: &[Row], dt: Real) {
        self.kept.retain_mut(|old| {
            old.pressure = 0.0;
            old.friction = Vec3::zeros();
            old.idle += 1;
            old.idle <= MOST_IDLE
        });
        let known = self.kept.len();
        for row in rows {
            let pressure = row.normal.dot(&row.multiplier);
            let Some(key) = row.key.filter(|_| pressure > 0.0) else {
                continue;
            };
            let new = Kept {
                key,
                pressure: pressure / dt,
                friction: (row.multiplier - row.normal * pressure) / dt,
                idle: 0,
            };
            match self.kept[..known].binary_search_by_key(&key, |old| old.key) {
                Ok(place) => self.kept[place] = new,
                Err(_) => self.kept.push(new),
            }
        }
        // Rows come in the order in which they were found. A key is there once, but for obstacles, and there any will do.
        self.kept.sort_unstable_by_key(|kept| kept.key);
        self.kept.dedup_by_key(|kept| kept.key);
    }

    fn place(&self, key: u64) -> Option<usize> {
        self.kept.binary_search_by_key(&key, |kept| kept.key).ok()
    }

    /// Whether the contact with this key pushed.
    pub(super) fn knows(&self, key: u64) -> bool {
        self.place(key).is_some()
    }

    /// The row, with the multiplier (kg·m) that its contact had, if it had one.
    pub(super) fn recall(&self, row: &Row, dt: Real) -> Option<Row> {
        let kept = self.kept[self.place(row.key?)?];
        let across = kept.friction - row.normal * row.normal.dot(&kept.friction);
        Some(Row {
            multiplier: (row.normal * kept.pressure + across) * (dt * dt),
            ..*row
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::row::RowMaker;
    use super::*;
    use crate::ccd::QueryKind;
    use crate::response::pair::nearest;

    /// A contact that has stopped pushing is known for a few steps more, with no force; one that pushes, with its force.
    #[test]
    fn contact_is_remembered_a_few_steps_after_it_pushed() {
        let corner = |x, y| Vec3::new(x, y, 0.0);
        let from = [
            corner(0.3, 0.3) + Vec3::z(),
            corner(0.0, 0.0),
            corner(1.0, 0.0),
            corner(0.0, 1.0),
        ];
        let make = RowMaker {
            from: &from,
            inverse_mass: &[1.0; 4],
            dt: 0.1,
            friction: 0.0,
        };
        let at = nearest(QueryKind::VertexTriangle, &from);
        let mut row = make.cloth([0, 1, 2, 3], &at, 1.0, 1e-3).unwrap();
        (row.key, row.multiplier) = (Some(7), Vec3::z() * 3.0);
        let mut memory = Memory::default();
        memory.replace(&[row], 0.1);
        let pressure = |memory: &Memory| memory.recall(&row, 0.1).map(|row| row.multiplier.z);
        // 3 N·s in 0.1 s are 30 N, and those in 0.1 s another 0.3 kg·m.
        assert!((pressure(&memory).unwrap() - 0.3).abs() < 1e-15);
        for _ in 0..MOST_IDLE {
            memory.replace(&[], 0.1);
            assert_eq!(pressure(&memory), Some(0.0));
        }
        memory.replace(&[], 0.1);
        assert!(!memory.knows(7));
    }
}

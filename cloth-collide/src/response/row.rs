//! One contact as one inequality, and its impulse.

use super::pair::Nearest;
use crate::obstacle::ObstacleContact;
use cloth_core::math::{Real, Vec3};

/// A contact of up to four vertices: with p = Σ wᵢ xᵢ,
///
/// n · p ≥ offset,  and friction holds p at `anchor` across n.
///
/// The same row serves positions (m), multipliers in kg·m, and velocities (m/s), multipliers in N·s.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    /// What the contact is remembered by; nothing if it is not.
    pub(super) key: Option<u64>,
    pub(super) vertices: [u32; 4],
    /// wᵢ (dimensionless).
    pub(super) weights: [Real; 4],
    /// n, of unit length.
    pub(super) normal: Vec3,
    pub(super) offset: Real,
    /// By how much n · p may miss the offset.
    pub(super) tolerance: Real,
    pub(super) anchor: Vec3,
    /// How far the surface moves in the step (m); zero for cloth.
    pub(super) surface: Vec3,
    pub(super) friction: Real,
    pub(super) restitution: Real,
    pub(super) is_obstacle: bool,
    /// Whether the nearest point of a piece of cloth is on its boundary.
    pub(super) is_at_boundary: bool,
    /// 1 / Σ wᵢ²/mᵢ (kg).
    pub(super) mass: Real,
    /// λ: along n what keeps apart, across n friction.
    pub(super) multiplier: Vec3,
    /// How the last sweep has changed λ.
    pub(super) change: Vec3,
    /// The direction in which λ is searched for.
    pub(super) direction: Vec3,
}

impl Row {
    /// Σ wᵢ xᵢ.
    pub(super) fn point(&self, x: &[Vec3]) -> Vec3 {
        let [a, b, c, d] = self.vertices.map(|v| &x[v as usize]);
        let [wa, wb, wc, wd] = self.weights;
        a * wa + b * wb + c * wc + d * wd
    }

    /// Gives the impulse `impulse` to the vertices.
    pub(super) fn apply(&self, impulse: Vec3, inverse_mass: &[Real], x: &mut [Vec3]) {
        for (&v, &weight) in self.vertices.iter().zip(&self.weights) {
            if weight != 0.0 {
                x[v as usize] += impulse * (weight * inverse_mass[v as usize]);
            }
        }
    }

    /// n · p − offset: negative if violated.
    pub(super) fn excess(&self, x: &[Vec3]) -> Real {
        self.normal.dot(&self.point(x)) - self.offset
    }
}

/// What all rows of a step are made with.
#[derive(Clone, Copy, Debug)]
pub(super) struct RowMaker<'a> {
    pub(super) from: &'a [Vec3],
    pub(super) inverse_mass: &'a [Real],
    pub(super) dt: Real,
    pub(super) friction: Real,
}

impl RowMaker<'_> {
    fn finish(&self, mut row: Row) -> Option<Row> {
        let share = |(&v, w): (&u32, &Real)| w * w * self.inverse_mass[v as usize];
        let inverse: Real = row.vertices.iter().zip(&row.weights).map(share).sum();
        row.mass = 1.0 / inverse;
        row.anchor = row.point(self.from) + row.surface;
        // Nothing moves prescribed vertices.
        row.mass.is_finite().then_some(row)
    }

    /// Keeps the nearest points of two pieces of cloth `offset` (m) apart, to `tolerance` (m); nothing if no vertex can be moved.
    pub(super) fn cloth(
        &self,
        vertices: [u32; 4],
        at: &Nearest,
        offset: Real,
        tolerance: Real,
    ) -> Option<Row> {
        self.finish(Row {
            key: None,
            vertices,
            weights: at.weights,
            normal: at.normal,
            offset,
            tolerance,
            anchor: Vec3::zeros(),
            surface: Vec3::zeros(),
            friction: self.friction,
            restitution: 0.0,
            is_obstacle: false,
            is_at_boundary: at.is_at_boundary(),
            mass: 0.0,
            multiplier: Vec3::zeros(),
            change: Vec3::zeros(),
            direction: Vec3::zeros(),
        })
    }

    /// Keeps a vertex out of an obstacle, to `tolerance` (m); nothing if it is prescribed.
    pub(super) fn obstacle(
        &self,
        contact: &ObstacleContact,
        restitution: Real,
        tolerance: Real,
    ) -> Option<Row> {
        self.finish(Row {
            key: None,
            vertices: [contact.vertex; 4],
            weights: [1.0, 0.0, 0.0, 0.0],
            normal: contact.normal,
            offset: contact.offset,
            tolerance,
            anchor: Vec3::zeros(),
            surface: contact.surface_velocity * self.dt,
            friction: contact.friction,
            restitution,
            is_obstacle: true,
            is_at_boundary: false,
            mass: 0.0,
            multiplier: Vec3::zeros(),
            change: Vec3::zeros(),
            direction: Vec3::zeros(),
        })
    }
}

/// Turns rows for the positions into rows for the velocities, and leaves out those that have not pushed. `velocities` (m/s) are those before the impulses.
pub(super) fn into_velocity_rows(rows: &mut Vec<Row>, velocities: &[Vec3], dt: Real) {
    rows.retain(|row| row.normal.dot(&row.multiplier) > 0.0);
    for row in rows {
        let surface = row.surface / dt;
        let approach = row.normal.dot(&(row.point(velocities) - surface));
        row.offset = row.normal.dot(&surface) - row.restitution * approach.min(0.0);
        row.anchor = surface;
        row.tolerance /= dt;
        // What has kept the positions apart is a good first guess.
        row.multiplier /= dt;
    }
}

//! All rows of all families in flat arrays: structure at build, numbers at every evaluation.

use crate::update::XpbdUpdate;
use cloth_core::element::{Constraint, Convexity, RowArray};
use cloth_core::math::{Real, Vec3, gather};
use cloth_core::method::block_matrix::{BlockMatrix, BlockPattern, PatternBuilder};
use cloth_core::method::family::check_vertices;
use cloth_core::step::BuildError;
use std::fmt::Debug;

/// C, J and k of every row. Row r has the entries `offsets[r]..offsets[r + 1]`.
#[derive(Clone, Debug, Default)]
pub(super) struct Rows {
    /// Start of each row in the entries, and the end of the last.
    pub(super) offsets: Vec<u32>,
    /// Vertex of each entry.
    pub(super) vertices: Vec<u32>,
    /// `∂C/∂x` of each entry (unit of C per m).
    pub(super) gradient: Vec<Vec3>,
    /// What the system is to bring to zero: `C` of each row. For a hard limit that its multiplier keeps active, the
    /// signed distance from that end of its range.
    pub(super) value: Vec<Real>,
    /// `C` of each row.
    pub(super) violation: Vec<Real>,
    /// `k` of each row.
    pub(super) stiffness: Vec<Real>,
    /// Whether each row has a dead zone.
    pub(super) is_limit: Vec<bool>,
}

impl Rows {
    /// Number of rows.
    pub(super) fn len(&self) -> usize {
        self.value.len()
    }

    /// α̃ of a row (unit of C² per kg m²).
    pub(super) fn scaled_compliance(&self, row: usize, update: XpbdUpdate) -> Real {
        let update = update.for_row(self.is_limit[row]);
        update.scaled_compliance(self.stiffness[row])
    }

    /// Entries of a row.
    #[inline]
    pub(super) fn entries(&self, row: usize) -> std::ops::Range<usize> {
        self.offsets[row] as usize..self.offsets[row + 1] as usize
    }
}

/// Elements of one type, type-erased.
pub(super) trait RowFamily: Debug + Send + Sync {
    /// Appends the structure of its rows.
    fn append(&self, rows: &mut Rows);
    /// Sets the elements to a time (s).
    fn set_time(&mut self, time: Real);
    /// Number of its rows.
    fn row_count(&self) -> usize;
    /// Writes C, J and k at `x` (m) to the rows from number `first` on.
    fn evaluate(&self, x: &[Vec3], first: usize, rows: &mut Rows);
    /// Decides for every row with a dead zone whether it is active: a soft one where C is beyond its range; a hard one
    /// by its multiplier, since C then ends exactly at the bound
    /// ([`DeadZoneRow`](cloth_core::element::DeadZoneRow)). An inactive row has no gradient, and its multiplier
    /// becomes zero; returns whether one was not zero before.
    fn activate(
        &self,
        x: &[Vec3],
        vertex_scale: &[Real],
        multipliers: &mut [Real],
        first: usize,
        rows: &mut Rows,
    ) -> bool;
    /// Adds the blocks that its geometric stiffness may have.
    fn add_pattern(&self, pattern: &mut PatternBuilder);
    /// Looks up their slots in the pattern.
    fn bind(&mut self, pattern: &BlockPattern);
    /// Adds `−Σ λ ∂²C`, made positive semi-definite, scaled by `scale[i] scale[j]`; `multipliers` are those of
    /// its rows.
    ///
    /// For a matrix that has a diagonal only, an upper bound: a positive semi-definite matrix of N × N blocks
    /// is at most N times its diagonal blocks.
    fn add_stiffness(
        &self,
        x: &[Vec3],
        multipliers: &[Real],
        scale: &[Real],
        diagonal_only: bool,
        out: &mut BlockMatrix,
    );
}

#[derive(Clone, Debug)]
struct Family<const N: usize, E> {
    elements: Vec<E>,
    /// Place of each block of the lower half of each element: `N (N + 1)/2` numbers an element.
    slots: Vec<u32>,
}

/// A boxed family of elements.
///
/// # Errors
/// [`BuildError::NoSuchVertex`], [`BuildError::RepeatedVertex`].
pub(super) fn family<const N: usize, E: Constraint<N>>(
    elements: Vec<E>,
    vertex_count: usize,
) -> Result<Box<dyn RowFamily>, BuildError> {
    check_vertices(&elements, vertex_count)?;
    Ok(Box::new(Family {
        elements,
        slots: Vec::new(),
    }))
}

impl<const N: usize, E: Constraint<N>> RowFamily for Family<N, E> {
    fn append(&self, rows: &mut Rows) {
        if rows.offsets.is_empty() {
            rows.offsets.push(0);
        }
        for element in &self.elements {
            let is_limit = element.dead_zone_rows(&[Vec3::zeros(); N]).is_some();
            for _ in 0..E::Rows::LEN {
                rows.is_limit.push(is_limit);
                rows.vertices.extend(element.vertices());
                rows.offsets.push(rows.vertices.len() as u32);
            }
        }
        rows.gradient.resize(rows.vertices.len(), Vec3::zeros());
        rows.value.resize(rows.offsets.len() - 1, 0.0);
        rows.violation.resize(rows.offsets.len() - 1, 0.0);
        rows.stiffness.resize(rows.offsets.len() - 1, 0.0);
    }

    fn set_time(&mut self, time: Real) {
        if E::CHANGES_WITH_TIME {
            self.elements.iter_mut().for_each(|e| e.set_time(time));
        }
    }

    fn row_count(&self) -> usize {
        self.elements.len() * E::Rows::LEN
    }

    fn evaluate(&self, x: &[Vec3], first: usize, rows: &mut Rows) {
        let mut r = first;
        for element in &self.elements {
            let all = element.rows(&gather(x, element.vertices()));
            for row in all.as_ref() {
                let start = rows.offsets[r] as usize;
                rows.gradient[start..start + N].copy_from_slice(&row.gradient);
                rows.value[r] = row.value;
                rows.stiffness[r] = row.stiffness;
                r += 1;
            }
        }
    }

    fn activate(
        &self,
        x: &[Vec3],
        vertex_scale: &[Real],
        multipliers: &mut [Real],
        first: usize,
        rows: &mut Rows,
    ) -> bool {
        let mut released = false;
        for (number, element) in self.elements.iter().enumerate() {
            let vertices = element.vertices();
            let Some(dead_zones) = element.dead_zone_rows(&gather(x, vertices)) else {
                continue;
            };
            let s = vertices.map(|v| vertex_scale[v as usize]);
            for (i, row) in dead_zones.as_ref().iter().enumerate() {
                let r = number * E::Rows::LEN + i;
                let (start, end) = (
                    rows.offsets[first + r] as usize,
                    rows.entries(first + r).end,
                );
                let gradient = &mut rows.gradient[start..end];
                if row.stiffness == Real::INFINITY {
                    let pairs = row.gradient.iter().zip(s);
                    let weight: Real = pairs.map(|(g, s)| (g * s).norm_squared()).sum();
                    if let Some(value) = row.acting_value(weight, multipliers[r]) {
                        gradient.copy_from_slice(&row.gradient);
                        rows.value[first + r] = value;
                        continue;
                    }
                    gradient.fill(Vec3::zeros());
                    rows.value[first + r] = 0.0;
                }
                if gradient.iter().all(|g| *g == Vec3::zeros()) {
                    released |= multipliers[r] != 0.0;
                    multipliers[r] = 0.0;
                }
            }
        }
        released
    }

    fn add_pattern(&self, pattern: &mut PatternBuilder) {
        pattern.add(&self.elements);
    }

    fn bind(&mut self, pattern: &BlockPattern) {
        for element in &self.elements {
            let vertices = element.vertices();
            for i in 0..N {
                for j in 0..=i {
                    let slot = pattern.slot(vertices[i], vertices[j]);
                    self.slots.push(slot.expect("made from these elements"));
                }
            }
        }
    }

    fn add_stiffness(
        &self,
        x: &[Vec3],
        multipliers: &[Real],
        scale: &[Real],
        diagonal_only: bool,
        out: &mut BlockMatrix,
    ) {
        let per_element = multipliers.chunks_exact(E::Rows::LEN);
        for (number, (element, multipliers)) in self.elements.iter().zip(per_element).enumerate() {
            let vertices = element.vertices();
            let s = vertices.map(|v| scale[v as usize]);
            let k =
                element.geometric_stiffness(&gather(x, vertices), multipliers, Convexity::Clamp);
            if diagonal_only {
                for i in 0..N {
                    let slot = out.pattern().row(vertices[i] as usize).end - 1;
                    out.blocks_mut()[slot] += k[i][i] * (N as Real * s[i] * s[i]);
                }
                continue;
            }
            let mut slots = self.slots[number * N * (N + 1) / 2..].iter();
            for i in 0..N {
                for j in 0..=i {
                    // The matrix keeps the block whose row is the larger vertex number.
                    let block = if vertices[i] >= vertices[j] {
                        &k[i][j]
                    } else {
                        &k[j][i]
                    };
                    let slot = *slots.next().expect("N (N + 1)/2 slots") as usize;
                    out.blocks_mut()[slot] += block * (s[i] * s[j]);
                }
            }
        }
    }
}

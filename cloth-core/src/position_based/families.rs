//! The elements of each kind, and the sweep over them.

use super::Sweep;
use crate::coloring::Colored;
use crate::element::{Constraint, Row, RowArray};
use crate::family::check_vertices;
use crate::math::{Real, Vec3, gather};
use crate::step::BuildError;
use std::fmt::Debug;

/// One row where a sweep meets it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RowAt {
    /// `C`, in the unit that the element documents.
    pub value: Real,
    /// `w̃ = Σᵢ wᵢ ‖∂C/∂xᵢ‖²` (unit of C² per kg m²): how easily the row moves. Zero if all its vertices are prescribed, or its gradient vanishes.
    pub weight: Real,
    /// `k` with the energy `½ k C²` (J).
    pub stiffness: Real,
}

/// What tells one position-based method from another: how far it goes along one row.
pub trait Rule: Debug + Send + Sync + 'static {
    /// What is remembered of a row from one visit to the next. It starts, and is forgotten, as the default.
    type Memory: Copy + Debug + Default + Send + Sync + 'static;

    /// Δλ (kg m² per unit of C): the vertices of the row will move by `wᵢ ∂C/∂xᵢ Δλ`.
    ///
    /// It has to be finite also where the weight is zero.
    fn multiplier(&self, row: RowAt, memory: &mut Self::Memory) -> Real;
}

/// The door of a family: one virtual call a sweep, none per element.
trait AnyFamily<R: Rule>: Debug + Send + Sync {
    fn sweep(&mut self, rule: &R, inverse_mass: &[Real], x: &mut [Vec3]);
    fn forget(&mut self);
    fn each_row(&self, inverse_mass: &[Real], x: &[Vec3], see: &mut dyn FnMut(RowAt, &R::Memory));
    fn remembered(&self, out: &mut Vec<R::Memory>);
}

/// Elements of one kind with their memory, one array of rows per element, in visiting order.
#[derive(Clone, Debug)]
struct Family<const N: usize, E, A> {
    elements: Colored<N, E>,
    memory: Vec<A>,
}

type Slot<const N: usize, E, R> =
    <<E as Constraint<N>>::Rows as RowArray<N>>::PerRow<<R as Rule>::Memory>;

impl<const N: usize, E: Constraint<N>, R: Rule> AnyFamily<R> for Family<N, E, Slot<N, E, R>> {
    fn sweep(&mut self, rule: &R, inverse_mass: &[Real], x: &mut [Vec3]) {
        self.elements
            .sweep(&mut self.memory, x, |element, memory, x| {
                let w = element.vertices().map(|v| inverse_mass[v as usize]);
                project(rule, element.rows(x).as_ref(), &w, memory.as_mut(), x);
            });
    }

    fn forget(&mut self) {
        self.memory.fill(E::Rows::per_row(R::Memory::default()));
    }

    fn each_row(&self, inverse_mass: &[Real], x: &[Vec3], see: &mut dyn FnMut(RowAt, &R::Memory)) {
        for (element, memory) in self.elements.elements().iter().zip(&self.memory) {
            let w = element.vertices().map(|v| inverse_mass[v as usize]);
            let rows = element.rows(&gather(x, element.vertices()));
            for (row, memory) in rows.as_ref().iter().zip(memory.as_ref()) {
                see(row_at(row, &w, row.value), memory);
            }
        }
    }

    fn remembered(&self, out: &mut Vec<R::Memory>) {
        out.clear();
        out.resize(self.memory.len() * E::Rows::LEN, R::Memory::default());
        for (&place, memory) in self.elements.input_index().iter().zip(&self.memory) {
            let place = place as usize * E::Rows::LEN;
            out[place..place + E::Rows::LEN].copy_from_slice(memory.as_ref());
        }
    }
}

/// Row after row of one element. All gradients are those at the start; the value of a later row is
/// updated to first order for what the earlier ones moved, which is exact for linear rows.
#[inline(always)]
fn project<const N: usize, R: Rule>(
    rule: &R,
    rows: &[Row<N>],
    w: &[Real; N],
    memory: &mut [R::Memory],
    x: &mut [Vec3; N],
) {
    let mut moved = [Vec3::zeros(); N];
    for (row, memory) in rows.iter().zip(memory) {
        let mut value = row.value;
        if rows.len() > 1 {
            for i in 0..N {
                value += row.gradient[i].dot(&moved[i]);
            }
        }
        let multiplier = rule.multiplier(row_at(row, w, value), memory);
        for i in 0..N {
            moved[i] += row.gradient[i] * (w[i] * multiplier);
        }
    }
    for i in 0..N {
        x[i] += moved[i];
    }
}

#[inline(always)]
fn row_at<const N: usize>(row: &Row<N>, w: &[Real; N], value: Real) -> RowAt {
    let mut weight = 0.0;
    for i in 0..N {
        weight += w[i] * row.gradient[i].norm_squared();
    }
    RowAt {
        value,
        weight,
        stiffness: row.stiffness,
    }
}

/// All constraints of a solver: families of elements with a memory per row.
#[derive(Debug)]
pub struct Families<R: Rule> {
    families: Vec<Box<dyn AnyFamily<R>>>,
}

impl<R: Rule> Families<R> {
    /// One Gauss–Seidel sweep: every element once, family after family. `inverse_mass` in 1/kg, `x` in m, one per vertex.
    ///
    /// # Panics
    /// If the lengths are not those that the families were built for.
    pub fn sweep(&mut self, rule: &R, inverse_mass: &[Real], x: &mut [Vec3]) {
        for family in &mut self.families {
            family.sweep(rule, inverse_mass, x);
        }
    }

    /// Sets all memory to the default.
    pub fn forget(&mut self) {
        for family in &mut self.families {
            family.forget();
        }
    }

    /// Shows every row at `x` (m) with its memory, without moving anything.
    ///
    /// # Panics
    /// If the lengths are not those that the families were built for.
    pub fn each_row(
        &self,
        inverse_mass: &[Real],
        x: &[Vec3],
        mut see: impl FnMut(RowAt, &R::Memory),
    ) {
        for family in &self.families {
            family.each_row(inverse_mass, x, &mut see);
        }
    }

    /// Writes the memory of the rows of one family to `out`: element after element in the order in which they were given, row after row.
    ///
    /// # Panics
    /// If there is no such family.
    pub fn remembered(&self, family: usize, out: &mut Vec<R::Memory>) {
        self.families[family].remembered(out);
    }
}

impl<R: Rule> Families<R> {
    /// No family yet.
    pub(super) fn none() -> Self {
        Self {
            families: Vec::new(),
        }
    }

    /// Adds a family to be visited after those that are there.
    ///
    /// # Errors
    /// [`BuildError::NoSuchVertex`] if an element names a vertex that does not exist.
    pub(super) fn add<const N: usize, E: Constraint<N>>(
        &mut self,
        elements: &[E],
        vertex_count: usize,
        sweep: Sweep,
    ) -> Result<(), BuildError> {
        check_vertices(elements, vertex_count)?;
        let memory = vec![E::Rows::per_row(R::Memory::default()); elements.len()];
        let elements = match sweep {
            Sweep::Sequential => Colored::in_input_order(elements, vertex_count),
            Sweep::Colored => Colored::new(elements, vertex_count),
        };
        self.families.push(Box::new(Family { elements, memory }));
        Ok(())
    }
}

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

    /// The softness and the residual of a row, for a method whose Δλ solves `(w̃ + softness) Δλ = −residual`; `None` where nothing could change it.
    ///
    /// The rows of one element are then solved together, with the products of their gradients. `None` for all rows, the default, has them solved one after another.
    #[inline]
    fn equation(&self, row: RowAt, memory: &Self::Memory) -> Option<RowEquation> {
        let _ = (row, memory);
        None
    }

    /// Remembers that a row solved together with others got the multiplier `change` (kg m² per unit of C).
    #[inline]
    fn remember(&self, change: Real, memory: &mut Self::Memory) {
        let _ = (change, memory);
    }
}

/// One row of the small system of an element; see [`Rule::equation`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RowEquation {
    /// What Δλ is to bring to zero (unit of C).
    pub residual: Real,
    /// What stands beside w̃ on the diagonal (unit of C² per kg m²), not negative.
    pub softness: Real,
}

/// One row as it is read out: where it stands, whom it acts on.
#[derive(Clone, Copy, Debug)]
pub struct RowView<'a, M> {
    /// Number of the row in its family: element after element in the order in which they were given, row after row.
    pub index: usize,
    /// Its numbers.
    pub row: RowAt,
    /// The vertices of its element.
    pub vertices: &'a [u32],
    /// `∂C/∂x` (unit of C per m), one per vertex of the element.
    pub gradient: &'a [Vec3],
    /// What is remembered of it.
    pub memory: &'a M,
}

/// The door of a family: one virtual call a sweep, none per element.
trait AnyFamily<R: Rule>: Debug + Send + Sync {
    fn sweep(&mut self, rule: &R, inverse_mass: &[Real], x: &mut [Vec3]);
    fn forget(&mut self);
    fn each_row(&self, inverse_mass: &[Real], x: &[Vec3], see: &mut dyn FnMut(RowAt, &R::Memory));
    fn remembered(&self, out: &mut Vec<R::Memory>);
    fn set(&mut self, inverse_mass: &[Real], x: &[Vec3], memory: &dyn Fn(RowAt) -> R::Memory);
    fn inspect(
        &self,
        inverse_mass: &[Real],
        x: &[Vec3],
        see: &mut dyn FnMut(RowView<'_, R::Memory>),
    );
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
                project::<N, E, R>(rule, &element.rows(x), &w, memory.as_mut(), x);
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

    fn set(&mut self, inverse_mass: &[Real], x: &[Vec3], start: &dyn Fn(RowAt) -> R::Memory) {
        for (element, memory) in self.elements.elements().iter().zip(&mut self.memory) {
            let w = element.vertices().map(|v| inverse_mass[v as usize]);
            let rows = element.rows(&gather(x, element.vertices()));
            for (row, memory) in rows.as_ref().iter().zip(memory.as_mut()) {
                *memory = start(row_at(row, &w, row.value));
            }
        }
    }

    fn inspect(
        &self,
        inverse_mass: &[Real],
        x: &[Vec3],
        see: &mut dyn FnMut(RowView<'_, R::Memory>),
    ) {
        let places = self.elements.input_index().iter().zip(&self.memory);
        for (element, (&place, memory)) in self.elements.elements().iter().zip(places) {
            let vertices = element.vertices();
            let w = vertices.map(|v| inverse_mass[v as usize]);
            let rows = element.rows(&gather(x, vertices));
            for (i, (row, memory)) in rows.as_ref().iter().zip(memory.as_ref()).enumerate() {
                see(RowView {
                    index: place as usize * E::Rows::LEN + i,
                    row: row_at(row, &w, row.value),
                    vertices: &vertices,
                    gradient: &row.gradient,
                    memory,
                });
            }
        }
    }
}

/// The rows of one element: one by one where they are independent, together where the method says how, else one after another.
#[inline(always)]
fn project<const N: usize, E: Constraint<N>, R: Rule>(
    rule: &R,
    rows: &E::Rows,
    w: &[Real; N],
    memory: &mut [R::Memory],
    x: &mut [Vec3; N],
) {
    let alone = E::ROWS_ARE_INDEPENDENT || E::Rows::LEN == 1;
    if alone || !together(rule, rows, w, memory, x) {
        in_turn(rule, rows.as_ref(), alone, w, memory, x);
    }
}

/// Row after row. All gradients are those at the start; the value of a later row is
/// updated to first order for what the earlier ones moved, which is exact for linear rows.
#[inline(always)]
fn in_turn<const N: usize, R: Rule>(
    rule: &R,
    rows: &[Row<N>],
    alone: bool,
    w: &[Real; N],
    memory: &mut [R::Memory],
    x: &mut [Vec3; N],
) {
    let mut moved = [Vec3::zeros(); N];
    for (row, memory) in rows.iter().zip(memory) {
        let mut value = row.value;
        if !alone {
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

/// A pivot below this part of its diagonal is rounding: the row says nothing that the rows before it did not say.
const REDUNDANT: Real = 1e-12;

/// Solves `(J M⁻¹ Jᵀ + softness) Δλ = −residual` for the rows of one element by `L D Lᵀ`. False, with nothing
/// done, if the method has no equation for any row.
#[inline(always)]
fn together<const N: usize, A: RowArray<N>, R: Rule>(
    rule: &R,
    rows: &A,
    w: &[Real; N],
    memory: &mut [R::Memory],
    x: &mut [Vec3; N],
) -> bool {
    // L below the diagonal, D on it; a pivot of 0 leaves its row out.
    let (mut lower, mut change) = (A::per_row(A::per_row(0.0)), A::per_row(0.0));
    let (lower, change, rows) = (lower.as_mut(), change.as_mut(), rows.as_ref());
    let mut any = false;
    for r in 0..rows.len() {
        let seen = row_at(&rows[r], w, rows[r].value);
        let Some(equation) = rule.equation(seen, &memory[r]) else {
            continue;
        };
        any = true;
        let whole = seen.weight + equation.softness;
        let (mut pivot, mut value) = (whole, -equation.residual);
        let mut scaled = A::per_row(0.0); // L D
        let scaled = scaled.as_mut();
        for s in 0..r {
            let before = lower[s].as_ref()[s];
            if before == 0.0 {
                continue;
            }
            for i in 0..N {
                scaled[s] += w[i] * rows[r].gradient[i].dot(&rows[s].gradient[i]);
            }
            for t in 0..s {
                scaled[s] -= scaled[t] * lower[s].as_ref()[t];
            }
            let l = scaled[s] / before;
            pivot -= l * scaled[s];
            value -= l * change[s];
            lower[r].as_mut()[s] = l;
        }
        if pivot > REDUNDANT * whole {
            lower[r].as_mut()[r] = pivot;
            change[r] = value;
        } else {
            lower[r].as_mut().fill(0.0);
        }
    }
    if !any {
        return false;
    }
    let mut moved = [Vec3::zeros(); N];
    for r in (0..rows.len()).rev() {
        let pivot = lower[r].as_ref()[r];
        if pivot == 0.0 {
            continue;
        }
        change[r] /= pivot;
        for q in r + 1..rows.len() {
            change[r] -= lower[q].as_ref()[r] * change[q];
        }
        rule.remember(change[r], &mut memory[r]);
        for i in 0..N {
            moved[i] += rows[r].gradient[i] * (w[i] * change[r]);
        }
    }
    for i in 0..N {
        x[i] += moved[i];
    }
    true
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

    /// Sets the memory of every row to what `start` makes of the row at `x` (m).
    ///
    /// # Panics
    /// If the lengths are not those that the families were built for.
    pub fn set(&mut self, inverse_mass: &[Real], x: &[Vec3], start: impl Fn(RowAt) -> R::Memory) {
        for family in &mut self.families {
            family.set(inverse_mass, x, &start);
        }
    }

    /// Number of families.
    #[must_use]
    pub fn len(&self) -> usize {
        self.families.len()
    }

    /// Whether there is no family.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.families.is_empty()
    }

    /// Shows every row of one family at `x` (m) with its gradient, in visiting order.
    ///
    /// # Panics
    /// If there is no such family, or the lengths are not those that it was built for.
    pub fn inspect(
        &self,
        family: usize,
        inverse_mass: &[Real],
        x: &[Vec3],
        mut see: impl FnMut(RowView<'_, R::Memory>),
    ) {
        self.families[family].inspect(inverse_mass, x, &mut see);
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

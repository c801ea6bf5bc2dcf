//! The elements of each kind, and the sweep over them.

use super::chebyshev::Recurrence;
use super::jacobi::{self, Corrections};
use super::{Acceleration, Sweep};
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
    /// Part (dimensionless) of its Δλ that the row will really make: 1, unless the sweep is a relaxed or an averaging one.
    pub share: Real,
}

/// What tells one position-based method from another: how far it goes along one row.
pub trait Rule: Debug + Send + Sync + 'static {
    /// What is remembered of a row from one visit to the next. It starts, and is forgotten, as the default.
    type Memory: Copy + Debug + Default + Send + Sync + 'static;

    /// Whether the memory is a part of the iterate, as a multiplier is that goes with the positions. It is then extrapolated with them
    /// ([`Rule::extrapolate`]).
    const MEMORY_ITERATES: bool = false;

    /// Δλ (kg m² per unit of C): the vertices of the row will move by `wᵢ ∂C/∂xᵢ Δλ`, times [`RowAt::share`]. A memory of multipliers has to take
    /// the share into account; Δλ itself has not.
    ///
    /// It has to be finite also where the weight is zero.
    fn multiplier(&self, row: RowAt, memory: &mut Self::Memory) -> Real;

    /// What [`Chebyshev`](super::Chebyshev) does to the memory: `now ← before + ω (now − before)`. Only called if [`Rule::MEMORY_ITERATES`].
    fn extrapolate(now: &mut Self::Memory, before: &Self::Memory, omega: Real) {
        let _ = (now, before, omega);
    }
}

/// The door of a family: one virtual call a sweep, none per element.
trait AnyFamily<R: Rule>: Debug + Send + Sync {
    fn sweep(&mut self, rule: &R, relaxation: Real, inverse_mass: &[Real], x: &mut [Vec3]);
    /// The same in the opposite order.
    fn sweep_back(&mut self, rule: &R, relaxation: Real, inverse_mass: &[Real], x: &mut [Vec3]);
    /// Writes the corrections to `moves`, N per element, without making them.
    fn correct(&mut self, rule: &R, inverse_mass: &[Real], x: &[Vec3], moves: &mut [Vec3]);
    /// Number of elements times N.
    fn corner_count(&self) -> usize;
    /// Appends the vertices of all elements.
    fn corners(&self, out: &mut Vec<u32>);
    /// What part of its correction each element makes when all are made at once.
    fn set_shares(&mut self, share: &dyn Fn(&[u32]) -> Real);
    fn forget(&mut self);
    /// Keeps the memory from which the next sweep starts.
    fn remember(&mut self);
    fn extrapolate(&mut self, omega: Real);
    fn each_row(&self, inverse_mass: &[Real], x: &[Vec3], see: &mut dyn FnMut(RowAt, &R::Memory));
    fn remembered(&self, out: &mut Vec<R::Memory>);
}

/// Elements of one kind with their memory, one array of rows per element, in visiting order.
#[derive(Clone, Debug)]
struct Family<const N: usize, E, A> {
    elements: Colored<N, E>,
    memory: Vec<A>,
    /// One per element, for Jacobi sweeps; else none.
    shares: Vec<Real>,
    /// The memory before the last sweep, and before the one before it; none unless it is extrapolated.
    now: Vec<A>,
    before: Vec<A>,
}

type Slot<const N: usize, E, R> =
    <<E as Constraint<N>>::Rows as RowArray<N>>::PerRow<<R as Rule>::Memory>;

impl<const N: usize, E: Constraint<N>, R: Rule> AnyFamily<R> for Family<N, E, Slot<N, E, R>> {
    fn sweep(&mut self, rule: &R, relaxation: Real, inverse_mass: &[Real], x: &mut [Vec3]) {
        self.elements
            .sweep(&mut self.memory, x, |element, memory, x| {
                project(rule, element, inverse_mass, relaxation, memory, x);
            });
    }

    fn sweep_back(&mut self, rule: &R, relaxation: Real, inverse_mass: &[Real], x: &mut [Vec3]) {
        self.elements
            .sweep_back(&mut self.memory, x, |element, memory, x| {
                project(rule, element, inverse_mass, relaxation, memory, x);
            });
    }

    fn correct(&mut self, rule: &R, inverse_mass: &[Real], x: &[Vec3], moves: &mut [Vec3]) {
        let correct = |element: &E, &share: &Real, memory: &mut Slot<N, E, R>| -> [Vec3; N] {
            let vertices = element.vertices();
            let w = vertices.map(|v| inverse_mass[v as usize]);
            let rows = element.rows(&gather(x, vertices));
            correction(rule, rows.as_ref(), &w, share, memory.as_mut())
        };
        let (moves, _) = moves.as_chunks_mut::<N>();
        jacobi::each_element(
            self.elements.elements(),
            &self.shares,
            &mut self.memory,
            moves,
            correct,
        );
    }

    fn corner_count(&self) -> usize {
        self.memory.len() * N
    }

    fn corners(&self, out: &mut Vec<u32>) {
        out.extend(self.elements.elements().iter().flat_map(E::vertices));
    }

    fn set_shares(&mut self, share: &dyn Fn(&[u32]) -> Real) {
        let elements = self.elements.elements().iter();
        self.shares = elements.map(|e| share(&e.vertices())).collect();
    }

    fn remember(&mut self) {
        if R::MEMORY_ITERATES {
            std::mem::swap(&mut self.before, &mut self.now);
            self.now.clone_from(&self.memory);
        }
    }

    fn extrapolate(&mut self, omega: Real) {
        if R::MEMORY_ITERATES {
            for (now, before) in self.memory.iter_mut().zip(&self.before) {
                for (now, before) in now.as_mut().iter_mut().zip(before.as_ref()) {
                    R::extrapolate(now, before, omega);
                }
            }
        }
    }

    fn forget(&mut self) {
        self.memory.fill(E::Rows::per_row(R::Memory::default()));
    }

    fn each_row(&self, inverse_mass: &[Real], x: &[Vec3], see: &mut dyn FnMut(RowAt, &R::Memory)) {
        for (element, memory) in self.elements.elements().iter().zip(&self.memory) {
            let w = element.vertices().map(|v| inverse_mass[v as usize]);
            let rows = element.rows(&gather(x, element.vertices()));
            for (row, memory) in rows.as_ref().iter().zip(memory.as_ref()) {
                see(row_at(row, &w, row.value, 1.0), memory);
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

/// Moves the vertices of one element, at `x` (m).
#[inline(always)]
fn project<const N: usize, E: Constraint<N>, R: Rule>(
    rule: &R,
    element: &E,
    inverse_mass: &[Real],
    relaxation: Real,
    memory: &mut Slot<N, E, R>,
    x: &mut [Vec3; N],
) {
    let w = element.vertices().map(|v| inverse_mass[v as usize]);
    let rows = element.rows(x);
    let moved = correction(rule, rows.as_ref(), &w, relaxation, memory.as_mut());
    for i in 0..N {
        x[i] += moved[i];
    }
}

/// What one element moves its vertices by (m): row after row, then `share` of it. All gradients are those at the start; the value of a later row is
/// updated to first order for what the earlier ones moved, which is exact for linear rows.
#[inline(always)]
fn correction<const N: usize, R: Rule>(
    rule: &R,
    rows: &[Row<N>],
    w: &[Real; N],
    share: Real,
    memory: &mut [R::Memory],
) -> [Vec3; N] {
    let mut moved = [Vec3::zeros(); N];
    for (row, memory) in rows.iter().zip(memory) {
        let mut value = row.value;
        if rows.len() > 1 {
            for i in 0..N {
                value += row.gradient[i].dot(&moved[i]);
            }
        }
        let multiplier = rule.multiplier(row_at(row, w, value, share), memory);
        for i in 0..N {
            moved[i] += row.gradient[i] * (w[i] * multiplier);
        }
    }
    moved.map(|moved| moved * share)
}

#[inline(always)]
fn row_at<const N: usize>(row: &Row<N>, w: &[Real; N], value: Real, share: Real) -> RowAt {
    let mut weight = 0.0;
    for i in 0..N {
        weight += w[i] * row.gradient[i].norm_squared();
    }
    RowAt {
        value,
        weight,
        stiffness: row.stiffness,
        share,
    }
}

/// All constraints of a solver: families of elements with a memory per row.
#[derive(Debug)]
pub struct Families<R: Rule> {
    families: Vec<Box<dyn AnyFamily<R>>>,
    vertex_count: usize,
    sweep: Sweep,
    relaxation: Real,
    /// For Jacobi sweeps; made when the first one begins, so that it knows all families.
    corrections: Option<Corrections>,
    recurrence: Option<Recurrence>,
    surrendered: u64,
}

impl<R: Rule> Families<R> {
    /// No family yet, on `vertex_count` vertices.
    ///
    /// # Errors
    /// [`BuildError::InvalidSetting`] for an acceleration out of range.
    pub fn new(
        vertex_count: usize,
        sweep: Sweep,
        acceleration: Acceleration,
    ) -> Result<Self, BuildError> {
        acceleration.check()?;
        let recurrence = |settings| Recurrence::new(settings, vertex_count);
        Ok(Self {
            families: Vec::new(),
            vertex_count,
            sweep,
            relaxation: acceleration.relaxation,
            corrections: None,
            recurrence: acceleration.chebyshev.map(recurrence),
            surrendered: 0,
        })
    }

    /// Adds a family to be visited after those that are there.
    ///
    /// # Errors
    /// [`BuildError::NoSuchVertex`] if an element names a vertex that does not exist.
    ///
    /// # Panics
    /// If an element of a coloured sweep names a vertex twice.
    pub fn add<const N: usize, E: Constraint<N>>(
        &mut self,
        elements: &[E],
    ) -> Result<(), BuildError> {
        check_vertices(elements, self.vertex_count)?;
        let memory = vec![E::Rows::per_row(R::Memory::default()); elements.len()];
        let elements = match self.sweep {
            Sweep::Colored => Colored::new(elements, self.vertex_count),
            Sweep::Sequential | Sweep::Jacobi | Sweep::PlainJacobi => {
                Colored::in_input_order(elements, self.vertex_count)
            }
        };
        let extrapolated = || {
            if R::MEMORY_ITERATES && self.recurrence.is_some() {
                memory.clone()
            } else {
                Vec::new()
            }
        };
        self.families.push(Box::new(Family {
            elements,
            shares: Vec::new(),
            now: extrapolated(),
            before: extrapolated(),
            memory,
        }));
        self.corrections = None;
        Ok(())
    }

    /// Tells that the next sweep is the first of a substep: extrapolation starts anew. The memory is kept; see [`Families::forget`].
    pub fn restart(&mut self) {
        if let Some(recurrence) = &mut self.recurrence {
            recurrence.restart();
        }
    }

    /// One sweep: every element once, family after family. `inverse_mass` in 1/kg, `x` in m, one per vertex.
    ///
    /// # Panics
    /// If the lengths are not those that the families were built for.
    pub fn sweep(&mut self, rule: &R, inverse_mass: &[Real], x: &mut [Vec3]) {
        if let Some(recurrence) = &mut self.recurrence {
            recurrence.remember(x);
            for family in &mut self.families {
                family.remember();
            }
        }
        match self.sweep {
            Sweep::Sequential | Sweep::Colored => {
                for family in &mut self.families {
                    family.sweep(rule, self.relaxation, inverse_mass, x);
                }
                // One way only, the iterates cannot be extrapolated; there and back they can.
                if self.recurrence.is_some() {
                    for family in self.families.iter_mut().rev() {
                        family.sweep_back(rule, self.relaxation, inverse_mass, x);
                    }
                }
            }
            Sweep::Jacobi | Sweep::PlainJacobi => self.sweep_at_once(rule, inverse_mass, x),
        }
        if let Some(recurrence) = &mut self.recurrence {
            let already = recurrence.has_given_up();
            if let Some(omega) = recurrence.extrapolate(inverse_mass, x) {
                for family in &mut self.families {
                    family.extrapolate(omega);
                }
            }
            self.surrendered += u64::from(!already && recurrence.has_given_up());
        }
    }

    /// A Jacobi sweep.
    fn sweep_at_once(&mut self, rule: &R, inverse_mass: &[Real], x: &mut [Vec3]) {
        let mut corrections = match self.corrections.take() {
            Some(corrections) => corrections,
            None => self.incidence(inverse_mass),
        };
        let mut moves = corrections.moves_mut();
        for family in &mut self.families {
            let (own, others) = moves.split_at_mut(family.corner_count());
            family.correct(rule, inverse_mass, x, own);
            moves = others;
        }
        corrections.apply(x);
        self.corrections = Some(corrections);
    }

    /// Which elements meet at each vertex, and by it their shares.
    fn incidence(&mut self, inverse_mass: &[Real]) -> Corrections {
        let mut corners = Vec::new();
        for family in &self.families {
            family.corners(&mut corners);
        }
        let corrections = Corrections::new(&corners, self.vertex_count);
        for family in &mut self.families {
            family.set_shares(&|vertices| {
                self.relaxation
                    * match self.sweep {
                        Sweep::Jacobi => jacobi::share(vertices, inverse_mass, &corrections),
                        _ => 1.0,
                    }
            });
        }
        corrections
    }

    /// How many times, since it was built, a substep ended with plain sweeps because [`Chebyshev`](super::Chebyshev) extrapolation made the
    /// corrections grow.
    #[must_use]
    pub fn surrendered(&self) -> u64 {
        self.surrendered
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

    /// Writes the memory of a family, numbered from 0 as they were added, to `out`: element after element in the order given, row after row.
    ///
    /// # Panics
    /// If there is no such family.
    pub fn remembered(&self, family: usize, out: &mut Vec<R::Memory>) {
        self.families[family].remembered(out);
    }
}

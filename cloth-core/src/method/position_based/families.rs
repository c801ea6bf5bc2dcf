//! Families of elements, each of one type, and the sweep over them.

use super::chebyshev::Recurrence;
use super::constraint_update::{ConstraintUpdate, RowState, RowView, WithoutAccumulation};
use super::correction::{correction, dead_zone_row_state, project, row_state};
use super::jacobi::{self, Corrections};
use super::{Acceleration, Sweep};
use crate::element::{Constraint, RowArray};
use crate::math::{Real, Vec3, gather};
use crate::method::coloring::Colored;
use crate::method::family::check_vertices;
use crate::step::BuildError;
use std::fmt::Debug;

/// A type-erased family: one virtual call a sweep, none per element.
trait AnyFamily<U: ConstraintUpdate>: Debug + Send + Sync {
    fn sweep(&mut self, update: &U, relaxation: Real, inverse_mass: &[Real], x: &mut [Vec3]);
    /// The same in the opposite order.
    fn sweep_back(&mut self, update: &U, relaxation: Real, inverse_mass: &[Real], x: &mut [Vec3]);
    /// Writes the corrections to `moves`, N per element, without making them.
    fn correct(&mut self, update: &U, inverse_mass: &[Real], x: &[Vec3], moves: &mut [Vec3]);
    fn set_time(&mut self, time: Real);
    /// Number of elements times N.
    fn corner_count(&self) -> usize;
    /// Appends the vertices of all elements.
    fn corners(&self, out: &mut Vec<u32>);
    /// Sets the fraction of its correction that each element makes in a Jacobi sweep.
    fn set_fractions(&mut self, fraction: &dyn Fn(&[u32]) -> Real);
    fn reset(&mut self);
    /// Stores the memory from which the next sweep starts.
    fn store_memory(&mut self, update: &U);
    fn extrapolate(&mut self, update: &U, omega: Real);
    fn each_row(
        &self,
        inverse_mass: &[Real],
        x: &[Vec3],
        see: &mut dyn FnMut(RowState, &U::Memory),
    );
    /// Passes the memory of every row with the row's number in the input.
    fn read_memory(&self, see: &mut dyn FnMut(usize, &U::Memory));
    /// Number of rows.
    fn row_count(&self) -> usize;
    /// Prepares the memory of every row.
    fn prepare(&mut self, update: &U, inverse_mass: &[Real], x: &[Vec3]);
    fn inspect(
        &self,
        which: Which,
        inverse_mass: &[Real],
        x: &[Vec3],
        see: &mut dyn FnMut(RowView<'_, U::Memory>),
    );
}

/// Which elements to inspect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Which {
    All,
    /// Those with a prescribed vertex.
    WithPrescribed,
}

/// Elements of one kind with their memory, one array of rows per element, in visiting order.
#[derive(Clone, Debug)]
struct Family<const N: usize, E, A> {
    elements: Colored<N, E>,
    memory: Vec<A>,
    /// One per element, for Jacobi sweeps; else none.
    fractions: Vec<Real>,
    /// The memory before the last sweep, and before the one before it; none until it is extrapolated.
    now: Vec<A>,
    before: Vec<A>,
}

type Slot<const N: usize, E, U> =
    <<E as Constraint<N>>::Rows as RowArray<N>>::PerRow<<U as ConstraintUpdate>::Memory>;

/// Corrects every element, one after another, forward or backward.
fn sweep_elements<const REVERSED: bool, const N: usize, E: Constraint<N>, U: ConstraintUpdate>(
    elements: &Colored<N, E>,
    memory: &mut [Slot<N, E, U>],
    update: &U,
    relaxation: Real,
    w: &[Real],
    x: &mut [Vec3],
) {
    elements.sweep_with::<REVERSED, _, _, _>(
        memory,
        x,
        w,
        #[inline(always)]
        |element, memory, x, w| project(update, element, w, relaxation, memory.as_mut(), x),
    );
}

impl<const N: usize, E: Constraint<N>, U: ConstraintUpdate> AnyFamily<U>
    for Family<N, E, Slot<N, E, U>>
{
    fn sweep(&mut self, update: &U, relaxation: Real, inverse_mass: &[Real], x: &mut [Vec3]) {
        let (elements, memory) = (&self.elements, &mut self.memory[..]);
        if update.accumulates() {
            sweep_elements::<false, N, E, U>(elements, memory, update, relaxation, inverse_mass, x);
        } else {
            let update = &WithoutAccumulation(*update);
            sweep_elements::<false, N, E, WithoutAccumulation<U>>(
                elements,
                memory,
                update,
                relaxation,
                inverse_mass,
                x,
            );
        }
    }

    fn sweep_back(&mut self, update: &U, relaxation: Real, inverse_mass: &[Real], x: &mut [Vec3]) {
        let (elements, memory) = (&self.elements, &mut self.memory[..]);
        if update.accumulates() {
            sweep_elements::<true, N, E, U>(elements, memory, update, relaxation, inverse_mass, x);
        } else {
            let update = &WithoutAccumulation(*update);
            sweep_elements::<true, N, E, WithoutAccumulation<U>>(
                elements,
                memory,
                update,
                relaxation,
                inverse_mass,
                x,
            );
        }
    }

    fn correct(&mut self, update: &U, inverse_mass: &[Real], x: &[Vec3], moves: &mut [Vec3]) {
        let correct = |element: &E, &fraction: &Real, memory: &mut Slot<N, E, U>| -> [Vec3; N] {
            let vertices = element.vertices();
            let x = gather(x, vertices);
            let w = vertices.map(|vertex| inverse_mass[vertex as usize]);
            correction(update, element, &w, fraction, memory.as_mut(), &x)
        };
        let (moves, _) = moves.as_chunks_mut::<N>();
        jacobi::each_element(
            self.elements.elements(),
            &self.fractions,
            &mut self.memory,
            moves,
            correct,
        );
    }

    fn set_time(&mut self, time: Real) {
        if E::CHANGES_WITH_TIME {
            let elements = self.elements.elements_mut();
            elements.iter_mut().for_each(|e| e.set_time(time));
        }
    }

    fn corner_count(&self) -> usize {
        self.memory.len() * N
    }

    fn corners(&self, out: &mut Vec<u32>) {
        out.extend(self.elements.elements().iter().flat_map(E::vertices));
    }

    fn set_fractions(&mut self, fraction: &dyn Fn(&[u32]) -> Real) {
        let elements = self.elements.elements().iter();
        self.fractions = elements.map(|e| fraction(&e.vertices())).collect();
    }

    fn store_memory(&mut self, update: &U) {
        if update.accumulates() {
            std::mem::swap(&mut self.before, &mut self.now);
            self.now.clone_from(&self.memory);
        }
    }

    fn extrapolate(&mut self, update: &U, omega: Real) {
        if update.accumulates() {
            for (now, before) in self.memory.iter_mut().zip(&self.before) {
                for (now, before) in now.as_mut().iter_mut().zip(before.as_ref()) {
                    U::extrapolate(now, before, omega);
                }
            }
        }
    }

    fn reset(&mut self) {
        for memory in &mut self.memory {
            memory.as_mut().iter_mut().for_each(U::reset);
        }
    }

    fn prepare(&mut self, update: &U, inverse_mass: &[Real], x: &[Vec3]) {
        for (element, memory) in self.elements.elements().iter().zip(&mut self.memory) {
            let w = element.vertices().map(|v| inverse_mass[v as usize]);
            let x = gather(x, element.vertices());
            let is_limit = element.dead_zone_rows(&x).is_some();
            let rows = element.rows(&x);
            for (row, memory) in rows.as_ref().iter().zip(memory.as_mut()) {
                let row = row_state(row, &w, row.value);
                match is_limit {
                    true => update.prepare_limit(row, memory),
                    false => update.prepare(row, memory),
                }
            }
        }
    }

    fn each_row(
        &self,
        inverse_mass: &[Real],
        x: &[Vec3],
        see: &mut dyn FnMut(RowState, &U::Memory),
    ) {
        for (element, memory) in self.elements.elements().iter().zip(&self.memory) {
            let w = element.vertices().map(|v| inverse_mass[v as usize]);
            let x = gather(x, element.vertices());
            if let Some(rows) = element.dead_zone_rows(&x) {
                for (row, memory) in rows.as_ref().iter().zip(memory.as_ref()) {
                    see(dead_zone_row_state::<N, U>(row, &w, memory), memory);
                }
                continue;
            }
            for (row, memory) in element.rows(&x).as_ref().iter().zip(memory.as_ref()) {
                see(row_state(row, &w, row.value), memory);
            }
        }
    }

    fn read_memory(&self, see: &mut dyn FnMut(usize, &U::Memory)) {
        for (&place, memory) in self.elements.input_index().iter().zip(&self.memory) {
            let first = place as usize * E::Rows::LEN;
            for (r, memory) in memory.as_ref().iter().enumerate() {
                see(first + r, memory);
            }
        }
    }

    fn row_count(&self) -> usize {
        self.memory.len() * E::Rows::LEN
    }

    fn inspect(
        &self,
        which: Which,
        inverse_mass: &[Real],
        x: &[Vec3],
        see: &mut dyn FnMut(RowView<'_, U::Memory>),
    ) {
        let places = self.elements.input_index().iter().zip(&self.memory);
        for (element, (&place, memory)) in self.elements.elements().iter().zip(places) {
            let vertices = element.vertices();
            let w = vertices.map(|v| inverse_mass[v as usize]);
            if which == Which::WithPrescribed && !w.contains(&0.0) {
                continue;
            }
            let x = gather(x, vertices);
            let (rows, whole) = (element.rows(&x), element.dead_zone_rows(&x));
            for (i, (row, memory)) in rows.as_ref().iter().zip(memory.as_ref()).enumerate() {
                // A hard row at the end of its range has a force but no value.
                let whole = whole.as_ref().map(|rows| &rows.as_ref()[i].gradient);
                see(RowView {
                    index: place as usize * E::Rows::LEN + i,
                    row: row_state(row, &w, row.value),
                    vertices: &vertices,
                    is_limit: whole.is_some(),
                    gradient: whole.unwrap_or(&row.gradient),
                    memory,
                });
            }
        }
    }
}

/// All constraints of a solver: families of elements with a memory per row.
#[derive(Debug)]
pub struct Families<U: ConstraintUpdate> {
    families: Vec<Box<dyn AnyFamily<U>>>,
    vertex_count: usize,
    sweep: Sweep,
    relaxation: Real,
    /// For Jacobi sweeps; built at the first one, when all families are there.
    corrections: Option<Corrections>,
    recurrence: Option<Recurrence>,
    chebyshev_fallbacks: u64,
}

impl<U: ConstraintUpdate> Families<U> {
    /// No family yet, on `vertex_count` vertices.
    ///
    /// # Errors
    /// [`BuildError::OutOfRange`] for an acceleration out of range.
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
            chebyshev_fallbacks: 0,
        })
    }

    /// Adds a family to be visited after those that are there.
    ///
    /// # Errors
    /// [`BuildError::NoSuchVertex`] or [`BuildError::RepeatedVertex`] if an element names a vertex that does not exist,
    /// or one twice; [`BuildError::InvalidElement`] for a number of one.
    pub fn add<const N: usize, E: Constraint<N>>(
        &mut self,
        elements: &[E],
    ) -> Result<(), BuildError> {
        let number = self.families.len();
        check_vertices(elements, self.vertex_count).map_err(|error| error.in_family(number))?;
        let memory = vec![E::Rows::per_row(U::Memory::default()); elements.len()];
        let elements = match self.sweep {
            Sweep::Colored => Colored::new(elements, self.vertex_count),
            Sweep::Sequential | Sweep::Jacobi | Sweep::PlainJacobi => {
                Colored::in_input_order(elements, self.vertex_count)
            }
        };
        self.families.push(Box::new(Family {
            elements,
            fractions: Vec::new(),
            now: Vec::new(),
            before: Vec::new(),
            memory,
        }));
        self.corrections = None;
        Ok(())
    }

    /// Restarts the extrapolation, before the first sweep of a substep. The memory is kept; see [`Families::reset`].
    pub fn restart(&mut self) {
        if let Some(recurrence) = &mut self.recurrence {
            recurrence.restart();
        }
    }

    /// One sweep: every element once, family after family. `inverse_mass` in 1/kg, `x` in m, one per vertex.
    ///
    /// # Panics
    /// If the lengths are not those that the families were built for.
    pub fn sweep(&mut self, update: &U, inverse_mass: &[Real], x: &mut [Vec3]) {
        if let Some(recurrence) = &mut self.recurrence {
            recurrence.store_iterate(x);
            for family in &mut self.families {
                family.store_memory(update);
            }
        }
        match self.sweep {
            Sweep::Sequential | Sweep::Colored => {
                for family in &mut self.families {
                    family.sweep(update, self.relaxation, inverse_mass, x);
                }
                // Only symmetric Gauss–Seidel can be extrapolated.
                if self.recurrence.is_some() {
                    for family in self.families.iter_mut().rev() {
                        family.sweep_back(update, self.relaxation, inverse_mass, x);
                    }
                }
            }
            Sweep::Jacobi | Sweep::PlainJacobi => self.jacobi_sweep(update, inverse_mass, x),
        }
        if let Some(recurrence) = &mut self.recurrence {
            let already = recurrence.is_disabled();
            if let Some(omega) = recurrence.extrapolate(inverse_mass, x) {
                for family in &mut self.families {
                    family.extrapolate(update, omega);
                }
            }
            self.chebyshev_fallbacks += u64::from(!already && recurrence.is_disabled());
        }
    }

    /// A Jacobi sweep.
    fn jacobi_sweep(&mut self, update: &U, inverse_mass: &[Real], x: &mut [Vec3]) {
        let mut corrections = match self.corrections.take() {
            Some(corrections) => corrections,
            None => self.incidence(inverse_mass),
        };
        let mut moves = corrections.moves_mut();
        for family in &mut self.families {
            let (own, others) = moves.split_at_mut(family.corner_count());
            family.correct(update, inverse_mass, x, own);
            moves = others;
        }
        corrections.apply(x);
        self.corrections = Some(corrections);
    }

    /// The incidence of elements at vertices, and from it the averaging fractions.
    fn incidence(&mut self, inverse_mass: &[Real]) -> Corrections {
        let mut corners = Vec::new();
        for family in &self.families {
            family.corners(&mut corners);
        }
        let corrections = Corrections::new(&corners, self.vertex_count);
        for family in &mut self.families {
            family.set_fractions(&|vertices| {
                self.relaxation
                    * match self.sweep {
                        Sweep::Jacobi => jacobi::fraction(vertices, inverse_mass, &corrections),
                        _ => 1.0,
                    }
            });
        }
        corrections
    }

    /// How many substeps, since it was built, disabled [`Chebyshev`](super::Chebyshev) extrapolation because it
    /// made the corrections grow, and ended with plain sweeps.
    #[must_use]
    pub fn chebyshev_fallbacks(&self) -> u64 {
        self.chebyshev_fallbacks
    }

    /// Sets the elements to a time (s), before the sweeps of a substep that ends then; see
    /// [`Element::set_time`](crate::element::Element::set_time).
    pub fn set_time(&mut self, time: Real) {
        for family in &mut self.families {
            family.set_time(time);
        }
    }

    /// Resets the memory of all rows, at the start of a substep.
    pub fn reset(&mut self) {
        for family in &mut self.families {
            family.reset();
        }
    }

    /// Passes the state of every row at `x` (m), as a sweep would see it, with its memory to `see`; nothing is moved.
    ///
    /// # Panics
    /// If the lengths are not those that the families were built for.
    pub fn each_row(
        &self,
        inverse_mass: &[Real],
        x: &[Vec3],
        mut see: impl FnMut(RowState, &U::Memory),
    ) {
        for family in &self.families {
            family.each_row(inverse_mass, x, &mut see);
        }
    }

    /// Prepares the memory of every row at `x` (m) for `update` ([`ConstraintUpdate::prepare`]).
    ///
    /// # Panics
    /// If the lengths are not those that the families were built for.
    pub fn prepare(&mut self, update: &U, inverse_mass: &[Real], x: &[Vec3]) {
        for family in &mut self.families {
            family.prepare(update, inverse_mass, x);
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

    /// Passes every row of one family at `x` (m), with its gradient, in visiting order to `see`.
    ///
    /// # Panics
    /// If there is no such family, or the lengths are not those that it was built for.
    pub fn inspect(
        &self,
        family: usize,
        inverse_mass: &[Real],
        x: &[Vec3],
        mut see: impl FnMut(RowView<'_, U::Memory>),
    ) {
        self.families[family].inspect(Which::All, inverse_mass, x, &mut see);
    }

    /// Passes every row at `x` (m) of an element with a prescribed vertex to `see`, family after family.
    ///
    /// # Panics
    /// If the lengths are not those that the families were built for.
    pub fn inspect_prescribed(
        &self,
        inverse_mass: &[Real],
        x: &[Vec3],
        mut see: impl FnMut(RowView<'_, U::Memory>),
    ) {
        for family in &self.families {
            family.inspect(Which::WithPrescribed, inverse_mass, x, &mut see);
        }
    }

    /// Writes `read` of the memory of each row of one family to `out`: element after element in the order
    /// given, row after row.
    ///
    /// # Panics
    /// If there is no such family.
    pub fn read_memory<T: Clone + Default>(
        &self,
        family: usize,
        out: &mut Vec<T>,
        read: impl Fn(&U::Memory) -> T,
    ) {
        let family = &self.families[family];
        out.clear();
        out.resize(family.row_count(), T::default());
        family.read_memory(&mut |place, memory| out[place] = read(memory));
    }
}

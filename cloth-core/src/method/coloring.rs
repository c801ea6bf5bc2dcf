//! Elements sorted so that a sweep over them can be shared by threads, and is fast on one.
//!
//! Gauss–Seidel visits elements one after another, each seeing what the one before it wrote. Two elements that share no
//! vertex do not see each other. A *colour* is a set of elements of which no two share a vertex: visiting it in
//! parallel gives the same bits as visiting it in turn; and a processor that need not wait for the element before has
//! several in work at once.
//!
//! An element takes the first colour that no element before it has at its vertices. With d elements at most at any of
//! its N vertices these are `N (d − 1)` at most: so greedy colouring needs at most `N (d − 1) + 1` colours, whatever
//! the size of the cloth, and where d meet no colouring does with fewer than d.
//!
//! A colour goes through the whole cloth. Where that is larger than a cache, all positions come from memory once per
//! colour. So a large cloth is cut into *blocks* of vertices with numbers next to each other, and the colours of one
//! block are visited before the next block:
//!
//! | stage | elements | parts that share no vertex |
//! |---|---|---|
//! | 1 | all vertices in one block | blocks |
//! | 2 | of the others: all vertices in one block, the blocks shifted by half | shifted blocks |
//! | 3, 4, … | the rest, a colour in each | pieces of up to 1024 elements of the colour |
//!
//! With numbers that keep neighbours close ([`crate::method::ordering`]) few elements are left for the third stage, and
//! a thread gets whole blocks.

mod greedy;
mod stages;

use crate::element::Element;
use crate::method::parallel::Stencils;
pub use greedy::{greedy_colors, greedy_vertex_colors};
use stages::{Place, stages, visiting_order};

/// A cloth of this many vertices or more is divided into blocks: its positions and masses alone are 16 MB. Measured,
/// springs, commit 2f79ca2d: at 512 × 512 vertices colours through the whole cloth are 10 % faster than blocks, at 1000
/// × 1000 blocks are 1.3 times as fast or more.
const LARGE: usize = 1 << 19;

/// Vertices of a block: their positions and masses are half a megabyte.
const BLOCK: u32 = 1 << 14;

/// Elements of one type in the order in which a sweep visits them.
///
/// Either sorted by block and colour ([`Colored::new`]) or in the order given ([`Colored::in_input_order`]). Each
/// element is asked for its vertices once; a sweep goes by that answer, whatever the element says later.
#[derive(Clone, Debug)]
pub struct Colored<const N: usize, E> {
    elements: Vec<E>,
    stencils: Stencils<N>,
    /// Position in the input of each element.
    input_index: Vec<u32>,
}

impl<const N: usize, E: Element<N>> Colored<N, E> {
    /// Colours greedily in input order, then sorts stably by block and colour.
    ///
    /// # Panics
    /// If an element names a vertex that is not smaller than `vertex_count`, or names one twice.
    #[must_use]
    pub fn new(elements: &[E], vertex_count: usize) -> Self {
        let block = (vertex_count >= LARGE).then_some(BLOCK);
        Self::in_blocks(elements, vertex_count, block)
    }

    /// The same with blocks of `size` vertices, or without: for caches other than those that [`Colored::new`] was
    /// measured on.
    ///
    /// # Panics
    /// As [`Colored::new`], and if `size` is 0.
    #[must_use]
    pub fn in_blocks(elements: &[E], vertex_count: usize, size: Option<u32>) -> Self {
        let vertices: Vec<[u32; N]> = elements.iter().map(Element::vertices).collect();
        let colors = greedy_colors(&vertices, vertex_count);
        let places = vertices.iter().zip(colors);
        let places: Vec<Place> = places
            .map(|(vertices, color)| Place::new(vertices, color, size))
            .collect();
        let input_index = visiting_order(&places);
        let places = input_index.iter().map(|&index| places[index as usize]);
        let stages = stages(&places.collect::<Vec<_>>());
        let in_order = input_index.iter().map(|&index| vertices[index as usize]);
        Self {
            stencils: Stencils::new(in_order.collect(), stages, vertex_count),
            elements: input_index.iter().map(|&i| elements[i as usize]).collect(),
            input_index,
        }
    }

    /// Keeps the order given; sweeps run on one thread.
    ///
    /// # Panics
    /// If an element names a vertex that is not smaller than `vertex_count`.
    #[must_use]
    pub fn in_input_order(elements: &[E], vertex_count: usize) -> Self {
        let vertices = elements.iter().map(Element::vertices).collect();
        let stages = vec![vec![0, elements.len()]];
        Self {
            elements: elements.to_vec(),
            stencils: Stencils::new(vertices, stages, vertex_count),
            input_index: (0..elements.len() as u32).collect(),
        }
    }

    /// The elements in visiting order.
    #[must_use]
    pub fn elements(&self) -> &[E] {
        &self.elements
    }

    /// The same, to change their rest data.
    pub(crate) fn elements_mut(&mut self) -> &mut [E] {
        &mut self.elements
    }

    /// For each element in visiting order, where it stood in the input.
    #[must_use]
    pub fn input_index(&self) -> &[u32] {
        &self.input_index
    }

    /// The stages of a sweep, by where their parts begin and end in visiting order: part p of a stage is
    /// `bounds[p]..bounds[p + 1]`. Two parts of a stage share no vertex; threads get whole parts.
    #[must_use]
    pub fn stages(&self) -> &[Vec<usize>] {
        self.stencils.stages()
    }

    /// Visits every element once. `visit`, best `#[inline(always)]`, gets the element, its slot of the method's own
    /// memory, and a copy of its vertices' positions (m), in whatever form the method has them, which is stored back
    /// afterwards.
    ///
    /// With the feature `parallel`, stages large enough to be worth it are split over rayon's threads; the result has
    /// the same bits as on one thread.
    ///
    /// # Panics
    /// If `slots` is not as long as the elements, or `x` not as long as the vertices.
    pub fn sweep<A: Send, P: Copy + Send>(
        &self,
        slots: &mut [A],
        x: &mut [P],
        visit: impl Fn(&E, &mut A, &mut [P; N]) + Sync,
    ) {
        self.stencils
            .visit::<false, E, A, P>(&self.elements, slots, x, visit);
    }

    /// The same the other way round: every element after those that it came before.
    ///
    /// # Panics
    /// If `slots` is not as long as the elements, or `x` not as long as the vertices.
    pub fn sweep_back<A: Send, P: Copy + Send>(
        &self,
        slots: &mut [A],
        x: &mut [P],
        visit: impl Fn(&E, &mut A, &mut [P; N]) + Sync,
    ) {
        self.stencils
            .visit::<true, E, A, P>(&self.elements, slots, x, visit);
    }

    /// A sweep, or one `BACK`, in which each visit is shown what `shared` holds for its vertices.
    ///
    /// # Panics
    /// As [`Colored::sweep`], and if `shared` is not as long as the vertices.
    pub(crate) fn sweep_with<const BACK: bool, A: Send, P: Copy + Send, W: Copy + Sync>(
        &self,
        slots: &mut [A],
        x: &mut [P],
        shared: &[W],
        visit: impl Fn(&E, &mut A, &mut [P; N], &[W; N]) + Sync,
    ) {
        self.stencils
            .visit_with::<BACK, E, A, P, W>(&self.elements, slots, x, shared, visit);
    }
}

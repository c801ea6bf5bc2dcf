//! Visiting elements in turn, or on several threads where they share no vertex; and a hint to the memory. The only file
//! of a library here with `unsafe`.

use std::marker::PhantomData;
use std::ops::Range;

/// Fewer elements than this are visited on one thread: waking a second one costs some microseconds,
/// and an element costs about five nanoseconds.
#[cfg(feature = "parallel")]
const SMALLEST_PARALLEL_SET: usize = 4096;

/// Passes over fewer vertices than this take less than it costs to wake a second thread a few times in an iteration.
#[cfg(feature = "parallel")]
const SMALLEST_PARALLEL_CLOTH: usize = 8_192;

/// Does two things that have nothing to do with each other: at the same time if there are several threads and the cloth
/// has enough vertices, else one after the other.
#[cfg(feature = "parallel")]
pub fn join<A: Send, B: Send>(
    vertex_count: usize,
    first: impl FnOnce() -> A + Send,
    second: impl FnOnce() -> B + Send,
) -> (A, B) {
    if vertex_count >= SMALLEST_PARALLEL_CLOTH && rayon::current_num_threads() > 1 {
        join_on_threads(first, second)
    } else {
        (first(), second())
    }
}

/// [`rayon::join`] with all that it brings compiled once, not once for each pair of closures.
#[cfg(feature = "parallel")]
fn join_on_threads<A: Send, B: Send>(
    first: impl FnOnce() -> A + Send,
    second: impl FnOnce() -> B + Send,
) -> (A, B) {
    let (mut first, mut second) = (Some(first), Some(second));
    let (mut a, mut b) = (None, None);
    join_erased(&mut || a = first.take().map(|first| first()), &mut || {
        b = second.take().map(|second| second())
    });
    (
        a.expect("the first is done"),
        b.expect("the second is done"),
    )
}

#[cfg(feature = "parallel")]
#[inline(never)]
fn join_erased(first: &mut (dyn FnMut() + Send), second: &mut (dyn FnMut() + Send)) {
    rayon::join(first, second);
}

/// Does two things that have nothing to do with each other, one after the other.
#[cfg(not(feature = "parallel"))]
pub fn join<A, B>(_: usize, first: impl FnOnce() -> A, second: impl FnOnce() -> B) -> (A, B) {
    (first(), second())
}

/// Runs `work`, compiled for registers of four numbers if the processor has them.
///
/// All processors of the kind x86-64 have registers of two numbers. What is run here is compiled for four as well. Both
/// do the same operations in the same order (a product and a sum are never fused), so the results have the same bits.
/// The closure and what its loops call have to be `#[inline(always)]`.
#[inline(always)]
pub fn wide<T>(work: impl FnOnce() -> T) -> T {
    #[cfg(target_arch = "x86_64")]
    if std::is_x86_feature_detected!("avx2") {
        #[allow(unsafe_code)]
        // SAFETY: the processor has the instructions.
        return unsafe { with_avx2(work) };
    }
    work()
}

/// # Safety
/// The processor has AVX2.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
#[allow(unsafe_code)] // the reason is in the section above
unsafe fn with_avx2<T>(work: impl FnOnce() -> T) -> T {
    work()
}

/// The vertices of elements in visiting order, and the stages in which they are visited: a vertex is in one part of a
/// stage at most.
///
/// That is checked when the value is made and nothing can change it afterwards; sharing a stage between threads rests
/// on it, and on nothing that an element says later.
#[derive(Clone, Debug)]
pub(crate) struct Stencils<const N: usize> {
    vertices: Vec<[u32; N]>,
    /// Part p of a stage is elements `bounds[p]..bounds[p + 1]`; at least one part.
    stages: Vec<Vec<usize>>,
    vertex_count: usize,
}

impl<const N: usize> Stencils<N> {
    /// Checks the stages.
    ///
    /// # Panics
    /// If a vertex is not smaller than `vertex_count`, bounds do not ascend or leave the elements, or two parts of a
    /// stage share a vertex.
    pub(crate) fn new(
        vertices: Vec<[u32; N]>,
        stages: Vec<Vec<usize>>,
        vertex_count: usize,
    ) -> Self {
        // The last part that each vertex was found in, counted through all stages from 1.
        let mut last_part = vec![0_usize; vertex_count];
        let mut part = 0;
        for bounds in &stages {
            assert!(bounds.len() > 1, "a stage has a part");
            let parts_before = part;
            for bounds in bounds.windows(2) {
                part += 1;
                for &vertex in vertices[bounds[0]..bounds[1]].iter().flatten() {
                    let last_part = last_part
                        .get_mut(vertex as usize)
                        .expect("an element names a vertex that does not exist");
                    assert!(
                        *last_part <= parts_before || *last_part == part,
                        "two parts of a stage share vertex {vertex}"
                    );
                    *last_part = part;
                }
            }
        }
        Self {
            vertices,
            stages,
            vertex_count,
        }
    }

    /// Visits every element once with its slot and a copy of its vertices, which is stored back: stage after stage, the
    /// parts of one on several threads if that is worth it. In order, or from the last to the first if it goes `BACK`.
    ///
    /// # Panics
    /// If there is not one element and one slot per stencil, or `x` is not as long as the vertices.
    pub(crate) fn visit<const BACK: bool, E: Sync, A: Send, P: Copy + Send>(
        &self,
        elements: &[E],
        slots: &mut [A],
        x: &mut [P],
        visit: impl Fn(&E, &mut A, &mut [P; N]) + Sync,
    ) {
        let nothing = vec![(); x.len()]; // takes no memory
        let visit =
            |element: &E, slot: &mut A, x: &mut [P; N], _: &[(); N]| visit(element, slot, x);
        self.visit_with::<BACK, E, A, P, ()>(elements, slots, x, &nothing, visit);
    }

    /// The same, and each visit is shown what `shared` holds for its vertices.
    ///
    /// # Panics
    /// As [`Stencils::visit`], and if `shared` is not as long as the vertices.
    pub(crate) fn visit_with<const BACK: bool, E: Sync, A: Send, P: Copy + Send, W: Copy + Sync>(
        &self,
        elements: &[E],
        slots: &mut [A],
        x: &mut [P],
        shared: &[W],
        visit: impl Fn(&E, &mut A, &mut [P; N], &[W; N]) + Sync,
    ) {
        let count = self.vertices.len();
        assert_eq!(elements.len(), count, "one stencil per element");
        assert_eq!(slots.len(), count, "one slot per element");
        assert_eq!(x.len(), self.vertex_count, "one position per vertex");
        assert_eq!(shared.len(), self.vertex_count, "one value per vertex");
        let stage_count = self.stages.len();
        for done in 0..stage_count {
            let stage = if BACK { stage_count - 1 - done } else { done };
            let parts = Parts {
                elements,
                stencils: &self.vertices,
                bounds: &self.stages[stage],
            };
            #[allow(unsafe_code)]
            // SAFETY: `new` made sure that all vertices are below `vertex_count`, and that no two parts of a stage share
            // one; there are as many positions and shared values.
            unsafe {
                visit_stage::<BACK, N, E, A, P, W>(&parts, slots, (x, shared), &visit);
            }
        }
    }

    /// Where the parts of each stage begin and end.
    pub(crate) fn stages(&self) -> &[Vec<usize>] {
        &self.stages
    }
}

/// Elements of one stage.
struct Parts<'a, const N: usize, E> {
    elements: &'a [E],
    stencils: &'a [[u32; N]],
    /// Part p is `bounds[p]..bounds[p + 1]`.
    bounds: &'a [usize],
}

impl<const N: usize, E> Parts<'_, N, E> {
    /// Where they stand among all elements.
    fn range(&self) -> Range<usize> {
        self.bounds[0]..self.bounds[self.bounds.len() - 1]
    }
}

/// Visits the elements of one stage.
///
/// # Safety
/// No vertex is in two of the parts, and all are below the numbers of positions and of shared values.
#[allow(unsafe_code)] // the reason is in the section above
unsafe fn visit_stage<
    const BACK: bool,
    const N: usize,
    E: Sync,
    A: Send,
    P: Copy + Send,
    W: Copy + Sync,
>(
    parts: &Parts<'_, N, E>,
    slots: &mut [A],
    (x, shared): (&mut [P], &[W]),
    visit: &(impl Fn(&E, &mut A, &mut [P; N], &[W; N]) + Sync),
) {
    let slots = &mut slots[parts.range()];
    let x = &Positions::new(x, shared);
    // SAFETY: `x` is borrowed mutably until this returns, so no one else touches it; the parts share no vertex, as the
    // caller says.
    unsafe {
        #[cfg(feature = "parallel")]
        if slots.len() >= SMALLEST_PARALLEL_SET && rayon::current_num_threads() > 1 {
            let grain = slots.len() / (4 * rayon::current_num_threads());
            visit_parts::<BACK, N, E, A, P, W>(parts, slots, x, grain, visit);
            return;
        }
        visit_part::<BACK, N, E, A, P, W>(parts, slots, x, visit);
    }
}

/// Splits the parts between threads until about `grain` elements are left.
///
/// # Safety
/// No vertex is in two of the parts, and while this runs, nobody else reads or writes the positions of their vertices.
/// All vertices are below the numbers of positions and of shared values.
#[cfg(feature = "parallel")]
#[allow(unsafe_code)] // the reason is in the section above
unsafe fn visit_parts<
    const BACK: bool,
    const N: usize,
    E: Sync,
    A: Send,
    P: Copy + Send,
    W: Copy + Sync,
>(
    parts: &Parts<'_, N, E>,
    slots: &mut [A],
    x: &Positions<'_, P, W>,
    grain: usize,
    visit: &(impl Fn(&E, &mut A, &mut [P; N], &[W; N]) + Sync),
) {
    if slots.len() <= grain || parts.bounds.len() <= 2 {
        // SAFETY: passed on.
        unsafe { visit_part::<BACK, N, E, A, P, W>(parts, slots, x, visit) };
        return;
    }
    let middle = parts.bounds.len() / 2;
    let half = |bounds| Parts { bounds, ..*parts };
    let (first, second) = (
        half(&parts.bounds[..=middle]),
        half(&parts.bounds[middle..]),
    );
    let (first_slots, second_slots) = slots.split_at_mut(first.range().len());
    // SAFETY: the two halves are of different parts, so they share no vertex.
    join_on_threads(
        || unsafe { visit_parts::<BACK, N, E, A, P, W>(&first, first_slots, x, grain, visit) },
        || unsafe { visit_parts::<BACK, N, E, A, P, W>(&second, second_slots, x, grain, visit) },
    );
}

/// Visits all elements of `parts` on this thread, in the best instructions that the processor has.
///
/// # Safety
/// While this runs, nobody else reads or writes the positions of the vertices of these parts. All vertices are below the
/// numbers of positions and of shared values.
#[allow(unsafe_code)] // the reason is in the section above
unsafe fn visit_part<const BACK: bool, const N: usize, E, A, P: Copy, W: Copy>(
    parts: &Parts<'_, N, E>,
    slots: &mut [A],
    x: &Positions<'_, P, W>,
    visit: &impl Fn(&E, &mut A, &mut [P; N], &[W; N]),
) {
    let range = parts.range();
    let (elements, stencils) = (&parts.elements[range.clone()], &parts.stencils[range]);
    #[cfg(target_arch = "x86_64")]
    if std::is_x86_feature_detected!("avx2") {
        // SAFETY: passed on, and the processor has the instructions.
        unsafe { visit_each_avx2::<BACK, N, E, A, P, W>(elements, stencils, slots, x, visit) };
        return;
    }
    // SAFETY: passed on.
    unsafe { visit_each::<BACK, N, E, A, P, W>(elements, stencils, slots, x, visit) }
}

/// [`visit_each`] in the instructions of newer processors, with the same bits, if `visit` is inlined.
///
/// # Safety
/// That of [`visit_each`], and the processor has AVX2.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
#[allow(unsafe_code)] // the reason is in the section above
unsafe fn visit_each_avx2<const BACK: bool, const N: usize, E, A, P: Copy, W: Copy>(
    elements: &[E],
    stencils: &[[u32; N]],
    slots: &mut [A],
    x: &Positions<'_, P, W>,
    visit: &impl Fn(&E, &mut A, &mut [P; N], &[W; N]),
) {
    // SAFETY: passed on.
    unsafe { visit_each::<BACK, N, E, A, P, W>(elements, stencils, slots, x, visit) }
}

/// Positions are prefetched this many elements ahead of their visit: long enough for the memory to answer.
const AHEAD: usize = 16;

/// With fewer vertices than this the positions are in a cache, and prefetching costs more than it saves.
const FAR: usize = 1 << 17;

/// The one loop behind all visits.
///
/// # Safety
/// While this runs, nobody else reads or writes the positions of these stencils' vertices. All vertices are below the
/// numbers of positions and of shared values.
#[allow(unsafe_code)] // the reason is in the section above
#[inline(always)]
unsafe fn visit_each<const BACK: bool, const N: usize, E, A, P: Copy, W: Copy>(
    elements: &[E],
    stencils: &[[u32; N]],
    slots: &mut [A],
    x: &Positions<'_, P, W>,
    visit: &impl Fn(&E, &mut A, &mut [P; N], &[W; N]),
) {
    let count = slots.len();
    let (elements, stencils) = (&elements[..count], &stencils[..count]);
    let place = |done: usize| if BACK { count - 1 - done } else { done };
    let far = x.count >= FAR;
    for first in (0..count).step_by(AHEAD) {
        if far {
            for done in (first + AHEAD)..(first + 2 * AHEAD).min(count) {
                for &vertex in &stencils[place(done)] {
                    fetch(x.first.wrapping_add(vertex as usize));
                }
            }
        }
        for done in first..(first + AHEAD).min(count) {
            let i = place(done);
            // Loops, because `map` to arrays of eight is a call.
            let mut places = [x.place(stencils[i][0]); N];
            for corner in 1..N {
                places[corner] = x.place(stencils[i][corner]);
            }
            // SAFETY: the places are in bounds and no other thread uses them, as the caller says, and aligned. No
            // reference to a position lives across `visit`.
            let mut local = [unsafe { *places[0] }; N];
            for corner in 1..N {
                // SAFETY: as above.
                local[corner] = unsafe { *places[corner] };
            }
            let mut shared = [x.shared[0]; N];
            for corner in 0..N {
                // SAFETY: in bounds, as the caller says.
                shared[corner] = unsafe { *x.shared.get_unchecked(stencils[i][corner] as usize) };
            }
            visit(&elements[i], &mut slots[i], &mut local, &shared);
            for i in 0..N {
                // SAFETY: as above.
                unsafe {
                    *places[i] = local[i];
                }
            }
        }
    }
}

/// The positions of all vertices, mutably borrowed, in a form that threads can share.
struct Positions<'a, P, W> {
    first: *mut P,
    count: usize,
    /// What all visits of a vertex are shown.
    shared: &'a [W],
    borrow: PhantomData<&'a mut [P]>,
}

// SAFETY: only `visit_each` uses the pointer, under the condition it states; what it hands from thread to thread is
// `Send`.
#[allow(unsafe_code)]
unsafe impl<P: Send, W: Sync> Sync for Positions<'_, P, W> {}

impl<'a, P, W> Positions<'a, P, W> {
    fn new(x: &'a mut [P], shared: &'a [W]) -> Self {
        Self {
            first: x.as_mut_ptr(),
            count: x.len(),
            shared,
            borrow: PhantomData,
        }
    }

    /// Where the position of a vertex below the number of positions lies.
    #[inline]
    fn place(&self, vertex: u32) -> *mut P {
        debug_assert!((vertex as usize) < self.count, "no such vertex");
        // Wrapping never happens; this form needs no `unsafe`.
        self.first.wrapping_add(vertex as usize)
    }
}

/// Asks the memory for `items[index]`, which will be read soon; nothing happens if there is no such item.
///
/// A loop that reads one long array and writes here and there in another does not look like a stream to the hardware,
/// and waits for every cache line: the product of a block matrix of 256 × 256 vertices takes 2.4 times as long without
/// this line (commit dac71dbe).
#[inline]
pub(crate) fn prefetch<T>(items: &[T], index: usize) {
    fetch(items.as_ptr().wrapping_add(index));
}

/// Asks the memory for what lies at `place`.
#[inline(always)]
fn fetch<T>(place: *const T) {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        #[allow(unsafe_code)]
        // SAFETY: a prefetch reads nothing and never faults, wherever the address points.
        unsafe {
            _mm_prefetch::<_MM_HINT_T0>(place.cast());
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = place;
}

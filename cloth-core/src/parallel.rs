//! Visiting elements in turn, or on several threads where they share no vertex; and a hint to the memory. The only file of a
//! library here with `unsafe`.

use std::marker::PhantomData;
use std::ops::Range;

/// Fewer elements than this are visited on one thread: waking a second one costs some microseconds,
/// and an element costs about five nanoseconds.
#[cfg(feature = "parallel")]
const SMALLEST_PARALLEL_SET: usize = 4096;

/// Elements in parts of which no two share a vertex.
pub(crate) struct Parts<'a, const N: usize, E> {
    elements: &'a [E],
    stencils: &'a [[u32; N]],
    /// Part p is `bounds[p]..bounds[p + 1]`.
    bounds: &'a [usize],
}

impl<'a, const N: usize, E> Parts<'a, N, E> {
    /// Takes the caller's word for it. Only [`crate::coloring::Colored`] calls this, with one of its stages:
    /// it made the parts from these very vertices, and no one can write to them since.
    pub(crate) fn trust(elements: &'a [E], stencils: &'a [[u32; N]], bounds: &'a [usize]) -> Self {
        Self {
            elements,
            stencils,
            bounds,
        }
    }

    /// Where they stand among all elements.
    fn range(&self) -> Range<usize> {
        self.bounds[0]..self.bounds[self.bounds.len() - 1]
    }
}

/// Visits each element of `parts` once with its slot and a copy of its vertices, which is stored back; on several threads if that is worth
/// it. In order, or from the last to the first if it goes `BACK`.
pub(crate) fn visit<const BACK: bool, const N: usize, E: Sync, A: Send, P: Copy + Send>(
    parts: &Parts<'_, N, E>,
    slots: &mut [A],
    x: &mut [P],
    visit: &(impl Fn(&E, &mut A, &mut [P; N]) + Sync),
) {
    let slots = &mut slots[parts.range()];
    #[allow(unsafe_code)]
    // SAFETY: `x` is borrowed mutably until this returns, so no one else touches it.
    unsafe {
        let x = &Positions::new(x);
        #[cfg(feature = "parallel")]
        if slots.len() >= SMALLEST_PARALLEL_SET && rayon::current_num_threads() > 1 {
            let grain = slots.len() / (4 * rayon::current_num_threads());
            visit_parts::<BACK, N, E, A, P>(parts, slots, x, grain, visit);
            return;
        }
        visit_part::<BACK, N, E, A, P>(parts, slots, x, visit);
    }
}

/// Splits the parts between threads until about `grain` elements are left.
///
/// # Safety
/// While this runs, nobody else reads or writes the positions of the vertices of these parts.
#[cfg(feature = "parallel")]
#[allow(unsafe_code)] // the reason is in the section above
unsafe fn visit_parts<const BACK: bool, const N: usize, E: Sync, A: Send, P: Copy + Send>(
    parts: &Parts<'_, N, E>,
    slots: &mut [A],
    x: &Positions<'_, P>,
    grain: usize,
    visit: &(impl Fn(&E, &mut A, &mut [P; N]) + Sync),
) {
    if slots.len() <= grain || parts.bounds.len() <= 2 {
        // SAFETY: passed on.
        unsafe { visit_part::<BACK, N, E, A, P>(parts, slots, x, visit) };
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
    rayon::join(
        || unsafe { visit_parts::<BACK, N, E, A, P>(&first, first_slots, x, grain, visit) },
        || unsafe { visit_parts::<BACK, N, E, A, P>(&second, second_slots, x, grain, visit) },
    );
}

/// Visits all elements of `parts` on this thread, in the best instructions that the processor has.
///
/// # Safety
/// While this runs, nobody else reads or writes the positions of the vertices of these parts.
#[allow(unsafe_code)] // the reason is in the section above
unsafe fn visit_part<const BACK: bool, const N: usize, E, A, P: Copy>(
    parts: &Parts<'_, N, E>,
    slots: &mut [A],
    x: &Positions<'_, P>,
    visit: &impl Fn(&E, &mut A, &mut [P; N]),
) {
    let range = parts.range();
    let (elements, stencils) = (&parts.elements[range.clone()], &parts.stencils[range]);
    #[cfg(target_arch = "x86_64")]
    if std::is_x86_feature_detected!("avx2") {
        // SAFETY: passed on, and the processor has the instructions.
        unsafe { visit_each_avx2::<BACK, N, E, A, P>(elements, stencils, slots, x, visit) };
        return;
    }
    // SAFETY: passed on.
    unsafe { visit_each::<BACK, N, E, A, P>(elements, stencils, slots, x, visit) }
}

/// [`visit_each`] in the instructions of newer processors, with the same bits, if `visit` is inlined: a twentieth faster. Above all, a root does not wait
/// there for whatever its target register held before. In the older instructions it does unless the compiler takes care, which can make one chain
/// of all elements and double the time.
///
/// # Safety
/// That of [`visit_each`], and the processor has AVX2.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
#[allow(unsafe_code)] // the reason is in the section above
unsafe fn visit_each_avx2<const BACK: bool, const N: usize, E, A, P: Copy>(
    elements: &[E],
    stencils: &[[u32; N]],
    slots: &mut [A],
    x: &Positions<'_, P>,
    visit: &impl Fn(&E, &mut A, &mut [P; N]),
) {
    // SAFETY: passed on.
    unsafe { visit_each::<BACK, N, E, A, P>(elements, stencils, slots, x, visit) }
}

/// Positions are asked for while so many elements before them are visited: long enough for the memory to answer.
const AHEAD: usize = 16;

/// With fewer vertices than this the positions are in a cache, and asking for them costs more than it saves.
const FAR: usize = 1 << 17;

/// The one loop behind all visits.
///
/// # Safety
/// While this runs, nobody else reads or writes the positions of these stencils' vertices.
#[allow(unsafe_code)] // the reason is in the section above
#[inline(always)]
unsafe fn visit_each<const BACK: bool, const N: usize, E, A, P: Copy>(
    elements: &[E],
    stencils: &[[u32; N]],
    slots: &mut [A],
    x: &Positions<'_, P>,
    visit: &impl Fn(&E, &mut A, &mut [P; N]),
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
            // SAFETY: the places are in bounds and aligned, and no other thread uses them, as the caller says. No reference to
            // a position lives across `visit`.
            let mut local = [unsafe { *places[0] }; N];
            for corner in 1..N {
                // SAFETY: as above.
                local[corner] = unsafe { *places[corner] };
            }
            visit(&elements[i], &mut slots[i], &mut local);
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
struct Positions<'a, P> {
    first: *mut P,
    count: usize,
    borrow: PhantomData<&'a mut [P]>,
}

#[allow(unsafe_code)] // SAFETY: only `visit_each` uses the pointer, under the condition it states; what it hands from thread to thread is `Send`.
unsafe impl<P: Send> Sync for Positions<'_, P> {}

impl<'a, P> Positions<'a, P> {
    fn new(x: &'a mut [P]) -> Self {
        Self {
            first: x.as_mut_ptr(),
            count: x.len(),
            borrow: PhantomData,
        }
    }

    /// Where a position lies.
    #[inline]
    fn place(&self, vertex: u32) -> *mut P {
        assert!((vertex as usize) < self.count, "no such vertex");
        // In bounds, so wrapping never happens; this form needs no `unsafe`.
        self.first.wrapping_add(vertex as usize)
    }
}

/// Asks the memory for `items[index]`, which will be read soon; nothing happens if there is no such item.
///
/// A loop that reads one long array and writes here and there in another does not look like a stream to the
/// hardware, and waits for every cache line: the product of a block matrix of 256 × 256 vertices takes 2.4 times as long
/// without this line.
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

//! Visiting elements in turn, or on several threads where they share no vertex; and a hint to the memory. The only file of a
//! library here with `unsafe`.

use crate::math::Vec3;
use std::marker::PhantomData;

/// Fewer elements than this are visited on one thread: waking a second one costs some microseconds,
/// and an element costs about ten nanoseconds.
#[cfg(feature = "parallel")]
const SMALLEST_PARALLEL_SET: usize = 8192;

/// Visits each element once, in order, with a copy of its vertices, which is stored back.
pub(crate) fn visit_in_order<const N: usize, E, A>(
    elements: &[E],
    stencils: &[[u32; N]],
    slots: &mut [A],
    x: &mut [Vec3],
    visit: &impl Fn(&E, &mut A, &mut [Vec3; N]),
) {
    #[allow(unsafe_code)]
    // SAFETY: `x` is borrowed mutably until this returns, so no other thread touches it.
    unsafe {
        visit_each(elements, stencils, slots, &Positions::new(x), visit);
    }
}

/// Stencils of which no two share a vertex.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Disjoint<'a, const N: usize>(&'a [[u32; N]]);

impl<'a, const N: usize> Disjoint<'a, N> {
    /// Takes the caller's word for it. Only [`crate::coloring::Colored`] calls this, with one of its colours:
    /// it made the colours from these very vertices, and no one can write to them since.
    pub(crate) fn trust(vertices: &'a [[u32; N]]) -> Self {
        Self(vertices)
    }
}

/// Visits each element once with a copy of its vertices, which is stored back; on several threads if that is worth it.
pub(crate) fn visit_disjoint<const N: usize, E: Sync, A: Send>(
    elements: &[E],
    stencils: Disjoint<'_, N>,
    slots: &mut [A],
    x: &mut [Vec3],
    visit: &(impl Fn(&E, &mut A, &mut [Vec3; N]) + Sync),
) {
    #[cfg(feature = "parallel")]
    if elements.len() >= SMALLEST_PARALLEL_SET && rayon::current_num_threads() > 1 {
        use rayon::prelude::*;

        let x = Positions::new(x);
        let chunk = elements
            .len()
            .div_ceil(4 * rayon::current_num_threads())
            .max(SMALLEST_PARALLEL_SET / 8);
        elements
            .par_chunks(chunk)
            .zip(stencils.0.par_chunks(chunk))
            .zip(slots.par_chunks_mut(chunk))
            .for_each(|((elements, stencils), slots)| {
                #[allow(unsafe_code)]
                // SAFETY: the stencils of other chunks share no vertex with these, because all are `Disjoint`, and
                // each chunk is visited by one thread; nobody else has `x`, which is borrowed mutably until this returns.
                unsafe {
                    visit_each(elements, stencils, slots, &x, visit);
                }
            });
        return;
    }
    visit_in_order(elements, stencils.0, slots, x, visit);
}

/// The one loop behind all visits, and the one place that calls `visit`: a closure that is called
/// in several places is not inlined into any of them, which doubles the time of a spring.
///
/// # Safety
/// While this runs, no other thread reads or writes the positions of these stencils' vertices.
#[allow(unsafe_code)] // the reason is in the section above
unsafe fn visit_each<const N: usize, E, A>(
    elements: &[E],
    stencils: &[[u32; N]],
    slots: &mut [A],
    x: &Positions<'_>,
    visit: &impl Fn(&E, &mut A, &mut [Vec3; N]),
) {
    for ((element, slot), stencil) in elements.iter().zip(slots).zip(stencils) {
        let places = stencil.map(|vertex| x.place(vertex));
        // SAFETY: the places are in bounds and aligned, and no other thread uses them, as the caller says. No reference to
        // a position lives across `visit`.
        let mut local = places.map(|place| unsafe { *place });
        visit(element, slot, &mut local);
        for i in 0..N {
            // SAFETY: as above.
            unsafe {
                *places[i] = local[i];
            }
        }
    }
}

/// The positions of all vertices, mutably borrowed, in a form that threads can share.
struct Positions<'a> {
    first: *mut Vec3,
    count: usize,
    borrow: PhantomData<&'a mut [Vec3]>,
}

#[allow(unsafe_code)] // SAFETY: only `visit_each` uses the pointer, under the condition it states.
unsafe impl Sync for Positions<'_> {}

impl<'a> Positions<'a> {
    fn new(x: &'a mut [Vec3]) -> Self {
        Self {
            first: x.as_mut_ptr(),
            count: x.len(),
            borrow: PhantomData,
        }
    }

    /// Where a position lies.
    #[inline]
    fn place(&self, vertex: u32) -> *mut Vec3 {
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
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        let place = items.as_ptr().wrapping_add(index);
        #[allow(unsafe_code)]
        // SAFETY: a prefetch reads nothing and never faults, wherever the address points.
        unsafe {
            _mm_prefetch::<_MM_HINT_T0>(place.cast());
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (items, index);
}

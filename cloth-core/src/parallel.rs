//! Visiting elements that share no vertex, on one thread or on several. The only file of the workspace with `unsafe`.

use crate::math::{Vec3, gather};

/// Fewer elements than this are visited on one thread: waking a second one costs some microseconds,
/// and an element costs about ten nanoseconds.
#[cfg(feature = "parallel")]
const SMALLEST_PARALLEL_SET: usize = 8192;

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

/// Visits each element once with a copy of its vertices, which is stored back.
pub(crate) fn visit_disjoint<const N: usize, E: Sync, A: Send>(
    elements: &[E],
    vertices: Disjoint<'_, N>,
    slots: &mut [A],
    x: &mut [Vec3],
    visit: &(impl Fn(&E, &mut A, &mut [Vec3; N]) + Sync),
) {
    #[cfg(feature = "parallel")]
    if elements.len() >= SMALLEST_PARALLEL_SET && rayon::current_num_threads() > 1 {
        return on_threads(elements, vertices, slots, x, visit);
    }
    for ((element, slot), &stencil) in elements.iter().zip(slots).zip(vertices.0) {
        let mut local = gather(x, stencil);
        visit(element, slot, &mut local);
        for i in 0..N {
            x[stencil[i] as usize] = local[i];
        }
    }
}

#[cfg(feature = "parallel")]
fn on_threads<const N: usize, E: Sync, A: Send>(
    elements: &[E],
    vertices: Disjoint<'_, N>,
    slots: &mut [A],
    x: &mut [Vec3],
    visit: &(impl Fn(&E, &mut A, &mut [Vec3; N]) + Sync),
) {
    use rayon::prelude::*;

    struct Shared(*mut Vec3, usize);
    #[allow(unsafe_code)] // SAFETY: see `get` and `set`, the only users of the pointer.
    unsafe impl Sync for Shared {}
    impl Shared {
        fn get(&self, vertex: u32) -> Vec3 {
            assert!((vertex as usize) < self.1);
            #[allow(unsafe_code)]
            // SAFETY: in bounds by the assertion. No other thread reads or writes this vertex: the stencils are `Disjoint`,
            // each is visited by one thread only, and a thread touches only the vertices of the stencil it visits.
            unsafe {
                *self.0.add(vertex as usize)
            }
        }
        fn set(&self, vertex: u32, position: Vec3) {
            assert!((vertex as usize) < self.1);
            #[allow(unsafe_code)]
            // SAFETY: as in `get`; and `x` stays mutably borrowed while `Shared` lives.
            unsafe {
                *self.0.add(vertex as usize) = position;
            }
        }
    }

    let shared = Shared(x.as_mut_ptr(), x.len());
    let shared = &shared;
    let chunk = elements
        .len()
        .div_ceil(4 * rayon::current_num_threads())
        .max(SMALLEST_PARALLEL_SET / 8);
    elements
        .par_chunks(chunk)
        .zip(vertices.0.par_chunks(chunk))
        .zip(slots.par_chunks_mut(chunk))
        .for_each(|((elements, stencils), slots)| {
            for ((element, slot), stencil) in elements.iter().zip(slots).zip(stencils) {
                let mut local = stencil.map(|vertex| shared.get(vertex));
                visit(element, slot, &mut local);
                for i in 0..N {
                    shared.set(stencil[i], local[i]);
                }
            }
        });
}

//! Elements sorted into colours, so that those of one colour can be visited in any order.
//!
//! Gauss–Seidel visits elements one after another, each seeing what the one before it wrote. Two elements that share no vertex do not
//! see each other. A *colour* is a set of elements of which no two share a vertex: visiting it in
//! parallel gives the same bits as visiting it in turn.

use crate::element::Element;
use crate::math::{Vec3, gather};
use crate::parallel;

/// Elements of one type in the order in which a sweep visits them (CORE-13).
///
/// Either sorted by colour ([`Colored::new`]) or in the order given ([`Colored::in_input_order`]). The fields are private, so
/// that "no two elements of a colour share a vertex, and every vertex exists" is a property of the type; the parallel sweep rests on it.
#[derive(Clone, Debug)]
pub struct Colored<const N: usize, E> {
    elements: Vec<E>,
    /// Vertices of each element, as they were when the colours were made.
    vertices: Vec<[u32; N]>,
    /// Colour `c` is `elements[offsets[c]..offsets[c + 1]]`. Empty if not coloured.
    offsets: Vec<usize>,
    /// Position in the input of each element.
    input_index: Vec<u32>,
    vertex_count: usize,
}

impl<const N: usize, E: Element<N>> Colored<N, E> {
    /// Colours greedily in input order, then sorts stably by colour.
    ///
    /// # Panics
    /// If an element names a vertex that is not smaller than `vertex_count`, or names one twice.
    #[must_use]
    pub fn new(elements: &[E], vertex_count: usize) -> Self {
        let colors = greedy_colors(elements, vertex_count);
        let color_count = colors.iter().map(|&c| c as usize + 1).max().unwrap_or(0);
        let mut offsets = vec![0; color_count + 1];
        for &color in &colors {
            offsets[color as usize + 1] += 1;
        }
        for color in 0..color_count {
            offsets[color + 1] += offsets[color];
        }
        let mut input_index: Vec<u32> = (0..elements.len() as u32).collect();
        input_index.sort_by_key(|&index| colors[index as usize]);
        Self::stored(elements, offsets, input_index, vertex_count)
    }

    /// Keeps the order given; sweeps run on one thread.
    ///
    /// # Panics
    /// If an element names a vertex that is not smaller than `vertex_count`.
    #[must_use]
    pub fn in_input_order(elements: &[E], vertex_count: usize) -> Self {
        let input_index = (0..elements.len() as u32).collect();
        Self::stored(elements, Vec::new(), input_index, vertex_count)
    }

    fn stored(
        elements: &[E],
        offsets: Vec<usize>,
        input_index: Vec<u32>,
        vertex_count: usize,
    ) -> Self {
        let elements: Vec<E> = input_index.iter().map(|&i| elements[i as usize]).collect();
        let vertices: Vec<[u32; N]> = elements.iter().map(Element::vertices).collect();
        assert!(
            vertices
                .iter()
                .flatten()
                .all(|&v| (v as usize) < vertex_count),
            "an element names a vertex that does not exist"
        );
        Self {
            elements,
            vertices,
            offsets,
            input_index,
            vertex_count,
        }
    }

    /// The elements in visiting order.
    #[must_use]
    pub fn elements(&self) -> &[E] {
        &self.elements
    }

    /// For each element in visiting order, where it stood in the input.
    #[must_use]
    pub fn input_index(&self) -> &[u32] {
        &self.input_index
    }

    /// Number of colours; 0 if the elements were kept in input order.
    #[must_use]
    pub fn color_count(&self) -> usize {
        self.offsets.len().saturating_sub(1)
    }

    /// Elements of one colour.
    ///
    /// # Panics
    /// If there is no such colour.
    #[must_use]
    pub fn color(&self, color: usize) -> &[E] {
        &self.elements[self.offsets[color]..self.offsets[color + 1]]
    }

    /// Visits every element once. `visit` gets the element, its slot of the method's own memory, and a copy of its
    /// vertices' positions, which is stored back afterwards.
    ///
    /// With the feature `parallel`, colours large enough to be worth it are split over rayon's threads; the result has the same bits as on one thread.
    ///
    /// # Panics
    /// If `slots` is not as long as the elements, or `x` not as long as the vertices.
    pub fn sweep<A: Send>(
        &self,
        slots: &mut [A],
        x: &mut [Vec3],
        visit: impl Fn(&E, &mut A, &mut [Vec3; N]) + Sync,
    ) {
        assert_eq!(slots.len(), self.elements.len(), "one slot per element");
        assert_eq!(x.len(), self.vertex_count, "one position per vertex");
        if self.offsets.is_empty() {
            parallel::visit_in_order(&self.elements, &self.vertices, slots, x, &visit);
            return;
        }
        for range in self.offsets.windows(2).map(|w| w[0]..w[1]) {
            parallel::visit_disjoint(
                &self.elements[range.clone()],
                parallel::Disjoint::trust(&self.vertices[range.clone()]),
                &mut slots[range],
                x,
                &visit,
            );
        }
    }

    /// The same the other way round: colour by colour from the last to the first, or the input order backwards.
    ///
    /// # Panics
    /// If `slots` is not as long as the elements, or `x` not as long as the vertices.
    pub fn sweep_back<A: Send>(
        &self,
        slots: &mut [A],
        x: &mut [Vec3],
        visit: impl Fn(&E, &mut A, &mut [Vec3; N]) + Sync,
    ) {
        assert_eq!(slots.len(), self.elements.len(), "one slot per element");
        assert_eq!(x.len(), self.vertex_count, "one position per vertex");
        // Within a colour the order makes no difference.
        for range in self.offsets.windows(2).map(|w| w[0]..w[1]).rev() {
            parallel::visit_disjoint(
                &self.elements[range.clone()],
                parallel::Disjoint::trust(&self.vertices[range.clone()]),
                &mut slots[range],
                x,
                &visit,
            );
        }
        if self.offsets.is_empty() {
            let backwards = self.elements.iter().zip(slots).zip(&self.vertices).rev();
            for ((element, slot), vertices) in backwards {
                let mut local = gather(x, *vertices);
                visit(element, slot, &mut local);
                for (&vertex, moved) in vertices.iter().zip(local) {
                    x[vertex as usize] = moved;
                }
            }
        }
    }
}

/// The smallest colour that no earlier element at a shared vertex has, for each element in turn.
fn greedy_colors<const N: usize, E: Element<N>>(elements: &[E], vertex_count: usize) -> Vec<u32> {
    // Colours in use at each vertex, 64 to a word; words are added where a vertex needs more.
    let mut words = 1;
    let mut used = vec![0u64; vertex_count];
    let mut colors = Vec::with_capacity(elements.len());
    for element in elements {
        let vertices = element.vertices();
        for (i, vertex) in vertices.iter().enumerate() {
            assert!(
                !vertices[..i].contains(vertex),
                "an element names vertex {vertex} twice"
            );
        }
        let free = (0..words).find_map(|word| {
            let taken = vertices
                .iter()
                .fold(0, |taken, &v| taken | used[v as usize * words + word]);
            (taken != u64::MAX).then(|| word * 64 + taken.trailing_ones() as usize)
        });
        let color = free.unwrap_or_else(|| {
            let mut wider = vec![0u64; vertex_count * (words + 1)];
            for (to, from) in wider
                .chunks_exact_mut(words + 1)
                .zip(used.chunks_exact(words))
            {
                to[..words].copy_from_slice(from);
            }
            used = wider;
            words += 1;
            (words - 1) * 64
        });
        for &v in &vertices {
            used[v as usize * words + color / 64] |= 1 << (color % 64);
        }
        colors.push(color as u32);
    }
    colors
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::energy::Spring;

    fn star(arms: u32) -> Vec<Spring> {
        (1..=arms)
            .map(|tip| Spring {
                vertices: [0, tip],
                rest_length: 1.0,
                stiffness: 1.0,
            })
            .collect()
    }

    fn ring(vertex_count: u32) -> Vec<Spring> {
        (0..vertex_count)
            .map(|v| Spring {
                vertices: [v, (v + 1) % vertex_count],
                rest_length: 1.0,
                stiffness: 1.0,
            })
            .collect()
    }

    #[test]
    fn a_star_needs_as_many_colors_as_arms_even_beyond_a_word() {
        let colored = Colored::new(&star(200), 201);
        assert_eq!(colored.color_count(), 200);
    }

    #[test]
    fn no_two_elements_of_a_color_share_a_vertex_and_none_is_lost() {
        let colored = Colored::new(&ring(101), 101);
        assert_eq!(colored.color_count(), 3, "an odd ring needs three colours");
        let mut seen = vec![0; 101];
        for color in 0..colored.color_count() {
            let mut taken = [false; 101];
            for spring in colored.color(color) {
                for v in spring.vertices {
                    assert!(!std::mem::replace(&mut taken[v as usize], true));
                }
            }
        }
        for &index in colored.input_index() {
            seen[index as usize] += 1;
        }
        assert!(seen.iter().all(|&n| n == 1));
    }

    #[test]
    fn input_order_is_kept_where_asked_for() {
        let springs = ring(7);
        let kept = Colored::in_input_order(&springs, 7);
        assert_eq!(kept.elements(), &springs[..]);
        // Each visit sees what the one before it wrote: a running sum round the ring.
        let mut x: Vec<Vec3> = (0..7).map(|_| Vec3::new(1.0, 0.0, 0.0)).collect();
        kept.sweep(&mut [(); 7], &mut x, |_, (), local| local[1] += local[0]);
        assert_eq!(
            x.iter().map(|p| p.x).collect::<Vec<_>>(),
            [8.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]
        );
        // And back: vertex 0 gets the 8 that it gave, then each the sum of the one before it as it is now.
        kept.sweep_back(&mut [(); 7], &mut x, |_, (), local| local[1] += local[0]);
        assert_eq!(
            x.iter().map(|p| p.x).collect::<Vec<_>>(),
            [15.0, 17.0, 5.0, 7.0, 9.0, 11.0, 13.0]
        );
    }

    #[test]
    fn a_coloured_sweep_goes_back_as_it_came() {
        let colored = Colored::new(&ring(9), 9);
        let mut order = vec![0_usize; 9];
        let next = std::sync::atomic::AtomicUsize::new(1);
        let visit = |_: &Spring, slot: &mut usize, _: &mut [Vec3; 2]| {
            *slot = next.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        };
        let mut x = vec![Vec3::zeros(); 9];
        colored.sweep(&mut order, &mut x, visit);
        assert_eq!(order, [1, 2, 3, 4, 5, 6, 7, 8, 9]);
        colored.sweep_back(&mut order, &mut x, visit);
        // Colour after colour: of four, of four, of one.
        assert_eq!(order, [15, 16, 17, 18, 11, 12, 13, 14, 10]);
    }

    #[test]
    fn a_coloured_sweep_gives_the_same_bits_at_any_thread_count() {
        let count = 60_001;
        let colored = Colored::new(&ring(count), count as usize);
        let visit = |s: &Spring, slot: &mut f64, x: &mut [Vec3; 2]| {
            let pull = (x[1] - x[0]) * 0.3 + Vec3::repeat(*slot);
            x[0] += pull;
            x[1] -= pull;
            *slot += x[0].x * 0.01 + f64::from(s.vertices[0]) * 1e-6;
        };
        let start: Vec<Vec3> = (0..count)
            .map(|i| {
                Vec3::new(
                    f64::from(i).sin(),
                    f64::from(i).cos(),
                    0.1 * f64::from(i % 17),
                )
            })
            .collect();
        let run = || {
            let mut x = start.clone();
            let mut slots = vec![0.0; count as usize];
            for _ in 0..3 {
                colored.sweep(&mut slots, &mut x, visit);
            }
            (x, slots)
        };
        let mut by_hand = (start.clone(), vec![0.0; count as usize]);
        for _ in 0..3 {
            for (i, s) in colored.elements().iter().enumerate() {
                let mut local = gather(&by_hand.0, s.vertices);
                visit(s, &mut by_hand.1[i], &mut local);
                for (v, p) in s.vertices.into_iter().zip(local) {
                    by_hand.0[v as usize] = p;
                }
            }
        }
        assert!(by_hand == run());
        #[cfg(feature = "parallel")]
        for threads in [1, 2, 4] {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            assert!(by_hand == pool.install(run), "{threads} threads");
        }
    }
}

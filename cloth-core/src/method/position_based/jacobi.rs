//! Jacobi sweeps: corrections of all elements first, then their sum at every vertex.

use crate::math::{Real, Vec3};

/// Fewer elements or vertices than this stay on one thread.
#[cfg(feature = "parallel")]
const SMALLEST_PARALLEL_SET: usize = 8192;

/// The corrections of all elements of all families, and for each vertex the places of its own.
///
/// No two threads ever write to the same place: elements write their corrections side by side, then vertices
/// read. A vertex adds them up in a fixed order, so the bits do not depend on the number of threads.
#[derive(Clone, Debug, Default)]
pub(super) struct Corrections {
    /// Δx (m), N per element, family after family.
    moves: Vec<Vec3>,
    /// Places in `moves` of vertex v: `places[starts[v]..starts[v + 1]]`, ascending.
    places: Vec<u32>,
    starts: Vec<u32>,
}

impl Corrections {
    /// The table for elements whose vertices stand one after another in `vertices`, family after family.
    pub(super) fn new(vertices: &[u32], vertex_count: usize) -> Self {
        let mut starts = vec![0_u32; vertex_count + 1];
        for &vertex in vertices {
            starts[vertex as usize + 1] += 1;
        }
        for vertex in 0..vertex_count {
            starts[vertex + 1] += starts[vertex];
        }
        let mut next = starts.clone();
        let mut places = vec![0; vertices.len()];
        for (place, &vertex) in vertices.iter().enumerate() {
            let slot = &mut next[vertex as usize];
            places[*slot as usize] = place as u32;
            *slot += 1;
        }
        Self {
            moves: vec![Vec3::zeros(); vertices.len()],
            places,
            starts,
        }
    }

    /// Number of elements at a vertex.
    pub(super) fn valence(&self, vertex: u32) -> u32 {
        let vertex = vertex as usize;
        self.starts[vertex + 1] - self.starts[vertex]
    }

    /// Δx (m), to be written to.
    pub(super) fn moves_mut(&mut self) -> &mut [Vec3] {
        &mut self.moves
    }

    /// Adds the corrections to the vertices.
    pub(super) fn apply(&self, x: &mut [Vec3]) {
        assert_eq!(x.len() + 1, self.starts.len(), "one position per vertex");
        #[cfg(feature = "parallel")]
        if x.len() >= SMALLEST_PARALLEL_SET && rayon::current_num_threads() > 1 {
            use rayon::prelude::*;
            const CHUNK: usize = SMALLEST_PARALLEL_SET / 8;
            x.par_chunks_mut(CHUNK)
                .enumerate()
                .for_each(|(chunk, x)| self.add_from(chunk * CHUNK, x));
            return;
        }
        self.add_from(0, x);
    }

    /// Adds to the vertices from number `first` on, whose positions are `x`.
    fn add_from(&self, first: usize, x: &mut [Vec3]) {
        for (x, range) in x.iter_mut().zip(self.starts[first..].windows(2)) {
            for &place in &self.places[range[0] as usize..range[1] as usize] {
                *x += self.moves[place as usize];
            }
        }
    }
}

/// The averaging fraction of an element with these vertices: `1/n`, n the largest number of elements at one of
/// its free vertices.
pub(super) fn fraction(vertices: &[u32], inverse_mass: &[Real], corrections: &Corrections) -> Real {
    let meeting = vertices
        .iter()
        .filter(|&&v| inverse_mass[v as usize] > 0.0)
        .map(|&v| corrections.valence(v));
    1.0 / Real::from(meeting.max().unwrap_or(1))
}

/// Computes the corrections of every element, each with its fraction and its memory.
pub(super) fn each_element<const N: usize, E: Sync, A: Send>(
    elements: &[E],
    fractions: &[Real],
    memory: &mut [A],
    moves: &mut [[Vec3; N]],
    correct: impl Fn(&E, &Real, &mut A) -> [Vec3; N] + Sync,
) {
    assert_eq!(fractions.len(), elements.len(), "one fraction per element");
    assert_eq!(moves.len(), elements.len(), "N corrections per element");
    // The one place that calls `correct`, so that it is inlined.
    let each = |elements: &[E], fractions: &[Real], memory: &mut [A], moves: &mut [[Vec3; N]]| {
        let of_element = elements.iter().zip(fractions).zip(memory).zip(moves);
        for (((element, fraction), memory), moves) in of_element {
            *moves = correct(element, fraction, memory);
        }
    };
    #[cfg(feature = "parallel")]
    if elements.len() >= SMALLEST_PARALLEL_SET && rayon::current_num_threads() > 1 {
        use rayon::prelude::*;
        const CHUNK: usize = SMALLEST_PARALLEL_SET / 8;
        elements
            .par_chunks(CHUNK)
            .zip(fractions.par_chunks(CHUNK))
            .zip(memory.par_chunks_mut(CHUNK))
            .zip(moves.par_chunks_mut(CHUNK))
            .for_each(|(((elements, fractions), memory), moves)| {
                each(elements, fractions, memory, moves);
            });
        return;
    }
    each(elements, fractions, memory, moves);
}

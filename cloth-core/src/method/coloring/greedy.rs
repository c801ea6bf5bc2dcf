//! A colour for every element, and for every vertex.

use crate::method::block_matrix::BlockPattern;

/// The smallest colour that no earlier element at a shared vertex has, for each element in turn. `stencils` are their
/// vertices.
///
/// # Panics
/// If an element names a vertex that is not smaller than `vertex_count`, or names one twice.
#[must_use]
pub fn greedy_colors<const N: usize>(stencils: &[[u32; N]], vertex_count: usize) -> Vec<u32> {
    // Colours in use at each vertex, 64 to a word; words are added where a vertex needs more.
    let mut words = 1;
    let mut used = vec![0u64; vertex_count];
    let mut colors = Vec::with_capacity(stencils.len());
    for vertices in stencils {
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
        for &v in vertices {
            used[v as usize * words + color / 64] |= 1 << (color % 64);
        }
        colors.push(color as u32);
    }
    colors
}

/// Vertices by colour: each has the smallest colour that none of its neighbours before it has. Its neighbours are
/// those that it has a block with.
#[must_use]
pub fn greedy_vertex_colors(pattern: &BlockPattern) -> Vec<Vec<u32>> {
    let mut colors: Vec<Vec<u32>> = Vec::new();
    let mut color_of: Vec<usize> = Vec::with_capacity(pattern.row_count());
    // The last vertex that found each colour taken.
    let mut taken_for = Vec::new();
    for vertex in 0..pattern.row_count() {
        for &neighbor in &pattern.columns()[pattern.row(vertex)] {
            if let Some(&color) = color_of.get(neighbor as usize) {
                taken_for[color] = vertex;
            }
        }
        let free = taken_for.iter().position(|&by| by != vertex);
        let color = free.unwrap_or(colors.len());
        if color == colors.len() {
            colors.push(Vec::new());
            taken_for.push(usize::MAX);
        }
        colors[color].push(vertex as u32);
        color_of.push(color);
    }
    colors
}

//! Orders of elimination: what they cut, and what they cost.

use cloth_core::math::Real;
use cloth_core::method::linear::{FillOrdering, UpperPattern};

/// The upper half of a dense pattern of nonzeros.
fn upper(nonzero: &[Vec<bool>]) -> UpperPattern {
    let mut pattern = UpperPattern {
        column_offsets: vec![0],
        rows: Vec::new(),
    };
    for column in 0..nonzero.len() {
        let rows = (0..=column).filter(|&row| nonzero[row][column]);
        pattern.rows.extend(rows.map(|row| row as u32));
        pattern.column_offsets.push(pattern.rows.len() as u32);
    }
    pattern
}

/// A grid with both diagonals, and a piece of its own.
fn pairs(side: u32) -> (usize, Vec<[u32; 2]>) {
    let mut pairs = Vec::new();
    for row in 0..side {
        for column in 0..side {
            let v = row * side + column;
            if column + 1 < side {
                pairs.push([v, v + 1]);
            }
            if row + 1 < side {
                pairs.push([v, v + side]);
            }
            if row + 1 < side && column + 1 < side {
                pairs.extend([[v, v + side + 1], [v + 1, v + side]]);
            }
        }
    }
    let last = side * side;
    pairs.push([last, last + 1]);
    (last as usize + 2, pairs)
}

/// The order of nested dissection of a graph.
fn dissected(count: usize, pairs: &[[u32; 2]]) -> Vec<u32> {
    let mut nonzero = vec![vec![false; count]; count];
    (0..count).for_each(|v| nonzero[v][v] = true);
    for pair in pairs {
        let [a, b] = pair.map(|v| v as usize);
        nonzero[a.min(b)][a.max(b)] = true;
    }
    let found = FillOrdering::NestedDissection.elimination(&upper(&nonzero));
    found.unwrap().sequence
}

#[test]
fn every_vertex_comes_once() {
    let (count, pairs) = pairs(23);
    let mut sequence = dissected(count, &pairs);
    sequence.sort_unstable();
    assert!(sequence.into_iter().eq(0..count as u32));
}

#[test]
fn the_last_vertices_cut_the_grid_in_two() {
    let (count, pairs) = pairs(31);
    let order = dissected(count, &pairs);
    // Without the last cut, of a side or so, no piece is larger than three quarters.
    let removed: Vec<u32> = order[count - 62..].to_vec();
    let mut piece: Vec<u32> = (0..count as u32).collect();
    let root = |piece: &[u32], mut v: u32| {
        while piece[v as usize] != v {
            v = piece[v as usize];
        }
        v
    };
    for &[a, b] in &pairs {
        if !removed.contains(&a) && !removed.contains(&b) {
            let (a, b) = (root(&piece, a), root(&piece, b));
            piece[a.max(b) as usize] = a.min(b);
        }
    }
    let mut sizes = vec![0; count];
    (0..count as u32).for_each(|v| sizes[root(&piece, v) as usize] += 1);
    assert!(*sizes.iter().max().unwrap() < 3 * count / 4);
}

#[test]
fn the_count_is_that_of_elimination_on_paper() {
    let n = 40;
    let mut nonzero = vec![vec![false; n]; n];
    for i in 0..n {
        nonzero[i][i] = true;
        for j in [(7 * i + 3) % n, (i + 1) % n] {
            (nonzero[i][j], nonzero[j][i]) = (true, true);
        }
    }
    for ordering in [FillOrdering::MinimumDegree, FillOrdering::NestedDissection] {
        let found = ordering.elimination(&upper(&nonzero)).unwrap();
        let mut left = nonzero.clone();
        let mut expected = 0.0;
        for (at, &row) in found.sequence.iter().enumerate() {
            let later = &found.sequence[at..];
            let later = later.iter().map(|&r| r as usize);
            let touched: Vec<usize> = later.filter(|&r| left[row as usize][r]).collect();
            expected += (touched.len() as Real).powi(2);
            for &a in &touched {
                for &b in &touched {
                    left[a][b] = true;
                }
            }
        }
        assert_eq!(found.work, expected, "{ordering:?}");
    }
}

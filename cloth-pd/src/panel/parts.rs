//! Cut of the elimination tree for threads.

use super::{Lanes, Part};
use cloth_core::method::linear::FactorView;

/// Parts that a large factor is cut into, about: enough for a few threads, few enough for a small separator.
const PARTS: usize = 8;

/// Smaller factors (numbers) stay whole: a solve takes less than a few times what it costs to wake a second thread.
const SMALLEST_DIVIDED: usize = 1 << 17;

/// The supernodes of a factor, each list ascending.
#[derive(Debug, Default)]
pub(super) struct Division {
    /// Independent subtrees of the elimination tree, small ones together in a list: no supernode reaches another list.
    pub(super) parts: Vec<Vec<u32>>,
    /// Their separator: the common ancestors.
    pub(super) separator: Vec<u32>,
}

impl Division {
    /// Cuts where the subtrees of the elimination tree have at most an eighth of all numbers.
    pub(super) fn of(factor: FactorView<'_>) -> Self {
        let count = factor.supernode_count();
        let mut owner = vec![0u32; factor.order().len()];
        for index in 0..count {
            let (start, _, block) = factor.supernode(index);
            owner[start..start + block.ncols()].fill(index as u32);
        }
        // The parent in the tree has the first of the rows below.
        let parent = |index: usize| {
            let below = factor.supernode(index).1.first();
            below.map(|&row| owner[row as usize] as usize)
        };
        let mut numbers = vec![0; count];
        for index in 0..count {
            let block = factor.supernode(index).2;
            numbers[index] += block.nrows() * block.ncols();
            if let Some(parent) = parent(index) {
                numbers[parent] += numbers[index];
            }
        }
        let roots = (0..count).filter(|&index| parent(index).is_none());
        let total: usize = roots.map(|root| numbers[root]).sum();
        let mut division = Self::default();
        if total < SMALLEST_DIVIDED {
            division.separator = (0..count as u32).collect();
            return division;
        }
        let limit = total / PARTS;
        let is_separator = |index: usize| numbers[index] > limit;
        // Subtrees that follow each other are one part as long as they have no more than the limit together.
        let (mut sizes, mut part_of) = (Vec::new(), vec![0; count]);
        for index in (0..count).filter(|&index| !is_separator(index)) {
            if parent(index).is_none_or(is_separator) {
                match sizes.last_mut() {
                    Some(size) if *size + numbers[index] <= limit => *size += numbers[index],
                    _ => sizes.push(numbers[index]),
                }
                part_of[index] = sizes.len() - 1;
            }
        }
        division.parts = vec![Vec::new(); sizes.len()];
        for index in (0..count).rev() {
            if is_separator(index) {
                division.separator.push(index as u32);
                continue;
            }
            if let Some(parent) = parent(index).filter(|&parent| !is_separator(parent)) {
                part_of[index] = part_of[parent];
            }
            division.parts[part_of[index]].push(index as u32);
        }
        division.parts.iter_mut().for_each(|part| part.reverse());
        division.separator.reverse();
        division
    }
}

/// Hands each part its stretch of `work`; at the same time where there are several threads.
pub(super) fn for_each(
    parts: &[Part],
    work: &mut [Lanes],
    visit: &(impl Fn(&Part, &mut [Lanes]) + Sync),
) {
    match parts {
        [] => {}
        [part] => visit(part, work),
        _ => {
            let (first, second) = parts.split_at(parts.len() / 2);
            let entries = first.iter().map(Part::entry_count).sum();
            let (first_work, second_work) = work.split_at_mut(entries);
            together(
                || for_each(first, first_work, visit),
                || for_each(second, second_work, visit),
            );
        }
    }
}

#[cfg(feature = "parallel")]
fn together(first: impl FnOnce() + Send, second: impl FnOnce() + Send) {
    if rayon::current_num_threads() > 1 {
        rayon::join(first, second);
    } else {
        first();
        second();
    }
}

#[cfg(not(feature = "parallel"))]
fn together(first: impl FnOnce(), second: impl FnOnce()) {
    first();
    second();
}

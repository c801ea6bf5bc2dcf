//! Stages of a sweep, and their parts: where an element is visited.

/// Elements of one colour that make a part.
const PIECE: usize = 1024;

/// Where an element is visited; in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Place {
    Block {
        shifted: bool,
        block: u32,
        color: u32,
    },
    Rest {
        color: u32,
    },
}

impl Place {
    /// Of an element with these vertices, in a cloth cut into blocks of `size` vertices, or not at all.
    pub(super) fn new(vertices: &[u32], color: u32, size: Option<u32>) -> Self {
        let ends = vertices.iter().min().zip(vertices.iter().max());
        if let Some((size, (&first, &last))) = size.zip(ends) {
            for (shifted, shift) in [(false, 0), (true, size / 2)] {
                let block = (first + shift) / size;
                if block == (last + shift) / size {
                    return Self::Block {
                        shifted,
                        block,
                        color,
                    };
                }
            }
        }
        Self::Rest { color }
    }

    /// Whether an element here and the one before it, there, are in stages of their own.
    fn begins_stage(self, before: Self) -> bool {
        match (self, before) {
            (Self::Block { shifted, .. }, Self::Block { shifted: other, .. }) => shifted != other,
            _ => self != before,
        }
    }

    /// Whether they are in parts of their own, in one stage, where the part so far has `count` elements.
    fn begins_part(self, before: Self, count: usize) -> bool {
        match (self, before) {
            (Self::Block { block, .. }, Self::Block { block: other, .. }) => block != other,
            _ => count >= PIECE,
        }
    }
}

/// The numbers of elements with these places in the order of their visits; not generic, so that it is compiled once.
pub(super) fn visiting_order(places: &[Place]) -> Vec<u32> {
    let mut order: Vec<u32> = (0..places.len() as u32).collect();
    order.sort_by_key(|&index| places[index as usize]);
    order
}

/// The stages of elements that are visited in places `sorted`: part p of one is elements `bounds[p]..bounds[p + 1]`.
pub(super) fn stages(sorted: &[Place]) -> Vec<Vec<usize>> {
    let mut stages: Vec<Vec<usize>> = Vec::new();
    let mut part = 0; // where the part so far begins
    for (index, &place) in sorted.iter().enumerate() {
        let before = index.checked_sub(1).map(|before| sorted[before]);
        if before.is_none_or(|before| place.begins_stage(before)) {
            stages.push(vec![index]);
            part = index;
        } else if before.is_some_and(|before| place.begins_part(before, index - part)) {
            part = index;
        } else {
            continue;
        }
        // `part` ends what came before it, in this stage or in the one before.
        let ended = if stages[stages.len() - 1][0] == part {
            stages.len().checked_sub(2)
        } else {
            Some(stages.len() - 1)
        };
        if let Some(ended) = ended {
            stages[ended].push(part);
        }
    }
    if let Some(last) = stages.last_mut() {
        last.push(sorted.len());
    }
    stages
}

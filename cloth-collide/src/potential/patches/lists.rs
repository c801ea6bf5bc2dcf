//! What a substep has found of pairs: some lists that threads have filled side by side, and one for what came later.

/// The number of the list for what comes later.
pub(super) const LATER: u32 = u32::MAX;

/// Lists of a substep. Which of them is how long differs little between substeps, so that they are used again.
#[derive(Clone, Debug)]
pub(in crate::potential) struct Lists<T> {
    /// Those of the beginning.
    first: Vec<Vec<T>>,
    /// What the motion made necessary once it had become another one.
    pub(super) later: Vec<T>,
}

impl<T> Default for Lists<T> {
    fn default() -> Self {
        Self {
            first: Vec::new(),
            later: Vec::new(),
        }
    }
}

impl<T> Lists<T> {
    pub(in crate::potential) fn clear(&mut self) {
        self.all_mut().for_each(Vec::clear);
    }

    /// The first `count` lists.
    pub(super) fn begin(&mut self, count: usize) -> &mut [Vec<T>] {
        if self.first.len() < count {
            self.first.resize_with(count, Vec::new);
        }
        &mut self.first[..count]
    }

    /// What stands at a place: the number of the list, and in it.
    #[inline]
    pub(in crate::potential) fn at(&self, [list, index]: [u32; 2]) -> &T {
        let list = match list {
            LATER => &self.later,
            _ => &self.first[list as usize],
        };
        &list[index as usize]
    }

    pub(in crate::potential) fn is_empty(&self) -> bool {
        self.first.iter().all(Vec::is_empty) && self.later.is_empty()
    }

    pub(in crate::potential) fn iter(&self) -> impl Iterator<Item = &T> {
        self.first.iter().flatten().chain(&self.later)
    }

    pub(in crate::potential) fn iter_mut(&mut self) -> impl Iterator<Item = &mut T> {
        self.all_mut().flatten()
    }

    fn all_mut(&mut self) -> impl Iterator<Item = &mut Vec<T>> {
        let Self { first, later } = self;
        first.iter_mut().chain(std::iter::once(later))
    }

    /// The lists, to be worked on side by side.
    pub(in crate::potential) fn split(&mut self) -> (&mut [Vec<T>], &mut Vec<T>) {
        (&mut self.first, &mut self.later)
    }
}

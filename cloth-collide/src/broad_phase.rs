//! Pairs of primitives that can touch: candidates from axis-aligned boxes.
//!
//! # The idea
//!
//! Every triangle gets a box around all that it sweeps from one position to the next, moved outwards by half of the
//! margin. Primitives whose boxes are disjoint cannot come nearer than the margin. A *broad phase* finds the
//! overlapping pairs without visiting all n². There are three, and they find the same pairs:
//!
//! | | how | suits | cost of a search |
//! |---|---|---|---|
//! | [`Hierarchy`] | a tree of boxes, made once and refitted | triangles of any sizes | n, and the pairs of nodes that overlap |
//! | [`SpatialHash`] | cubic cells, looked up by a hash of their place | triangles of one size | n, and the pairs in a cell |
//! | [`MortonGrid`] | the same cells, sorted along a space-filling curve | triangles of one size; no table | n log n, and the pairs in a cell |
//!
//! In the worst case, with all boxes in one place, each of the three visits all pairs. Cells are 1.5 times as wide as
//! the median box, and filled anew in each search. So a box of median size is in one to eight cells; one in more than
//! 64 is compared with all others, and many small ones crowd in one cell. That is why cells suit triangles of one size.
//! The tree is slow where parts that are far apart now lay together when it was made.
//!
//! Only triangles are searched for. [`ClothCandidates`] makes vertex–triangle and edge–edge pairs from their pairs:
//! each vertex and each edge belongs to one of its triangles, its *representative* (Curtis, Tamstorf and Manocha 2008),
//! inside whose box its own lies. So each pair of primitives is met in one pair of triangles only, and one search
//! serves both kinds. Pairs whose boxes overlap although a plane separates them are then left out.
//!
//! The tree is refitted in every search, in place, and built anew only for another number of boxes.
//! [`potential`](crate::potential) has boxes around patches of at most 32 triangles instead, moved outwards by a mean
//! edge or more and h/2, and searches among them when a patch has gone so far. A component of the cloth is halved until
//! its patches are that small, so they have at least 16 triangles if the component has.

mod candidates;
mod cells;
mod hierarchy;
mod morton_grid;
mod order;
mod spatial_hash;
mod triangle_pairs;

pub use candidates::ClothCandidates;
pub use hierarchy::Hierarchy;
pub use morton_grid::MortonGrid;
pub use spatial_hash::SpatialHash;
pub(crate) use triangle_pairs::TrianglePairs;

use crate::bounds::Bounds;
use std::fmt::Debug;

/// The broad phases by name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BroadPhaseKind {
    /// [`Hierarchy`].
    #[default]
    Hierarchy,
    /// [`SpatialHash`].
    SpatialHash,
    /// [`MortonGrid`].
    MortonGrid,
}

impl BroadPhaseKind {
    /// A new one of this kind.
    #[must_use]
    pub fn create(self) -> Box<dyn BroadPhase> {
        match self {
            Self::Hierarchy => Box::new(Hierarchy::default()),
            Self::SpatialHash => Box::new(SpatialHash::default()),
            Self::MortonGrid => Box::new(MortonGrid::default()),
        }
    }
}

/// Finds overlapping boxes.
pub trait BroadPhase: Debug + Send + Sync {
    /// Replaces `out` by all pairs `[a, b]`, a < b, of numbers of overlapping boxes ([`Bounds::overlaps`]), each once,
    /// in any order. Corners of boxes are finite. From the second call with as many boxes on, nothing is allocated
    /// beyond what `out` needs.
    fn overlapping(&mut self, boxes: &[Bounds], out: &mut Vec<[u32; 2]>);
}

impl Default for Box<dyn BroadPhase> {
    fn default() -> Self {
        BroadPhaseKind::default().create()
    }
}

/// One of the kinds, whose copy is a new one: it finds the same.
#[derive(Debug)]
pub(crate) struct OfKind {
    kind: BroadPhaseKind,
    broad_phase: Box<dyn BroadPhase>,
}

impl OfKind {
    pub(crate) fn new(kind: BroadPhaseKind) -> Self {
        let broad_phase = kind.create();
        Self { kind, broad_phase }
    }
}

impl Default for OfKind {
    fn default() -> Self {
        Self::new(BroadPhaseKind::default())
    }
}

impl Clone for OfKind {
    fn clone(&self) -> Self {
        Self::new(self.kind)
    }
}

impl BroadPhase for OfKind {
    fn overlapping(&mut self, boxes: &[Bounds], out: &mut Vec<[u32; 2]>) {
        self.broad_phase.overlapping(boxes, out);
    }
}

/// A broad phase chosen when the program runs.
impl<B: BroadPhase + ?Sized> BroadPhase for Box<B> {
    fn overlapping(&mut self, boxes: &[Bounds], out: &mut Vec<[u32; 2]>) {
        (**self).overlapping(boxes, out);
    }
}

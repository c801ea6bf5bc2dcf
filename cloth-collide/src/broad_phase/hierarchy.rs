//! Overlapping boxes from a tree of boxes.

use super::BroadPhase;
use crate::bounds::Bounds;
use crate::convert::{aabb, bounds as node_bounds};
use cloth_core::math::Real;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy, BvhNode, BvhWorkspace};
use std::cell::Cell;
use std::fmt;

/// A bounding volume hierarchy (parry's). Its shape is made once, from the boxes of the first call, since neighbours in
/// a cloth stay neighbours however it moves; afterwards only the sizes of its boxes follow. It is made anew when the
/// number of boxes changes.
///
/// Limits: where far parts of a cloth lay together at the first call, the tree mixes them and is slow, not wrong.
#[derive(Default)]
pub struct Hierarchy {
    tree: Bvh,
    leaf_count: usize,
    workspace: BvhWorkspace,
}

impl Clone for Hierarchy {
    fn clone(&self) -> Self {
        Self {
            tree: self.tree.clone(),
            leaf_count: self.leaf_count,
            workspace: BvhWorkspace::default(),
        }
    }
}

impl Hierarchy {
    /// A tree whose shape suits `boxes`, finite ones.
    #[must_use]
    pub fn over(boxes: &[Bounds]) -> Self {
        // The tree is cut where the volumes of the boxes become small. A flat sheet along the axes has boxes without
        // volume, and all cuts look equal; so every box is given a thickness. Measured on a crumpled sheet: the
        // search then takes two thirds of the time.
        let size = |b: &Bounds| (b.upper - b.lower).norm();
        let thickness = 0.25 * boxes.iter().map(size).sum::<Real>() / boxes.len() as Real;
        let leaves: Vec<_> = boxes.iter().map(|b| aabb(&b.inflated(thickness))).collect();
        Self {
            tree: Bvh::from_leaves(BvhBuildStrategy::Binned, &leaves),
            leaf_count: boxes.len(),
            workspace: BvhWorkspace::default(),
        }
    }

    /// Lets the tree follow its boxes; its shape stays.
    ///
    /// # Panics
    /// If there are not as many boxes as the tree was made for.
    pub fn refit(&mut self, boxes: impl ExactSizeIterator<Item = Bounds>) {
        assert_eq!(boxes.len(), self.leaf_count, "one box a leaf");
        for (leaf, bounds) in (0..).zip(boxes) {
            self.tree
                .insert_or_update_partially(aabb(&bounds), leaf, 0.0);
        }
        self.tree.refit_without_opt();
    }

    /// Hands `visit` every pair of numbers of overlapping boxes once, the two in either order.
    pub fn visit_overlapping(&mut self, mut visit: impl FnMut(u32, u32)) {
        self.tree
            .traverse_bvtt_single_tree::<false>(&mut self.workspace, &mut visit);
    }

    /// Hands `visit` every pair of leaves a < b whose boxes are nearer than the distance whose square is `limit` (m²),
    /// which `visit` may lower on the way.
    pub(crate) fn visit_near(&self, limit: &Cell<Real>, mut visit: impl FnMut(u32, u32)) {
        let near =
            |a: &BvhNode, b: &BvhNode| node_bounds(a).squared_gap(&node_bounds(b)) < limit.get();
        for (a, b) in self.tree.leaf_pairs(&self.tree, near) {
            if a < b {
                visit(a, b);
            }
        }
    }
}

impl BroadPhase for Hierarchy {
    fn overlapping(&mut self, boxes: &[Bounds], out: &mut Vec<[u32; 2]>) {
        out.clear();
        if boxes.is_empty() {
            return;
        }
        if boxes.len() != self.leaf_count {
            *self = Self::over(boxes);
        }
        self.refit(boxes.iter().copied());
        self.visit_overlapping(|a, b| out.push([a.min(b), a.max(b)]));
    }
}

impl fmt::Debug for Hierarchy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // The tree alone would be thousands of lines.
        f.debug_struct("Hierarchy")
            .field("leaf_count", &self.leaf_count)
            .finish_non_exhaustive()
    }
}

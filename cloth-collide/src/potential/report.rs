//! What a step took of a method that projects positions.

/// What the last step took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ConstraintReport {
    /// Searches for pairs of patches.
    pub searches: u32,
    /// Searches for pairs of primitives between two patches.
    pub detections: u32,
    /// Pairs that were looked at, over all substeps.
    pub looked: u32,
    /// Rows, over all substeps, of cloth and of bodies.
    pub rows: u32,
    /// Pairs that had not kept their distance at the end of a substep.
    pub violated: u32,
    /// Vertices whose path was shortened.
    pub shortened: u32,
    /// Substeps that impact zones ended.
    pub zones: u32,
    /// Substeps in which nothing could come near, so that nothing was looked at.
    pub quiet: u32,
}

//! What a step took of a method that projects positions.

/// What the last step took.
///
/// `violated`, `shortened` and `zones` tell whether the substeps were short enough. A violated pair is one that sweeps
/// have left nearer than a tenth of its distance (or of its range), and gets more of them. Vertices whose path is
/// shortened, and what the last resort has moved, are where they are for safety and not because of a force: momentum
/// and friction are then not those of the model. Shorter substeps or more sweeps have fewer of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ConstraintReport {
    /// Searches for pairs of patches.
    pub searches: u32,
    /// Searches for pairs of primitives between two patches.
    pub detections: u32,
    /// Pairs whose distance was asked for, over all substeps.
    pub queries: u32,
    /// Constraints, over all substeps, of cloth and of bodies.
    pub constraints: u32,
    /// How often a pair had not kept its distance at the end of a substep, over all rounds and substeps.
    pub violated: u32,
    /// How often the path of a vertex was shortened. It counts anew in every round of every substep, and so can be more
    /// than there are vertices.
    pub shortened: u32,
    /// Substeps that came to the last resort, whichever of its stages ended them: pushes, impact zones or truncation.
    pub zones: u32,
    /// Substeps in which nothing could come near, so that nothing was asked for.
    pub culled_substeps: u32,
}

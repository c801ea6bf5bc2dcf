//! Hierarchical PBD (Müller 2008): projected distance constraints on the coarse levels of
//! [`cloth_core::method::multigrid`].

mod level;
mod tether;

use cloth_core::error::{at_least_one, within};
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::{MeshError, TriMesh};
use cloth_core::method::multigrid::coarse_levels;
use cloth_core::method::position_based::Sweep;
use cloth_core::particles::Particles;
use cloth_core::step::BuildError;
use cloth_core::topology::EdgeTable;
use level::Level;
use std::fmt;

/// Settings of a [`Hierarchy`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HierarchyConfig {
    /// Most coarse levels, at least 1. Coarsening stops earlier where it gains nothing.
    pub levels: u32,
    /// Parents that a vertex inside the cloth has at least on the next coarser level, at least 1.
    pub parents: u32,
    /// Sweeps over the links of the first coarse level in one correction, at least 1. Each further level has about half
    /// as many vertices, and gets twice as many sweeps: every level costs about the same.
    pub sweeps: u32,
    /// Fraction (dimensionless, above 0 and at most 1) of its excess length that a link loses in a visit.
    pub stiffness: Real,
    /// Sweeps between coarse corrections in a substep; `None` for one correction, before the first sweep.
    pub every: Option<u32>,
    /// Order of the sweeps over the links.
    pub sweep: Sweep,
}

impl Default for HierarchyConfig {
    /// As many levels as there are, two parents, two coloured sweeps of the first level at full stiffness, one
    /// correction a substep.
    fn default() -> Self {
        Self {
            levels: 16,
            parents: 2,
            sweeps: 2,
            stiffness: 1.0,
            every: None,
            sweep: Sweep::Colored,
        }
    }
}

/// Coarse levels of a cloth, for [`PbdSolver::with_hierarchy`](crate::PbdSolver::with_hierarchy).
///
/// A Gauss–Seidel sweep propagates a correction from neighbour to neighbour; a cloth of N vertices a side takes of the
/// order of N² sweeps to converge, in proportion to its vertices. A level with half of the vertices takes half of the
/// sweeps, at half the work each. A correction does not save that work: it makes *twice* as many sweeps on each further
/// level, so that all levels cost the same. The coarser a level, the nearer it comes to convergence, and the longest
/// waves of the error, which the sweeps over the cloth hardly reach, are corrected best.
///
/// - **Coarsening.** [`coarse_levels`], with [`HierarchyConfig::parents`]. Vertices are tested one after another in the
///   order of their numbers, those of the boundary first. A prescribed one is kept. Another is left out if it can be
///   interpolated from the neighbours that are kept, and if that stays true of those of its neighbours that were left
///   out before it. It can be interpolated
///   - inside the cloth, where at least `parents` of its neighbours are kept, and their mean with the weights below is
///     nearer to it than 0.3 of their mean distance from it;
///   - on the boundary, where its two neighbours along the boundary are kept.
///
///   Each level is a subset of the one before, of at most four fifths of its vertices, mostly about half. With fewer
///   than four vertices, or more than four fifths, there is no further level.
/// - **Weights.** A vertex i that is left out has as parents j all its neighbours that are kept
///   ([`Hierarchy::parents`]), on the boundary the two there. With their displacements rⱼ at rest from i, distances ℓⱼ
///   along the link, mean `m = Σⱼ bⱼ rⱼ` and covariance `K = Σⱼ bⱼ (rⱼ − m)(rⱼ − m)ᵀ` by the weights b of distance
///   alone, the weights P
///   ```text
///   bⱼ = (1/ℓⱼ)/Σ (1/ℓ),   Pᵢⱼ = bⱼ (1 + β·(rⱼ − m)),   K β = −m
///   ```
///   have the sum 1, so a translation is prolongated exactly, and `Σⱼ Pᵢⱼ rⱼ = m + K β = 0`, so a linear field is too:
///   of all such weights these differ least from b, by `Σ (Pᵢⱼ − bⱼ)²/bⱼ`. Along axes in which the parents do not
///   spread, β is zero, and where a weight would be negative β is shortened until it is zero; then a linear field is
///   met nearly.
/// - **Links.** Two coarse vertices are linked where a fine link joins them, or vertices whose nearest parents they
///   are. The length of a link is the geodesic distance over the cloth at rest
///   ([`Geodesics`](cloth_core::method::multigrid::Geodesics)), so no folding, bending or unrolling without stretch
///   makes one longer, as with [long-range attachments](crate#long-range-attachments). Where no link is too long,
///   however short some are, no link does anything. So the zero-energy configurations of the cloth, those in which
///   nothing is stretched, as folds, have no energy on any level: a coarse level does not resist bending. Links that
///   kept their length in both directions, as rods, would.
/// - **Correction.** From the coarsest level to the finest, links that are too long are shortened by projections. With
///   L the length of a link at rest, l its present length, and l₀ the smaller of L and its length when the sweeps of
///   its level began, a link may be between l₀ and L. A visit, with the fraction s, makes of its multiplier λ
///   - `λ − s (l − L)/w̃`, if that is below 0: the link pulls;
///   - else the larger of 0 and `λ − s (l − l₀)/w̃`: it pushes, or does nothing. One that was short may stay so.
///
///   (Müller's links only pull. Each that is shortened lengthens or shortens its neighbours; those that have become too
///   short are left so, and a hanging sheet narrows.) Then the finer level follows: `Δxᵢ = Σⱼ Pᵢⱼ Δxⱼ`, a vertex that
///   was kept with weight 1 on itself. The mass of a coarse vertex is `Σᵢ Pᵢⱼ mᵢ`, `Pᵀm`, so
///   `Σᵢ mᵢ Δxᵢ = Σⱼ (Pᵀm)ⱼ Δxⱼ`: as projections of free vertices leave the right side zero, `Σ m x` does not change.
///
/// What it saves: the table of [acceleration](crate#acceleration). What it costs: each level about as many visits of
/// links, in its sweeps, as [`HierarchyConfig::sweeps`] sweeps over the first, plus one sweep to store lengths.
///
/// Limits: links are as hard as [`HierarchyConfig::stiffness`] says, whatever the material; a soft cloth becomes
/// stiffer. Angular momentum is not conserved by the prolongation. Only stretching is corrected: no level acts against
/// bending, or against compression that it found. What the finer level gets is smooth between parents, so the
/// correction may bend or stretch single fine links, which only sweeps after it repair. Levels, lengths and weights
/// come from the mesh at rest and the vertices prescribed when it is built; pins may move.
#[derive(Debug)]
pub struct Hierarchy {
    vertex_count: usize,
    /// From fine to coarse.
    levels: Vec<Level>,
    config: HierarchyConfig,
}

/// One link of a coarse level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Link {
    /// The two vertices, numbered as in the mesh.
    pub vertices: [u32; 2],
    /// Length at rest (m), above which it pulls.
    pub length: Real,
}

impl Hierarchy {
    /// The levels of a cloth at rest, with the masses and prescribed vertices of `particles` as they are now.
    ///
    /// # Errors
    /// [`HierarchyError`].
    pub fn build(
        mesh: &TriMesh,
        particles: &Particles,
        config: HierarchyConfig,
    ) -> Result<Self, HierarchyError> {
        check(&config)?;
        let vertex_count = mesh.vertex_count();
        let count = particles.len();
        let (name, range) = (
            "the number of particles",
            "that of the vertices of the mesh",
        );
        within(count == vertex_count, name, count as Real, range).map_err(BuildError::from)?;
        let edges = EdgeTable::build(mesh)?;
        let is_prescribed = |v: u32| particles.is_prescribed(v as usize);
        let [parents, most] = [config.parents, config.levels].map(|n| n as usize);
        let mut mass = particles.mass().to_vec();
        let mut levels: Vec<Level> = Vec::new();
        for coarse in coarse_levels(mesh, &edges, is_prescribed, parents, most) {
            let level = Level::new(coarse, &mass, is_prescribed, config.sweep)?;
            mass.clone_from(&level.mass);
            levels.push(level);
        }
        Ok(Self {
            vertex_count,
            levels,
            config,
        })
    }

    /// The settings.
    #[must_use]
    pub fn config(&self) -> &HierarchyConfig {
        &self.config
    }

    /// Number of vertices of the mesh.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.vertex_count
    }

    /// Number of coarse levels; 0 if the mesh is too small for any.
    #[must_use]
    pub fn level_count(&self) -> usize {
        self.levels.len()
    }

    /// The vertices of coarse level `level`, from 1, numbered as in the mesh; level 0 is the mesh.
    ///
    /// # Panics
    /// If there is no such coarse level.
    #[must_use]
    pub fn vertices(&self, level: usize) -> &[u32] {
        &self.levels[level - 1].original
    }

    /// The links of coarse level `level`, from 1.
    ///
    /// # Panics
    /// If there is no such coarse level.
    #[must_use]
    pub fn links(&self, level: usize) -> Vec<Link> {
        let level = &self.levels[level - 1];
        let of_mesh = |v: u32| level.original[v as usize];
        let link = |t: &tether::Tether| Link {
            vertices: t.vertices.map(of_mesh),
            length: t.length,
        };
        level.links.iter().map(link).collect()
    }

    /// The vertices of the level before coarse level `level` (from 1) that are not in it, each with its parents
    /// and their weights (dimensionless, sum 1), all numbered as in the mesh.
    ///
    /// # Panics
    /// If there is no such coarse level.
    #[must_use]
    pub fn parents(&self, level: usize) -> Vec<(u32, Vec<(u32, Real)>)> {
        let finer = |v: u32| match level {
            1 => v,
            _ => self.levels[level - 2].original[v as usize],
        };
        let level = &self.levels[level - 1];
        let of_mesh = |&(v, weight): &(u32, Real)| (level.original[v as usize], weight);
        let parents = level.parents();
        parents
            .map(|(child, parents)| (finer(child), parents.iter().map(of_mesh).collect()))
            .collect()
    }

    /// One correction of `positions` (m), from the coarsest level to the finest.
    ///
    /// # Panics
    /// If there is not one position per vertex of the mesh.
    pub fn correct(&mut self, positions: &mut [Vec3]) {
        assert_eq!(positions.len(), self.vertex_count, "number of positions");
        for level in 0..self.levels.len() {
            let (finer, coarser) = self.levels.split_at_mut(level);
            match finer.last() {
                Some(finer) => coarser[0].restrict(finer.positions()),
                None => coarser[0].restrict(positions),
            }
        }
        for level in (0..self.levels.len()).rev() {
            let (finer, coarser) = self.levels.split_at_mut(level);
            // Twice as many sweeps where there are half as many vertices.
            let sweeps = self.config.sweeps.saturating_mul(1 << level.min(20));
            coarser[0].relax(sweeps, self.config.stiffness);
            match finer.last_mut() {
                Some(finer) => coarser[0].prolongate(finer.positions_mut()),
                None => coarser[0].prolongate(positions),
            }
        }
    }

    /// Whether a correction comes before sweep number `sweep` (from 0) of a substep.
    pub(crate) fn is_due(&self, sweep: u32) -> bool {
        match self.config.every {
            Some(every) => sweep.is_multiple_of(every),
            None => sweep == 0,
        }
    }
}

fn check(config: &HierarchyConfig) -> Result<(), BuildError> {
    let counts = [
        ("the number of levels", config.levels),
        ("the number of parents", config.parents),
        ("the sweeps of a level", config.sweeps),
        ("the sweeps between corrections", config.every.unwrap_or(1)),
    ];
    for (name, count) in counts {
        at_least_one(name, count)?;
    }
    let (name, k) = ("the stiffness of the coarse links", config.stiffness);
    within(k > 0.0 && k <= 1.0, name, k, "above 0 and at most 1")?;
    Ok(())
}

/// Why a hierarchy could not be built.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum HierarchyError {
    /// The mesh is refused for its topology.
    Mesh(MeshError),
    /// A setting lies outside its range.
    Build(BuildError),
}

impl fmt::Display for HierarchyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Mesh(error) => error.fmt(f),
            Self::Build(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for HierarchyError {}

impl From<MeshError> for HierarchyError {
    fn from(error: MeshError) -> Self {
        Self::Mesh(error)
    }
}

impl From<BuildError> for HierarchyError {
    fn from(error: BuildError) -> Self {
        Self::Build(error)
    }
}

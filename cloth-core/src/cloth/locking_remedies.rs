//! Remedies against locking for springs on edges: how they resist a change of length, and which edges have one.
//!
//! A sheet of stiff edges has the freedom of its boundary only, `3χ + E_b`, and cannot fold where its mesh does not
//! happen to have a line. Each remedy buys freedom and gives something up; the table in [`crate::dof`] has how much.
//! Under [`SpringLaw::Compression`] edges may shorten, in a [`SpringLaw::DeadZone`] lengths are free within a range.
//! `3V − E` grows by 1 with every edge that [`SpringEdges`] leave out; with no diagonal left a grid resists no shear to
//! first order, and a wanted modulus is missed. [`CoarseMembrane`](super::CoarseMembrane) is the fourth.
//!
//! All of them are made of [`Spring`] and [`StrainLimitSpring`], which have all three views, so every method takes
//! them.

use super::{ClothError, FRACTION};
use crate::energy::{Spring, StrainLimitSpring};
use crate::error::within;
use crate::math::Real;
use crate::mesh::TriMesh;
use crate::topology::{EdgeTable, removable_edges};

/// How the springs on the edges resist a change of length.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum SpringLaw {
    /// In proportion.
    #[default]
    Linear,
    /// k under tension, this fraction of k (dimensionless, 0 to 1) under compression:
    /// `E = ½ r k C² + ½ (1 − r) k max(0, C)²`, a spring and, beside it, one that is slack below its rest length.
    ///
    /// Limits: PBD with one fixed stiffness for all constraints does not know k, and takes the two for the same.
    Compression(Real),
    /// Nothing while the length relative to rest lies between these limits (dimensionless, from below 1 to above 1), k
    /// times the excess outside: a dead zone. With `[0, 1]` only tension is resisted.
    DeadZone([Real; 2]),
}

/// Which edges have springs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum SpringEdges {
    /// All of them.
    #[default]
    All,
    /// So few that `3V − E` reaches this fraction of 3V (dimensionless, 0 to 1): edges are left out in the order of
    /// [`removable_edges`].
    DofFraction(Real),
    /// The edges of quads only: all [`removable_edges`] are left out, the diagonals of a grid among them.
    Quads,
}

impl SpringLaw {
    fn check(self) -> Result<(), ClothError> {
        match self {
            Self::Linear => Ok(()),
            Self::Compression(fraction) => {
                let name = "fraction of k that springs keep under compression";
                within((0.0..=1.0).contains(&fraction), name, fraction, FRACTION)?;
                Ok(())
            }
            Self::DeadZone([shortest, longest]) => {
                if (0.0..=1.0).contains(&shortest) && 1.0 <= longest && longest.is_finite() {
                    return Ok(());
                }
                Err(ClothError::SlackRange([shortest, longest]))
            }
        }
    }

    /// The lengths, or stretches, between which nothing resists; of a law without slack `[1, 1]`.
    pub(super) fn slack_range(self) -> Result<[Real; 2], ClothError> {
        self.check()?;
        Ok(match self {
            Self::DeadZone(limits) => limits,
            Self::Linear | Self::Compression(_) => [1.0; 2],
        })
    }

    /// The springs that resist at every length, and those that do so outside a range.
    pub(super) fn applied_to(
        self,
        mut springs: Vec<Spring>,
    ) -> Result<(Vec<Spring>, Vec<StrainLimitSpring>), ClothError> {
        self.check()?;
        let limited = |springs: &[Spring], limits: [Real; 2], fraction: Real| {
            let one = |s: &Spring| StrainLimitSpring {
                vertices: s.vertices,
                shortest: limits[0] * s.rest_length,
                longest: limits[1] * s.rest_length,
                stiffness: fraction * s.stiffness,
            };
            springs.iter().map(one).collect()
        };
        Ok(match self {
            Self::Linear => (springs, Vec::new()),
            Self::DeadZone(limits) => (Vec::new(), limited(&springs, limits, 1.0)),
            Self::Compression(1.0) => (springs, Vec::new()),
            Self::Compression(fraction) => {
                let tension = limited(&springs, [0.0, 1.0], 1.0 - fraction);
                for spring in &mut springs {
                    spring.stiffness *= fraction;
                }
                springs.retain(|spring| spring.stiffness > 0.0);
                (springs, tension)
            }
        })
    }
}

impl SpringEdges {
    /// The springs, one per edge, without those on edges that are left out.
    pub(super) fn chosen_from(
        self,
        springs: Vec<Spring>,
        mesh: &TriMesh,
        edges: &EdgeTable,
    ) -> Result<Vec<Spring>, ClothError> {
        if self == Self::All {
            return Ok(springs);
        }
        let removable = removable_edges(mesh, edges);
        let coordinates = 3 * mesh.vertex_count();
        let count = match self {
            Self::All => 0,
            Self::Quads => removable.len(),
            Self::DofFraction(fraction) => {
                let least = (coordinates as Real - edges.len() as Real) / coordinates as Real;
                let most = least + removable.len() as Real / coordinates as Real;
                if !(0.0 <= fraction && fraction <= most) {
                    return Err(ClothError::DofFraction { fraction, most });
                }
                ((fraction - least) * coordinates as Real).ceil().max(0.0) as usize
            }
        };
        let mut is_kept = vec![true; edges.len()];
        for &edge in removable.iter().take(count) {
            is_kept[edge as usize] = false;
        }
        let pairs = springs.into_iter().zip(is_kept);
        Ok(pairs.filter(|(_, kept)| *kept).map(|(s, _)| s).collect())
    }
}

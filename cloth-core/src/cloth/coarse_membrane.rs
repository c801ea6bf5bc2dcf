//! A coarse membrane against locking: links of a coarse level keep the cloth from stretching, the mesh bends.
//!
//! Springs on the edges do two things at once: they keep the cloth from stretching, and they keep every triangle as it
//! is, which is what locks. Only the first is wanted. So each level gets a model of its own: the mesh gets hinges and
//! springs of a small fraction of the modulus, and links of a coarser level, which pull and do not push, have the
//! rest, with braces across them. A link is as long as the geodesic over the cloth ([`coarse_levels`]); bending,
//! folding and rolling make no geodesic longer, so the links cost no bend anything, at any curvature and on any mesh.
//!
//! Hierarchical position-based dynamics holds a cloth with such links, level by level from coarse to fine, as a way to
//! carry corrections far ([`crate::method::multigrid`]). Here they are elements with a stiffness, so that every method
//! takes them and all agree on what they mean.

use super::{ClothError, FRACTION, Membrane};
use crate::energy::{Spring, StrainLimitSpring};
use crate::error::within;
use crate::math::Real;
use crate::mesh::TriMesh;
use crate::method::multigrid::{CoarseLevel, Geodesics, coarse_levels};
use crate::topology::EdgeTable;

/// Which level of the mesh keeps the cloth from stretching.
///
/// Links on the level `level` have the fraction `1 − fine_fraction` of the modulus, the springs on the edges the rest:
/// stretched evenly, the sheet stores what springs alone store, in the mean over all directions.
///
/// What it breaks, besides taking more elements (figures of level 2 with a fine fraction of 0.01 on sheets of 16 cells
/// a side, `cloth-bench study locking`):
/// - links lie more in some directions than in others: pulled along x, the sheet has 0.93 (irregular mesh) to 1.03
///   (alternating grid) of the energy of springs;
/// - pushed together, the sheet keeps `fine_fraction` of its stiffness, and under shear, which pulls one way and pushes
///   the other, 0.36 to 0.57;
/// - coarse vertices are 2^(level/2) edges apart or more, and links see nothing in between. Stretch that changes from
///   one coarse vertex to the next meets `fine_fraction` of the stiffness only, waves of four edges 0.02 to 0.15 of it.
///   The coarser the level, the larger the part of a sheet that can be drawn out of place within its surroundings;
/// - a vertex that the level leaves out and that alone holds the cloth hangs on the springs of the fine fraction: on a
///   sheet of 33 × 33 vertices (3000 N/m, 0.2 kg/m²) that hangs by two corners the edge there comes to rest 1.6 times
///   as long, with level 1 and with 2. Prescribe what is around it too, as a clip or a rod does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoarseMembrane {
    /// The coarse level, from 1: each has half as many vertices as the one before, or fewer (dimensionless).
    pub level: u32,
    /// The fraction of the modulus that stays with the springs on the edges (dimensionless, 0 to 1).
    pub fine_fraction: Real,
}

/// Vertices of the next coarser level that a vertex is interpolated from.
const PARENTS: usize = 2;
/// The longest brace, in lengths of the link that it crosses.
const LONGEST_BRACE: Real = 1.5;

impl CoarseMembrane {
    fn check(self) -> Result<(), ClothError> {
        let value = self.fine_fraction;
        let name = "fraction of the modulus that springs on the edges keep";
        within((0.0..=1.0).contains(&value), name, value, FRACTION)?;
        Ok(())
    }

    /// Leaves the fine fraction to the springs on the edges, all of them, and returns the links of the coarse level.
    pub(super) fn applied_to(
        self,
        springs: &mut Vec<Spring>,
        membrane: Membrane,
        mesh: &TriMesh,
        edges: &EdgeTable,
    ) -> Result<Vec<StrainLimitSpring>, ClothError> {
        self.check()?;
        // One level even where none is asked for, so that a refusal can say how many there are.
        let most = self.level.max(1) as usize;
        let levels = coarse_levels(mesh, edges, |_| false, PARENTS, most);
        let Some(level) = levels
            .last()
            .filter(|_| levels.len() == self.level as usize)
        else {
            return Err(ClothError::NoSuchLevel {
                level: self.level,
                most: levels.len() as u32,
            });
        };
        let (ends, lengths) = braced(mesh, level);
        // Springs of stiffness k on lengths L make the modulus Σ k L²/(3A) in the mean over all directions.
        let squares: Real = lengths.iter().map(|length| length * length).sum();
        let modulus = (1.0 - self.fine_fraction) * membrane.modulus(mesh, edges);
        let stiffness = 3.0 * mesh.area() * modulus / squares;
        for spring in springs.iter_mut() {
            spring.stiffness *= self.fine_fraction;
        }
        springs.retain(|spring| spring.stiffness > 0.0);
        let link = |(vertices, &longest): ([u32; 2], &Real)| StrainLimitSpring {
            vertices,
            shortest: 0.0,
            longest,
            stiffness,
        };
        let links = ends.into_iter().zip(&lengths).map(link);
        Ok(links.filter(|link| link.stiffness > 0.0).collect())
    }
}

/// The links of a level and their braces, as numbers in the mesh, with their lengths (m). Where two vertices have both
/// ends of a link as neighbours they are joined too, across it, if they are not much farther apart: a square of links
/// with one diagonal keeps its sides while it is drawn out along the other, as the first one does not push.
fn braced(mesh: &TriMesh, level: &CoarseLevel) -> (Vec<[u32; 2]>, Vec<Real>) {
    let count = level.vertices.len();
    let mut neighbours = vec![Vec::new(); count];
    for &[a, b] in &level.links {
        neighbours[a as usize].push(b);
        neighbours[b as usize].push(a);
    }
    neighbours.iter_mut().for_each(|own| own.sort_unstable());
    let are_linked = |[a, b]: [u32; 2]| neighbours[a as usize].binary_search(&b).is_ok();
    let mut crossed: Vec<([u32; 2], Real)> = Vec::new();
    for (&[a, b], &length) in level.links.iter().zip(&level.lengths) {
        let common = neighbours[a as usize]
            .iter()
            .filter(|v| are_linked([**v, b]));
        let common: Vec<u32> = common.copied().collect();
        for (k, &first) in common.iter().enumerate() {
            let others = common[k + 1..].iter().map(|&second| [first, second]);
            crossed.extend(
                others
                    .filter(|pair| !are_linked(*pair))
                    .map(|pair| (pair, length)),
            );
        }
    }
    // The longest of the links that a brace crosses.
    crossed.sort_unstable_by(|a, b| a.0.cmp(&b.0).then(b.1.total_cmp(&a.1)));
    crossed.dedup_by_key(|(pair, _)| *pair);
    let of_mesh = |v: u32| level.vertices[v as usize];
    let (mut ends, mut lengths): (Vec<_>, _) = (level.ends().collect(), level.lengths.clone());
    let mut geodesics = Geodesics::new(mesh);
    for from_one in crossed.chunk_by(|a, b| a.0[0] == b.0[0]) {
        let source = of_mesh(from_one[0].0[0]);
        let targets: Vec<u32> = from_one.iter().map(|(pair, _)| of_mesh(pair[1])).collect();
        let found = geodesics.from(source, &targets);
        for ((&target, length), (_, across)) in targets.iter().zip(found).zip(from_one) {
            if length <= LONGEST_BRACE * across {
                ends.push([source, target]);
                lengths.push(length);
            }
        }
    }
    (ends, lengths)
}

//! The triangles of the cloth that go through bodies.

use super::meet_unduly;
use crate::broad_phase::TrianglePairs;
use crate::error::CollideError;
use cloth_core::math::Vec3;
use cloth_core::mesh::{MeshError, TriMesh, generate::join};

/// Counts the pairs of a triangle of the cloth and one of a body's surface that have a point in common, by the exact
/// test of [`triangles_meet`](crate::triangles_meet). What keeps them apart in a step (pairs of patches, constraints
/// and the continuous test) has no part in it. The list of near triangles and this test also check the start of a step.
///
/// ```
/// use cloth_collide::BodyProbe;
/// use cloth_core::math::Vec3;
/// use cloth_core::mesh::{TriMesh, generate::sphere};
///
/// // A ball of 2 cm in the middle of a triangle of 1 m touches none of its corners.
/// let corners = [(-0.5, -0.5), (0.5, -0.5), (0.0, 0.7)].map(|(x, y)| Vec3::new(x, y, 0.0));
/// let cloth = TriMesh::new(corners.to_vec(), vec![[0, 1, 2]])?;
/// let ball = sphere(2, 0.02)?;
///
/// let mut probe = BodyProbe::new(&cloth, &[&ball])?;
/// let at = |height: f64| ball.positions().iter().map(|x| x + Vec3::z() * height).collect::<Vec<_>>();
/// assert!(probe.count(&corners, [&at(0.0)[..]])? > 0);
/// assert_eq!(probe.count(&corners, [&at(0.03)[..]])?, 0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct BodyProbe {
    /// Number of vertices of the cloth; those of bodies follow.
    cloth: usize,
    pairs: TrianglePairs,
    places: Vec<Vec3>,
}

impl BodyProbe {
    /// Prepares for a cloth and the surfaces of bodies.
    ///
    /// # Errors
    /// [`MeshError`] if they have too many triangles together.
    pub fn new(cloth: &TriMesh, bodies: &[&TriMesh]) -> Result<Self, MeshError> {
        let all: Vec<TriMesh> = std::iter::once(&cloth)
            .chain(bodies)
            .map(|m| (*m).clone())
            .collect();
        let all = join(&all)?;
        Ok(Self {
            cloth: cloth.vertex_count(),
            pairs: TrianglePairs::new(&all),
            places: Vec::with_capacity(all.vertex_count()),
        })
    }

    /// Counts them where the cloth is at `cloth` (m) and each body, in the same order, at `bodies` (m).
    ///
    /// # Errors
    /// [`CollideError::NonFinitePosition`], with bodies' vertices counted on from those of the cloth.
    ///
    /// # Panics
    /// If there are not as many positions as vertices.
    pub fn count<'a>(
        &mut self,
        cloth: &[Vec3],
        bodies: impl IntoIterator<Item = &'a [Vec3]>,
    ) -> Result<usize, CollideError> {
        cloth.clone_into(&mut self.places);
        bodies
            .into_iter()
            .for_each(|x| self.places.extend_from_slice(x));
        self.pairs.find(&self.places)?;
        let is_own = |t: &[u32; 3]| (t[0] as usize) < self.cloth;
        let mixed = self.pairs.corners().filter(|[a, b]| is_own(a) != is_own(b));
        let meet = mixed.filter(|pair| meet_unduly(*pair, &self.places));
        Ok(meet.count())
    }
}

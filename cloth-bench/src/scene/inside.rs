//! Cloth that starts inside a body, or on it, where contact holds infinite energy and would shoot it out.

use super::Scene;
use crate::error::BenchError;
use cloth_core::math::Real;
use cloth_core::particles::State;
use cloth_core::topology::{EdgeTable, components};

impl Scene {
    /// Refuses free vertices in or on a body that has an inside. Untangling pulls out what goes through triangles of a
    /// body, so where the scene wants it, only a piece that is inside with all of its vertices is refused, and what is
    /// in a plane, which has no triangles.
    ///
    /// # Errors
    /// [`BenchError::Usage`] with the body and its deepest vertex, in the caller's numbers.
    pub(crate) fn refuse_start_inside(&self, state: &State) -> Result<(), BenchError> {
        let (Some(touch), Some(mesh)) = (&self.touch, &self.mesh) else {
            return Ok(());
        };
        if touch.is_idle() {
            return Ok(());
        }
        for body in touch.rigid_bodies() {
            let depth = |v: usize| {
                let x = state.positions[v];
                -body.obstacle.signed_distance(x, state.time).value
            };
            let mut inside: Vec<(usize, Real)> = (0..state.positions.len())
                .filter(|&v| !self.model.particles.is_prescribed(v))
                .map(|v| (v, depth(v)))
                .filter(|(_, depth)| *depth >= 0.0)
                .collect();
            let can_untangle = touch.untangles() && body.has_triangles;
            if can_untangle && !inside.is_empty() {
                let edges = EdgeTable::build(mesh).map_err(BenchError::failed)?;
                let piece = components(mesh.vertex_count(), &edges);
                let mut is_whole = vec![true; mesh.vertex_count()];
                for v in (0..mesh.vertex_count()).filter(|&v| depth(v) < 0.0) {
                    is_whole[piece[v] as usize] = false;
                }
                inside.retain(|(v, _)| is_whole[piece[*v] as usize]);
            }
            let deepest = inside
                .iter()
                .copied()
                .reduce(|a, b| if b.1 > a.1 { b } else { a });
            let Some((vertex, depth)) = deepest else {
                continue;
            };
            let order = self.order.as_ref();
            let named = order.map_or(vertex, |order| order.old_of_new()[vertex] as usize);
            let x = state.positions[vertex];
            let advice = match (body.has_triangles, touch.untangles()) {
                (true, false) => {
                    ", or have what goes through the surface pulled out (untangle=yes)"
                }
                (true, true) => "; untangle=yes pulls out only what goes through the surface",
                (false, _) => "",
            };
            return Err(BenchError::Usage(format!(
                "the cloth starts inside obstacle {} ({}), with {} of its vertices: the deepest is vertex {named}, at \
                 ({:.4}, {:.4}, {:.4}) m, {depth:.3e} m below the surface; move it out, \
                 the thickness of {} m away{advice}",
                body.number + 1,
                body.kind,
                inside.len(),
                x.x,
                x.y,
                x.z,
                touch.thickness()
            )));
        }
        Ok(())
    }
}

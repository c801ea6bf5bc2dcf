//! Cloth that starts inside a body, or on it, where contact holds infinite energy and would shoot it out; and what is
//! said of cloth that crosses a body.

use super::{ContactSetup, Scene};
use crate::bounds::bounds;
use crate::error::BenchError;
use cloth_core::contact::ContactError;
use cloth_core::math::Real;
use cloth_core::particles::State;
use cloth_core::step::StepError;
use cloth_core::topology::{EdgeTable, components};

/// A step (s), and a size of cloth (m) that is from a file or not, beyond which a unit may be another one than meant.
const LONGEST_STEP: Real = 0.5;
const LARGEST_FROM_FILE: Real = 20.0;
const LARGEST_CLOTH: Real = 200.0;
/// The same of cloth that is small (m), and of gravity (m/s²).
const SMALLEST_CLOTH: Real = 5e-3;
const STRONGEST_GRAVITY: Real = 100.0;
/// A vertex no deeper than so many thicknesses is on the surface and not below it, but for rounding.
const ON_SURFACE: Real = 1e-9;

impl Scene {
    /// Refuses free vertices in or on a body that has an inside. Untangling pulls out what goes through triangles of a
    /// body, so where the scene wants it, only a piece that is inside with all of its vertices is refused, and what is
    /// in a plane, which has no triangles.
    pub(crate) fn refuse_start_inside(&self, state: &State) -> Result<(), BenchError> {
        let (Some(touch), Some(mesh)) = (&self.touch, &self.mesh) else {
            return Ok(());
        };
        if touch.is_idle() {
            return Ok(());
        }
        for body in &touch.rigid {
            let depth = |v: usize| {
                let x = state.positions[v];
                -body.obstacle.signed_distance(x, state.time).value
            };
            let mut inside: Vec<(usize, Real)> = (0..state.positions.len())
                .filter(|&v| !self.model.particles.is_prescribed(v))
                .map(|v| (v, depth(v)))
                .filter(|(_, depth)| *depth >= 0.0)
                .collect();
            if inside.is_empty() {
                continue;
            }
            // What untangling cannot serve: pieces that are inside with all of their vertices, or in a plane.
            let mut stuck = inside.clone();
            if body.has_triangles() {
                let edges = EdgeTable::build(mesh).map_err(BenchError::failed)?;
                let piece = components(mesh.vertex_count(), &edges);
                let mut is_whole = vec![true; mesh.vertex_count()];
                for v in (0..mesh.vertex_count()).filter(|&v| depth(v) < 0.0) {
                    is_whole[piece[v] as usize] = false;
                }
                stuck.retain(|(v, _)| is_whole[piece[*v] as usize]);
            }
            let advice = match (stuck.is_empty(), touch.untangles()) {
                (true, false) => {
                    ", or have what goes through the surface pulled out (untangle=yes)"
                }
                (false, true) if body.has_triangles() => {
                    "; untangle=yes pulls out only what goes through the surface"
                }
                _ => "",
            };
            if touch.untangles() {
                inside = stuck;
            }
            let deepest = inside
                .iter()
                .copied()
                .reduce(|a, b| if b.1 > a.1 { b } else { a });
            let Some((vertex, depth)) = deepest else {
                continue;
            };
            let named = self.named(vertex as u32);
            let x = state.positions[vertex];
            let (count, number, kind) = (inside.len(), body.number, body.kind);
            let (thickness, at) = (
                touch.thickness,
                format!("({:.4}, {:.4}, {:.4}) m", x.x, x.y, x.z),
            );
            return Err(BenchError::Usage(if depth <= ON_SURFACE * thickness {
                format!(
                    "the cloth starts on the surface of obstacle {number} ({kind}), with {count} of its vertices, \
                     among them vertex {named}, at {at}; start it outside, the thickness of {thickness} m away \
                     (translate of its [[mesh]]), or hold what is to stay there{advice}"
                )
            } else {
                format!(
                    "the cloth starts inside obstacle {number} ({kind}), with {count} of its vertices: the deepest is \
                     vertex {named}, at {at}, {depth:.3e} m below the surface; move it out, the thickness of \
                     {thickness} m away (translate of its [[mesh]]), or hold what is to stay inside{advice}"
                )
            }));
        }
        Ok(())
    }

    /// What a user should know before so many steps of `dt` (s), a sentence each.
    pub(crate) fn start_warnings(&self, dt: Real, steps: u32) -> Vec<String> {
        let mut warnings: Vec<String> = self.border_warning().into_iter().collect();
        if self.model.particles.free_count() == 0 && self.changes.is_empty() {
            warnings.push("all vertices are held, for ever: nothing can move by itself".into());
        }
        warnings.extend_from_slice(&self.hints);
        warnings.extend(self.unit_warnings(dt));
        let end = dt * Real::from(steps);
        let late = self.event_times.iter().filter(|(_, time)| *time >= end);
        warnings.extend(late.map(|(place, time)| {
            format!("{place}at {time} s, but the run ends with step {steps}, at {end} s: it does not happen")
        }));
        let touch = self.touch.iter().filter(|touch| !touch.is_idle());
        warnings.extend(touch.flat_map(ContactSetup::overlap_warnings));
        warnings
    }

    /// Sentences about lengths and times that look as if they were in other units.
    fn unit_warnings(&self, dt: Real) -> impl Iterator<Item = String> {
        let step = (dt > LONGEST_STEP).then(|| {
            format!("dt = {dt} s is longer than what cloth does in a step: dt is in seconds, 1/60 s is 0.0167")
        });
        let mesh = self.mesh.as_ref();
        let sizes = mesh.map(|mesh| {
            let [low, high] = bounds(mesh.positions().iter().copied());
            (high - low).norm()
        });
        // Meshes of files alone have an order of their own.
        let (largest, whose) = match self.order {
            Some(_) => (LARGEST_FROM_FILE, " of the file"),
            None => (LARGEST_CLOTH, ""),
        };
        let size = sizes.filter(|size| *size > largest).map(|size| {
            format!(
                "the cloth{whose} is {size:.0} m across: lengths are in metres (scale = 0.01 makes them of \
                 centimetres, scale = 0.001 of millimetres)"
            )
        });
        let small = sizes.filter(|size| *size < SMALLEST_CLOTH).map(|size| {
            format!(
                "the cloth is {:.2} mm across: lengths are in metres (scale = 10 makes them of decimetres, scale = 1000 \
                 of kilometres)",
                1e3 * size
            )
        });
        let gravity = self.gravity.norm();
        let strong = (gravity > STRONGEST_GRAVITY)
            .then(|| format!("gravity is {gravity} m/s²: on Earth it is 9.81 m/s², 9810 mm/s²"));
        [step, size, small, strong].into_iter().flatten()
    }

    /// The number of a vertex in the caller's mesh.
    pub(crate) fn named(&self, vertex: u32) -> u32 {
        let order = self.order.as_ref();
        order.map_or(vertex, |order| order.old_of_new()[vertex as usize])
    }

    /// The error of a step; of one that begins with crossing triangles in the scene's own numbers.
    pub(crate) fn crossing_error(&self, error: StepError) -> BenchError {
        let StepError::Contact {
            reason:
                ContactError::IntersectingStart {
                    pairs,
                    triangle,
                    body,
                },
            step,
        } = error
        else {
            return error.into();
        };
        let [a, b, c] = triangle.map(|v| self.named(v));
        let named = |touch: &ContactSetup| body.map(|body| touch.body_name(body));
        let other = self.touch.as_ref().and_then(named);
        let other = other.unwrap_or_else(|| "the cloth itself".into());
        let advice = match body.is_none() && self.border_warning().is_some() {
            true => {
                "some of its border vertices lie on others without being one with them: weld = 0 makes those of one \
                 [[mesh]] one, and two [[mesh]] need a [[seam]], or a distance from each other"
            }
            false => {
                "move them apart, hold the vertices that are to stay in a body, or have them pulled apart \
                 (untangle=yes)"
            }
        };
        let message = format!(
            "{}step {step}: {pairs} pairs of triangles pass through each other at its start, the first of them that \
             with the vertices {a}, {b} and {c} of the cloth, and one of {other}; {advice}",
            self.file
        );
        match step {
            // The scene says where the cloth starts.
            1 => BenchError::Usage(message),
            _ => BenchError::Failed(message),
        }
    }

    /// A sentence about held vertices in bodies, each with the number of its body in contact; none without any.
    pub(crate) fn held_inside(&self, pairs: &[[u32; 2]]) -> Option<String> {
        /// So many are named.
        const MOST: usize = 6;
        let first = pairs.first()?;
        let body = self.touch.as_ref()?.body_name(first[1] as usize);
        let of_it = pairs.iter().filter(|pair| pair[1] == first[1]);
        let mut vertices: Vec<u32> = of_it.map(|pair| self.named(pair[0])).collect();
        vertices.sort_unstable();
        let more = match vertices.len().saturating_sub(MOST) {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        let others = match pairs.len() - vertices.len() {
            0 => String::new(),
            others => format!(", and {others} in other bodies"),
        };
        vertices.truncate(MOST);
        let vertices: Vec<String> = vertices.iter().map(u32::to_string).collect();
        Some(format!(
            "held vertices are in {body}, and the triangles around them pass through it: vertices {}{more}{others}",
            vertices.join(", ")
        ))
    }
}

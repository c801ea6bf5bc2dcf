//! The camera: frames what is to be seen, and maps points to the picture.

use crate::bounds::bounds;
use cloth_core::math::Vec3;

use super::{Projection, RenderError, SAMPLES, Surface, View};

/// Right, up and backward axes (the camera looks along −backward), and what maps them to samples.
#[derive(Debug)]
pub struct Camera {
    pub(super) right: Vec3,
    pub(super) up: Vec3,
    pub(super) back: Vec3,
    /// The point in the middle of the picture (m).
    centre: Vec3,
    /// Distance (m) from the eye to the centre; `None` for parallel rays.
    pub(super) distance: Option<f64>,
    /// Samples per metre at the centre.
    scale: f64,
    /// The middle of the picture, in samples.
    middle: [f64; 2],
}

impl Camera {
    /// The camera that has all of the surfaces in its picture.
    pub fn framing(surfaces: &[Surface<'_>], view: &View) -> Result<Self, RenderError> {
        let unit = |v: Vec3| v.try_normalize(1e-12);
        let degenerate = RenderError::View("direction and up must be independent vectors");
        let (back, right) = unit(-view.direction)
            .and_then(|back| Some((back, unit(view.up.cross(&back))?)))
            .ok_or(degenerate)?;
        let mut camera = Self {
            right,
            up: back.cross(&right),
            back,
            centre: Vec3::zeros(),
            distance: None,
            scale: 1.0,
            middle: [view.width, view.height].map(|side| (side * SAMPLES) as f64 / 2.0),
        };
        let corners = corners(surfaces, view.bounds);
        let [low, high] = camera.extent(&corners);
        let middle = (low + high) / 2.0;
        camera.centre = camera.right * middle.x + camera.up * middle.y + camera.back * middle.z;
        let half = ((high - low) / 2.0).map(|v| v.max(1e-9 * (1.0 + middle.norm())));
        // 6 % of the picture stay empty on each side.
        let room = camera.middle.map(|side| 0.88 * side);
        camera.scale = (room[0] / half.x).min(room[1] / half.y);
        if let Projection::Perspective { angle } = view.projection {
            if !(angle > 0.0 && angle < std::f64::consts::PI) {
                return Err(RenderError::View(
                    "the angle of view is not between 0 and π",
                ));
            }
            camera.step_back(&corners, half, room, angle);
        }
        if !camera.scale.is_finite() || !camera.centre.iter().all(|v| v.is_finite()) {
            return Err(RenderError::View("the box to frame is too large"));
        }
        Ok(camera)
    }

    /// Lower and upper bounds of `points` in camera axes (m).
    fn extent(&self, points: &[Vec3]) -> [Vec3; 2] {
        let axes = [self.right, self.up, self.back];
        let seen = |point: &Vec3| Vec3::from(axes.map(|axis| axis.dot(point)));
        bounds(points.iter().map(seen))
    }

    /// Moves the eye back until all corners are in the picture.
    fn step_back(&mut self, corners: &[Vec3], half: Vec3, room: [f64; 2], angle: f64) {
        let tangent = (angle / 2.0).tan();
        let smaller = self.middle[0].min(self.middle[1]);
        // The angle fixes how many samples a unit of slope takes; each corner then asks for a
        // distance.
        let focal = smaller / tangent;
        let needed = corners.iter().map(|corner| {
            let x = corner - self.centre;
            let sideways = (self.right.dot(&x).abs() * focal / room[0])
                .max(self.up.dot(&x).abs() * focal / room[1]);
            self.back.dot(&x) + sideways
        });
        let distance = needed.fold(half.z * 1.01 + 1e-6 * half.norm(), f64::max);
        self.distance = Some(distance);
        self.scale = focal / distance;
    }

    /// Where a point (m) stands: samples from left and top, and nearness, which grows towards the
    /// camera and is linear in the picture. `None` behind the eye.
    pub fn project(&self, point: &Vec3) -> Option<[f64; 3]> {
        let x = point - self.centre;
        let towards = self.back.dot(&x);
        let (shrink, nearness) = match self.distance {
            None => (1.0, towards),
            Some(distance) => {
                let depth = distance - towards;
                if depth < 1e-6 * distance {
                    return None;
                }
                (distance / depth, 1.0 / depth)
            }
        };
        let scale = self.scale * shrink;
        Some([
            self.middle[0] + scale * self.right.dot(&x),
            self.middle[1] - scale * self.up.dot(&x),
            nearness,
        ])
    }

    /// The unit vector from `point` to the eye.
    pub(super) fn towards_eye(&self, point: &Vec3) -> Vec3 {
        let Some(distance) = self.distance else {
            return self.back;
        };
        (self.centre + self.back * distance - point).normalize()
    }
}

/// The corners of the box to frame.
fn corners(surfaces: &[Surface<'_>], bounds: Option<[Vec3; 2]>) -> Vec<Vec3> {
    let Some([low, high]) = bounds else {
        // Every vertex is a corner: the box of a tilted sheet would leave much empty space.
        return surfaces
            .iter()
            .flat_map(|s| {
                s.triangles
                    .iter()
                    .flatten()
                    .map(|&v| s.positions[v as usize])
            })
            .collect();
    };
    let pick = |i: usize, bit: usize| {
        if i >> bit & 1 == 0 {
            low[bit]
        } else {
            high[bit]
        }
    };
    (0..8)
        .map(|i| Vec3::new(pick(i, 0), pick(i, 1), pick(i, 2)))
        .collect()
}

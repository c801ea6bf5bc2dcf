//! Triangles to pixels: z-buffer, shading, averaging of samples.

use cloth_core::math::Vec3;
use cloth_core::mesh::vertex_normals;

use super::camera::Camera;
use super::{SAMPLES, Surface, View};
use crate::report::palette::{Rgb, from_linear, to_linear};

/// Cosine of the angle between a triangle and the mean of those at its corner, from which on an edge is drawn there.
const EDGE: f64 = 0.9;

/// Linear-light colour samples with their nearness.
pub(super) struct Raster {
    width: usize,
    height: usize,
    nearness: Vec<f64>,
    colour: Vec<[f64; 3]>,
}

/// One corner of a triangle in the picture.
#[derive(Clone, Copy)]
struct Corner {
    at: [f64; 3],
    position: Vec3,
    normal: Vec3,
}

impl Raster {
    pub(super) fn new(view: &View) -> Self {
        let (width, height) = (view.width * SAMPLES, view.height * SAMPLES);
        let nearness = vec![f64::NEG_INFINITY; width * height];
        Self {
            width,
            height,
            nearness,
            colour: vec![[0.0; 3]; width * height],
        }
    }

    pub(super) fn draw(&mut self, surface: &Surface<'_>, camera: &Camera, view: &View) {
        let normals = vertex_normals(surface.positions, surface.triangles);
        let shade = Shade::new(surface, camera, view);
        for triangle in surface.triangles {
            let [a, b, c] = triangle.map(|v| surface.positions[v as usize]);
            let flat = (b - a).cross(&(c - a)).normalize();
            let is_edge = |normal: &Vec3| surface.has_edges && normal.dot(&flat) < EDGE;
            let corner = |i: usize| {
                let vertex = triangle[i] as usize;
                let position = surface.positions[vertex];
                let at = camera.project(&position)?;
                Some(Corner {
                    at,
                    position,
                    normal: match normals[vertex] {
                        normal if is_edge(&normal) => flat,
                        normal => normal,
                    },
                })
            };
            if let (Some(a), Some(b), Some(c)) = (corner(0), corner(1), corner(2)) {
                self.fill([a, b, c], &shade, camera);
            }
        }
    }

    fn fill(&mut self, corners: [Corner; 3], shade: &Shade, camera: &Camera) {
        let [a, b, c] = corners.map(|corner| corner.at);
        // Twice the signed area; the picture's y points down, so the front is negative.
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        if area == 0.0 || !area.is_finite() {
            return;
        }
        let front = area < 0.0;
        let side = |p: [f64; 3], q: [f64; 3]| (q[0] - p[0]).hypot(q[1] - p[1]);
        let heights = [side(b, c), side(c, a), side(a, b)].map(|edge| area.abs() / edge);
        let span = |axis: usize, size: usize| {
            let values = [a[axis], b[axis], c[axis]];
            let low = values.iter().copied().fold(f64::INFINITY, f64::min) - 0.5;
            let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max) - 0.5;
            (low.ceil().clamp(0.0, size as f64) as usize)
                ..(high.floor() + 1.0).clamp(0.0, size as f64) as usize
        };
        for y in span(1, self.height) {
            for x in span(0, self.width) {
                let (px, py) = (x as f64 + 0.5, y as f64 + 0.5);
                let share = |p: [f64; 3], q: [f64; 3]| {
                    ((q[0] - p[0]) * (py - p[1]) - (q[1] - p[1]) * (px - p[0])) / area
                };
                let weights = [share(b, c), share(c, a), share(a, b)];
                if weights.iter().any(|w| *w < 0.0) {
                    continue;
                }
                let nearness = weights[0] * a[2] + weights[1] * b[2] + weights[2] * c[2];
                let at = y * self.width + x;
                if nearness > self.nearness[at] {
                    self.nearness[at] = nearness;
                    self.colour[at] = shade.colour(corners, weights, heights, front, camera);
                }
            }
        }
    }

    /// Averages the samples of each pixel and hands over its sRGB colour and opacity.
    pub(super) fn resolve(
        &self,
        background: Option<Rgb>,
        mut put: impl FnMut(usize, usize, [u8; 4]),
    ) {
        let behind = background.map(|colour| colour.map(to_linear));
        let count = (SAMPLES * SAMPLES) as f64;
        for y in 0..self.height / SAMPLES {
            for x in 0..self.width / SAMPLES {
                let (mut sum, mut covered) = ([0.0; 3], 0.0);
                for sample in 0..SAMPLES * SAMPLES {
                    let row = y * SAMPLES + sample / SAMPLES;
                    let at = row * self.width + x * SAMPLES + sample % SAMPLES;
                    let hit = self.nearness[at] > f64::NEG_INFINITY;
                    if let Some(colour) = if hit { Some(self.colour[at]) } else { behind } {
                        (0..3).for_each(|i| sum[i] += colour[i]);
                        covered += 1.0;
                    }
                }
                let [r, g, b] = sum.map(|light| from_linear(light / f64::max(covered, 1.0)));
                put(x, y, [r, g, b, (255.0 * covered / count).round() as u8]);
            }
        }
    }
}

/// Lights and colours, in linear light and world axes.
struct Shade {
    front: [f64; 3],
    back: [f64; 3],
    key: Vec3,
    fill: Vec3,
    wire: f64,
}

impl Shade {
    fn new(surface: &Surface<'_>, camera: &Camera, view: &View) -> Self {
        let world =
            |v: Vec3| (camera.right * v.x + camera.up * v.y + camera.back * v.z).normalize();
        let light = view.light.try_normalize(1e-12).unwrap_or_else(Vec3::z);
        Self {
            front: surface.front.map(to_linear),
            back: surface.back.map(to_linear),
            key: world(light),
            fill: world(Vec3::new(-light.x, -0.3 * light.y, light.z.abs() + 0.3)),
            wire: view.wire.clamp(0.0, 1.0),
        }
    }

    /// The colour of the point with the given barycentric weights in the picture.
    fn colour(
        &self,
        corners: [Corner; 3],
        weights: [f64; 3],
        heights: [f64; 3],
        front: bool,
        camera: &Camera,
    ) -> [f64; 3] {
        // Weights in the picture are not weights in space, where rays converge.
        let mut weights_in_space = weights;
        if camera.distance.is_some() {
            (0..3).for_each(|i| weights_in_space[i] *= corners[i].at[2]);
            let sum: f64 = weights_in_space.iter().sum();
            weights_in_space.iter_mut().for_each(|w| *w /= sum);
        }
        let blend = |of: fn(&Corner) -> Vec3| {
            (0..3)
                .map(|i| of(&corners[i]) * weights_in_space[i])
                .sum::<Vec3>()
        };
        let eye = camera.towards_eye(&blend(|corner| corner.position));
        let facing = if front { 1.0 } else { -1.0 };
        let normal = blend(|corner| corner.normal)
            .try_normalize(1e-150)
            .unwrap_or(eye * facing)
            * facing;
        let lambert = |light: &Vec3| normal.dot(light).max(0.0);
        // Where the surface turns away from the eye it darkens a little: folds get an outline.
        let turned = 1.0 - normal.dot(&eye).clamp(0.0, 1.0);
        let light = 0.1 + 0.95 * lambert(&self.key) + 0.16 * lambert(&self.fill);
        let brightness = light * (1.0 - 0.45 * turned * turned);
        let colour = if front { self.front } else { self.back };
        let darker = 1.0 - 0.75 * self.wire * wire(weights, heights);
        colour.map(|light| light * brightness * darker)
    }
}

/// How much of a wire covers the point (0 to 1): one near an edge, fading out where the triangle
/// is small. `heights` are those of the triangle (samples).
fn wire(weights: [f64; 3], heights: [f64; 3]) -> f64 {
    let distance = (0..3)
        .map(|i| weights[i] * heights[i])
        .fold(f64::INFINITY, f64::min);
    let smallest = heights.into_iter().fold(f64::INFINITY, f64::min);
    let visible = ((smallest - 3.0) / 7.0).clamp(0.0, 1.0);
    // Half a line lies in each of the two triangles that share the edge.
    visible * (1.4 - distance).clamp(0.0, 1.0)
}

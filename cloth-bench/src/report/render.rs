//! Pictures of triangle meshes, drawn in software: what the cloth looks like.
//!
//! An orthographic or perspective camera frames the bounding box; triangles go through a z-buffer
//! and are shaded by the cosine to a key light (Lambert), with a weaker fill light from the other
//! side. Normals are averaged at vertices, so a coarse mesh looks smooth; that is a kindness to the
//! eye, not a property of the solution, and [`View::wire`] shows the triangles as they are. Front
//! (counter-clockwise) and back have different colours. There are no shadows.

use std::fmt;

use cloth_core::math::{Vec3, is_finite};

use super::palette::Rgb;
use camera::Camera;
use raster::Raster;

pub mod camera;
mod raster;

/// Samples per pixel along each side.
const SAMPLES: usize = 2;

/// A mesh and how it is coloured.
#[derive(Debug, Clone, Copy)]
pub struct Surface<'a> {
    /// Positions (m), one per vertex.
    pub positions: &'a [Vec3],
    /// Triangles, each three vertex numbers, counter-clockwise seen from the front.
    pub triangles: &'a [[u32; 3]],
    /// Colour of the front.
    pub front: Rgb,
    /// Colour of the back.
    pub back: Rgb,
    /// Whether sharp edges are drawn as edges, and not smoothly.
    pub has_edges: bool,
}

impl<'a> Surface<'a> {
    /// A piece of cloth: blue front, sand-coloured back.
    pub fn cloth(positions: &'a [Vec3], triangles: &'a [[u32; 3]]) -> Self {
        Self {
            positions,
            triangles,
            front: [0x3f, 0x86, 0xc4],
            back: [0xe3, 0xa8, 0x57],
            has_edges: false,
        }
    }

    /// Something solid that cloth lies on: grey.
    pub fn obstacle(positions: &'a [Vec3], triangles: &'a [[u32; 3]]) -> Self {
        Self {
            positions,
            triangles,
            front: [0xb4, 0xb7, 0xba],
            back: [0x8c, 0x8f, 0x92],
            has_edges: true,
        }
    }
}

/// How depth is projected.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Projection {
    /// Parallel rays: equal lengths look equal everywhere.
    Orthographic,
    /// Rays through one point.
    Perspective {
        /// Full angle of view (rad) over the smaller side of the picture, between 0 and π.
        angle: f64,
    },
}

/// Camera, light and picture size.
#[derive(Debug, Clone, PartialEq)]
pub struct View {
    /// Width (px).
    pub width: usize,
    /// Height (px).
    pub height: usize,
    /// Where the camera looks (any length).
    pub direction: Vec3,
    /// What is up in the picture (any length, not parallel to `direction`).
    pub up: Vec3,
    /// How depth is projected.
    pub projection: Projection,
    /// Towards the key light, in camera axes: right, up, towards the camera (any length).
    pub light: Vec3,
    /// Opacity (0 to 1) of the mesh edges drawn over the surface; 0 for none. Edges fade where
    /// triangles are only a few pixels large.
    pub wire: f64,
    /// Background, `None` for transparent.
    pub background: Option<Rgb>,
    /// The lower and upper corner (m) of the box to frame; `None` frames everything.
    pub bounds: Option<[Vec3; 2]>,
}

impl Default for View {
    /// 720 × 540 px, seen in perspective from the front, the right and above, with z up, on white.
    fn default() -> Self {
        Self {
            width: 720,
            height: 540,
            direction: Vec3::new(-0.45, 0.8, -0.42),
            up: Vec3::z(),
            projection: Projection::Perspective { angle: 0.5 },
            light: Vec3::new(-0.85, 0.6, 0.4),
            wire: 0.0,
            background: Some([255; 3]),
            bounds: None,
        }
    }
}

/// Why there is no picture.
#[derive(Debug, Clone, PartialEq)]
pub enum RenderError {
    /// There is no triangle.
    Empty,
    /// A position is NaN or infinite.
    NotFinite {
        /// Number of the vertex within its surface.
        vertex: usize,
    },
    /// A triangle names a vertex that does not exist.
    NoSuchVertex {
        /// Number of the triangle within its surface.
        triangle: usize,
        /// The vertex number it names.
        vertex: u32,
        /// How many vertices the surface has.
        vertex_count: usize,
    },
    /// The view cannot be drawn; the text says why.
    View(&'static str),
    /// The picture could not be encoded.
    Encoding(String),
}

impl fmt::Display for RenderError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => write!(f, "there is no triangle to draw"),
            Self::NotFinite { vertex } => {
                write!(f, "the position of vertex {vertex} is not finite")
            }
            Self::NoSuchVertex {
                triangle,
                vertex,
                vertex_count,
            } => write!(
                f,
                "triangle {triangle} names vertex {vertex}, but there are {vertex_count} vertices"
            ),
            Self::View(reason) => write!(f, "the view cannot be drawn: {reason}"),
            Self::Encoding(reason) => write!(f, "the PNG could not be written: {reason}"),
        }
    }
}

impl std::error::Error for RenderError {}

/// A PNG file that shows `surfaces` together.
///
/// # Errors
/// [`RenderError`] if there is nothing to draw, a position is not finite, a triangle names a
/// missing vertex, or the view is degenerate.
pub fn render(surfaces: &[Surface<'_>], view: &View) -> Result<Vec<u8>, RenderError> {
    check(surfaces, view)?;
    let camera = Camera::framing(surfaces, view)?;
    let (width, height) = (view.width, view.height);
    let mut pixels = vec![0; width * height * 4];
    let mut raster = Raster::new(view);
    for surface in surfaces {
        raster.draw(surface, &camera, view);
    }
    raster.resolve(view.background, |x, y, colour| {
        let at = 4 * (y * width + x);
        pixels[at..at + 4].copy_from_slice(&colour);
    });
    encode(&pixels, width, height)
}

fn encode(pixels: &[u8], width: usize, height: usize) -> Result<Vec<u8>, RenderError> {
    let failed = |error: png::EncodingError| RenderError::Encoding(error.to_string());
    let side = |pixels| u32::try_from(pixels).map_err(|_| RenderError::View("too many pixels"));
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, side(width)?, side(height)?);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header().map_err(failed)?;
    writer.write_image_data(pixels).map_err(failed)?;
    writer.finish().map_err(failed)?;
    Ok(file)
}

fn check(surfaces: &[Surface<'_>], view: &View) -> Result<(), RenderError> {
    if !(1..=16_384).contains(&view.width) || !(1..=16_384).contains(&view.height) {
        return Err(RenderError::View(
            "a side has less than 1 or more than 16384 pixels",
        ));
    }
    if surfaces.iter().all(|surface| surface.triangles.is_empty()) {
        return Err(RenderError::Empty);
    }
    for surface in surfaces {
        if let Some(vertex) = surface.positions.iter().position(|x| !is_finite(x)) {
            return Err(RenderError::NotFinite { vertex });
        }
        let vertex_count = surface.positions.len();
        for (triangle, vertices) in surface.triangles.iter().enumerate() {
            if let Some(&vertex) = vertices.iter().find(|&&v| v as usize >= vertex_count) {
                return Err(RenderError::NoSuchVertex {
                    triangle,
                    vertex,
                    vertex_count,
                });
            }
        }
    }
    Ok(())
}

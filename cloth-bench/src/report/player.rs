//! Runs that a page plays back in three dimensions, side by side, seen by one camera.
//!
//! Positions are kept with 16 bits a coordinate between the lowest and the highest of the surface: a 65536th of its
//! extent is below what a screen shows. The page needs WebGL 2 and nothing from outside.

use super::html::{base64, escape};
use crate::bounds::bounds;
use cloth_core::math::Vec3;
use serde::{Deserialize, Serialize};
use serde_json::json;

/// Several runs of one scene.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Playback {
    /// What it shows.
    pub caption: String,
    /// Time between two frames (s).
    pub seconds_per_frame: f64,
    /// The runs, in the order in which they stand side by side.
    pub tracks: Vec<Track>,
}

/// One run.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Track {
    /// Its name, such as that of the method.
    pub name: String,
    /// What is seen in it.
    pub surfaces: Vec<Film>,
}

/// A surface that moves.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Film {
    /// Whether it is cloth, with a front and a back, or an obstacle.
    is_cloth: bool,
    vertices: usize,
    /// Lowest coordinates (m), and how far the highest are above them.
    low: [f64; 3],
    size: [f64; 3],
    /// Vertices of the triangles: whole numbers of 32 bits, lowest byte first, as base64.
    triangles: String,
    /// Coordinates, frame after frame: whole numbers of 16 bits, lowest byte first, as base64.
    frames: String,
    /// How red each vertex is, frame after frame, in 255ths, as base64; none of a film without such colours.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    reds: Option<String>,
}

impl Film {
    /// A film of cloth.
    pub fn of_cloth(triangles: &[[u32; 3]], frames: &[Vec<Vec3>]) -> Self {
        Self::new(true, triangles, frames)
    }

    /// A film of an obstacle.
    pub fn of_obstacle(triangles: &[[u32; 3]], frames: &[Vec<Vec3>]) -> Self {
        Self::new(false, triangles, frames)
    }

    /// The same where each vertex in each frame, one after the other, is red by these fractions, from 0 to 1.
    pub fn with_colors(self, fractions: impl Iterator<Item = f64>) -> Self {
        let reds: Vec<u8> = fractions.map(|red| (255.0 * red).round() as u8).collect();
        Self {
            reds: Some(base64(&reds)),
            ..self
        }
    }

    fn new(is_cloth: bool, triangles: &[[u32; 3]], frames: &[Vec<Vec3>]) -> Self {
        let points = || frames.iter().flatten().copied();
        let [low, high] = bounds(points());
        let size = high - low;
        let place = |x: f64, low: f64, size: f64| {
            let share = if size > 0.0 { (x - low) / size } else { 0.0 };
            ((share * 65535.0).round() as u16).to_le_bytes()
        };
        let coordinates = points().flat_map(|p| {
            let three: [[u8; 2]; 3] = std::array::from_fn(|k| place(p[k], low[k], size[k]));
            three.into_iter().flatten()
        });
        let corners = triangles.iter().flatten().flat_map(|v| v.to_le_bytes());
        Self {
            is_cloth,
            vertices: frames.first().map_or(0, Vec::len),
            low: low.into(),
            size: size.into(),
            triangles: base64(&corners.collect::<Vec<u8>>()),
            frames: base64(&coordinates.collect::<Vec<u8>>()),
            reds: None,
        }
    }
}

/// The program that plays, once per page.
pub(super) const SCRIPT: &str = include_str!("player.js");

impl Playback {
    /// As an element of a page.
    pub fn to_html(&self) -> String {
        let tiles: String = self
            .tracks
            .iter()
            .map(|track| {
                format!(
                    "<div class=\"tile\"><span>{}</span></div>",
                    escape(&track.name)
                )
            })
            .collect();
        let data = json!({"seconds_per_frame": self.seconds_per_frame, "tracks": self.tracks});
        // A script ends at the first `</`, whatever it holds.
        let data = data.to_string().replace('<', "\\u003c");
        format!(
            "<figure class=\"player\"><div class=\"stage\"><canvas></canvas>{tiles}</div>\n\
             <div class=\"controls\"><button type=\"button\">Play</button>\
             <input type=\"range\" min=\"0\" max=\"0\" value=\"0\" aria-label=\"time\"/><output></output></div>\n\
             <figcaption>{} Drag to turn, scroll to come nearer.</figcaption>\n\
             <script type=\"application/json\">{data}</script></figure>\n",
            escape(&self.caption)
        )
    }
}

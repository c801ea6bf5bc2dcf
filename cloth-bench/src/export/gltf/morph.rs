//! A surface that changes its shape: a mesh with a morph target for every frame after the first.

use super::{FLOAT, Pieces, VERTICES, range, single};
use cloth_core::math::Vec3;
use serde_json::{Value, json};

/// Its frames so far.
#[derive(Default)]
pub(super) struct Morph {
    name: String,
    /// The first frame (m).
    start: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    /// Triangles that have vanished, with the number of the first frame without them.
    torn: Vec<(usize, Vec<[u32; 3]>)>,
    /// Displacements of all later frames, with the least and the largest of each.
    targets: Vec<u8>,
    ranges: Vec<[[f32; 3]; 2]>,
    /// Number of frames.
    frames: usize,
}

impl Morph {
    /// Before its first frame, in which it will be at `start` (m).
    pub(super) fn new(name: &str, start: &[Vec3], triangles: Vec<[u32; 3]>) -> Self {
        Self {
            name: name.to_owned(),
            start: start.to_vec(),
            triangles,
            ..Self::default()
        }
    }

    /// Size (bytes) in the file after so many frames, but for the JSON and the weights.
    pub(super) fn size(&self, frames: u64) -> u64 {
        let torn = self.torn.iter().map(|(_, triangles)| triangles.len());
        let f = self.triangles.len() + torn.sum::<usize>();
        let [v, f] = [self.start.len(), f].map(|n| n as u64);
        12 * (v * frames + f)
    }

    /// How far (m) a frame is from the first. The error is the first vertex that is not finite in single precision.
    pub(super) fn displacements(&self, positions: &[Vec3]) -> Result<Vec<[f32; 3]>, usize> {
        let moved = positions.iter().zip(&self.start);
        let displacements: Vec<[f32; 3]> = moved.map(|(x, start)| single(x - start)).collect();
        // A start or a displacement that is too large is seen in one of them.
        let mut all = positions.iter().map(|x| single(*x)).zip(&displacements);
        let is_far = |(x, d): ([f32; 3], &[f32; 3])| x.iter().chain(d).any(|c| !c.is_finite());
        match all.position(is_far) {
            Some(vertex) => Err(vertex),
            None => Ok(displacements),
        }
    }

    /// From the next frame on only these triangles are left, in the order that they have.
    pub(super) fn tear(&mut self, left: &[[u32; 3]]) {
        if left.len() == self.triangles.len() {
            return;
        }
        let mut left = left.iter().peekable();
        let all = std::mem::take(&mut self.triangles).into_iter();
        let is_left = |triangle: &[u32; 3]| left.next_if_eq(&triangle).is_some();
        let (kept, gone) = all.partition(is_left);
        self.triangles = kept;
        self.torn.push((self.frames, gone));
    }

    /// The meshes of what vanishes, beside that of the rest, with the numbers of the first frames without them.
    pub(super) fn torn(&self, rest: &Value, file: &mut Pieces) -> Vec<(usize, Value)> {
        let mesh = |(frame, triangles): &(usize, Vec<[u32; 3]>)| {
            let mut mesh = rest.clone();
            mesh["name"] = json!(format!("{} torn at frame {frame}", self.name));
            mesh["primitives"][0]["indices"] = json!(file.indices(triangles));
            (*frame, mesh)
        };
        self.torn.iter().map(mesh).collect()
    }

    /// Adds a frame that is so far (m) from the first.
    pub(super) fn add(&mut self, displacements: &[[f32; 3]]) {
        if self.frames > 0 {
            self.ranges.push(range(displacements));
            for number in displacements.as_flattened() {
                self.targets.extend(number.to_le_bytes());
            }
        }
        self.frames += 1;
    }

    /// The mesh with its targets, and a material of this number. It is written once.
    pub(super) fn write(&mut self, material: u32, file: &mut Pieces) -> Value {
        let mut primitive = file.surface(&self.start, &self.triangles);
        primitive["material"] = json!(material);
        let mut mesh = json!({"name": self.name});
        if !self.ranges.is_empty() {
            // One view for all targets: they are read one after the other.
            let view = file.view(&self.targets, Some(VERTICES), Some(12));
            self.targets = Vec::new();
            let count = self.start.len();
            let targets: Vec<Value> = self
                .ranges
                .iter()
                .enumerate()
                .map(|(index, [min, max])| {
                    let accessor = json!({"bufferView": view, "byteOffset": 12 * count * index, "componentType": FLOAT,
                        "count": count, "type": "VEC3", "min": min, "max": max});
                    json!({"POSITION": file.accessor(accessor)})
                })
                .collect();
            mesh["weights"] = json!(vec![0.0; targets.len()]);
            primitive["targets"] = json!(targets);
        }
        mesh["primitives"] = json!([primitive]);
        mesh
    }
}

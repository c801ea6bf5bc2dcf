//! Binary glTF 2.0 with the run as an animation of morph targets.
//!
//! The cloth is one mesh. Every frame after the first is a morph target, a displacement of each vertex (m) from the
//! first frame, and the animation blends from one to the next: at the time of frame i the weight of its target is 1 and
//! all others are 0, linear in between. What is torn out of it is a mesh of its own with the same targets, whose node
//! is scaled to nothing from the first frame without it on. Obstacles that change their shape are the same, and rigid
//! ones are nodes that move and turn. Names and limits are those of the *glTF 2.0 specification* (Khronos, ISO/IEC
//! 12113).
//!
//! Size: 12 bytes for each vertex and frame, of the cloth and of obstacles that change their shape, and 4 for each pair
//! of frames, because the animation lists all weights at the time of every frame. Many viewers on the web cannot have
//! more than 256 targets; `--export-every` makes fewer.
//!
//! The validator of the Khronos group (`npm install gltf-validator`) finds nothing to say about these files:
//!
//! ```sh
//! cargo run --release -p cloth-bench -- run drape-box --method xpbd --n 17 --steps 60 --export out --format gltf
//! node -e 'require("gltf-validator").validateBytes(new Uint8Array(require("fs").readFileSync("out/run.glb"))).then(r => console.log(r.issues))'
//! ```

mod morph;

use super::{Folder, Frame, Writer};
use crate::error::BenchError;
use crate::scene::BodySurface;
use cloth_collide::obstacle::Pose;
use cloth_core::math::{Real, Vec3};
use morph::Morph;
use nalgebra::UnitQuaternion;
use serde_json::{Value, json};

/// Component types, buffer targets and chunk types of the specification.
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
const VERTICES: u32 = 34962;
const INDICES: u32 = 34963;
const JSON_CHUNK: u32 = u32::from_le_bytes(*b"JSON");
const BINARY_CHUNK: u32 = u32::from_le_bytes(*b"BIN\0");

/// The frames so far.
pub(super) struct Gltf {
    name: String,
    /// Turns the scene so that y is up.
    upright: UnitQuaternion<Real>,
    times: Vec<f32>,
    cloth: Morph,
    bodies: Vec<Body>,
}

/// An obstacle in all frames.
enum Body {
    Rigid(Moving),
    Morphing(Morph),
}

/// A rigid obstacle in all frames.
struct Moving {
    name: String,
    /// In the first frame.
    positions: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    first: Pose,
    is_still: bool,
    /// How it has moved since the first frame.
    translations: Vec<[f32; 3]>,
    rotations: Vec<[f32; 4]>,
}

impl Body {
    fn new(body: &BodySurface<'_>) -> Self {
        let (name, triangles) = (body.name(), body.triangles.to_vec());
        match body.pose {
            Some(first) => Self::Rigid(Moving {
                name,
                positions: body.positions.clone(),
                triangles,
                first,
                is_still: body.is_still,
                translations: Vec::new(),
                rotations: Vec::new(),
            }),
            None => Self::Morphing(Morph::new(&name, &body.positions, triangles)),
        }
    }
}

impl Moving {
    /// x ↦ R x + t takes the first frame to this one.
    fn add(&mut self, pose: &Pose) {
        let turn = pose.orientation * self.first.orientation.inverse();
        let shift = pose.position - turn * self.first.position;
        let mut rotation = quaternion(&turn);
        // Both signs are the same rotation; the nearer one is the short way from the last.
        if let Some(last) = self.rotations.last() {
            let product: f32 = last.iter().zip(&rotation).map(|(a, b)| a * b).sum();
            if product < 0.0 {
                rotation = rotation.map(|c| -c);
            }
        }
        self.translations.push(single(shift));
        self.rotations.push(rotation);
    }
}

impl Gltf {
    /// For a run of the scene `name` under this gravity (m/s²); z is up without any.
    pub(super) fn new(name: &str, gravity: Vec3) -> Self {
        let up = -gravity.try_normalize(0.0).unwrap_or(-Vec3::z());
        let upside_down = || UnitQuaternion::from_axis_angle(&Vec3::x_axis(), std::f64::consts::PI);
        Self {
            name: name.to_owned(),
            upright: UnitQuaternion::rotation_between(&up, &Vec3::y()).unwrap_or_else(upside_down),
            times: Vec::new(),
            cloth: Morph::default(),
            bodies: Vec::new(),
        }
    }

    /// Size of the file if it ended here (bytes), but for the JSON and rigid obstacles.
    fn size(&self, frames: u64) -> u64 {
        let morphing = self.bodies.iter().filter_map(|body| match body {
            Body::Morphing(morph) => Some(morph),
            Body::Rigid(_) => None,
        });
        let all = morphing.chain([&self.cloth]);
        all.map(|morph| morph.size(frames)).sum::<u64>() + 4 * frames * frames.saturating_sub(1)
    }
}

/// More bytes than this have no room in the 32 bits that count them, with some left for the JSON.
const LARGEST: u64 = u32::MAX as u64 - (1 << 28);

impl Writer for Gltf {
    fn frame(&mut self, frame: &Frame<'_>, _: &mut Folder) -> Result<(), BenchError> {
        if frame.index == 0 {
            self.cloth = Morph::new("cloth", &frame.positions, frame.triangles.to_vec());
            self.bodies = frame.obstacles.iter().map(Body::new).collect();
        }
        if self.size(u64::from(frame.index) + 1) > LARGEST {
            return Err(BenchError::Failed(format!(
                "{} frames of {} vertices have no room in one glTF file of 4 GiB: use --export-every",
                frame.index + 1,
                frame.positions.len()
            )));
        }
        let far = |vertex: usize, of: String| {
            BenchError::Failed(format!(
                "vertex {vertex}{of} after step {} is too far out for the single precision of glTF",
                frame.step
            ))
        };
        // A frame that is refused leaves nothing behind.
        let cloth = self.cloth.displacements(&frame.positions);
        let cloth = cloth.map_err(|vertex| far(vertex, String::new()))?;
        let mut moved = Vec::new();
        for (body, surface) in self.bodies.iter().zip(&frame.obstacles) {
            if let Body::Morphing(morph) = body {
                let displacements = morph.displacements(&surface.positions);
                let of = || format!(" of {}", surface.name());
                moved.push(displacements.map_err(|vertex| far(vertex, of()))?);
            }
        }
        self.times.push(frame.time as f32);
        self.cloth.tear(frame.triangles);
        self.cloth.add(&cloth);
        let mut moved = moved.iter();
        for (body, surface) in self.bodies.iter_mut().zip(&frame.obstacles) {
            match body {
                Body::Rigid(moving) => surface.pose.iter().for_each(|pose| moving.add(pose)),
                Body::Morphing(morph) => moved.by_ref().take(1).for_each(|d| morph.add(d)),
            }
        }
        Ok(())
    }

    fn finish(&mut self, folder: &mut Folder) -> Result<(), BenchError> {
        let mut file = Pieces::default();
        let targets = self.times.len().saturating_sub(1);
        let mut meshes = vec![self.cloth.write(0, &mut file)];
        let torn = self.cloth.torn(&meshes[0], &mut file);
        let mut nodes = vec![json!({
            "name": self.name,
            "rotation": quaternion(&self.upright),
            "children": (1..=self.bodies.len() + torn.len() + 1).collect::<Vec<_>>(),
        })];
        nodes.push(json!({"name": "cloth", "mesh": 0}));
        let (mut samplers, mut channels) = (Vec::new(), Vec::new());
        let mut animate = |input: usize, output: usize, node: usize, path: &str| {
            channels
                .push(json!({"sampler": samplers.len(), "target": {"node": node, "path": path}}));
            // What is torn out vanishes at once.
            let way = if path == "scale" { "STEP" } else { "LINEAR" };
            samplers.push(json!({"input": input, "output": output, "interpolation": way}));
        };
        let played = (targets > 0).then(|| {
            let weight = |i: usize| (1..=targets).map(move |target| f32::from(target == i));
            let weights: Vec<f32> = (0..=targets).flat_map(weight).collect();
            let times = file.times(&self.times);
            (times, file.numbers(&weights, "SCALAR", weights.len()))
        });
        if let Some((times, weights)) = played {
            animate(times, weights, 1, "weights");
            for (frame, mesh) in torn {
                let node = nodes.len();
                nodes.push(json!({"name": mesh["name"], "mesh": meshes.len()}));
                meshes.push(mesh);
                animate(times, weights, node, "weights");
                let moments = file.times(&[self.times[0], self.times[frame]]);
                let scales = file.numbers(&[1.0, 1.0, 1.0, 0.0, 0.0, 0.0], "VEC3", 2);
                animate(moments, scales, node, "scale");
            }
        }
        for body in &mut self.bodies {
            let node = nodes.len();
            let mesh = match body {
                Body::Rigid(body) => file.rigid(body),
                Body::Morphing(morph) => morph.write(1, &mut file),
            };
            nodes.push(json!({"name": mesh["name"], "mesh": meshes.len()}));
            meshes.push(mesh);
            match (played, body) {
                (Some((times, _)), Body::Rigid(body)) if !body.is_still => {
                    let (shifts, turns) = (&body.translations, &body.rotations);
                    let shifts = file.numbers(shifts.as_flattened(), "VEC3", shifts.len());
                    let turns = file.numbers(turns.as_flattened(), "VEC4", turns.len());
                    animate(times, shifts, node, "translation");
                    animate(times, turns, node, "rotation");
                }
                (Some((times, weights)), Body::Morphing(_)) => {
                    animate(times, weights, node, "weights");
                }
                _ => {}
            }
        }
        let material = |name: &str, colour: [Real; 4]| {
            json!({"name": name, "doubleSided": true, "pbrMetallicRoughness":
                {"baseColorFactor": colour, "metallicFactor": 0.0, "roughnessFactor": 0.8}})
        };
        let mut materials = vec![material("cloth", [0.18, 0.36, 0.62, 1.0])];
        if !self.bodies.is_empty() {
            materials.push(material("obstacle", [0.5, 0.5, 0.5, 1.0]));
        }
        let mut document = json!({
            "asset": {"version": "2.0", "generator": concat!("cloth-bench ", env!("CARGO_PKG_VERSION"))},
            "scene": 0,
            "scenes": [{"name": self.name, "nodes": [0]}],
            "nodes": nodes,
            "meshes": meshes,
            "materials": materials,
            "accessors": file.accessors,
            "bufferViews": file.views,
            "buffers": [{"byteLength": file.bytes.len()}],
        });
        if !channels.is_empty() {
            document["animations"] =
                json!([{"name": "run", "samplers": samplers, "channels": channels}]);
        }
        let mut text = document.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let length = 12 + 8 + text.len() + 8 + file.bytes.len();
        let too_large = |_| BenchError::Failed("the run is larger than the 4 GiB of glTF".into());
        let length = u32::try_from(length).map_err(too_large)?;
        let word = |number: u32| number.to_le_bytes();
        let head = [*b"glTF", word(2), word(length)].concat();
        let before_text = [word(text.len() as u32), word(JSON_CHUNK)].concat();
        let before_bytes = [word(file.bytes.len() as u32), word(BINARY_CHUNK)].concat();
        folder.write(
            "run.glb",
            &[&head, &before_text, &text, &before_bytes, &file.bytes],
        )
    }
}

/// The binary part, and what the JSON says of it.
#[derive(Default)]
struct Pieces {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Pieces {
    fn view(&mut self, bytes: &[u8], target: Option<u32>, stride: Option<u32>) -> usize {
        let mut view =
            json!({"buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len()});
        if let Some(target) = target {
            view["target"] = json!(target);
        }
        if let Some(stride) = stride {
            view["byteStride"] = json!(stride);
        }
        self.bytes.extend(bytes);
        self.views.push(view);
        self.views.len() - 1
    }

    fn accessor(&mut self, accessor: Value) -> usize {
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    /// An accessor of the corners of triangles.
    fn indices(&mut self, triangles: &[[u32; 3]]) -> usize {
        let corners = triangles.as_flattened();
        let bytes: Vec<u8> = corners.iter().flat_map(|v| v.to_le_bytes()).collect();
        let view = self.view(&bytes, Some(INDICES), None);
        self.accessor(json!({"bufferView": view, "componentType": UNSIGNED_INT,
            "count": corners.len(), "type": "SCALAR"}))
    }

    /// A primitive of triangles without a material.
    fn surface(&mut self, positions: &[Vec3], triangles: &[[u32; 3]]) -> Value {
        let indices = self.indices(triangles);
        let places: Vec<[f32; 3]> = positions.iter().map(|&x| single(x)).collect();
        let numbers = places.as_flattened().iter();
        let bytes: Vec<u8> = numbers.flat_map(|c| c.to_le_bytes()).collect();
        let view = self.view(&bytes, Some(VERTICES), None);
        let [min, max] = range(&places);
        let position = self.accessor(json!({"bufferView": view, "componentType": FLOAT,
            "count": places.len(), "type": "VEC3", "min": min, "max": max}));
        json!({"attributes": {"POSITION": position}, "indices": indices})
    }

    /// The mesh of a rigid obstacle.
    fn rigid(&mut self, body: &Moving) -> Value {
        let mut primitive = self.surface(&body.positions, &body.triangles);
        primitive["material"] = json!(1);
        json!({"name": body.name, "primitives": [primitive]})
    }

    /// An accessor of numbers of an animation.
    fn numbers(&mut self, numbers: &[f32], kind: &str, count: usize) -> usize {
        let bytes: Vec<u8> = numbers.iter().flat_map(|c| c.to_le_bytes()).collect();
        let view = self.view(&bytes, None, None);
        self.accessor(
            json!({"bufferView": view, "componentType": FLOAT, "count": count, "type": kind}),
        )
    }

    fn times(&mut self, times: &[f32]) -> usize {
        let accessor = self.numbers(times, "SCALAR", times.len());
        self.accessors[accessor]["min"] = json!(times.first().into_iter().collect::<Vec<_>>());
        self.accessors[accessor]["max"] = json!(times.last().into_iter().collect::<Vec<_>>());
        accessor
    }
}

fn single(x: Vec3) -> [f32; 3] {
    [x.x as f32, x.y as f32, x.z as f32]
}

fn quaternion(rotation: &UnitQuaternion<Real>) -> [f32; 4] {
    let q = rotation.as_vector();
    [q.x as f32, q.y as f32, q.z as f32, q.w as f32]
}

/// Least and largest coordinates.
fn range(points: &[[f32; 3]]) -> [[f32; 3]; 2] {
    let mut range = [[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]];
    for point in points {
        for axis in 0..3 {
            range[0][axis] = range[0][axis].min(point[axis]);
            range[1][axis] = range[1][axis].max(point[axis]);
        }
    }
    range
}

//! Binary glTF files, read.

use cloth_core::math::Vec3;
use serde_json::Value;
use std::path::Path;

/// A GLB file, taken apart.
pub(crate) struct Glb {
    pub(crate) json: Value,
    bytes: Vec<u8>,
}

impl Glb {
    pub(crate) fn read(path: &Path) -> Self {
        let file = std::fs::read(path).unwrap();
        let word = |at: usize| u32::from_le_bytes(file[at..at + 4].try_into().unwrap()) as usize;
        assert_eq!(&file[..4], b"glTF");
        assert_eq!([word(4), word(8)], [2, file.len()]);
        assert_eq!(&file[16..20], b"JSON");
        let end = 20 + word(12);
        assert_eq!(&file[end + 4..end + 8], b"BIN\0");
        assert_eq!(
            [end % 4, word(end), end + 8 + word(end)],
            [0, file.len() - end - 8, file.len()]
        );
        let json: Value = serde_json::from_slice(&file[20..end]).unwrap();
        let bytes = file[end + 8..].to_vec();
        assert_eq!(json["buffers"][0]["byteLength"], bytes.len());
        Self { json, bytes }
    }

    /// The 32-bit words of an accessor, whose bounds are checked.
    fn words(&self, accessor: &Value) -> Vec<[u8; 4]> {
        let accessor = &self.json["accessors"][accessor.as_u64().unwrap() as usize];
        let number = |value: &Value| value.as_u64().unwrap_or(0) as usize;
        let view = &self.json["bufferViews"][number(&accessor["bufferView"])];
        let parts = match accessor["type"].as_str().unwrap() {
            "SCALAR" => 1,
            "VEC3" => 3,
            "VEC4" => 4,
            other => panic!("{other}"),
        };
        let from = number(&accessor["byteOffset"]);
        let length = 4 * parts * number(&accessor["count"]);
        assert!(from + length <= number(&view["byteLength"]));
        let at = number(&view["byteOffset"]) + from;
        assert_eq!(at % 4, 0);
        let words = self.bytes[at..at + length].as_chunks().0.to_vec();
        if let Some(least) = accessor["min"].as_array() {
            for (axis, least) in least.iter().enumerate() {
                let values = words
                    .iter()
                    .skip(axis)
                    .step_by(parts)
                    .map(|w| f32::from_le_bytes(*w));
                let (low, high) =
                    values.fold((f32::MAX, f32::MIN), |(a, b), v| (a.min(v), b.max(v)));
                assert_eq!(least.as_f64().unwrap() as f32, low);
                assert_eq!(accessor["max"][axis].as_f64().unwrap() as f32, high);
            }
        }
        words
    }

    pub(crate) fn floats(&self, accessor: &Value) -> Vec<f64> {
        let words = self.words(accessor).into_iter();
        words.map(|w| f64::from(f32::from_le_bytes(w))).collect()
    }

    pub(crate) fn vectors(&self, accessor: &Value) -> Vec<Vec3> {
        self.floats(accessor)
            .chunks(3)
            .map(Vec3::from_column_slice)
            .collect()
    }

    /// Sampler of the animation for a path of a node, linear in between: times and values.
    pub(crate) fn animation(&self, node: usize, path: &str) -> Option<[Vec<f64>; 2]> {
        self.sampler(node, path, "LINEAR")
    }

    /// The same of one that jumps.
    pub(crate) fn stepped(&self, node: usize, path: &str) -> Option<[Vec<f64>; 2]> {
        self.sampler(node, path, "STEP")
    }

    fn sampler(&self, node: usize, path: &str, way: &str) -> Option<[Vec<f64>; 2]> {
        let animation = &self.json["animations"][0];
        let channel = animation["channels"].as_array()?.iter().find(|channel| {
            channel["target"]["node"] == node && channel["target"]["path"] == path
        })?;
        let sampler = &animation["samplers"][channel["sampler"].as_u64().unwrap() as usize];
        assert_eq!(sampler["interpolation"], way);
        Some([
            self.floats(&sampler["input"]),
            self.floats(&sampler["output"]),
        ])
    }

    pub(crate) fn mesh_of(&self, node: usize) -> &Value {
        let mesh = self.json["nodes"][node]["mesh"].as_u64().unwrap();
        &self.json["meshes"][mesh as usize]
    }

    pub(crate) fn corners(&self, primitive: &Value) -> Vec<u32> {
        self.words(&primitive["indices"])
            .into_iter()
            .map(u32::from_le_bytes)
            .collect()
    }
}

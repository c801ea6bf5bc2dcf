//! XML files of VTK: polygons (`.vtp`) frame by frame, and a collection (`.pvd`) that gives them their times.
//!
//! Numbers follow the XML as raw bytes, each array after its length in bytes (*VTK file formats*, Kitware, section on
//! XML formats).

use super::{Folder, Frame, Writer};
use crate::error::BenchError;
use cloth_core::math::{Real, Vec3};
use std::fmt::Write as _;

/// The files so far, with their times.
#[derive(Default)]
pub(super) struct Vtk {
    entries: String,
}

impl Writer for Vtk {
    fn frame(&mut self, frame: &Frame<'_>, folder: &mut Folder) -> Result<(), BenchError> {
        let (step, time) = (frame.step, frame.time);
        let name = format!("cloth_{step:05}.vtp");
        let mut arrays = vec![("velocity", &frame.velocities[..])];
        arrays.extend(frame.force_vectors());
        let cloth = polygons(time, &frame.positions, frame.triangles, &arrays);
        folder.write(&name, &[&cloth])?;
        self.enter(time, 0, "cloth", &name);
        for (part, body) in frame.obstacles.iter().enumerate() {
            let name = if body.is_still {
                format!("{}.vtp", body.name())
            } else {
                format!("{}_{step:05}.vtp", body.name())
            };
            if frame.index == 0 || !body.is_still {
                let bytes = polygons(time, &body.positions, body.triangles, &[]);
                folder.write(&name, &[&bytes])?;
            }
            self.enter(time, part + 1, &body.name(), &name);
        }
        Ok(())
    }

    fn finish(&mut self, folder: &mut Folder) -> Result<(), BenchError> {
        let text = format!(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n  <Collection>\n{}  \
             </Collection>\n</VTKFile>\n",
            self.entries
        );
        folder.write("run.pvd", &[text.as_bytes()])
    }
}

impl Vtk {
    fn enter(&mut self, time: Real, part: usize, name: &str, file: &str) {
        // Writing to a string cannot fail.
        let _ = writeln!(
            self.entries,
            "    <DataSet timestep=\"{time:?}\" part=\"{part}\" name=\"{name}\" file=\"{file}\"/>"
        );
    }
}

/// A `.vtp` file of triangles with vectors at their vertices.
fn polygons(
    time: Real,
    positions: &[Vec3],
    triangles: &[[u32; 3]],
    vectors: &[(&str, &[Vec3])],
) -> Vec<u8> {
    let mut data = Appended::default();
    let mut point_data = String::new();
    if let Some((first, _)) = vectors.first() {
        let tags = vectors
            .iter()
            .map(|(name, values)| data.vectors(name, values));
        let tags: String = tags.collect();
        point_data = format!("      <PointData Vectors=\"{first}\">{tags}</PointData>\n");
    }
    let points = data.vectors("position", positions);
    let corners = triangles.as_flattened().iter().map(|&v| i64::from(v));
    let connectivity = data.integers("connectivity", corners);
    let offsets = data.integers("offsets", (1..=triangles.len()).map(|n| 3 * n as i64));
    let head = format!(
        "<?xml version=\"1.0\"?>\n\
         <VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n  <PolyData>\n    <FieldData>\
         <DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" format=\"ascii\">{time:?}</DataArray></FieldData>\n    \
         <Piece NumberOfPoints=\"{}\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"{}\">\n{point_data}      \
         <Points>{points}</Points>\n      <Polys>{connectivity}{offsets}</Polys>\n    </Piece>\n  </PolyData>\n  <AppendedData encoding=\"raw\">_",
        positions.len(),
        triangles.len()
    );
    let tail = b"</AppendedData>\n</VTKFile>\n";
    [head.as_bytes(), &data.bytes, tail].concat()
}

/// The arrays behind the XML.
#[derive(Default)]
struct Appended {
    bytes: Vec<u8>,
}

impl Appended {
    /// Adds an array, and gives the tag that refers to it.
    fn vectors(&mut self, name: &str, values: &[Vec3]) -> String {
        let numbers = values.iter().flat_map(|v| v.iter().copied());
        let offset = self.add(numbers.flat_map(Real::to_le_bytes));
        format!(
            "<DataArray type=\"Float64\" Name=\"{name}\" NumberOfComponents=\"3\" format=\"appended\" offset=\"{offset}\"/>"
        )
    }

    fn integers(&mut self, name: &str, values: impl Iterator<Item = i64>) -> String {
        let offset = self.add(values.flat_map(i64::to_le_bytes));
        format!(
            "<DataArray type=\"Int64\" Name=\"{name}\" format=\"appended\" offset=\"{offset}\"/>"
        )
    }

    fn add(&mut self, values: impl Iterator<Item = u8>) -> usize {
        let offset = self.bytes.len();
        self.bytes.extend([0; 8]);
        self.bytes.extend(values);
        let length = (self.bytes.len() - offset - 8) as u64;
        self.bytes[offset..offset + 8].copy_from_slice(&length.to_le_bytes());
        offset
    }
}

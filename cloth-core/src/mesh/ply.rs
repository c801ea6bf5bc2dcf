//! PLY (the polygon file format of Stanford), in and out, as text and in both binary byte orders, with the place of
//! every mistake.
//!
//! A header names tables, their columns and types; a cloth needs the columns `x`, `y`, `z` of the table `vertex` and
//! the list `vertex_indices` (or `vertex_index`) of the table `face`, of any type. Other tables and columns (normals,
//! colours, edges, …) are skipped. A polygon becomes a fan around its first corner, or, where that would leave it,
//! is [cut by ears](super#polygons).
//!
//! [`parse`] refuses what [`TriMesh::new`] and [`EdgeTable::build`] refuse, and says where it stands: in which line of
//! a text, at which byte of a binary body.
//!
//! Limits: the unit is not written anywhere; we take metres. Strips of triangles (`tristrips`) are not read. Polygons
//! and everything skipped are lost when a file is read and written again; vertices and triangles keep their order and
//! every bit, because coordinates are written in double precision.

mod error;
mod header;
mod values;

pub use error::PlyProblem;

use super::file_error::{self, MeshFileError, MeshFileProblem, Place};
use super::polygon::{cut_concave, fan};
use super::{MeshError, TriMesh};
use crate::math::Vec3;
use crate::topology::EdgeTable;
use header::{Element, Header, Property};
use std::io::Write as _;
use std::path::Path;
use values::{Number, Values};

/// How the numbers of a file are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// As text, one vertex or face a line.
    Ascii,
    /// As bits, the least significant byte first.
    BinaryLittleEndian,
    /// As bits, the most significant byte first.
    BinaryBigEndian,
}

impl Encoding {
    const ALL: [Self; 3] = [Self::Ascii, Self::BinaryLittleEndian, Self::BinaryBigEndian];

    /// Its name in the header.
    fn name(self) -> &'static str {
        match self {
            Self::Ascii => "ascii",
            Self::BinaryLittleEndian => "binary_little_endian",
            Self::BinaryBigEndian => "binary_big_endian",
        }
    }
}

/// Reads a mesh (positions in m) from a file.
///
/// # Errors
/// [`MeshFileError`] with the path if the file cannot be read, with path and place if it can be read
/// and is wrong.
pub fn read(path: &Path) -> Result<TriMesh, MeshFileError> {
    file_error::read(path, parse)
}

/// Reads the vertices (m) of a file alone, whatever mesh its faces make: a state of a mesh that is known already.
///
/// # Errors
/// [`MeshFileError`] with the path if the file cannot be read, with path and place if its header or a value cannot be
/// understood, or a coordinate is not finite.
pub fn read_vertices(path: &Path) -> Result<Vec<Vec3>, MeshFileError> {
    file_error::read(path, |bytes| Ok(Source::scan(bytes)?.positions))
}

/// Reads a mesh (positions in m) from the bytes of a file.
///
/// # Errors
/// [`MeshFileError`] with the place, for the first mistake of this list of which there is one: a header
/// or a value that cannot be understood, then whatever [`TriMesh::new`] refuses, then an edge with
/// more than two faces.
pub fn parse(bytes: &[u8]) -> Result<TriMesh, MeshFileError> {
    Source::scan(bytes)?.finish()
}

/// Reads one row and keeps the values of the wanted columns with their numbers.
fn read_row(
    values: &mut Values<'_>,
    element: &Element,
    index: u64,
    wanted: &[usize],
    kept: &mut Vec<(usize, Number)>,
) -> Result<(), MeshFileError> {
    kept.clear();
    for (column, property) in element.properties.iter().enumerate() {
        let length = match property.length {
            Some(kind) => match values.value(kind, element, index)? {
                // A negative length is an empty list.
                Number::Whole(length) => length.max(0),
                Number::Broken(_) => 0,
            },
            None => 1,
        };
        for _ in 0..length {
            let value = values.value(property.kind, element, index)?;
            if wanted.contains(&column) {
                kept.push((column, value));
            }
        }
    }
    values.end_row(element)
}

/// Everything a file says, not yet checked as a mesh.
#[derive(Default)]
struct Source {
    vertex_count: u64,
    positions: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    /// Where each vertex and each face was written down.
    vertex_places: Vec<Place>,
    face_places: Vec<Place>,
    /// The face of each triangle.
    face_of_triangle: Vec<usize>,
    corners: Vec<u32>,
}

impl Source {
    fn scan(bytes: &[u8]) -> Result<Self, MeshFileError> {
        let header = Header::parse(bytes)?;
        let missing = |what| MeshFileError::new(None, PlyProblem::Missing { what });
        let element = |name: &str| header.elements.iter().find(|e| e.name == name);
        let vertices = element("vertex").ok_or_else(|| missing("element \"vertex\""))?;
        let faces = element("face").ok_or_else(|| missing("element \"face\""))?;
        let column = |element: &Element, suits: &dyn Fn(&Property) -> bool| {
            element.properties.iter().position(suits)
        };
        let mut axes = [0; 3];
        for (axis, name) in axes.iter_mut().zip(["x", "y", "z"]) {
            let found = column(vertices, &|p| p.name == name && p.length.is_none());
            *axis =
                found.ok_or_else(|| missing("property \"x\", \"y\" and \"z\" of the vertices"))?;
        }
        let corners = column(faces, &|p| {
            let named = matches!(&p.name[..], "vertex_indices" | "vertex_index");
            named && p.length.is_some() && p.kind.is_integer()
        });
        let corners = corners
            .ok_or_else(|| missing("list of whole numbers \"vertex_indices\" of the faces"))?;

        let mut values = Values::new(bytes, header.encoding, header.body);
        let mut source = Source {
            vertex_count: vertices.count,
            ..Source::default()
        };
        let mut kept = Vec::new();
        for element in &header.elements {
            let wanted: &[usize] = match &element.name[..] {
                "vertex" => &axes,
                "face" => &[corners],
                _ => &[],
            };
            // Rows without columns take no room in the file, so there may be any number of them.
            let rows = if element.properties.is_empty() {
                0
            } else {
                element.count
            };
            for index in 0..rows {
                let place = values.row(element, index)?;
                read_row(&mut values, element, index, wanted, &mut kept)?;
                match &element.name[..] {
                    "vertex" => source.add_vertex(place, &kept, axes)?,
                    "face" => source.add_face(place, &kept)?,
                    _ => {}
                }
            }
        }
        values.end()?;
        Ok(source)
    }

    fn add_vertex(
        &mut self,
        place: Place,
        kept: &[(usize, Number)],
        axes: [usize; 3],
    ) -> Result<(), MeshFileError> {
        let coordinate = |axis: usize| {
            let found = kept.iter().find(|(column, _)| *column == axes[axis]);
            found.map_or(0.0, |(_, number)| number.real())
        };
        let position = Vec3::new(coordinate(0), coordinate(1), coordinate(2));
        if !crate::math::is_finite(&position) {
            return Err(MeshFileError::new(Some(place), MeshFileProblem::NotFinite));
        }
        self.positions.push(position);
        self.vertex_places.push(place);
        Ok(())
    }

    fn add_face(&mut self, place: Place, kept: &[(usize, Number)]) -> Result<(), MeshFileError> {
        let refused = |problem| Err(MeshFileError::new(Some(place), problem));
        if kept.len() < 3 {
            let found = kept.len();
            return refused(MeshFileProblem::TooFewCorners { found });
        }
        self.corners.clear();
        for &(_, number) in kept {
            let Number::Whole(index) = number else {
                continue; // the column is of whole numbers
            };
            match u32::try_from(index) {
                Ok(corner) if u64::from(corner) < self.vertex_count => self.corners.push(corner),
                _ => {
                    let vertex_count = self.vertex_count;
                    let problem = PlyProblem::NoSuchVertex {
                        index,
                        vertex_count,
                    };
                    return refused(problem.into());
                }
            }
        }
        for triangle in fan(&self.corners) {
            self.triangles.push(triangle);
            self.face_of_triangle.push(self.face_places.len());
        }
        self.face_places.push(place);
        Ok(())
    }

    fn finish(mut self) -> Result<TriMesh, MeshFileError> {
        let positions = std::mem::take(&mut self.positions);
        let mut triangles = std::mem::take(&mut self.triangles);
        cut_concave(&positions, &mut triangles, |t| self.face_of_triangle[t]).map_err(
            |triangle| {
                let place = self.face_places[self.face_of_triangle[triangle]];
                MeshFileError::new(Some(place), MeshFileProblem::CrossingPolygon)
            },
        )?;
        let mesh = TriMesh::new(positions, triangles).map_err(|error| self.blame(error))?;
        EdgeTable::build(&mesh).map_err(|error| self.blame(error))?;
        Ok(mesh)
    }

    /// Says in terms of the file what is wrong with the mesh.
    fn blame(&self, error: MeshError) -> MeshFileError {
        let triangle = match error {
            MeshError::RepeatedVertex { triangle, .. }
            | MeshError::ZeroArea { triangle, .. }
            | MeshError::IndexOutOfRange { triangle, .. } => Some(triangle),
            MeshError::DuplicateTriangle { second, .. } => Some(second),
            MeshError::NonManifoldEdge { triangles, .. } => Some(triangles[2]),
            _ => None,
        };
        let face = triangle.and_then(|triangle| self.face_of_triangle.get(triangle).copied());
        let place = match (face, &error) {
            (Some(face), _) => self.face_places.get(face),
            (
                None,
                MeshError::UnreferencedVertex { vertex } | MeshError::NonFinitePosition { vertex },
            ) => self.vertex_places.get(*vertex),
            _ => None,
        };
        let first = |triangle: usize| {
            let face = self.face_of_triangle[triangle];
            (face, self.face_places[face])
        };
        let problem = match (face, error) {
            (Some(face), MeshError::DuplicateTriangle { first: other, .. }) => {
                let first = first(other);
                PlyProblem::DuplicateFace { face, first }
            }
            (Some(face), MeshError::NonManifoldEdge { ends, triangles }) => {
                let first = [first(triangles[0]), first(triangles[1])];
                PlyProblem::NonManifoldEdge { face, ends, first }
            }
            (face, error) => PlyProblem::Mesh { face, error },
        };
        MeshFileError::new(place.copied(), problem)
    }
}

/// Writes positions (m) and triangles to a file, replacing it.
///
/// Nothing is checked: during a simulation any positions may be of interest. What is not a number
/// is written as such, which [`read`] refuses.
///
/// # Errors
/// [`MeshFileError`] with the path if the file cannot be written.
pub fn write(
    path: &Path,
    positions: &[Vec3],
    triangles: &[[u32; 3]],
    encoding: Encoding,
) -> Result<(), MeshFileError> {
    std::fs::write(path, format(positions, triangles, encoding))
        .map_err(|error| MeshFileError::new(None, MeshFileProblem::Unwritable(error)).in_file(path))
}

/// The bytes of a PLY file with these positions (m, in double precision) and triangles.
///
/// As text every number has the fewest digits that give the same bits when read again.
#[must_use]
pub fn format(positions: &[Vec3], triangles: &[[u32; 3]], encoding: Encoding) -> Vec<u8> {
    format_with(positions, &[], triangles, encoding)
}

/// The same with more vectors at the vertices, in double precision: one called `force` becomes the columns `force_x`,
/// `force_y` and `force_z` behind the positions. [`parse`] skips them.
///
/// # Panics
/// If there are not as many vectors as positions.
#[must_use]
pub fn format_with(
    positions: &[Vec3],
    vectors: &[(&str, &[Vec3])],
    triangles: &[[u32; 3]],
    encoding: Encoding,
) -> Vec<u8> {
    let columns = 1 + vectors.len();
    let mut bytes = Vec::with_capacity(256 + 64 * columns * positions.len() + 24 * triangles.len());
    // Writing to a vector cannot fail.
    let _ = write!(
        bytes,
        "ply\nformat {} 1.0\ncomment positions in m\nelement vertex {}\nproperty double x\nproperty double y\n\
         property double z\n",
        encoding.name(),
        positions.len(),
    );
    for (name, values) in vectors {
        assert_eq!(values.len(), positions.len(), "one vector {name} a vertex");
        for axis in ["x", "y", "z"] {
            let _ = writeln!(bytes, "property double {name}_{axis}");
        }
    }
    let _ = write!(
        bytes,
        "element face {}\nproperty list uchar uint vertex_indices\nend_header\n",
        triangles.len()
    );
    for (v, position) in positions.iter().enumerate() {
        let others = vectors.iter().map(|(_, values)| &values[v]);
        for (column, vector) in std::iter::once(position).chain(others).enumerate() {
            match encoding {
                Encoding::Ascii => {
                    let space = if column > 0 { " " } else { "" };
                    let _ = write!(bytes, "{space}{:?} {:?} {:?}", vector.x, vector.y, vector.z);
                }
                Encoding::BinaryLittleEndian => {
                    vector.iter().for_each(|c| bytes.extend(c.to_le_bytes()));
                }
                Encoding::BinaryBigEndian => {
                    vector.iter().for_each(|c| bytes.extend(c.to_be_bytes()));
                }
            }
        }
        if encoding == Encoding::Ascii {
            bytes.push(b'\n');
        }
    }
    for t in triangles {
        match encoding {
            Encoding::Ascii => {
                let _ = writeln!(bytes, "3 {} {} {}", t[0], t[1], t[2]);
            }
            Encoding::BinaryLittleEndian => {
                bytes.push(3);
                t.iter().for_each(|v| bytes.extend(v.to_le_bytes()));
            }
            Encoding::BinaryBigEndian => {
                bytes.push(3);
                t.iter().for_each(|v| bytes.extend(v.to_be_bytes()));
            }
        }
    }
    bytes
}

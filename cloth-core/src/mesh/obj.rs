//! Wavefront OBJ, in and out, with the line of every mistake.
//!
//! What a cloth needs from an OBJ file is vertices (`v`) and faces (`f`). Other statements
//! (texture coordinates, normals, groups, materials, lines, curves, …) are skipped. A face may name
//! its corners as `v`, `v/vt`, `v//vn` or `v/vt/vn`, also with slashes that nothing follows, counted from 1 or, negative,
//! backwards from the last vertex so far. A polygon becomes a fan around its first corner, or, where that would
//! leave it, is [cut by ears](super#polygons). A backslash at the end of a line continues it.
//!
//! [`parse`] refuses what [`TriMesh::new`] and [`EdgeTable::build`] refuse, and says in which
//! line it stands: a zero-area or repeated face, a number that is not finite, a vertex without a
//! face, an edge with more than two faces.
//!
//! Limits: the unit of an OBJ file is not written anywhere; we take metres. Texture coordinates (`vt`) are not taken
//! for a rest shape: the vertices are both the rest shape and, unless the caller sets others, the start. Polygons and
//! everything skipped are lost when a file is read and written again; vertices and triangles keep their order and every
//! bit.

mod error;
mod statement;

pub use error::ObjProblem;

use super::file_error::{self, MeshFileError, MeshFileProblem, Place};
use super::polygon::{cut_concave, fan};
use super::{MeshError, TriMesh};
use crate::math::{Vec3, is_finite};
use crate::topology::EdgeTable;
use statement::{corner, position, statements};
use std::fmt::Write as _;
use std::path::Path;

/// Reads a mesh (positions in m) from a file.
///
/// Bytes that are not UTF-8 do no harm in comments and names.
///
/// # Errors
/// [`MeshFileError`] with the path if the file cannot be read or is empty, with path and line if it
/// can be read and is wrong.
pub fn read(path: &Path) -> Result<TriMesh, MeshFileError> {
    file_error::read(path, |bytes| parse(&String::from_utf8_lossy(bytes)))
}

/// Reads the vertices (m) of a file alone, whatever mesh its faces make: a state of a mesh that is known already.
///
/// # Errors
/// [`MeshFileError`] with the path if the file cannot be read, with path and line if a statement cannot be understood
/// or a coordinate is not finite.
pub fn read_vertices(path: &Path) -> Result<Vec<Vec3>, MeshFileError> {
    file_error::read(path, |bytes| {
        let source = Source::scan(&String::from_utf8_lossy(bytes))?;
        match source.positions.iter().position(|x| !is_finite(x)) {
            Some(vertex) => Err(source.lines.blame(MeshError::NonFinitePosition { vertex })),
            None => Ok(source.positions),
        }
    })
}

/// Reads a mesh (positions in m) from the text of a file.
///
/// # Errors
/// [`MeshFileError`] with the line, for the first mistake of this list of which there is one: a
/// statement that cannot be understood, then whatever [`TriMesh::new`] refuses, then an edge
/// with more than two faces.
pub fn parse(text: &str) -> Result<TriMesh, MeshFileError> {
    let source = Source::scan(text)?;
    let Source {
        positions,
        mut triangles,
        lines,
    } = source;
    cut_concave(&positions, &mut triangles, |t| lines.of_triangle[t]).map_err(|triangle| {
        let line = Place::Line(lines.of_triangle[triangle]);
        MeshFileError::new(Some(line), MeshFileProblem::CrossingPolygon)
    })?;
    let mesh = TriMesh::new(positions, triangles).map_err(|error| lines.blame(error))?;
    EdgeTable::build(&mesh).map_err(|error| lines.blame(error))?;
    Ok(mesh)
}

/// Everything a file says, not yet checked as a mesh.
#[derive(Default)]
struct Source {
    positions: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    lines: Lines,
}

/// Where each vertex and each triangle was written down (1-based line numbers).
#[derive(Default)]
struct Lines {
    of_vertex: Vec<usize>,
    of_triangle: Vec<usize>,
}

impl Source {
    fn scan(text: &str) -> Result<Self, MeshFileError> {
        let mut source = Self::default();
        let mut corners = Vec::new();
        for (line, statement) in statements(text) {
            let at = |problem| MeshFileError::new(Some(Place::Line(line)), problem);
            let mut words = statement.split_whitespace();
            match words.next() {
                Some("v") => {
                    source.positions.push(position(words).map_err(at)?);
                    source.lines.of_vertex.push(line);
                }
                Some("f") => {
                    corners.clear();
                    for word in words {
                        corners.push(
                            corner(word, source.positions.len())
                                .map_err(|problem| at(problem.into()))?,
                        );
                    }
                    source.add_fan(line, &corners).map_err(at)?;
                }
                Some(word) if !word.starts_with(|c: char| c.is_ascii_alphabetic()) => {
                    return Err(at(ObjProblem::NotAStatement(word.to_owned()).into()));
                }
                _ => {}
            }
        }
        Ok(source)
    }

    fn add_fan(&mut self, line: usize, corners: &[u32]) -> Result<(), MeshFileProblem> {
        if corners.len() < 3 {
            return Err(MeshFileProblem::TooFewCorners {
                found: corners.len(),
            });
        }
        for triangle in fan(corners) {
            self.triangles.push(triangle);
            self.lines.of_triangle.push(line);
        }
        Ok(())
    }
}

impl Lines {
    /// Says in terms of the file what is wrong with the mesh.
    fn blame(&self, error: MeshError) -> MeshFileError {
        let of_triangle = |triangle: usize| self.of_triangle.get(triangle).copied();
        let of_vertex = |vertex: usize| self.of_vertex.get(vertex).copied();
        let first_line = |triangle| of_triangle(triangle).unwrap_or(0);
        let (line, problem): (_, MeshFileProblem) = match error {
            MeshError::Empty => (None, ObjProblem::Empty.into()),
            MeshError::NonFinitePosition { vertex } => {
                (of_vertex(vertex), MeshFileProblem::NotFinite)
            }
            MeshError::RepeatedVertex { triangle, .. } => {
                (of_triangle(triangle), ObjProblem::RepeatedVertex.into())
            }
            MeshError::ZeroArea { triangle, area } => {
                (of_triangle(triangle), ObjProblem::ZeroArea { area }.into())
            }
            MeshError::DuplicateTriangle { first, second } => {
                let first_line = first_line(first);
                (
                    of_triangle(second),
                    ObjProblem::DuplicateFace { first_line }.into(),
                )
            }
            MeshError::UnreferencedVertex { vertex } => {
                (of_vertex(vertex), ObjProblem::UnreferencedVertex.into())
            }
            MeshError::NonManifoldEdge { ends, triangles } => {
                let problem = ObjProblem::NonManifoldEdge {
                    ends: ends.map(|end| end as usize + 1),
                    first_lines: [first_line(triangles[0]), first_line(triangles[1])],
                };
                (of_triangle(triangles[2]), problem.into())
            }
            // A face may come before the vertices it names, so this is known at the end only.
            MeshError::IndexOutOfRange {
                triangle,
                vertex,
                vertex_count,
            } => {
                let index = i64::from(vertex) + 1;
                let problem = ObjProblem::NoSuchVertex {
                    index,
                    vertex_count,
                };
                (of_triangle(triangle), problem.into())
            }
            other => (None, ObjProblem::Mesh(other).into()),
        };
        MeshFileError::new(line.map(Place::Line), problem)
    }
}

/// Writes positions (m) and triangles to a file, replacing it.
///
/// Nothing is checked: during a simulation any positions may be of interest. Not a number is
/// written as `NaN`, which [`read`] refuses.
///
/// # Errors
/// [`MeshFileError`] with the path if the file cannot be written.
pub fn write(path: &Path, positions: &[Vec3], triangles: &[[u32; 3]]) -> Result<(), MeshFileError> {
    std::fs::write(path, format(positions, triangles))
        .map_err(|error| MeshFileError::new(None, MeshFileProblem::Unwritable(error)).in_file(path))
}

/// The text of an OBJ file with these positions (m) and triangles.
///
/// Every number has the fewest digits that give the same bits when read again.
#[must_use]
pub fn format(positions: &[Vec3], triangles: &[[u32; 3]]) -> String {
    let mut text = String::with_capacity(64 * positions.len() + 24 * triangles.len());
    add_vectors(&mut text, "v", positions);
    for &t in triangles {
        let [a, b, c] = t.map(|vertex| u64::from(vertex) + 1);
        let _ = writeln!(text, "f {a} {b} {c}");
    }
    text
}

/// The same with a normal of each vertex (dimensionless) beside its position, so that a viewer shades the surface as
/// smooth; see [`vertex_normals`](super::vertex_normals). Reading it leaves the normals out.
///
/// # Panics
/// If there are not as many normals as positions.
#[must_use]
pub fn format_smooth(positions: &[Vec3], normals: &[Vec3], triangles: &[[u32; 3]]) -> String {
    assert_eq!(normals.len(), positions.len(), "one normal per vertex");
    let mut text = String::with_capacity(128 * positions.len() + 48 * triangles.len());
    add_vectors(&mut text, "v", positions);
    add_vectors(&mut text, "vn", normals);
    for &t in triangles {
        let [a, b, c] = t.map(|vertex| u64::from(vertex) + 1);
        let _ = writeln!(text, "f {a}//{a} {b}//{b} {c}//{c}");
    }
    text
}

/// One statement a vector.
fn add_vectors(text: &mut String, statement: &str, vectors: &[Vec3]) {
    for v in vectors {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{statement} {:?} {:?} {:?}", v.x, v.y, v.z);
    }
}

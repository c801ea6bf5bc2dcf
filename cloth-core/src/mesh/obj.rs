//! Wavefront OBJ, in and out, with the line of every mistake.
//!
//! What a cloth needs from an OBJ file is vertices (`v`) and faces (`f`). Other statements
//! (texture coordinates, normals, groups, materials, lines, curves, …) are skipped. A face may name
//! its corners as `v`, `v/vt`, `v//vn` or `v/vt/vn`, counted from 1 or, negative, backwards from
//! the last vertex so far. A polygon becomes a fan around its first corner, which is right for
//! convex polygons only. A backslash at the end of a line continues it.
//!
//! [`parse`] refuses what [`TriMesh::new`] and [`EdgeTable::build`] refuse, and says in which
//! line it stands: a zero-area or repeated face, a number that is not finite, a vertex without a
//! face, an edge with more than two faces.
//!
//! Limits: the unit of an OBJ file is not written anywhere; we take metres. Polygons and
//! everything skipped are lost when a file is read and written again; vertices and triangles
//! keep their order and every bit.

mod error;
mod statement;

pub use error::{ObjError, ObjProblem};

use super::{MeshError, TriMesh, fan};
use crate::math::Vec3;
use crate::topology::EdgeTable;
use statement::{corner, position, statements};
use std::fmt::Write as _;
use std::path::Path;

/// Reads a mesh (positions in m) from a file.
///
/// Bytes that are not UTF-8 do no harm in comments and names.
///
/// # Errors
/// [`ObjError`] with the path if the file cannot be read or is empty, with path and line if it
/// can be read and is wrong.
pub fn read(path: &Path) -> Result<TriMesh, ObjError> {
    let parsed = match std::fs::read(path) {
        Ok(bytes) => parse(&String::from_utf8_lossy(&bytes)),
        Err(error) => Err(ObjError::new(None, ObjProblem::Unreadable(error))),
    };
    parsed.map_err(|error| error.in_file(path))
}

/// Reads a mesh (positions in m) from the text of a file.
///
/// # Errors
/// [`ObjError`] with the line, for the first mistake of this list of which there is one: a
/// statement that cannot be understood, then whatever [`TriMesh::new`] refuses, then an edge
/// with more than two faces.
pub fn parse(text: &str) -> Result<TriMesh, ObjError> {
    let source = Source::scan(text)?;
    let Source {
        positions,
        triangles,
        lines,
    } = source;
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
    fn scan(text: &str) -> Result<Self, ObjError> {
        let mut source = Self::default();
        let mut corners = Vec::new();
        for (line, statement) in statements(text) {
            let at = |problem| ObjError::new(Some(line), problem);
            let mut words = statement.split_whitespace();
            match words.next() {
                Some("v") => {
                    source.positions.push(position(words).map_err(at)?);
                    source.lines.of_vertex.push(line);
                }
                Some("f") => {
                    corners.clear();
                    for word in words {
                        corners.push(corner(word, source.positions.len()).map_err(at)?);
                    }
                    source.add_fan(line, &corners).map_err(at)?;
                }
                Some(word) if !word.starts_with(|c: char| c.is_ascii_alphabetic()) => {
                    return Err(at(ObjProblem::NotAStatement(word.to_owned())));
                }
                _ => {}
            }
        }
        Ok(source)
    }

    fn add_fan(&mut self, line: usize, corners: &[u32]) -> Result<(), ObjProblem> {
        if corners.len() < 3 {
            return Err(ObjProblem::TooFewCorners {
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
    fn blame(&self, error: MeshError) -> ObjError {
        let of_triangle = |triangle: usize| self.of_triangle.get(triangle).copied();
        let of_vertex = |vertex: usize| self.of_vertex.get(vertex).copied();
        let first_line = |triangle| of_triangle(triangle).unwrap_or(0);
        let (line, problem) = match error {
            MeshError::Empty => (None, ObjProblem::Empty),
            MeshError::NonFinitePosition { vertex } => (of_vertex(vertex), ObjProblem::NotFinite),
            MeshError::RepeatedVertex { triangle, .. } => {
                (of_triangle(triangle), ObjProblem::RepeatedVertex)
            }
            MeshError::ZeroArea { triangle, area } => {
                (of_triangle(triangle), ObjProblem::ZeroArea { area })
            }
            MeshError::DuplicateTriangle { first, second } => {
                let first_line = first_line(first);
                (
                    of_triangle(second),
                    ObjProblem::DuplicateFace { first_line },
                )
            }
            MeshError::UnreferencedVertex { vertex } => {
                (of_vertex(vertex), ObjProblem::UnreferencedVertex)
            }
            MeshError::NonManifoldEdge { ends, triangles } => {
                let problem = ObjProblem::NonManifoldEdge {
                    ends: ends.map(|end| end as usize + 1),
                    first_lines: [first_line(triangles[0]), first_line(triangles[1])],
                };
                (of_triangle(triangles[2]), problem)
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
                (of_triangle(triangle), problem)
            }
            other => (None, ObjProblem::Mesh(other)),
        };
        ObjError::new(line, problem)
    }
}

/// Writes positions (m) and triangles to a file, replacing it.
///
/// Nothing is checked: during a simulation any positions may be of interest. Not a number is
/// written as `NaN`, which [`read`] refuses.
///
/// # Errors
/// [`ObjError`] with the path if the file cannot be written.
pub fn write(path: &Path, positions: &[Vec3], triangles: &[[u32; 3]]) -> Result<(), ObjError> {
    std::fs::write(path, format(positions, triangles))
        .map_err(|error| ObjError::new(None, ObjProblem::Unwritable(error)).in_file(path))
}

/// The text of an OBJ file with these positions (m) and triangles.
///
/// Every number has the fewest digits that give the same bits when read again.
#[must_use]
pub fn format(positions: &[Vec3], triangles: &[[u32; 3]]) -> String {
    let mut text = String::with_capacity(64 * positions.len() + 24 * triangles.len());
    for p in positions {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "v {:?} {:?} {:?}", p.x, p.y, p.z);
    }
    for &t in triangles {
        let [a, b, c] = t.map(|vertex| u64::from(vertex) + 1);
        let _ = writeln!(text, "f {a} {b} {c}");
    }
    text
}

//! Tetrahedra from a file of Gmsh, format 2.2 in ASCII (`gmsh -3 -format msh22`), with the line of every mistake.
//!
//! Of the file, `$Nodes` (m) and the tetrahedra among `$Elements` (type 4) are read; elements of other types, physical
//! names and all other sections are skipped, and nodes that are in no tetrahedron are left out. The others are
//! numbered from 0 in the order of the file.
//!
//! C. Geuzaine, J.-F. Remacle, "Gmsh: a 3-D finite element mesh generator", 2009, <https://doi.org/10.1002/nme.2579>;
//! the format stands in Gmsh's manual.

use super::file_error::{self, MeshFileError, MeshFileProblem, Place};
use super::{MeshError, TetMesh, used};
use crate::math::{Real, Vec3};
use std::collections::HashMap;
use std::fmt;
use std::path::Path;
use std::str::FromStr;

/// Gmsh's number of the element that has four corners.
const TETRAHEDRON: u64 = 4;

/// Reads a solid (positions in m) from a file.
///
/// # Errors
/// [`MeshFileError`] with the path if the file cannot be read, with path and line if it can be read and is wrong.
pub fn read(path: &Path) -> Result<TetMesh, MeshFileError> {
    file_error::read(path, |bytes| parse(&String::from_utf8_lossy(bytes)))
}

/// Reads a solid (positions in m) from the text of a file.
///
/// # Errors
/// [`MeshFileError`] with the line, for the first mistake.
pub fn parse(text: &str) -> Result<TetMesh, MeshFileError> {
    let mut lines = Lines {
        lines: text.lines(),
        number: 0,
    };
    let (mut nodes, mut elements) = (None, None);
    while let Some(line) = lines.next() {
        match line {
            "$MeshFormat" => lines.format()?,
            "$Nodes" if nodes.is_some() => return Err(lines.wrong(GmshProblem::Second("$Nodes"))),
            "$Elements" if elements.is_some() => {
                return Err(lines.wrong(GmshProblem::Second("$Elements")));
            }
            "$Nodes" => nodes = Some(lines.nodes()?),
            "$Elements" => {
                let known = nodes.as_ref();
                let known = known.ok_or_else(|| lines.wrong(GmshProblem::Missing("$Nodes")))?;
                elements = Some(lines.tetrahedra(known)?);
            }
            _ => {}
        }
    }
    let missing = |section| MeshFileError::new(None, GmshProblem::Missing(section));
    let nodes = nodes.ok_or_else(|| missing("$Nodes"))?;
    let (mut tetrahedra, of_tetrahedron) = elements.ok_or_else(|| missing("$Elements"))?;
    let mut places = Vec::with_capacity(nodes.positions.len());
    let mut positions = Vec::new();
    for (x, is_used) in nodes
        .positions
        .iter()
        .zip(used(&tetrahedra, nodes.positions.len()))
    {
        places.push(positions.len() as u32);
        positions.extend(is_used.then_some(*x));
    }
    for corner in tetrahedra.as_flattened_mut() {
        *corner = places[*corner as usize];
    }
    TetMesh::new(positions, tetrahedra).map_err(|error| {
        let line = match error {
            MeshError::BadTetrahedron { tetrahedron, .. } => Some(of_tetrahedron[tetrahedron]),
            _ => None,
        };
        MeshFileError::new(line.map(Place::Line), GmshProblem::Mesh(error))
    })
}

/// Positions (m), and which one each node's number in the file has.
struct Nodes {
    positions: Vec<Vec3>,
    places: HashMap<u64, u32>,
}

/// Lines without blanks around them, and the number of the last one.
struct Lines<'a> {
    lines: std::str::Lines<'a>,
    number: usize,
}

impl<'a> Lines<'a> {
    fn next(&mut self) -> Option<&'a str> {
        self.number += 1;
        self.lines.next().map(str::trim)
    }

    fn wrong(&self, problem: GmshProblem) -> MeshFileError {
        MeshFileError::new(Some(Place::Line(self.number)), problem)
    }

    /// The words of the next line.
    fn words(&mut self) -> Result<Words<'a>, MeshFileError> {
        let line = self.next();
        let line = line.ok_or_else(|| self.wrong(GmshProblem::Ends))?;
        Ok(Words {
            line: self.number,
            words: line.split_whitespace(),
        })
    }

    fn format(&mut self) -> Result<(), MeshFileError> {
        let mut words = self.words()?;
        let (version, kind): (Real, u64) = (words.number()?, words.number()?);
        if version.floor() == 2.0 && kind == 0 {
            Ok(())
        } else {
            Err(self.wrong(GmshProblem::OtherFormat))
        }
    }

    fn nodes(&mut self) -> Result<Nodes, MeshFileError> {
        let count: usize = self.words()?.number()?;
        let mut nodes = Nodes {
            positions: Vec::new(),
            places: HashMap::new(),
        };
        for _ in 0..count {
            let mut words = self.words()?;
            let node: u64 = words.number()?;
            let x = Vec3::new(words.number()?, words.number()?, words.number()?);
            if !crate::math::is_finite(&x) {
                let place = Some(Place::Line(self.number));
                return Err(MeshFileError::new(place, MeshFileProblem::NotFinite));
            }
            let place = nodes.positions.len() as u32;
            if nodes.places.insert(node, place).is_some() {
                return Err(self.wrong(GmshProblem::SecondNode(node)));
            }
            nodes.positions.push(x);
        }
        Ok(nodes)
    }

    /// The tetrahedra, and the line of each.
    fn tetrahedra(&mut self, nodes: &Nodes) -> Result<(Vec<[u32; 4]>, Vec<usize>), MeshFileError> {
        let count: usize = self.words()?.number()?;
        let (mut tetrahedra, mut lines) = (Vec::new(), Vec::new());
        for _ in 0..count {
            let mut words = self.words()?;
            let (_, kind, tags): (u64, u64, u64) =
                (words.number()?, words.number()?, words.number()?);
            if kind != TETRAHEDRON {
                continue;
            }
            for _ in 0..tags {
                words.number::<i64>()?;
            }
            let mut corners = [0; 4];
            for corner in &mut corners {
                let node: u64 = words.number()?;
                let place = nodes.places.get(&node);
                *corner = *place.ok_or_else(|| self.wrong(GmshProblem::NoSuchNode(node)))?;
            }
            tetrahedra.push(corners);
            lines.push(self.number);
        }
        Ok((tetrahedra, lines))
    }
}

/// What is left of a line.
struct Words<'a> {
    line: usize,
    words: std::str::SplitWhitespace<'a>,
}

impl Words<'_> {
    fn number<T: FromStr>(&mut self) -> Result<T, MeshFileError> {
        let word = self.words.next();
        word.and_then(|word| word.parse().ok()).ok_or_else(|| {
            let problem = GmshProblem::NotANumber(word.unwrap_or("the end of the line").to_owned());
            MeshFileError::new(Some(Place::Line(self.line)), problem)
        })
    }
}

/// What is wrong with a file of Gmsh.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum GmshProblem {
    /// It is of another version, or binary.
    OtherFormat,
    /// A section is missing.
    Missing(&'static str),
    /// There is a second section of the name.
    Second(&'static str),
    /// The file ends within a section.
    Ends,
    /// Where a number should be, something else is.
    NotANumber(String),
    /// A node has the number of another one.
    SecondNode(u64),
    /// There is no node of this number.
    NoSuchNode(u64),
    /// The tetrahedra do not make a solid.
    Mesh(MeshError),
}

impl fmt::Display for GmshProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OtherFormat => {
                write!(
                    f,
                    "only version 2.2 in ASCII is read: gmsh -3 -format msh22"
                )
            }
            Self::Missing(section) => write!(f, "there is no section {section} before here"),
            Self::Second(section) => write!(f, "there is a section {section} before this one"),
            Self::Ends => write!(f, "the file ends within a section"),
            Self::NotANumber(found) => write!(f, "a number should be here, and not {found}"),
            Self::SecondNode(node) => write!(f, "there is a node {node} already"),
            Self::NoSuchNode(node) => write!(f, "there is no node {node}"),
            Self::Mesh(error) => error.fmt(f),
        }
    }
}

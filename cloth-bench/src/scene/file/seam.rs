//! `[[seam]]`: two chains of border vertices that are drawn together.

use super::document::Section;
use super::keys::Seam;
use super::material::Material;
use crate::error::BenchError;
use crate::scene::{Change, ChangeKind, Scene};
use crate::settings::Setting;
use cloth_core::energy::Stitch;
use cloth_core::math::Real;
use cloth_core::mesh::TriMesh;
use cloth_core::method::ordering::Order;
use cloth_core::topology::{EdgeTable, boundary_loops};
use std::ops::Range;

/// Vertices farther apart than this part of the size of the cloth do not lie on each other.
const APART: Real = 1e-9;

/// The border of the joined mesh, in the caller's numbers.
pub(super) struct Borders<'a> {
    mesh: &'a TriMesh,
    edges: EdgeTable,
    loops: Vec<Vec<u32>>,
    /// The vertices of each piece.
    pieces: Vec<Range<usize>>,
}

impl<'a> Borders<'a> {
    /// `counts` are the numbers of vertices of the pieces; nothing is looked for where there is no seam.
    pub(super) fn new(
        seams: &[Section<'_>],
        mesh: &'a TriMesh,
        counts: &[usize],
    ) -> Result<Option<Self>, BenchError> {
        let Some(first) = seams.first() else {
            return Ok(None);
        };
        let edges = EdgeTable::build(mesh).map_err(|error| first.refuse_table(error))?;
        let mut start = 0;
        let piece = |&count: &usize| {
            start += count;
            start - count..start
        };
        Ok(Some(Self {
            mesh,
            loops: boundary_loops(mesh, &edges),
            edges,
            pieces: counts.iter().map(piece).collect(),
        }))
    }

    /// The pairs of vertices that a table sews together.
    pub(super) fn pairs(&self, section: &Section<'_>) -> Result<Vec<[u32; 2]>, BenchError> {
        let own = section.read::<Seam>()?;
        let meshes = own.meshes.as_deref();
        let &[first, second] = meshes.ok_or_else(|| section.refuse_table("needs meshes"))? else {
            let message = "meshes has to be two numbers such as [0, 1]";
            return Err(own.meshes.refuse(message));
        };
        let first = self.chain(&own, first, [&own.first, &own.first_border])?;
        let (keys, first_count) = ([&own.second, &own.second_border], first.len());
        let second = self.chain(&own, second, keys)?;
        let key = given(keys);
        if second.len() != first_count {
            let message = format!(
                "the first chain has {first_count} vertices and the second {}, but a seam needs as many in both",
                second.len()
            );
            return Err(key.refuse(message));
        }
        let pairs: Vec<[u32; 2]> = first
            .into_iter()
            .zip(second)
            .map(<[u32; 2]>::from)
            .collect();
        let firsts = || pairs.iter().map(|pair| pair[0]);
        for &[a, b] in &pairs {
            if firsts().any(|first| first == b) {
                let message = format!("vertex {} is in both chains", self.own(b));
                return Err(key.refuse(message));
            }
            if self.edges.find(a, b).is_some() {
                let [a, b] = [a, b].map(|v| self.own(v));
                let message =
                    format!("vertices {a} and {b} are the ends of one edge, which would vanish");
                return Err(key.refuse(message));
            }
        }
        Ok(pairs)
    }

    /// The number of a vertex in its own piece.
    fn own(&self, vertex: u32) -> usize {
        let vertex = vertex as usize;
        let piece = self.pieces.iter().find(|piece| piece.contains(&vertex));
        vertex - piece.map_or(0, |piece| piece.start)
    }

    /// The vertices of one side, in the numbers of the joined mesh.
    fn chain(&self, own: &Seam, mesh: u32, keys: [&Numbers; 2]) -> Result<Vec<u32>, BenchError> {
        let Some(piece) = self.pieces.get(mesh as usize) else {
            let message = format!(
                "there is no mesh {mesh}, only 0 to {}",
                self.pieces.len() - 1
            );
            return Err(own.meshes.refuse(message));
        };
        let [list, border] = keys;
        let key = given(keys);
        let numbers = match (&**list, &**border) {
            (Some(numbers), None) | (None, Some(numbers)) => numbers,
            _ => {
                let message = format!(
                    "needs one of the keys {} and {}",
                    list.name(),
                    border.name()
                );
                return Err(key.refuse(message));
            }
        };
        let mut chain = Vec::with_capacity(numbers.len());
        for &number in numbers {
            if number as usize >= piece.len() {
                let message = format!(
                    "mesh {mesh} has no vertex {number}, only {}, counted from 0",
                    piece.len()
                );
                return Err(key.refuse(message));
            }
            let vertex = (piece.start + number as usize) as u32;
            if !self.loops.iter().any(|border| border.contains(&vertex)) {
                let message = format!("vertex {number} of mesh {mesh} is not on its border");
                return Err(key.refuse(message));
            }
            if chain.contains(&vertex) {
                let message = format!("vertex {number} is there twice");
                return Err(key.refuse(message));
            }
            chain.push(vertex);
        }
        if key.name() == border.name() {
            let between = self.between(&chain);
            return between.map_err(|message| key.refuse(message));
        }
        if chain.is_empty() {
            return Err(key.refuse("there is no vertex in it"));
        }
        Ok(chain)
    }

    /// The vertices along the border between two ends, with them, the shorter way or past a vertex in between.
    fn between(&self, named: &[u32]) -> Result<Vec<u32>, String> {
        let (from, past, to) = match *named {
            [from, to] => (from, None, to),
            [from, past, to] => (from, Some(past), to),
            _ => return Err("it has to be two ends, or two ends and a vertex in between".into()),
        };
        let [a, b] = [from, to].map(|v| self.own(v));
        let joins = |border: &&Vec<u32>| named.iter().all(|vertex| border.contains(vertex));
        let border = self.loops.iter().find(joins);
        let border = border.ok_or_else(|| format!("vertices {a} and {b} are on two borders"))?;
        let mut ways = [border.clone(), border.iter().rev().copied().collect()];
        for way in &mut ways {
            let start = way.iter().position(|&v| v == from).unwrap_or(0);
            way.rotate_left(start);
            let end = way.iter().position(|&v| v == to).unwrap_or(0);
            way.truncate(end + 1);
        }
        if let Some(past) = past {
            let way = ways.into_iter().find(|way| way.contains(&past));
            return way.ok_or_else(|| "no way along the border passes all three".into());
        }
        let x = |v: u32| self.mesh.positions()[v as usize];
        let length = |way: &Vec<u32>| -> Real {
            way.windows(2)
                .map(|ends| (x(ends[0]) - x(ends[1])).norm())
                .sum()
        };
        let [one, other] = [length(&ways[0]), length(&ways[1])];
        if (one - other).abs() <= APART * (one + other) {
            return Err(format!(
                "both ways along the border from vertex {a} to {b} are equally long: name a vertex in between"
            ));
        }
        let [forward, backward] = ways;
        Ok(if one < other { forward } else { backward })
    }
}

/// Numbers of vertices, if they are given.
type Numbers = Setting<Option<Vec<u32>>>;

/// The key of two that is given.
fn given([list, border]: [&Numbers; 2]) -> &Numbers {
    if list.is_given() { list } else { border }
}

/// Refuses a pair of vertices that is sewn together twice.
pub(super) fn refuse_repeated(
    sections: &[Section<'_>],
    seams: &[Vec<[u32; 2]>],
) -> Result<(), BenchError> {
    let sorted = |&[a, b]: &[u32; 2]| [a.min(b), a.max(b)];
    let mut all: Vec<[u32; 2]> = Vec::new();
    for (section, pairs) in sections.iter().zip(seams) {
        if pairs.iter().any(|pair| all.contains(&sorted(pair))) {
            let message = "two of its vertices are sewn together by another [[seam]] too";
            return Err(section.refuse_table(message));
        }
        all.extend(pairs.iter().map(sorted));
    }
    Ok(())
}

/// Sews a scene as a table says, now or later; `pairs` are in the caller's numbers.
pub(super) fn apply(
    section: &Section<'_>,
    mut pairs: Vec<[u32; 2]>,
    material: &Material,
    order: Option<&Order>,
    scene: &mut Scene,
) -> Result<(), BenchError> {
    if let Some(order) = order {
        let vertices = pairs.iter_mut().flatten();
        vertices.for_each(|v| *v = order.new_of_old()[*v as usize]);
    }
    let own = section.read::<Seam>()?;
    let (from, until) = (*own.from, *own.until);
    if until.is_some_and(|until| until <= from) {
        let message = format!("until has to be later than from, which is {from} s");
        return Err(own.until.refuse(message));
    }
    let mut stiffness = Vec::with_capacity(pairs.len());
    for pair in &pairs {
        let of_cloth = || -> Result<Real, BenchError> {
            let [a, b] = pair.map(|vertex| material.stiffness(vertex as usize));
            let softer = a?.min(b?);
            if softer > 0.0 {
                return Ok(softer);
            }
            let message = "needs a stiffness, since that of the cloth is 0 or infinite";
            Err(section.refuse_table(message))
        };
        stiffness.push(own.stiffness.map_or_else(of_cloth, Ok)?);
    }
    if from > 0.0 {
        let Some(until) = until else {
            return Err(own.from.refuse("from needs until"));
        };
        let kind = ChangeKind::Sew {
            pairs,
            stiffness,
            until,
        };
        scene.changes.push(Change { time: from, kind });
        return Ok(());
    }
    let x = &scene.start.positions;
    let size = x.iter().map(|x| x.amax()).fold(0.0, Real::max);
    let mut stitches = Vec::with_capacity(pairs.len());
    for (pair, k) in pairs.into_iter().zip(stiffness) {
        let [a, b] = pair.map(|vertex| x[vertex as usize]);
        let distance = (a - b).norm();
        stitches.push(match until {
            Some(until) => Stitch::closing(pair, k, distance, [from, until]),
            None if distance <= APART * size => Stitch::closed(pair, k),
            None => {
                let message = format!("needs until, since its chains are {distance:.3} m apart");
                return Err(section.refuse_table(message));
            }
        });
    }
    scene.model.sew(stitches);
    Ok(())
}

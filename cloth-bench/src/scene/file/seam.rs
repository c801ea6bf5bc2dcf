//! `[[seam]]`: two chains of border vertices that are drawn together.

mod chain;

use super::document::Section;
use super::keys::Seam;
use super::material::Material;
use crate::error::BenchError;
use crate::names;
use crate::scene::{Change, ChangeKind, Scene};
use crate::settings::Setting;
use chain::Chain;
pub(super) use chain::Ends;
use cloth_core::energy::{Seam as Stitches, Stitch};
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

    /// What a table sews together.
    pub(super) fn ends(&self, section: &Section<'_>) -> Result<Ends, BenchError> {
        let own = section.read::<Seam>()?;
        let meshes = own.meshes.as_deref();
        let &[first, second] = meshes.ok_or_else(|| section.refuse_table("needs meshes"))? else {
            let message = "meshes has to be two numbers such as [0, 1]";
            return Err(own.meshes.refuse(message));
        };
        let first = self.chain(&own, first, [&own.first, &own.first_border])?;
        let keys = [&own.second, &own.second_border];
        let second = self.chain(&own, second, keys)?;
        let key = given(keys);
        let refuse = |message: String| key.refuse(message);
        if first.is_closed() != second.is_closed() {
            return Err(refuse(
                "one of the chains goes all the way round a border, and the other does not".into(),
            ));
        }
        if let Some(both) = second.vertices.iter().find(|v| first.vertices.contains(v)) {
            return Err(refuse(format!(
                "vertex {} is in both chains",
                self.own(*both)
            )));
        }
        let ends = first.sewn_to(&second).map_err(refuse)?;
        let is_edge = |a: u32, b: u32| self.edges.find(a, b).is_some();
        if let Some(&[a, b]) = ends.pairs.iter().find(|[a, b]| is_edge(*a, *b)) {
            let [a, b] = [a, b].map(|v| self.own(v));
            return Err(refuse(format!(
                "vertices {a} and {b} are the ends of one edge, which would vanish"
            )));
        }
        let flat = |([v, a, b], _): &&([u32; 3], Real)| is_edge(*v, *a) && is_edge(*v, *b);
        if let Some((corners, _)) = ends.onto_edges.iter().find(flat) {
            let [v, a, b] = corners.map(|v| self.own(v));
            return Err(refuse(format!(
                "vertex {v} would be on the edge from {a} to {b}, and their triangle would vanish"
            )));
        }
        Ok(ends)
    }

    /// The number of a vertex in its own piece.
    fn own(&self, vertex: u32) -> usize {
        let vertex = vertex as usize;
        let piece = self.pieces.iter().find(|piece| piece.contains(&vertex));
        vertex - piece.map_or(0, |piece| piece.start)
    }

    /// The vertices of one side, in the numbers of the joined mesh.
    fn chain(&self, own: &Seam, mesh: u32, keys: [&Numbers; 2]) -> Result<Chain, BenchError> {
        let Some(piece) = self.pieces.get(mesh as usize) else {
            let message = names::beyond("mesh", mesh, self.pieces.len());
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
                    "mesh {mesh} has no vertex {number}, only 0 to {}",
                    piece.len() - 1
                );
                return Err(key.refuse(message));
            }
            let vertex = (piece.start + number as usize) as u32;
            if !self.loops.iter().any(|border| border.contains(&vertex)) {
                let message = format!("vertex {number} of mesh {mesh} is not on its border");
                return Err(key.refuse(message));
            }
            // The last one may be the first again.
            let goes_round = chain.len() > 1 && chain.len() + 1 == numbers.len();
            let seen = &chain[usize::from(goes_round)..];
            if seen.contains(&vertex) {
                let message = format!("vertex {number} is there twice");
                return Err(key.refuse(message));
            }
            chain.push(vertex);
        }
        if key.name() == border.name() {
            chain = self
                .between(&chain)
                .map_err(|message| key.refuse(message))?;
        }
        if chain.is_empty() {
            return Err(key.refuse("there is no vertex in it"));
        }
        Ok(self.measured(chain))
    }

    /// A chain with what is known of its edges.
    fn measured(&self, vertices: Vec<u32>) -> Chain {
        let x = |v: u32| self.mesh.positions()[v as usize];
        let mut along = vec![0.0];
        let mut gap = None;
        for ends in vertices.windows(2) {
            let [a, b] = [ends[0], ends[1]];
            along.push(along[along.len() - 1] + (x(a) - x(b)).norm());
            if self.edges.find(a, b).is_none() {
                gap = gap.or(Some([a, b].map(|v| self.own(v))));
            }
        }
        Chain {
            vertices,
            along,
            gap,
        }
    }

    /// The vertices along the border between two ends, with them, the shorter way or past a vertex in between.
    fn between(&self, named: &[u32]) -> Result<Vec<u32>, String> {
        if let [from, past, to] = *named
            && from == to
        {
            return self.round(from, past);
        }
        let (from, past, to) = match *named {
            [from, to] => (from, None, to),
            [from, past, to] => (from, Some(past), to),
            _ => return Err("it has to be two ends, or two ends and a vertex in between".into()),
        };
        let [a, b] = [from, to].map(|v| self.own(v));
        let mut ways = self.ways(named, [from, to])?;
        if let Some(past) = past {
            let way = ways.into_iter().find(|way| way.contains(&past));
            return way.ok_or_else(|| "no way along the border passes all three".into());
        }
        let [one, other] = [0, 1].map(|way| self.length(&ways[way]));
        if (one - other).abs() <= APART * (one + other) {
            return Err(format!(
                "both ways along the border from vertex {a} to {b} are equally long: name a vertex in between"
            ));
        }
        Ok(std::mem::take(&mut ways[usize::from(other < one)]))
    }

    /// The vertices all the way round a border, from one back to it, the shorter way to `past` first.
    fn round(&self, from: u32, past: u32) -> Result<Vec<u32>, String> {
        let mut way = self.between(&[from, past])?;
        let [forward, backward] = self.ways(&[from, past], [past, from])?;
        let before_past = way[way.len() - 2];
        let back = if forward[1] == before_past {
            backward
        } else {
            forward
        };
        way.extend(&back[1..]);
        Ok(way)
    }

    /// Both ways along the border on which all `named` vertices are, from one end to the other.
    fn ways(&self, named: &[u32], [from, to]: [u32; 2]) -> Result<[Vec<u32>; 2], String> {
        let joins = |border: &&Vec<u32>| named.iter().all(|vertex| border.contains(vertex));
        let border = self.loops.iter().find(joins).ok_or_else(|| {
            let [a, b] = [from, to].map(|v| self.own(v));
            format!("vertices {a} and {b} are on two borders")
        })?;
        let mut ways = [border.clone(), border.iter().rev().copied().collect()];
        for way in &mut ways {
            let start = way.iter().position(|&v| v == from).unwrap_or(0);
            way.rotate_left(start);
            let end = way.iter().position(|&v| v == to).unwrap_or(0);
            way.truncate(end + 1);
        }
        Ok(ways)
    }

    fn length(&self, way: &[u32]) -> Real {
        let x = |v: u32| self.mesh.positions()[v as usize];
        let edges = way.windows(2);
        edges.map(|ends| (x(ends[0]) - x(ends[1])).norm()).sum()
    }
}

/// Numbers of vertices, if they are given.
type Numbers = Setting<Option<Vec<u32>>>;

/// The key of two that is given.
fn given([list, border]: [&Numbers; 2]) -> &Numbers {
    if list.is_given() { list } else { border }
}

/// Leaves a pair of vertices that two tables sew together, such as the corner of a pillow, to the first of them.
/// Refuses a table with no pair of its own.
pub(super) fn sew_once(sections: &[Section<'_>], seams: &mut [Ends]) -> Result<(), BenchError> {
    let sorted = |&[a, b]: &[u32; 2]| [a.min(b), a.max(b)];
    let mut all: Vec<[u32; 2]> = Vec::new();
    for (section, ends) in sections.iter().zip(seams) {
        ends.pairs.retain(|pair| !all.contains(&sorted(pair)));
        if ends.pairs.is_empty() && ends.onto_edges.is_empty() {
            let message = "all of its vertices are sewn together by another [[seam]] already";
            return Err(section.refuse_table(message));
        }
        all.extend(ends.pairs.iter().map(sorted));
    }
    Ok(())
}

impl Ends {
    /// Its closed stitches, whose stiffness (N/m) is that of the cloth unless it is given.
    fn stitches(
        &self,
        section: &Section<'_>,
        material: &Material,
        stiffness: Option<Real>,
    ) -> Result<Stitches, BenchError> {
        let of_cloth = |vertices: &[u32]| {
            let mut softest = Real::INFINITY;
            for &vertex in vertices {
                softest = softest.min(material.stiffness(vertex as usize)?);
            }
            if softest > 0.0 {
                return Ok(softest);
            }
            let message = "needs a stiffness, since that of the cloth is 0 or infinite";
            Err(section.refuse_table(message))
        };
        let of = |vertices: &[u32]| stiffness.map_or_else(|| of_cloth(vertices), Ok);
        let pairs = self.pairs.iter();
        let onto_edges = self.onto_edges.iter();
        let onto = |(corners, fraction): &([u32; 3], Real)| {
            Ok(Stitch::onto_edge(*corners, *fraction, of(corners)?))
        };
        Ok(Stitches {
            pairs: pairs
                .map(|pair| Ok(Stitch::pair(*pair, of(pair)?)))
                .collect::<Result<_, BenchError>>()?,
            onto_edges: onto_edges.map(onto).collect::<Result<_, BenchError>>()?,
        })
    }
}

/// Sews a scene as a table says, now or later; its `ends` are in the caller's numbers.
pub(super) fn apply(
    section: &Section<'_>,
    mut ends: Ends,
    material: &Material,
    order: Option<&Order>,
    scene: &mut Scene,
) -> Result<(), BenchError> {
    if let Some(order) = order {
        ends.reorder(order);
    }
    let own = section.read::<Seam>()?;
    let (from, until) = (*own.from, *own.until);
    if until.is_some_and(|until| until <= from) {
        let message = format!("until has to be later than from, which is {from} s");
        return Err(own.until.refuse(message));
    }
    let seam = ends.stitches(section, material, *own.stiffness)?;
    if from > 0.0 {
        let Some(until) = until else {
            return Err(own.from.refuse("from needs until"));
        };
        let kind = ChangeKind::Sew { seam, until };
        scene.changes.push(Change { time: from, kind });
        return Ok(());
    }
    let x = &scene.start.positions;
    let size = x.iter().map(|x| x.amax()).fold(0.0, Real::max);
    let widest = seam.gaps(x).map(|gap| gap.norm()).fold(0.0, Real::max);
    scene.model.sew(match until {
        Some(until) => seam.closing(x, [from, until]),
        None if widest <= APART * size => seam,
        None => {
            let message = format!("needs until, since its chains are {widest:.3} m apart");
            return Err(section.refuse_table(message));
        }
    });
    Ok(())
}

//! `[cloth]`, `[mesh.cloth]` and `[mesh.solid]`: what the pieces are made of.

use super::document::Section;
use crate::error::BenchError;
use crate::scene::cloth;
use crate::settings::Settings;
use cloth_core::cloth::{ClothModel, Membrane, Piece, SolidPiece};
use cloth_core::math::Real;
use cloth_core::mesh::TriMesh;
use cloth_core::method::ordering::Order;

/// Keys of which one can be given: that of a piece takes the place of either in `[cloth]`.
const ALTERNATIVES: [[&str; 2]; 2] = [["modulus", "stiffness"], ["slack", "compression"]];

/// The material of each vertex; pieces share none.
pub(super) struct Material {
    /// Of every piece that has one of its own, after that of all others.
    settings: Vec<Settings>,
    /// What stands in the tables of these pieces alone.
    own: Vec<Settings>,
    /// Which of them each vertex has, but for those of solids.
    of_vertex: Vec<Option<usize>>,
    solids: Vec<SolidPiece>,
}

impl Material {
    /// `common` is that of `[cloth]`, overruled; `own` are the tables of the pieces, and `counts` the numbers of their
    /// vertices.
    pub(super) fn new(
        common: &Settings,
        own: &[Option<Section<'_>>],
        solids: Vec<Option<SolidPiece>>,
        counts: &[usize],
    ) -> Result<Self, BenchError> {
        let mut settings = vec![common.clone()];
        let mut of_vertex = Vec::new();
        for ((section, solid), count) in own.iter().zip(&solids).zip(counts) {
            let mut place = solid.is_none().then_some(0);
            if let Some(section) = section {
                if solid.is_some() {
                    return Err(section.refuse_table("has no meaning for a solid"));
                }
                place = Some(settings.len());
                let own = section.settings(Settings::default());
                let mut inherited = common.clone();
                for pair in ALTERNATIVES {
                    if pair.iter().any(|key| own.get(key).is_some()) {
                        inherited = inherited.without(&pair);
                    }
                }
                settings.push(section.settings(inherited));
            }
            of_vertex.extend(std::iter::repeat_n(place, *count));
        }
        let own = own.iter().flatten();
        Ok(Self {
            solids: solids.into_iter().flatten().collect(),
            settings,
            own: own
                .map(|section| section.settings(Settings::default()))
                .collect(),
            of_vertex,
        })
    }

    /// Whether a vertex is of a solid.
    pub(super) fn is_solid(&self, vertex: u32) -> bool {
        self.of_vertex[vertex as usize].is_none()
    }

    /// The same for vertices in another order.
    pub(super) fn reorder(&mut self, order: &Order) {
        let old = order.old_of_new().iter();
        self.of_vertex = old.map(|&old| self.of_vertex[old as usize]).collect();
        for solid in &mut self.solids {
            for corners in &mut solid.tetrahedra {
                *corners = order.renumber(*corners);
            }
        }
    }

    /// The stiffness k of springs (N/m) at a vertex, or the membrane modulus (N/m) if that is given in its place; 0 for
    /// hard constraints and solids, which have none.
    pub(super) fn stiffness(&self, vertex: usize) -> Result<Real, BenchError> {
        let Some(place) = self.of_vertex[vertex] else {
            return Ok(0.0);
        };
        let settings = &self.settings[place];
        if cloth::is_hard(settings)? {
            return Ok(0.0);
        }
        Ok(match cloth::described(settings)?.membrane {
            Membrane::SpringStiffness(value) | Membrane::Modulus(value) => value,
        })
    }

    /// What is seldom meant of these materials on a mesh, a sentence each.
    pub(super) fn hints(&self, mesh: &TriMesh) -> Result<Vec<String>, BenchError> {
        let pieces = self.pieces(mesh, |_| true)?;
        Ok(pieces
            .iter()
            .flat_map(|piece| cloth::hints(piece, mesh))
            .collect())
    }

    /// The triangles of a mesh that are wanted, by their numbers, for each material that has some.
    fn pieces(
        &self,
        mesh: &TriMesh,
        is_wanted: impl Fn(usize) -> bool,
    ) -> Result<Vec<Piece>, BenchError> {
        let mut pieces = Vec::new();
        for (place, settings) in self.settings.iter().enumerate() {
            let numbered = (0u32..).zip(mesh.triangles());
            let own = numbered.filter(|(triangle, corners)| {
                self.of_vertex[corners[0] as usize] == Some(place) && is_wanted(*triangle as usize)
            });
            let triangles: Vec<u32> = own.map(|(triangle, _)| triangle).collect();
            if !triangles.is_empty() {
                pieces.push(Piece {
                    cloth: cloth::described(settings)?,
                    discretization: cloth::discretization(settings)?,
                    triangles,
                });
            }
        }
        Ok(pieces)
    }

    /// The cloth cut to the triangles of a mesh that are wanted, by their numbers.
    pub(super) fn cut(
        &self,
        mesh: &TriMesh,
        is_wanted: impl Fn(usize) -> bool,
    ) -> Result<ClothModel, BenchError> {
        let pieces = self.pieces(mesh, is_wanted)?;
        let mut model = ClothModel::of_pieces(mesh, &pieces, &self.solids)
            .map_err(|error| self.settings[0].blame(&self.own, error))?;
        let is_hard = self.settings.iter().map(cloth::is_hard);
        let is_hard: Vec<bool> = is_hard.collect::<Result<_, _>>()?;
        cloth::harden(&mut model, |vertex| {
            self.of_vertex[vertex].is_some_and(|place| is_hard[place])
        });
        Ok(model)
    }
}

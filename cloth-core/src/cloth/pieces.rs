//! A cloth of several materials on one mesh.

use super::{
    Cloth, ClothError, ClothModel, DirectionalModulus, Discretization, Elements, Membrane,
    MembraneElements, SolidPiece,
};
use crate::math::Real;
use crate::mesh::TriMesh;
use crate::particles::Particles;
use crate::topology::EdgeTable;

/// Some triangles of a mesh, and what they are made of.
#[derive(Clone, Debug, PartialEq)]
pub struct Piece {
    /// The material.
    pub cloth: Cloth,
    /// Which elements it is discretized with.
    pub discretization: Discretization,
    /// Numbers of its triangles.
    pub triangles: Vec<u32>,
}

impl Piece {
    /// Young's modulus of its springs along the softest and along the stiffest edge; none unless springs carry a
    /// [`Membrane::Modulus`].
    ///
    /// # Errors
    /// [`ClothError::NoSuchTriangle`], [`ClothError::Mesh`].
    pub fn directional_moduli(
        &self,
        mesh: &TriMesh,
    ) -> Result<Option<[DirectionalModulus; 2]>, ClothError> {
        let has_modulus = matches!(self.cloth.membrane, Membrane::Modulus(_));
        if !has_modulus || self.discretization.membrane != MembraneElements::Springs {
            return Ok(None);
        }
        let corners = |&triangle: &u32| {
            let corners = mesh.triangles().get(triangle as usize);
            corners.copied().ok_or(ClothError::NoSuchTriangle(triangle))
        };
        let triangles = self.triangles.iter().map(corners);
        let part = mesh.part(triangles.collect::<Result<_, _>>()?);
        let edges = EdgeTable::build(&part)?;
        Ok(DirectionalModulus::extremes(&part, &edges))
    }
}

impl ClothModel {
    /// Masses and elements of pieces of one mesh, each by [`Cloth::discretized_with`] on its own triangles: no
    /// hinge goes across the border of two pieces, and pieces that share an edge both have a spring on it, as two
    /// cloths would that are sewn together there. Triangles in no piece get no elements. Solids on vertices of the mesh
    /// come on top.
    ///
    /// # Errors
    /// [`ClothError`] for a number out of range, a triangle that does not exist or is in two pieces, a vertex in no
    /// piece (its mass would be zero), or a coarse level for a piece that is not the whole mesh.
    ///
    /// # Panics
    /// If a tetrahedron names a vertex that the mesh does not have.
    pub fn of_pieces(
        mesh: &TriMesh,
        pieces: &[Piece],
        solids: &[SolidPiece],
    ) -> Result<Self, ClothError> {
        let mut mass = vec![0.0; mesh.vertex_count()];
        let areas: Vec<Real> = mesh.areas().collect();
        let mut is_taken = vec![false; areas.len()];
        let (mut springs, mut hinges, mut others) = (Vec::new(), Vec::new(), Vec::new());
        for piece in pieces {
            let density = piece.cloth.areal_density;
            Particles::check_density(density)?;
            let mut triangles = Vec::with_capacity(piece.triangles.len());
            for &triangle in &piece.triangles {
                let place = triangle as usize;
                match is_taken.get(place) {
                    None => return Err(ClothError::NoSuchTriangle(triangle)),
                    Some(true) => return Err(ClothError::InTwoPieces(triangle)),
                    Some(false) => is_taken[place] = true,
                }
                let corners = mesh.triangles()[place];
                for vertex in corners {
                    mass[vertex as usize] += density * areas[place] / 3.0;
                }
                triangles.push(corners);
            }
            if triangles.is_empty() {
                continue;
            }
            if piece.discretization.coarse_membrane.is_some() && triangles.len() < areas.len() {
                return Err(ClothError::CoarseMembraneOfPiece);
            }
            let part = mesh.part(triangles);
            let edges = EdgeTable::build(&part)?;
            let elements = piece.discretization.elements(&piece.cloth, &part, &edges)?;
            springs.extend(elements.springs);
            hinges.extend(elements.hinges);
            for family in elements.others {
                Elements::merge(&mut others, family);
            }
        }
        for piece in solids {
            for family in piece.cut(mesh.positions(), &mut mass)? {
                if !family.is_empty() {
                    Elements::merge(&mut others, family);
                }
            }
        }
        Ok(Self {
            particles: Particles::new(mass)?.resting_at(mesh.positions()),
            springs,
            hinges,
            others,
        })
    }
}

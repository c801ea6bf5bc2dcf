//! Which elements a cloth is discretized with, and how each kind gets its constants from the one description.

use super::{Cloth, ClothError, CoarseMembrane, Elements, Membrane, SpringEdges, SpringLaw};
use crate::energy::{
    ArapTriangle, CubicShell, CurvatureHinge, CurvedHinge, DihedralHinge, Spring,
    StrainLimitTriangle, StvkTriangle,
};
use crate::error::not_negative;
use crate::math::{Real, gather};
use crate::mesh::TriMesh;
use crate::topology::{EdgeTable, HingeTable};

/// Which elements a cloth is discretized with. The default, springs on the edges and quadratic hinges, is what
/// [`Cloth::on`] takes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Discretization {
    /// What resists stretching.
    pub membrane: MembraneElements,
    /// Stiffness (N/m) of shear springs along both diagonals of every rectangle that two triangles form: one lies on an
    /// edge and takes this stiffness instead of the membrane's, the other is added. With axial springs of stiffness k
    /// on a square grid the sheet is isotropic if this is k/2, and has then the modulus `Y = 4k/3` and ν = 1/3, but for
    /// the boundary ([`Membrane::SpringStiffness`]). None: no second diagonal. Springs of a given stiffness only.
    pub shear: Option<Real>,
    /// What resists bending.
    pub bending: BendingElements,
    /// How springs on edges answer; springs only, and none beside shear springs. A dead zone is for ARAP triangles too:
    /// of their principal stretches.
    pub law: SpringLaw,
    /// Which edges carry springs; springs only, and all of them beside shear springs.
    pub edges: SpringEdges,
    /// Links of a coarser level that keep the cloth from stretching instead of the edges, beside linear springs on all
    /// edges. None: the edges do.
    pub coarse_membrane: Option<CoarseMembrane>,
}

/// What resists stretching.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum MembraneElements {
    /// A spring on every edge.
    #[default]
    Springs,
    /// St. Venant–Kirchhoff triangles with the modulus of the cloth; of a cloth that states a spring stiffness k, with
    /// the modulus that those springs have in the mean over all directions, `Y = k Σ n L²/(3A)` as in
    /// [`Membrane::Modulus`], with half of k on the boundary.
    Stvk {
        /// Poisson's ratio ν in (−1, 1) (dimensionless); 1/3 is that of springs.
        poisson_ratio: Real,
    },
    /// As-rigid-as-possible triangles with the same modulus and ν = 0.
    Arap,
}

/// What resists bending. Each kind gets its constant from the rigidity D of the cloth; a cloth with D =
/// 0 gets none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum BendingElements {
    /// [`CurvatureHinge`]: flat at rest.
    #[default]
    Quadratic,
    /// [`DihedralHinge`]: the mesh is the rest shape.
    Dihedral,
    /// [`DihedralHinge`] by [`HingeLaw::HalfSine`](crate::energy::HingeLaw::HalfSine): the mesh is the rest shape.
    Bridson,
    /// [`CubicShell`]: the mesh is the rest shape.
    Cubic,
    /// [`CurvedHinge`]: the mesh is the rest shape.
    Curved,
    /// Springs of this stiffness (N/m) between the wing tips of every hinge, [`Spring::across`]. They have no rigidity:
    /// D is not used.
    Springs(Real),
    /// Nothing; D is not used.
    None,
}

/// Springs on the edges, quadratic hinges, and everything else.
#[derive(Default)]
pub(super) struct MeshElements {
    pub(super) springs: Vec<Spring>,
    pub(super) hinges: Vec<CurvatureHinge>,
    pub(super) others: Vec<Elements>,
}

impl Discretization {
    /// The elements of a cloth on a mesh.
    pub(super) fn elements(
        &self,
        cloth: &Cloth,
        mesh: &TriMesh,
        edges: &EdgeTable,
    ) -> Result<MeshElements, ClothError> {
        cloth.membrane.check()?;
        not_negative("bending rigidity (N·m)", cloth.bending_rigidity)?;
        let mut elements = MeshElements::default();
        self.add_membrane(cloth.membrane, mesh, edges, &mut elements)?;
        self.add_bending(cloth.bending_rigidity, mesh, edges, &mut elements)?;
        Ok(elements)
    }

    fn add_membrane(
        &self,
        membrane: Membrane,
        mesh: &TriMesh,
        edges: &EdgeTable,
        out: &mut MeshElements,
    ) -> Result<(), ClothError> {
        let is_linear_on_all_edges =
            self.law == SpringLaw::Linear && self.edges == SpringEdges::All;
        let is_springs_alone = self.membrane == MembraneElements::Springs && self.shear.is_none();
        let is_slack_arap = self.membrane == MembraneElements::Arap
            && self.shear.is_none()
            && self.edges == SpringEdges::All
            && matches!(self.law, SpringLaw::DeadZone(_));
        if !is_linear_on_all_edges && !is_springs_alone && !is_slack_arap {
            return Err(ClothError::LockingRemedyWithoutSprings);
        }
        if self.coarse_membrane.is_some() && !(is_linear_on_all_edges && is_springs_alone) {
            return Err(ClothError::CoarseMembraneWithoutSprings);
        }
        match self.membrane {
            MembraneElements::Springs => {
                let springs = membrane.springs(mesh, edges);
                let springs = self.edges.chosen_from(springs, mesh, edges)?;
                let (mut springs, mut limited) = self.law.applied_to(springs)?;
                if let Some(coarse_membrane) = self.coarse_membrane {
                    limited = coarse_membrane.applied_to(&mut springs, membrane, mesh, edges)?;
                }
                out.springs = springs;
                if !limited.is_empty() {
                    out.others.push(Elements::Limited(limited));
                }
            }
            MembraneElements::Stvk { poisson_ratio } => {
                if !(-1.0 < poisson_ratio && poisson_ratio < 1.0) {
                    return Err(ClothError::PoissonRatio(poisson_ratio));
                }
                let modulus = membrane.modulus(mesh, edges);
                let triangles = StvkTriangle::on(mesh, modulus, poisson_ratio);
                out.others.push(Elements::Stvk(triangles));
            }
            MembraneElements::Arap if is_slack_arap => {
                let limits = self.law.slack_range()?;
                let modulus = membrane.modulus(mesh, edges);
                let triangles = StrainLimitTriangle::on(mesh, limits, modulus);
                out.others.push(Elements::LimitedTriangles(triangles));
            }
            MembraneElements::Arap => {
                let triangles = ArapTriangle::on(mesh, membrane.modulus(mesh, edges));
                out.others.push(Elements::Arap(triangles));
            }
        }
        let Some(stiffness) = self.shear else {
            return Ok(());
        };
        not_negative("shear stiffness (N/m)", stiffness)?;
        if self.membrane != MembraneElements::Springs || matches!(membrane, Membrane::Modulus(_)) {
            return Err(ClothError::ShearWithoutStiffness);
        }
        let diagonals = shear(mesh, edges, stiffness, &mut out.springs)?;
        out.others.push(Elements::Springs(diagonals));
        Ok(())
    }

    fn add_bending(
        &self,
        rigidity: Real,
        mesh: &TriMesh,
        edges: &EdgeTable,
        out: &mut MeshElements,
    ) -> Result<(), ClothError> {
        if let BendingElements::Springs(stiffness) = self.bending {
            not_negative("stiffness of the bending springs (N/m)", stiffness)?;
            let hinges = HingeTable::build(mesh, edges);
            let springs = Spring::across(mesh.positions(), &hinges, stiffness);
            out.others.push(Elements::Springs(springs));
            return Ok(());
        }
        if rigidity == 0.0 || self.bending == BendingElements::None {
            return Ok(());
        }
        let table = HingeTable::build(mesh, edges);
        match self.bending {
            BendingElements::Quadratic => {
                out.hinges = CurvatureHinge::across(mesh, &table, rigidity);
            }
            BendingElements::Dihedral => {
                let hinges = DihedralHinge::across(mesh, &table, rigidity);
                out.others.push(Elements::Dihedral(hinges));
            }
            BendingElements::Bridson => {
                let hinges = DihedralHinge::bridson_across(mesh, &table, rigidity);
                out.others.push(Elements::Dihedral(hinges));
            }
            BendingElements::Cubic => {
                let hinges = CubicShell::across(mesh, &table, rigidity);
                out.others.push(Elements::Cubic(hinges));
            }
            BendingElements::Curved => {
                let hinges = CurvedHinge::across(mesh, &table, rigidity);
                out.others.push(Elements::Curved(hinges));
            }
            BendingElements::Springs(_) | BendingElements::None => {}
        }
        Ok(())
    }
}

/// Sets the springs on the diagonals of rectangles to `stiffness` (N/m), and returns those of the other diagonals.
fn shear(
    mesh: &TriMesh,
    edges: &EdgeTable,
    stiffness: Real,
    springs: &mut [Spring],
) -> Result<Vec<Spring>, ClothError> {
    let hinges = HingeTable::build(mesh, edges);
    // Hinges stand in the order of their edges.
    let inner = (0..edges.len()).filter(|&edge| !edges.is_boundary(edge));
    let mut crossing = Vec::new();
    for (edge, &hinge) in inner.zip(hinges.hinges()) {
        let [x0, x1, x2, x3] = gather(mesh.positions(), hinge);
        let [length, other] = [(x1 - x0).norm(), (x3 - x2).norm()];
        // The diagonals of a rectangle are as long as each other and halve each other.
        let apart = (x0 + x1 - x2 - x3).norm().max((length - other).abs());
        if apart < 1e-9 * length {
            springs[edge].stiffness = stiffness;
            crossing.push([hinge[2], hinge[3]]);
        }
    }
    if crossing.is_empty() {
        return Err(ClothError::NoRectangles);
    }
    Ok(Spring::along(mesh.positions(), &crossing, stiffness))
}

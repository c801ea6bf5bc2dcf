//! What springs and hinges amount to as a sheet.

use super::prelude::*;
use cloth_core::cloth::{Cloth, Membrane};
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{self, Diagonals};
use cloth_core::topology::EdgeTable;

crate::choices! {
    /// How a sheet is cut into triangles.
    #[derive(PartialEq, Eq)]
    pub(crate) enum Pattern {
        Equilateral = "equilateral",
        OneWay = "one-way",
        Alternating = "alternating",
    }
}

crate::settings! {
    /// Of laws of lattices.
    pub(super) struct Direction {
        pattern: Pattern = "equilateral", "equilateral, one-way or alternating";
        angle_deg: Real = 0 "degrees", "direction of the pull, from the x axis";
    }
}

pub(super) const LATTICE_MODULUS: Law = Law {
    name: "lattice-modulus",
    about: "Y/k of springs of equal stiffness, pulled in one direction (dimensionless)",
    parameters: &[Direction::PARAMETERS],
    tolerance: 1e-9,
    evaluate: lattice_modulus,
};

pub(super) const FLAT_BENDING: Law = Law {
    name: "flat-bending",
    about: "quadratic bending energy (J) of a flat irregular sheet that is turned and stretched in its plane: 0",
    parameters: &[],
    tolerance: 1e-24, // rounding of coordinates up to 4 m: ½ K (Σ|q| ε x)² with K = 400 N/m, on 1100 hinges
    evaluate: flat_bending,
};

/// A patch of the pattern with unit edges (unit cells for the grids), and a window (low corner, size) in it that holds
/// whole periods.
pub(super) fn patch(pattern: Pattern) -> Result<(TriMesh, [Real; 2], [Real; 2]), BenchError> {
    const CELLS: usize = 12;
    let side = CELLS as Real;
    let row = 0.75_f64.sqrt();
    let (mesh, window) = match pattern {
        Pattern::Equilateral => (
            generate::equilateral(CELLS + 1, CELLS + 1, 1.0),
            [6.0, 6.0 * row],
        ),
        Pattern::OneWay => (
            generate::grid(CELLS + 1, CELLS + 1, side, side, Diagonals::OneWay),
            [6.0, 6.0],
        ),
        Pattern::Alternating => (
            generate::grid(CELLS + 1, CELLS + 1, side, side, Diagonals::Alternating),
            [6.0, 6.0],
        ),
    };
    // No edge has its middle on the rim of the window.
    Ok((mesh?, [3.123, 2.877], window))
}

/// Stress times area (N·m) of the springs under the strain `(e_xx, e_yy, 2 e_xy)`, by virtual work: `Σ ∂E/∂x ⊗ X`,
/// symmetrised by nature.
fn stress(
    model: &cloth_core::cloth::ClothModel,
    rest: &[Vec3],
    strain: [Real; 3],
) -> Result<[Real; 3], BenchError> {
    let stretched: Vec<Vec3> = rest
        .iter()
        .map(|p| {
            let shear = 0.5 * strain[2];
            p + Vec3::new(
                strain[0] * p.x + shear * p.y,
                shear * p.x + strain[1] * p.y,
                0.0,
            )
        })
        .collect();
    let mut gradient = vec![Vec3::zeros(); rest.len()];
    model.energies()?.add_gradient(&stretched, &mut gradient);
    let work = |i: usize, j: usize| {
        gradient
            .iter()
            .zip(rest)
            .map(|(g, p)| g[i] * p[j])
            .sum::<Real>()
    };
    Ok([work(0, 0), work(1, 1), 0.5 * (work(0, 1) + work(1, 0))])
}

fn lattice_modulus(settings: &Settings) -> Result<Evaluation, BenchError> {
    let own = Direction::read(settings)?;
    const STRAIN: Real = 1e-5;
    let pattern = *own.pattern;
    let angle = own.angle_deg.to_radians();
    let (mesh, ..) = patch(pattern)?;
    let cloth = Cloth {
        areal_density: 1.0,
        membrane: Membrane::SpringStiffness(1.0),
        bending_rigidity: 0.0,
    };
    let mut model = cloth.on(&mesh)?;
    // In the unbounded lattice a spring on the rim belongs to this patch by half.
    let edges = EdgeTable::build(&mesh)?;
    for (edge, spring) in model.springs.iter_mut().enumerate() {
        if edges.is_boundary(edge) {
            spring.stiffness *= 0.5;
        }
    }
    let mut tensor = nalgebra::Matrix3::<Real>::zeros();
    for column in 0..3 {
        let mut strain = [0.0; 3];
        strain[column] = STRAIN;
        let above = stress(&model, mesh.positions(), strain)?;
        let below = stress(&model, mesh.positions(), strain.map(|e| -e))?;
        for row in 0..3 {
            tensor[(row, column)] = (above[row] - below[row]) / (2.0 * STRAIN * mesh.area());
        }
    }
    let c = |m: [[Real; 3]; 3]| nalgebra::Matrix3::from_fn(|i, j| m[i][j]);
    let expected = match pattern {
        Pattern::Equilateral => 2.0 / 3.0_f64.sqrt(),
        Pattern::Alternating => 4.0 / 3.0,
        // Σ L² (t⊗t⊗t⊗t) over the springs of a cell: two sides and one diagonal.
        Pattern::OneWay => modulus(
            &c([[1.5, 0.5, 0.5], [0.5, 1.5, 0.5], [0.5, 0.5, 0.5]]),
            angle,
        )?,
    };
    Ok(Evaluation::new(expected, modulus(&tensor, angle)?))
}

/// Young's modulus along a direction: a pull `σ = d dᵀ` makes the strain `C⁻¹σ`.
fn modulus(tensor: &nalgebra::Matrix3<Real>, angle: Real) -> Result<Real, BenchError> {
    let (sin, cos) = angle.sin_cos();
    let pull = nalgebra::Vector3::new(cos * cos, sin * sin, sin * cos);
    let inverse = tensor
        .try_inverse()
        .ok_or_else(|| BenchError::Failed("the springs do not resist every strain".into()))?;
    Ok(1.0 / pull.dot(&(inverse * pull)))
}

fn flat_bending(_: &Settings) -> Result<Evaluation, BenchError> {
    let mesh = generate::irregular(20, 1.0, 1.0, 5)?;
    let cloth = Cloth {
        areal_density: 1.0,
        membrane: Membrane::SpringStiffness(0.0),
        bending_rigidity: 1.0,
    };
    let mut model = cloth.on(&mesh)?;
    model.springs.clear();
    let turn = nalgebra::Rotation3::from_euler_angles(0.4, -1.1, 2.3);
    let moved: Vec<Vec3> = mesh
        .positions()
        .iter()
        .map(|p| {
            turn * Vec3::new(1.3 * p.x + 0.2 * p.y, 0.7 * p.y, 0.0) + Vec3::new(3.0, -2.0, 1.0)
        })
        .collect();
    let energy = model.energies()?.value(&moved);
    Ok(Evaluation::new(0.0, energy))
}

//! Patch tests: a sheet pulled in any direction answers as its closed form says.

use super::prelude::*;
use cloth_core::cloth::{Cloth, Membrane};
use cloth_core::energy::{ArapTriangle, StvkTriangle};
use cloth_core::mesh::{TriMesh, generate};
use cloth_core::method::family::Energies;
use cloth_core::topology::EdgeTable;

law! {
    PATCH = "patch" within 1e-10,
    "pull per width over the modulus Y (dimensionless) of a sheet stretched s times: stvk s(s² − 1)/2, or over (1 − ν) equibiaxial; arap s − 1; springs by direction";
    patch(PatchSettings {
        element: Sheet = "stvk", "stvk, arap (both on an irregular mesh) or springs (on equilateral triangles)";
        load: Load = "uniaxial", "uniaxial (free to become narrower) or equibiaxial";
        direction_deg: Real = 20 "degrees", "direction of the pull, from the x axis";
        stretch: Real = 1.2 in Within(0.1, 10.0), "present over rest length along the pull";
        poisson: Real = 0.3 in Between(-1.0, 1.0), "Poisson's ratio of stvk";
    })
}

crate::choices! {
    /// What the sheet is made of.
    #[derive(PartialEq, Eq)]
    enum Sheet { Stvk = "stvk", Arap = "arap", Springs = "springs" }
    /// How the sheet is pulled.
    #[derive(PartialEq, Eq)]
    enum Load { Uniaxial = "uniaxial", Equibiaxial = "equibiaxial" }
}

impl Sheet {
    /// Mesh and elements of modulus 1 N/m.
    fn build(self, poisson: Real) -> Result<(TriMesh, Energies), BenchError> {
        let mesh = match self {
            Self::Springs => generate::equilateral(7, 7, 1.0),
            _ => generate::irregular(7, 1.0, 1.0, 3),
        }?;
        let none = Energies::new(mesh.vertex_count());
        let energies = match self {
            Self::Stvk => none.with(StvkTriangle::on(&mesh, 1.0, poisson)),
            Self::Arap => none.with(ArapTriangle::on(&mesh, 1.0)),
            Self::Springs => {
                let cloth = Cloth {
                    areal_density: 1.0,
                    membrane: Membrane::Modulus(1.0),
                    bending_rigidity: 0.0,
                };
                cloth.on(&mesh)?.energies()
            }
        };
        Ok((mesh, energies?))
    }

    /// `P` (N/m) along and across the direction at stretches along and across, by hand.
    fn by_hand(self, poisson: Real, angle: Real, stretch: [Real; 2]) -> [Real; 2] {
        let [s, t] = stretch;
        let green = stretch.map(|s| 0.5 * (s * s - 1.0));
        let plane = |a: Real, b: Real| (a + poisson * b) / (1.0 - poisson * poisson);
        match self {
            Self::Stvk => [s * plane(green[0], green[1]), t * plane(green[1], green[0])],
            Self::Arap => [s - 1.0, t - 1.0],
            // Y = 1 is k = √¾; three springs of unit length a vertex, that is on an area of √¾.
            Self::Springs => {
                let mut sum = [0.0; 2];
                for degrees in [0.0_f64, 60.0, 120.0] {
                    let (sin, cos) = (degrees.to_radians() - angle).sin_cos();
                    let length = (s * cos).hypot(t * sin);
                    let pull = (length - 1.0) / length;
                    sum = [sum[0] + pull * s * cos * cos, sum[1] + pull * t * sin * sin];
                }
                sum
            }
        }
    }
}

/// `P` (N/m) of an affine stretch along and across a direction, by virtual work, and the largest force (N) on an inner
/// vertex.
fn measure(
    mesh: &TriMesh,
    energies: &Energies,
    angle: Real,
    stretch: [Real; 2],
) -> Result<([Real; 2], Real), BenchError> {
    let (sin, cos) = angle.sin_cos();
    let axes = [Vec3::new(cos, sin, 0.0), Vec3::new(-sin, cos, 0.0)];
    let at = |p: &Vec3| -> Vec3 {
        let part = |k: usize| axes[k] * (stretch[k] * axes[k].dot(p));
        part(0) + part(1)
    };
    let x: Vec<Vec3> = mesh.positions().iter().map(at).collect();
    let mut gradient = vec![Vec3::zeros(); x.len()];
    energies.add_gradient(&x, &mut gradient);
    let pull = axes.map(|axis| {
        let pairs = gradient.iter().zip(mesh.positions());
        let work: Real = pairs.map(|(g, p)| axis.dot(g) * axis.dot(p)).sum();
        work / mesh.area()
    });
    let edges = EdgeTable::build(mesh)?;
    for edge in (0..edges.len()).filter(|&edge| edges.is_boundary(edge)) {
        for vertex in edges.ends()[edge] {
            gradient[vertex as usize] = Vec3::zeros();
        }
    }
    Ok((pull, gradient.iter().map(Vec3::norm).fold(0.0, Real::max)))
}

/// The stretch across at which nothing pulls across, near 1: `across` rises through zero there.
fn relaxed(mut across: impl FnMut(Real) -> Result<Real, BenchError>) -> Result<Real, BenchError> {
    let [mut low, mut high] = [0.5, 2.0];
    if across(low)? > 0.0 || across(high)? < 0.0 {
        return Err(BenchError::Usage(
            "at this stretch the sheet is less than half or more than twice as wide as at rest"
                .into(),
        ));
    }
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if across(middle)? < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    Ok(0.5 * (low + high))
}

fn patch(own: &PatchSettings) -> Result<Evaluation, BenchError> {
    let (sheet, load) = (*own.element, *own.load);
    let angle = own.direction_deg.to_radians();
    let (s, poisson) = (*own.stretch, *own.poisson);
    let (mesh, energies) = sheet.build(poisson)?;
    let [expected_width, width] = match load {
        Load::Equibiaxial => [s, s],
        Load::Uniaxial => [
            match sheet {
                Sheet::Stvk => (1.0 - poisson * (s * s - 1.0)).max(0.0).sqrt(),
                Sheet::Arap => 1.0,
                Sheet::Springs => relaxed(|t| Ok(sheet.by_hand(poisson, angle, [s, t])[1]))?,
            },
            relaxed(|t| Ok(measure(&mesh, &energies, angle, [s, t])?.0[1]))?,
        ],
    };
    let expected = match (sheet, load) {
        _ if s == 1.0 => 0.0,
        (Sheet::Stvk, Load::Uniaxial) => 0.5 * s * (s * s - 1.0),
        (Sheet::Stvk, Load::Equibiaxial) => 0.5 * s * (s * s - 1.0) / (1.0 - poisson),
        _ => sheet.by_hand(poisson, angle, [s, expected_width])[0],
    };
    let ([along, across], inner) = measure(&mesh, &energies, angle, [s, width])?;
    // Forces are sums of Y times lengths known to rounding, over the strain that is measured.
    let rounding = 1e-14 / expected.abs().max(1e-300);
    Ok(Evaluation::new(expected, along)
        .rounding(if expected == 0.0 { 1e-13 } else { rounding })
        .detail("lateral_expected", expected_width)
        .detail("lateral", width)
        .detail("across", across)
        .detail("force_on_inner_vertices", inner))
}

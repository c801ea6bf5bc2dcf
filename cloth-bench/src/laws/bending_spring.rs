//! What a spring across a hinge does against a fold: nothing at first.

use super::prelude::*;
use cloth_core::math::Mat3;
use cloth_core::mesh::generate;
use cloth_core::method::family::Energies;
use cloth_core::topology::{EdgeTable, HingeTable};

law! {
    BENDING_SPRING = "bending-spring" within 1e-6,
    "energy of a bending spring across two equilateral triangles folded by θ, over k ℓ0² θ⁴ (dimensionless): 1/128; extrapolated from two angles";
    bending_spring(BendingSpringSettings {
        angle_deg: Real = 2 "degrees" in Above(0.0), "largest fold, up to 30; a second one is half of it";
    })
}

fn bending_spring(own: &BendingSpringSettings) -> Result<Evaluation, BenchError> {
    let angle = own.angle_deg.to_radians();
    if angle > 30.5_f64.to_radians() {
        return Err(BenchError::Usage(format!(
            "angle_deg is {}, but the law of small folds is extrapolated from at most 30",
            angle.to_degrees()
        )));
    }
    let mesh = generate::equilateral(2, 2, 1.0)?;
    let edges = EdgeTable::build(&mesh)?;
    let hinges = HingeTable::build(&mesh, &edges);
    let springs = Spring::across(mesh.positions(), &hinges, 1.0);
    let (hinge, rest_length) = (hinges.hinges()[0], springs[0].rest_length);
    let energies = Energies::new(mesh.vertex_count()).with(springs)?;
    let folded = |theta: Real| {
        let mut x = mesh.positions().to_vec();
        let [start, end, _, tip] = hinge.map(|v| v as usize);
        let axis = (x[end] - x[start]).normalize().cross_matrix();
        let turn = Mat3::identity() + axis * theta.sin() + axis * axis * (1.0 - theta.cos());
        x[tip] = x[start] + turn * (x[tip] - x[start]);
        energies.value(&x)
    };
    let [whole, half] = [folded(angle), folded(0.5 * angle)];
    let over = |energy: Real, theta: Real| energy / (rest_length.powi(2) * theta.powi(4));
    // The next order goes with θ²: E/θ⁴ = (1 − θ²/24 + …)/128.
    let measured = (4.0 * over(half, 0.5 * angle) - over(whole, angle)) / 3.0;
    // What is left out is of order θ⁴; the length is known to rounding, its change is θ²/8 of it.
    let series = angle.powi(4) / 1000.0;
    let rounding = 64.0 * Real::EPSILON / angle.powi(2);
    Ok(Evaluation::new(1.0 / 128.0, measured)
        .rounding(rounding.max(series))
        .detail("exponent", (whole / half).log2()))
}

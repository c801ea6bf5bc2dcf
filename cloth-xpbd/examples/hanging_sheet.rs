//! A sheet held at two corners falls and swings: the same number of sweeps, spent on iterations or on substeps.
//!
//! `cargo run --release -p cloth-xpbd --example hanging_sheet`

use cloth_core::cloth::{Cloth, Membrane};
use cloth_core::math::Vec3;
use cloth_core::measure::{Strain, center_of_mass};
use cloth_core::mesh::generate::{Diagonals, grid};
use cloth_core::particles::State;
use cloth_core::step::{StepInput, Stepper};
use cloth_xpbd::{XpbdConfig, XpbdSolver};
use std::error::Error;

const SIDE: usize = 24;

fn main() -> Result<(), Box<dyn Error>> {
    let mesh = grid(SIDE, SIDE, 1.0, 1.0, Diagonals::Alternating)?;
    let cloth = Cloth {
        areal_density: 0.2,
        membrane: Membrane::SpringStiffness(1e4),
        bending_rigidity: 1e-5,
    };
    let mut model = cloth.on(&mesh)?;
    model.particles.prescribe(0)?;
    model.particles.prescribe(SIDE - 1)?;

    println!("after 0.5 s       largest strain   largest |C + α̃λ| (m)  fall of the centre (m)");
    let mut largest = Vec::new();
    for (iterations, substeps) in [(1, 20), (4, 5), (20, 1), (400, 1), (1, 400)] {
        let mut solver = XpbdSolver::builder(&model.particles)
            .energy(model.springs.clone())
            .energy(model.hinges.clone())
            .config(XpbdConfig {
                iterations,
                substeps,
                ..XpbdConfig::default()
            })
            .build()?;
        let mut state = State::at_rest(mesh.positions().to_vec());
        for _ in 0..30 {
            let input = StepInput::new(1.0 / 60.0).gravity(Vec3::new(0.0, 0.0, -9.81));
            solver.step(&mut state, input)?;
        }
        let strain = Strain::of(&model.springs, &state.positions).max;
        let residual = solver.compliance_residual(&state.positions);
        let fall = -center_of_mass(&model.particles, &state.positions).z;
        println!(
            "{substeps:3} substeps × {iterations:3}  {strain:14.4}   {residual:20.2e}   {fall:22.4}"
        );
        largest.push(strain);
    }
    assert!(
        largest[0] < 0.2 * largest[2],
        "twenty sweeps hold the cloth together better as substeps than as iterations"
    );
    println!("twenty sweeps hold the cloth together better as substeps than as iterations");
    Ok(())
}

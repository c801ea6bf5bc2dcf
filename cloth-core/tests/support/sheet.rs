//! A sheet of cloth held at two corners, for the tests of several crates.

use cloth_core::cloth::{Cloth, ClothModel, Membrane};
use cloth_core::math::Vec3;
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{Diagonals, grid};
use cloth_core::particles::State;
use cloth_core::step::{StepInput, Stepper};

/// 1 m × 1 m of `side` × `side` vertices, 0.2 kg/m², with bending, two corners held.
pub(crate) fn held_sheet(side: usize, spring_stiffness: f64) -> (TriMesh, ClothModel) {
    let mesh = grid(side, side, 1.0, 1.0, Diagonals::Alternating).unwrap();
    let cloth = Cloth {
        areal_density: 0.2,
        membrane: Membrane::SpringStiffness(spring_stiffness),
        bending_rigidity: 1e-4,
    };
    let mut model = cloth.on(&mesh).unwrap();
    model.particles.prescribe(0).unwrap();
    model.particles.prescribe(side - 1).unwrap();
    (mesh, model)
}

/// Lets it fall for `steps` steps of 1/60 s.
pub(crate) fn fall(solver: &mut dyn Stepper, state: &mut State, steps: u32) {
    for _ in 0..steps {
        let input = StepInput::new(1.0 / 60.0).gravity(Vec3::new(0.0, 0.0, -9.81));
        solver.step(state, input).unwrap();
    }
}

//! Nothing is allocated after the first step.

use crate::counting_allocator;
use crate::sheet;

#[test]
fn nothing_is_allocated_after_the_first_step() {
    let (mesh, model) = sheet::held_sheet(24, 1e4);
    for (damping, energy_gain) in [(0.0, None), (1e-3, None), (0.0, Some(0.01))] {
        let config = cloth_xpbd::XpbdConfig {
            damping,
            energy_gain,
            ..Default::default()
        };
        let builder = cloth_xpbd::XpbdSolver::builder(&model.particles);
        let builder = builder.energy(model.springs.clone()).config(config);
        let mut solver = builder.energy(model.hinges.clone()).build().unwrap();
        let mut state = cloth_core::particles::State::at_rest(mesh.positions().to_vec());
        let step = || sheet::fall(&mut solver, &mut state, 1);
        assert_eq!(counting_allocator::allocations_once_warm(step), 0);
    }
}

//! Nothing is allocated after the first step.

#[path = "../../cloth-core/tests/support/counting_allocator.rs"]
mod counting_allocator;
#[path = "../../cloth-core/tests/support/sheet.rs"]
mod sheet;

use cloth_core::particles::State;
use cloth_xpbd::XpbdSolver;

#[test]
fn nothing_is_allocated_after_the_first_step() {
    let (mesh, model) = sheet::held_sheet(24, 1e4);
    let mut state = State::at_rest(mesh.positions().to_vec());
    let mut solver = XpbdSolver::builder(&model.particles)
        .energy(model.springs)
        .energy(model.hinges)
        .build()
        .unwrap();
    sheet::fall(&mut solver, &mut state, 1);
    let later = counting_allocator::allocations(|| sheet::fall(&mut solver, &mut state, 20));
    assert_eq!(later, 0);
}

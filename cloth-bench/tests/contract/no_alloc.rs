//! No method allocates once warm.

use crate::common::{advance, allocations_once_warm, methods, scene, solver};

#[test]
fn no_step_allocates_after_the_first() {
    let scene = scene("hang", &["n=20"]);
    for method in methods() {
        let mut solver = solver(method, &scene);
        let mut state = scene.start.clone();
        let count = allocations_once_warm(|| advance(&mut *solver, &scene, &mut state, 1));
        assert_eq!(count, 0, "allocations of {} in twenty steps", method.name);
    }
}

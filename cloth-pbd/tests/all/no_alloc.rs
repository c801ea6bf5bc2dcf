//! Nothing is allocated after the first step.

use crate::counting_allocator;
use crate::sheet;

use cloth_core::method::position_based::{Acceleration, Chebyshev, Radius, Sweep};
use cloth_core::particles::State;
use cloth_pbd::{PbdConfig, PbdSolver};

#[test]
fn nothing_is_allocated_after_the_first_step() {
    let (mesh, model) = sheet::held_sheet(24, 1e4);
    let chebyshev = Chebyshev {
        radius: Radius::Estimated,
        delay: 4,
    };
    for sweep in [Sweep::Sequential, Sweep::Colored, Sweep::Jacobi] {
        for chebyshev in [None, Some(chebyshev)] {
            let acceleration = Acceleration {
                chebyshev,
                ..Acceleration::default()
            };
            let config = PbdConfig {
                sweep,
                acceleration,
                ..PbdConfig::default()
            };
            let builder = PbdSolver::builder(&model.particles).energy(model.springs.clone());
            let builder = builder.energy(model.hinges.clone()).config(config);
            let mut solver = builder.build().unwrap();
            let mut state = State::at_rest(mesh.positions().to_vec());
            let step = || sheet::fall(&mut solver, &mut state, 1);
            let count = counting_allocator::allocations_once_warm(step);
            assert_eq!(count, 0, "{config:?}");
        }
    }
}

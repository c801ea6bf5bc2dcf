//! No step after the first allocates.
#![allow(unsafe_code)] // a global allocator can be written in no other way

use cloth_core::energy::Spring;
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::generate::{Diagonals, grid};
use cloth_core::particles::{Particles, State};
use cloth_core::step::{StepInput, Stepper};
use cloth_core::topology::EdgeTable;
use cloth_massspring::{
    Bdf2, Damping, ExplicitConfig, ExplicitEuler, ImplicitConfig, ImplicitEuler, ImplicitMidpoint,
    SymplecticEuler,
};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

struct Counting;

thread_local! {
    // By thread: the test harness allocates in its own when it likes.
    static ALLOCATIONS: Cell<usize> = const { Cell::new(0) };
}

// SAFETY: every call goes to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.set(ALLOCATIONS.get() + 1);
        // SAFETY: the caller keeps the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller keeps the contract of `dealloc`, and all memory is from `System`.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

#[test]
fn no_step_after_the_first_allocates() {
    let mesh = grid(9, 9, 1.0, 1.0, Diagonals::Alternating).unwrap();
    let edges = EdgeTable::build(&mesh).unwrap();
    let springs = Spring::along(mesh.positions(), edges.ends(), 1e3);
    let mut particles = Particles::from_areal_density(&mesh, 0.2).unwrap();
    particles.prescribe(0).unwrap();
    let damping = Damping {
        air_drag: 0.1,
        stiffness: 1e-6,
    };
    let explicit = ExplicitConfig {
        damping,
        ..ExplicitConfig::default()
    };
    let implicit = ImplicitConfig {
        damping,
        ..ImplicitConfig::reference()
    };
    let frame = 1.0 / 60.0;
    macro_rules! solver {
        ($kind:ident, $config:expr) => {{
            let builder = $kind::builder(&particles).energy(springs.clone()).unwrap();
            Box::new(builder.config($config).build().unwrap())
        }};
    }
    let solvers: [(Box<dyn Stepper>, Real, usize); 6] = [
        (solver!(ExplicitEuler, explicit), 1e-5, 300),
        (solver!(SymplecticEuler, explicit), 1e-5, 1000),
        (solver!(ImplicitEuler, implicit), frame, 10),
        (
            solver!(ImplicitEuler, ImplicitConfig::linearized()),
            frame,
            10,
        ),
        (solver!(ImplicitMidpoint, implicit), frame, 10),
        (solver!(Bdf2, implicit), frame, 10),
    ];
    for (mut solver, dt, steps) in solvers {
        let mut state = State::at_rest(mesh.positions().to_vec());
        let gravity = Vec3::new(0.0, 0.0, -9.81);
        let mut before = 0;
        for step in 0..=steps {
            solver
                .step(&mut state, StepInput::new(dt).gravity(gravity))
                .unwrap();
            if step == 0 {
                before = ALLOCATIONS.get();
            }
        }
        let count = ALLOCATIONS.get() - before;
        assert_eq!(count, 0, "{}", solver.name());
    }
}

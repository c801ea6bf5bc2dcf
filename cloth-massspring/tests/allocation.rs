//! No step after the first allocates.
#![allow(unsafe_code)] // a global allocator can be written in no other way

use cloth_core::energy::Spring;
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::generate::{Diagonals, grid};
use cloth_core::particles::{Particles, State};
use cloth_core::step::{StepInput, Stepper};
use cloth_core::topology::EdgeTable;
use cloth_massspring::{ExplicitEuler, ImplicitConfig, ImplicitEuler, SymplecticEuler};
use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};

struct Counting;

static ALLOCATIONS: AtomicUsize = AtomicUsize::new(0);

// SAFETY: every call goes to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
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

/// One test for all, because the count is global.
#[test]
fn no_step_after_the_first_allocates() {
    let mesh = grid(9, 9, 1.0, 1.0, Diagonals::Alternating).unwrap();
    let edges = EdgeTable::build(&mesh).unwrap();
    let springs = Spring::along(mesh.positions(), edges.ends(), 1e3);
    let mut particles = Particles::from_areal_density(&mesh, 0.2).unwrap();
    particles.prescribe(0).unwrap();
    let explicit = ExplicitEuler::builder(&particles)
        .energy(springs.clone())
        .unwrap();
    let symplectic = SymplecticEuler::builder(&particles)
        .energy(springs.clone())
        .unwrap();
    let implicit = ImplicitEuler::builder(&particles).energy(springs).unwrap();
    let implicit = implicit.config(ImplicitConfig::reference());
    let solvers: [(Box<dyn Stepper>, Real, usize); 3] = [
        (Box::new(explicit.build().unwrap()), 1e-5, 300),
        (Box::new(symplectic.build().unwrap()), 1e-5, 1000),
        (Box::new(implicit.build().unwrap()), 1.0 / 60.0, 10),
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
                before = ALLOCATIONS.load(Ordering::Relaxed);
            }
        }
        let count = ALLOCATIONS.load(Ordering::Relaxed) - before;
        assert_eq!(count, 0, "{}", solver.name());
    }
}

//! Steps after the first do not touch the heap.

use cloth_core::cloth::{Cloth, ClothModel, Membrane};
use cloth_core::energy::Attachment;
use cloth_core::math::Vec3;
use cloth_core::mesh::generate::{Diagonals, grid};
use cloth_core::particles::State;
use cloth_core::step::{StepInput, Stepper};
use cloth_pd::{Acceleration, PdConfig, PdSolver, StartGuess};
use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicU64, Ordering};

/// Allocations of all threads.
static ALLOCATIONS: AtomicU64 = AtomicU64::new(0);

struct Counting;

#[allow(unsafe_code)] // a global allocator cannot be written without
// SAFETY: every call is handed to the allocator of the system as it came.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        // SAFETY: the caller keeps the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller keeps the contract of `dealloc`, and `pointer` came from `System`.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn hanging(n: usize) -> (ClothModel, State) {
    let mesh = grid(n, n, 1.0, 1.0, Diagonals::Alternating).unwrap();
    let cloth = Cloth {
        areal_density: 0.2,
        membrane: Membrane::SpringStiffness(1e4),
        bending_rigidity: 1e-5,
    };
    let mut model = cloth.on(&mesh).unwrap();
    model.particles.prescribe(0).unwrap();
    (model, State::at_rest(mesh.positions().to_vec()))
}

/// Allocations of some steps that follow on a first one with each of these step sizes.
fn allocations(
    n: usize,
    acceleration: Acceleration,
    tolerance: Option<f64>,
    step_sizes: &[f64],
) -> u64 {
    let (model, mut state) = hanging(n);
    let config = PdConfig {
        iterations: Some(8),
        tolerance,
        start: StartGuess::Inertial,
        acceleration,
        ..PdConfig::default()
    };
    let builder = PdSolver::builder(&model.particles)
        .energy(model.springs)
        .energy(model.hinges)
        .coarse_grid(&state.positions, 4);
    let mut solver = builder.config(config).build().unwrap();
    let tie = Attachment {
        vertex: 5,
        target: state.positions[5],
        stiffness: 100.0,
    };
    let tied = solver.attach(tie).unwrap();
    let mut step = |dt| {
        // The pin and the attachment are dragged all the time.
        state.velocities[0] = Vec3::new(0.1, 0.0, 0.2 * state.time.cos());
        let target = tie.target + Vec3::z() * state.time;
        solver.move_attachment(tied, target).unwrap();
        let input = StepInput::new(dt).gravity(Vec3::new(0.0, 0.0, -9.81));
        solver.step(&mut state, input).unwrap();
    };
    step(step_sizes[0]);
    // The harness of the tests allocates on its own now and then; what a step allocates, it allocates in every round.
    let mut round = || {
        let before = ALLOCATIONS.load(Ordering::Relaxed);
        step_sizes.iter().for_each(|&dt| step(dt));
        ALLOCATIONS.load(Ordering::Relaxed) - before
    };
    (0..4).map(|_| round()).min().unwrap_or(0)
}

/// One test, because the count is that of the whole process.
#[test]
fn steps_after_the_first_do_not_allocate() {
    let chebyshev = |spectral_radius| Acceleration::Chebyshev { spectral_radius };
    let quasi_newton = Acceleration::QuasiNewton { history: 3 };
    for acceleration in [
        Acceleration::None,
        chebyshev(None),
        chebyshev(Some(0.99)),
        quasi_newton,
    ] {
        let count = |tolerance, dt: &[f64]| allocations(12, acceleration, tolerance, dt);
        assert_eq!(count(None, &[0.01]), 0, "{acceleration:?}");
        let tolerance = Some(1e-3);
        assert_eq!(count(tolerance, &[0.01]), 0, "{acceleration:?}, tolerance");
        let sizes = [0.01, 0.02];
        assert_eq!(count(None, &sizes), 0, "{acceleration:?}, factorising");
    }
    #[cfg(feature = "parallel")]
    {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(2)
            .build()
            .unwrap();
        let on_threads = pool.install(|| allocations(128, quasi_newton, None, &[0.01]));
        assert_eq!(on_threads, 0, "on two threads");
    }
}

//! No step after the first allocates.

use crate::counting_allocator;
use cloth_core::energy::Spring;
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::generate::{Diagonals, grid};
use cloth_core::method::linear::{LinearMethod, StoppingCriteria};
use cloth_core::particles::{Particles, State};
use cloth_core::step::{StepInput, Stepper};
use cloth_core::topology::EdgeTable;
use cloth_massspring::{
    Bdf2, Damping, ExplicitConfig, ExplicitEuler, ImplicitConfig, ImplicitEuler, ImplicitMidpoint,
    SymplecticEuler,
};

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
            let builder = $kind::builder(&particles).energy(springs.clone());
            Box::new(builder.config($config).build().unwrap())
        }};
    }
    let budget = StoppingCriteria::default();
    let iterative = [
        LinearMethod::ConjugateGradients(budget),
        LinearMethod::ChebyshevJacobi(budget),
        LinearMethod::Jacobi(budget),
        LinearMethod::GaussSeidel(budget),
    ];
    let mut solvers: Vec<(Box<dyn Stepper>, Real, usize)> = vec![
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
    for linear in iterative {
        let config = ImplicitConfig {
            linear,
            ..ImplicitConfig::default()
        };
        solvers.push((solver!(ImplicitEuler, config), frame, 10));
    }
    for (mut solver, dt, steps) in solvers {
        let mut state = State::at_rest(mesh.positions().to_vec());
        let gravity = Vec3::new(0.0, 0.0, -9.81);
        // The first call is one step; twenty calls of several steps follow.
        let mut warm = false;
        let count = counting_allocator::allocations_once_warm(|| {
            let steps = if std::mem::replace(&mut warm, true) {
                steps.div_ceil(20)
            } else {
                1
            };
            for _ in 0..steps {
                let input = StepInput::new(dt).gravity(gravity);
                solver.step(&mut state, input).unwrap();
            }
        });
        assert_eq!(count, 0, "{}", solver.name());
    }
}

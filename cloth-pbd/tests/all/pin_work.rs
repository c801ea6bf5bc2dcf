//! The work of prescribed vertices that move, against the momentum that they give.

use cloth_core::element::Constraint;
use cloth_core::energy::{CurvatureHinge, Spring};
use cloth_core::math::{Real, Vec3};
use cloth_core::method::position_based::{Acceleration, Chebyshev, Radius, Sweep};
use cloth_core::particles::{Particles, State};
use cloth_core::step::{StepInput, Stepper};
use cloth_pbd::{PbdConfig, PbdSolver, StiffnessRule};

const VELOCITY: Vec3 = Vec3::new(0.7, 0.0, 1.9);
const MASS: Real = 0.03;
const DT: Real = 1.0 / 60.0;

/// Vertex 0 is prescribed and moves with [`VELOCITY`], all others are at rest.
fn pulled(positions: Vec<Vec3>) -> (Particles, State) {
    let mut particles = Particles::new(vec![MASS; positions.len()]).unwrap();
    particles.prescribe(0).unwrap();
    let mut state = State::at_rest(positions);
    state.velocities[0] = VELOCITY;
    (particles, state)
}

/// Seven springs in a row along `direction`.
fn chain(direction: Vec3) -> (Particles, State, Vec<Spring>) {
    let along = direction.normalize() * -0.1;
    let (particles, state) = pulled((0..8).map(|i| along * Real::from(i)).collect());
    let spring = |i| Spring {
        vertices: [i, i + 1],
        rest_length: 0.1,
        stiffness: 2e3,
    };
    (particles, state, (0..7).map(spring).collect())
}

/// Projections between vertices give no momentum but that of the pin, and the pin does the work `V·p` in giving
/// it: the largest error over 30 steps, relative to that.
fn error<const N: usize, E: Constraint<N>>(
    (particles, mut state, elements): (Particles, State, Vec<E>),
    config: PbdConfig,
) -> Real {
    let builder = PbdSolver::builder(&particles).energy(elements);
    let mut solver = builder.config(config).build().unwrap();
    let (mut work, mut error) = (0.0, 0.0);
    for _ in 0..30 {
        let report = solver.step(&mut state, StepInput::new(DT)).unwrap();
        work += report.pin_work.expect("it is added up");
        let momentum: Vec3 = state.velocities[1..].iter().map(|v| v * MASS).sum();
        let given = VELOCITY.dot(&momentum);
        assert!(given > 1e-6, "{given}");
        error = Real::max(error, (work / given - 1.0).abs());
    }
    error
}

#[test]
fn what_a_pin_gives_a_chain_is_the_work_it_does() {
    let over = Acceleration {
        relaxation: 1.3,
        ..Acceleration::default()
    };
    let extrapolated = |radius| Acceleration {
        chebyshev: Some(Chebyshev { radius, delay: 4 }),
        ..Acceleration::default()
    };
    let cases = [
        (Sweep::Colored, Acceleration::default()),
        (Sweep::Sequential, over),
        (Sweep::Jacobi, Acceleration::default()),
        (Sweep::Jacobi, extrapolated(Radius::Given(0.9))),
        (Sweep::Colored, extrapolated(Radius::Estimated)),
    ];
    for (sweep, acceleration) in cases {
        for stiffness in [StiffnessRule::Material, StiffnessRule::Fixed(0.7)] {
            for (substeps, iterations) in [(1, 20), (20, 1), (3, 7)] {
                let config = PbdConfig {
                    iterations,
                    substeps,
                    sweep,
                    acceleration,
                    stiffness,
                };
                let found = error(chain(VELOCITY), config);
                assert!(found < 1e-11, "{config:?}: {found:e}");
            }
        }
    }
}

/// Of a chain that is dragged sideways springs turn while they are swept, and J is taken where they end: an
/// error that a substep of half the size divides by four.
#[test]
fn work_on_a_chain_that_turns_is_right_to_second_order() {
    let sideways = Vec3::new(1.9, 0.3, -0.7);
    let errors = [10, 20, 40, 80].map(|substeps| {
        let config = PbdConfig {
            substeps,
            iterations: 5,
            ..PbdConfig::default()
        };
        error(chain(sideways), config)
    });
    for pair in errors.windows(2) {
        assert!((3.6..4.1).contains(&(pair[0] / pair[1])), "{errors:?}");
    }
    assert!(errors[3] < 3e-5, "{errors:?}");
}

#[test]
fn what_a_pin_gives_through_a_hinge_is_the_work_it_does() {
    let corners = [[0.0, 1.0], [0.0, -1.0], [-1.0, 0.0], [1.0, 0.0]];
    let corners = corners.map(|[x, y]| Vec3::new(0.1 * x, 0.1 * y, 0.0));
    let (particles, state) = pulled(corners.to_vec());
    let hinge = CurvatureHinge::new([0, 1, 2, 3], &corners, 0.5);
    let found = error((particles, state, vec![hinge]), PbdConfig::default());
    assert!(found < 1e-12, "{found:e}");
}

/// What is added up is that of one step, also where pins have moved before.
#[test]
fn pins_that_stand_still_do_no_work() {
    let (particles, mut state, springs) = chain(VELOCITY);
    let builder = PbdSolver::builder(&particles).energy(springs);
    let mut solver = builder.build().unwrap();
    let input = StepInput::new(DT).gravity(Vec3::new(0.0, -9.81, 0.0));
    assert!(solver.step(&mut state, input).unwrap().pin_work > Some(0.0));
    state.velocities[0] = Vec3::zeros();
    for _ in 0..5 {
        let input = StepInput::new(DT).gravity(Vec3::new(0.0, -9.81, 0.0));
        assert_eq!(solver.step(&mut state, input).unwrap().pin_work, Some(0.0));
    }
}

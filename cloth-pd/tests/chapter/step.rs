//! The contract of a step: factorisations, threads, errors.

use crate::cloth::{
    DT, GRAVITY, coarse_solver, falling, hanging, iterations, shake, sheet, solver,
};
use cloth_core::contact::{
    ContactConstraints, ContactError, ContactPotential, ContactRow, ContactSource, ContactStep,
};
use cloth_core::energy::Spring;
use cloth_core::error::OutOfRange;
use cloth_core::math::{Real, Vec3};
use cloth_core::particles::{Particles, State};
use cloth_core::step::{BuildError, StepError, StepInput, Stepper};
#[cfg(feature = "parallel")]
use cloth_pd::Acceleration;
use cloth_pd::{PdConfig, PdSolver, StartGuess};

fn input_of<'a>(dt: Real) -> StepInput<'a> {
    StepInput::new(dt).gravity(GRAVITY)
}

#[test]
fn a_changed_step_size_is_factorised_once_and_reported() {
    let (model, mut state) = hanging(9, 1e4);
    let mut one = solver(&model, iterations(4));
    let reported: Vec<u32> = [DT, DT, DT / 2.0, DT / 2.0, DT, DT]
        .into_iter()
        .map(|dt| one.step(&mut state, input_of(dt)).unwrap().factorizations)
        .collect();
    assert_eq!(reported, [1, 0, 1, 0, 1, 0]);
}

#[test]
fn a_step_has_the_bits_that_a_new_solver_gives() {
    let (model, mut state) = hanging(9, 1e4);
    shake(&model, &mut state, 0.02);
    let mut old = solver(&model, iterations(4));
    for dt in [DT, DT / 3.0, DT / 3.0, 2.0 * DT, DT] {
        let mut by_new = state.clone();
        solver(&model, iterations(4))
            .step(&mut by_new, input_of(dt))
            .unwrap();
        old.step(&mut state, input_of(dt)).unwrap();
        assert_eq!(state, by_new);
    }
}

/// Pushes everything below a height (m) up by the springs of a foundation; and the fraction of its path that each
/// vertex may go by itself (dimensionless), where all together may go the whole of it.
#[derive(Debug)]
struct Floor(Real, Real);

impl Floor {
    /// k of the spring of a vertex (N/m).
    const STIFFNESS: Real = 10.0;
}

impl ContactSource for Floor {
    fn keep_free(&mut self, _: &[Vec3], _: &[Real], _: &mut [Vec3]) -> Result<(), ContactError> {
        Ok(())
    }

    fn potential(&mut self) -> &mut dyn ContactPotential {
        self
    }

    fn constraints(&mut self) -> &mut dyn ContactConstraints {
        unreachable!("projective dynamics wants an energy")
    }
}

impl ContactPotential for Floor {
    fn begin(&mut self, _: &ContactStep<'_>, _: &mut [Vec3]) -> Result<(), ContactError> {
        Ok(())
    }

    fn limit(&mut self, _: &[Vec3], _: &[Vec3]) -> Result<Real, ContactError> {
        Ok(1.0)
    }

    fn limit_each(
        &mut self,
        from: &[Vec3],
        to: &mut [Vec3],
        fractions: &mut [Real],
    ) -> Result<(), ContactError> {
        fractions.fill(self.1);
        let ends = to.iter_mut().zip(from);
        ends.for_each(|(to, from)| *to = from + (*to - from) * self.1);
        Ok(())
    }

    fn add_gradient(&self, x: &[Vec3], out: &mut [Vec3]) -> Real {
        let deep = |x: &Vec3| (self.0 - x.z).max(0.0);
        for (out, x) in out.iter_mut().zip(x) {
            out.z -= Self::STIFFNESS * deep(x);
        }
        let squares = x.iter().map(|x| deep(x).powi(2));
        0.5 * Self::STIFFNESS * squares.sum::<Real>()
    }

    fn linearize(&self, x: &[Vec3], out: &mut Vec<ContactRow>) {
        let below = (0u32..).zip(x).filter(|(_, x)| x.z < self.0);
        out.extend(below.map(|(vertex, _)| ContactRow {
            vertices: [vertex; 4],
            weights: [1.0, 0.0, 0.0, 0.0],
            normal: Vec3::z(),
            stiffness: Self::STIFFNESS,
        }));
    }

    fn end(&mut self, _: &[Vec3], _: &mut [Vec3]) {}
}

#[test]
fn nothing_is_remembered_that_contact_has_made_wrong() {
    let (model, mut state) = hanging(9, 1e4);
    let rest = state.positions.clone();
    // An extrapolated start is of the velocities of the last step; that is all.
    let config = PdConfig {
        start: StartGuess::Inertial,
        ..PdConfig::default()
    };
    let build = || coarse_solver(&model, &rest, config);
    let mut old = build();
    let mut floor = Floor(-0.2, 1.0);
    for _ in 0..60 {
        let mut by_new = state.clone();
        let mut steps = [(&mut old, &mut state), (&mut build(), &mut by_new)];
        for (solver, state) in &mut steps {
            let input = falling().contacts(&mut floor);
            solver.step(state, input).unwrap();
        }
        assert_eq!(state, by_new);
    }
    assert!(state.positions.iter().any(|x| x.z < -0.2));
}

/// Where what contact leaves of a direction vertex by vertex does not descend, the direction is followed as a whole: a
/// step with a source that leaves nothing takes no more iterations than one that leaves all.
#[test]
fn a_direction_that_does_not_descend_vertex_by_vertex_is_followed_as_a_whole() {
    let (model, mut start) = hanging(9, 1e4);
    let free = |solver: &mut PdSolver, state: &mut State, floor: &mut Floor| {
        let report = solver.step(state, falling().contacts(floor)).unwrap();
        report.iterations
    };
    let build = || {
        solver(
            &model,
            PdConfig {
                tolerance: Some(1e-8),
                ..PdConfig::default()
            },
        )
    };
    for _ in 0..60 {
        free(&mut build(), &mut start, &mut Floor(-0.2, 1.0));
    }
    assert!(start.positions.iter().any(|x| x.z < -0.2));
    let [one, other] = [1.0, 0.0].map(|fraction| {
        let mut state = start.clone();
        (
            free(&mut build(), &mut state, &mut Floor(-0.2, fraction)),
            state,
        )
    });
    println!("{} and {} iterations", one.0, other.0);
    assert!(other.0 <= one.0 + 2, "{} but {} iterations", other.0, one.0);
    let apart = one
        .1
        .positions
        .iter()
        .zip(&other.1.positions)
        .map(|(a, b)| (a - b).norm());
    assert!(apart.fold(0.0, Real::max) < 1e-9);
}

/// A sheet of which one edge jumps by six cells folds up behind it, and the pairs of L-BFGS do not follow: half of 600
/// iterations do not end the step. Newton's method does in 75 after as many. A number of iterations stays what it is.
#[test]
fn directions_are_those_of_newtons_method_after_half_of_the_iterations() {
    let (mut model, rest) = sheet(33, 1e4);
    let edge = 0..33;
    for v in edge.clone() {
        model.particles.prescribe(v).unwrap();
    }
    let step = |iterations: Option<u32>, most_iterations: u32| {
        let mut state = rest.clone();
        for v in edge.clone() {
            state.velocities[v].y = 0.2 / DT;
        }
        let config = PdConfig {
            iterations,
            most_iterations,
            velocity_tolerance: 1e-3,
            ..PdConfig::default()
        };
        solver(&model, config).step(&mut state, falling()).unwrap()
    };
    for most in [150, 600] {
        let report = step(None, most);
        assert_eq!(report.unfinished, 0, "of {most}");
        assert!(report.iterations > most / 2, "{}", report.iterations);
        assert!(report.linear_iterations > 0);
    }
    let report = step(Some(200), 300);
    assert_eq!((report.iterations, report.linear_iterations), (200, 0));
}

#[test]
fn the_report_counts_one_solve_an_iteration() {
    let (model, mut state) = hanging(5, 1e4);
    let report = solver(&model, iterations(7))
        .step(&mut state, falling())
        .unwrap();
    assert_eq!(
        (report.iterations, report.linear_solves, report.backtracks),
        (7, 7, 0)
    );
    assert_eq!(report.residual, None);
}

#[cfg(feature = "parallel")]
#[test]
fn threads_do_not_change_a_bit() {
    let (model, mut start) = hanging(128, 1e4);
    shake(&model, &mut start, 0.002);
    let run = |threads, acceleration| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        let mut state = start.clone();
        let config = PdConfig {
            tolerance: Some(1e-9),
            // Chebyshev's method extrapolates from the fourth on.
            iterations: Some(6),
            acceleration,
            ..PdConfig::default()
        };
        let mut solver = coarse_solver(&model, &start.positions, config);
        let residual = pool.install(|| {
            solver.step(&mut state, falling()).unwrap();
            solver.step(&mut state, falling()).unwrap().residual
        });
        (state, residual)
    };
    let plain = Acceleration::None;
    let chebyshev = Acceleration::Chebyshev {
        spectral_radius: None,
    };
    let quasi_newton = Acceleration::QuasiNewton { history: 5 };
    for acceleration in [plain, chebyshev, quasi_newton] {
        let one = run(1, acceleration);
        assert!(one == run(2, acceleration) && one == run(4, acceleration));
    }
}

#[test]
fn an_error_leaves_the_state_as_it_was() {
    let (model, start) = hanging(5, 1e4);
    let mut solver = solver(&model, iterations(3));
    let mut refuse = |state: &State, input: StepInput<'_>| {
        let mut after = state.clone();
        let error = solver.step(&mut after, input).unwrap_err();
        // NaN is not equal to itself; the text of it is.
        assert_eq!(format!("{after:?}"), format!("{state:?}"));
        error
    };
    for dt in [0.0, -DT, Real::NAN, Real::INFINITY] {
        assert!(matches!(
            refuse(&start, input_of(dt)),
            StepError::InvalidTimeStep { .. }
        ));
    }
    let mut bad = start.clone();
    bad.positions[3].y = Real::NAN;
    let vertex = Some(3);
    assert_eq!(
        refuse(&bad, falling()),
        StepError::NonFiniteInput {
            what: "the state",
            vertex
        }
    );
    let mut load = vec![Vec3::zeros(); 25];
    load[7].x = Real::INFINITY;
    let vertex = Some(7);
    assert_eq!(
        refuse(&start, falling().load(&load)),
        StepError::NonFiniteInput {
            what: "the load",
            vertex
        }
    );
    load[7].x = 1e308;
    assert!(matches!(
        refuse(&start, falling().load(&load)),
        StepError::NonFinite { step: 1, .. }
    ));
    // M/Δt² is infinite.
    let expected = StepError::NotPositiveDefinite {
        iteration: 1,
        step: 1,
    };
    assert_eq!(refuse(&start, input_of(1e-200)), expected);

    let (mut after, mut by_new) = (start.clone(), start);
    assert_eq!(
        solver.step(&mut after, falling()).unwrap().factorizations,
        1
    );
    self::solver(&model, iterations(3))
        .step(&mut by_new, falling())
        .unwrap();
    assert_eq!(after, by_new);
}

#[test]
fn a_singular_matrix_is_reported() {
    let (model, mut state) = sheet(5, 1e4);
    let before = state.clone();
    // M/Δt² is zero.
    let error = solver(&model, iterations(3)).step(&mut state, StepInput::new(1e200));
    match error {
        Err(StepError::NotPositiveDefinite { .. }) => {}
        other => panic!("{other:?}"),
    }
    assert_eq!(state, before);
}

#[test]
fn what_cannot_be_built_is_refused() {
    let particles = Particles::new(vec![1.0; 3]).unwrap();
    let spring = Spring {
        vertices: [0, 1],
        rest_length: 1.0,
        stiffness: 5.0,
    };
    let build = |spring, config| {
        PdSolver::builder(&particles)
            .energy(vec![spring])
            .config(config)
            .build()
    };
    let refused = |spring, config: PdConfig| match build(spring, config) {
        Err(BuildError::OutOfRange(OutOfRange { name, .. })) => name,
        other => panic!("{other:?}"),
    };
    let config = PdConfig::default();
    assert_eq!(refused(spring, iterations(0)), "iterations");
    for tolerance in [-1.0, Real::NAN, Real::INFINITY] {
        assert_eq!(
            refused(
                spring,
                PdConfig {
                    tolerance: Some(tolerance),
                    ..config
                }
            ),
            "tolerance"
        );
    }
    for stiffness in [-1.0, Real::NAN, Real::INFINITY] {
        let bad = Spring {
            stiffness,
            ..spring
        };
        let error = build(bad, config).unwrap_err();
        let is_named = matches!(
            error,
            BuildError::InvalidElement {
                kind: "Spring",
                family: Some(0),
                element: 0,
                ..
            }
        );
        assert!(is_named, "{error}");
    }
    let outside = Spring {
        vertices: [0, 3],
        ..spring
    };
    let expected = BuildError::NoSuchVertex {
        kind: "Spring",
        family: Some(0),
        element: 0,
        vertex: 3,
        vertex_count: 3,
    };
    assert_eq!(build(outside, config).unwrap_err(), expected);
    assert!(build(spring, config).is_ok());
}

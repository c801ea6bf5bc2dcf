//! Cloth that changes between two steps.

use crate::cloth::{DT, GRAVITY, distance, falling, hanging, noise};
use cloth_core::cloth::ClothModel;
use cloth_core::energy::Attachment;
use cloth_core::math::{Real, Vec3};
use cloth_core::measure::linear_momentum;
use cloth_core::particles::State;
use cloth_core::pin::Pins;
use cloth_core::step::{StepInput, StepReport, Stepper};
use cloth_pd::{Acceleration, ChangeError, PdConfig, PdSolver};

const SIDE: usize = 15;

fn configs() -> [PdConfig; 3] {
    let chebyshev = Acceleration::Chebyshev {
        spectral_radius: Some(0.9),
    };
    [
        PdConfig::plain(),
        // Ten iterations: what rounding makes of them is 1e-9 m, and ten times that after 40.
        PdConfig {
            iterations: Some(10),
            ..PdConfig::default()
        },
        PdConfig {
            acceleration: chebyshev,
            ..PdConfig::default()
        },
    ]
}

fn build(model: &ClothModel, ties: &[Attachment], rest: &[Vec3], config: PdConfig) -> PdSolver {
    PdSolver::builder(&model.particles)
        .energy(model.springs.clone())
        .energy(model.hinges.clone())
        .energy(ties.to_vec())
        .coarse_grid(rest, 4)
        .config(config)
        .build()
        .unwrap()
}

/// A cloth that is changed twice: a solver that goes along, and the description that a new solver is built from.
struct Changing {
    model: ClothModel,
    ties: Vec<Attachment>,
    rest: Vec<Vec3>,
    state: State,
    config: PdConfig,
    solver: PdSolver,
}

impl Changing {
    fn new(config: PdConfig) -> Self {
        let (model, state) = hanging(SIDE, 1e4);
        let rest = state.positions.clone();
        Self {
            solver: build(&model, &[], &rest, config),
            model,
            ties: Vec::new(),
            rest,
            state,
            config,
        }
    }

    /// Takes a step with both solvers, and goes on with the old one's.
    fn step(&mut self, what: &str) -> StepReport {
        let mut expected = self.state.clone();
        build(&self.model, &self.ties, &self.rest, self.config)
            .step(&mut expected, falling())
            .unwrap();
        let report = self.solver.step(&mut self.state, falling()).unwrap();
        let apart = distance(&self.state.positions, &expected.positions);
        assert!(apart < 1e-9, "{what}, {:?}: {apart:e} m", self.config);
        report
    }

    fn prescribe(&mut self, vertex: usize) {
        self.model.particles.prescribe(vertex).unwrap();
        self.solver.prescribe(vertex).unwrap();
        self.state.velocities[vertex] = Vec3::new(0.1, 0.0, 0.4);
    }

    fn release(&mut self, vertex: usize) {
        self.model.particles.release(vertex).unwrap();
        self.solver.release(vertex).unwrap();
    }
}

#[test]
fn a_changed_solver_steps_as_a_new_one_does() {
    for config in configs() {
        let mut cloth = Changing::new(config);
        assert_eq!(cloth.step("at first").factorizations, 1);
        let mut factorizations = 0;
        cloth.prescribe(100);
        factorizations += cloth.step("one grabbed").factorizations;
        cloth.prescribe(37);
        cloth.release(SIDE * SIDE - 1);
        factorizations += cloth.step("a pin released, another grabbed").factorizations;
        cloth.release(100);
        factorizations += cloth.step("the first released").factorizations;
        let tie = |vertex: u32| Attachment {
            vertex,
            target: Vec3::new(0.1, 0.2, 0.05),
            stiffness: 300.0,
        };
        cloth.ties = vec![tie(50), tie(51), tie(SIDE as u32 * SIDE as u32 - 1)];
        let ids: Vec<_> = cloth
            .ties
            .iter()
            .map(|&tie| cloth.solver.attach(tie).unwrap())
            .collect();
        factorizations += cloth.step("attachments come").factorizations;
        cloth.ties[1].target.x += 0.2;
        cloth
            .solver
            .move_attachment(ids[1], cloth.ties[1].target)
            .unwrap();
        factorizations += cloth.step("one moves").factorizations;
        cloth.ties.remove(0);
        cloth.solver.detach(ids[0]).unwrap();
        factorizations += cloth.step("one goes").factorizations;
        // A spring tears, a spring at a pin, and a hinge.
        for (spring, number) in [(60, 60), (SIDE * (SIDE - 1), SIDE * (SIDE - 1) + 1), (3, 3)] {
            cloth.model.springs.remove(spring);
            cloth.solver.remove(0, number).unwrap();
        }
        cloth.model.hinges.remove(11);
        cloth.solver.remove(1, 11).unwrap();
        factorizations += cloth.step("elements tear").factorizations;
        factorizations += cloth.step("nothing more").factorizations;
        assert!(factorizations <= 2, "{factorizations}");
    }
}

#[test]
fn an_attachment_holds_a_free_cloth_as_in_a_new_solver_and_lets_it_go() {
    for config in configs() {
        let mut cloth = Changing::new(config);
        cloth.release(SIDE * (SIDE - 1));
        cloth.release(SIDE * SIDE - 1);
        cloth.step("free");
        let tie = Attachment {
            vertex: 7,
            target: cloth.rest[7],
            stiffness: 1e3,
        };
        cloth.ties.push(tie);
        let id = cloth.solver.attach(tie).unwrap();
        cloth.step("held");
        cloth.step("held still");
        cloth.ties.clear();
        cloth.solver.detach(id).unwrap();
        let before = linear_momentum(&cloth.model.particles, &cloth.state.velocities);
        cloth.step("let go");
        let gained = linear_momentum(&cloth.model.particles, &cloth.state.velocities) - before;
        let mass: Real = cloth.model.particles.mass().iter().sum();
        assert!(
            (gained - GRAVITY * (mass * DT)).norm() < 1e-12,
            "{config:?}: {gained}"
        );
    }
}

#[test]
fn a_small_change_is_not_worth_a_factorisation_and_a_large_one_is() {
    let mut cloth = Changing::new(PdConfig::plain());
    cloth.step("at first");
    cloth.prescribe(7);
    assert_eq!(cloth.step("one").factorizations, 0);
    for vertex in 0..100 {
        cloth.prescribe(vertex);
    }
    assert_eq!(cloth.step("a hundred").factorizations, 1);
    assert_eq!(cloth.step("nothing more").factorizations, 0);
    // The correction for a change that stays is paid for in every solve; at some time a factorisation has been paid.
    cloth.prescribe(150);
    let reports: Vec<u32> = (0..200)
        .map(|_| {
            let report = cloth.solver.step(&mut cloth.state, falling()).unwrap();
            report.factorizations
        })
        .collect();
    assert_eq!(reports[0], 0);
    assert_eq!(reports.iter().sum::<u32>(), 1, "{reports:?}");
}

#[test]
fn a_dragged_pin_or_attachment_never_factorises() {
    for config in configs() {
        let (mut model, mut state) = hanging(9, 1e4);
        let mut pins = Pins::new();
        let path = |t: Real| Vec3::new(0.5 + 0.2 * (9.0 * t).sin(), 0.5, 0.3 * t);
        pins.add_path(&mut model.particles, 40, path).unwrap();
        let rest = state.positions.clone();
        let mut solver = build(&model, &[], &rest, config);
        let id = solver
            .attach(Attachment {
                vertex: 4,
                target: rest[4],
                stiffness: 100.0,
            })
            .unwrap();
        let mut factorizations = 0;
        for step in 0..100 {
            pins.set_velocities(&mut state, DT).unwrap();
            let target = rest[4] + Vec3::z() * (0.001 * Real::from(step));
            solver.move_attachment(id, target).unwrap();
            let input = StepInput::new(DT).gravity(GRAVITY);
            factorizations += solver.step(&mut state, input).unwrap().factorizations;
        }
        assert_eq!(factorizations, 1);
        assert!((state.positions[40] - path(100.0 * DT)).norm() < 1e-13);
    }
}

/// The bending of thin cloth is no part of the matrix of the old solver; where it is all that holds a vertex, it is
/// part of that of a new one.
#[test]
fn what_hangs_on_hinges_alone_ends_where_it_does_with_the_whole_matrix() {
    let mut cloth = Changing::new(PdConfig {
        iterations: Some(20_000),
        tolerance: Some(1e-11),
        ..PdConfig::default()
    });
    // A vertex inside, and a row that parts the cloth.
    let at_the_cut = |v: &u32| *v == 112 || (45..60).contains(v);
    for number in (0..cloth.model.springs.len()).rev() {
        if cloth.model.springs[number].vertices.iter().any(at_the_cut) {
            cloth.model.springs.remove(number);
            cloth.solver.remove(0, number).unwrap();
        }
    }
    for _ in 0..5 {
        let report = cloth.step("cut");
        assert!(report.residual.unwrap() <= 1e-11, "{report:?}");
    }
}

#[test]
fn a_cloth_torn_apart_falls_in_pieces() {
    // Every spring and hinge of one corner vertex.
    let mut cloth = Changing::new(PdConfig::default());
    let corner = 0;
    for number in (0..cloth.model.springs.len()).rev() {
        if cloth.model.springs[number].vertices.contains(&corner) {
            cloth.model.springs.remove(number);
            cloth.solver.remove(0, number).unwrap();
        }
    }
    for number in (0..cloth.model.hinges.len()).rev() {
        if cloth.model.hinges[number].vertices.contains(&corner) {
            cloth.model.hinges.remove(number);
            cloth.solver.remove(1, number).unwrap();
        }
    }
    for step in 1..=10 {
        cloth.step("torn");
        let fall = GRAVITY * (DT * DT * Real::from(step * (step + 1)) / 2.0);
        let error = cloth.state.positions[0] - cloth.rest[0] - fall;
        assert!(error.norm() < 1e-12, "step {step}: {:e} m", error.norm());
    }
}

#[test]
fn many_random_changes_stay_those_of_a_new_solver() {
    let mut cloth = Changing::new(PdConfig::default());
    let draws = noise(40);
    let vertex = |x: Real| ((x * 0.5 + 0.5) * (SIDE * SIDE) as Real) as usize % (SIDE * SIDE);
    for draw in draws {
        for x in [draw.x, draw.y] {
            let vertex = vertex(x);
            if cloth.model.particles.is_prescribed(vertex) {
                cloth.release(vertex);
            } else {
                cloth.prescribe(vertex);
                cloth.state.velocities[vertex] = Vec3::zeros();
            }
        }
        cloth.step("random");
    }
}

#[test]
fn changes_that_make_no_sense_are_refused() {
    let mut cloth = Changing::new(PdConfig::default());
    let vertex = SIDE * SIDE;
    let refused = Err(ChangeError::NoSuchVertex { vertex });
    assert_eq!(cloth.solver.prescribe(vertex), refused);
    assert_eq!(cloth.solver.release(vertex), refused);
    let tie = Attachment {
        vertex: vertex as u32,
        target: Vec3::zeros(),
        stiffness: 1.0,
    };
    assert!(cloth.solver.attach(tie).is_err());
    for stiffness in [0.0, -1.0, 1e13, Real::NAN, Real::INFINITY] {
        let tie = Attachment {
            vertex: 1,
            stiffness,
            ..tie
        };
        assert!(cloth.solver.attach(tie).is_err());
    }
    let id = cloth
        .solver
        .attach(Attachment { vertex: 1, ..tie })
        .unwrap();
    let nowhere = Vec3::repeat(Real::NAN);
    assert!(cloth.solver.move_attachment(id, nowhere).is_err());
    cloth.solver.detach(id).unwrap();
    assert_eq!(cloth.solver.detach(id), Err(ChangeError::NoSuchAttachment));
    // The name of one that is gone is not that of the next.
    let next = cloth
        .solver
        .attach(Attachment { vertex: 2, ..tie })
        .unwrap();
    let moved = |solver: &mut PdSolver, id| solver.move_attachment(id, Vec3::zeros());
    assert_eq!(
        moved(&mut cloth.solver, id),
        Err(ChangeError::NoSuchAttachment)
    );
    assert_eq!(moved(&mut cloth.solver, next), Ok(()));
    let (family, element) = (0, 5);
    cloth.solver.remove(family, element).unwrap();
    let gone = Err(ChangeError::NoSuchElement { family, element });
    assert_eq!(cloth.solver.remove(family, element), gone);
    assert!(cloth.solver.remove(2, 0).is_err());
    assert!(cloth.solver.remove(9, 0).is_err());
}

//! What all position-based methods get from their common ground, seen through the simplest of them: every row is made
//! zero, every time.

mod contact;

use cloth_core::element::{Constraint, Element, Row};
use cloth_core::energy::{Attachment, Spring};
use cloth_core::error::OutOfRange;
use cloth_core::math::{Real, Vec3};
use cloth_core::measure::{angular_momentum, linear_momentum};
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{Diagonals, grid};
use cloth_core::method::position_based::{
    Acceleration, ConstraintUpdate, Families, FamilyPlans, Motion, RowEquation, RowState, Sweep,
    check_counts,
};
use cloth_core::particles::{Particles, State};
use cloth_core::pin::Pins;
use cloth_core::step::{BuildError, Observer, StepError, StepInput, StepReport};
use cloth_core::topology::EdgeTable;

const GRAVITY: Vec3 = Vec3::new(0.0, 0.0, -9.81);

/// `Δλ = −C/w̃`, and a count of the visits.
#[derive(Clone, Copy, Debug)]
struct Rigid;

impl ConstraintUpdate for Rigid {
    type Memory = u32;

    fn equation(&self, row: RowState, visits: &mut u32) -> RowEquation {
        *visits += 1;
        RowEquation {
            residual: row.value,
            scaled_compliance: 0.0,
        }
    }
}

#[derive(Clone, Copy, Debug)]
struct TestSettings {
    iterations: u32,
    substeps: u32,
    sweep: Sweep,
}

impl Default for TestSettings {
    fn default() -> Self {
        Self {
            iterations: 4,
            substeps: 1,
            sweep: Sweep::Colored,
        }
    }
}

#[derive(Debug)]
struct Solver {
    settings: TestSettings,
    motion: Motion,
    families: Families<Rigid>,
}

struct Builder {
    settings: TestSettings,
    motion: Motion,
    plans: FamilyPlans<Rigid>,
}

impl Builder {
    fn new(particles: &Particles) -> Self {
        Self {
            settings: TestSettings::default(),
            motion: Motion::new(particles),
            plans: FamilyPlans::default(),
        }
    }

    fn energy<const N: usize, E: Constraint<N>>(mut self, elements: Vec<E>) -> Self {
        self.plans.add(elements);
        self
    }

    fn config(mut self, settings: TestSettings) -> Self {
        self.settings = settings;
        self
    }

    fn build(self) -> Result<Solver, BuildError> {
        let Self {
            settings,
            motion,
            plans,
        } = self;
        check_counts(settings.iterations, settings.substeps)?;
        let count = motion.vertex_count();
        Ok(Solver {
            families: plans.build(count, settings.sweep, Acceleration::default())?,
            settings,
            motion,
        })
    }
}

impl Solver {
    fn step(
        &mut self,
        state: &mut State,
        mut input: StepInput<'_>,
    ) -> Result<StepReport, StepError> {
        self.motion.begin(state, &mut input)?;
        let h = input.dt / Real::from(self.settings.substeps);
        for _ in 0..self.settings.substeps {
            self.motion.predict(&mut input, h)?;
            for _ in 0..self.settings.iterations {
                self.motion
                    .iterate(&mut input, |w, x| self.families.sweep(&Rigid, w, x));
            }
            self.motion.update_velocities(&mut input)?;
        }
        self.motion.finish(state, &mut input)
    }
}

fn sheet(n: usize) -> TriMesh {
    grid(n, n, 1.0, 1.0, Diagonals::Alternating).unwrap()
}

fn springs(mesh: &TriMesh) -> Vec<Spring> {
    Spring::along(
        mesh.positions(),
        EdgeTable::build(mesh).unwrap().ends(),
        1.0,
    )
}

fn uneven_masses(count: usize) -> Particles {
    Particles::new((0..count).map(|i| 0.01 + 0.003 * (i % 5) as Real).collect()).unwrap()
}

fn link(a: u32, b: u32) -> Spring {
    Spring {
        vertices: [a, b],
        rest_length: 1.0,
        stiffness: 1.0,
    }
}

/// A sheet pulled out of shape, in motion.
fn shaken(mesh: &TriMesh) -> State {
    let wave = |v: usize, a: Real| (a * v as Real).sin();
    let mut state = State::at_rest(mesh.positions().to_vec());
    for (v, x) in state.positions.iter_mut().enumerate() {
        *x += Vec3::new(wave(v, 1.7), wave(v, 2.3), wave(v, 0.9)) * 0.02;
    }
    for (v, velocity) in state.velocities.iter_mut().enumerate() {
        *velocity = Vec3::new(wave(v, 0.3), wave(v, 3.1), wave(v, 5.7));
    }
    state
}

#[test]
fn a_falling_sheet_keeps_its_shape_and_falls_as_the_law_says() {
    let mesh = sheet(20);
    let springs = springs(&mesh);
    for (substeps, steps) in [(1_u32, 60_u32), (5, 60)] {
        let settings = TestSettings {
            substeps,
            ..TestSettings::default()
        };
        let builder = Builder::new(&uneven_masses(mesh.vertex_count()));
        let mut solver = builder
            .energy(springs.clone())
            .config(settings)
            .build()
            .unwrap();
        let mut state = State::at_rest(mesh.positions().to_vec());
        let dt = 1.0 / 60.0;
        for _ in 0..steps {
            solver
                .step(&mut state, StepInput::new(dt).gravity(GRAVITY))
                .unwrap();
        }
        let (h, n) = (dt / Real::from(substeps), Real::from(steps * substeps));
        let fallen = GRAVITY.z * h * h * n * (n + 1.0) / 2.0;
        for (x, rest) in state.positions.iter().zip(mesh.positions()) {
            let error = (x - rest - Vec3::new(0.0, 0.0, fallen)).norm();
            assert!(error < 1e-13, "{substeps} substeps: {error:e} m");
        }
        for s in &springs {
            let [a, b] = s.vertices.map(|v| state.positions[v as usize]);
            assert!(((a - b).norm() - s.rest_length).abs() < 1e-14);
        }
        assert_eq!(state.steps, u64::from(steps));
        assert!((state.time - 1.0).abs() < 1e-14);
    }
}

#[test]
fn linear_momentum_is_conserved_to_round_off() {
    let mesh = sheet(12);
    let particles = uneven_masses(mesh.vertex_count());
    let builder = Builder::new(&particles).energy(springs(&mesh));
    let mut solver = builder.build().unwrap();
    let mut state = shaken(&mesh);
    let before = linear_momentum(&particles, &state.velocities);
    for _ in 0..100 {
        solver.step(&mut state, StepInput::new(0.01)).unwrap();
    }
    let change = (linear_momentum(&particles, &state.velocities) - before).norm();
    assert!(change < 1e-13, "{change:e} kg m/s");
}

/// The moment of each correction about the positions that it meets is zero, so from rest nothing starts to spin
/// as long as the direction of a spring does not change: one spring.
#[test]
fn a_spring_released_from_rest_does_not_start_to_spin() {
    let particles = Particles::new(vec![0.3, 1.7]).unwrap();
    let builder = Builder::new(&particles).energy(vec![link(0, 1)]);
    let mut solver = builder.build().unwrap();
    let mut state = State::at_rest(vec![Vec3::new(3.0, 1.0, 2.0), Vec3::new(4.0, 3.0, 0.5)]);
    solver.step(&mut state, StepInput::new(0.01)).unwrap();
    assert!(state.velocities[0].norm() > 1.0);
    let momentum = angular_momentum(&particles, &state).norm();
    assert!(momentum < 1e-13, "{momentum:e} kg m²/s");
}

#[test]
fn the_angular_momentum_that_is_lost_is_of_the_order_of_the_step() {
    let particles = Particles::new(vec![1.0, 1.0]).unwrap();
    let lost = |steps: u32| {
        let builder = Builder::new(&particles).energy(vec![link(0, 1)]);
        let mut solver = builder.build().unwrap();
        let mut state = State::at_rest(vec![Vec3::new(0.5, 0.0, 0.0), Vec3::new(-0.5, 0.0, 0.0)]);
        state.velocities = vec![Vec3::new(0.0, 0.5, 0.0), Vec3::new(0.0, -0.5, 0.0)];
        for _ in 0..steps {
            solver
                .step(&mut state, StepInput::new(1.0 / Real::from(steps)))
                .unwrap();
        }
        0.5 - angular_momentum(&particles, &state).z
    };
    let ratio = lost(1000) / lost(2000);
    assert!((ratio - 2.0).abs() < 0.01, "{ratio}");
    // One step takes the angle φ per step to φ − φ³ (to that order): at 1 rad/s the loss is h per unit of time.
    assert!((lost(2000) / 0.5 - 1.0 / 2000.0).abs() < 1e-6);
}

#[test]
fn pins_hold_to_the_last_bit_and_moving_ones_follow_their_path() {
    let mesh = sheet(9);
    let mut particles = uneven_masses(mesh.vertex_count());
    particles.prescribe(0).unwrap();
    let mut pins = Pins::new();
    let path = |t: Real| Vec3::new(1.0 - 0.2 * t, 0.1 * t * t, (3.0 * t).sin() * 0.1);
    pins.add_path(&mut particles, 8, path).unwrap();
    let settings = TestSettings {
        substeps: 3,
        ..TestSettings::default()
    };
    let builder = Builder::new(&particles)
        .energy(springs(&mesh))
        .config(settings);
    let mut solver = builder.build().unwrap();
    let mut state = shaken(&mesh);
    state.velocities[0] = Vec3::zeros();
    state.positions[8] = path(0.0);
    let held = state.positions[0];
    for _ in 0..50 {
        pins.set_velocities(&mut state, 0.01).unwrap();
        let velocity = state.velocities[8];
        solver
            .step(&mut state, StepInput::new(0.01).gravity(GRAVITY))
            .unwrap();
        assert_eq!(state.positions[0], held);
        assert_eq!(state.velocities[0], Vec3::zeros());
        assert_eq!(state.velocities[8], velocity);
        assert!((state.positions[8] - path(state.time)).norm() < 1e-15);
    }
}

#[test]
fn a_force_accelerates_by_its_mass_and_not_the_prescribed() {
    let mut particles = Particles::new(vec![2.0, 4.0, 1.0]).unwrap();
    particles.prescribe(2).unwrap();
    let mut solver = Builder::new(&particles).build().unwrap();
    let mut state = State::at_rest(vec![Vec3::zeros(); 3]);
    let load = [Vec3::new(1.0, 0.0, 0.0); 3];
    solver
        .step(&mut state, StepInput::new(0.5).load(&load))
        .unwrap();
    assert_eq!(
        state.velocities.iter().map(|v| v.x).collect::<Vec<_>>(),
        [0.25, 0.125, 0.0]
    );
    assert_eq!(
        state.positions.iter().map(|x| x.x).collect::<Vec<_>>(),
        [0.125, 0.0625, 0.0]
    );
}

#[test]
fn bad_input_is_refused_and_the_state_left_alone() {
    let particles = uneven_masses(2);
    let mut solver = Builder::new(&particles)
        .energy(vec![link(0, 1)])
        .build()
        .unwrap();
    let good = State::at_rest(vec![Vec3::zeros(), Vec3::new(1.5, 0.0, 0.0)]);
    for dt in [0.0, -0.01, Real::NAN, Real::INFINITY] {
        let mut state = good.clone();
        let error = solver.step(&mut state, StepInput::new(dt)).unwrap_err();
        assert!(matches!(error, StepError::InvalidTimeStep { .. }));
        assert_eq!(state, good);
    }
    for time in [Real::NAN, Real::INFINITY] {
        let mut late = good.clone();
        late.time = time;
        let error = solver.step(&mut late, StepInput::new(0.01)).unwrap_err();
        let named = format!("the time of the state is {time} s");
        assert!(error.to_string().starts_with(&named), "{error}");
        assert_eq!((late.positions, late.steps), (good.positions.clone(), 0));
    }
    let mut broken = good.clone();
    broken.velocities[1].y = Real::NAN;
    let error = solver.step(&mut broken, StepInput::new(0.01)).unwrap_err();
    let what = "the state";
    let vertex = Some(1);
    assert_eq!(error, StepError::NonFiniteInput { what, vertex });
    assert!(broken.velocities[1].y.is_nan() && broken.steps == 0);
    // Finite going in, not coming out.
    let mut wild = good;
    wild.velocities[1].x = 1e308;
    let kept = wild.clone();
    let error = solver.step(&mut wild, StepInput::new(10.0)).unwrap_err();
    assert_eq!(error, StepError::NonFinite { vertex: 0, step: 1 });
    assert_eq!(wild, kept);
    // And it still works.
    solver.step(&mut wild, StepInput::new(1e-308)).unwrap();
}

#[test]
fn elements_of_vertices_that_do_not_exist_and_no_iterations_are_refused() {
    let particles = uneven_masses(2);
    for sweep in [Sweep::Sequential, Sweep::Colored] {
        let settings = TestSettings {
            sweep,
            ..TestSettings::default()
        };
        let builder = Builder::new(&particles).energy(vec![link(0, 1), link(1, 2)]);
        let error = builder.config(settings).build().unwrap_err();
        let no_such_vertex = BuildError::NoSuchVertex {
            kind: "Spring",
            family: Some(0),
            element: 1,
            vertex: 2,
            vertex_count: 2,
        };
        assert_eq!(error, no_such_vertex);
    }
    for (iterations, substeps) in [(0, 1), (1, 0)] {
        let settings = TestSettings {
            iterations,
            substeps,
            sweep: Sweep::Colored,
        };
        let error = Builder::new(&particles)
            .config(settings)
            .build()
            .unwrap_err();
        assert!(matches!(
            error,
            BuildError::OutOfRange(OutOfRange { value: 0.0, .. })
        ));
    }
}

/// Two rows of one element at 45°, so that the second has to know what the first one did.
#[derive(Clone, Copy, Debug)]
struct Corner(u32);

impl Element<1> for Corner {
    fn vertices(&self) -> [u32; 1] {
        [self.0]
    }
}

impl Constraint<1> for Corner {
    type Rows = [Row<1>; 2];

    fn rows(&self, x: &[Vec3; 1]) -> [Row<1>; 2] {
        let directions = [Vec3::new(1.0, 0.0, 0.0), Vec3::new(1.0, 1.0, 0.0)];
        directions.map(|d| Row {
            value: d.dot(&x[0]),
            gradient: [d],
            stiffness: 1.0,
        })
    }
}

#[test]
fn a_later_row_of_an_element_sees_what_the_earlier_ones_moved() {
    let particles = uneven_masses(1);
    let settings = TestSettings {
        iterations: 1,
        ..TestSettings::default()
    };
    let builder = Builder::new(&particles).energy(vec![Corner(0)]);
    let mut solver = builder.config(settings).build().unwrap();
    let mut state = State::at_rest(vec![Vec3::new(1.0, 3.0, 0.0)]);
    solver.step(&mut state, StepInput::new(1.0)).unwrap();
    // To x = 0, then at right angles to x + y = 0.
    let error = state.positions[0] - Vec3::new(-1.5, 1.5, 0.0);
    assert!(error.norm() < 1e-15, "{error}");
}

#[derive(Default)]
struct Log(Vec<(u32, Real)>);

impl Observer for Log {
    fn iteration(&mut self, iteration: u32, positions: &[Vec3]) {
        self.0.push((iteration, positions[0].x));
    }
}

#[test]
fn the_observer_sees_every_iteration_of_every_substep() {
    let particles = uneven_masses(1);
    let settings = TestSettings {
        iterations: 2,
        substeps: 3,
        sweep: Sweep::Sequential,
    };
    let mut solver = Builder::new(&particles).config(settings).build().unwrap();
    let mut state = State::at_rest(vec![Vec3::zeros()]);
    state.velocities[0].x = 1.0;
    let mut log = Log::default();
    let input = StepInput::new(3.0).observer(&mut log);
    let report = solver.step(&mut state, input).unwrap();
    assert_eq!(report.iterations, 6);
    let seen = [(1, 1.0), (2, 1.0), (3, 2.0), (4, 2.0), (5, 3.0), (6, 3.0)];
    assert_eq!(log.0, seen);
    // Counted from 1 in each step.
    let mut log = Log::default();
    let input = StepInput::new(3.0).observer(&mut log);
    assert_eq!(solver.step(&mut state, input).unwrap().iterations, 6);
    assert_eq!(log.0[0], (1, 4.0));
}

#[test]
fn memory_comes_back_in_input_order_and_is_forgotten_on_request() {
    let particles = uneven_masses(4);
    let attachments = [3, 1, 2, 0].map(|vertex| Attachment {
        vertex,
        target: Vec3::zeros(),
        stiffness: 1.0,
    });
    let builder = Builder::new(&particles)
        .energy(vec![link(0, 1), link(1, 2), link(0, 1)])
        .energy(attachments.to_vec());
    let mut solver = builder.build().unwrap();
    let mut state = State::at_rest(vec![Vec3::zeros(); 4]);
    solver.step(&mut state, StepInput::new(1.0)).unwrap();
    let mut visits = Vec::new();
    solver
        .families
        .read_memory(0, &mut visits, |memory| *memory);
    assert_eq!(visits, [4; 3]);
    solver
        .families
        .read_memory(1, &mut visits, |memory| *memory);
    assert_eq!(visits, [4; 12]);
    solver.families.reset();
    solver
        .families
        .read_memory(1, &mut visits, |memory| *memory);
    assert_eq!(visits, [0; 12]);
    let mut values = Vec::new();
    let x: Vec<Vec3> = (0..4).map(|i| Vec3::new(0.0, Real::from(i), 0.0)).collect();
    solver
        .families
        .each_row(&[1.0; 4], &x, |row, _| values.push((row.value, row.weight)));
    assert_eq!(values.len(), 3 + 12);
    assert_eq!(values[0], (0.0, 2.0));
}

#[cfg(feature = "parallel")]
#[test]
fn a_coloured_sweep_gives_the_same_bits_on_any_number_of_threads() {
    // 160 × 160 vertices: 76 000 springs, eight colours, several of them larger than the smallest set worth
    // splitting.
    let mesh = sheet(160);
    let particles = uneven_masses(mesh.vertex_count());
    let run = || {
        let builder = Builder::new(&particles).energy(springs(&mesh));
        let mut solver = builder.build().unwrap();
        let mut state = shaken(&mesh);
        for _ in 0..3 {
            solver.step(&mut state, StepInput::new(0.01)).unwrap();
        }
        state
    };
    let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let one = pool(1).unwrap().install(run);
    for threads in [2, 4] {
        assert!(
            one == pool(threads).unwrap().install(run),
            "{threads} threads"
        );
    }
}

//! The estimate of the stable step, and what happens beyond it.

use crate::{DOWN, chain, hang, oscillator};
use cloth_core::cloth::{BendingElements, Cloth, Discretization, Membrane};
use cloth_core::energy::Spring;
use cloth_core::math::{Real, Vec3};
use cloth_core::measure::kinetic_energy;
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{Diagonals, equilateral, grid};
use cloth_core::method::family::Energies;
use cloth_core::particles::{Particles, State};
use cloth_core::step::{StepError, StepInput, Stepper};
use cloth_core::topology::EdgeTable;
use cloth_massspring::{ExplicitEuler, SymplecticEuler, stable_time_step};

#[test]
fn one_oscillator_is_exact() {
    for omega in [1e-3, 7.0, 1e5] {
        let (particles, springs) = oscillator(omega);
        let energies = Energies::new(1).with(springs).unwrap();
        let dt = stable_time_step(&energies, &particles, &[Vec3::zeros()]).unwrap();
        assert!((dt * omega / 2.0 - 1.0).abs() < 1e-14);
    }
}

#[test]
fn a_chain_has_the_closed_form_of_its_length() {
    // n masses, one end held: ω_max = 2√(k/m) cos(π/(2n + 1)).
    for n in [1, 2, 3, 20, 500] {
        let (particles, springs, positions) = chain(n, 400.0);
        let energies = Energies::new(n + 1).with(springs).unwrap();
        let dt = stable_time_step(&energies, &particles, &positions).unwrap();
        let angle = std::f64::consts::PI / (2 * n + 1) as Real;
        let excess = 2.0 / dt / (40.0 * angle.cos()) - 1.0;
        // The accuracy promised: on the safe side, by 0.05 % at most.
        assert!((-1e-12..5.1e-4).contains(&excess), "{n}: {excess:e}");
    }
}

/// ω_max/√(k/m) of a sheet with springs k on its edges and equal masses.
fn frequency(mesh: &TriMesh) -> Real {
    let edges = EdgeTable::build(mesh).unwrap();
    let springs = Spring::along(mesh.positions(), edges.ends(), 250.0);
    let particles = Particles::new(vec![0.1; mesh.vertex_count()]).unwrap();
    let energies = Energies::new(particles.len()).with(springs).unwrap();
    let dt = stable_time_step(&energies, &particles, mesh.positions()).unwrap();
    2.0 / dt / 50.0
}

#[test]
fn sheets_come_near_the_frequency_of_the_endless_lattice() {
    // A finite lattice is below the endless one, by O(1/n²); 0.5 % at 40 a side.
    let equilateral = frequency(&equilateral(40, 40, 1.0).unwrap()) / 6.0_f64.sqrt();
    assert!((0.995..1.0006).contains(&equilateral), "{equilateral}");
    let right = frequency(&grid(40, 40, 1.0, 1.0, Diagonals::OneWay).unwrap());
    let right = right / (4.0 + 2.0 * 2.0_f64.sqrt()).sqrt();
    assert!((0.995..1.0006).contains(&right), "{right}");
}

#[test]
fn no_stiffness_no_limit() {
    let particles = Particles::new(vec![1.0; 3]).unwrap();
    let x = [Vec3::zeros(), Vec3::x(), Vec3::y()];
    assert_eq!(stable_time_step(&Energies::new(3), &particles, &x), None);
    let (mut pinned, springs, positions) = chain(1, 10.0);
    pinned.prescribe(1).unwrap();
    let energies = Energies::new(2).with(springs).unwrap();
    assert_eq!(stable_time_step(&energies, &pinned, &positions), None);
}

fn symplectic_hang(n: usize) -> (SymplecticEuler, State, Real) {
    let (mesh, model) = hang(n);
    let energies = model.energies().unwrap();
    let stable = stable_time_step(&energies, &model.particles, mesh.positions()).unwrap();
    let builder = SymplecticEuler::builder(&model.particles).energy(model.springs);
    let solver = builder.energy(model.hinges).build().unwrap();
    (solver, State::at_rest(mesh.positions().to_vec()), stable)
}

#[test]
fn a_step_beyond_the_stable_one_is_refused_with_both_numbers() {
    let (mut solver, mut state, stable) = symplectic_hang(9);
    let before = state.clone();
    let error = solver.step(&mut state, StepInput::new(1.01 * stable).gravity(DOWN));
    let frame = solver.step(&mut state, StepInput::new(6.5 * stable).gravity(DOWN));
    let said = frame.unwrap_err().to_string();
    assert!(said.contains("at least 7 times as many substeps"), "{said}");
    let Err(StepError::Unstable {
        dt,
        stable_dt,
        step,
    }) = error
    else {
        panic!("{error:?}")
    };
    assert_eq!((dt, step), (1.01 * stable, 1));
    assert!((stable_dt / stable - 1.0).abs() < 1e-3);
    assert_eq!(state, before);
    solver
        .step(&mut state, StepInput::new(0.9 * stable).gravity(DOWN))
        .unwrap();
}

#[test]
fn a_change_of_the_step_is_noticed() {
    let (mut solver, mut state, stable) = symplectic_hang(9);
    for _ in 0..10 {
        solver
            .step(&mut state, StepInput::new(0.9 * stable))
            .unwrap();
    }
    let error = solver.step(&mut state, StepInput::new(1.5 * stable));
    assert!(
        matches!(error, Err(StepError::Unstable { step: 11, .. })),
        "{error:?}"
    );
}

#[test]
fn a_stable_run_is_never_stopped() {
    let (mut solver, mut state, stable) = symplectic_hang(12);
    for _ in 0..4000 {
        solver
            .step(&mut state, StepInput::new(0.9 * stable).gravity(DOWN))
            .unwrap();
    }
}

#[test]
fn a_spring_that_stiffens_beyond_the_limit_ends_the_run() {
    // At rest a cross of four springs resists with 2k along either axis; pulled out to thrice its length it resists
    // with 2k + 2k·⅔.
    let centre = Vec3::zeros();
    let tips = [Vec3::x(), -Vec3::x(), Vec3::y(), -Vec3::y()];
    let springs: Vec<Spring> = (1..5)
        .map(|tip| Spring {
            vertices: [0, tip],
            rest_length: 1.0,
            stiffness: 100.0,
        })
        .collect();
    let mut particles = Particles::new(vec![1.0; 5]).unwrap();
    (1..5).for_each(|tip| particles.prescribe(tip).unwrap());
    let mut solver = SymplecticEuler::builder(&particles)
        .energy(springs)
        .build()
        .unwrap();
    let mut state = State::at_rest([centre].into_iter().chain(tips).collect());
    for (v, tip) in state.velocities[1..].iter_mut().zip(tips) {
        *v = tip;
    }
    state.velocities[0] = Vec3::new(1e-3, 2e-3, 0.0);
    // 2/√200 = 0.1414 at rest, 2/√333 = 0.1095 when pulled out.
    let end = (0..1000).find_map(|_| solver.step(&mut state, StepInput::new(0.12)).err());
    let Some(StepError::Unstable { dt, stable_dt, .. }) = end else {
        panic!("{end:?}")
    };
    assert!(
        dt == 0.12 && stable_dt < 0.12 && stable_dt > 0.08,
        "{end:?}"
    );
    assert!(state.positions[0].amax() < 1.0, "{:?}", state.positions[0]);
}

#[test]
fn forward_euler_ends_as_unstable_long_before_it_overflows() {
    let (mesh, model) = hang(6);
    let energies = model.energies().unwrap();
    let stable = stable_time_step(&energies, &model.particles, mesh.positions()).unwrap();
    for part in [0.1, 0.5, 0.9] {
        let builder = ExplicitEuler::builder(&model.particles).energy(model.springs.clone());
        let mut solver = builder.build().unwrap();
        let mut state = State::at_rest(mesh.positions().to_vec());
        let end = (0..100_000).find_map(|_| {
            solver
                .step(&mut state, StepInput::new(part * stable).gravity(DOWN))
                .err()
        });
        assert!(
            matches!(end, Some(StepError::Unstable { stable_dt: 0.0, .. })),
            "{end:?}"
        );
        let size = state.positions.iter().map(Vec3::amax).fold(0.0, Real::max);
        assert!(size < 10.0, "{part}: {size}");
    }
}

#[test]
fn rest_stays_at_rest() {
    let (mut solver, mut state, stable) = symplectic_hang(9);
    let before = state.positions.clone();
    for _ in 0..1000 {
        solver
            .step(&mut state, StepInput::new(0.9 * stable))
            .unwrap();
    }
    assert!(crate::largest_difference(&state.positions, &before) < 1e-13);
}

#[test]
fn energy_from_below_zero_is_no_gain() {
    // A cylinder at rest by its cubic shells, whose energy is zero there and falls as the membrane lets go outwards.
    let flat = grid(9, 9, 1.0, 1.0, Diagonals::Alternating).unwrap();
    let rolled = |p: &Vec3| Vec3::new(p.x.sin(), p.y, p.x.cos());
    let positions: Vec<Vec3> = flat.positions().iter().map(rolled).collect();
    let mesh = TriMesh::new(positions, flat.triangles().to_vec()).unwrap();
    let cloth = Cloth {
        areal_density: 0.2,
        membrane: Membrane::SpringStiffness(1e3),
        bending_rigidity: 0.1,
    };
    let discretization = Discretization {
        bending: BendingElements::Cubic,
        ..Discretization::default()
    };
    let model = cloth.discretized_with(&discretization, &mesh).unwrap();
    let energies = model.energies().unwrap();
    let stable = stable_time_step(&energies, &model.particles, mesh.positions()).unwrap();
    let builder = SymplecticEuler::builder(&model.particles).elements(model.families());
    let mut solver = builder.build().unwrap();
    let mut state = State::at_rest(mesh.positions().to_vec());
    let [mut motion, mut gain]: [Real; 2] = [0.0; 2];
    for _ in 0..1000 {
        let input = StepInput::new(0.1 * stable);
        solver.step(&mut state, input).unwrap();
        let kinetic = kinetic_energy(&model.particles, &state.velocities);
        motion = motion.max(kinetic);
        gain = gain.max((kinetic + energies.value(&state.positions)).abs());
    }
    println!("{motion:e} J of motion, {gain:e} J of gain or loss");
    assert!(motion > 1e-6 && gain < 0.1 * motion);
}

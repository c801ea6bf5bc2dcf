//! Steps that would gain energy, against the energy of a run added up from outside, and against runs with more substeps
//! from the start.

#[path = "../../src/refinement.rs"]
#[expect(dead_code, reason = "what a step uses of it")]
mod source;

use crate::sheet::held_sheet;
use cloth_core::cloth::ClothModel;
use cloth_core::math::{Real, Vec3};
use cloth_core::measure::{gravitational_energy, kinetic_energy};
use cloth_core::mesh::TriMesh;
use cloth_core::particles::State;
use cloth_core::step::{StepInput, Stepper};
use cloth_xpbd::{XpbdConfig, XpbdSolver};
use source::Refinement;

const GRAVITY: Vec3 = Vec3::new(0.0, 0.0, -9.81);
const DT: Real = 1.0 / 60.0;

fn solver(model: &ClothModel, substeps: u32, energy_gain: Option<Real>) -> XpbdSolver {
    let config = XpbdConfig {
        substeps,
        energy_gain,
        ..XpbdConfig::default()
    };
    let builder = XpbdSolver::builder(&model.particles).elements(model.families());
    builder.config(config).build().unwrap()
}

fn step(solver: &mut XpbdSolver, state: &mut State) -> u32 {
    let input = StepInput::new(DT).gravity(GRAVITY);
    solver.step(state, input).unwrap().refinements
}

/// The largest sum (J) of all energies of a sheet that is let go where it is flat, relative to the start, the most that
/// gravity has given it, and how often a step was taken again.
fn excess(mesh: &TriMesh, model: &ClothModel, energy_gain: Option<Real>) -> ([Real; 2], u32) {
    let mut solver = solver(model, 20, energy_gain);
    let elastic = model.energies().unwrap();
    let mut state = State::at_rest(mesh.positions().to_vec());
    let (mut most, mut repeats) = ([0.0 as Real; 2], 0);
    for _ in 0..90 {
        repeats += step(&mut solver, &mut state);
        let height = gravitational_energy(&model.particles, &state.positions, GRAVITY);
        let held =
            kinetic_energy(&model.particles, &state.velocities) + elastic.value(&state.positions);
        most = [most[0].max(held + height), most[1].max(-height)];
    }
    (most, repeats)
}

/// With a try with fewer substeps after every calm step, 47 steps would be taken again.
#[test]
fn a_swing_makes_no_more_energy_than_was_accepted() {
    let (mesh, model) = held_sheet(33, 1e4);
    let ([without, given], _) = excess(&mesh, &model, None);
    let ([with, _], repeats) = excess(&mesh, &model, Some(0.01));
    assert!(without > 12.0 * given, "{without} J of {given}");
    assert!(with < 0.008 * given, "{with} J of {given}");
    assert!(repeats <= 25, "{repeats} steps");
}

#[test]
fn a_step_taken_again_is_one_with_more_substeps() {
    let (mesh, model) = held_sheet(17, 1e4);
    let mut refined = solver(&model, 5, Some(0.01));
    let mut state = State::at_rest(mesh.positions().to_vec());
    let mut before = state.clone();
    let doublings = (0..60).find_map(|_| {
        before.clone_from(&state);
        let doublings = step(&mut refined, &mut state);
        (doublings > 0).then_some(doublings)
    });
    let doublings = doublings.expect("a step that gains energy");
    // As many doublings as helped: one less would still have gained more than it may.
    let mut plain = solver(&model, 5 << doublings, None);
    step(&mut plain, &mut before);
    assert_eq!(before.positions, state.positions);
    assert_eq!(before.velocities, state.velocities);
}

#[test]
fn a_step_that_gains_nothing_has_the_same_bits_without_the_balance() {
    let (mesh, model) = held_sheet(17, 1e4);
    let mut states = [None, Some(0.01)].map(|gain| {
        let mut solver = solver(&model, 400, gain);
        let mut state = State::at_rest(mesh.positions().to_vec());
        for _ in 0..10 {
            assert_eq!(step(&mut solver, &mut state), 0);
        }
        state
    });
    let [with, without] = &mut states;
    assert_eq!(with.positions, without.positions);
}

/// Doubled by a step that gains, lowered by √2 after good ones; a step that gains with a lowered number goes back
/// to the one before, and one that comes later, with a number that has done well, doubles again.
#[test]
fn a_lowered_number_that_has_done_well_is_doubled_like_any_other() {
    let (calm, gains) = ([1.0, 1.0], [1.0, 1.1]);
    let mut refinement = Refinement::new(0.01);
    assert!(refinement.refines(gains, 0.0));
    assert_eq!(refinement.substeps(100), 200);
    let mut numbers = Vec::new();
    for _ in 0..3 {
        assert!(!refinement.refines(calm, 0.0));
        numbers.push(refinement.substeps(100));
    }
    assert_eq!(numbers, [200, 141, 100]);

    let mut lowered = refinement;
    assert!(lowered.refines(gains, 0.0));
    assert_eq!(lowered.substeps(100), 141);

    assert!(!refinement.refines(calm, 0.0));
    assert!(refinement.refines(gains, 0.0));
    assert_eq!(refinement.substeps(100), 200);
}

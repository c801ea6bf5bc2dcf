//! What the settings guide of the chapter predicts.

use crate::chain::Chain;
use crate::chapter::{GRAVITY, iterations, sheet, solver};
use cloth_core::math::{Real, Vec3};
use cloth_core::measure::{Strain, kinetic_energy};
use cloth_core::particles::State;
use cloth_core::step::{StepInput, Stepper};
use cloth_xpbd::{XpbdConfig, XpbdSolver};
use std::f64::consts::PI;

const DT: Real = 1.0 / 60.0;
const G: Real = 9.81;
const LINKS: u32 = 24;
const LENGTH: Real = 1.0 / 24.0;

/// Substeps for a mean strain, with a tip of `ratio` times the mass of the other vertices.
fn substeps_for(strain: Real, ratio: Real) -> Real {
    let n = Real::from(LINKS);
    let heavier = 1.0 + 2.0 * (ratio - 1.0) / n;
    DT * (G * (n - 1.0) * heavier / (2.0 * LENGTH * strain)).sqrt()
}

/// The mean strain that a number of substeps leaves.
fn strain_of(substeps: u32, ratio: Real) -> Real {
    let part = substeps_for(1.0, ratio) / Real::from(substeps);
    part * part
}

fn once(substeps: u32) -> XpbdConfig {
    XpbdConfig {
        substeps,
        ..iterations(1)
    }
}

#[test]
fn the_substeps_of_the_guide_leave_the_strain_of_the_guide_in_a_chain() {
    for (ratio, wanted, named) in [(1.0, 0.01, 8.7), (1200.0, 0.01, 87.0), (1.0, 1e-3, 27.4)] {
        let substeps = substeps_for(wanted, ratio);
        assert!((substeps / named - 1.0).abs() < 0.01, "{substeps}");
        let substeps = substeps.ceil() as u32;
        let mut chain = Chain::of(LINKS, 0.01, LENGTH, Real::INFINITY);
        chain
            .particles
            .set_mass(LINKS as usize, 0.01 * ratio)
            .unwrap();
        let law = strain_of(substeps, ratio);
        assert!(law <= wanted);
        // A heavy tip takes long to come to rest; from the place that the law gives it must not leave.
        let mut state = chain.at_rest();
        let mut sag = 0.0;
        let h = DT / Real::from(substeps);
        for (i, x) in (1..LINKS).zip(&mut state.positions[1..]) {
            // Link i ends longer by g h² times the mass below vertex i over its own.
            sag += G * h * h * (Real::from(LINKS - i - 1) + ratio);
            x.z -= sag;
        }
        state.positions[LINKS as usize].z -= sag;
        let placed = state.clone();
        let mut solver = solver(&chain, once(substeps));
        for _ in 0..20 {
            let input = StepInput::new(DT).gravity(GRAVITY);
            solver.step(&mut state, input).unwrap();
        }
        let moved = crate::chapter::largest_distance(&state.positions, &placed.positions);
        assert!(moved < 1e-9, "{moved:e} m");
        let strain = -1.0 - state.positions[LINKS as usize].z;
        assert!((strain / law - 1.0).abs() < 1e-6, "{strain} {law}");
    }
}

#[test]
fn iterations_leave_23_times_the_sag_of_as_many_substeps() {
    let chain = Chain::of(LINKS, 0.01, LENGTH, Real::INFINITY);
    let sag = |config| chain.sag_at_rest(&mut solver(&chain, config), DT, 6000);
    let [iterated, cut] = [sag(iterations(LINKS)), sag(once(LINKS))];
    let n = Real::from(LINKS);
    let one_sweep = G * DT * DT * n * (n - 1.0) / 2.0;
    assert!((cut * n * n / one_sweep - 1.0).abs() < 1e-9);
    assert!(
        (0.95..1.0).contains(&(iterated * n / one_sweep)),
        "{}",
        iterated * n / one_sweep
    );
    assert!((iterated - 0.0300).abs() < 1e-4, "{iterated}");
    let decades = Real::ln(100.0) / (-2.0 * (PI / (2.0 * n)).cos().ln());
    assert!((decades - 1074.0).abs() < 1.0, "{decades}");
    assert!(((PI / (2.0 * n)).cos().powf(2.0 * n) - 0.90).abs() < 0.005);
}

/// Rigid springs, coloured sweeps, one per substep: mean strain, the fall of the lowest vertex over 1 m, and
/// the largest strain of an edge.
fn sheet_at_rest(substeps: u32, by_edge: bool) -> (Real, Real) {
    let side = LINKS as usize + 1;
    let (mesh, mut model) = sheet::held_sheet(side, 1.0);
    for spring in &mut model.springs {
        spring.stiffness = Real::INFINITY;
    }
    if by_edge {
        (0..side).for_each(|v| model.particles.prescribe(v).unwrap());
    }
    let config = XpbdConfig {
        substeps,
        iterations: 1,
        ..XpbdConfig::default()
    };
    let builder = XpbdSolver::builder(&model.particles).energy(model.springs.clone());
    let builder = builder.energy(model.hinges.clone()).config(config);
    let mut solver = builder.build().unwrap();
    let mut state = State::at_rest(mesh.positions().to_vec());
    let mut before = 0.0;
    for _ in 0..600 {
        let input = StepInput::new(DT).gravity(Vec3::y() * G);
        solver.step(&mut state, input).unwrap();
        let energy = kinetic_energy(&model.particles, &state.velocities);
        if energy < before {
            state.velocities.fill(Vec3::zeros());
        }
        before = if energy < before { 0.0 } else { energy };
    }
    let lowest = state.positions.iter().map(|x| x.y).fold(0.0, Real::max);
    (
        lowest - 1.0,
        Strain::of(&model.springs, &state.positions).max,
    )
}

#[test]
fn the_guide_is_safe_by_an_edge_and_at_a_third_by_two_corners() {
    for (by_edge, wanted, [least, most], largest) in [
        (true, 0.01, [0.77, 0.80], 4.4),
        (true, 1e-3, [0.77, 0.80], 4.4),
        (false, 3e-3, [2.9, 3.3], 40.0),
    ] {
        let substeps = substeps_for(wanted, 1.0).ceil() as u32;
        let law = strain_of(substeps, 1.0);
        let (mean, worst) = sheet_at_rest(substeps, by_edge);
        println!(
            "{wanted}: {} of the mean, {} in the worst edge",
            mean / law,
            worst / law
        );
        assert!(
            (least..most).contains(&(mean / law)),
            "{wanted}: {}",
            mean / law
        );
        assert!(worst / law < largest, "{wanted}: {}", worst / law);
    }
}

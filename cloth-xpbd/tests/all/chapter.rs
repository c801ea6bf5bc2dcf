//! The claims of the chapter.
//!
//! A solver is right if it meets closed forms. These are used here, and what their tolerances allow for:
//!
//! | closed form | where | tolerance |
//! |---|---|---|
//! | one row ends at `C̃/(1 + k h² w̃)`, whatever k, h and n | here | 1e-13 of it: rounding of C, 1e-16 m |
//! | a hard row is met | here | 3e-16 of a stretch of 2 m: rounding of a length |
//! | hanging chain: sag and tensions of statics | here | 1e-12: converged sweeps, rounding |
//! | its support bears the weight, damped or hard | `forces.rs` | 1e-10: what 400 steps leave of the motion |
//! | a sweep keeps `cos²(π/(2N))` of the error | here | 1e-7: the next eigenvector |
//! | one sweep a substep sags by `g h² N(N − 1)/2` | here | 1e-10: what is left of the motion |
//! | damped row; energy divided by `1 + (hω)²` | `damping.rs` | 1e-11: difference of two lengths |
//! | rows of one element against a dense solve | `rows.rs` | 1e-12 m: rounding |
//! | limits: the minimum of implicit Euler, found independently | `limits.rs` | 1e-14 m: rounding |
//! | force missing at rest goes with h² | `forces.rs` | the order, 2 ± 0.1, from h and h/2 |
//! | momentum in free flight; rigid motion is not damped | `links.rs`, `damping.rs` | rounding |
//! | angular momentum that a free link keeps, `1/√(1 + (ωh)²)`, then `1/√(5 − 4 cos φ)` | `links.rs` | 1e-12: rounding of x over h |
//! | same bits on 1, 2 and 4 threads, and restarted | here | none |
//! | gap to implicit Euler shrinks with h and not with n | here | bounds: there is no closed form |
//!
//! Beside them stand the naive loop (`examples/first_program.rs`, 3e-13 m after 600 substeps), the direct solver
//! against an independent minimiser (`../direct/convergence.rs`), gradients against finite differences (`links.rs`),
//! bad input (`input.rs`) and bad starts (`robustness.rs`). The order in h of a whole motion, one as for backward
//! Euler, has no test of its own here; the energy that a substep loses is met in closed form (`damping.rs`).

use crate::sheet;

mod damping;
mod forces;
mod guide;
mod input;
mod limits;
mod links;
mod robustness;
mod rows;

use crate::chain::Chain;
use cloth_core::energy::{CurvatureHinge, Spring};
use cloth_core::math::{Real, Vec3};
use cloth_core::measure::{IncrementalPotential, predict};
use cloth_core::method::family::Energies;
use cloth_core::method::position_based::Sweep;
use cloth_core::particles::{Particles, State};
use cloth_core::step::{BuildError, StepInput, Stepper};
use cloth_xpbd::{XpbdConfig, XpbdSolver};
use std::f64::consts::PI;

const GRAVITY: Vec3 = Vec3::new(0.0, 0.0, -9.81);

fn iterations(iterations: u32) -> XpbdConfig {
    XpbdConfig {
        iterations,
        substeps: 1,
        sweep: Sweep::Sequential,
        ..XpbdConfig::default()
    }
}

fn solver(chain: &Chain, config: XpbdConfig) -> XpbdSolver {
    let builder = XpbdSolver::builder(&chain.particles).energy(chain.springs.clone());
    builder.config(config).build().unwrap()
}

fn largest_distance(a: &[Vec3], b: &[Vec3]) -> Real {
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b).norm())
        .fold(0.0, Real::max)
}

/// What a step of `h` (s) leaves of a stretch of 2 m of a spring of 1 m between masses of 0.3 and 0.7 kg, as a
/// fraction.
fn fraction_left(k: Real, h: Real, n: u32) -> Real {
    let particles = Particles::new(vec![0.3, 0.7]).unwrap();
    let vertices = [0, 1];
    let spring = Spring {
        vertices,
        rest_length: 1.0,
        stiffness: k,
    };
    let builder = XpbdSolver::builder(&particles).energy(vec![spring]);
    let mut solver = builder.config(iterations(n)).build().unwrap();
    let start = Vec3::new(0.2, -0.1, 0.4);
    let mut state = State::at_rest(vec![start, start + Vec3::new(1.0, 2.0, 2.0)]);
    solver.step(&mut state, StepInput::new(h)).unwrap();
    assert!(solver.compliance_residual(&state.positions) < 1e-15);
    ((state.positions[1] - state.positions[0]).norm() - 1.0) / 2.0
}

#[test]
fn one_constraint_ends_where_implicit_euler_does_at_any_iterations() {
    for k in [0.0, 1e-3, 3.0, 700.0, 2e4] {
        for n in [1, 2, 50] {
            for h in [1.0 / 30.0, 1.0 / 600.0] {
                let left = fraction_left(k, h, n);
                let law = 1.0 / (1.0 + k * h * h * (1.0 / 0.3 + 1.0 / 0.7));
                // The stretch left over is known to some 1e-16 m, however small it is.
                let error = (left - law).abs();
                assert!(error < 1e-13 * law, "k {k}, n {n}, h {h}: {error:e}");
            }
        }
    }
}

#[test]
fn a_hard_constraint_is_met_and_a_stiff_one_nears_it_as_one_over_k() {
    for n in [1, 50] {
        assert!(fraction_left(Real::INFINITY, 0.01, n).abs() < 3e-16);
        let ratio = fraction_left(1e7, 0.01, n) / fraction_left(1e8, 0.01, n);
        assert!((ratio - 10.0).abs() < 0.02, "{ratio}");
        // No overflow on the way.
        assert!(fraction_left(Real::MAX, 0.01, n).abs() < 3e-16);
    }
}

#[test]
fn the_rows_of_a_hinge_follow_the_same_law() {
    let particles = Particles::new(vec![0.1, 0.2, 0.3, 0.4]).unwrap();
    let rest = [[0.0, 0.0], [1.0, 0.0], [0.4, 0.8], [0.5, -0.9]];
    let rest = rest.map(|[x, y]| Vec3::new(x, y, 0.0));
    let hinge = CurvatureHinge::new([0, 1, 2, 3], &rest, 5.0);
    let z = |x: &[Vec3]| -> Vec3 { (0..4).map(|i| x[i] * hinge.coefficients[i]).sum() };
    let weights = (0..4).map(|i| particles.inverse_mass()[i] * hinge.coefficients[i].powi(2));
    let (weight, h): (Real, Real) = (weights.sum(), 0.02);
    let mut state = State::at_rest(rest.to_vec());
    state.positions[2] = Vec3::new(0.4, 0.2, 0.7);
    let law = z(&state.positions) / (1.0 + hinge.stiffness * h * h * weight);
    let builder = XpbdSolver::builder(&particles).energy(vec![hinge]);
    let mut solver = builder.config(iterations(9)).build().unwrap();
    solver.step(&mut state, StepInput::new(h)).unwrap();
    let error = (z(&state.positions) - law).norm() / law.norm();
    assert!(error < 1e-13, "{error:e}");
}

/// With one end fixed and the other free. The error factor is cos²(π/(N + 1)) with both ends free, and
/// cos²(π/(N − 1)) with both fixed.
#[test]
fn a_sweep_leaves_cos_squared_of_the_error_of_a_rigid_chain() {
    for links in [5, 20] {
        let chain = Chain::new(links, Real::INFINITY);
        let sweeps = 3 * links * links / 2;
        let left = chain.stretch_after_each_iteration(&mut solver(&chain, iterations(sweeps)));
        let factor = left[sweeps as usize - 1] / left[sweeps as usize - 2];
        let law = (PI / (2.0 * Real::from(links))).cos().powi(2);
        assert!((factor - law).abs() < 1e-7, "{links}: {factor} {law}");
    }
}

#[test]
fn a_rigid_chain_swept_once_per_substep_sags_by_its_law() {
    let chain = Chain::new(20, Real::INFINITY);
    for substeps in [1, 4] {
        let once = XpbdConfig {
            substeps,
            ..iterations(1)
        };
        let h = 1.0 / 60.0 / Real::from(substeps);
        let law = 9.81 * h * h * 20.0 * 19.0 / 2.0;
        let sag = chain.sag_at_rest(&mut solver(&chain, once), 1.0 / 60.0, 10_000);
        assert!((sag / law - 1.0).abs() < 1e-10, "{:e}", sag / law - 1.0);
    }
}

#[test]
fn a_hanging_chain_has_sag_and_tensions_of_statics_in_any_order() {
    let (n, k, mass) = (6_u32, 50.0, 0.02);
    let chain = Chain::of(n, mass, 0.1, k);
    for sweep in [Sweep::Sequential, Sweep::Colored] {
        let config = XpbdConfig {
            iterations: 200,
            substeps: 2,
            sweep,
            ..XpbdConfig::default()
        };
        let mut solver = solver(&chain, config);
        let sag = chain.sag_at_rest(&mut solver, 0.1, 500);
        let law = Real::from(n * (n + 1)) * mass * 9.81 / (2.0 * k);
        assert!((sag / law - 1.0).abs() < 1e-12, "{:e}", sag / law - 1.0);
        let mut multipliers = Vec::new();
        solver.multipliers_into(0, &mut multipliers);
        for (i, multiplier) in multipliers.iter().enumerate() {
            let tension = -multiplier / (0.05 * 0.05);
            let law = (Real::from(n) - i as Real) * mass * 9.81;
            assert!((tension / law - 1.0).abs() < 1e-12, "{i}: {tension} {law}");
        }
    }
}

/// Stretched out sideways and swinging: the links turn during a step, and with them the gradients.
fn swinging(chain: &Chain) -> State {
    let mut state = chain.at_rest();
    for x in &mut state.positions {
        *x = Vec3::new(-x.z, 0.0, 0.0);
    }
    for (x, v) in state.positions.iter().zip(&mut state.velocities) {
        v.z = -3.0 * x.x * x.x;
    }
    state
}

#[test]
fn converged_sweeps_miss_the_minimiser_of_implicit_euler() {
    let chain = Chain::of(10, 0.1, 0.1, 200.0);
    let energies = Energies::new(chain.particles.len());
    let energies = energies.with(chain.springs.clone()).unwrap();
    let gap = |h: Real, n: u32| {
        let mut state = swinging(&chain);
        let mut predicted = state.positions.clone();
        let input = StepInput::new(h).gravity(GRAVITY);
        predict(&chain.particles, &state, &input, &mut predicted);
        let mut solver = solver(&chain, iterations(n));
        solver.step(&mut state, input).unwrap();
        let residual = solver.compliance_residual(&state.positions);
        assert!(residual < 1e-14, "{residual:e} m");
        let potential = IncrementalPotential {
            particles: &chain.particles,
            energies: &energies,
            predicted: &predicted,
            dt: h,
        };
        let mut gradient = predicted.clone();
        potential.gradient_into(&state.positions, &mut gradient);
        let reached = potential.gradient_norm(&gradient);
        potential.gradient_into(&predicted, &mut gradient);
        reached / potential.gradient_norm(&gradient)
    };
    let (large, small) = (gap(1.0 / 30.0, 4000), gap(1.0 / 480.0, 4000));
    assert!(large > 1e-4, "{large:e}");
    assert!(small < large / 100.0, "{large:e} {small:e}");
    let longer = gap(1.0 / 30.0, 8000);
    assert!((longer / large - 1.0).abs() < 1e-6, "{large:e} {longer:e}");
}

#[test]
fn the_residual_is_that_of_the_multipliers_and_positions_given() {
    let chain = Chain::new(1, 25.0);
    let mut solver = solver(&chain, iterations(1));
    let mut state = chain.at_rest();
    assert_eq!(solver.compliance_residual(&state.positions), 0.0);
    state.positions[1].z = -1.5;
    solver.step(&mut state, StepInput::new(0.2)).unwrap();
    // One link, 1 kg: k h² w = 1, half of the stretch is left, and a spring moved by 0.1 m is wrong by 0.1 m.
    assert!(solver.compliance_residual(&state.positions) < 1e-15);
    state.positions[1].z -= 0.1;
    assert!((solver.compliance_residual(&state.positions) - 0.1).abs() < 1e-15);
    let mut multipliers = Vec::new();
    solver.multipliers_into(0, &mut multipliers);
    assert_eq!(multipliers.len(), 1);
    assert!((multipliers[0] + 0.25).abs() < 1e-15);
}

#[test]
fn coloured_and_sequential_sweeps_agree_only_where_they_converge() {
    let chain = Chain::new(12, 3e4);
    let run = |n, sweep| {
        let config = XpbdConfig {
            sweep,
            ..iterations(n)
        };
        let mut state = chain.at_rest();
        state.positions[7].z += 0.1;
        solver(&chain, config)
            .step(&mut state, StepInput::new(0.01))
            .unwrap();
        state.positions
    };
    let apart = |n| largest_distance(&run(n, Sweep::Sequential), &run(n, Sweep::Colored));
    assert!(apart(2) > 1e-3);
    assert!(apart(3000) < 1e-13);
}

/// In the straight chain above no link turns.
#[test]
fn where_links_turn_the_end_of_converged_sweeps_depends_on_their_order() {
    let chain = Chain::of(10, 0.1, 0.1, 200.0);
    let run = |n, sweep| {
        let config = XpbdConfig {
            sweep,
            ..iterations(n)
        };
        let mut state = swinging(&chain);
        let mut solver = solver(&chain, config);
        let input = StepInput::new(1.0 / 30.0).gravity(GRAVITY);
        solver.step(&mut state, input).unwrap();
        let residual = solver.compliance_residual(&state.positions);
        assert!(residual < 1e-14, "{sweep:?}: {residual:e} m");
        state.positions
    };
    let apart = |n| largest_distance(&run(n, Sweep::Sequential), &run(n, Sweep::Colored));
    let (apart, longer) = (apart(4000), apart(8000));
    assert!(apart > 1e-8, "{apart:e} m");
    assert!((longer / apart - 1.0).abs() < 1e-6, "{apart:e} {longer:e}");
}

#[test]
fn a_cloth_gives_the_same_bits_on_any_threads_and_when_restarted() {
    let (mesh, model) = sheet::held_sheet(150, 1e4);
    let solver = || {
        let builder = XpbdSolver::builder(&model.particles).energy(model.springs.clone());
        builder.energy(model.hinges.clone()).build().unwrap()
    };
    let run = |solvers: u32, steps| {
        let mut state = State::at_rest(mesh.positions().to_vec());
        for _ in 0..solvers {
            sheet::fall(&mut solver(), &mut state, steps);
        }
        state
    };
    let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let one = pool(1).unwrap().install(|| run(1, 4));
    for threads in [2, 4] {
        let more = pool(threads).unwrap().install(|| run(1, 4));
        assert!(one == more, "{threads} threads");
    }
    // A fresh solver for each step: its internal state must not matter.
    assert!(one == run(4, 1));
}

#[test]
fn pinned_and_degenerate_springs_stay_finite() {
    let mut particles = Particles::new(vec![1.0; 4]).unwrap();
    for pinned in [0, 1] {
        particles.prescribe(pinned).unwrap();
    }
    for stiffness in [0.0, 5.0, Real::INFINITY] {
        let spring = |(vertices, rest_length)| Spring {
            vertices,
            rest_length,
            stiffness,
        };
        let springs = [([0, 1], 9.0), ([1, 2], 0.0), ([2, 3], 0.5)].map(spring);
        let builder = XpbdSolver::builder(&particles).energy(springs.to_vec());
        let mut solver = builder.config(iterations(60)).build().unwrap();
        let mut state = State::at_rest(vec![Vec3::zeros(); 4]);
        state.positions[0].x = 1.0;
        solver.step(&mut state, StepInput::new(0.01)).unwrap();
        assert_eq!(state.positions[0], Vec3::new(1.0, 0.0, 0.0));
        assert_eq!(state.positions[1], Vec3::zeros());
        let length = (state.positions[2] - state.positions[3]).norm();
        assert_eq!(length > 0.0, stiffness > 0.0, "{stiffness} {length}");
        let residual = solver.compliance_residual(&state.positions);
        assert!(residual < 1e-12, "{stiffness}: {residual:e}");
    }
}

#[test]
fn settings_out_of_range_are_refused() {
    let particles = Particles::new(vec![1.0]).unwrap();
    let no_substep = XpbdConfig {
        substeps: 0,
        ..iterations(1)
    };
    for config in [iterations(0), no_substep] {
        let error = XpbdSolver::builder(&particles).config(config).build();
        assert!(matches!(error, Err(BuildError::OutOfRange(_))));
    }
}

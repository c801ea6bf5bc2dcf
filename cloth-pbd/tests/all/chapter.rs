//! The claims of the chapter.

use crate::sheet;

use crate::chain::Chain;
use cloth_core::element::{Constraint, Element, Row};
use cloth_core::energy::{Attachment, CurvatureHinge, Spring};
use cloth_core::math::{Real, Vec3};
use cloth_core::measure::kinetic_energy;
use cloth_core::method::position_based::Sweep;
use cloth_core::particles::{Particles, State};
use cloth_core::step::{BuildError, StepInput, Stepper};
use cloth_pbd::{PbdConfig, PbdSolver, StiffnessRule, effective_stiffness, projection_stiffness};
use std::f64::consts::PI;

const MATERIAL: StiffnessRule = StiffnessRule::Material;
const RIGID: StiffnessRule = StiffnessRule::Fixed(1.0);

fn config(iterations: u32, stiffness: StiffnessRule) -> PbdConfig {
    PbdConfig {
        iterations,
        substeps: 1,
        sweep: Sweep::Sequential,
        stiffness,
        ..PbdConfig::default()
    }
}

/// What one step of `h` (s) leaves of the stretch (m) of one spring of 1 m and `k` (N/m) between masses of 0.3
/// and 0.7 kg that starts with a stretch of 2 m, as a fraction.
fn fraction_left(k: Real, h: Real, config: PbdConfig) -> Real {
    let particles = Particles::new(vec![0.3, 0.7]).unwrap();
    let spring = Spring {
        vertices: [0, 1],
        rest_length: 1.0,
        stiffness: k,
    };
    let builder = PbdSolver::builder(&particles).energy(vec![spring]);
    let mut solver = builder.config(config).build().unwrap();
    let start = Vec3::new(0.2, -0.1, 0.4);
    let mut state = State::at_rest(vec![start, start + Vec3::new(1.0, 2.0, 2.0)]);
    solver.step(&mut state, StepInput::new(h)).unwrap();
    ((state.positions[1] - state.positions[0]).norm() - 1.0) / 2.0
}

/// 1/kg, of the spring above.
const WEIGHT: Real = 1.0 / 0.3 + 1.0 / 0.7;

#[test]
fn one_constraint_with_a_fixed_stiffness_has_the_stiffness_of_the_law() {
    for s in [0.1, 0.5, 0.9] {
        for n in [1, 2, 3, 5] {
            for h in [1.0 / 30.0, 1.0 / 600.0] {
                let left = fraction_left(1.0, h, config(n, StiffnessRule::Fixed(s)));
                // Implicit Euler leaves 1/(1 + k h² w̃): the stiffness that this fraction means.
                let measured = (1.0 / left - 1.0) / (h * h * WEIGHT);
                let law = ((1.0 - s).powi(-(n as i32)) - 1.0) / (h * h * WEIGHT);
                // The stretch left over is known to some 1e-16 m, however small it is.
                let error = (measured / law - 1.0).abs();
                assert!(error < 1e-13 + 1e-15 / left, "s {s}, n {n}: {error:e}");
                assert!((effective_stiffness(s, n, h, WEIGHT) / law - 1.0).abs() < 1e-14);
            }
        }
    }
}

#[test]
fn one_constraint_with_its_material_ends_where_implicit_euler_does() {
    for k in [0.0, 1e-3, 3.0, 700.0, 2e4] {
        for n in [1, 2, 7, 50] {
            for h in [1.0 / 30.0, 1.0 / 600.0] {
                let left = fraction_left(k, h, config(n, MATERIAL));
                let law = 1.0 / (1.0 + k * h * h * WEIGHT);
                let error = (left / law - 1.0).abs();
                assert!(error < 1e-12, "k {k}, n {n}, h {h}: {error:e}");
            }
        }
    }
}

#[test]
fn the_two_stiffness_formulas_are_inverse_to_each_other() {
    for k in [1e-9, 1.0, 1e9] {
        for n in [1, 3, 40] {
            let (h, w) = (0.01, 7.0);
            let s = projection_stiffness(k * h * h * w, n);
            let error = (effective_stiffness(s, n, h, w) / k - 1.0).abs();
            // s loses digits of 1 − s where the material is very stiff.
            let lost = 1e-15 / (1.0 - s);
            assert!(
                error < 1e-13 + 2.0 * Real::from(n) * lost,
                "{k} {n}: {error:e}"
            );
        }
    }
}

#[test]
fn the_rows_of_a_hinge_and_of_an_attachment_follow_the_same_law() {
    let (h, n) = (0.02, 6);
    let particles = Particles::new(vec![0.1, 0.2, 0.3, 0.4]).unwrap();
    let rest = [[0.0, 0.0], [1.0, 0.0], [0.4, 0.8], [0.5, -0.9]].map(|[x, y]| Vec3::new(x, y, 0.0));
    let hinge = CurvatureHinge::new([0, 1, 2, 3], &rest, 5.0);
    let folded = [rest[0], rest[1], Vec3::new(0.4, 0.2, 0.7), rest[3]];
    let z = |x: &[Vec3]| -> Vec3 { (0..4).map(|i| x[i] * hinge.coefficients[i]).sum() };
    let weight: Real = (0..4)
        .map(|i| particles.inverse_mass()[i] * hinge.coefficients[i].powi(2))
        .sum();
    let builder = PbdSolver::builder(&particles).energy(vec![hinge]);
    let mut solver = builder.config(config(n, MATERIAL)).build().unwrap();
    let mut state = State::at_rest(folded.to_vec());
    solver.step(&mut state, StepInput::new(h)).unwrap();
    let law = z(&folded) / (1.0 + hinge.stiffness * h * h * weight);
    let error = (z(&state.positions) - law).norm() / law.norm();
    assert!(error < 1e-12, "{error:e}");

    let target = Vec3::new(1.0, 2.0, 3.0);
    let tie = Attachment {
        vertex: 0,
        target,
        stiffness: 30.0,
    };
    let builder = PbdSolver::builder(&particles).energy(vec![tie]);
    let mut solver = builder.config(config(n, MATERIAL)).build().unwrap();
    let mut state = State::at_rest(rest.to_vec());
    solver.step(&mut state, StepInput::new(h)).unwrap();
    let law = (rest[0] - target) / (1.0 + 30.0 * h * h * 10.0);
    let error = (state.positions[0] - target - law).norm() / law.norm();
    assert!(error < 1e-12, "{error:e}");
}

#[test]
fn an_infinite_stiffness_is_met_at_once() {
    for n in [1, 10] {
        assert!(fraction_left(Real::INFINITY, 0.01, config(n, MATERIAL)).abs() < 3e-16);
        assert!(fraction_left(1.0, 0.01, config(n, RIGID)).abs() < 3e-16);
    }
}

/// With one end fixed and the other free. The error factor is cos²(π/(N + 1)) with both ends free, and
/// cos²(π/(N − 1)) with both fixed.
#[test]
fn a_sweep_leaves_cos_squared_of_the_error_of_a_rigid_chain() {
    for links in [5, 20] {
        let chain = Chain::new(links, 1.0);
        for sweep in [Sweep::Sequential, Sweep::Colored] {
            let builder = PbdSolver::builder(&chain.particles).energy(chain.springs.clone());
            let sweeps = (3 * links * links / 2) as usize;
            let rigid = PbdConfig {
                sweep,
                ..config(sweeps as u32, RIGID)
            };
            let mut solver = builder.config(rigid).build().unwrap();
            let left = chain.stretch_after_each_iteration(&mut solver);
            let factor = left[sweeps - 1] / left[sweeps - 2];
            let law = (PI / (2.0 * Real::from(links))).cos().powi(2);
            assert!((factor - law).abs() < 1e-7, "{links}: {factor} {law}");
        }
    }
}

/// At rest a step gives back what gravity took: each free mass predicted g h² below its place. From below, link
/// N ends without stretch, and each link above with g h² more than the one below it. From above, link 1 ends without
/// stretch, and link i with (N + 2 − i) g h².
#[test]
fn a_rigid_chain_swept_once_per_substep_sags_by_its_law() {
    let (links, dt) = (20, 1.0 / 60.0);
    let chain = Chain::new(links, 1.0);
    for substeps in [1, 4] {
        let once = PbdConfig {
            substeps,
            ..config(1, RIGID)
        };
        let h = dt / Real::from(substeps);
        let upwards = chain.springs.iter().rev().copied().collect();
        for (springs, count) in [
            (chain.springs.clone(), links * (links - 1) / 2),
            (upwards, (links - 1) * (links + 2) / 2),
        ] {
            let builder = PbdSolver::builder(&chain.particles).energy(springs);
            let mut solver = builder.config(once).build().unwrap();
            let law = 9.81 * h * h * Real::from(count);
            let error = chain.sag_at_rest(&mut solver, dt, 10_000) / law - 1.0;
            assert!(error.abs() < 1e-10, "{error:e}");
        }
    }
}

#[test]
fn one_spring_sags_by_its_weight_over_its_stiffness() {
    let chain = Chain::of(1, 0.2, 0.3, 80.0);
    for n in [1, 20] {
        let builder = PbdSolver::builder(&chain.particles).energy(chain.springs.clone());
        let mut solver = builder.config(config(n, MATERIAL)).build().unwrap();
        let error = chain.sag_at_rest(&mut solver, 0.02, 2000) / (0.2 * 9.81 / 80.0) - 1.0;
        assert!(error.abs() < 1e-12, "{error:e}");
    }
}

/// The limit that the chapter states: springs that share a vertex do not get their k, and more iterations do
/// not help.
#[test]
fn springs_in_a_row_are_softer_than_their_material_at_any_iterations() {
    let chain = Chain::of(2, 0.01, 0.05, 100.0);
    let exact = 3.0 * 0.01 * 9.81 / 100.0;
    for (n, ratio) in [(1, 1.926), (20, 1.900), (1000, 1.919)] {
        let builder = PbdSolver::builder(&chain.particles).energy(chain.springs.clone());
        let mut solver = builder.config(config(n, MATERIAL)).build().unwrap();
        let sag = chain.sag_at_rest(&mut solver, 1.0 / 60.0, 500);
        assert!((sag / exact - ratio).abs() < 1e-3, "{n}: {}", sag / exact);
    }
}

/// Equal masses swept once from the support have a law, which the first of each mass is held against; more
/// iterations give what they give.
#[test]
fn twenty_springs_are_softer_by_the_size_of_k_h2_over_m() {
    for (mass, n, ratio) in [
        (0.01, 1, 252.32),
        (0.01, 20, 83.61),
        (1.0, 1, 3.5132),
        (1.0, 20, 2.8614),
    ] {
        let chain = Chain::of(20, mass, 0.05, 1e4);
        let builder = PbdSolver::builder(&chain.particles).energy(chain.springs.clone());
        let mut solver = builder.config(config(n, MATERIAL)).build().unwrap();
        let sag = chain.sag_at_rest(&mut solver, 1.0 / 60.0, 30_000);
        let exact = 210.0 * mass * 9.81 / 1e4;
        let error = sag / exact / ratio - 1.0;
        assert!(error.abs() < 1e-3, "{mass} {n}: {}", sag / exact);
        if n == 1 {
            let law = 1.0 + 1e4 / (3600.0 * mass) * 19.0 / 21.0;
            assert!((sag / exact / law - 1.0).abs() < 1e-3, "{mass}");
        }
    }
}

#[test]
fn iterations_divide_the_sag_of_a_rigid_chain_by_their_number_or_a_little_more() {
    let chain = Chain::new(20, 1.0);
    let sag = |n| {
        let builder = PbdSolver::builder(&chain.particles).energy(chain.springs.clone());
        let mut solver = builder.config(config(n, RIGID)).build().unwrap();
        chain.sag_at_rest(&mut solver, 1.0 / 60.0, 6000)
    };
    let once = sag(1);
    for n in [2, 4, 8, 20] {
        let gain = once / sag(n) / Real::from(n);
        assert!((1.0..1.06).contains(&gain), "{n}: {gain}");
    }
}

/// Along its axis one spring is a linear oscillator, and its step that of implicit Euler.
#[test]
fn a_spring_alone_divides_its_energy_by_one_plus_k_h2_w() {
    let (k, h) = (40.0, 0.02);
    let particles = Particles::new(vec![0.3, 0.7]).unwrap();
    let spring = Spring {
        vertices: [0, 1],
        rest_length: 1.0,
        stiffness: k,
    };
    let energy = |state: &State| {
        let stretch = (state.positions[1] - state.positions[0]).norm() - 1.0;
        0.5 * k * stretch * stretch + kinetic_energy(&particles, &state.velocities)
    };
    for n in [1, 7] {
        let builder = PbdSolver::builder(&particles).energy(vec![spring]);
        let mut solver = builder.config(config(n, MATERIAL)).build().unwrap();
        let mut state = State::at_rest(vec![Vec3::zeros(), Vec3::x() * 1.3]);
        for _ in 0..10 {
            let before = energy(&state);
            solver.step(&mut state, StepInput::new(h)).unwrap();
            let law = 1.0 + k * h * h * WEIGHT;
            assert!((before / energy(&state) / law - 1.0).abs() < 1e-12);
        }
    }
}

#[test]
fn a_rigid_link_about_its_pin_slows_down_by_its_law() {
    let h = 0.01;
    let mut particles = Particles::new(vec![1.0, 0.2]).unwrap();
    particles.prescribe(0).unwrap();
    let link = Spring {
        vertices: [0, 1],
        rest_length: 0.5,
        stiffness: 1.0,
    };
    let builder = PbdSolver::builder(&particles).energy(vec![link]);
    let mut solver = builder.config(config(1, RIGID)).build().unwrap();
    let mut state = State::at_rest(vec![Vec3::zeros(), Vec3::x() * 0.5]);
    state.velocities[1] = Vec3::y() * 3.0;
    let mut turned_by = None;
    for _ in 0..100 {
        let (from, energy) = (
            state.positions[1],
            kinetic_energy(&particles, &state.velocities),
        );
        solver.step(&mut state, StepInput::new(h)).unwrap();
        let angle = from.cross(&state.positions[1]).z / 0.25;
        let angle = angle.asin();
        if let Some(alpha) = turned_by {
            let law = Real::atan2(Real::sin(alpha), 2.0 - Real::cos(alpha));
            assert!((angle / law - 1.0).abs() < 1e-11, "{angle} {law}");
            let lost = 1.0 - kinetic_energy(&particles, &state.velocities) / energy;
            assert!((lost / (2.0 * alpha * alpha) - 1.0).abs() < 3.0 * alpha * alpha);
        }
        turned_by = Some(angle);
    }
}

#[test]
fn a_fixed_stiffness_gets_stiffer_with_every_iteration_and_smaller_step() {
    let chain = Chain::new(5, 1.0);
    let sag = |n, substeps| {
        let soft = PbdConfig {
            substeps,
            ..config(n, StiffnessRule::Fixed(0.2))
        };
        let builder = PbdSolver::builder(&chain.particles).energy(chain.springs.clone());
        chain.sag_at_rest(&mut builder.config(soft).build().unwrap(), 1.0 / 60.0, 4000)
    };
    assert!(sag(2, 1) < 0.5 * sag(1, 1));
    assert!(sag(4, 1) < 0.5 * sag(2, 1));
    assert!((sag(1, 2) / sag(1, 1) - 0.25).abs() < 1e-9);
}

#[test]
fn coloured_and_sequential_sweeps_agree_only_where_they_converge() {
    let chain = Chain::new(12, 1.0);
    let run = |iterations, sweep| {
        let builder = PbdSolver::builder(&chain.particles).energy(chain.springs.clone());
        let config = PbdConfig {
            sweep,
            ..config(iterations, RIGID)
        };
        let mut state = chain.at_rest();
        state.positions[7].z += 0.1;
        let mut solver = builder.config(config).build().unwrap();
        solver.step(&mut state, StepInput::new(0.01)).unwrap();
        state
    };
    let apart = |iterations| {
        let [a, b] = [Sweep::Sequential, Sweep::Colored].map(|sweep| run(iterations, sweep));
        let apart = a.positions.iter().zip(&b.positions);
        apart.map(|(a, b)| (a - b).norm()).fold(0.0, Real::max)
    };
    assert!(apart(2) > 1e-3);
    assert!(apart(3000) < 1e-13);
}

#[test]
fn a_cloth_gives_the_same_bits_on_any_threads_and_when_restarted() {
    let (mesh, model) = sheet::held_sheet(150, 1e4);
    let solver = || {
        let builder = PbdSolver::builder(&model.particles);
        let builder = builder.energy(model.springs.clone());
        builder.energy(model.hinges.clone()).build().unwrap()
    };
    let start = State::at_rest(mesh.positions().to_vec());
    let run = || {
        let mut state = start.clone();
        sheet::fall(&mut solver(), &mut state, 4);
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
    // A fresh solver for each step: its internal state must not matter.
    let mut state = start.clone();
    for _ in 0..4 {
        sheet::fall(&mut solver(), &mut state, 1);
    }
    assert!(one == state);
}

/// `C = ½(‖x‖² − 1)`: its w̃ depends on where the vertex is.
#[derive(Clone, Copy, Debug)]
struct OnSphere;

impl Element<1> for OnSphere {
    fn vertices(&self) -> [u32; 1] {
        [0]
    }
}

impl Constraint<1> for OnSphere {
    type Rows = [Row<1>; 1];

    fn rows(&self, x: &[Vec3; 1]) -> [Row<1>; 1] {
        [Row {
            value: 0.5 * (x[0].norm_squared() - 1.0),
            gradient: *x,
            stiffness: 300.0,
        }]
    }
}

#[test]
fn a_new_step_size_or_configuration_brings_a_new_stiffness() {
    let particles = Particles::new(vec![1.0]).unwrap();
    let builder = || PbdSolver::builder(&particles).energy(vec![OnSphere]);
    let mut warm = builder().build().unwrap();
    let mut state = State::at_rest(vec![Vec3::new(1.0, 1.0, 0.5)]);
    for dt in [0.01, 0.003, 0.003, 0.2, 0.2, 0.01] {
        let mut again = state.clone();
        let mut fresh = builder().build().unwrap();
        warm.step(&mut state, StepInput::new(dt)).unwrap();
        fresh.step(&mut again, StepInput::new(dt)).unwrap();
        assert_eq!(state, again);
    }
    // One iteration, so that its w̃ is that of the start: s = kh²w̃/(1 + kh²w̃).
    let mut once = builder().config(config(1, MATERIAL)).build().unwrap();
    for x in [2.0, 3.0] {
        let mut state = State::at_rest(vec![Vec3::new(x, 0.0, 0.0)]);
        once.step(&mut state, StepInput::new(0.1)).unwrap();
        let z = 300.0 * 0.01 * x * x;
        let law = x - z / (1.0 + z) * 0.5 * (x * x - 1.0) / x;
        assert!((state.positions[0].x - law).abs() < 1e-12);
    }
}

#[test]
fn constraints_between_pins_and_springs_without_length_stay_finite() {
    let mut particles = Particles::new(vec![1.0; 4]).unwrap();
    particles.prescribe(0).unwrap();
    particles.prescribe(1).unwrap();
    let spring = |a, b, rest_length, stiffness| Spring {
        vertices: [a, b],
        rest_length,
        stiffness,
    };
    for stiffness in [0.0, 5.0, Real::INFINITY] {
        let springs = vec![
            spring(0, 1, 9.0, stiffness),
            spring(1, 2, 0.0, stiffness),
            spring(2, 3, 0.5, stiffness),
        ];
        for rule in [MATERIAL, RIGID] {
            let builder = PbdSolver::builder(&particles).energy(springs.clone());
            let mut solver = builder.config(config(30, rule)).build().unwrap();
            let mut state = State::at_rest(vec![Vec3::zeros(); 4]);
            state.positions[0].x = 1.0;
            solver.step(&mut state, StepInput::new(0.01)).unwrap();
            assert_eq!(state.positions[0], Vec3::new(1.0, 0.0, 0.0));
            assert_eq!(state.positions[1], Vec3::zeros());
            let length = (state.positions[2] - state.positions[3]).norm();
            let moved = rule == RIGID || stiffness > 0.0;
            assert_eq!(length > 0.0, moved, "{stiffness} {length}");
        }
    }
}

#[test]
fn settings_out_of_range_are_refused() {
    let particles = Particles::new(vec![1.0]).unwrap();
    let stiffness = |s| config(1, StiffnessRule::Fixed(s));
    for config in [
        config(0, MATERIAL),
        PbdConfig {
            substeps: 0,
            ..config(1, MATERIAL)
        },
        stiffness(-0.1),
        stiffness(1.1),
        stiffness(Real::NAN),
    ] {
        let error = PbdSolver::builder(&particles).config(config).build();
        assert!(matches!(error, Err(BuildError::OutOfRange(_))));
    }
}

//! In a straight chain every kind of sweep, extrapolated or not, converges to the same step, multipliers included.

use crate::counting_allocator;
use crate::sheet;

use crate::chain::Chain;
use cloth_core::energy::Spring;
use cloth_core::math::{Real, Vec3};
use cloth_core::method::position_based::{Acceleration, Chebyshev, Radius, Sweep};
use cloth_core::particles::{Particles, State};
use cloth_core::step::{StepInput, Stepper};
use cloth_xpbd::{XpbdConfig, XpbdSolver};
use std::f64::consts::PI;
use std::iter;

const SWEEPS: [Sweep; 4] = [
    Sweep::Sequential,
    Sweep::Colored,
    Sweep::Jacobi,
    Sweep::PlainJacobi,
];

fn chebyshev(radius: Radius) -> Acceleration {
    let chebyshev = Some(Chebyshev { radius, delay: 4 });
    Acceleration {
        chebyshev,
        ..Acceleration::default()
    }
}

#[test]
fn a_hanging_chain_has_the_sag_and_the_tensions_of_statics() {
    let (n, k, mass) = (6_u32, 50.0, 0.02);
    let chain = Chain::of(n, mass, 0.1, k);
    for sweep in SWEEPS {
        for (acceleration, iterations) in [
            (Acceleration::default(), 500),
            (chebyshev(Radius::Given(0.97)), 150),
            (chebyshev(Radius::Estimated), 150),
        ] {
            let config = XpbdConfig {
                iterations,
                substeps: 2,
                sweep,
                acceleration,
                ..XpbdConfig::default()
            };
            let builder = XpbdSolver::builder(&chain.particles).energy(chain.springs.clone());
            let mut solver = builder.config(config).build().unwrap();
            let sag = chain.sag_at_rest(&mut solver, 0.1, 500);
            let law = Real::from(n * (n + 1)) * mass * 9.81 / (2.0 * k);
            assert!(
                (sag / law - 1.0).abs() < 1e-11,
                "{config:?} {:e}",
                sag / law - 1.0
            );
            let mut multipliers = Vec::new();
            solver.multipliers_into(0, &mut multipliers);
            for (i, multiplier) in multipliers.iter().enumerate() {
                let tension = -multiplier / (0.05 * 0.05);
                let law = (Real::from(n) - i as Real) * mass * 9.81;
                assert!((tension / law - 1.0).abs() < 1e-11, "{config:?}, {i}");
            }
        }
    }
}

/// A rigid chain of 20 links: `cos²(π/40)` per plain sweep, and at best `ρ/(1 + √(1 − ρ²))` of an extrapolated
/// one.
#[test]
fn extrapolated_sweeps_need_a_tenth_of_the_iterations() {
    let chain = Chain::new(20, Real::INFINITY);
    let needed = |acceleration| {
        let config = XpbdConfig {
            iterations: 2000,
            substeps: 1,
            acceleration,
            ..XpbdConfig::default()
        };
        let builder = XpbdSolver::builder(&chain.particles).energy(chain.springs.clone());
        let mut solver = builder.config(config).build().unwrap();
        let left = chain.stretch_after_each_iteration(&mut solver);
        assert_eq!(solver.chebyshev_fallbacks(), 0);
        left.iter().position(|&stretch| stretch < 1e-7).unwrap()
    };
    let plain = needed(Acceleration::default());
    let radius = (PI / 40.0).cos().powi(2);
    let given = needed(chebyshev(Radius::Given(radius)));
    let estimated = needed(chebyshev(Radius::Estimated));
    println!("{plain} plain, {given} with ρ given, {estimated} with ρ estimated");
    assert!(
        given * 10 < plain && estimated * 6 < plain,
        "{plain} {given} {estimated}"
    );
}

#[test]
fn nothing_is_allocated_after_the_first_step() {
    let (mesh, model) = sheet::held_sheet(24, 1e4);
    for sweep in SWEEPS {
        let acceleration = Acceleration {
            relaxation: 0.2,
            ..chebyshev(Radius::Estimated)
        };
        let config = XpbdConfig {
            iterations: 20,
            substeps: 1,
            sweep,
            acceleration,
            ..XpbdConfig::default()
        };
        let builder = XpbdSolver::builder(&model.particles).energy(model.springs.clone());
        let builder = builder.energy(model.hinges.clone()).config(config);
        let mut solver = builder.build().unwrap();
        let mut state = State::at_rest(mesh.positions().to_vec());
        let step = || sheet::fall(&mut solver, &mut state, 1);
        let count = counting_allocator::allocations_once_warm(step);
        assert_eq!(count, 0, "{config:?}");
    }
}

/// A vertex in a plane, held by N hard struts that turn by π/N: one sweep the same way round multiplies its
/// displacement by `μ = −cosᴺ(π/N)`, so that a substep multiplies the motion by the larger root z of
/// `z² = μ (2z − 1)`.
#[test]
fn one_sweep_around_a_star_of_struts_gains_energy_from_five_on() {
    const AWAY: Real = 1e-6;
    let growth = |order: &[u32], iterations: u32| {
        let n = order.len() as u32;
        let angle = |strut: u32| Real::from(strut) * PI / Real::from(n);
        let ends = order.iter().map(|&strut| {
            let (y, x) = angle(strut).sin_cos();
            Vec3::new(x, y, 0.0)
        });
        let positions: Vec<_> = iter::once(Vec3::zeros()).chain(ends).collect();
        let mut particles = Particles::new(vec![1.0; positions.len()]).unwrap();
        for end in 1..positions.len() {
            particles.prescribe(end).unwrap();
        }
        let struts: Vec<[u32; 2]> = (1..=n).map(|end| [0, end]).collect();
        let struts = Spring::along(&positions, &struts, Real::INFINITY);
        let config = XpbdConfig {
            iterations,
            substeps: 1,
            sweep: Sweep::Sequential,
            ..XpbdConfig::default()
        };
        let builder = XpbdSolver::builder(&particles)
            .energy(struts)
            .config(config);
        let mut solver = builder.build().unwrap();
        let mut state = State::at_rest(positions);
        let mut sizes = Vec::new();
        state.positions[0] = Vec3::new(0.3 * AWAY, AWAY, 0.0);
        for _ in 0..30 {
            solver.step(&mut state, StepInput::new(0.01)).unwrap();
            sizes.push(state.positions[0].norm());
        }
        [(sizes[29] / sizes[9]).powf(0.05), sizes[29] / AWAY]
    };
    let larger = |mu: Real| (mu - (mu * mu - mu).sqrt()).abs();
    for n in [4, 5, 6] {
        let order: Vec<u32> = (0..n).collect();
        let mu = -(PI / Real::from(n)).cos().powi(n as i32);
        let ([found, _], law) = (growth(&order, 1), larger(mu));
        assert!(
            (found / law - 1.0).abs() < 1e-4,
            "{n} struts: {found}, {law}"
        );
        assert_eq!(found > 1.0, n > 4, "{n} struts: {found}");
    }
    for (order, iterations) in [([0, 1, 2, 3, 4], 2), ([0, 2, 4, 1, 3], 1)] {
        let [_, left] = growth(&order, iterations);
        assert!(left < 1e-6, "{order:?}, {iterations} sweeps leave {left}");
    }
}

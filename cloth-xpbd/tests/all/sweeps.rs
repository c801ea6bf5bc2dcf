//! In a straight chain every kind of sweep, extrapolated or not, converges to the same step, multipliers included.

use crate::counting_allocator;
use crate::sheet;

use crate::chain::Chain;
use cloth_core::math::Real;
use cloth_core::method::position_based::{Acceleration, Chebyshev, Radius, Sweep};
use cloth_core::particles::State;
use cloth_xpbd::{XpbdConfig, XpbdSolver};

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
    let radius = (std::f64::consts::PI / 40.0).cos().powi(2);
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

//! Constraints that act beyond a range only: as stiff as their k, with the force that this makes, after any
//! number of sweeps.

use crate::chapter::iterations;
use cloth_core::element::Constraint;
use cloth_core::energy::{Attachment, StrainLimitTriangle};
use cloth_core::math::{Real, Vec3};
use cloth_core::method::position_based::{Acceleration, Chebyshev, Radius, Sweep};
use cloth_core::particles::{Particles, State};
use cloth_core::step::{StepInput, Stepper};
use cloth_xpbd::links::DistanceLimit;
use cloth_xpbd::{XpbdConfig, XpbdSolver};

/// Of the one vertex that moves, along y (kg), and the step (s).
const MASS: Real = 0.1;
const H: Real = 0.01;

/// Vertices 0 at the origin and 1 on the x axis are prescribed. Vertex 2 at (0, y, 0) is to stay below
/// `y = LONGEST` (m) and above `SHORTEST` (m).
const SHORTEST: Real = 0.8;
const LONGEST: Real = 1.2;

fn spring(stiffness: Real) -> DistanceLimit {
    DistanceLimit {
        vertices: [0, 2],
        shortest: SHORTEST,
        longest: LONGEST,
        stiffness,
    }
}

/// Its area is ½ m², and one of its stretches is the y of the vertex. The other one is free, and on the same
/// side of it all the time: of stretches that cross, each would go on with the multiplier of the other.
fn triangle(stiffness: Real) -> StrainLimitTriangle {
    let rest = [Vec3::zeros(), Vec3::x(), Vec3::y()];
    StrainLimitTriangle::new([0, 1, 2], &rest, [SHORTEST, LONGEST], 2.0 * stiffness)
}

/// The y (m) that a step ends at, the force (N) of the limit on the vertex along y, and the residual (m): from
/// rest at `predicted`, with a soft pin of `pull` (N/m) at y = 1.
fn step<const N: usize, E: Constraint<N>>(
    limit: E,
    pull: Real,
    predicted: Real,
    config: XpbdConfig,
) -> [Real; 3] {
    let mut particles = Particles::new(vec![MASS; 3]).unwrap();
    particles.prescribe(0).unwrap();
    particles.prescribe(1).unwrap();
    let pin = Attachment {
        vertex: 2,
        target: Vec3::y(),
        stiffness: pull,
    };
    let builder = XpbdSolver::builder(&particles)
        .energy(vec![limit])
        .energy(vec![pin]);
    let mut solver = builder.config(config).build().unwrap();
    let width = if predicted > 1.0 { 0.9 } else { 1.1 };
    let mut state = State::at_rest(vec![
        Vec3::zeros(),
        Vec3::x() * width,
        Vec3::y() * predicted,
    ]);
    solver.step(&mut state, StepInput::new(H)).unwrap();
    let mut force = 0.0;
    solver.each_force(0, |row| force += row.on(N - 1).y);
    let x = &state.positions;
    [x[2].y, force, solver.compliance_residual(x)]
}

/// The minimum of `m/(2h²) (y − ỹ)² + ½ p (y − 1)² + ½ k (y − clamp y)²`, and the force of the last term. Damping β,
/// with ỹ where the step starts, adds `p β/(2h) (y − ỹ)²`: the pin is damped, and the limit is not.
fn implicit_euler(stiffness: Real, pull: Real, predicted: Real, damping: Real) -> [Real; 2] {
    let inertia = MASS / (H * H) + pull * damping / H;
    let free = (inertia * predicted + pull) / (inertia + pull);
    let bound = free.clamp(SHORTEST, LONGEST);
    let rest = inertia + pull;
    if stiffness == Real::INFINITY {
        return [bound, rest * (bound - free)];
    }
    let y = (rest * free + stiffness * bound) / (rest + stiffness);
    [y, stiffness * (bound - y)]
}

fn follows_the_law<const N: usize, E: Constraint<N>>(
    limit: impl Fn(Real) -> E,
    variants: &[(Sweep, Acceleration)],
) {
    // Far beyond the range and barely; where the pin takes it back inside; below it; and inside all the time.
    for predicted in [3.0, 1.3, 1.21, 0.5, 1.1] {
        for stiffness in [50.0, 2e3, 1e5, Real::INFINITY] {
            for pull in [100.0, 2e3, 5e3] {
                for &(sweep, acceleration) in variants {
                    for (sweeps, damping) in [(800, 0.0), (801, 0.0), (1600, 0.0), (1600, 0.004)] {
                        let [y, force] = implicit_euler(stiffness, pull, predicted, damping);
                        let config = XpbdConfig {
                            sweep,
                            acceleration,
                            damping,
                            ..iterations(sweeps)
                        };
                        let [end, read, left] = step(limit(stiffness), pull, predicted, config);
                        let what = format!(
                            "k {stiffness}, pin {pull}, ỹ {predicted}, {config:?}: {end} {y}, {read} {force} N"
                        );
                        assert!((end - y).abs() < 1e-14, "{what}");
                        // Each sweep rounds y by some 1e-16 m, which is 1e-13 N of inertia.
                        let rounding = 1e-13 * Real::from(sweeps);
                        assert!((read - force).abs() < rounding, "{what}");
                        assert!(left < 1e-14, "{what}: {left:e}");
                    }
                }
            }
        }
    }
}

#[test]
fn a_distance_limit_is_as_stiff_as_its_k_after_any_number_of_iterations() {
    let plain = Acceleration::default();
    let over_relaxed = Acceleration {
        relaxation: 1.4,
        ..plain
    };
    let chebyshev = Acceleration {
        chebyshev: Some(Chebyshev {
            radius: Radius::Given(0.9),
            delay: 3,
        }),
        ..plain
    };
    let variants = [
        (Sweep::Sequential, plain),
        (Sweep::Sequential, over_relaxed),
        (Sweep::Sequential, chebyshev),
        (Sweep::Jacobi, plain),
    ];
    follows_the_law(spring, &variants);
}

#[test]
fn a_slack_triangle_is_as_stiff_as_its_k_after_any_number_of_iterations() {
    let plain = Acceleration::default();
    follows_the_law(
        triangle,
        &[(Sweep::Sequential, plain), (Sweep::Jacobi, plain)],
    );
}

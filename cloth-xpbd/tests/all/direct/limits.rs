//! Constraints that act beyond a range only, in the direct solver.

use crate::direct::SYSTEMS;
use cloth_core::energy::Attachment;
use cloth_core::math::{Real, Vec3};
use cloth_core::particles::{Particles, State};
use cloth_core::step::{Outcome, StepInput, Stepper};
use cloth_xpbd::direct::{DirectConfig, DirectStart, DirectXpbd};
use cloth_xpbd::links::DistanceLimit;

const MASS: Real = 0.1;
const H: Real = 0.01;
const RANGE: [Real; 2] = [0.8, 1.2];

/// One vertex along y between a limit of its distance to the origin and a soft pin at y = 1: where a step from
/// rest ends (m) and the force of the limit (N), beside the minimum of
/// `m/(2h²) (y − ỹ)² + ½ p (y − 1)² + ½ k (y − clamp y)²`, to which damping β adds `p β/(2h) (y − ỹ)²` of the pin alone.
#[test]
fn a_limit_acts_with_its_stiffness_where_it_does_and_not_at_all_elsewhere() {
    let [shortest, longest] = RANGE;
    let mut particles = Particles::new(vec![MASS; 2]).unwrap();
    particles.prescribe(0).unwrap();
    for system in SYSTEMS {
        for (start, damping) in [
            (DirectStart::Predicted, 0.0),
            (DirectStart::Previous, 0.0),
            (DirectStart::Predicted, 0.004),
        ] {
            let config = DirectConfig {
                system,
                start,
                damping,
                ..DirectConfig::default()
            };
            for predicted in [3.0, 1.3, 1.21, longest, 1.1, shortest, 0.5] {
                for stiffness in [50.0, 2e3, 1e5, Real::INFINITY] {
                    for pull in [100.0, 2e3, 5e3] {
                        let pin = Attachment {
                            vertex: 1,
                            target: Vec3::y(),
                            stiffness: pull,
                        };
                        let limit = DistanceLimit {
                            vertices: [0, 1],
                            shortest,
                            longest,
                            stiffness,
                        };
                        let builder = DirectXpbd::builder(&particles)
                            .energy(vec![limit])
                            .energy(vec![pin]);
                        let mut solver = builder.config(config).build().unwrap();
                        let mut state = State::at_rest(vec![Vec3::zeros(), Vec3::y() * predicted]);
                        let report = solver.step(&mut state, StepInput::new(H)).unwrap();
                        let damper = pull * damping / H;
                        let inertia = MASS / (H * H) + damper;
                        let rest = inertia + pull;
                        let free = (inertia * predicted + pull) / rest;
                        let bound = free.clamp(shortest, longest);
                        let (y, force) = if stiffness == Real::INFINITY {
                            (bound, rest * (bound - free))
                        } else {
                            let y = (rest * free + stiffness * bound) / (rest + stiffness);
                            (y, stiffness * (bound - y))
                        };
                        let mut multipliers = Vec::new();
                        solver.multipliers_into(0, &mut multipliers);
                        let mut forces = vec![Vec3::zeros(); 2];
                        solver.vertex_forces_into(&mut forces);
                        let (end, read) = (state.positions[1].y, multipliers[0] / (H * H));
                        let what = format!(
                            "{config:?}: k {stiffness}, pin {pull}, ỹ {predicted}: {end} {y}, {read} {force} N, {report:?}"
                        );
                        assert!((end - y).abs() < 1e-15, "{what}");
                        assert!((read - force).abs() < 1e-10, "{what}");
                        let sum = read - pull * (end - 1.0) - damper * (end - predicted);
                        assert!((forces[1].y - sum).abs() < 1e-10, "{what}");
                        assert_eq!(report.outcome, Outcome::Converged, "{what}");
                        assert!(report.iterations <= 6, "{what}");
                    }
                }
            }
        }
    }
}

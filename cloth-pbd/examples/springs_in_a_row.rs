//! A row of springs hangs from its first vertex: how far it sags, against statics, for more and more iterations.
//!
//! `cargo run --release -p cloth-pbd --example springs_in_a_row`

use cloth_core::energy::Spring;
use cloth_core::math::Vec3;
use cloth_core::particles::{Particles, State};
use cloth_core::step::{StepInput, Stepper};
use cloth_pbd::{PbdConfig, PbdSolver, StiffnessRule};
use std::error::Error;

/// kg, m, N/m, m/s², s.
const MASS: f64 = 0.01;
const LINK: f64 = 0.1;
const STIFFNESS: f64 = 100.0;
const GRAVITY: f64 = 9.81;
const STEP: f64 = 1.0 / 60.0;

fn main() -> Result<(), Box<dyn Error>> {
    println!("sag as a multiple of n(n+1)mg/2k");
    println!("springs  rule        1 iteration     5    20   100");
    let mut of_one = Vec::new();
    for count in [1, 2, 10] {
        for (name, rule) in [
            ("material", StiffnessRule::Material),
            ("fixed 0.2", StiffnessRule::Fixed(0.2)),
        ] {
            print!("{count:7}  {name:10}");
            for iterations in [1, 5, 20, 100] {
                let ratio = sag(count, iterations, rule)? / statics(count);
                print!("  {ratio:8.1e}");
                if count == 1 && rule == StiffnessRule::Material {
                    of_one.push(ratio);
                }
            }
            println!();
        }
    }
    assert!(
        of_one.iter().all(|ratio| (ratio - 1.0).abs() < 1e-9),
        "one spring alone has its stiffness"
    );
    println!(
        "one spring alone hangs where it should, whatever the iterations; springs in a row do not"
    );
    Ok(())
}

/// How far (m) the lowest of `count` masses hangs below its place without gravity.
fn statics(count: u32) -> f64 {
    f64::from(count * (count + 1)) * MASS * GRAVITY / (2.0 * STIFFNESS)
}

fn sag(count: u32, iterations: u32, stiffness: StiffnessRule) -> Result<f64, Box<dyn Error>> {
    let positions: Vec<Vec3> = (0..=count)
        .map(|i| Vec3::new(0.0, -LINK * f64::from(i), 0.0))
        .collect();
    let ends: Vec<[u32; 2]> = (0..count).map(|i| [i, i + 1]).collect();
    let mut particles = Particles::new(vec![MASS; positions.len()])?;
    particles.prescribe(0)?;
    let mut solver = PbdSolver::builder(&particles)
        .energy(Spring::along(&positions, &ends, STIFFNESS))
        .config(PbdConfig {
            iterations,
            stiffness,
            ..PbdConfig::default()
        })
        .build()?;
    let mut state = State::at_rest(positions);
    let lowest = state.positions[count as usize].y;
    for _ in 0..3000 {
        let input = StepInput::new(STEP).gravity(Vec3::new(0.0, -GRAVITY, 0.0));
        solver.step(&mut state, input)?;
    }
    Ok(lowest - state.positions[count as usize].y)
}

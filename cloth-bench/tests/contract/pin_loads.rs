//! What held vertices bear is what gravity does to the cloth and its motion does not take.

use crate::common::{methods, scene};
use cloth_bench::error::BenchError;
use cloth_bench::method::Method;
use cloth_bench::run::{Plan, Solver, run_changing};
use cloth_bench::scene::Scene;
use cloth_bench::settings::Settings;
use cloth_bench::studies::variants::Variant;
use cloth_core::math::{Real, Vec3};
use cloth_core::particles::State;

/// Runs a method; gives the end and the largest difference, in weights of the cloth, between the sum of the pin loads
/// of a step and M g − dP/dt, with the momentum P of the free vertices.
fn imbalance(method: &Method, scene: &Scene, pin_loads: bool) -> Result<(State, Real), BenchError> {
    let is_iterated = matches!(method.name, "implicit-euler" | "bdf2" | "implicit-midpoint");
    let settings = match is_iterated {
        true => Settings::parse(&["tolerance=1e-12"])?,
        false => Variant::default_of(method).settings,
    };
    let mut solver = Solver::new(method, &settings, scene, scene.dt)?;
    let mut state = scene.start.clone();
    let plan = Plan {
        pin_loads,
        ..Plan::new(scene.dt, 20)
    };
    let mass = scene.model.particles.mass();
    let weight = scene.gravity * mass.iter().sum::<Real>();
    let is_free = |v: &usize| !scene.model.particles.is_prescribed(*v);
    let momentum = |state: &State| -> Vec3 {
        let free = (0..mass.len()).filter(is_free);
        free.map(|v| state.velocities[v] * mass[v]).sum()
    };
    let mut earlier = [momentum(&state); 2];
    let mut worst: Real = 0.0;
    run_changing(scene, &mut solver, &mut state, plan, |moment| {
        let now = momentum(moment.state);
        let [before, last] = earlier;
        // BDF2 has the force where its step ends, and begins anew by implicit Euler where the motion has jumped.
        let mut changes = vec![now - last];
        if method.name == "bdf2" {
            changes.push(now * 1.5 - last * 2.0 + before * 0.5);
        }
        if let Some(loads) = moment.pin_loads {
            let found: Vec3 = loads.iter().sum();
            let errors = changes
                .iter()
                .map(|change| found - (weight - change / scene.dt));
            let error = errors.map(|error| error.norm()).reduce(Real::min).unwrap();
            worst = worst.max(error / weight.norm());
        }
        earlier = [last, now];
        Ok(())
    })?;
    Ok((state, worst))
}

#[test]
fn pins_bear_what_gravity_does_and_motion_does_not_take() {
    for (name, pairs) in [("hang", &["n=9"][..]), ("twist", &["n=9", "self=no"])] {
        let scene = scene(name, pairs);
        for method in methods() {
            let at = format!("{name}, {}", method.name);
            let told = imbalance(method, &scene, true);
            // Its forces are linearised, and not those where it ends.
            if method.name == "linear-implicit" {
                let said = told.unwrap_err().to_string();
                assert!(said.contains("does not tell the forces at held"), "{said}");
                continue;
            }
            let (told, worst) = told.unwrap();
            let most = match method.name {
                // Rows turn while they are swept: their direction is that of the end.
                "pbd" => 0.05,
                "xpbd" => 2e-3,
                "xpbd-direct" | "pd" => 1e-3, // what its iterations leave
                _ => 1e-10,
            };
            assert!(worst < most, "{at}: {worst:e}");
            let (silent, _) = imbalance(method, &scene, false).unwrap();
            assert!(told == silent, "{at}: asking moves the cloth");
        }
    }
}

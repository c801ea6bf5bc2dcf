//! The whole program of the comparison, with one method more: vertex block descent.
//!
//! ```sh
//! cd cloth-bench/examples/own-method
//! cargo run --release -- list
//! cargo run --release -- run hang --method vbd --n 64             # as many parts of a step as the mesh asks for
//! cargo run --release -- run hang --method vbd --set substeps=1   # as the studies compare it: 100 sweeps a step
//! cargo run --release -- run ../../scenes/ball.toml --method vbd --watch
//! cargo run --release -- study convergence --tables               # iterations and ms to errors of 1e-1, 1e-2, 1e-3
//! cargo run --release -- study                                    # the whole report, with this method in it
//! ```
//!
//! [`vbd`] is the method, [`contact`] how a vertex sees what touches it. All that the comparison has to be told of a
//! method stands here: what can be set, how it is built, its colour, and which variants are worth a line of their own.
//! It is then in every study that compares methods. The others are about one method (`xpbd-floor`, `sag`, `projective`,
//! `newton`) or about elements (`bending`).

mod contact;
mod vbd;

use cloth_bench::error::BenchError;
use cloth_bench::method::{Method, OwnMethod};
use cloth_bench::report::palette::Marker;
use cloth_bench::scene::Scene;
use cloth_bench::settings::{Auto, Or, Range::*, Settings, Table};
use cloth_core::step::Stepper;
use std::process::ExitCode;
use vbd::{VbdConfig, VertexBlockDescent};

cloth_bench::settings! {
    /// What can be set of it.
    struct Vbd {
        iterations: Or<Auto, u32> = "auto" in AtLeast(1.0),
            "sweeps over all vertices in each part of a step; auto: 100 a step, divided among its parts";
        substeps: Or<Auto, u32> = 1 in AtLeast(1.0), "parts of a step; auto: as many as xpbd takes for the mesh";
        chebyshev_radius: Or<Auto, f64> = "auto" in Within(0.0, 0.9999),
            "spectral radius ρ of the Chebyshev acceleration; 0: none; auto: 0.99 from 20 sweeps on, else none";
        air_drag: f64 = 0 "1/s" in AtLeast(0.0), "drag per mass α: a force −α m v";
        stiffness_damping: f64 = 0 "s" in AtLeast(0.0), "stiffness-proportional damping β: a force −β K v";
    }
}

const VBD: Method = Method::own(OwnMethod {
    parameters: &[Vbd::PARAMETERS],
    aims_at_implicit_euler: true,
    look: ([0x8a, 0x3f, 0xfc], Marker::Diamond),
    by_default: "substeps=auto",
    variants: "vbd, plain: chebyshev_radius=0
        vbd, Chebyshev 0.95: chebyshev_radius=0.95",
    qualities: [
        "yes, once it has converged",
        "no",
        "vertices of a colour",
        "3 × 3 blocks",
        "none reported",
    ],
    ..OwnMethod::new(
        "vbd",
        "vertex block descent: implicit Euler by Gauss–Seidel over vertices",
        build,
    )
});

/// Sweeps a step where nothing else is said, as the paper has them at most.
const SWEEPS: u32 = 100;

/// Acceleration by default: see [`vbd`].
const RADIUS: f64 = 0.99;
const LEAST_ACCELERATED: u32 = 20;

fn build(scene: &Scene, settings: &Settings, dt: f64) -> Result<Box<dyn Stepper>, BenchError> {
    if !scene.volumes.is_empty() {
        return Err(BenchError::usage(
            "`vbd` cannot take bulk_modulus: the pressure of a sealed volume couples all of its vertices, and one \
             moves at a time; implicit-euler, pd and xpbd can",
        ));
    }
    let own = Vbd::read(settings)?;
    let iterations = match *own.iterations {
        Or::Word(Auto::Auto) => None,
        Or::Value(count) => Some(count),
    };
    let substeps = match *own.substeps {
        Or::Value(count) => count,
        // A sweep over vertices leaves as much strain as one over springs, so the rule of xpbd holds.
        Or::Word(Auto::Auto) => {
            let rule = Settings::of("substeps=auto").with("iterations", iterations.unwrap_or(1));
            Method::find("xpbd")?.substeps(scene, &rule, dt)?
        }
    };
    let iterations = iterations.unwrap_or(SWEEPS.div_ceil(substeps));
    let config = VbdConfig {
        iterations,
        substeps,
        chebyshev_radius: match *own.chebyshev_radius {
            Or::Value(radius) => radius,
            Or::Word(Auto::Auto) if iterations >= LEAST_ACCELERATED => RADIUS,
            Or::Word(Auto::Auto) => 0.0,
        },
        air_drag: *own.air_drag,
        stiffness_damping: *own.stiffness_damping,
    };
    let energies = scene.model.energies().map_err(BenchError::usage)?;
    let solver = VertexBlockDescent::new(&scene.model.particles, energies, config);
    Ok(Box::new(solver))
}

fn main() -> ExitCode {
    cloth_bench::main_with(&[VBD]) // the one line
}

#[cfg(test)]
mod tests;

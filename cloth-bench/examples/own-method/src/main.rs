//! The whole program of the comparison, with one method more.
//!
//! ```sh
//! cd cloth-bench/examples/own-method
//! cargo run --release -- list
//! cargo run --release -- run hang --method descent --set iterations=50
//! cargo run --release -- study convergence collision --quick
//! ```

mod descent;

use cloth_bench::error::BenchError;
use cloth_bench::method::{Method, OwnMethod};
use cloth_bench::settings::{Parameter, parameter};
use descent::Descent;
use std::process::ExitCode;

const ITERATIONS: Parameter = parameter("iterations", "30", "steps of the descent per time step");

const DESCENT: Method = Method::own(OwnMethod {
    name: "descent",
    about: "implicit Euler by preconditioned gradient descent with a line search",
    parameters: &[ITERATIONS],
    build: |scene, settings, _| {
        let energies = scene.model.energies().map_err(BenchError::usage)?;
        let iterations = settings.count(&ITERATIONS, 1)?;
        Ok(Box::new(Descent::new(
            &scene.model.particles,
            energies,
            iterations,
        )))
    },
    aims_at_implicit_euler: true,
});

fn main() -> ExitCode {
    cloth_bench::main_with(&[DESCENT]) // the one line
}

#[cfg(test)]
mod tests;

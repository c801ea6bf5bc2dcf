//! The whole program of the comparison, with one method more: vertex block descent.
//!
//! ```sh
//! cd cloth-bench/examples/own-method
//! cargo run --release -- list
//! cargo run --release -- run hang --method vbd --set iterations=50
//! cargo run --release -- run drape-sphere --method vbd --dt 0.002
//! cargo run --release -- study convergence collision --quick
//! ```

mod contact;
mod vbd;

use cloth_bench::error::BenchError;
use cloth_bench::method::{Method, OwnMethod};
use cloth_bench::settings::{Range::AtLeast, Table};
use std::process::ExitCode;
use vbd::VertexBlockDescent;

cloth_bench::settings! {
    /// What can be set of it.
    struct Vbd {
        iterations: u32 = 100 in AtLeast(1.0), "sweeps over all vertices a step";
        rho: f64 = 0, "spectral radius of the Chebyshev acceleration, from 0 (none) to below 1";
    }
}

const VBD: Method = Method::own(OwnMethod {
    name: "vbd",
    about: "vertex block descent: implicit Euler by Gauss–Seidel over vertices",
    parameters: &[Vbd::PARAMETERS],
    build: |scene, settings, _| {
        let energies = scene.model.energies().map_err(BenchError::usage)?;
        let own = Vbd::read(settings)?;
        let (iterations, radius) = (*own.iterations, *own.rho);
        if !(0.0..1.0).contains(&radius) {
            return Err(own
                .rho
                .refuse(format!("rho = {radius} is not from 0 to below 1")));
        }
        let particles = &scene.model.particles;
        let solver = VertexBlockDescent::new(particles, energies, iterations, radius);
        Ok(Box::new(solver))
    },
    aims_at_implicit_euler: true,
});

fn main() -> ExitCode {
    cloth_bench::main_with(&[VBD]) // the one line
}

#[cfg(test)]
mod tests;

//! How fast the sweeps over a straight chain of rigid links converge.

use super::chains::chain;
use super::prelude::*;
use crate::settings::Or;
use cloth_core::method::position_based::{Acceleration, Chebyshev, Radius, Sweep};
use cloth_core::step::Observer;
use cloth_pbd::{PbdConfig, PbdSolver, StiffnessRule};
use cloth_xpbd::{XpbdConfig, XpbdSolver};
use std::f64::consts::FRAC_PI_2;

law! {
    CHAIN_RATE = "chain-rate" within 1e-10,
    "factor by which one sweep reduces the slowest error of a straight chain of N rigid links, held at one end: jacobi cos(π/2N), gauss-seidel cos²(π/2N), sor ω − 1 with ω = 2/(1 + sin(π/2N)), chebyshev cos(π/2N)/(1 + sin(π/2N))";
    chain_rate(ChainRateSettings {
        solver: Or<Sweeper, Solver> = "gauss-seidel",
            "jacobi, gauss-seidel, sor (at its best relaxation) or chebyshev (on jacobi); pbd or xpbd: gauss-seidel of \
             that method";
        method: Sweeper = "xpbd", "whose sweeps: pbd or xpbd";
        links: u32 = 20 in AtLeast(2.0), "number of links N";
    })
}

crate::choices! {
    /// A kind of sweep.
    #[derive(PartialEq)]
    enum Solver {
        Jacobi = "jacobi",
        GaussSeidel = "gauss-seidel",
        Sor = "sor",
        Chebyshev = "chebyshev",
    }
    /// Whose sweeps.
    enum Sweeper { Pbd = "pbd", Xpbd = "xpbd" }
}

/// The slowest error of a kind of sweep, and what a sweep leaves of it.
#[derive(Debug)]
struct Mode {
    factor: Real,
    sweep: Sweep,
    acceleration: Acceleration,
    sweeps: u32,
    /// Displacements (m) of the vertices along −z, from the held one.
    displacements: Vec<Real>,
    /// Part of the mode that is there after the last sweep.
    left: Real,
}

impl Mode {
    fn new(solver: Solver, links: u32) -> Self {
        let angle = FRAC_PI_2 / Real::from(links);
        let (sin, cos) = angle.sin_cos();
        let mut acceleration = Acceleration::default();
        let mut sweep = Sweep::Sequential;
        let (mut sweeps, mut size) = (3, 0.5);
        // The multipliers of the slowest mode are rʲ cos((j − 1)π/2N) in link j.
        let (factor, r) = match solver {
            Solver::Jacobi | Solver::Chebyshev => {
                sweep = Sweep::PlainJacobi;
                (cos, 1.0)
            }
            Solver::GaussSeidel => (cos * cos, cos),
            Solver::Sor => {
                acceleration.relaxation = 2.0 / (1.0 + sin);
                let factor = acceleration.relaxation - 1.0;
                (factor, factor.sqrt())
            }
        };
        let mut left = factor.powi(3);
        let mut law = factor;
        if solver == Solver::Chebyshev {
            let radius = Radius::Given(cos);
            acceleration.chebyshev = Some(Chebyshev { radius, delay: 1 });
            law = cos / (1.0 + sin);
            // k sweeps leave 1/T_k(1/ρ) = 1/cosh(k arcosh(1/ρ)), whose factor is the law's but for exp(−2k
            // arcosh(1/ρ)): here 1e-11. The mode starts large, so that some millionths of it are still well above
            // rounding.
            let decay = -law.ln();
            sweeps = (5.5 * std::f64::consts::LN_10 / decay).ceil().max(3.0) as u32;
            left = 2.0 * (-Real::from(sweeps) * decay).exp();
            size = 100.0;
        }
        let multiplier = |link: u32| {
            if link > links {
                return 0.0;
            }
            size * r.powi(link as i32 - 1) * (Real::from(link - 1) * angle).cos()
        };
        let displacement = |vertex| match vertex {
            0 => 0.0,
            _ => multiplier(vertex) - multiplier(vertex + 1),
        };
        Self {
            factor: law,
            sweep,
            acceleration,
            sweeps,
            displacements: (0..=links).map(displacement).collect(),
            left,
        }
    }

    /// Σ u², of the mode.
    fn square(&self) -> Real {
        self.displacements.iter().map(|u| u * u).sum()
    }
}

/// How much of the mode is there after each sweep, and how much else (m) after the last.
#[derive(Debug)]
struct Watch<'a> {
    mode: &'a Mode,
    parts: Vec<Real>,
    other: Real,
}

impl Observer for Watch<'_> {
    fn iteration(&mut self, _: u32, positions: &[Vec3]) {
        let off = |(i, p): (usize, &Vec3)| -p.z - i as Real;
        let off: Vec<Real> = positions.iter().enumerate().map(off).collect();
        let mode = &self.mode.displacements;
        let product: Real = off.iter().zip(mode).map(|(a, b)| a * b).sum();
        let part = product / self.mode.square();
        let other = off.iter().zip(mode).map(|(a, b)| (a - part * b).abs());
        self.other = other.fold(0.0, Real::max);
        self.parts.push(part);
    }
}

fn chain_rate(own: &ChainRateSettings) -> Result<Evaluation, BenchError> {
    let links = *own.links;
    within_reach(2e3 * Real::from(links))?;
    let (solver, sweeper) = match *own.solver {
        Or::Word(sweeper) => (Solver::GaussSeidel, sweeper),
        Or::Value(solver) => (solver, *own.method),
    };
    let mode = Mode::new(solver, links);
    let (particles, springs, mut state) = chain(vec![1.0; links as usize + 1], Real::INFINITY)?;
    for (x, displacement) in state.positions.iter_mut().zip(&mode.displacements) {
        x.z -= displacement;
    }
    let (iterations, sweep, acceleration) = (mode.sweeps, mode.sweep, mode.acceleration);
    let mut solver: Box<dyn Stepper> = if matches!(sweeper, Sweeper::Pbd) {
        let builder = PbdSolver::builder(&particles).elements(vec![Elements::Springs(springs)]);
        let config = PbdConfig {
            iterations,
            sweep,
            acceleration,
            stiffness: StiffnessRule::Fixed(1.0),
            ..Default::default()
        };
        Box::new(builder.config(config).build()?)
    } else {
        let builder = XpbdSolver::builder(&particles).elements(vec![Elements::Springs(springs)]);
        let config = XpbdConfig {
            iterations,
            substeps: 1,
            sweep,
            acceleration,
            ..XpbdConfig::default()
        };
        Box::new(builder.config(config).build()?)
    };
    let mut watch = Watch {
        mode: &mode,
        parts: Vec::new(),
        other: 0.0,
    };
    let input = StepInput::new(1.0).observer(&mut watch);
    solver.step(&mut state, input)?;
    let [.., before, last] = watch.parts[..] else {
        return Err(BenchError::Failed(
            "the solver reported fewer than two sweeps".into(),
        ));
    };
    // Positions are known to ε times the largest of them; the sum over the vertices averages over them.
    let largest = Real::from(links)
        + mode
            .displacements
            .iter()
            .fold(0.0, |a: Real, b| a.max(b.abs()));
    let rounding = 4.0 * Real::EPSILON * largest / (mode.left * mode.square().sqrt());
    Ok(Evaluation::new(mode.factor, last / before)
        .rounding(rounding)
        .detail("sweeps", Real::from(iterations))
        .detail("off_mode", watch.other))
}

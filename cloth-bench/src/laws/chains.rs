//! Chains: how far a chain sags, how it hangs.

use super::prelude::*;
use cloth_core::method::position_based::Sweep;
use cloth_massspring::{ImplicitConfig, ImplicitEuler};
use cloth_xpbd::{XpbdConfig, XpbdSolver};
use nalgebra::DVector;

law! {
    SAG = "sag" within 1e-10,
    "sag (m) of a hanging chain of rigid links at rest under XPBD: g h² Σ (mass below vertex i)/mᵢ over the vertices between support and tip for one sweep from the support, which is g h² N(N − 1)/2 for equal masses; else the fixed point of the sweeps as a matrix";
    sag(SagSettings {
        links: u32 = 20 in AtLeast(1.0), "number of links N";
        substeps: u32 = 10 in AtLeast(1.0), "parts of the step of 1/60 s";
        iterations: u32 = 1 in AtLeast(1.0), "sweeps per substep";
        tip_mass: Real = 1 "kg" in Above(0.0), "mass of the last vertex; the others have 1 kg";
    })
}

law! {
    HANGING_CHAIN = "hanging-chain" within 1e-10,
    "displacement (m) of the tip of a hanging elastic chain: n(n + 1)mg/(2k) + nMg/k";
    hanging_chain(HangingChainSettings {
        links: u32 = 20 in AtLeast(1.0), "number of links N";
        stiffness: Real = 1e4 "N/m" in Above(0.0), "stiffness k of every link";
        mass: Real = 0.1 "kg" in Above(0.0), "mass m of every vertex";
        tip_mass: Real = 1 "kg", "further mass M at the tip";
    })
}

pub(super) const GRAVITY: Real = 9.81;

/// A chain along −z of links of 1 m, held at the top.
pub(super) fn chain(
    masses: Vec<Real>,
    stiffness: Real,
) -> Result<(Particles, Vec<Spring>, State), BenchError> {
    let links = masses.len() - 1;
    let mut particles = Particles::new(masses).map_err(BenchError::usage)?;
    particles.prescribe(0)?;
    let positions: Vec<Vec3> = (0..=links)
        .map(|i| Vec3::new(0.0, 0.0, -(i as Real)))
        .collect();
    let ends: Vec<[u32; 2]> = (0..links as u32).map(|i| [i, i + 1]).collect();
    let springs = Spring::along(&positions, &ends, stiffness);
    Ok((particles, springs, State::at_rest(positions)))
}

/// Steps after which a chain that still moves is given up.
const MOST_STEPS: u32 = 100_000;

fn sag(own: &SagSettings) -> Result<Evaluation, BenchError> {
    let (links, substeps, iterations) = (*own.links, *own.substeps, *own.iterations);
    let [n, of_substeps, sweeps] = [links, substeps, iterations].map(Real::from);
    // The matrix of the sweeps is made one sweep after the other.
    within_reach(n.powi(3) * (sweeps + 10.0) + 30.0 * n * of_substeps * sweeps)?;
    let links = links as usize;
    let tip = *own.tip_mass;
    let mut masses = vec![1.0; links + 1];
    masses[links] = tip;
    let h = 1.0 / 60.0 / Real::from(substeps);
    let (particles, springs, start) = chain(masses, Real::INFINITY)?;
    let matrix = SweepMatrix::new(&particles, iterations);
    let expected = if iterations == 1 {
        // Link i ends as long as link i + 1 pulls its lower end away, by wᵢ λᵢ₊₁, and λᵢ₊₁ = g h² (mass below vertex
        // i).
        let n = links as Real;
        GRAVITY * h * h * (n * (n - 1.0) / 2.0 + (n - 1.0) * (tip - 1.0))
    } else {
        matrix.sag(GRAVITY * h * h)?
    };
    let solver = |substeps| {
        let builder =
            XpbdSolver::builder(&particles).elements(vec![Elements::Springs(springs.clone())]);
        let config = XpbdConfig {
            iterations,
            substeps,
            sweep: Sweep::Sequential,
            ..Default::default()
        };
        builder.config(config).build().map_err(BenchError::failed)
    };
    // How far a step from rest moves the free vertices, u (m) below their places.
    let step = |solver: &mut XpbdSolver, dt, u: &DVector<Real>| {
        let mut state = start.clone();
        for (p, u) in state.positions[1..].iter_mut().zip(u.iter()) {
            p.z -= u;
        }
        let before = state.positions.clone();
        let input = StepInput::new(dt).gravity(Vec3::z() * -GRAVITY);
        solver.step(&mut state, input)?;
        let moved = before.iter().zip(&state.positions).skip(1);
        let moved = moved.map(|(before, after)| before.z - after.z);
        Ok::<_, BenchError>(DVector::from_iterator(links, moved))
    };
    // Rest under one substep is rest under many; the whole step then tells how far it is from its own.
    let mut one = solver(1)?;
    let (rest, steps) = matrix.rest(|u| step(&mut one, h, u))?;
    let moved = step(&mut solver(substeps)?, 1.0 / 60.0, &rest)?;
    let sag = (rest + matrix.to_rest(&moved, substeps)?)[links - 1];
    let scale = if expected == 0.0 { 1.0 } else { expected.abs() };
    let rounding = 4.0 * matrix.rounding(sag)? / scale + matrix.own_rounding(iterations)?;
    Ok(Evaluation::new(expected, sag)
        .rounding(rounding)
        .detail("steps", Real::from(steps)))
}

/// `n` Gauss–Seidel sweeps over a vertical chain of rigid links, as a matrix that acts on the displacements of the free
/// vertices.
#[derive(Debug)]
struct SweepMatrix(nalgebra::DMatrix<Real>);

impl SweepMatrix {
    /// Where the solver comes to rest: the displacements (m) that its substep leaves alone, and the substeps taken to
    /// find them. `step` tells how far a substep moves the free vertices from rest.
    ///
    /// To wait would take more than 10⁶ steps for a heavy tip. At rest every velocity is zero, and a step from u moves
    /// it by `r = F(u) − u`. The next u is `u + (I − S)⁻¹ r`: this finds the fixed point of F, wherever it is, if S is
    /// near to what a substep does.
    fn rest(
        &self,
        mut step: impl FnMut(&DVector<Real>) -> Result<DVector<Real>, BenchError>,
    ) -> Result<(DVector<Real>, u32), BenchError> {
        let mut u = DVector::zeros(self.0.nrows());
        for steps in 1..=MOST_STEPS {
            let change = self.to_rest(&step(&u)?, 1)?;
            u += &change;
            if change.amax() <= 1e-14 * u.amax() + self.rounding(u.amax())? {
                return Ok((u, steps));
            }
        }
        Err(BenchError::Failed(format!(
            "the chain is not at rest after {MOST_STEPS} steps"
        )))
    }

    /// The way to rest (m) of what a step of `substeps` parts moves by r (m): `(I − S)⁻¹ r` over `n(n + 1)/2`, since
    /// near rest n substeps go so many times as far as one.
    fn to_rest(&self, r: &DVector<Real>, substeps: u32) -> Result<DVector<Real>, BenchError> {
        let n = Real::from(substeps);
        Ok(self.solve(r)? / (0.5 * n * (n + 1.0)))
    }

    /// `(I − S)⁻¹ r`.
    fn solve(&self, r: &DVector<Real>) -> Result<DVector<Real>, BenchError> {
        let n = self.0.nrows();
        let system = nalgebra::DMatrix::identity(n, n) - &self.0;
        let solved = system.lu().solve(r);
        solved.ok_or_else(|| BenchError::Failed("the sweeps have no fixed point".into()))
    }

    /// What rounding does to the fixed point (m), for displacements of `size` (m): positions are known to ε, and
    /// `(I − S)⁻¹` magnifies what is unknown.
    fn rounding(&self, size: Real) -> Result<Real, BenchError> {
        let n = self.0.nrows() as Real;
        Ok(2.0 * Real::EPSILON * (n + size) * self.magnified()?)
    }

    /// What rounding does to [`Self::sag`] (relative): each sweep rounds the matrix by some ε, and `(I − S)⁻¹`
    /// magnifies it.
    fn own_rounding(&self, iterations: u32) -> Result<Real, BenchError> {
        Ok(2.0 * Real::EPSILON * Real::from(iterations) * self.magnified()?)
    }

    /// The largest row sum of `(I − S)⁻¹`.
    fn magnified(&self) -> Result<Real, BenchError> {
        let ones = DVector::from_element(self.0.nrows(), 1.0);
        Ok(self.solve(&ones)?.amax())
    }

    fn new(particles: &Particles, iterations: u32) -> Self {
        let w = particles.inverse_mass();
        let n = w.len() - 1;
        let mut sweep = nalgebra::DMatrix::<Real>::identity(n + 1, n + 1);
        for link in 0..n {
            // The link brings its ends together by their difference, shared as their inverse masses.
            let difference = sweep.row(link + 1) - sweep.row(link);
            let total = w[link] + w[link + 1];
            for (vertex, sign) in [(link, 1.0), (link + 1, -1.0)] {
                let moved = sweep.row(vertex) + &difference * (sign * w[vertex] / total);
                sweep.set_row(vertex, &moved);
            }
        }
        let free = sweep.view((1, 1), (n, n)).into_owned();
        Self((1..iterations).fold(free.clone(), |power, _| power * &free))
    }

    /// The displacement of the tip that the sweeps just restore after every vertex has dropped by `drop`:
    /// `u = S (u + drop)`.
    fn sag(&self, drop: Real) -> Result<Real, BenchError> {
        let n = self.0.nrows();
        let dropped = &self.0 * DVector::from_element(n, drop);
        Ok(self.solve(&dropped)?[n - 1])
    }
}

fn hanging_chain(own: &HangingChainSettings) -> Result<Evaluation, BenchError> {
    let links = *own.links;
    within_reach(2e6 * Real::from(links))?;
    let links = links as usize;
    let (k, m, extra) = (*own.stiffness, *own.mass, *own.tip_mass);
    let mut masses = vec![m; links + 1];
    masses[links] = m + extra;
    let (particles, springs, mut state) = chain(masses, k)?;
    let mut solver = ImplicitEuler::builder(&particles)
        .elements(vec![Elements::Springs(springs)])
        .config(ImplicitConfig {
            tolerance: 0.0,
            ..Default::default()
        })
        .build()?;
    // A step of a thousand seconds leaves next to nothing of the inertia; a few of them leave nothing.
    for _ in 0..10 {
        let input = StepInput::new(1e3).gravity(Vec3::z() * -GRAVITY);
        solver.step(&mut state, input)?;
    }
    let n = links as Real;
    let expected = n * (n + 1.0) * m * GRAVITY / (2.0 * k) + n * extra * GRAVITY / k;
    Ok(Evaluation::new(expected, -state.positions[links].z - n))
}

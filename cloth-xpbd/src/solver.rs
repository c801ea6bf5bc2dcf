//! The solver: the loop over substeps and sweeps.

mod builder;

pub use builder::XpbdBuilder;

use crate::config::XpbdConfig;
use crate::refinement::{Refinement, external_work, kinetic};
use crate::update::XpbdUpdate;
use cloth_core::math::{Real, Vec3};
use cloth_core::method::position_based::{Families, Motion};
use cloth_core::particles::{Particles, State};
use cloth_core::step::{StepError, StepInput, StepReport, Stepper};

/// Extended position-based dynamics; see the [crate documentation](crate).
///
/// # What a step costs
/// **A sweep**, in ns per element, on one thread of a 2-core AMD EPYC (Zen 3) with AVX2, plain release build
/// (`cargo bench -p benches --bench sweeps` at commit 67220442, the smallest sample of each):
///
/// | vertices a side | springs | quadratic hinges | springs, single precision (`single::SingleXpbd`) | springs, naive loop |
/// |---|---|---|---|---|
/// | 64 | 5.2 | 7.9 | 2.5 | 13.4 |
/// | 128 | 5.2 | 8.0 | 2.5 | 13.5 |
/// | 256 | 5.5 | 10.4 | 2.5 | 13.6 |
/// | 512 | 5.4 | 10.4 | | 13.4 |
/// | 1000 | 6.1 | 12.9 | | 13.6 |
///
/// What takes the time is the chain of load, root, quotient and store of each spring. The naive loop visits springs in
/// the order of their vertices, each waiting for the one before it; those of a colour do not wait for one another.
///
/// **A visit of a spring** computes d = x₀ − x₁, ‖d‖² and its root, C, `C + α̃λ`, w̃ + α̃ and one quotient, Δλ/‖d‖;
/// then λ and both ends move: 16 sums, 15 products, one root, one quotient. It touches 112 bytes: vertex numbers (of
/// the element 8, of the sweep 8), rest length and k (16; α̃ stands for k), λ and α̃ (16), two positions (48) and two
/// inverse masses (16). It writes λ (8) and the positions (48). Of these, 48 bytes are the spring's own and read once a
/// sweep, in order. Positions and inverse masses, 32 bytes a vertex, are read by each of its springs, some six, out of
/// a cache where they fit.
///
/// **Memory** in bytes a vertex, of a large sheet with three springs and three hinges for each:
///
/// | what | bytes |
/// |---|---|
/// | inverse mass; x, v and x̃ | 8 + 3 · 24 = 80 |
/// | springs: 24 each, their vertices again 8, place in the input 4, λ and α̃ 16 | 3 · 52 = 156 |
/// | quadratic hinges: 56, 16, 4, and of three rows 48 | 3 · 124 = 372 |
/// | sum | 608 |
/// | with contact: x at the start of the substep | 24 |
/// | with damping: the offset of λ for each row | 12 · 8 = 96 |
/// | with [`Chebyshev`](cloth_core::method::position_based::Chebyshev): λ and α̃ of the two sweeps before, and x | 2 · 12 · 16 + 48 = 432 |
///
/// The state (48 bytes), the masses and the mesh are the caller's.
///
/// Vertices should be numbered along the mesh, or along a curve that fills space and so keeps neighbours close,
/// [`Order::morton`](cloth_core::method::ordering::Order::morton).
///
/// **The rest of a substep**, without contact, damping and extrapolation: x̃ and its copy, the velocities, and λ set to
/// zero. So a step of V vertices in s substeps of n sweeps takes about `s V (a n + b)` ns, linear in V for given s and
/// n. (Besides, a step copies the state in and out once.)
///
/// **a and b measured** (2 cores of an Intel Xeon VM, commit 3158c95, median of 60 steps):
/// `run hang --n 64 --steps 60 --method xpbd --threads 1 --set energy_gain=none --set substeps=177 --set iterations=1`
/// of `cloth-bench`, and 2. A step takes 39.8 ms with one sweep a substep, 73.1 ms with two. The difference is 188 µs a
/// sweep, and what is left of a substep 37 µs: a = 46 and b = 9, of 4096 vertices. So a substep with its one sweep
/// costs 1.2 times what one more sweep does. (It is another machine than that of the table above.)
///
/// # Rounding
/// A position of size s is known to ε s, with ε = 1.1·10⁻¹⁶ in double precision and 6·10⁻⁸ in single. A substep moves a
/// vertex by some g h² against that, so a correction has d digits where `h > √(10^d ε s/g)`; and `(x − x̃)/h` adds a
/// noise of ε s/h to v. At s = 1 m:
///
/// | precision | noise in v at h = 1/1200 s | digits there | two digits from | five digits from |
/// |---|---|---|---|---|
/// | double | 1.3·10⁻¹³ m/s | 10 | 33 ns | 1 µs |
/// | single | 7·10⁻⁵ m/s | 2 | 0.8 ms | 25 ms |
///
/// So `single` adds the changes by its sweeps to positions in double precision: the noise stays, but does not drift.
///
/// **Bits on other machines.** A sum, a product, a quotient or a root is rounded as IEEE 754 says, and a product and a
/// sum are never fused. Springs, quadratic hinges and StVK triangles need nothing else, so in double precision their
/// sweeps have the same bits on every processor that keeps to that standard. What takes an angle or singular values
/// (`DihedralHinge`, `ArapTriangle`, `ArapTetrahedron`, `StrainLimitTriangle`) calls `atan2`, `sin` or `cos`, and an
/// estimated ρ of `Chebyshev` `cosh` and `acosh`: their last bits may differ between platforms. Tests compare numbers
/// of threads only. The direct solver factorises on one thread; its bits on another processor are not promised.
#[derive(Debug)]
pub struct XpbdSolver {
    pub(crate) motion: Motion,
    pub(crate) families: Families<XpbdUpdate>,
    config: XpbdConfig,
    /// None unless the settings ask for it.
    refinement: Option<Refinement>,
    /// With the substep of the last step, once one was taken.
    pub(crate) last: Option<XpbdUpdate>,
    /// The update whose α̃ the families hold.
    prepared: Option<XpbdUpdate>,
    /// `λ − ν` of the rows of each family in the last substep, in the order in which they were added; empty if nothing
    /// is damped.
    pub(crate) offsets: Vec<Vec<Real>>,
    /// `λ − ν` of the rows with a prescribed vertex, in the order of [`Families::inspect_prescribed`]; empty
    /// unless such a vertex moves and there is damping.
    pub(crate) prescribed_offsets: Vec<Real>,
}

impl Stepper for XpbdSolver {
    fn name(&self) -> &'static str {
        "xpbd"
    }

    fn step(
        &mut self,
        state: &mut State,
        mut input: StepInput<'_>,
    ) -> Result<StepReport, StepError> {
        input.check(state, self.motion.vertex_count())?;
        let fallbacks_before = self.families.chebyshev_fallbacks();
        let before = self.energy_before(state, input.dt);
        // After a step that failed the multipliers may be no numbers.
        if self.last.take().is_none() {
            self.prepared = None;
        }
        let (mut sweeps, mut refinements) = (0, 0);
        let refinement_before = self.refinement;
        let update = loop {
            let count = self.config.substeps;
            let refinement = self.refinement.as_ref();
            let substeps = refinement.map_or(count, |refinement| refinement.substeps(count));
            let update = match self.try_step(state, &mut input, substeps) {
                Ok(update) => update,
                Err(error) => {
                    self.refinement = refinement_before;
                    return Err(error);
                }
            };
            sweeps += self.motion.iterations();
            if !self.refines(state, &mut input, before) {
                break update;
            }
            refinements += 1;
        };
        let report = self.motion.finish(state, &mut input)?;
        self.last = Some(update);
        Ok(StepReport {
            iterations: sweeps,
            refinements,
            chebyshev_fallbacks: (self.families.chebyshev_fallbacks() - fallbacks_before) as u32,
            ..report
        })
    }
}

impl XpbdSolver {
    /// Starts with the masses and prescribed vertices of `particles` as they are now, and without constraints.
    #[must_use]
    pub fn builder(particles: &Particles) -> XpbdBuilder {
        XpbdBuilder::new(particles)
    }

    /// Takes a step by so many substeps, all but its end.
    fn try_step(
        &mut self,
        state: &State,
        input: &mut StepInput<'_>,
        substeps: u32,
    ) -> Result<XpbdUpdate, StepError> {
        self.motion.begin(state, input)?;
        let h = input.dt / Real::from(substeps);
        let update = XpbdUpdate::new(h, self.config.damping);
        for substep in 1..=substeps {
            let begun = state.time + Real::from(substep - 1) * h;
            self.begin_substep(update, begun, substep == substeps); // λ = 0, here and not in each iteration
            self.families.set_time(state.time + Real::from(substep) * h);
            self.motion.predict(input, h)?; // v ← v + h a, x̃ ← x + h v
            self.families.restart();
            for _ in 0..self.config.iterations {
                self.motion.iterate(input, |w, x| {
                    self.families.sweep(&update, w, x); // Δλ of every row, x moved along
                });
            }
            self.count_pin_work(input);
            self.motion.update_velocities(input)?; // v ← v + (x − x̃)/h
        }
        Ok(update)
    }

    /// `K + E` (J) before a step of `dt` (s), E with the elements as they are at its end; 0 if no step is refined.
    fn energy_before(&mut self, state: &State, dt: Real) -> Real {
        let Some(refinement) = &self.refinement else {
            return 0.0;
        };
        let is_first = refinement.held.is_none();
        let kinetic = kinetic(self.motion.inverse_mass(), &state.velocities);
        if is_first {
            self.families.set_time(state.time);
            let held = Some(self.elastic(&state.positions) + kinetic);
            self.refinement.iter_mut().for_each(|own| own.held = held);
        }
        self.families.set_time(state.time + dt);
        self.elastic(&state.positions) + kinetic
    }

    /// Whether the step that was tried is to be taken again.
    fn refines(&mut self, state: &State, input: &mut StepInput<'_>, before: Real) -> bool {
        if self.refinement.is_none() {
            return false;
        }
        let (w, x) = (self.motion.inverse_mass(), self.motion.positions());
        let after = self.elastic(x) + kinetic(w, self.motion.velocities());
        let mut given = self.motion.pin_work() + external_work(w, state, x, input);
        given += input.contact_constraints().map_or(0.0, |c| c.given(x));
        let refinement = self.refinement.as_mut();
        refinement.is_some_and(|refinement| refinement.refines([before, after], given))
    }

    /// `½ Σ k C²` (J) of all rows of finite stiffness at `x` (m).
    fn elastic(&self, x: &[Vec3]) -> Real {
        let mut sum = 0.0;
        self.families
            .each_row(self.motion.inverse_mass(), x, |row, _| {
                if row.stiffness.is_finite() {
                    sum += 0.5 * row.stiffness * row.value * row.value;
                }
            });
        sum
    }

    /// Sets λ of every row to zero, once per substep, which begins at `time` (s). Damped it sets ν to `−k h β C⁰`, with
    /// the C⁰ of the positions and the rest data at that time, and keeps `k h β C⁰` of the last substep, to read λ out.
    fn begin_substep(&mut self, update: XpbdUpdate, time: Real, is_last: bool) {
        let damped = self.config.damping > 0.0;
        if !damped && self.prepared == Some(update) {
            self.families.reset();
            return;
        }
        let (w, x) = (self.motion.inverse_mass(), self.motion.positions());
        if damped {
            self.families.set_time(time);
        }
        self.families.prepare(&update, w, x);
        self.prepared = Some(update);
        if !damped {
            return;
        }
        self.prescribed_offsets.clear();
        if self.motion.needs_pin_forces() {
            let offsets = &mut self.prescribed_offsets;
            self.families
                .inspect_prescribed(w, x, |seen| offsets.push(-seen.memory.lambda()));
        }
        if is_last {
            self.offsets.resize(self.families.len(), Vec::new());
            for (family, offsets) in self.offsets.iter_mut().enumerate() {
                self.families
                    .read_memory(family, offsets, |memory| -memory.lambda());
            }
        }
    }

    /// The settings.
    #[must_use]
    pub fn config(&self) -> &XpbdConfig {
        &self.config
    }

    /// How many substeps, since the solver was built, disabled Chebyshev extrapolation because it made the
    /// corrections grow; see [`Chebyshev`](cloth_core::method::position_based::Chebyshev).
    #[must_use]
    pub fn chebyshev_fallbacks(&self) -> u64 {
        self.families.chebyshev_fallbacks()
    }

    /// `max |C + α̃λ|` (damped: `|C + α̃ν|`) over all rows (unit of C; m for springs and hinges) at `positions`
    /// (m), with the multipliers of the last substep: what the sweeps of that substep bring to zero. At the
    /// positions that the step ended at, and where contact moved nothing, it is the residual of the sweeps.
    ///
    /// Rows that no multiplier can change (no stiffness; hard, with all vertices prescribed) are left out.
    /// Before the first step, and after one that has failed, it is 0.
    ///
    /// # How to read it
    /// A residual r of a spring is the part of its stretch that its tension −λ/h² does not explain: `C = −α̃λ + r`. So
    /// r/l is the strain that unconverged sweeps add to the elastic one, and k r the force by which λ/h² exceeds −k C.
    /// Of a hard row r is C itself, its error. A visit leaves r = 0 in its own rows, so r is what the visits after it
    /// have undone.
    ///
    /// A hanging chain, swept from the support once a substep, keeps at rest `r = g h² (mass below vertex i)/mᵢ` in
    /// link i, whatever its k. Of equal masses the first link has the most, `g h² (N − 1)`: with 24 links of 1/24 m it
    /// is 63 mm for h = 1/60 s, and 0.16 mm or a strain of 0.38 % for h = 1/1200 s. More sweeps of a substep multiply
    /// r, in the end, by [ρ each](XpbdConfig#how-fast-sweeps-converge), down to rounding: below 1e-14 m after 4000
    /// sweeps of ten swinging links of 0.1 m (`tests/all/chapter.rs`).
    ///
    /// To choose a number of sweeps, compare r/l with the strain that may be seen. A small r does not say that the step
    /// is that of implicit Euler (see [limits](crate#limits)), nor that h is short enough for the motion.
    ///
    /// # Panics
    /// If there is not one position per vertex.
    #[must_use]
    pub fn compliance_residual(&self, positions: &[Vec3]) -> Real {
        assert_eq!(
            positions.len(),
            self.motion.vertex_count(),
            "number of positions"
        );
        let mut largest: Real = 0.0;
        if self.last.is_some() {
            self.families
                .each_row(self.motion.inverse_mass(), positions, |row, memory| {
                    if let Some(violation) = memory.violation(row) {
                        largest = largest.max(violation.abs());
                    }
                });
        }
        largest
    }
}

//! Sweeps of every kind and their acceleration, against the closed forms of the straight chain
//! and on sheets.

use cloth_core::energy::{CurvatureHinge, Spring};
use cloth_core::error::OutOfRange;
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{Diagonals, grid, irregular};
use cloth_core::method::position_based::{
    Acceleration, Chebyshev, ConstraintUpdate, Families, Radius, RowEquation, RowState, Sweep,
};
use cloth_core::step::BuildError;
use cloth_core::topology::{EdgeTable, HingeTable};
use std::f64::consts::PI;

/// `Δλ = −C/w̃`, with the sum of what was really made of it.
#[derive(Clone, Copy, Debug)]
struct Rigid;

impl ConstraintUpdate for Rigid {
    type Memory = Real;
    fn equation(&self, row: RowState, _: &mut Real) -> RowEquation {
        RowEquation {
            residual: row.value,
            scaled_compliance: 0.0,
        }
    }

    fn accumulate(&self, change: Real, total: &mut Real) {
        *total += change;
    }

    fn extrapolate(now: &mut Real, before: &Real, omega: Real) {
        *now = before + omega * (*now - before);
    }
}

const SWEEPS: [Sweep; 4] = [
    Sweep::Sequential,
    Sweep::Colored,
    Sweep::Jacobi,
    Sweep::PlainJacobi,
];

fn relaxed(relaxation: Real) -> Acceleration {
    Acceleration {
        relaxation,
        ..Acceleration::default()
    }
}

fn chebyshev(radius: Radius, delay: u32) -> Acceleration {
    Acceleration {
        chebyshev: Some(Chebyshev { radius, delay }),
        ..Acceleration::default()
    }
}

/// A straight chain of N links of 1 m along x, equal masses, held at its first vertex.
struct Chain {
    links: u32,
    w: Vec<Real>,
    families: Families<Rigid>,
    /// Size (m) of the mode that is put in.
    size: Real,
}

impl Chain {
    fn new(links: u32, sweep: Sweep, acceleration: Acceleration) -> Self {
        let spring = |i| Spring {
            vertices: [i, i + 1],
            rest_length: 1.0,
            stiffness: 1.0,
        };
        let mut w = vec![4.0; links as usize + 1];
        w[0] = 0.0;
        let mut families = Families::new(w.len(), sweep, acceleration).unwrap();
        families
            .add(&(0..links).map(spring).collect::<Vec<_>>())
            .unwrap();
        families.restart();
        Self {
            links,
            w,
            families,
            size: 1.0,
        }
    }

    /// The positions that are off by `size · Jᵀe` with `eⱼ = rʲ cos((j − 1)π/2N)`: the slowest mode of Jacobi
    /// for r = 1, of Gauss–Seidel for `r = cos(π/2N)`, of SOR with factor λ for `r = √λ`.
    fn off_by_mode(&self, r: Real) -> Vec<Vec3> {
        let angle = PI / (2.0 * Real::from(self.links));
        let e = |link: u32| {
            if link > self.links {
                return 0.0;
            }
            self.size * r.powi(link as i32) * (Real::from(link - 1) * angle).cos()
        };
        let place = |i: u32| {
            let off = if i == 0 { 0.0 } else { e(i) - e(i + 1) };
            Vec3::new(Real::from(i) + off, 0.0, 0.0)
        };
        (0..=self.links).map(place).collect()
    }

    fn errors(&self, x: &[Vec3]) -> Vec<Real> {
        (0..).zip(x).map(|(i, x)| x.x - Real::from(i)).collect()
    }

    /// What each of some sweeps leaves of the mode, after making sure that it leaves the mode a mode.
    fn factors(&mut self, r: Real, sweeps: u32) -> Vec<Real> {
        let mut x = self.off_by_mode(r);
        let mode = self.errors(&x);
        let square: Real = mode.iter().map(|e| e * e).sum();
        let mut part = 1.0;
        let mut factors = Vec::new();
        for _ in 0..sweeps {
            self.families.sweep(&Rigid, &self.w, &mut x);
            let errors = self.errors(&x);
            let now = errors.iter().zip(&mode).map(|(a, b)| a * b).sum::<Real>() / square;
            for (error, mode) in errors.iter().zip(&mode) {
                let bent = (error - now * mode).abs();
                assert!(bent < 1e-11 * self.size, "{bent:e}");
            }
            factors.push(now / part);
            part = now;
        }
        factors
    }

    fn leaves(&mut self, r: Real, factor: Real) {
        for (sweep, measured) in self.factors(r, 4).iter().enumerate() {
            let error = (measured / factor - 1.0).abs();
            assert!(
                error < 1e-10,
                "{} links, sweep {sweep}: {error:e}",
                self.links
            );
        }
    }
}

#[test]
fn every_kind_of_sweep_leaves_of_a_chain_what_its_closed_form_says() {
    for links in [2, 5, 20, 60] {
        let angle = PI / (2.0 * Real::from(links));
        let chain = |sweep, relaxation| Chain::new(links, sweep, relaxed(relaxation));
        chain(Sweep::PlainJacobi, 1.0).leaves(1.0, angle.cos());
        chain(Sweep::Jacobi, 1.0).leaves(1.0, (angle / 2.0).cos().powi(2));
        chain(Sweep::Jacobi, 1.9).leaves(1.0, 1.0 - 1.9 * (angle / 2.0).sin().powi(2));
        chain(Sweep::Sequential, 1.0).leaves(angle.cos(), angle.cos().powi(2));
        // SOR: λ + ω − 1 = √λ ω cos(π/2N), with a double root at the best ω.
        let best = 2.0 / (1.0 + angle.sin());
        chain(Sweep::Sequential, best).leaves((best - 1.0).sqrt(), best - 1.0);
        let omega = 1.1;
        let b = omega * angle.cos();
        let root = (b + (b * b - 4.0 * (omega - 1.0)).sqrt()) / 2.0;
        chain(Sweep::Sequential, omega).leaves(root, root * root);
    }
}

/// Links 0, 2, 4, … first: the other order of Gauss–Seidel has another slowest mode, and the same factor.
#[test]
fn coloured_sweeps_converge_at_the_rate_of_gauss_seidel() {
    let mut chain = Chain::new(12, Sweep::Colored, Acceleration::default());
    let mut x = chain.off_by_mode(1.0);
    let mut before = 0.0;
    let mut factor = 0.0;
    for _ in 0..400 {
        chain.families.sweep(&Rigid, &chain.w, &mut x);
        let now = x.iter().zip(0..).map(|(x, i)| (x.x - f64::from(i)).powi(2));
        let now = now.sum::<Real>().sqrt();
        (factor, before) = (now / before, now);
    }
    let law = (PI / 24.0).cos().powi(2);
    assert!((factor - law).abs() < 1e-10, "{factor} {law}");
}

/// k accelerated sweeps leave `1/T_k(1/ρ)` of the slowest mode, whatever kind of sweep has that ρ; per sweep
/// `ρ/(1 + √(1 − ρ²))` in the end.
#[test]
fn chebyshev_leaves_what_the_polynomial_says() {
    for links in [2, 5, 20] {
        let cos = (PI / (2.0 * Real::from(links))).cos();
        let kinds = [(Sweep::PlainJacobi, cos), (Sweep::Jacobi, 0.5 + 0.5 * cos)];
        for (sweep, radius) in kinds {
            let mut chain = Chain::new(links, sweep, chebyshev(Radius::Given(radius), 1));
            chain.size = 100.0;
            let decay = (1.0 / radius).acosh();
            let law = |k: usize| 1.0 / (k as Real * decay).cosh();
            let sweeps = (10.0 / decay).min(60.0) as usize;
            for (k, factor) in chain.factors(1.0, sweeps as u32).iter().enumerate() {
                let error = (factor * law(k) / law(k + 1) - 1.0).abs();
                // The factor is known as well as what is left of the mode.
                assert!(
                    error < 1e-13 + 1e-15 / law(k + 1),
                    "{sweep:?} {links} {k}: {error:e}"
                );
            }
            assert_eq!(chain.families.chebyshev_fallbacks(), 0);
        }
        // Plain Jacobi's, in its closed form.
        let (sin, decay) = ((1.0 - cos * cos).sqrt(), (1.0 / cos).acosh());
        assert!(((-decay).exp() - cos / (1.0 + sin)).abs() < 1e-14);
    }
}

#[test]
fn a_delay_puts_the_recurrence_off() {
    let radius = (PI / 10.0).cos();
    let mut chain = Chain::new(5, Sweep::PlainJacobi, chebyshev(Radius::Given(radius), 4));
    let factors = chain.factors(1.0, 6);
    let second = 2.0 * (1.0 / radius).powi(2) - 1.0; // T₂(1/ρ)
    for (k, law) in [radius, radius, radius, radius, 1.0 / (radius * second)]
        .iter()
        .enumerate()
    {
        assert!(
            (factors[k] - law).abs() < 1e-13,
            "{k}: {} {law}",
            factors[k]
        );
    }
    // A new substep starts again with plain sweeps.
    chain.families.restart();
    assert!((chain.factors(1.0, 1)[0] - radius).abs() < 1e-13);
}

/// Sweeps until the error of a chain of 30 links is a thousandth of what it was.
fn sweeps_to_a_thousandth(sweep: Sweep, acceleration: Acceleration) -> u32 {
    let mut chain = Chain::new(30, sweep, acceleration);
    let mut x: Vec<Vec3> = (0..=30)
        .map(|i| Vec3::new(f64::from(i) * 1.01, 0.0, 0.0))
        .collect();
    let error = |x: &[Vec3]| {
        (0..)
            .zip(x)
            .map(|(i, x)| (x.x - f64::from(i)).powi(2))
            .sum::<Real>()
            .sqrt()
    };
    let wanted = 1e-3 * error(&x);
    (1..100_000)
        .find(|_| {
            chain.families.sweep(&Rigid, &chain.w, &mut x);
            error(&x) < wanted
        })
        .expect("converges")
}

#[test]
fn an_estimated_radius_is_nearly_as_good_as_the_true_one() {
    let cos = (PI / 60.0).cos();
    for (sweep, radius) in [
        (Sweep::Jacobi, 0.5 + 0.5 * cos),
        (Sweep::PlainJacobi, cos),
        (Sweep::Sequential, cos * cos),
    ] {
        let plain = sweeps_to_a_thousandth(sweep, Acceleration::default());
        let given = sweeps_to_a_thousandth(sweep, chebyshev(Radius::Given(radius), 1));
        let estimated = sweeps_to_a_thousandth(sweep, chebyshev(Radius::Estimated, 4));
        println!("{sweep:?}: {plain} plain, {given} with ρ given, {estimated} with ρ estimated");
        assert!(given * 10 < plain, "{sweep:?}");
        assert!(estimated < 3 * given, "{sweep:?}");
    }
}

fn wave(v: usize, a: Real) -> Real {
    (a * v as Real).sin()
}

/// A sheet of springs and hinges with uneven masses, and the same pulled out of shape.
struct Sheet {
    w: Vec<Real>,
    springs: Vec<Spring>,
    hinges: Vec<CurvatureHinge>,
    x: Vec<Vec3>,
}

impl Sheet {
    fn of(mesh: &TriMesh) -> Self {
        let edges = EdgeTable::build(mesh).unwrap();
        let shaken =
            |(v, x): (usize, &Vec3)| x + Vec3::new(wave(v, 1.7), wave(v, 2.3), wave(v, 0.9)) * 0.02;
        Self {
            w: (0..mesh.vertex_count())
                .map(|v| 1.0 + (v % 5) as Real)
                .collect(),
            springs: Spring::along(mesh.positions(), edges.ends(), 1.0),
            hinges: CurvatureHinge::across(mesh, &HingeTable::build(mesh, &edges), 1.0),
            x: mesh.positions().iter().enumerate().map(shaken).collect(),
        }
    }

    fn families(&self, sweep: Sweep, acceleration: Acceleration) -> Families<Rigid> {
        let mut families = Families::new(self.w.len(), sweep, acceleration).unwrap();
        families.add(&self.springs).unwrap();
        families.add(&self.hinges).unwrap();
        families.restart();
        families
    }

    fn strain(&self, x: &[Vec3]) -> Real {
        cloth_core::measure::Strain::of(&self.springs, x).rms
    }
}

#[test]
fn no_kind_of_sweep_changes_the_centre_of_mass_or_adds_a_moment() {
    let sheet = Sheet::of(&irregular(9, 1.0, 1.0, 5).unwrap());
    for sweep in SWEEPS {
        for acceleration in [relaxed(0.1), chebyshev(Radius::Given(0.5), 1)] {
            let mut families = sheet.families(sweep, acceleration);
            let mut x = sheet.x.clone();
            for _ in 0..4 {
                families.sweep(&Rigid, &sheet.w, &mut x);
            }
            let moved = |(x, from): (&Vec3, &Vec3)| x - from;
            let all = || x.iter().zip(&sheet.x).map(moved).zip(&sheet.w);
            let sum: Vec3 = all().map(|(d, w)| d / *w).sum();
            let size: Real = all().map(|(d, w)| d.norm() / w).sum();
            assert!(
                sum.norm() < 1e-13 * size,
                "{sweep:?}: {}",
                sum.norm() / size
            );
        }
    }
    // All at once, each correction has no moment about the positions that all of them meet.
    let mut x = sheet.x.clone();
    sheet
        .families(Sweep::Jacobi, relaxed(1.0))
        .sweep(&Rigid, &sheet.w, &mut x);
    let moment = |((x, from), w): ((&Vec3, &Vec3), &Real)| from.cross(&(x - from)) / *w;
    let sum: Vec3 = x.iter().zip(&sheet.x).zip(&sheet.w).map(moment).sum();
    assert!(sum.norm() < 1e-14, "{sum}");
}

#[test]
fn an_averaged_sweep_does_not_depend_on_the_order_of_the_elements() {
    let mut sheet = Sheet::of(&grid(9, 9, 1.0, 1.0, Diagonals::Alternating).unwrap());
    let run = |sheet: &Sheet| {
        let mut families = sheet.families(Sweep::Jacobi, relaxed(1.3));
        let mut x = sheet.x.clone();
        for _ in 0..10 {
            families.sweep(&Rigid, &sheet.w, &mut x);
        }
        x
    };
    let first = run(&sheet);
    sheet.springs.reverse();
    sheet.hinges.rotate_left(17);
    for (a, b) in first.iter().zip(run(&sheet)) {
        assert!((a - b).norm() < 1e-15);
    }
}

/// In the metric of M no error grows, whatever the masses: the sum of the shares at a vertex is at most 1.
#[test]
fn averaging_converges_on_any_mesh_and_with_any_masses() {
    for (mesh, ratio) in [
        (grid(8, 8, 1.0, 1.0, Diagonals::Alternating).unwrap(), 1.0),
        (irregular(8, 1.0, 1.0, 3).unwrap(), 1e6),
    ] {
        let mut sheet = Sheet::of(&mesh);
        for w in sheet.w.iter_mut().step_by(3) {
            *w *= ratio;
        }
        let mut families = sheet.families(Sweep::Jacobi, Acceleration::default());
        let mut x = sheet.x.clone();
        let mut last = Real::INFINITY;
        for sweep in 0..3000 {
            let before = x.clone();
            families.sweep(&Rigid, &sheet.w, &mut x);
            let move_of = |((a, b), w): ((&Vec3, &Vec3), &Real)| (a - b).norm_squared() / w;
            let size: Real = x.iter().zip(&before).zip(&sheet.w).map(move_of).sum();
            assert!(
                size <= last * (1.0 + 1e-3) + 1e-25,
                "sweep {sweep}: {last:e} to {size:e}"
            );
            last = size;
        }
        assert!(sheet.strain(&x) < 0.5 * sheet.strain(&sheet.x));
    }
}

/// Linear rows: what λ says has been moved is what has been moved, for every kind of sweep and under extrapolation.
#[test]
fn multipliers_and_positions_stay_together() {
    let mesh = grid(6, 6, 1.0, 1.0, Diagonals::Alternating).unwrap();
    let sheet = Sheet::of(&mesh);
    for sweep in SWEEPS {
        for radius in [Radius::Given(0.9), Radius::Estimated] {
            let acceleration = Acceleration {
                relaxation: 0.15,
                ..chebyshev(radius, 3)
            };
            let mut families = Families::new(sheet.w.len(), sweep, acceleration).unwrap();
            families.add(&sheet.hinges).unwrap();
            families.restart();
            let mut x = sheet.x.clone();
            for _ in 0..30 {
                families.sweep(&Rigid, &sheet.w, &mut x);
            }
            let mut lambda = Vec::new();
            families.read_memory(0, &mut lambda, |memory| *memory);
            let mut expected = sheet.x.clone();
            for (hinge, lambda) in sheet.hinges.iter().zip(lambda.chunks(3)) {
                for (&v, q) in hinge.vertices.iter().zip(hinge.coefficients) {
                    expected[v as usize] +=
                        Vec3::from_row_slice(lambda) * (q * sheet.w[v as usize]);
                }
            }
            let moved = x
                .iter()
                .zip(&sheet.x)
                .map(|(a, b)| (a - b).norm())
                .fold(0.0, Real::max);
            assert!(moved > 1e-2);
            for (x, expected) in x.iter().zip(&expected) {
                assert!((x - expected).norm() < 1e-13, "{sweep:?} {radius:?}");
            }
        }
    }
}

/// A radius that lets everything grow: sweeps that diverge by themselves, and a Gauss–Seidel sweep on a
/// crumpled sheet.
#[test]
fn growth_is_noticed_and_the_sweeps_go_on_without_extrapolation() {
    let sheet = Sheet::of(&grid(10, 10, 1.0, 1.0, Diagonals::Alternating).unwrap());
    let crumpled: Vec<Vec3> = (0..sheet.w.len())
        .map(|v| Vec3::new(wave(v, 12.9), wave(v, 78.2), wave(v, 37.7)))
        .collect();
    for sweep in [Sweep::Sequential, Sweep::Colored, Sweep::Jacobi] {
        for (radius, delay) in [(Radius::Given(0.9999), 1), (Radius::Estimated, 2)] {
            let mut families = sheet.families(sweep, chebyshev(radius, delay));
            let mut x = crumpled.clone();
            for _ in 0..2000 {
                families.sweep(&Rigid, &sheet.w, &mut x);
                assert!(x.iter().all(|x| x.norm() < 100.0), "{sweep:?} {radius:?}");
            }
            let left = sheet.strain(&x);
            println!(
                "{sweep:?} {radius:?}: strain {left:e}, given up {}",
                families.chebyshev_fallbacks()
            );
            assert!(left < 0.3, "{sweep:?} {radius:?}: {left}");
        }
    }
    let mut families = sheet.families(Sweep::PlainJacobi, chebyshev(Radius::Given(0.9), 1));
    let mut x = sheet.x.clone();
    for _ in 0..20 {
        families.sweep(&Rigid, &sheet.w, &mut x);
    }
    assert_eq!(families.chebyshev_fallbacks(), 1);
}

#[test]
fn settings_out_of_range_are_refused() {
    let build = |acceleration| Families::<Rigid>::new(1, Sweep::Jacobi, acceleration);
    for relaxation in [0.0, -1.0, 2.0, Real::NAN, Real::INFINITY] {
        let error = build(relaxed(relaxation)).unwrap_err();
        assert!(matches!(
            error,
            BuildError::OutOfRange(OutOfRange {
                name: "the relaxation",
                ..
            })
        ));
    }
    for radius in [-0.1, 1.0, Real::NAN] {
        let error = build(chebyshev(Radius::Given(radius), 1)).unwrap_err();
        assert!(matches!(
            error,
            BuildError::OutOfRange(OutOfRange {
                name: "the spectral radius",
                ..
            })
        ));
    }
    for (radius, delay) in [(Radius::Given(0.5), 0), (Radius::Estimated, 1)] {
        assert!(build(chebyshev(radius, delay)).is_err());
        assert!(build(chebyshev(radius, delay + 1)).is_ok());
    }
}

#[cfg(feature = "parallel")]
#[test]
fn the_bits_do_not_depend_on_the_number_of_threads() {
    let sheet = Sheet::of(&grid(140, 140, 1.0, 1.0, Diagonals::Alternating).unwrap());
    for sweep in SWEEPS {
        for radius in [Radius::Given(0.99), Radius::Estimated] {
            let run = || {
                let acceleration = Acceleration {
                    relaxation: 0.9,
                    ..chebyshev(radius, 2)
                };
                let mut families = sheet.families(sweep, acceleration);
                let mut x = sheet.x.clone();
                for _ in 0..14 {
                    families.sweep(&Rigid, &sheet.w, &mut x);
                }
                let mut lambda = Vec::new();
                families.read_memory(1, &mut lambda, |memory| *memory);
                (x, lambda)
            };
            let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            let one = pool(1).unwrap().install(run);
            for threads in [2, 4] {
                let more = pool(threads).unwrap().install(run);
                assert!(one == more, "{sweep:?} {radius:?}, {threads} threads");
            }
        }
    }
}

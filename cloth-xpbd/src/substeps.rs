//! [`SubstepRule`]: the number of substeps that a cloth needs for a wanted strain.
//!
//! One sweep in a substep of h leaves a spring longer than its stiffness says: its end has been moved on by the next
//! spring, by `w |λ|` with |λ|/h² the tension. So a sweep acts like a spring of a stiffness of some `m/h²` in series
//! with the material's, and no wave goes faster than about an edge in a substep, l/h
//! ([derivation](crate::XpbdConfig#what-few-sweeps-do-to-the-motion)). Two loads follow.
//!
//! - **An impact**: cloth that is stopped, or bent round, at a speed v is strained by v over the wave speed,
//!   `v h/l`. The speed is that of a fall through a height H, `v = √(2 g H)`: the length of the cloth, which may swing,
//!   and what is free below it, or less where a floor is nearer. To it comes the speed of what pulls or pushes the
//!   cloth: pins and bodies that move.
//! - **The weight**: P prescribed vertices carry V vertices of mass m, so an edge there has a tension of some m g V/P.
//!   Over the stiffness m/h² that is a stretch of g h² V/P, and a strain of `g h² V/(P l)`. Cloth without prescribed
//!   vertices comes to lie on a fold or a rim of some √V vertices.
//!
//! The largest strain of the worst edge, over a whole swing and whatever the mesh, is about
//!
//! ```text
//! ε = 2 v h/l + 3.6 g h² V/(P l)
//! ```
//!
//! with both coefficients measured: sheets of 0.3 and 1 m, 17 to 128 vertices a side, regular and irregular,
//! held at two corners, at an edge or at one corner, swinging for two seconds with steps of 1/30 to 1/240 s and
//! stiffnesses from 10⁴ N/m on, were strained by 0.3 to 1.4 times that. On an irregular mesh l is the first
//! percentile of edge lengths.
//!
//! A third load lasts: **the tension** T (N/m) of an inflated piece, `p R/2` of a sphere, or `F/w` where a force F (N)
//! pulls on a width of w (m). An edge there pulls with `T l`, which the sweeps of a substep leave as a strain of
//! `0.65 T h²/m`. (Measured, as root mean square of all edges: spheres of 0.2 to 1 m with gas inside, 362 and 1442
//! vertices, at rest: 0.56 to 0.87; square sheets pulled at an edge, 169 and 625 vertices: 0.5 to 0.6.) It does not
//! pass, as a swing or an impact does: cloth stays longer by it. The springs themselves yield to T by about half of
//! `T/k`, k the largest of theirs. So what the sweeps may add is
//!
//! - a fiftieth of `T/k`, 4 % of what the springs do: `0.65 h²/m = 0.02/k`, so `h² = 0.031 m/k`, whatever T is. Sweeps
//!   yield as much as springs where `0.65 h²/m = 0.5/k`, `h² = 0.77 m/k`. The h here is √(0.031/0.77), a fifth, of
//!   that;
//! - or 1/5000 of the wanted strain, where that is more;
//! - a fiftieth of the wanted strain instead, where a spring is hard (k = ∞) or all have k = 0.
//!
//! For the first two loads no substep is shorter than the h at which `k h² (w₁ + w₂) = 1`. With shorter ones the
//! springs themselves yield more than unconverged sweeps do, so a soft cloth is as long as its k makes it. Nor is a
//! substep ever longer than 1/1200 s, that of the default, 20 substeps of 1/60 s.

use cloth_core::energy::Spring;
use cloth_core::math::{Real, Vec3};
use cloth_core::particles::Particles;
use cloth_core::topology::joined;
use std::collections::BTreeMap;

/// Coefficients of the law, measured (dimensionless).
const IMPACT_COEFFICIENT: Real = 2.0;
const WEIGHT_COEFFICIENT: Real = 3.6;
const TENSION_COEFFICIENT: Real = 0.65;
/// Fraction of the strain of the springs, or of the wanted one without springs that yield, that a lasting tension may
/// add.
const TENSION_FRACTION: Real = 0.02;
/// Fraction of the wanted strain that it may always add.
const NEGLIGIBLE_FRACTION: Real = 2e-4;
/// The longest substep (s).
const LONGEST: Real = 1.0 / 1200.0;
/// One edge in so many may be shorter than the l of the law.
const SHORT_EDGES: usize = 100;

/// Chooses a number of substeps for a wanted strain; the closed forms behind it are in the [crate
/// documentation](crate#how-many-substeps-how-many-iterations). The strain that is left is about the wanted one: where
/// the coefficients of the law were measured it was 0.3 to 1.4 times that.
///
/// The largest strains that its numbers leave over a whole swing (1 m, 10⁴ N/m, falling from the horizontal with steps
/// of 1/60 s, 10 % wanted; `cargo test --release -p cloth-xpbd --test all the_table_of_the_rule`):
///
/// | sheet | held by | substeps | largest strain |
/// |---|---|---|---|
/// | 17 × 17 | two corners | 33 | 4.6 % |
/// | 33 × 33 | two corners | 75 | 8.7 % |
/// | 33 × 33, irregular | two corners | 148 | 7.0 % |
/// | 33 × 33 | an edge | 50 | 7.0 % |
/// | 64 × 64 | two corners | 177 | 8.3 % |
///
/// A sheet that buckles is chaotic: rounding otherwise in the last bit changes these strains by up to a third.
///
/// Twenty substeps leave 54 % at 33 × 33 and 272 % at 64 × 64 by two corners, at the worst moment of the swing.
///
/// **What a substep costs** beside its sweeps: one pass over the vertices for x̃, one for the velocities, one over the
/// rows to set λ to zero ([measured](crate::XpbdSolver#what-a-step-costs)); with damping one more over the rows, for
/// C⁰. Contact is detected once a substep, but a shorter displacement meets less: for a sheet of 64 × 64 vertices that
/// may touch itself (`cloth-bench run hang`, with `self=yes`, commit b8898d50), nine times as many substeps took twice
/// the time of contact.
///
/// # Against the closed form
/// The [closed form of a chain](crate#how-many-substeps-how-many-iterations) and what is measured
/// (`cloth-bench study sag --tables`; 24 edges of 1/24 m, rigid springs, one sweep per substep, at rest), in multiples
/// of the predicted mean strain:
///
/// | hung by | sweep | mean strain | largest strain |
/// |---|---|---|---|
/// | chain, its end | from the support | 1.00 | 2.0 |
/// | chain, its end | coloured | 1.04 | 3.8 |
/// | sheet, an edge | coloured | 0.79 | 4.3 |
/// | sheet, two corners, predicted 0.3 % or less | coloured | 3.0 to 3.2 | 11 or 35, by the diagonals at the corners |
/// | sheet, two corners, predicted 0.9 % | coloured | 13 | 100 |
///
/// To use that form for two corners, divide the wanted mean strain by three before, and never put in more than 0.3 %:
/// beyond, the edges at the corners yield. For a bound on the *worst* edge divide by four (held by an edge) or 10 to 40
/// (corners).
///
/// **The order** of one sweep decides where the strain is. At rest each vertex has to be brought back by g h² in a
/// substep, so in any order λ bears the weight below its link: `w |λᵢ| = g h² Mᵢ`, with equal masses and the number
/// `Mᵢ = N − i + 1` of those below the upper end of link i. A visit leaves C = 0, and every neighbour that is visited
/// later stretches the link again, by its w |λ|. In units of g h²:
///
/// | visited | stretch of link i | sum | largest |
/// |---|---|---|---|
/// | from the support | Mᵢ₊₁ | N (N − 1)/2 | N − 1 |
/// | from the free end | Mᵢ₋₁; of the first 0 | N (N + 1)/2 − 1 | N |
/// | odd links, then even ones (N even) | odd: Mᵢ₋₁ + Mᵢ₊₁ = 2 Mᵢ; of the first M₂; even: 0 | N²/2 − 1 | 2N − 4 |
///
/// The sum hardly depends on the order, but colours leave all of it to the links of the first one, twice as much to
/// each. For N = 24 the first line has the mean 276/24 = 11.5; that of the third is 287/276 = 1.04 times this, and its
/// largest 44/11.5 = 3.8 times, as in the table above. So the result of a few sweeps is not symmetric, even where the
/// scene is; the pattern is the same in each substep, and goes with h².
///
/// # With contact
/// A sheet of 64 × 64 vertices (1 m, k = 10⁴ N/m) that falls by 5 cm onto a ball of 0.1 m, with friction and without
/// `energy_gain`, for 60 steps of `cloth-bench run ball.toml --method xpbd` on the file
///
/// ```toml
/// mesh = [{ generator = "grid:64x64:alternating", translate = [-0.5, -0.5, 0.15] }]
/// obstacle = [{ shape = "sphere", radius = 0.1 }]
/// contact = { self = true }
/// ```
///
/// holds this much strain energy, and at some time so much more energy than all that was put in. The rule has there a
/// `fall` of 1.0504 m: the side of the sheet, and what is free between its nearest vertex and the ball.
///
/// | substeps | after 20 steps (J) | after 60 (J) | excess over 60 (J) |
/// |---|---|---|---|
/// | 20 | 19 | 3.1 | 28 |
/// | 40 | 2.0 | 0.44 | 5.5 |
/// | 80 | 0.66 | 0.10 | 0.9 |
/// | 100, by this rule for 10 % | | 0.060 | 0.39 |
/// | 141, for 7 % | | 0.060 | 0.09 |
/// | 196, for 5 % | | 0.041 | 0.05 |
///
/// The excess is the error of unconverged sweeps, as without contact. So where cloth can touch something, ask for 7 %.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SubstepRule {
    /// About the largest strain (dimensionless) that the sweeps are to leave in an edge, above 0; up to 1.4 times as
    /// much was seen.
    pub strain: Real,
    /// Acceleration of free fall (m/s²).
    pub gravity: Vec3,
    /// The greatest height (m) through which any part of the cloth can fall: its own length, where it can swing, and
    /// what is free below it; no more than what is above a floor.
    pub fall: Real,
    /// The greatest speed (m/s) with which pins pull the cloth, bodies push it, or it flies at the start; 0 for none.
    pub driven: Real,
    /// The largest tension (N/m) that lasts, such as `p R/2` of a sphere of radius R (m) with a gauge pressure p (Pa)
    /// inside, or `F/w` of a force (N) on a width (m); 0 for none.
    pub tension: Real,
    /// Sweeps in each substep. They divide the strain by their number; n times as many substeps divide the part of the
    /// weight by n², that of an impact by n.
    pub iterations: u32,
}

impl SubstepRule {
    /// The number of substeps for a step of `dt` (s). `springs` lie along the edges; their stiffness bounds the
    /// number from above, unless all are zero. Pieces that no spring joins have each their own weight, edges and
    /// stiffness, and the piece that needs most substeps decides. A spring of no length only joins: where a seam or
    /// contact makes one piece carry another.
    ///
    /// # Panics
    /// If the wanted strain or the number of sweeps is not above 0, a number is negative or not finite, or a spring
    /// names a vertex that does not exist.
    #[must_use]
    pub fn substeps(&self, particles: &Particles, springs: &[Spring], dt: Real) -> u32 {
        assert!(self.strain > 0.0 && self.iterations > 0, "{self:?}");
        let numbers = [self.gravity.norm(), self.fall, self.driven, self.tension];
        assert!(
            numbers.iter().all(|n| *n >= 0.0 && n.is_finite()),
            "{self:?}"
        );
        let exists = |v: &u32| (*v as usize) < particles.len();
        assert!(
            springs.iter().all(|s| s.vertices.iter().all(exists)),
            "springs of another mesh"
        );
        let longest = self.longest(particles, springs);
        // A quotient that rounding has put above a whole number is that number.
        let count = (dt / longest.min(LONGEST) * (1.0 - 1e-12)).ceil();
        // A step of no length, or of one that is not a number, is refused where it is taken.
        count.clamp(1.0, Real::from(u32::MAX)) as u32
    }

    /// The longest substep (s) that leaves about the wanted strain, or no more than the elastic stretch of the springs.
    fn longest(&self, particles: &Particles, springs: &[Spring]) -> Real {
        let every: Vec<u32> = (0..particles.len() as u32).collect();
        let Some(whole) = Piece::of(particles, &every, springs.iter()) else {
            return Real::INFINITY;
        };
        let ends = springs.iter().map(|spring| spring.vertices);
        let root = joined(particles.len(), ends);
        let mut vertices: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for (vertex, &root) in every.iter().zip(&root) {
            vertices.entry(root).or_default().push(*vertex);
        }
        let mut own: BTreeMap<u32, Vec<&Spring>> = BTreeMap::new();
        for spring in springs {
            let root = root[spring.vertices[0] as usize];
            own.entry(root).or_default().push(spring);
        }
        let own = own.into_iter();
        let pieces = own.filter_map(|(root, own)| Piece::of(particles, &vertices[&root], own));
        let passing = pieces.map(|piece| self.passing(&piece));
        passing.fold(self.lasting(&whole), Real::min)
    }

    /// The longest substep (s) for the impact and the weight of a piece.
    fn passing(&self, piece: &Piece) -> Real {
        let gravity = self.gravity.norm();
        let speed = (2.0 * gravity * self.fall.max(0.0)).sqrt() + self.driven.max(0.0);
        // b h + a h² = ε
        let b = IMPACT_COEFFICIENT * speed / piece.edge;
        let a = WEIGHT_COEFFICIENT * gravity * piece.carried / piece.edge;
        let strain = self.strain * Real::from(self.iterations);
        let wanted = 2.0 * strain / (b + (b * b + 4.0 * a * strain).sqrt());
        match piece.stiffest > 0.0 {
            true => wanted.max((piece.mass / (2.0 * piece.stiffest)).sqrt()),
            false => wanted,
        }
    }

    /// The longest substep (s) for the tension that lasts.
    fn lasting(&self, whole: &Piece) -> Real {
        let strain = self.strain * Real::from(self.iterations);
        let added = match whole.stiffest > 0.0 && whole.stiffest.is_finite() {
            // Sweeps divide what they leave, and not what the springs do.
            true => (TENSION_FRACTION * self.tension / whole.stiffest
                * Real::from(self.iterations))
            .max(NEGLIGIBLE_FRACTION * strain),
            false => TENSION_FRACTION * strain,
        };
        // 0.65 T h²/m, divided by the sweeps.
        (added * whole.mass / (TENSION_COEFFICIENT * self.tension)).sqrt()
    }
}

/// What the law takes of vertices that springs join.
struct Piece {
    /// The mass m (kg) of a vertex: the harmonic mean, as light vertices are moved furthest.
    mass: Real,
    /// The length l (m) of an edge: few are shorter.
    edge: Real,
    /// V/P: how many vertices of that mass an end of a spring carries.
    carried: Real,
    /// The largest stiffness (N/m).
    stiffest: Real,
}

impl Piece {
    /// None if nothing in it can move, or no spring has a length.
    fn of<'a>(
        particles: &Particles,
        vertices: &[u32],
        springs: impl IntoIterator<Item = &'a Spring>,
    ) -> Option<Self> {
        let mut lengths = Vec::new();
        let mut stiffest = 0.0;
        for spring in springs
            .into_iter()
            .filter(|spring| spring.rest_length > 0.0)
        {
            lengths.push(spring.rest_length);
            stiffest = spring.stiffness.max(stiffest);
        }
        let (mut count, mut ease, mut whole) = (0_usize, 0.0, 0.0);
        for &vertex in vertices {
            let inverse = particles.inverse_mass()[vertex as usize];
            if inverse > 0.0 {
                count += 1;
                ease += inverse;
                whole += particles.mass()[vertex as usize];
            }
        }
        if count == 0 || lengths.is_empty() {
            return None;
        }
        lengths.sort_by(Real::total_cmp);
        let mass = count as Real / ease;
        let weight = whole / mass;
        let held = match vertices.len() - count {
            0 => weight.sqrt(),
            held => held as Real,
        };
        Some(Self {
            mass,
            edge: lengths[lengths.len() / SHORT_EDGES],
            carried: weight / held,
            stiffest,
        })
    }
}

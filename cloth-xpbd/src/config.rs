//! Settings of the solver.

use cloth_core::math::Real;
use cloth_core::method::position_based::{Acceleration, Sweep};

/// Settings of [`XpbdSolver`](crate::XpbdSolver).
///
/// # How fast sweeps converge
/// For rows with constant gradients a sweep is Gauss–Seidel on `A = J M⁻¹ Jᵀ + α̃`, which is symmetric and positive
/// semi-definite. So it converges for any mesh, stiffness and masses ([stability](crate#limits)), unless hard rows
/// [contradict one another](#redundant-and-contradictory-hard-rows). The slowest part of the error is multiplied by one
/// factor ρ a sweep: a factor of e takes `1/(−ln ρ)` sweeps. In a straight chain A is tridiagonal, with
/// `wᵢ₋₁ + wᵢ + α̃` on the diagonal and `−wᵢ` beside it, and the ρ of Gauss–Seidel is the square of that of Jacobi
/// (Young 1971). Of N rigid links, hung, with equal masses, Jacobi's matrix `D⁻¹(L + U)` (D the diagonal of A, −L and
/// −U what is beside it) is a random walk on the links 1 to N, reflected at 1 (w₀ = 0) and absorbed at N + 1:
/// eigenvectors `cos((i − 1) θ)` with `cos(Nθ) = 0`, eigenvalues `cos θ = cos((2j − 1) π/(2N))`. With `η = 2 k h² w`:
///
/// | chain | ρ |
/// |---|---|
/// | N rigid links, equal masses, held by one end | `cos²(π/(2N))` |
/// | N springs of η, equal masses, both ends free | `cos²(π/(N + 1))/(1 + 1/η)²` |
/// | two rigid links, hung: a mass m, below it r m | `r/(1 + r)` |
/// | N rigid links, hung: masses m, the last one r m, r well above N | about `1 − 1/(r (N − 1))` |
///
/// The last line is a Rayleigh quotient: with equal λ in all links `λᵀAλ` is the w of the tip alone, `1/(r m)`, and the
/// diagonal makes `2 (N − 1)/m`. That gives Jacobi's `1 − ρ`, and Gauss–Seidel has twice that.
///
/// - **Stiffness**: with both ends free and η well above 1, sweeps for a factor of e are about `1/(2/η + π²/(N + 1)²)`.
///   For `1 ≪ η ≪ N²` this is η/2, in proportion to k. The two terms are equal at `η = 2 (N + 1)²/π²`, some N²/5. For η
///   far above that it is `(N + 1)²/π²`, however stiff the springs are: a hard row is no slower. For η of 1 or less it
///   is less than one sweep, at most `1/(2 ln(1 + 1/η))`, 0.72 at η = 1: such springs are soft for the step, and one
///   sweep does.
/// - **Resolution**: on a sheet of N vertices a side and the same material, w goes with N² and k is constant. At the
///   same h both η/2 and its bound `(N + 1)²/π²` grow with N², and so do the sweeps. With h ~ 1/N, N times the
///   substeps, η is constant: then one sweep a substep corrects the same fraction on any mesh, at the cost of N
///   substeps and not N² sweeps.
/// - **Mass ratio**: with a heavy tip a factor of e takes some `r (N − 1)` sweeps in the place of `4N²/π²`, so for 24
///   links and r = 1000 some 23,000 in the place of 230. A light tip costs none. Springs in place of the links add
///   `N α̃ = N/(k h²)` to the `λᵀAλ = 1/(r m)` of equal λ, and so take fewer: `(N − 1)/(1/r + N/(k h² w))`. For heavy
///   tips there is the [direct solver](crate#direct-solve).
/// - **Stacks**, by hand, not measured: N layers of cloth on a floor, vertex above vertex and one row to a gap, have
///   the A of the hung chain, per area: w₀ = 0 is the floor, w = 1/σ, σ the mass per area, and `α̃ = 1/(κ h²)` with the
///   κ of [contact](crate#contact), so `η = 2 κ h²/σ`. In a stack at rest every λ is above 0, and its bound does not
///   act. The rows of Jacobi's matrix sum to `1/(1 + 1/η)` at most, which bounds its ρ, so that of Gauss–Seidel is at
///   most `1/(1 + 1/η)²` for any N: 0.77 with κ h²/σ = 3.5. One sweep a substep, from the floor up, leaves gap i at
///   rest short by `g h² (N − i)`, by which the layers above have pushed its upper side down after its visit: 6.8 µm
///   times (N − 1) in the lowest, at 1/1200 s. That is beside the `N σ g/κ` of the pressure itself there, and holds
///   while both together are less than half of r.
/// - **The order** does not change ρ of a chain: Gauss–Seidel has the square of Jacobi's ρ in the order of the links
///   and coloured. Averaged Jacobi is slower; [`Sweep`] has its factors.
/// - **Jacobi**, with a relaxation ω, multiplies the error by `1 − ω D⁻¹A`, D the diagonal of A, or its diagonal blocks
///   where elements have several rows. With n the largest number of elements that meet in a free vertex,
///   `λᵀAλ = λᵀα̃λ + Σ_v w_v ‖Σ_e Jₑᵥᵀλₑ‖²`, over vertices v and the elements e that meet there, Jₑᵥ the gradients of e
///   at v, is at most n λᵀDλ, as the square of a sum of n vectors is at most n times the sum of their squares. So the
///   eigenvalues of D⁻¹A lie between 0 and n, and ω < 2/n is enough. The bound is reached: n parallel hard links from
///   one free vertex to held ones have the eigenvalue n. Eight hard springs about a vertex of a flat sheet, 45° apart,
///   with equal masses, have one of at least (4 + 1)/2 = 2.5, by the Rayleigh quotient: their `Σ n nᵀ` is 4 in the
///   plane, their far ends add 1, and D is 2, times w. So [`Sweep::PlainJacobi`] diverges there with ω = 1. With the
///   `1/n` of [`Sweep::Jacobi`] no part of the error grows.
/// - **Sweeps on the primal system**, `(M + h² Jᵀ K J) x = …` with K the diagonal matrix of all k, go vertex by vertex
///   (vertex block descent: A. H. Chen, Z. Liu, Y. Yang, C. Yuksel, ACM Transactions on Graphics 43 (4), 2024). Ratios
///   of stiffness slow them down as ratios of mass do the dual ones (M. Macklin et al., "Primal/dual descent methods
///   for dynamics", Computer Graphics Forum 39 (8), 2020). Of two masses that hang by a spring of k and, below that,
///   one of r k, with k h² well above the masses, the matrix along the chain is h² k times `[1 + r, −r; −r, r]`. Its
///   Gauss–Seidel has ρ = r²/((1 + r) r) = r/(1 + r), the line of the two masses m and r m in the table. In the dual
///   matrix a soft spring among stiff ones only adds to the diagonal. And k = ∞ has no place in the primal one.
///
/// For a sheet ρ has no closed form. Hung by a side its columns are chains of N − 1 links; what is measured on sheets
/// is the strain that is left ([table](crate::SubstepRule#against-the-closed-form)).
///
/// # Relaxation and extrapolation
/// **Relaxation.** [`Acceleration::relaxation`] multiplies every correction by ω (that of an inequality by 1 at most,
/// as its λ must keep its sign). With μ an eigenvalue of Jacobi's matrix, those of the sweep, s², are given by
/// `s² − ω μ s + ω − 1 = 0` where A is tridiagonal (Young 1971); ω = 1 makes s = μ, Gauss–Seidel. The best ω is that at
/// which the two s of the largest μ meet, `ω² μ² = 4 (ω − 1)`: `ω = 2/(1 + √(1 − μ²))`, with the factor `s² = ω − 1` a
/// sweep in the end. For N hung links, μ = cos(π/(2N)), that is `(1 − sin(π/(2N)))/(1 + sin(π/(2N)))`. So a factor of e
/// takes about N/π sweeps in the place of 4N²/π², for 24 links 7.6 in the place of 233. But a visit leaves its own row
/// at `(1 − ω)(C + α̃λ)`, not at zero, and for a cloth the best ω has no closed form: with few sweeps a substep keep 1.
///
/// **Extrapolation.** The error that k sweeps S leave is Sᵏ times the first. A combination of the iterates, with
/// coefficients of sum 1, leaves `p_k(S)` times that, `p_k` a polynomial of degree k with `p_k(1) = 1`. If the
/// eigenvalues s of S are real and within ±ρ, the largest `|p_k(s)|` is least for `p_k(s) = T_k(s/ρ)/t_k`, with
/// Chebyshev's polynomials `T_k` and `t_k = T_k(1/ρ)`. From `T_{k+1}(y) = 2y T_k(y) − T_{k−1}(y)`, once for y = s/ρ and
/// once for y = 1/ρ,
///
/// ```text
/// p_{k+1} = ω s p_k + (1 − ω) p_{k−1},   ω = 2 t_k/(ρ t_{k+1}),   1 − ω = −t_{k−1}/t_{k+1}
/// x⁺ = x⁻ + ω (S(x) − x⁻),               ω = 1, then 2/(2 − ρ²), then 4/(4 − ρ² ω) again and again
/// ```
///
/// the second line being the first for iterates, `x⁻` the one before x. The values of ω follow from the recurrence of
/// `t_k` divided by `2 t_k/ρ`: `1/ω = 1 − (ρ/2) t_{k−1}/t_k`, where `t_{k−1}/t_k` is ρ/2 times the ω of the iterate
/// before, and ρ at first. In the end `t_k` grows by `(1 + √(1 − ρ²))/ρ` an iteration, and the error falls by as much.
/// λ takes the same ω as x, so that `x = x̃ + M⁻¹ Jᵀλ`, which is affine, stays true.
///
/// *Why forward and back*: with A = L + D + Lᵀ, D its diagonal, a sweep forward is `1 − (D + L)⁻¹ A`, whose eigenvalues
/// may be complex. Forward and back it is `1 − B⁻¹ A` with `B = (D + L) D⁻¹ (D + Lᵀ) = A + L D⁻¹ Lᵀ`. B is symmetric
/// and at least A, so the eigenvalues are real, from 0 to 1. In a chain of two colours the second visit of the colour
/// at which the sweep turns moves nothing, and ρ is that of one sweep. For 20 rigid links, ρ = cos²(π/40), an iteration
/// of two sweeps then leaves 0.895 of the error in the end, where one plain sweep leaves 0.994: it takes a ninth of the
/// sweeps. Rows that turn and bounds on λ are not linear, and nothing is proved for them;
/// [`Chebyshev`](crate::Chebyshev) says what is done where the corrections grow.
///
/// # What few sweeps do to the motion
/// With linear rows, x measured from rest, the n sweeps of a substep are a matrix: `x = T x̃`, where x̃ is twice the x
/// of one substep before less that of two before. So an eigenvector of T with the eigenvalue μ is multiplied in each
/// substep by a z with
///
/// ```text
/// z² = μ (2z − 1),   z = μ ± √(μ² − μ)
/// ```
///
/// Where μ is real and between 0 and 1, the two z are conjugate, of `|z|² = μ`: `z = √μ e^(±iφ)` with `cos φ = √μ`. The
/// mode swings with the frequency φ/h, loses the fraction 1 − μ of its squared amplitude in a substep, and never grows.
/// Converged sweeps make `μ = 1/(1 + (hω)²)`, ω that of the material: backward Euler's [damping](crate#damping). Fewer
/// sweeps leave a larger μ, and φ/h is below ω. Where φ is small, a velocity v then ends in a stretch of about v h/φ,
/// and in (hω/φ)² times the energy that it had: the [gain](crate#steps-that-gain-energy) of too few sweeps.
///
/// **Forward and back**, any number of times, sweeps have such μ for any mesh, masses, stiffnesses and h, so that they
/// are stable. (A [`Chebyshev`](crate::Chebyshev) of the given radius 0 makes them, at twice the work.) With the
/// symmetric B of the section above, `T = 1 − M⁻¹ Jᵀ W J` with `W = Σ (1 − B⁻¹A)ᵏ B⁻¹` over k < n. The eigenvalues b of
/// B⁻¹A lie between 0 and 1, those of W A are 1 − (1 − b)ⁿ and do too, and `J M⁻¹ Jᵀ` is at most A: so 1 − μ, an
/// eigenvalue of `W J M⁻¹ Jᵀ`, is also between 0 and 1.
///
/// **One sweep over N hung rigid links**, equal masses, coloured or from either end, has the μ = cos² θ of
/// Gauss–Seidel, θ = (2j − 1) π/(2N), and 0. So `z = cos θ e^(±iθ)`: a mode of the wave number θ/l swings with θ/h. All
/// waves go at l/h, one link in a substep, a speed of the sweeps and not of the material: the sag and the strain of an
/// impact in [`SubstepRule`](crate::SubstepRule) are those of such a chain. For 24 links and 1/1200 s the slowest mode
/// has 12.5 Hz, and keeps 99.57 % of its squared amplitude in a substep.
///
/// **One way**, sweeps may have other μ, and gain energy with linear rows too: where μ is below −1/3, one z is below
/// −1. Take a vertex in a plane, held by N hard struts to prescribed vertices, each at π/N from the one visited before.
/// A visit projects the displacement of the vertex onto the line across its strut. The displacement that N visits leave
/// is on the line of the last, and is multiplied by the cosines between successive lines, from the last to the first
/// included: `μ = cosᴺ⁻¹(π/N) cos((N − 1) π/N) = −cosᴺ(π/N)`. That is −0.25 with four struts, and −0.35 with five,
/// where z = −1.03: the vertex is thrown to and fro, further in each substep, whatever h is, until the struts turn by
/// much. A second sweep makes μ = 0.12, and every other strut first, at 0, 72, 144, 36 and 108°, 0.003: both end it.
///
/// # Redundant and contradictory hard rows
/// The gradients of hard rows may depend on one another: a truss with more links than hold it, two hard attachments of
/// one vertex. A is then singular.
///
/// - *Redundant* rows agree: some positions meet all of them. Sweeps converge to such positions, and a row that others
///   have met moves nothing. λ is one of many; which one depends on the order of the visits.
/// - *Contradictory* rows do not. Each visit meets its own row and undoes the others, so sweeps end in a cycle, not in
///   a limit: at the end of a sweep the row that was visited last is met. Positions stay between what the rows ask for,
///   but the λ of these rows grow by the same amounts in each sweep, until the next substep begins with λ = 0: forces
///   read from them mean nothing. With a finite k in their place, however large, A is regular and sweeps have a limit.
///
/// Within one element the later of two redundant rows is left out. A row between prescribed vertices is left alone.
/// What the [direct solver](crate#direct-solve) makes of such rows is with that.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct XpbdConfig {
    /// Sweeps over all constraints per substep, at least 1.
    pub iterations: u32,
    /// Substeps per step, at least 1; each is a step of its own of size Δt/substeps, with multipliers that
    /// start at zero.
    pub substeps: u32,
    /// Order of the sweep.
    pub sweep: Sweep,
    /// Relaxation of the corrections and extrapolation of the sweeps, positions and multipliers together.
    pub acceleration: Acceleration,
    /// β (s): a force `−β k Ċ` along every row beside the elastic `−k C`, relative to rest data that change
    /// ([damping](crate#damping)). Zero, the default, costs nothing. A hard row has no rate and is not damped.
    ///
    /// To give a mode of frequency ω (1/s) the damping ratio ζ take `β = 2ζ/ω`; faster ones get more, in proportion to
    /// ω. A damped row has `α̃ = 1/(k h (h + β))`, so sweeps converge as for springs of `η = 2 k h (h + β) w`: with β
    /// well above h a row that was soft for the step is a stiff one, and takes more sweeps.
    ///
    /// A damped row is led to `β/(h + β)` of its C⁰ and not to zero. So strain that the sweeps leave does not end with
    /// the substep: what each leaves as e adds up to `e (1 + β/h)`. With β far above h sweep more often, or take the
    /// [direct solver](crate::direct), which leaves nothing.
    pub damping: Real,
    /// With `Some(τ)` (dimensionless, above 0) the gains of energy are summed over the steps and losses taken off, but
    /// not below zero. A step that adds to that sum and lifts it above τ times the scale of energy is repeated with
    /// twice as many substeps, up to eight times as many. The scale is the largest value so far, with the present step,
    /// of max(H, H + W): H is the kinetic and elastic energy before a step, W the work done on the cloth in it. See
    /// [steps that gain energy](crate#steps-that-gain-energy). `None`: nothing is computed for it.
    pub energy_gain: Option<Real>,
}

impl Default for XpbdConfig {
    /// Twenty substeps of one coloured sweep, no damping. One sweep a substep is what Macklin et al. 2019 propose: for
    /// the same number of sweeps, small steps are nearer to the solution than many iterations. (Their examples of cloth
    /// take 30 and 40 substeps a frame.)
    ///
    /// Twenty is no answer for fine meshes: [`SubstepRule`](crate::SubstepRule) chooses the number for a wanted
    /// strain.
    fn default() -> Self {
        Self {
            iterations: 1,
            substeps: 20,
            sweep: Sweep::Colored,
            acceleration: Acceleration::default(),
            damping: 0.0,
            energy_gain: None,
        }
    }
}

//! Bias of the order of constraints: how lopsided a symmetric sheet becomes.

use crate::studies::prelude::*;
use cloth_core::measure::center_of_mass;

const SECONDS: Real = 0.5;
/// Asymmetry (m) of a sheet of 1 m below which its symmetry is kept.
const KEPT: Real = 1e-6;

/// Methods with so many iterations a step, and how their sweeps go.
pub fn cases(scope: Scope) -> impl Iterator<Item = (Variant, u32)> {
    let counts: &[u32] = scope.pick(&[1, 4, 16], &[1, 4, 16, 64, 256]);
    let own = iterating_own().map(Variant::uncut);
    let variants = Variant::list(
        "pbd, colours: sweep=colored
        pbd, sequential: sweep=sequential
        pbd, Jacobi: sweep=jacobi
        xpbd, colours: substeps=1 sweep=colored
        xpbd, sequential: substeps=1 sweep=sequential
        xpbd, Jacobi: substeps=1 sweep=jacobi
        pd
        pd, no coarse grid: coarse=0
        implicit-euler
        implicit-euler, Newton: linear=cholesky
        xpbd-direct",
    );
    let cases = |variant: Variant| counts.iter().map(move |&count| (variant.clone(), count));
    // The system of the direct solver converges in a few, and takes as long for each as hundreds of sweeps.
    let is_quick = |case: &(Variant, u32)| case.0.method() != "xpbd-direct" || case.1 <= 16;
    let all = variants.into_iter().chain(own);
    all.flat_map(cases).filter(is_quick)
}

/// The hanging sheet with crossed diagonals, which is its own mirror image in the plane between its pins.
pub fn sheet(scope: Scope) -> Result<Scene, BenchError> {
    let settings = Settings::default().with("n", scope.pick(9, 33));
    scene::build("hang", None, &settings.with("pattern", "crossed"))
}

fn mirrored(x: &Vec3) -> Vec3 {
    Vec3::new(1.0 - x.x, x.y, x.z)
}

/// What is left of the symmetry after half a second.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Lopsided {
    /// Largest distance of a vertex from the mirror image of its partner.
    #[serde(rename = "asymmetry (m)")]
    pub asymmetry: Number,
    /// How far the centre of mass has left the plane of symmetry.
    #[serde(rename = "sideways (m)")]
    sideways: Number,
}

/// Half a second of the sheet, by so many iterations a step.
pub fn swing(scene: &Scene, variant: &Variant, iterations: u32) -> Result<Lopsided, BenchError> {
    let start = &scene.start.positions;
    let partner = |x: &Vec3| start.iter().position(|y| (y - mirrored(x)).norm() < 1e-9);
    let partners: Option<Vec<usize>> = start.iter().map(partner).collect();
    let partners = partners.ok_or_else(|| BenchError::Failed("no symmetric sheet".into()))?;
    let settings = variant.settings.clone().with("iterations", iterations);
    let mut stepper = Method::find(variant.method())?.build(scene, &settings, scene.dt)?;
    let mut state = scene.start.clone();
    for _ in 0..(SECONDS / scene.dt).round() as u32 {
        stepper.step(&mut state, StepInput::new(scene.dt).gravity(scene.gravity))?;
    }
    let x = &state.positions;
    let apart = partners
        .iter()
        .zip(x)
        .map(|(&p, x_v)| (x_v - mirrored(&x[p])).norm());
    Ok(Lopsided {
        asymmetry: Number(apart.fold(0.0, Real::max)),
        sideways: Number(center_of_mass(&scene.model.particles, x).x - 0.5),
    })
}

/// Measures all; who keeps the symmetry and who does not, in words.
pub(super) fn run(study: &mut StudyRun<'_>) -> Result<String, BenchError> {
    let scene = sheet(study.scope)?;
    let found = study.grid_side_by_side(
        cases(study.scope),
        |(variant, iterations)| format!("order, {}, {iterations} iterations", variant.label),
        |(variant, iterations)| swing(&scene, variant, *iterations),
    );
    let curves = curves(&found, |((variant, iterations), lopsided)| {
        let point = (Real::from(*iterations), lopsided.asymmetry.0);
        (variant.label.as_str(), point)
    });
    let most = |curve: &Series| curve.points.iter().map(|at| at.1).fold(0.0, Real::max);
    let (kept, lost): (Vec<&Series>, Vec<&Series>) =
        curves.iter().partition(|curve| most(curve) < KEPT);
    let names = |curves: &[&Series]| curves.iter().map(|curve| &curve.label).join("; ");
    let told = format!(
        "To a millionth of its side, by however few iterations, with {}; with the others a vertex ends up to so far from the mirror image of its partner, worst with so many iterations:",
        names(&kept)
    );
    let mut table = Table::new(&["method", "off by", "with iterations a step"]);
    for curve in lost {
        let worst = curve.points.iter().max_by(|a, b| a.1.total_cmp(&b.1));
        let cells =
            worst.map(|&(count, off)| [format!("{} mm", two(1e3 * off)), count.to_string()]);
        table.line(
            curve.label.as_str(),
            cells.into_iter().flatten().map(Cell::said),
        );
    }
    let verdict = format!(
        "A symmetric sheet stays symmetric to a millionth of its side with {}.",
        names(&kept)
    );
    let plot = Plot::new(
        format!("How lopsided a symmetric sheet is after {SECONDS} s"),
        Axis::log("iterations a step, at most (dimensionless)"),
        Axis::log("asymmetry (m)"),
    )
    .with(curves)
    .note("The sheet and its fall are their own mirror image, so all asymmetry is the method's: rounding, the order in which it visits constraints, or coarse levels without that symmetry.");
    study.plot("independence-order", &plot);
    let rows = Table::named(&["method", "iterations"], &found);
    study.table(
        "independence-order",
        "A symmetric sheet after its fall",
        rows,
    );
    let question = "Does a symmetric cloth stay symmetric?";
    study.answer(question, told, Some(table), "figure-independence-order");
    Ok(verdict)
}

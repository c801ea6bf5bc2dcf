//! The maps: which sheet stands behind which pair of values.

use super::{Fate, follow};
use crate::studies::prelude::*;
use cloth_core::cloth::{Cloth, Membrane};
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{Diagonals, grid};

/// Vertices a side.
pub(in crate::studies) const N: usize = 9;
const STEP: Real = 1.0 / 60.0;
/// Every vertex starts with a velocity (m/s) of up to this in each direction, another in every run: it loads no spring,
/// as displacements would.
const JITTER: Real = 1e-2;

/// Runs of every cell. One of the direct solver takes as long as ten of most others.
pub(crate) fn runs(scope: Scope, method: &str) -> u64 {
    match (scope, method) {
        (Scope::Quick, _) => 1,
        (Scope::Full, "xpbd-direct") => 3,
        (Scope::Full, _) => 10,
    }
}

/// A pair of parameters.
#[derive(Debug)]
pub struct Map {
    /// In names of files.
    pub name: &'static str,
    pub(super) caption: &'static str,
    /// What changes from column to column, and from row to row.
    pub(super) across: &'static str,
    pub(super) down: &'static str,
    values: [[&'static [Real]; 2]; 2],
    /// Who is asked.
    pub methods: fn() -> Vec<Variant>,
    /// The sheet and its step (s) for a value across and one down.
    build: fn(Real, Real) -> Result<(Scene, Real), BenchError>,
}

const STEPS_AND_STIFFNESSES: [[&[Real]; 2]; 2] = [
    [&[1.0 / 240.0, 1.0 / 60.0, 0.25], &[1e2, 1e6]],
    [
        &[1e-3, 1.0 / 240.0, 1.0 / 60.0, 1.0 / 15.0, 0.25, 1.0],
        &[1.0, 1e2, 1e4, 1e6, 1e8],
    ],
];

/// Every method at its published setting.
fn published() -> Vec<Variant> {
    method::all().map(Variant::published).collect()
}

/// Every method that iterates, cut short after the first, and the one that does so by its nature.
fn cut_short() -> Vec<Variant> {
    let mut variants = Variant::list(
        "implicit-euler: iterations=1
        implicit-euler, Newton: linear=cholesky iterations=1
        implicit-midpoint: iterations=1
        linear-implicit
        bdf2: iterations=1
        pbd: iterations=1
        xpbd: substeps=1 iterations=1
        xpbd-direct: iterations=1
        pd: iterations=1
        pd, no coarse grid: coarse=0 iterations=1",
    );
    let one = |own| Variant {
        settings: Settings::of("iterations=1"),
        ..Variant::uncut(own)
    };
    variants.extend(iterating_own().map(one));
    variants
}

/// Every method with steps that are stable, and the sweeps that compute with fewer digits.
fn with_single() -> Vec<Variant> {
    let more = Variant::list(
        "symplectic-euler, cut: substeps=auto
        xpbd, single precision: precision=single",
    );
    let implicit = method::all().filter(|method| !method.is_explicit());
    implicit.map(Variant::published).chain(more).collect()
}

/// Values are those of the quick scope, across and down, then of the full one.
pub static MAPS: [Map; 5] = [
    Map {
        name: "step",
        caption: "Step size and stiffness",
        across: "Δt",
        down: "stiffness (N/m)",
        values: STEPS_AND_STIFFNESSES,
        methods: published,
        build: |dt, stiffness| Ok((hung(stiffness)?, dt)),
    },
    Map {
        name: "ratio",
        caption: "Ratios of mass and stiffness",
        across: "mass ratio",
        down: "stiffness ratio",
        values: [
            [&[1.0, 1e4], &[1.0, 1e6]],
            [&[1.0, 1e2, 1e4, 1e6], &[1.0, 1e2, 1e4, 1e6, 1e8]],
        ],
        methods: published,
        build: |mass, stiffness| Ok((uneven(mass, stiffness)?, STEP)),
    },
    Map {
        name: "quality",
        caption: "Slivers",
        across: "height of a row",
        down: "stiffness (N/m)",
        values: [
            [&[1.0, 1e-3, 0.0], &[1e4]],
            [&[1.0, 0.1, 1e-2, 1e-3, 1e-4, 1e-6, 0.0], &[1e2, 1e4, 1e6]],
        ],
        methods: published,
        build: |height, stiffness| Ok((slivers(height, stiffness)?, STEP)),
    },
    Map {
        name: "one-iteration",
        caption: "Step size and stiffness with one iteration a step",
        across: "Δt",
        down: "stiffness (N/m)",
        values: STEPS_AND_STIFFNESSES,
        methods: cut_short,
        build: |dt, stiffness| Ok((hung(stiffness)?, dt)),
    },
    Map {
        name: "offset",
        caption: "Distance from the origin",
        across: "offset (m)",
        down: "stiffness (N/m)",
        values: [
            [&[0.0, 1e4], &[1e4]],
            [&[0.0, 1e4, 1e8, 1e12], &[1e2, 1e4, 1e6]],
        ],
        methods: with_single,
        build: |offset, stiffness| Ok((far_away(offset, stiffness)?, STEP)),
    },
];

impl Map {
    /// Values across and down.
    pub(super) fn values(&self, scope: Scope) -> [&'static [Real]; 2] {
        scope.of(self.values)
    }

    /// What a method makes of every value across, with one down.
    pub fn row(&self, scope: Scope, down: Real, method: &Variant) -> Result<Vec<Fate>, BenchError> {
        let steps = scope.pick(20, 60);
        let fate = |&first: &Real| match (self.build)(first, down) {
            Ok((scene, dt)) => worst(runs(scope, method.method()), |seed| {
                follow(&jittered(&scene, seed), method, dt, steps)
            }),
            Err(error) => Ok(Fate::Refused(error.to_string())),
        };
        self.values(scope)[0].iter().map(fate).collect()
    }
}

/// The worst that came of so many runs, of which one that fails is enough.
pub fn worst(
    runs: u64,
    mut run: impl FnMut(u64) -> Result<Fate, BenchError>,
) -> Result<Fate, BenchError> {
    let mut worst = Fate::Ok;
    for seed in 1..=runs {
        let fate = run(seed)?;
        if worst == Fate::Ok || fate.is_lost() {
            worst = fate;
        }
        if worst.is_lost() {
            break;
        }
    }
    Ok(worst)
}

/// What a method makes of the fall of a sheet with springs of so many N/m, in steps of 1/60 s.
pub(super) fn falls(stiffness: Real, method: &str, steps: u32) -> Result<Fate, BenchError> {
    let by_default = Variant::default_of(Method::find(method)?);
    follow(&jittered(&hung(stiffness)?, 1), &by_default, STEP, steps)
}

fn jittered(scene: &Scene, seed: u64) -> Scene {
    let mut scene = scene.clone();
    let mut random = SplitMix64::new(seed);
    for (vertex, velocity) in scene.start.velocities.iter_mut().enumerate() {
        let [x, y, z] = [0; 3].map(|_| JITTER * random.symmetric());
        if !scene.model.particles.is_prescribed(vertex) {
            *velocity += Vec3::new(x, y, z);
        }
    }
    scene
}

fn hung(stiffness: Real) -> Result<Scene, BenchError> {
    let settings = Settings::of(&format!("n={N} stiffness={stiffness}"));
    scene::build("hang", None, &settings)
}

/// The sheet moved by `offset` (m) along each axis: its edges lose as many digits as its coordinates have more.
pub fn far_away(offset: Real, stiffness: Real) -> Result<Scene, BenchError> {
    let mut scene = hung(stiffness)?;
    for x in &mut scene.start.positions {
        *x += Vec3::repeat(offset);
    }
    Ok(scene)
}

/// The free corner opposite to the held ones is heavier than an inner vertex by `mass`, and the half of the sheet
/// beyond the middle stiffer by `stiffness`.
fn uneven(mass: Real, stiffness: Real) -> Result<Scene, BenchError> {
    let mut scene = hung(1e2)?;
    let model = &mut scene.model;
    let particles = &mut model.particles;
    let inner = particles.mass()[N + 1];
    let corner = (0..particles.len())
        .rev()
        .find(|&v| !particles.is_prescribed(v) && scene.start.positions[v].x == 0.0)
        .ok_or_else(|| BenchError::Failed("every corner is held".into()))?;
    particles.set_mass(corner, mass * inner)?;
    for spring in &mut model.springs {
        let [a, b] = spring.vertices.map(|v| scene.start.positions[v as usize].x);
        if a + b > 1.0 {
            spring.stiffness *= stiffness;
        }
    }
    Ok(scene)
}

/// One row of the sheet is lower than the others by the factor `height`.
fn slivers(height: Real, stiffness: Real) -> Result<Scene, BenchError> {
    let cells = N - 1;
    let flat = grid(N, N, 1.0, 1.0, Diagonals::Alternating).map_err(BenchError::usage)?;
    let row = 1.0 / cells as Real;
    let middle = 0.5;
    let squeeze = |p: &Vec3| {
        let beyond = (p.y - middle).clamp(0.0, row);
        Vec3::new(p.x, p.y - beyond * (1.0 - height), p.z)
    };
    let squeezed = flat.positions().iter().map(squeeze).collect();
    let mesh = TriMesh::new(squeezed, flat.triangles().to_vec()).map_err(BenchError::usage)?;
    let base = hung(stiffness)?;
    let cloth = Cloth {
        areal_density: 0.2,
        membrane: Membrane::SpringStiffness(stiffness),
        bending_rigidity: 1e-5,
    };
    let mut model = cloth.on(&mesh).map_err(BenchError::usage)?;
    for vertex in 0..model.particles.len() {
        if base.model.particles.is_prescribed(vertex) {
            model.particles.prescribe(vertex)?;
        }
    }
    Ok(Scene {
        model,
        start: State::at_rest(mesh.positions().to_vec()),
        mesh: Some(mesh),
        ..base
    })
}

//! What is around the steps: yardsticks, the air, strain limiting, coarse corrections, crossings and distances, frames
//! of films and exports, pictures.

use cloth_bench::export::{Export, Format};
use cloth_bench::report::player::Film;
use cloth_bench::report::render::{Surface, View, render};
use cloth_bench::run::Moment;
use cloth_collide::SeparationProbe;
use cloth_core::air::{Air, AirConfig};
use cloth_core::math::{Real, Vec3};
use cloth_core::measure::{self, Strain};
use cloth_core::mesh::TriMesh;
use cloth_core::particles::{Particles, State};
use cloth_core::step::{Outcome, StepInput, StepReport};
use cloth_pbd::{Hierarchy, HierarchyConfig, StrainLimiter, StretchRange};
use criterion::{Criterion, Throughput};
use support::sheet::shaken;
use support::{limit, sheet};

const SIDES: [u32; 3] = [32, 128, 256];

/// Positions of a mesh as a state that moves.
fn moving(mesh: &TriMesh) -> State {
    let mut state = State::at_rest(shaken(mesh.positions()));
    state.velocities.clone_from(&state.positions);
    state
}

fn yardsticks(criterion: &mut Criterion) {
    for side in SIDES {
        let scene = sheet::sheet(side);
        let mesh = scene.mesh.as_ref().expect("a sheet");
        let state = moving(mesh);
        let (x, v) = (&state.positions, &state.velocities);
        let vectors = size_of_val(&x[..]);
        let particles: &Particles = &scene.model.particles;
        let masses = size_of_val(particles.mass());
        let springs = &scene.model.springs;
        let mut group = criterion.benchmark_group(format!("yardsticks, {side} a side"));
        group.throughput(Throughput::Elements(x.len() as u64));
        let bytes = size_of_val(&springs[..]) + vectors;
        limit::bench(&mut group, "strain", bytes, || Strain::of(springs, x));
        limit::bench(&mut group, "kinetic energy", vectors + masses, || {
            measure::kinetic_energy(particles, v)
        });
        let bytes = 2 * vectors + masses;
        limit::bench(&mut group, "angular momentum", bytes, || {
            measure::angular_momentum(particles, &state)
        });
        let input = StepInput::new(scene.dt).gravity(scene.gravity);
        let mut out = x.clone();
        limit::bench(&mut group, "prediction", 3 * vectors + masses, || {
            measure::predict(particles, &state, &input, &mut out);
        });
        let wind = Vec3::new(1.0, 2.0, 3.0);
        let config = AirConfig {
            wind,
            lift: 0.5,
            ..AirConfig::default()
        };
        let mut air = Air::new(config, 0.2, mesh).expect("air");
        let bytes = size_of_val(mesh.triangles()) + 4 * vectors;
        limit::bench(&mut group, "air", bytes, || air.load(&state, scene.dt)[0]);
        if side < 256 {
            let mut probe = SeparationProbe::new(mesh);
            let bytes = size_of_val(mesh.triangles()) + vectors;
            limit::bench(&mut group, "crossings and distance", bytes, || {
                probe.measure(x)
            });
        }
    }
}

fn corrections(criterion: &mut Criterion) {
    for side in SIDES {
        let scene = sheet::sheet(side);
        let mesh = scene.mesh.as_ref().expect("a sheet");
        let particles = &scene.model.particles;
        let springs = &scene.model.springs;
        let start = moving(mesh);
        let vectors = size_of_val(&start.positions[..]);
        let mut group = criterion.benchmark_group(format!("corrections, {side} a side"));
        group.throughput(Throughput::Elements(springs.len() as u64));
        // One pass over all edges, of which half are too long.
        let limiter = StrainLimiter::builder(particles);
        let limiter = limiter.springs(springs, StretchRange::stretch(0.01));
        let mut limiter = limiter.max_passes(1).build().expect("limits");
        let mut state = start.clone();
        let bytes = size_of_val(&springs[..]) + 6 * vectors;
        limit::bench(&mut group, "strain limit, one pass", bytes, || {
            state.clone_from(&start);
            limiter.apply(&mut state, scene.dt)
        });
        if side < 256 {
            let levels = Hierarchy::build(mesh, particles, HierarchyConfig::default());
            let mut levels = levels.expect("levels");
            let mut x = start.positions.clone();
            limit::bench(&mut group, "coarse levels", 2 * vectors, || {
                x.clone_from(&start.positions);
                levels.correct(&mut x);
            });
        }
    }
}

fn frames(criterion: &mut Criterion) {
    for side in SIDES {
        let scene = sheet::sheet(side);
        let mesh = scene.mesh.as_ref().expect("a sheet");
        let state = moving(mesh);
        let report = StepReport::new(Outcome::Converged, 1);
        let moment = Moment {
            step: 1,
            scene: &scene,
            state: &state,
            report: &report,
            forces: None,
            pin_loads: None,
            held: 0.0,
            given: 0.0,
            tangled: None,
        };
        let x = &state.positions;
        let bytes = size_of_val(&x[..]) + size_of_val(mesh.triangles());
        let mut group = criterion.benchmark_group(format!("frames, {side} a side"));
        group.sample_size(10);
        group.throughput(Throughput::Elements(x.len() as u64));
        let folder = std::env::temp_dir().join(format!("cloth-frames-{}", std::process::id()));
        for (name, format) in [
            ("OBJ", Format::Obj),
            ("PLY", Format::Ply),
            ("VTK", Format::Vtk),
        ] {
            let export = Export::begin(&scene, &folder, format, 1);
            let mut export = export.expect("a folder for temporary files");
            limit::bench(&mut group, name, bytes, || export.after(&moment));
            // What was written is of no use to anybody.
            drop(export);
            let _ = std::fs::remove_dir_all(&folder);
        }
        limit::bench(&mut group, "glTF, two frames", bytes, || {
            let export = Export::begin(&scene, &folder, Format::Gltf, 1);
            let mut export = export.expect("a folder for temporary files");
            export.after(&moment).expect("a frame");
            export.finish()
        });
        let _ = std::fs::remove_dir_all(&folder);
        limit::bench(&mut group, "film, two frames", 2 * bytes, || {
            Film::of_cloth(mesh.triangles(), &[x.clone(), x.clone()])
        });
        let view = View::default();
        let pixels = 4 * view.width * view.height;
        limit::bench(&mut group, "picture", bytes + pixels, || {
            render(&[Surface::cloth(x, mesh.triangles())], &view)
        });
    }
}

/// What a scene costs before its first step, for the method that builds most.
fn scenes(criterion: &mut Criterion) {
    for side in SIDES {
        let scene = sheet::sheet(side);
        let vectors = size_of_val(&scene.start.positions[..]);
        let springs = size_of_val(&scene.model.springs[..]);
        let hinges = size_of_val(&scene.model.hinges[..]);
        let bytes = 2 * vectors + springs + hinges + (side * side) as usize * size_of::<Real>();
        let mut group = criterion.benchmark_group(format!("scene, {side} a side"));
        group.sample_size(10);
        limit::bench(&mut group, "build the hanging sheet", bytes, || {
            sheet::sheet(side)
        });
    }
}

fn main() {
    limit::main(&[yardsticks, corrections, frames, scenes]);
}

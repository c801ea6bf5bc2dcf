//! What contact costs in a step of a folded sheet: an accordion of sixteen layers, with noise, six or two thicknesses
//! apart on average.
//!
//! `apart` moves it as a whole, so that nothing comes nearer than it was and only the search for candidates is left;
//! `pressed` squeezes the pile by a hundredth in every step, at a thickness of 2 mm; `floor` lets it fall on a floor
//! without looking for contact of the cloth with itself. All start from the same positions each time, which are safe
//! because a step that stays there comes before, outside of the time.

use cloth_bench::crumpled::accordion;

use cloth_collide::obstacle::{HalfSpace, Obstacle, Pose, RigidMotion};
use cloth_collide::potential::PotentialContacts;
use cloth_core::contact::{ContactStep, Projection};
use cloth_core::math::{Real, Vec3};
use criterion::Criterion;
use std::hint::black_box;
use std::time::{Duration, Instant};
use support::limit;

const THICKNESS: Real = 0.002;
/// Sweeps over the contacts of a step.
const SWEEPS: u32 = 4;
const DT: Real = 1.0 / 600.0;

/// One resolved step from `from` to where `end` (m) takes each position; returns how long it took.
fn resolve(
    contacts: &mut PotentialContacts,
    from: &[Vec3],
    end: impl Fn(&Vec3) -> Vec3,
) -> Duration {
    let mut positions: Vec<_> = from.iter().map(end).collect();
    let ways = positions.iter().zip(from);
    let mut velocities: Vec<_> = ways.map(|(to, x)| (to - x) / DT).collect();
    let inverse_mass = vec![1e4; from.len()];
    let step = ContactStep {
        from: black_box(from),
        inverse_mass: &inverse_mass,
        dt: DT,
    };
    let mut projection = Projection::default();
    let (x, v) = (&mut positions, &mut velocities);
    let started = Instant::now();
    let resolved = projection.step(contacts, &step, SWEEPS, x, v);
    resolved.expect("a way");
    started.elapsed()
}

/// The same many times over, each from a start that is known to be safe.
fn repeat(
    contacts: &mut PotentialContacts,
    from: &[Vec3],
    end: impl Fn(&Vec3) -> Vec3,
    count: u64,
) -> Duration {
    let once = |_| {
        resolve(contacts, from, |x| *x);
        resolve(contacts, from, &end)
    };
    (0..count).map(once).sum()
}

fn response(criterion: &mut Criterion) {
    for (side, gap) in [(33, 0.012), (129, 0.012), (129, 0.004)] {
        let (mesh, from) = accordion(side, gap).expect("a sheet");
        let count = mesh.triangle_count();
        let name = format!("response, {count} triangles, layers {} mm apart", 1e3 * gap);
        let mut group = criterion.benchmark_group(name);
        group.sample_size(10);
        let mut contacts = PotentialContacts::builder(&mesh)
            .thickness(THICKNESS)
            .friction(0.3)
            .build()
            .expect("settings in range");
        // Positions before and after, velocities, inverse masses, and the triangles.
        let bytes = 3 * size_of_val(&from[..]) + 8 * from.len() + size_of_val(mesh.triangles());
        let shift = Vec3::new(0.01, 0.0, 0.02);
        limit::timed(&mut group, "apart", bytes, |count| {
            repeat(&mut contacts, &from, |x| x + shift, count)
        });
        let press = |x: &Vec3| Vec3::new(x.x, x.y, 0.99 * x.z);
        limit::timed(&mut group, "pressed", bytes, |count| {
            repeat(&mut contacts, &from, press, count)
        });
        println!("{:?}", contacts.constraint_report());
        let still = RigidMotion::still(Pose::at(Vec3::z() * -THICKNESS));
        let floor = HalfSpace::new(Vec3::z()).expect("a normal");
        let floor = Obstacle::moving(floor, still).expect("a motion");
        let mut contacts = PotentialContacts::builder(&mesh)
            .self_collision(false)
            .obstacle(floor, 0.3)
            .build()
            .expect("settings in range");
        let fall = |x: &Vec3| x - Vec3::z() * 0.005;
        limit::timed(&mut group, "floor", bytes, |count| {
            repeat(&mut contacts, &from, fall, count)
        });
        group.finish();
    }
}

fn main() {
    limit::main(&[response]);
}

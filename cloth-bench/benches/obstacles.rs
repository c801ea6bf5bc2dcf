//! What a vertex costs against an obstacle: one signed distance, one swept search, for every shape.

use cloth_collide::obstacle::{
    Capsule, ClosedMesh, Cuboid, HalfSpace, Obstacle, RigidMotion, SampledDistance, Sphere,
    VertexPath, first_contact,
};
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::generate;
use criterion::{Criterion, Throughput};
use std::hint::black_box;
use support::limit;

fn obstacles() -> Vec<(&'static str, Obstacle)> {
    let turning = RigidMotion {
        velocity: Vec3::new(0.1, 0.2, 0.3),
        angular_velocity: Vec3::new(0.0, 1.0, 2.0),
        ..RigidMotion::default()
    };
    let ball = Sphere::new(0.5).expect("a sphere");
    let mesh = generate::sphere(16, 0.5).expect("5120 triangles");
    let mesh = ClosedMesh::new(&mesh).expect("a closed mesh");
    let samples = SampledDistance::new(&mesh, 0.02, 0.1).expect("a grid");
    let mut obstacles = vec![
        (
            "half-space",
            Obstacle::new(HalfSpace::new(Vec3::z()).expect("a normal")),
        ),
        ("sphere", Obstacle::new(ball)),
        (
            "box",
            Obstacle::new(Cuboid::new(Vec3::repeat(0.4)).expect("a box")),
        ),
        (
            "capsule",
            Obstacle::new(Capsule::new(0.3, 0.2).expect("a capsule")),
        ),
        ("mesh of 5120 triangles", Obstacle::new(mesh)),
        ("samples of that mesh", Obstacle::new(samples)),
    ];
    let moved = Obstacle::moving(ball, turning).expect("a motion");
    obstacles.push(("sphere, turning", moved));
    obstacles
}

/// A cloud of points (m) around the obstacles.
fn points() -> Vec<Vec3> {
    let wave = |i: u32, k: Real| 0.8 * (12.9898 * Real::from(i) + 78.233 * k).sin();
    let point = |i| Vec3::new(wave(i, 1.0), wave(i, 2.0), wave(i, 3.0));
    (0..1000).map(point).collect()
}

fn distances(criterion: &mut Criterion) {
    let points = points();
    let mut group = criterion.benchmark_group("signed distance of 1000 points");
    group.throughput(Throughput::Elements(points.len() as u64));
    for (name, obstacle) in obstacles() {
        limit::bench(&mut group, name, size_of_val(&points[..]), || {
            let value = |&x: &Vec3| obstacle.signed_distance(x, 0.01).value;
            black_box(&points).iter().map(value).sum::<Real>()
        });
    }
    group.finish();
}

fn sweeps(criterion: &mut Criterion) {
    let points = points();
    let dt = 1.0 / 60.0;
    let mut group = criterion.benchmark_group("first contact of 1000 vertices, 5 m/s");
    group.throughput(Throughput::Elements(points.len() as u64));
    for (name, obstacle) in obstacles() {
        limit::bench(&mut group, name, size_of_val(&points[..]), || {
            let hit = |&x: &Vec3| {
                let path = VertexPath::straight(x, x - Vec3::z() * (5.0 * dt), dt);
                first_contact(&obstacle, &path, 0.0, dt, 0.001).is_some()
            };
            black_box(&points).iter().filter(|x| hit(x)).count()
        });
    }
    group.finish();
}

fn main() {
    limit::main(&[distances, sweeps]);
}

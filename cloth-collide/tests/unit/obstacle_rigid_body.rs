use super::*;
use cloth_core::mesh::generate;

const DENSITY: Real = 700.0;

fn near(a: Real, b: Real, part: Real) -> bool {
    (a - b).abs() <= part * b.abs()
}

/// A cube of 0.2 m whose mesh is shifted: mass, centre and inertia are those of the closed form.
#[test]
fn mesh_has_the_mass_and_inertia_of_its_box() {
    let half = Vec3::new(0.1, 0.05, 0.2);
    let shift = Vec3::new(0.3, -0.2, 0.7);
    let centred = generate::cuboid(half.into()).unwrap();
    let corners = centred.positions().iter().map(|x| x + shift).collect();
    let mesh = TriMesh::new(corners, centred.triangles().to_vec()).unwrap();
    let (body, centre) = RigidBody::of_mesh(DENSITY, &mesh, Vec3::zeros()).unwrap();
    let exact = RigidBody::cuboid(DENSITY, half, Vec3::zeros()).unwrap();
    assert!((centre - shift).norm() < 1e-14);
    assert!(near(body.mass(), exact.mass(), 1e-13));
    assert!((body.inertia() - exact.inertia()).norm() < 1e-12 * exact.inertia().norm());
}

/// The meshes of a ball and of a capsule come near their closed forms as they become finer.
#[test]
fn ball_and_capsule_have_the_mass_and_inertia_of_their_meshes() {
    let (radius, half) = (0.1, 0.15);
    let ball = generate::sphere(30, radius).unwrap();
    let stretch = |x: &Vec3| x + Vec3::z() * if x.z < 0.0 { -half } else { half };
    let long = ball.positions().iter().map(stretch).collect();
    let capsule = TriMesh::new(long, ball.triangles().to_vec()).unwrap();
    let zero = Vec3::zeros();
    for (mesh, exact) in [
        (&ball, RigidBody::sphere(DENSITY, radius, zero)),
        (&capsule, RigidBody::capsule(DENSITY, half, radius, zero)),
    ] {
        let (body, _) = RigidBody::of_mesh(DENSITY, mesh, zero).unwrap();
        let exact = exact.unwrap();
        assert!(near(body.mass(), exact.mass(), 0.02), "{body:?} {exact:?}");
        let off = body.inertia() - exact.inertia();
        assert!(
            off.norm() < 0.03 * exact.inertia().norm(),
            "{body:?} {exact:?}"
        );
    }
}

/// Without forces a box that turns about no principal axis keeps its angular momentum, and its energy to second
/// order of the step.
#[test]
fn free_box_keeps_its_angular_momentum() {
    let body = RigidBody::cuboid(DENSITY, Vec3::new(0.1, 0.05, 0.2), Vec3::zeros()).unwrap();
    let off = |steps: u32| {
        let dt = 1.0 / Real::from(steps);
        let mut motion = RigidMotion {
            angular_velocity: Vec3::new(3.0, 0.1, 2.0),
            ..RigidMotion::default()
        };
        let momenta = body.momenta(&motion);
        let energy = |motion: &RigidMotion| 0.5 * motion.angular_velocity.dot(&momenta[1]);
        let start = energy(&motion);
        for _ in 0..steps {
            motion = body.motion(motion.pose, momenta, dt);
            motion.pose = motion.pose_at(dt);
        }
        let end = body.motion(motion.pose, momenta, 0.0);
        let kept = body.momenta(&end);
        assert!((kept[1] - momenta[1]).norm() < 1e-12 * momenta[1].norm());
        (energy(&end) / start - 1.0).abs()
    };
    let [coarse, fine] = [off(100), off(200)];
    assert!(coarse < 1e-3 && fine < 0.3 * coarse, "{coarse} {fine}");
}

/// A ball all around which contact presses swings with the closed form: ∫ n nᵀ dA = (4/3) π r² I.
#[test]
fn ball_swings_at_the_frequency_of_the_closed_form() {
    let (radius, stiffness) = (0.1, 1e6);
    let body = RigidBody::sphere(DENSITY, radius, Vec3::zeros()).unwrap();
    let surface = generate::sphere(30, radius).unwrap();
    let exact = (stiffness * 4.0 / 3.0 * PI * radius * radius / body.mass()).sqrt();
    let found = body.highest_frequency(stiffness, &surface);
    assert!(near(found, exact, 0.01), "{found} {exact}");
}

#[test]
fn what_cannot_be_moved_is_refused() {
    let identity = Matrix3::identity();
    assert!(RigidBody::new(0.0, identity, Vec3::zeros()).is_err());
    assert!(RigidBody::new(1.0, -identity, Vec3::zeros()).is_err());
    assert!(RigidBody::new(1.0, identity, Vec3::new(Real::NAN, 0.0, 0.0)).is_err());
    // Of a disk one moment is the sum of the two others; of nothing is it more.
    let moments = |largest| Matrix3::from_diagonal(&Vec3::new(1.0, largest, 1.0));
    assert!(RigidBody::new(1.0, moments(2.0), Vec3::zeros()).is_ok());
    let error = RigidBody::new(1.0, moments(2.1), Vec3::zeros()).unwrap_err();
    assert!(
        error.to_string().contains("the sum of the two others"),
        "{error}"
    );
}

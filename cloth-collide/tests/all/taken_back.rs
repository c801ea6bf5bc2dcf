//! Steps of a method that minimises, taken back and taken again: bodies, their time and friction are what they were.

use cloth_collide::obstacle::{
    AnimatedMesh, HalfSpace, Obstacle, Pose, RigidBody, RigidMotion, Sphere,
};
use cloth_collide::potential::PotentialContacts;
use cloth_core::contact::{ContactPotential, ContactSource, ContactStep};
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::TriMesh;

pub(super) const THICKNESS: Real = 1e-2;
pub(super) const DT: Real = 0.01;

/// A triangle with edges of 1 m, `height` (m) above z = 0.
pub(super) fn triangle(height: Real) -> TriMesh {
    let corners = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)].map(|(x, y)| Vec3::new(x, y, height));
    TriMesh::new(corners.to_vec(), vec![[0, 1, 2]]).unwrap()
}

pub(super) fn moving(at: Vec3, velocity: Vec3) -> RigidMotion {
    RigidMotion {
        pose: Pose::at(at),
        velocity,
        ..RigidMotion::default()
    }
}

/// Begins a step from `from` to `to` (m), and goes there; the energy (J) and its gradient (N) there.
pub(super) fn go(
    contacts: &mut PotentialContacts,
    from: &[Vec3],
    to: &[Vec3],
) -> (Real, Vec<Vec3>) {
    let inverse_mass = vec![1.0; from.len()];
    let step = ContactStep {
        from,
        inverse_mass: &inverse_mass,
        dt: DT,
    };
    ContactPotential::begin(contacts, &step, &mut from.to_vec()).unwrap();
    assert_eq!(contacts.limit(from, to).unwrap(), 1.0);
    let mut gradient = vec![Vec3::zeros(); from.len()];
    let energy = contacts.add_gradient(to, &mut gradient);
    (energy, gradient)
}

pub(super) fn end(contacts: &mut PotentialContacts, x: &[Vec3]) {
    ContactPotential::end(contacts, x, &mut vec![Vec3::zeros(); x.len()]);
}

pub(super) fn shifted(x: &[Vec3], by: Vec3) -> Vec<Vec3> {
    x.iter().map(|x| x + by).collect()
}

/// A spring of friction is stretched by 20 µm in one step, and by 20 µm more in the next.
#[test]
fn friction_is_stretched_as_before_a_step_that_is_taken_back() {
    let mesh = triangle(0.7 * THICKNESS);
    let floor = Obstacle::new(HalfSpace::new(Vec3::z()).unwrap());
    let mut contacts = PotentialContacts::builder(&mesh)
        .thickness(THICKNESS)
        .obstacle(floor, 0.5)
        .build()
        .unwrap();
    let (start, by) = (mesh.positions(), Vec3::x() * 2e-5);
    let (first, second) = (shifted(start, by), shifted(start, by * 2.0));
    let (_, once) = go(&mut contacts, start, &first);
    end(&mut contacts, &first);
    let (energy, twice) = go(&mut contacts, &first, &second);
    assert!((twice[0].x / once[0].x - 2.0).abs() < 1e-9, "{twice:?}");
    end(&mut contacts, &second);
    // Asked twice, it is taken back once.
    contacts.take_back();
    contacts.take_back();
    assert_eq!(go(&mut contacts, &first, &second), (energy, twice));
}

/// A surface that rises at 0.2 m/s, and nothing else that moves.
#[test]
fn an_animated_surface_alone_goes_back_in_time() {
    let mesh = triangle(0.9 * THICKNESS);
    let below = triangle(0.0);
    let shapes = [0.0, 0.2].map(|rise| shifted(below.positions(), Vec3::z() * rise));
    let animation = AnimatedMesh::new(shapes.to_vec(), 1.0).unwrap();
    let mut contacts = PotentialContacts::builder(&mesh)
        .thickness(THICKNESS)
        .animated(below, animation, 0.0)
        .build()
        .unwrap();
    let x = mesh.positions();
    let keep_free = |contacts: &mut PotentialContacts| {
        contacts.keep_free(x, &[1.0; 3], &mut x.to_vec()).unwrap();
    };
    let first = go(&mut contacts, x, x);
    end(&mut contacts, x);
    keep_free(&mut contacts);
    contacts.take_back();
    assert_eq!(go(&mut contacts, x, x), first);
    end(&mut contacts, x);
    let second = go(&mut contacts, x, x);
    assert!(second.0 > first.0);
    // Nor does a step that has not ended leave it where it would have come to.
    keep_free(&mut contacts);
    assert_eq!(go(&mut contacts, x, x), second);
}

/// What has been moved after the step, and kept free, is taken back with it.
#[test]
fn a_pushed_body_goes_back_to_where_the_step_began() {
    let mesh = triangle(0.9 * THICKNESS);
    let motion = moving(Vec3::new(0.0, 0.0, -0.1), Vec3::z() * 0.1);
    let ball = Obstacle::moving(Sphere::new(0.1).unwrap(), motion).unwrap();
    let mut contacts = PotentialContacts::builder(&mesh)
        .thickness(THICKNESS)
        .obstacle(ball, 0.0)
        .free(0, RigidBody::sphere(100.0, 0.1, Vec3::zeros()).unwrap())
        .build()
        .unwrap();
    let x = mesh.positions();
    let motions = |contacts: &PotentialContacts| contacts.free_motions().collect::<Vec<_>>();
    let before = motions(&contacts);
    let first = go(&mut contacts, x, x);
    end(&mut contacts, x);
    let after = motions(&contacts);
    assert!(after[0].1.velocity.z < 0.09, "{after:?}");
    contacts.keep_free(x, &[1.0; 3], &mut x.to_vec()).unwrap();
    assert_eq!(motions(&contacts), after);
    contacts.take_back();
    assert_eq!(go(&mut contacts, x, x), first);
    // It is there when the next one begins, and pushed as before.
    assert_eq!(before[0].1.pose.position.z, -0.1);
}

/// A floor takes along what it presses at the start of a step by friction, though that has left it at the end: the
/// work is that of μ λ over the displacement of the floor.
#[test]
fn friction_of_a_body_works_on_what_leaves_it_in_the_step() {
    let mesh = triangle(0.7 * THICKNESS);
    let speed = Vec3::x() * 0.5;
    let floor = HalfSpace::new(Vec3::z()).unwrap();
    let mut contacts = PotentialContacts::builder(&mesh)
        .thickness(THICKNESS)
        .obstacle(
            Obstacle::moving(floor, moving(Vec3::zeros(), speed)).unwrap(),
            0.5,
        )
        .build()
        .unwrap();
    let start = mesh.positions();
    let [far, farther] = [40.0, 45.0].map(|h| shifted(start, Vec3::z() * (h * THICKNESS)));
    go(&mut contacts, start, &far);
    // On this path nothing is near any more.
    assert_eq!(contacts.limit(&far, &farther).unwrap(), 1.0);
    let mut gradient = [Vec3::zeros(); 3];
    contacts.add_gradient(&farther, &mut gradient);
    end(&mut contacts, &farther);
    let force: Vec3 = gradient.iter().sum::<Vec3>() * -1.0;
    // μ κ A (h − d), in the direction of the floor's motion.
    let expected = 0.5 * 1e6 * 0.5 * 0.3 * THICKNESS;
    assert!((force.x / expected - 1.0).abs() < 1e-9, "{force}");
    let work = expected * speed.x * DT;
    assert!(
        (contacts.work() / work - 1.0).abs() < 1e-9,
        "{} J",
        contacts.work()
    );
}

/// A ball that rises at 0.1 m/s is told to stand still, and a free one is held and let go, while a step has begun that
/// never ends, or after one that is taken back.
#[test]
fn what_bodies_are_told_outlasts_a_step_that_is_taken_back() {
    let mesh = triangle(0.9 * THICKNESS);
    let x = mesh.positions();
    let contacts_with = |velocity: Vec3, is_free: bool| {
        let ball = Sphere::new(0.1).unwrap();
        let ball = Obstacle::moving(ball, moving(Vec3::z() * -0.1, velocity)).unwrap();
        let contacts = PotentialContacts::builder(&mesh)
            .thickness(THICKNESS)
            .obstacle(ball, 0.0);
        match is_free {
            true => contacts.free(0, RigidBody::sphere(100.0, 0.1, Vec3::zeros()).unwrap()),
            false => contacts,
        }
        .build()
        .unwrap()
    };
    let still = go(&mut contacts_with(Vec3::zeros(), false), x, x);
    for ends in [false, true] {
        let interrupted = |is_free: bool| {
            let mut contacts = contacts_with(Vec3::z() * 0.1, is_free);
            go(&mut contacts, x, x);
            if ends {
                end(&mut contacts, x);
                contacts.take_back();
            }
            contacts
        };
        let mut driven = interrupted(false);
        assert!(driven.set_velocities(0, [Vec3::zeros(); 2]).unwrap());
        for _ in 0..3 {
            assert_eq!(go(&mut driven, x, x), still, "{ends}");
            end(&mut driven, x);
        }
        let mut free = interrupted(true);
        assert!(free.hold_body(0, true) && free.hold_body(0, false));
        let motion = free.free_motions().next().unwrap().1;
        assert_eq!(motion.velocity, Vec3::zeros(), "{ends}");
        assert_eq!(go(&mut free, x, x), still, "{ends}");
    }
}

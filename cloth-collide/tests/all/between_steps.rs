//! What is read and changed between steps: where bodies are, and friction.

use super::taken_back::{DT, THICKNESS, end, go, moving, shifted, triangle};
use cloth_collide::obstacle::{AnimatedMesh, HalfSpace, Obstacle, Pose, RigidBody, Sphere};
use cloth_collide::potential::PotentialContacts;
use cloth_core::contact::{ContactConstraints, ContactStep};
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::TriMesh;

/// The motion of a ball 1 m below, which turns and flies, is that of the closed form after each step; one that failed
/// does not count.
#[test]
fn the_motion_of_a_body_is_where_it_is_after_the_step() {
    let mesh = triangle(0.0);
    let x = mesh.positions();
    let mut motion = moving(Vec3::z() * -1.0, Vec3::x() * 0.3);
    motion.angular_velocity = Vec3::z() * 2.0;
    let ball = Obstacle::moving(Sphere::new(0.1).unwrap(), motion).unwrap();
    let builder = PotentialContacts::builder(&mesh).obstacle(ball, 0.0);
    let mut contacts = builder.build().unwrap();
    for step in 0..3 {
        let now = contacts.motion(0).unwrap();
        let time = Real::from(step) * DT;
        assert!((now.pose.position - motion.pose_at(time).position).norm() < 1e-15);
        // A vector of its frame along x, in the world.
        let (sin, cos) = (2.0 * time).sin_cos();
        let along = now.pose.orientation * Vec3::x();
        assert!((along - Vec3::new(cos, sin, 0.0)).norm() < 1e-15);
        assert_eq!(now.velocity, motion.velocity);
        assert_eq!(now.angular_velocity, motion.angular_velocity);
        // In the view of constraints bodies go on within a step; this one does not end.
        let taken = ContactStep {
            from: x,
            inverse_mass: &[1.0; 3],
            dt: DT,
        };
        contacts.begin_step(&taken).unwrap();
        contacts.begin_substep(&taken, x).unwrap();
        contacts.end_substep(&taken, &mut x.to_vec()).unwrap();
        assert_eq!(contacts.motion(0), Some(now), "in step {step}");
        go(&mut contacts, x, x);
        end(&mut contacts, x);
    }
    assert_eq!(contacts.motion(1), None);
    let last = contacts.motion(0).unwrap();
    contacts.take_back();
    let before = contacts.motion(0).unwrap();
    let moved = last.pose.position - before.pose.position;
    assert!((moved - Vec3::x() * (0.3 * DT)).norm() < 1e-15);
}

/// A ball of 2 kg in free fall, by the step of symplectic Euler.
#[test]
fn the_motion_of_a_pushed_body_is_that_of_its_momenta() {
    let mesh = triangle(0.0);
    let x = mesh.positions();
    let start = Pose::at(Vec3::z() * -1.0);
    let ball = Obstacle::moving(Sphere::new(0.1).unwrap(), moving(start.position, Vec3::y()));
    let body = RigidBody::sphere(2.0, 0.1, Vec3::z() * -10.0).unwrap();
    let builder = PotentialContacts::builder(&mesh).obstacle(ball.unwrap(), 0.0);
    let mut contacts = builder.free(0, body).build().unwrap();
    go(&mut contacts, x, x);
    end(&mut contacts, x);
    let motion = contacts.motion(0).unwrap();
    let velocity = Vec3::new(0.0, 1.0, -10.0 * DT);
    assert!((motion.velocity - velocity).norm() < 1e-14, "{motion:?}");
    assert!((motion.pose.position - start.position - velocity * DT).norm() < 1e-14);
    assert_eq!(contacts.free_motions().next(), Some((0, motion)));
    contacts.take_back();
    let before = contacts.motion(0).unwrap();
    assert_eq!((before.pose, before.velocity), (start, Vec3::y()));
}

/// What a triangle is pressed on in these tests.
#[derive(Clone, Copy, Debug)]
enum Below {
    Floor,
    Animated,
    Cloth,
}

/// A triangle 0.7 thicknesses above something, with a coefficient of friction; and all vertices of the cloth.
fn pressed(below: Below, friction: Real) -> (PotentialContacts, Vec<Vec3>) {
    let own = triangle(0.7 * THICKNESS);
    let wide = [(-1.0, -1.0), (4.0, -1.0), (-1.0, 4.0)].map(|(x, y)| Vec3::new(x, y, 0.0));
    let other = TriMesh::new(wide.to_vec(), vec![[0, 1, 2]]).unwrap();
    let both = [own.positions(), other.positions()].concat();
    let cloth = match below {
        Below::Cloth => TriMesh::new(both, vec![[0, 1, 2], [3, 4, 5]]).unwrap(),
        _ => own,
    };
    let builder = PotentialContacts::builder(&cloth).thickness(THICKNESS);
    let builder = match below {
        Below::Floor => {
            let floor = Obstacle::new(HalfSpace::new(Vec3::z()).unwrap());
            builder.obstacle(floor, friction)
        }
        Below::Animated => {
            let one = AnimatedMesh::new(vec![other.positions().to_vec()], 1.0).unwrap();
            builder.animated(other, one, friction)
        }
        Below::Cloth => builder.friction(friction),
    };
    let contacts = builder.build().unwrap();
    (contacts, cloth.positions().to_vec())
}

/// A step in the view of constraints from `from` towards `to` (m), and where it ends.
fn project(contacts: &mut PotentialContacts, from: &[Vec3], to: &[Vec3]) -> Vec<Vec3> {
    let inverse_mass = vec![1.0; from.len()];
    let step = ContactStep {
        from,
        inverse_mass: &inverse_mass,
        dt: DT,
    };
    let mut x = to.to_vec();
    contacts.begin_step(&step).unwrap();
    contacts.begin_substep(&step, to).unwrap();
    (0..5).for_each(|_| contacts.sweep(&step, &mut x));
    contacts.end_substep(&step, &mut x).unwrap();
    contacts.end_step(&x);
    x
}

/// After a step at rest with μ = 0.2, friction is set to 0.4: the next step is that of contact built with 0.4, in both
/// views, on everything that there is friction on.
#[test]
fn friction_that_is_set_between_steps_acts_as_if_built_so() {
    for below in [Below::Floor, Below::Animated, Below::Cloth] {
        let run = |built: Real, set: Option<Real>| {
            let (mut contacts, x) = pressed(below, built);
            let mut to = x.clone();
            to[..3].iter_mut().for_each(|x| x.x += 1e-3);
            let mut other = contacts.clone();
            go(&mut contacts, &x, &x);
            end(&mut contacts, &x);
            project(&mut other, &x, &x);
            for contacts in [&mut contacts, &mut other] {
                match (set, below) {
                    (Some(friction), Below::Cloth) => contacts.set_friction(friction).unwrap(),
                    (Some(friction), _) => contacts.set_body_friction(0, friction).unwrap(),
                    _ => {}
                }
            }
            let (_, gradient) = go(&mut contacts, &x, &to);
            let force = gradient[..3].iter().map(|g| g.x).sum::<Real>();
            (force, project(&mut other, &x, &to))
        };
        let [less, more, set] =
            [(0.2, None), (0.4, None), (0.2, Some(0.4))].map(|(a, b)| run(a, b));
        assert!(less.0 > 0.0, "{below:?}");
        assert!((more.0 / less.0 - 2.0).abs() < 1e-9, "{below:?}");
        assert_eq!(set.0, more.0, "{below:?}");
        assert!(less.1[0].x > more.1[0].x + 1e-9, "{below:?}");
        assert_eq!(set.1, more.1, "{below:?}");
    }
}

#[test]
fn friction_out_of_range_or_of_no_body_is_refused() {
    let (mut contacts, x) = pressed(Below::Animated, 0.2);
    for friction in [-0.1, Real::NAN, Real::INFINITY] {
        let refused = contacts.set_friction(friction).unwrap_err();
        assert_eq!(refused.name, "friction of contact");
        let refused = contacts.set_body_friction(0, friction).unwrap_err();
        assert_eq!(refused.name, "friction of a body");
    }
    let refused = contacts.set_body_friction(1, 0.5).unwrap_err();
    assert!(refused.to_string().starts_with("number of a body is 1"));
    let (mut fresh, _) = pressed(Below::Animated, 0.2);
    let to = shifted(&x, Vec3::x() * 1e-3);
    assert_eq!(go(&mut contacts, &x, &to), go(&mut fresh, &x, &to));
}

use super::*;
use crate::random::Random;

#[test]
fn zone_keeps_its_shape_and_both_momenta() {
    let mut random = Random::new(5);
    let count = 12;
    let mut points = |size| (0..count).map(|_| random.point(size)).collect::<Vec<_>>();
    let (from, mut displacements, mut velocities) = (points(1.0), points(0.2), points(3.0));
    let inverse_mass: Vec<_> = (0..count).map(|k| 1.0 / (1.0 + k as Real)).collect();
    let mut to: Vec<_> = from
        .iter()
        .zip(&displacements)
        .map(|(x, u)| x + u)
        .collect();
    let zone: Vec<_> = (0..count as u32).map(|v| [0, v]).collect();
    let sum =
        |of: &dyn Fn(usize) -> Vec3| -> Vec3 { (0..count).map(|v| of(v) / inverse_mass[v]).sum() };
    let place = sum(&|v| to[v]);
    move_rigidly(&zone, &from, &mut to, &mut displacements, &inverse_mass);
    assert!((sum(&|v| to[v]) - place).norm() < 1e-12);
    for a in 0..count {
        for b in 0..a {
            let change = (to[a] - to[b]).norm() - (from[a] - from[b]).norm();
            assert!(change.abs() < 1e-14, "{change:e}");
        }
    }
    let momenta = |v: &[Vec3]| [sum(&|k| v[k]), sum(&|k| to[k].cross(&v[k]))];
    let before = momenta(&velocities);
    make_velocities_rigid(&zone, &to, &mut velocities, &inverse_mass);
    for (before, after) in before.iter().zip(momenta(&velocities)) {
        assert!((before - after).norm() < 1e-11 * before.norm());
    }
    // No two vertices come nearer to each other: it is one body.
    for (a, b) in [(0, 1), (3, 7), (11, 2)] {
        let rate = (to[a] - to[b]).dot(&(velocities[a] - velocities[b]));
        assert!(rate.abs() < 1e-13);
    }
}

/// A displacement that is a small turn and a shift already is kept, up to the second power of its angle.
#[test]
fn zone_turns_the_way_that_its_vertices_do() {
    let mut random = Random::new(9);
    let from: Vec<_> = (0..7).map(|_| random.point(1.0)).collect();
    let inverse_mass: Vec<_> = (1..8).map(Real::from).collect();
    let (turn, shift) = (Vec3::new(2e-4, -3e-4, 1e-4), Vec3::new(0.1, 0.2, -0.3));
    let rotation = Rotation3::new(turn);
    let moved: Vec<_> = from.iter().map(|x| rotation * x + shift).collect();
    let (mut to, mut displacements) = (moved.clone(), from.clone());
    let zone: Vec<_> = (0..7).map(|v| [0, v]).collect();
    move_rigidly(&zone, &from, &mut to, &mut displacements, &inverse_mass);
    for (to, moved) in to.iter().zip(&moved) {
        assert!((to - moved).norm() < 1e-6, "{to} {moved}");
    }
}

/// A prescribed vertex takes its zone along, and is not moved itself.
#[test]
fn zone_follows_its_prescribed_vertex() {
    let from = [Vec3::zeros(), Vec3::x(), Vec3::y()];
    let mut to = [Vec3::z(), Vec3::x(), Vec3::y() * 3.0];
    let inverse_mass = [0.0, 1.0, 2.0];
    let zone = [[0, 0], [0, 1], [0, 2]];
    move_rigidly(
        &zone,
        &from,
        &mut to,
        &mut [Vec3::zeros(); 3],
        &inverse_mass,
    );
    assert_eq!(to, from.map(|x| x + Vec3::z()));
}

//! The contact potential of a whole cloth: its derivatives, which paths are safe, and that it begins anew after a step
//! that failed.

use crate::random::Random;
use cloth_collide::SeparationProbe;
use cloth_collide::obstacle::{HalfSpace, Obstacle, PenaltyLaw, RigidMotion, Sphere};
use cloth_collide::potential::PotentialContacts;
use cloth_core::contact::{ContactError, ContactPotential, ContactStep};
use cloth_core::math::{Real, Vec3, is_finite};
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{Diagonals, grid};

const THICKNESS: Real = 0.05;

/// Two waved sheets above each other, nearer than the thickness in places, and a ball below them that they touch.
fn layers(random: &mut Random) -> TriMesh {
    let one = grid(6, 6, 0.5, 0.5, Diagonals::Alternating).unwrap();
    let count = one.vertex_count() as u32;
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for sheet in 0..2 {
        let height = 0.035 * Real::from(sheet);
        let mut place = |x: &Vec3| x + Vec3::new(0.02 * height, 0.013, height) + random.point(4e-3);
        positions.extend(one.positions().iter().map(&mut place));
        triangles.extend(one.triangles().iter().map(|t| t.map(|v| v + count * sheet)));
    }
    TriMesh::new(positions, triangles).unwrap()
}

fn contacts(mesh: &TriMesh, friction: Real, motion: RigidMotion) -> PotentialContacts {
    let ball = Sphere::new(0.2).unwrap();
    let builder = PotentialContacts::builder(mesh)
        .thickness(THICKNESS)
        .stiffness(1e4)
        .friction(friction)
        .obstacle(Obstacle::moving(ball, motion).unwrap(), friction);
    builder.build().unwrap()
}

/// Below the middle of the sheets, 3 cm from the lower one.
fn below() -> RigidMotion {
    let mut motion = RigidMotion::default();
    motion.pose.position = Vec3::new(0.25, 0.25, -0.23);
    motion
}

fn begin(contacts: &mut PotentialContacts, x: &[Vec3]) {
    let mut start = x.to_vec();
    let inverse_mass = vec![1.0; x.len()];
    let step = ContactStep {
        from: x,
        inverse_mass: &inverse_mass,
        dt: 0.01,
    };
    contacts.begin(&step, &mut start).unwrap();
    assert_eq!(contacts.limit(x, x).unwrap(), 1.0);
}

#[test]
fn gradient_is_that_of_the_energy_and_rows_are_its_change() {
    let mut random = Random::new(7);
    let mesh = layers(&mut random);
    for friction in [0.0, 0.4] {
        let x = mesh.positions().to_vec();
        let mut contacts = contacts(&mesh, friction, below());
        begin(&mut contacts, &x);
        // Friction has to have a way to resist.
        let shift = |x: &Vec3, random: &mut Random| x + random.point(1e-3);
        let at: Vec<Vec3> = x.iter().map(|x| shift(x, &mut random)).collect();
        assert_eq!(contacts.limit(&x, &at).unwrap(), 1.0);
        let value = |x: &[Vec3]| {
            let mut unused = vec![Vec3::zeros(); x.len()];
            contacts.add_gradient(x, &mut unused)
        };
        let mut gradient = vec![Vec3::zeros(); x.len()];
        assert!(contacts.add_gradient(&at, &mut gradient) > 1e-3);
        let size = gradient.iter().map(Vec3::amax).fold(0.0, Real::max);
        // So short that it hardly meets a place where the second derivative jumps.
        let step = 1e-8;
        let mut touched = 0;
        for vertex in 0..x.len() {
            for axis in 0..3 {
                let moved = |by: Real| {
                    let mut x = at.clone();
                    x[vertex][axis] += by;
                    value(&x)
                };
                let difference = (moved(step) - moved(-step)) / (2.0 * step);
                let found = gradient[vertex][axis];
                touched += u32::from(found != 0.0);
                assert!(
                    (difference - found).abs() < 1e-6 * size,
                    "{difference} {found}"
                );
            }
        }
        assert!(touched > 100, "{touched} entries");

        // Rows leave out what would make the Hessian indefinite, and add to it across friction: they bound it from
        // above.
        let mut rows = Vec::new();
        contacts.linearize(&at, &mut rows);
        for _ in 0..20 {
            let p: Vec<Vec3> = x.iter().map(|_| random.point(1.0)).collect();
            let at_end =
                |by: Real| -> Vec<Vec3> { at.iter().zip(&p).map(|(x, p)| x + p * by).collect() };
            let slope = |by: Real| {
                let x = at_end(by);
                let mut gradient = vec![Vec3::zeros(); x.len()];
                contacts.add_gradient(&x, &mut gradient);
                gradient.iter().zip(&p).map(|(g, p)| g.dot(p)).sum::<Real>()
            };
            let curvature = (slope(1e-7) - slope(-1e-7)) / 2e-7;
            let by_rows: Real = rows
                .iter()
                .map(|row| {
                    let ends = row.vertices.iter().zip(row.weights);
                    let along: Real = ends.map(|(v, w)| w * row.normal.dot(&p[*v as usize])).sum();
                    row.stiffness * along * along
                })
                .sum();
            assert!(
                by_rows > 0.0 && by_rows >= curvature * (1.0 - 1e-4),
                "{by_rows} {curvature}"
            );
        }
    }
}

/// The quadratic range is a spring, the barrier goes on from it with the same slope and curvature, and the derivatives
/// are those of the energy.
#[test]
fn two_stage_law_is_joined_twice_differentiably() {
    let (stiffness, range) = (1e6, 2e-3);
    let law = PenaltyLaw::new(stiffness, range).unwrap();
    assert_eq!(law.energy(range), 0.0);
    assert_eq!(law.slope(0.8 * range), -stiffness * (range - 0.8 * range));
    assert_eq!(law.energy(0.0), Real::INFINITY);
    let joint = 0.5 * range;
    let (above, below) = (joint * (1.0 + 1e-12), joint * (1.0 - 1e-12));
    for of in [PenaltyLaw::energy, PenaltyLaw::slope, PenaltyLaw::curvature] {
        let (a, b) = (of(&law, above), of(&law, below));
        assert!((a / b - 1.0).abs() < 1e-11, "{a} {b}");
    }
    for part in [0.01, 0.1, 0.3, 0.49, 0.51, 0.9] {
        let (d, step) = (part * range, 1e-6 * part * range);
        let slope = (law.energy(d + step) - law.energy(d - step)) / (2.0 * step);
        let curvature = (law.slope(d + step) - law.slope(d - step)) / (2.0 * step);
        assert!((slope / law.slope(d) - 1.0).abs() < 1e-8);
        assert!((curvature / law.curvature(d) - 1.0).abs() < 1e-8);
    }
}

/// Random paths, short and long, are cut where the layers would cross or the ball would be entered, and not elsewhere.
#[test]
fn ways_are_cut_before_anything_crosses() {
    let mut random = Random::new(11);
    let mut cut = 0;
    for _ in 0..60 {
        let mesh = layers(&mut random);
        let mut x = mesh.positions().to_vec();
        let mut contacts = contacts(&mesh, 0.2, below());
        begin(&mut contacts, &x);
        let mut probe = SeparationProbe::new(&mesh);
        for size in [1e-3, 0.1, 1e-2, 2.0, 0.05] {
            let to: Vec<Vec3> = x.iter().map(|x| x + random.point(size)).collect();
            let most = contacts.limit(&x, &to).unwrap();
            assert!((0.0..=1.0).contains(&most));
            cut += u32::from(most < 1.0);
            for (x, to) in x.iter_mut().zip(&to) {
                *x += (to - *x) * most;
            }
            let seen = probe.measure(&x).unwrap();
            assert_eq!(seen.intersecting_pairs, 0);
            let centre = Vec3::new(0.25, 0.25, -0.23);
            assert!(x.iter().all(|x| (x - centre).norm() > 0.2));
            let mut unused = vec![Vec3::zeros(); x.len()];
            let energy = contacts.add_gradient(&x, &mut unused);
            assert!((0.0..Real::INFINITY).contains(&energy), "{energy} J");
        }
    }
    assert!(cut > 100, "{cut} paths");
}

/// The same where each vertex has its own bound: nothing crosses, what is cut goes as far as it may, and what is far
/// from it goes all of its path.
#[test]
fn ways_are_cut_vertex_by_vertex() {
    let mut random = Random::new(13);
    let (mut cut, mut alone) = (0, 0);
    for _ in 0..60 {
        let mesh = layers(&mut random);
        let mut x = mesh.positions().to_vec();
        let mut contacts = contacts(&mesh, 0.2, below());
        begin(&mut contacts, &x);
        let mut probe = SeparationProbe::new(&mesh);
        let mut fractions = vec![0.0; x.len()];
        for size in [1e-3, 0.1, 1e-2, 0.05] {
            let wanted: Vec<Vec3> = x.iter().map(|x| x + random.point(size)).collect();
            let mut to = wanted.clone();
            let together = contacts.limit(&x, &to).unwrap();
            contacts.limit_each(&x, &mut to, &mut fractions).unwrap();
            let least = fractions.iter().copied().fold(1.0, Real::min);
            assert!((0.0..=1.0).contains(&least));
            for (vertex, fraction) in fractions.iter().enumerate() {
                let end = x[vertex] + (wanted[vertex] - x[vertex]) * *fraction;
                assert!((to[vertex] - end).norm() < 1e-15);
            }
            assert_eq!(least < 1.0, together < 1.0);
            cut += u32::from(least < 1.0);
            alone += u32::from(least < 1.0 && fractions.contains(&1.0));
            for time in [0.5, 1.0] {
                let places = x.iter().zip(&to).map(|(x, to)| x + (to - x) * time);
                let places: Vec<Vec3> = places.collect();
                let seen = probe.measure(&places).unwrap();
                assert_eq!(seen.intersecting_pairs, 0);
                let centre = Vec3::new(0.25, 0.25, -0.23);
                assert!(places.iter().all(|x| (x - centre).norm() > 0.2));
                let mut unused = vec![Vec3::zeros(); x.len()];
                let energy = contacts.add_gradient(&places, &mut unused);
                assert!((0.0..Real::INFINITY).contains(&energy), "{energy} J");
            }
            x = to;
        }
    }
    assert!(cut > 100 && alone > 100, "{cut} paths, {alone} in part");
}

/// A step that has begun and did not end leaves no trace: a body that moves is where it was when the next one begins.
#[test]
fn step_that_failed_leaves_bodies_where_they_were() {
    let mesh = layers(&mut Random::new(3));
    let motion = RigidMotion {
        velocity: Vec3::new(0.0, 0.0, -1.0),
        ..below()
    };
    let x = mesh.positions().to_vec();
    let energy = |begun: u32| {
        let mut contacts = contacts(&mesh, 0.0, motion);
        for _ in 0..begun {
            begin(&mut contacts, &x);
        }
        let mut unused = vec![Vec3::zeros(); x.len()];
        contacts.add_gradient(&x, &mut unused)
    };
    assert!(energy(1) > 0.0);
    assert_eq!(energy(1), energy(5));
}

/// Two triangles that lie above each other at z = 0 and `height` (m).
fn two_triangles(height: Real) -> TriMesh {
    let at = |z: Real| [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)].map(|(x, y)| Vec3::new(x, y, z));
    TriMesh::new([at(0.0), at(height)].concat(), vec![[0, 1, 2], [3, 4, 5]]).unwrap()
}

/// Prescribed vertices that would pass through each other are refused, and the step that goes on without that finds
/// everything as it was.
#[test]
fn pins_that_cross_are_refused() {
    let mesh = two_triangles(0.5);
    let from = mesh.positions();
    let motion = RigidMotion {
        velocity: Vec3::new(1.0, 0.0, 0.0),
        ..below()
    };
    let mut contacts = contacts(&mesh, 0.0, motion);
    let step = ContactStep {
        from,
        inverse_mass: &[0.0; 6],
        dt: 0.01,
    };
    let mut crossed = two_triangles(-0.5).positions().to_vec();
    let refused = contacts.begin(&step, &mut crossed);
    assert!(
        matches!(refused, Err(ContactError::Infeasible { .. })),
        "{refused:?}"
    );
    let mut still = from.to_vec();
    contacts.begin(&step, &mut still).unwrap();
    assert_eq!(still, from);
}

/// A start that passes through itself is refused with what is wrong with it, and so is one of another cloth; one inside
/// a body is moved out of it.
#[test]
fn start_that_is_not_free_is_refused_or_led_out() {
    let flat = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)].map(|(x, y)| Vec3::new(x, y, 0.0));
    let standing = flat.map(|x| Vec3::new(0.2 + x.x * 0.1, 0.2, x.y - 0.5));
    let crossed = [flat, standing].concat();
    let mesh = TriMesh::new(crossed.clone(), vec![[0, 1, 2], [3, 4, 5]]).unwrap();
    let begin = |contacts: &mut PotentialContacts, x: &[Vec3]| {
        let step = ContactStep {
            from: x,
            inverse_mass: &vec![1.0; x.len()],
            dt: 0.01,
        };
        contacts.begin(&step, &mut x.to_vec())
    };
    let mut contacts = PotentialContacts::builder(&mesh).build().unwrap();
    let found = begin(&mut contacts, &crossed);
    let (pairs, triangle, body) = (1, [0, 1, 2], None);
    let expected = ContactError::IntersectingStart {
        pairs,
        triangle,
        body,
    };
    assert_eq!(found, Err(expected));

    let mesh = TriMesh::new(flat.to_vec(), vec![[0, 1, 2]]).unwrap();
    let plane = Obstacle::new(HalfSpace::new(Vec3::z()).unwrap());
    let builder = PotentialContacts::builder(&mesh).obstacle(plane, 0.0);
    let mut contacts = builder.build().unwrap();
    let inside = flat.map(|x| x - Vec3::z() * 1e-3);
    let step = ContactStep {
        from: &inside,
        inverse_mass: &[1.0; 3],
        dt: 0.01,
    };
    let mut start = inside.to_vec();
    contacts.begin(&step, &mut start).unwrap();
    assert!(start.iter().all(|x| x.z > 0.0), "{start:?}");
    let short = begin(&mut contacts, &flat[..2]);
    let (expected, found) = (3, 2);
    assert_eq!(short, Err(ContactError::VertexCount { expected, found }));
}

/// Sizes of space, speed and time from 1e-300 to 1e300: every path is cut or refused, and what is left of it is finite
/// and free.
#[test]
fn extreme_sizes_are_cut_or_refused() {
    let mut random = Random::new(17);
    let (mut cut, mut refused) = (0, 0);
    for round in 0..48 {
        let mut power = |most: Real| (10.0 as Real).powf(random.point(most).x);
        let most: Real = [3.0, 20.0, 150.0, 300.0][round % 4];
        let (size, dt) = (power(most.min(70.0)), power(most));
        let distance = size * power(3.0);
        let thickness = size * power(2.0);
        let x: Vec<Vec3> = layers(&mut Random::new(round as u64)).positions().to_vec();
        let scaled = x.iter().map(|x| x * size).collect();
        let triangles = layers(&mut Random::new(0)).triangles().to_vec();
        let Ok(mesh) = TriMesh::new(scaled, triangles) else {
            continue;
        };
        let Ok(mut contacts) = PotentialContacts::builder(&mesh)
            .thickness(thickness)
            .build()
        else {
            continue;
        };
        let from = mesh.positions();
        let step = ContactStep {
            from,
            inverse_mass: &vec![power(most.min(100.0)); from.len()],
            dt,
        };
        let to: Vec<Vec3> = from.iter().map(|x| x + random.point(distance)).collect();
        let mut start = to.clone();
        let begun = contacts.begin(&step, &mut start);
        let Ok(share) = begun.and_then(|()| contacts.limit(&start, &to)) else {
            refused += 1;
            continue;
        };
        assert!((0.0..=1.0).contains(&share), "round {round}: {share}");
        let end: Vec<Vec3> = start
            .iter()
            .zip(&to)
            .map(|(a, b)| a + (b - a) * share)
            .collect();
        assert!(end.iter().all(is_finite), "round {round}");
        let mut probe = SeparationProbe::new(&mesh);
        for x in [&start, &end] {
            let seen = probe.measure(x).unwrap();
            assert_eq!(seen.intersecting_pairs, 0, "round {round}");
        }
        cut += u32::from(share < 1.0);
    }
    assert!(cut > 10, "{cut} cut, {refused} refused");
}

/// Two sheets fly side by side, a centimetre apart, far towards a floor: the lower one is stopped, so the upper one
/// must not go on through it, though nothing brings them nearer on their own paths.
#[test]
fn what_flies_along_is_cut_too() {
    let one = grid(9, 9, 0.4, 0.4, Diagonals::Alternating).unwrap();
    let count = one.vertex_count() as u32;
    let at = |z: Real| {
        one.positions()
            .iter()
            .map(move |x| x + Vec3::new(0.011, 0.007, 1.0) * z)
    };
    let positions: Vec<Vec3> = at(0.003).chain(at(0.013)).chain(at(0.023)).collect();
    let shifted = |k: u32| {
        one.triangles()
            .iter()
            .map(move |t| t.map(|v| v + k * count))
    };
    let triangles = shifted(0).chain(shifted(1)).chain(shifted(2)).collect();
    let mesh = TriMesh::new(positions, triangles).unwrap();
    let plane = Obstacle::new(HalfSpace::new(Vec3::z()).unwrap());
    let builder = PotentialContacts::builder(&mesh)
        .thickness(2e-3)
        .obstacle(plane, 0.0);
    let mut contacts = builder.build().unwrap();
    let mut x = mesh.positions().to_vec();
    begin(&mut contacts, &x);
    let mut probe = SeparationProbe::new(&mesh);
    let mut fractions = vec![0.0; x.len()];
    for _ in 0..5 {
        let mut to: Vec<Vec3> = x.iter().map(|x| x - Vec3::z() * 0.019).collect();
        contacts.limit_each(&x, &mut to, &mut fractions).unwrap();
        let seen = probe.measure(&to).unwrap();
        assert_eq!(seen.intersecting_pairs, 0);
        assert!(seen.min_distance.unwrap() > 0.0);
        let layers = [0, 1, 2].map(|k| {
            let own = &to[k * count as usize..(k + 1) * count as usize];
            own.iter().map(|x| x.z).fold(Real::INFINITY, Real::min)
        });
        assert!(
            0.0 < layers[0] && layers[0] < layers[1] && layers[1] < layers[2],
            "{layers:?}"
        );
        x = to;
    }
}

/// Two flat sheets of triangles of one size, turned against each other at random: the pressure between them over that
/// of a body at the same distance, for a thickness of h over the cell size.
fn pressure_over_that_of_a_body(thickness: Real) -> Real {
    let (cell, cells, kappa) = (1.0 / 30.0, 12, 1e4);
    let (h, gap) = (thickness * cell, 0.8 * thickness * cell);
    let small = Real::from(cells) * cell;
    let mut random = Random::new(5);
    let mut sum = 0.0;
    let tries = 40;
    for _ in 0..tries {
        let lower = grid(31, 31, 1.0, 1.0, Diagonals::Alternating).unwrap();
        let upper = grid(13, 13, small, small, Diagonals::Alternating).unwrap();
        let (sin, cos) = random.real(3.0).sin_cos();
        let centre =
            Vec3::new(0.5, 0.5, gap) + Vec3::new(random.real(0.05), random.real(0.05), 0.0);
        let place = |x: &Vec3| {
            let (a, b) = (x.x - 0.5 * small, x.y - 0.5 * small);
            centre + Vec3::new(cos * a - sin * b, sin * a + cos * b, 0.0)
        };
        let count = lower.vertex_count();
        let mut positions = lower.positions().to_vec();
        positions.extend(upper.positions().iter().map(place));
        let mut triangles = lower.triangles().to_vec();
        let above = |t: &[u32; 3]| t.map(|v| v + count as u32);
        triangles.extend(upper.triangles().iter().map(above));
        let mesh = TriMesh::new(positions, triangles).unwrap();
        let builder = PotentialContacts::builder(&mesh)
            .thickness(h)
            .stiffness(kappa);
        let mut contacts = builder.build().unwrap();
        begin(&mut contacts, mesh.positions());
        let mut gradient = vec![Vec3::zeros(); mesh.vertex_count()];
        contacts.add_gradient(mesh.positions(), &mut gradient);
        let force = -gradient[count..].iter().map(|g| g.z).sum::<Real>();
        sum += force / (kappa * (h - gap) * small * small);
    }
    sum / Real::from(tries)
}

/// Vertices of both sides press with half of their areas, edges not at all at this distance. What is near without being
/// above adds to that as the thickness comes near the size of the cells.
#[test]
fn cloth_presses_cloth_as_it_presses_a_body() {
    for (thickness, expected, tolerance) in [
        (1e-3, 1.0, 0.01),
        (0.1, 1.27, 0.01),
        (0.3, 1.89, 0.01),
        (1.0, 4.58, 0.01),
    ] {
        let found = pressure_over_that_of_a_body(thickness);
        assert!(
            (found / expected - 1.0).abs() < tolerance,
            "{thickness}: {found}, not {expected}"
        );
    }
}

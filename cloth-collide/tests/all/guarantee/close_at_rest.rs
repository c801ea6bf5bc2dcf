//! Pieces that are nearer to each other at rest than any tolerance: slivers, seams, pockets, layers that nearly
//! coincide.

use super::flight::Flight;
use super::random::Random;
use cloth_collide::SeparationProbe;
use cloth_collide::potential::PotentialContacts;
use cloth_core::contact::{ContactError, ContactStep, Projection};
use cloth_core::math::{Real, Vec3};
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{Diagonals, grid};
use nalgebra::Rotation3;

const THICKNESS: Real = 1e-3;

/// A corner 5 µm above a triangle of its own piece goes 3 µm below it, and everything else is held.
#[test]
fn corner_that_rests_on_its_own_cloth_does_not_go_through_it() {
    let from = [
        (0.0, 0.0, 0.0),
        (1.0, 0.0, 0.0),
        (0.0, 1.0, 0.0),
        (2.0, 2.0, 1.0),
        (0.2, 0.2, 5e-6),
        (0.3, 0.2, 0.5),
    ]
    .map(|(x, y, z)| Vec3::new(x, y, z));
    let mesh = TriMesh::new(from.to_vec(), vec![[0, 1, 2], [1, 3, 2], [3, 4, 5]]).unwrap();
    let builder = PotentialContacts::builder(&mesh).thickness(THICKNESS);
    let mut contacts = builder.build().unwrap();
    let mut inverse_mass = [0.0; 6];
    inverse_mass[4] = 1.0;
    let step = ContactStep {
        from: &from,
        inverse_mass: &inverse_mass,
        dt: 0.01,
    };
    let mut positions = from;
    positions[4].z -= 8e-6;
    let mut velocities = [Vec3::zeros(); 6];
    velocities[4].z = -8e-4;
    Projection::default()
        .step(&mut contacts, &step, 10, &mut positions, &mut velocities)
        .unwrap();
    let found = SeparationProbe::new(&mesh).measure(&positions).unwrap();
    assert_eq!(found.intersecting_pairs, 0, "at {:e} m", positions[4].z);
    // It gives in by the law of contact, and the velocity is that of its displacement.
    let displacement = positions[4].z - 5e-6;
    assert!((-1e-6..0.0).contains(&displacement), "{displacement:e}");
    assert!(
        (velocities[4].z - displacement / 0.01).abs() < 1e-12,
        "{}",
        velocities[4]
    );
}

/// A strip folded into layers about `gap` (m) apart, its vertices displaced at random, somehow in space, `offset` (m)
/// from the origin.
fn folded(random: &mut Random, gap: Real, offset: Real) -> TriMesh {
    let (columns, layers) = (3, 3);
    let strip = grid(columns * layers, 3, 1.0, 1.0, Diagonals::Alternating).unwrap();
    let cell = 0.3;
    let turn = Rotation3::new(random.point(3.0));
    let shift = random.point(offset);
    let mut vertex = 0;
    let places = strip.positions().iter().map(|_| {
        let (column, row) = (vertex % (columns * layers), vertex / (columns * layers));
        vertex += 1;
        let (layer, place) = (column / columns, column % columns);
        let place = if layer % 2 == 0 {
            place
        } else {
            columns - 1 - place
        };
        let at = [place, row].map(|k| k as Real * cell + random.real(0.3 * cell));
        let height = (layer as Real + random.real(0.3)) * gap;
        turn * Vec3::new(at[0], at[1], height) + shift
    });
    TriMesh::new(places.collect(), strip.triangles().to_vec()).unwrap()
}

/// Folded strips from a billionth of the thickness between their layers up, as far as 1000 km out. About a third of
/// the vertices are held, and all others, every fourth time the held ones too, are kicked at random, from a tenth of
/// that distance up to 1 m.
#[test]
fn nothing_crosses_that_is_closer_at_rest_than_any_tolerance() {
    let (mut resolved, mut refused, mut tangled) = ([0; 3], 0, 0);
    for seed in 0..240 {
        let mut random = Random::new(seed);
        let exponent = |random: &mut Random, from: Real, to: Real| {
            Real::powf(10.0, 0.5 * (from + to) + random.real(0.5 * (to - from)))
        };
        let gap = THICKNESS * exponent(&mut random, -9.0, 0.0);
        let offset = if seed % 3 == 0 {
            0.0
        } else {
            exponent(&mut random, 0.0, 6.0)
        };
        let mesh = folded(&mut random, gap, offset);
        let builder = PotentialContacts::builder(&mesh).thickness(THICKNESS);
        let mut flight = Flight::new(&mesh, builder.friction(0.3).build().unwrap());
        if flight.crossings() > 0 {
            // Layers nearer to each other than the spacing of coordinates so far out.
            tangled += 1;
            continue;
        }
        for w in &mut flight.inverse_mass {
            if random.real(1.0) > 0.4 {
                *w = 0.0;
            }
        }
        for step in 0..6 {
            let kick = exponent(&mut random, gap.log10() - 1.0, 0.0);
            for (v, w) in flight.velocities.iter_mut().zip(&flight.inverse_mass) {
                let still = *w == 0.0 && seed % 4 != 0;
                *v = if still {
                    Vec3::zeros()
                } else {
                    random.point(kick)
                };
            }
            match flight.step(1.0) {
                Ok(()) => resolved[(gap / THICKNESS).log10().abs() as usize / 3] += 1,
                Err(ContactError::Infeasible { .. }) if seed % 4 == 0 => refused += 1,
                Err(error) => panic!("seed {seed}, step {step}: {error}"),
            }
            assert_eq!(
                flight.crossings(),
                0,
                "seed {seed}, step {step}: layers {gap:e} m apart, kicks of {kick:e} m, {offset:e} m out, {:?}",
                flight.contacts.constraint_report()
            );
        }
    }
    // Held vertices that move leave no feasible path now and then.
    assert!(resolved.iter().all(|&steps| steps > 350), "{resolved:?}");
    assert!(refused < 150 && tangled < 10, "{refused}, {tangled}");
}

//! Piles of sheets.

use super::flight::{Flight, moved, together};
use cloth_collide::ClothContacts;
use cloth_collide::obstacle::{HalfSpace, ImpactLaw, Obstacle, ObstacleContacts};
use cloth_core::math::Vec3;
use cloth_core::mesh::generate::{Diagonals, grid};

#[test]
fn ten_sheets_on_a_floor_stay_at_rest_and_press_with_their_weight() {
    let h = 1e-3;
    let sheet = grid(9, 9, 0.5, 0.5, Diagonals::Alternating).unwrap();
    let layer = |k: usize| {
        let k = k as f64;
        moved(&sheet, |x| {
            x + Vec3::new(0.003 * k, 0.002 * k, h * (k + 1.0))
        })
    };
    let mesh = together(&(0..10).map(layer).collect::<Vec<_>>());
    let floor = Obstacle::new(HalfSpace::new(Vec3::z()).unwrap());
    let floor = ObstacleContacts::new(h, h)
        .unwrap()
        .with(floor, ImpactLaw::new(0.5, 0.0).unwrap());
    let contacts = ClothContacts::builder(&mesh)
        .thickness(h)
        .friction(0.3)
        .obstacles(floor)
        .build()
        .unwrap();
    let mut flight = Flight::new(&mesh, contacts);
    flight.gravity = Vec3::new(0.0, 0.0, -9.81);
    let weight = flight.positions.len() as f64 * 9.81;
    let dt = 1.0 / 60.0;
    for step in 0..120 {
        flight.step(dt).unwrap();
        let report = flight.contacts.report();
        let force = report.obstacle_impulse / dt;
        assert!(
            (force.z - weight).abs() < 1e-4 * weight,
            "step {step}: {force}"
        );
        assert!(force.xy().norm() < 1e-4 * weight, "step {step}: {force}");
        // Forces known from the steps before: no longer a search through ten layers.
        assert!(
            step < 10 || report.rounds == 1 && report.sweeps < 100,
            "step {step}: {report:?}"
        );
        let ways = flight.positions.iter().zip(mesh.positions());
        let way = ways.map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
        assert!(way < 0.02 * h, "step {step}: {way:e} m");
        assert_eq!(flight.crossings(), 0);
    }
}

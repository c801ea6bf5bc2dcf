//! The air's load against the formulas of a plate, and the fall that it ends.

use cloth_core::air::{Air, AirConfig, implicit};
use cloth_core::math::{Mat3, Real, Vec3};
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{Diagonals, disk, grid, irregular};
use cloth_core::particles::State;

const RHO: Real = 1.2;
const DRAG: Real = 1.3;
const LIFT: Real = 0.7;
/// kg/m².
const AREAL: Real = 0.2;

fn config(wind: Vec3) -> AirConfig {
    AirConfig {
        density: RHO,
        drag: DRAG,
        lift: LIFT,
        wind,
    }
}

fn total(mesh: &TriMesh, wind: Vec3, velocity: Vec3, dt: Real) -> Vec3 {
    let mut state = State::at_rest(mesh.positions().to_vec());
    state.velocities.fill(velocity);
    let mut air = Air::new(config(wind), AREAL, mesh).unwrap();
    air.load(&state, dt).iter().sum()
}

/// The same mesh with every triangle turned over.
fn turned_over(mesh: &TriMesh) -> TriMesh {
    let triangles = mesh.triangles().iter().map(|&[a, b, c]| [a, c, b]);
    TriMesh::new(mesh.positions().to_vec(), triangles.collect()).unwrap()
}

#[test]
fn a_plate_at_an_angle_feels_drag_along_the_flow_and_lift_across_it() {
    let plate = irregular(9, 2.0, 1.5, 4).unwrap(); // 3 m² in the plane z = 0
    for degrees in [0.0, 10.0, 45.0, 80.0, 90.0, 135.0, 180.0] {
        let angle = (degrees as Real).to_radians();
        // The wind comes at `angle` to the normal z, and the plate moves too: only the difference counts.
        let along = Vec3::new(angle.sin(), 0.0, angle.cos());
        let velocity = Vec3::new(0.3, -2.0, 0.7);
        let speed: Real = 6.0;
        let pressure = 0.5 * RHO * speed * speed * plate.area() * angle.cos().abs();
        // The normal on the lee side without its part along the flow: as long as sin θ.
        let normal = Vec3::z() * angle.cos().signum();
        let across = normal - along * normal.dot(&along);
        let expected = (along * DRAG + across * LIFT) * pressure;
        for mesh in [&plate, &turned_over(&plate)] {
            let force = total(mesh, velocity + along * speed, velocity, 1e-6);
            let error = (force - expected).norm();
            assert!(error < 1e-12 * (1.0 + pressure), "{degrees}°: {error}");
        }
        // And its two parts, as one would measure them in a wind tunnel.
        let force = total(&plate, velocity + along * speed, velocity, 1e-6);
        let lift = (force - along * force.dot(&along)).norm();
        assert!((force.dot(&along) - pressure * DRAG).abs() < 1e-12 * (1.0 + pressure));
        assert!((lift - pressure * LIFT * angle.sin().abs()).abs() < 1e-12 * (1.0 + pressure));
    }
}

#[test]
fn a_flat_sheet_falls_as_the_square_law_says() {
    let mesh = grid(5, 5, 1.0, 1.0, Diagonals::Alternating).unwrap();
    let mass = AREAL * mesh.area();
    let gravity = 9.81;
    let terminal = (2.0 * AREAL * gravity / (RHO * DRAG)).sqrt();
    let mut air = Air::new(config(Vec3::zeros()), AREAL, &mesh).unwrap();
    let mut speed_after = |seconds: Real, steps: u32| {
        let dt = seconds / Real::from(steps);
        let mut state = State::at_rest(mesh.positions().to_vec());
        for _ in 0..steps {
            let force: Vec3 = air.load(&state, dt).iter().sum();
            let change = (force / mass - Vec3::z() * gravity) * dt;
            state.velocities.iter_mut().for_each(|v| *v += change);
        }
        state.velocities[0]
    };
    // v(t) = v∞ tanh(g t/v∞), to first order in the step: the force is that at its start.
    let exact = terminal * (gravity * 0.15 / terminal).tanh();
    let [coarse, fine] =
        [200, 400].map(|steps| (speed_after(0.15, steps) + Vec3::z() * exact).norm());
    assert!((coarse / fine - 2.0).abs() < 0.01, "{coarse} {fine}");
    assert!(fine < 1e-3 * terminal, "{fine}");
    let last = speed_after(10.0, 600) + Vec3::z() * terminal;
    assert!(last.norm() < 1e-13 * terminal, "{last}");
}

#[test]
fn each_corner_takes_a_third_of_its_triangles() {
    let mesh = disk(5, 0.5).unwrap();
    let mut air = Air::new(config(Vec3::z() * 4.0), AREAL, &mesh).unwrap();
    let load = air.load(&State::at_rest(mesh.positions().to_vec()), 1e-6);
    let mut shares = vec![0.0; mesh.vertex_count()];
    for (corners, area) in mesh.triangles().iter().zip(mesh.areas()) {
        for &corner in corners {
            shares[corner as usize] += area / 3.0;
        }
    }
    for (force, share) in load.iter().zip(shares) {
        let expected = Vec3::z() * (0.5 * RHO * DRAG * 16.0 * share);
        assert!((force - expected).norm() < 1e-13, "{force}");
    }
}

#[test]
fn still_air_wind_along_the_surface_and_no_area_give_no_force() {
    let mesh = grid(4, 4, 1.0, 1.0, Diagonals::OneWay).unwrap();
    assert_eq!(
        total(&mesh, Vec3::zeros(), Vec3::zeros(), 0.01),
        Vec3::zeros()
    );
    let along = Vec3::new(3.0, -1.0, 0.0);
    assert_eq!(total(&mesh, along, Vec3::zeros(), 0.01), Vec3::zeros());
    assert_eq!(total(&mesh, along, along, 0.01), Vec3::zeros());
    // All vertices in one point.
    let mut air = Air::new(config(Vec3::z()), AREAL, &mesh).unwrap();
    let state = State::at_rest(vec![Vec3::zeros(); 16]);
    assert!(
        air.load(&state, 0.01)
            .iter()
            .all(|force| *force == Vec3::zeros())
    );
}

#[test]
fn no_wind_takes_a_triangle_beyond_the_speed_of_the_air() {
    let mesh = grid(2, 2, 1.0, 1.0, Diagonals::OneWay).unwrap();
    let mass = AREAL * mesh.area();
    for degrees in [0.0, 30.0, 60.0, 89.0] {
        let angle = (degrees as Real).to_radians();
        for speed in [0.1, 10.0, 1e4] {
            for dt in [1e-3, 1.0 / 60.0, 1.0] {
                let wind = Vec3::new(angle.sin(), 0.0, angle.cos()) * speed;
                let force = total(&mesh, wind, Vec3::zeros(), dt);
                let after = (wind - force * (dt / mass)).norm();
                assert!(
                    after <= speed * (1.0 + 1e-12),
                    "{degrees}° {speed} {dt}: {after}"
                );
                // Not beyond the smallest speed that this direction of the force can lead to either.
                let change = force.dot(&(wind - force * (dt / mass)));
                assert!(change >= -1e-9 * force.norm() * speed, "{change}");
            }
        }
    }
}

/// Twice the wind is four times the force, from the next step on.
#[test]
fn air_that_is_changed_acts_as_if_built_so() {
    let mesh = grid(3, 3, 2.0, 1.0, Diagonals::OneWay).unwrap();
    let state = State::at_rest(mesh.positions().to_vec());
    let mut air = Air::new(config(Vec3::z() * 2.0), 0.2, &mesh).unwrap();
    let force = |air: &mut Air| air.load(&state, 1e-6).iter().sum::<Vec3>().z;
    let before = force(&mut air);
    let stronger = config(Vec3::z() * 4.0);
    air.set_config(stronger).unwrap();
    assert_eq!(*air.config(), stronger);
    assert!((force(&mut air) / before - 4.0).abs() < 1e-12);
    let bad = AirConfig {
        density: -1.0,
        ..stronger
    };
    assert_eq!(
        air.set_config(bad).unwrap_err().name,
        "the density of the air"
    );
    assert_eq!(*air.config(), stronger);
}

#[test]
fn what_makes_no_sense_is_refused_by_name() {
    let mesh = grid(2, 2, 1.0, 1.0, Diagonals::OneWay).unwrap();
    let base = config(Vec3::zeros());
    let told =
        |config: AirConfig, areal: Real| Air::new(config, areal, &mesh).unwrap_err().to_string();
    let density = AirConfig {
        density: -1.0,
        ..base
    };
    assert_eq!(
        told(density, AREAL),
        "the density of the air is -1, but it has to be zero or a positive finite number"
    );
    let drag = AirConfig {
        drag: Real::INFINITY,
        ..base
    };
    assert!(told(drag, AREAL).starts_with("the drag is inf"));
    let lift = AirConfig {
        lift: Real::NAN,
        ..base
    };
    assert!(told(lift, AREAL).starts_with("the lift is NaN"));
    let lift = AirConfig { drag: 0.0, ..base };
    assert_eq!(
        told(lift, AREAL),
        "the lift is 0.7, but it has to be zero without drag"
    );
    let wind = config(Vec3::new(0.0, Real::NAN, 0.0));
    assert_eq!(
        told(wind, AREAL),
        "the wind is NaN, but it has to be a finite number"
    );
    assert_eq!(
        told(base, 0.0),
        "the areal density is 0, but it has to be a positive finite number"
    );
}

/// D and the forces, summed over the vertices, with every velocity that.
fn linearized(lift: Real, mesh: &TriMesh, wind: Vec3, velocity: Vec3) -> (Mat3, Vec3) {
    let config = AirConfig {
        lift,
        ..config(wind)
    };
    let mut air = Air::new(config, AREAL, mesh).unwrap();
    air.linearize(mesh.positions(), &vec![velocity; mesh.vertex_count()]);
    (air.drag().iter().sum(), air.forces().iter().sum())
}

#[test]
fn drag_is_the_derivative_of_the_force_where_the_air_comes_straight() {
    let mesh = irregular(7, 1.0, 1.0, 3).unwrap();
    let (wind, step) = (Vec3::z() * 7.0, 1e-5);
    let (drag, _) = linearized(0.0, &mesh, wind, Vec3::zeros());
    for direction in [Vec3::x(), Vec3::y(), Vec3::z()] {
        let [back, on] = [-step, step].map(|step| linearized(0.0, &mesh, wind, direction * step).1);
        let expected = (back - on) / (2.0 * step);
        assert!((drag * direction - expected).norm() < 1e-8, "{expected}");
    }
}

/// Across and along the surface, what is left of the flow after a step of any length has the sign that it had.
#[test]
fn a_free_sheet_never_outruns_the_air() {
    let mesh = grid(3, 3, 1.0, 1.0, Diagonals::OneWay).unwrap();
    let mass = AREAL * mesh.area();
    for degrees in [0.0, 10.0, 45.0, 80.0, 89.9] {
        let angle = (degrees as Real).to_radians();
        let wind = Vec3::new(angle.sin(), 0.0, angle.cos()) * 30.0;
        for lift in [0.0, LIFT, DRAG] {
            let (drag, force) = linearized(lift, &mesh, wind, Vec3::zeros());
            for h in [1e-4, 1e-2, 1.0, 100.0] {
                let speed = implicit(&drag, h / mass) * force * (h / mass);
                for axis in [0, 2] {
                    let part = speed[axis] / wind[axis].max(1e-9);
                    assert!(
                        (-1e-12..=1.0 + 1e-12).contains(&part),
                        "{degrees}° {lift} {h}: {part}"
                    );
                }
            }
        }
    }
}

/// Sweeps of a vertex that nothing else moves come to the velocity of the implicit step, `(M + h D)⁻¹ h F`.
#[test]
fn a_projection_is_the_implicit_step() {
    let mesh = grid(3, 3, 1.0, 1.0, Diagonals::OneWay).unwrap();
    let mut air = Air::new(config(Vec3::new(3.0, -1.0, 9.0)), AREAL, &mesh).unwrap();
    let (h, mass) = (0.05, AREAL * mesh.area() / 9.0);
    let start = vec![Vec3::new(0.3, 0.2, -1.0); 9];
    air.linearize(mesh.positions(), &start);
    let mut w = vec![1.0 / mass; 9];
    w[4] = 0.0;
    air.begin_projection(&w, h);
    let free = |v: usize, force: Vec3| mesh.positions()[v] + (start[v] + force * (h * w[v])) * h;
    let mut x: Vec<Vec3> = (0..9).map(|v| free(v, air.forces()[v])).collect();
    let (forces, drag) = (air.forces().to_vec(), air.drag().to_vec());
    for _ in 0..3 {
        air.project(&mut x);
    }
    for v in 0..9 {
        let change = implicit(&drag[v], h * w[v]) * forces[v] * (h * w[v]);
        let expected = mesh.positions()[v] + (start[v] + change) * h;
        assert!((x[v] - expected).norm() < 1e-14, "{v}");
    }
    let speeds: Vec<Vec3> = (0..9).map(|v| (x[v] - mesh.positions()[v]) / h).collect();
    air.end(&x, &speeds, &w);
    for v in (0..9).filter(|v| *v != 4) {
        // The force of the whole step is what has changed the momentum.
        let gained = (speeds[v] - start[v]) * mass / h;
        assert!((air.forces()[v] - gained).norm() < 1e-11, "{v}");
    }
}

//! From a description in SI units to masses, elements and measures.

use cloth_core::cloth::{Cloth, ClothError, Discretization, Membrane, Piece};
use cloth_core::element::Energy;
use cloth_core::energy::Spring;
use cloth_core::math::{Real, Vec3, gather};
use cloth_core::measure::{self, IncrementalPotential, Strain};
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{Diagonals, disk, equilateral, grid, irregular};
use cloth_core::particles::{ParticleError, Particles, State};
use cloth_core::pin::Pins;
use cloth_core::step::StepInput;
use cloth_core::topology::EdgeTable;

const COTTON: Cloth = Cloth {
    areal_density: 0.2,
    membrane: Membrane::SpringStiffness(1e3),
    bending_rigidity: 1e-5,
};

/// Deterministic numbers in (−1, 1).
fn noise(index: usize) -> Vec3 {
    Vec3::from_fn(|axis, _| 2.0 * ((3 * index + axis) as Real * 0.618_033_988 + 0.1).fract() - 1.0)
}

#[test]
fn the_masses_add_up_to_density_times_area() {
    for mesh in [disk(7, 0.5).unwrap(), irregular(15, 1.0, 2.0, 3).unwrap()] {
        let model = COTTON.on(&mesh).unwrap();
        let total: Real = model.particles.mass().iter().sum();
        assert!((total / (0.2 * mesh.area()) - 1.0).abs() < 1e-13);
    }
}

#[test]
fn a_vertex_gets_a_third_of_each_triangle_at_it() {
    // Two triangles of half a square metre: corners 0 and 3 belong to both.
    let mesh = grid(2, 2, 1.0, 1.0, Diagonals::OneWay).unwrap();
    let model = COTTON.on(&mesh).unwrap();
    let mut masses = model.particles.mass().to_vec();
    masses.sort_by(Real::total_cmp);
    let third = 0.2 * 0.5 / 3.0;
    for (mass, shares) in masses.into_iter().zip([1.0, 1.0, 2.0, 2.0]) {
        assert!((mass - shares * third).abs() < 1e-16);
    }
}

#[test]
fn a_modulus_gives_the_springs_of_the_lattice_that_has_it() {
    let cloth = Cloth {
        membrane: Membrane::Modulus(500.0),
        ..COTTON
    };
    for (mesh, k) in [
        (
            equilateral(20, 20, 0.01).unwrap(),
            500.0 * 3.0_f64.sqrt() / 2.0,
        ),
        (
            grid(9, 9, 1.0, 1.0, Diagonals::Alternating).unwrap(),
            500.0 * 0.75,
        ),
    ] {
        let model = cloth.on(&mesh).unwrap();
        let edges = EdgeTable::build(&mesh).unwrap();
        for (edge, spring) in model.springs.iter().enumerate() {
            let share = if edges.is_boundary(edge) { 0.5 } else { 1.0 };
            assert!((spring.stiffness / (share * k) - 1.0).abs() < 1e-12);
        }
        // Exactly: pulled by s in all directions the sheet stores Y s²/(1 − ν) per area.
        let pulled: Vec<Vec3> = mesh.positions().iter().map(|p| p * 1.001).collect();
        let stored = model.energies().unwrap().value(&pulled) / mesh.area();
        assert!(
            (stored / (500.0 * 1e-6 * 1.5) - 1.0).abs() < 1e-9,
            "{stored}"
        );
    }
}

/// Of cells as high as `height` and 1 wide, with springs k on all edges, in the two coordinates of their plane.
#[test]
fn a_modulus_along_an_edge_is_that_of_the_plane() {
    let turned = nalgebra::Rotation3::new(Vec3::new(0.3, -0.8, 0.5));
    let extremes = |mesh: &TriMesh| {
        let piece = Piece {
            cloth: Cloth {
                membrane: Membrane::Modulus(500.0),
                ..COTTON
            },
            discretization: Discretization::default(),
            triangles: (0..mesh.triangles().len() as u32).collect(),
        };
        piece.directional_moduli(mesh).unwrap().unwrap()
    };
    for height in [1.0_f64, 1.3, 4.0] {
        let flat = grid(9, 9, 8.0, 8.0 * height, Diagonals::Alternating).unwrap();
        // A cell has one edge of each kind.
        let lengths = [1.0, height * height, 1.0 + height * height];
        let k = 3.0 * height / lengths.iter().sum::<Real>();
        let [x, y, z] = lengths.map(|square| k * square / height);
        let [c, s] = [1.0 / lengths[2], height * height / lengths[2]];
        let [xx, xy, yy] = [x + z * c * c, z * c * s, y + z * s * s];
        let compliance = |c: Real, s: Real| {
            let normal = (yy * c * c - 2.0 * xy * c * s + xx * s * s) / (xx * yy - xy * xy);
            normal + c * s / xy
        };
        let mut moduli = [[1.0, 0.0], [0.0, 1.0], [c, s]].map(|[c, s]| 1.0 / compliance(c, s));
        let along = moduli[1];
        moduli.sort_by(Real::total_cmp);
        let placed = |place: &dyn Fn(&Vec3) -> Vec3| {
            let x = flat.positions().iter().map(place).collect();
            extremes(&TriMesh::new(x, flat.triangles().to_vec()).unwrap())
        };
        let close = |found: Real, expected: Real| {
            assert!(
                (found / expected - 1.0).abs() < 0.02,
                "{height}: {found}, {expected}"
            );
        };
        let [soft, stiff] = placed(&|p| turned * p);
        close(soft.ratio, moduli[0]);
        close(stiff.ratio, moduli[2]);
        // Of half a tube along its axis, which is as stiff as the flat sheet that way.
        let radius = 8.0 / std::f64::consts::PI;
        let [_, tube] = placed(&|p| {
            let (sin, cos) = (p.x / radius).sin_cos();
            Vec3::new(radius * sin, p.y, radius * cos)
        });
        if height > 1.0 {
            assert!(tube.direction.y.abs() > 0.99, "{tube:?}");
            close(tube.ratio, along);
        }
    }
    for mesh in [equilateral(20, 20, 0.01).unwrap(), disk(7, 0.5).unwrap()] {
        for extreme in extremes(&mesh) {
            assert!((extreme.ratio - 1.0).abs() < 0.02, "{extreme:?}");
        }
    }
}

#[test]
fn numbers_out_of_range_are_refused_by_name() {
    let mesh = grid(3, 3, 1.0, 1.0, Diagonals::OneWay).unwrap();
    let refused = |cloth: Cloth, words: &str| {
        let error = cloth.on(&mesh).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    };
    for bad in [-1.0, Real::NAN, Real::INFINITY] {
        refused(
            Cloth {
                areal_density: bad,
                ..COTTON
            },
            "density",
        );
        refused(
            Cloth {
                membrane: Membrane::SpringStiffness(bad),
                ..COTTON
            },
            "spring stiffness",
        );
        refused(
            Cloth {
                membrane: Membrane::Modulus(bad),
                ..COTTON
            },
            "membrane modulus",
        );
        refused(
            Cloth {
                bending_rigidity: bad,
                ..COTTON
            },
            "bending rigidity",
        );
    }
    let weightless = Cloth {
        areal_density: 0.0,
        ..COTTON
    };
    assert_eq!(
        weightless.on(&mesh).unwrap_err(),
        ClothError::Particles(ParticleError::InvalidDensity { density: 0.0 })
    );
}

#[test]
fn masses_and_pins_are_checked() {
    let bad = |mass: Real| Particles::new(vec![1.0, mass]).unwrap_err();
    for mass in [0.0, -1.0, Real::NAN, Real::INFINITY, 1e-320] {
        assert!(matches!(
            bad(mass),
            ParticleError::InvalidMass { vertex: 1, .. }
        ));
    }
    let mut particles = Particles::new(vec![2.0; 3]).unwrap();
    assert_eq!(
        particles.prescribe(3),
        Err(ParticleError::NoSuchVertex {
            vertex: 3,
            vertex_count: 3
        })
    );
    particles.prescribe(1).unwrap();
    particles.set_mass(1, 4.0).unwrap();
    assert_eq!(
        (particles.inverse_mass()[1], particles.free_count()),
        (0.0, 2)
    );
    particles.release(1).unwrap();
    assert_eq!(particles.inverse_mass()[1], 0.25);
}

#[test]
fn a_pin_is_steered_to_where_its_path_will_be() {
    let mut particles = Particles::new(vec![1.0; 2]).unwrap();
    let mut pins = Pins::new();
    pins.add_path(&mut particles, 1, |t| Vec3::new(t * t, 0.0, 3.0))
        .unwrap();
    assert!(pins.add_path(&mut particles, 2, |_| Vec3::zeros()).is_err());
    let mut state = State::at_rest(vec![Vec3::zeros(), Vec3::new(0.25, 0.0, 3.0)]);
    state.time = 0.5;
    pins.set_velocities(&mut state, 0.5).unwrap();
    assert_eq!(state.velocities, [Vec3::zeros(), Vec3::new(1.5, 0.0, 0.0)]);
}

#[test]
fn pins_that_cannot_reach_their_paths_are_named() {
    let mut particles = Particles::new(vec![1.0; 2]).unwrap();
    let mut pins = Pins::new();
    let path = |t: Real| Vec3::x() * if t < 1.0 { t } else { Real::NAN };
    pins.add_path(&mut particles, 1, path).unwrap();
    let start = State::at_rest(vec![Vec3::zeros(); 2]);
    for dt in [0.0, -0.5, Real::NAN, Real::INFINITY] {
        let mut state = start.clone();
        let refused = pins.set_velocities(&mut state, dt).unwrap_err();
        assert!(matches!(refused, ParticleError::InvalidTimeStep { .. }));
        assert_eq!(state, start);
    }
    let mut short = State::at_rest(vec![Vec3::zeros()]);
    let (vertex, vertex_count) = (1, 1);
    let expected = ParticleError::NoSuchVertex {
        vertex,
        vertex_count,
    };
    assert_eq!(pins.set_velocities(&mut short, 0.5), Err(expected));
    let mut state = start.clone();
    let refused = pins.set_velocities(&mut state, 2.0).unwrap_err();
    assert_eq!(
        refused,
        ParticleError::InvalidPath {
            vertex: 1,
            time: 2.0
        }
    );
    assert_eq!(state, start);
    // Nor do those change that could reach theirs.
    pins.add_path(&mut particles, 0, |t| Vec3::x() * t).unwrap();
    pins.add_path(&mut particles, 1, path).unwrap();
    pins.set_velocities(&mut state, 2.0).unwrap_err();
    assert_eq!(state, start);
}

#[test]
fn energies_and_momenta_of_a_turning_body_are_the_textbooks() {
    // A ring of 12 masses of 0.5 kg at radius 2 m, turning about z at 3 /s and moving along x at 1 m/s.
    let particles = Particles::new(vec![0.5; 12]).unwrap();
    let angle = |i: i32| Real::from(i) * std::f64::consts::TAU / 12.0;
    let positions: Vec<Vec3> = (0..12)
        .map(|i| Vec3::new(2.0 * angle(i).cos(), 2.0 * angle(i).sin(), 1.0))
        .collect();
    let mut state = State::at_rest(positions);
    for (x, v) in state.positions.iter().zip(&mut state.velocities) {
        *v = Vec3::new(1.0 - 3.0 * x.y, 3.0 * x.x, 0.0);
    }
    let kinetic = measure::kinetic_energy(&particles, &state.velocities);
    assert!((kinetic - 0.5 * 6.0 * (1.0 + 36.0)).abs() < 1e-12);
    let momentum = measure::linear_momentum(&particles, &state.velocities);
    assert!((momentum - Vec3::new(6.0, 0.0, 0.0)).norm() < 1e-13);
    // Spin 6·4·3 about z, and the motion along x at height 1 gives 6 about y.
    let spin = measure::angular_momentum(&particles, &state);
    assert!((spin - Vec3::new(0.0, 6.0, 72.0)).norm() < 1e-12, "{spin}");
    let weight =
        measure::gravitational_energy(&particles, &state.positions, Vec3::new(0.0, 0.0, -10.0));
    assert!((weight - 60.0).abs() < 1e-12);
    let centre = measure::center_of_mass(&particles, &state.positions);
    assert!((centre - Vec3::z()).norm() < 1e-15);
}

#[test]
fn strain_is_that_of_the_stretched_axis() {
    let rest = [Vec3::zeros(), Vec3::x(), Vec3::y()];
    let springs = Spring::along(&rest, &[[0, 1], [0, 2]], 1.0);
    let strain = Strain::of(&springs, &[Vec3::zeros(), Vec3::x() * 1.3, Vec3::y() * 0.9]);
    assert!((strain.max - 0.3).abs() < 1e-15 && (strain.min + 0.1).abs() < 1e-15);
    assert!((strain.rms - (0.05_f64).sqrt()).abs() < 1e-15);
    assert_eq!(Strain::of(&[], &rest), Strain::default());
}

#[test]
fn the_gradient_of_the_incremental_potential_is_its_derivative() {
    let mesh = irregular(6, 1.0, 1.0, 1).unwrap();
    let mut model = COTTON.on(&mesh).unwrap();
    model.particles.prescribe(3).unwrap();
    let energies = model.energies().unwrap();
    let mut state = State::at_rest(mesh.positions().to_vec());
    for (i, v) in state.velocities.iter_mut().enumerate() {
        *v = noise(i);
    }
    let load: Vec<Vec3> = (0..mesh.vertex_count())
        .map(|i| noise(i + 900) * 0.1)
        .collect();
    let input = StepInput::new(0.02)
        .gravity(Vec3::new(0.0, 0.0, -9.81))
        .load(&load);
    let mut predicted = state.positions.clone();
    measure::predict(&model.particles, &state, &input, &mut predicted);
    // A prescribed vertex feels neither gravity nor load.
    assert_eq!(
        predicted[3],
        state.positions[3] + state.velocities[3] * 0.02
    );
    let potential = IncrementalPotential {
        particles: &model.particles,
        energies: &energies,
        predicted: &predicted,
        dt: 0.02,
    };
    let x: Vec<Vec3> = state
        .positions
        .iter()
        .enumerate()
        .map(|(i, p)| p + noise(i + 500) * 0.02)
        .collect();
    let mut gradient = vec![Vec3::zeros(); x.len()];
    potential.gradient_into(&x, &mut gradient);
    assert_eq!(gradient[3], Vec3::zeros());
    let largest = gradient.iter().map(Vec3::amax).fold(0.0, Real::max);
    for vertex in (0..x.len()).filter(|&v| v != 3) {
        for axis in 0..3 {
            let at = |shift: Real| {
                let mut moved = x.clone();
                moved[vertex][axis] += shift;
                potential.value(&moved)
            };
            let slope = (at(1e-6) - at(-1e-6)) / 2e-6;
            assert!(
                (slope - gradient[vertex][axis]).abs() < 1e-7 * largest,
                "vertex {vertex}, axis {axis}"
            );
        }
    }
}

#[test]
fn a_sum_of_families_is_the_sum_of_their_elements() {
    let mesh = irregular(8, 1.0, 1.0, 2).unwrap();
    let model = COTTON.on(&mesh).unwrap();
    let x: Vec<Vec3> = mesh
        .positions()
        .iter()
        .enumerate()
        .map(|(i, p)| p + noise(i) * 0.05)
        .collect();
    let springs: Real = model
        .springs
        .iter()
        .map(|s| s.value(&gather(&x, s.vertices)))
        .sum();
    let hinges: Real = model
        .hinges
        .iter()
        .map(|h| h.value(&gather(&x, h.vertices)))
        .sum();
    let total = model.energies().unwrap().value(&x);
    assert!(springs > 0.0 && hinges > 0.0);
    assert!((total / (springs + hinges) - 1.0).abs() < 1e-14);
}

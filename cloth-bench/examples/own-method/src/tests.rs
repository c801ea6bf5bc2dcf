//! What the comparison then says of the method.

use crate::VBD;
use crate::vbd::{VbdConfig, VertexBlockDescent};
use cloth_bench::method::{METHODS, Method};
use cloth_bench::report::palette::{gap, looks};
use cloth_bench::run::{SeparationWatch, from_start};
use cloth_bench::scene;
use cloth_bench::settings::Settings;
use cloth_bench::studies::contact::laws::slide;
use cloth_bench::studies::contact::step::ContactProblem;
use cloth_bench::yardstick::StepProblem;
use cloth_core::contact::ContactSource;
use cloth_core::energy::Attachment;
use cloth_core::math::Vec3;
use cloth_core::method::family::Energies;
use cloth_core::particles::{Particles, State};
use cloth_core::step::{StepInput, Stepper};

/// Errors of one step of the hanging sheet of `n` vertices a side after so many iterations with a radius ρ: 0 is the
/// minimum, 1 the free flight.
fn errors<const N: usize>(n: u32, radius: f64, iterations: [u32; N]) -> [f64; N] {
    let scene = scene::build("hang", None, &Settings::default().with("n", n)).unwrap();
    let problem = StepProblem::after(&scene, 5, scene.dt).unwrap();
    let settings = Settings::default().with("chebyshev_radius", radius);
    iterations.map(|count| {
        let settings = settings.clone().with("iterations", count);
        let mut solver = VBD.build(&scene, &settings, scene.dt).unwrap();
        problem.solve(&mut *solver).unwrap().0.objective
    })
}

#[test]
fn it_goes_down_to_the_minimum_of_implicit_euler() {
    for (radius, last) in [(0.0, 30_000), (0.99, 3000)] {
        let errors = errors(9, radius, [1, 10, 100, last / 10, last]);
        assert!(errors[0] < 1.0, "{errors:?}");
        assert!(
            errors.windows(2).all(|pair| pair[1] < pair[0]),
            "{errors:?}"
        );
        assert!(errors[4].abs() < 1e-9, "{errors:?}");
    }
}

#[test]
fn acceleration_saves_iterations_and_diverges_with_no_radius() {
    let [plain] = errors(17, 0.0, [100]);
    for (radius, fraction) in [(0.9, 0.9), (0.99, 0.7), (0.9999, 0.7)] {
        let [error] = errors(17, radius, [100]);
        assert!(error < fraction * plain, "{radius}: {error} of {plain}");
    }
}

#[test]
fn it_is_found_by_name_among_all_others() {
    // Another test may have registered it before.
    let _ = cloth_bench::method::register(&[VBD]);
    assert_eq!(Method::find("vbd").unwrap().name, "vbd");
    let all: Vec<&str> = cloth_bench::method::all()
        .map(|method| method.name)
        .collect();
    assert_eq!(all.last(), Some(&"vbd"));
    assert!(all.contains(&"xpbd"));
    assert!(cloth_bench::method::register(&[VBD]).is_err());
}

#[test]
fn it_has_one_look_that_no_other_method_has() {
    let _ = cloth_bench::method::register(&[VBD]);
    let (colour, marker) = VBD.look();
    let seen = looks(&["xpbd", "vbd, plain", "something"])[1];
    assert_eq!((seen.colour, seen.marker), (colour, marker));
    for other in &METHODS {
        assert!(gap(other.look().0, colour) > 70.0, "{}", other.name);
    }
}

/// With zeros in the place of negative eigenvalues it comes to a halt at 1.45.
#[test]
fn acceleration_in_contact_comes_nearer_than_plain_sweeps() {
    let problem = ContactProblem::new("drape-sphere", 25, 17).unwrap();
    let [plain, accelerated] = [0.0, 0.99].map(|radius| {
        let settings = Settings::of("iterations=400").with("chebyshev_radius", radius);
        problem.reached(&VBD, &settings).unwrap().position.0
    });
    assert!(accelerated < 0.5 * plain, "{accelerated}, {plain}");
}

/// One plain sweep a step, undamped.
const CONFIG: VbdConfig = VbdConfig {
    iterations: 1,
    substeps: 1,
    chebyshev_radius: 0.0,
    air_drag: 0.0,
    stiffness_damping: 0.0,
};

#[test]
fn a_damped_oscillator_follows_the_closed_form_of_implicit_euler() {
    let (omega, drag, beta, dt) = (7.0, 0.9, 0.013, 0.1);
    let attachment = Attachment {
        vertex: 0,
        target: Vec3::zeros(),
        stiffness: omega * omega,
    };
    let energies = Energies::new(1).with(vec![attachment]).unwrap();
    let config = VbdConfig {
        air_drag: drag,
        stiffness_damping: beta,
        ..CONFIG
    };
    let particles = Particles::new(vec![1.0]).unwrap();
    let mut vbd = VertexBlockDescent::new(&particles, energies, config);
    let mut state = State::at_rest(vec![Vec3::new(0.3, 0.0, 0.0)]);
    state.velocities[0].x = 1.1;
    let [mut x, mut v] = [0.3, 1.1];
    for _ in 0..20 {
        vbd.step(&mut state, StepInput::new(dt)).unwrap();
        // v⁺ = v − Δt (ω² x⁺ + (α + β ω²) v⁺), x⁺ = x + Δt v⁺, solved.
        let rate = drag + beta * omega * omega + dt * omega * omega;
        v = (v - dt * omega * omega * x) / (1.0 + dt * rate);
        x += dt * v;
        assert!((state.positions[0].x - x).abs() < 1e-14);
        assert!((state.velocities[0].x - v).abs() < 1e-13);
    }
}

/// The first guess has the last acceleration itself where something touches: cloth would else slide too slowly.
#[test]
fn cloth_slides_down_a_slope_as_the_closed_form_says() {
    let _ = cloth_bench::method::register(&[VBD]);
    let slide = |degrees| slide("vbd", degrees, 0.3).unwrap()[0];
    let stuck = slide(10.0).measured.0;
    assert!(stuck < 1e-4, "{stuck} m");
    for degrees in [20.0, 40.0] {
        let found = slide(degrees);
        let (expected, measured) = (found.expected.0, found.measured.0);
        assert!((measured / expected - 1.0).abs() < 0.05, "{found:?}");
    }
}

#[test]
fn the_first_guess_has_as_much_of_gravity_as_the_last_step_had() {
    let (dt, gravity) = (0.1, Vec3::new(0.0, 0.0, -9.81));
    let adaptive = [(0.5, 0.5), (0.25, 0.25), (2.0, 1.0), (-3.0, 0.0)];
    let config = VbdConfig {
        iterations: 0,
        ..CONFIG
    };
    for (last, fraction) in adaptive {
        let particles = Particles::new(vec![1.0]).unwrap();
        let mut vbd = VertexBlockDescent::new(&particles, Energies::new(1), config);
        let mut state = State::at_rest(vec![Vec3::zeros()]);
        // Nothing is known of a step before, so it begins in free fall.
        vbd.step(&mut state, StepInput::new(dt).gravity(gravity))
            .unwrap();
        assert!((state.positions[0] - gravity * (dt * dt)).norm() < 1e-15);
        // It began at rest, and this is as if the sweeps had left so much of the acceleration.
        state.velocities[0] = gravity * (last * dt);
        vbd.step(&mut state, StepInput::new(dt).gravity(gravity))
            .unwrap();
        let expected = gravity * (dt * dt * (1.0 + last + fraction));
        assert!((state.positions[0] - expected).norm() < 1e-15, "{last}");
    }
}

#[test]
fn stiffness_damping_leaves_rigid_motion_alone() {
    let scene = scene::build("drop", None, &Settings::of("n=9 gravity=0")).unwrap();
    let settings = Settings::of("iterations=5 stiffness_damping=0.1");
    let mut vbd = VBD.build(&scene, &settings, scene.dt).unwrap();
    let mut state = scene.start.clone();
    let flight = Vec3::new(0.3, -0.2, 0.1);
    state.velocities.fill(flight);
    for _ in 0..10 {
        vbd.step(&mut state, StepInput::new(scene.dt)).unwrap();
    }
    assert!(state.velocities.iter().all(|v| (v - flight).norm() < 1e-11));
}

#[test]
fn parts_of_a_step_are_steps() {
    let scene = scene::build("drape-sphere", None, &Settings::of("n=9")).unwrap();
    let end = |substeps: u32, cut: u32| {
        let settings = Settings::of("iterations=3").with("substeps", substeps);
        let dt = scene.dt / f64::from(cut);
        let ran = from_start(&scene, &VBD, &settings, dt, 20 * cut, |_, _, _| Ok(()));
        ran.unwrap().1.positions
    };
    assert_eq!(end(4, 1), end(2, 2));
}

/// A hundred sweeps a step are far too few for a sheet of 33 × 33 vertices. From a first guess that may hold more than
/// the cloth has, plain ones leave three times what gravity has given as strain.
#[test]
fn cut_short_it_holds_no_more_energy_than_it_was_given() {
    let scene = scene::build("hang", None, &Settings::of("n=33")).unwrap();
    let ran = |settings: &str| {
        let settings = Settings::of(settings);
        from_start(&scene, &VBD, &settings, scene.dt, 30, |_, _, _| Ok(())).unwrap()
    };
    for settings in ["", "chebyshev_radius=0"] {
        assert_eq!(ran(settings).0.energy_excess, 0.0, "{settings}");
    }
    let (in_parts, _) = ran("substeps=auto");
    assert_eq!(in_parts.energy_excess, 0.0);
    assert!(in_parts.max_stretch < 0.05, "{}", in_parts.max_stretch);
    let fall = in_parts.center_of_mass_drop;
    assert!((fall - 0.49).abs() < 0.02, "{fall} m");
}

#[test]
fn its_limit_is_the_step_of_implicit_euler_with_contact_too() {
    let settings = Settings::default()
        .with("n", 9)
        .with("friction", 0)
        .with("stiffness", 200);
    let scene = scene::build("drape-sphere", None, &settings).unwrap();
    let dt = 0.5 * scene.dt;
    let implicit = Method::find("implicit-euler").unwrap();
    let tight = Settings::default().with("tolerance", 1e-10);
    let mut reference = implicit.build(&scene, &tight, dt).unwrap();
    let many = Settings::default().with("iterations", 500);
    let mut vbd = VBD.build(&scene, &many, dt).unwrap();
    let [mut contacts, mut of_vbd] = [(); 2].map(|()| scene.contacts().unwrap().unwrap());
    let mut state = scene.start.clone();
    let (mut apart, mut largest_force): (f64, f64) = (0.0, 0.0);
    for _ in 0..40 {
        let mut by_vbd = state.clone();
        let input = |source| StepInput::new(dt).gravity(scene.gravity).contacts(source);
        vbd.step(&mut by_vbd, input(&mut of_vbd)).unwrap();
        reference.step(&mut state, input(&mut contacts)).unwrap();
        let pairs = by_vbd.positions.iter().zip(&state.positions);
        apart = pairs.map(|(a, b)| (a - b).norm()).fold(apart, f64::max);
        largest_force = largest_force.max(contacts.potential_energy());
    }
    assert!(largest_force > 1e-6, "nothing has touched");
    assert!(apart < 1e-8, "{apart} m apart, {largest_force}");
}

#[test]
fn wrapped_round_a_ball_it_passes_through_nothing() {
    let settings = Settings::default().with("n", 17);
    let scene = scene::build("drape-sphere", None, &settings).unwrap();
    let mut vbd = VBD.build(&scene, &Settings::default(), scene.dt).unwrap();
    let mut contacts = scene.contacts().unwrap().unwrap();
    let mut state = scene.start.clone();
    let mut watch = SeparationWatch::new(&scene).unwrap();
    for _ in 0..60 {
        let input = StepInput::new(scene.dt).gravity(scene.gravity);
        vbd.step(&mut state, input.contacts(&mut contacts)).unwrap();
        watch.look(&scene, &state).unwrap();
    }
    let seen = watch.seen();
    assert_eq!(seen.most_intersections, 0);
    assert_eq!(seen.most_obstacle_intersections, 0);
    assert!(seen.min_clearance.unwrap() > 0.0, "{seen:?}");
}

/// Sheets come down on each other and on a floor. An iteration that took most of each gap would store fifty times what
/// gravity has given in the barrier.
#[test]
fn a_stack_comes_to_rest_without_energy_from_nowhere() {
    let settings = Settings::default().with("n", 7).with("sheets", 2);
    let scene = scene::build("stack", None, &settings).unwrap();
    let settings = Settings::default();
    let ran = from_start(&scene, &VBD, &settings, scene.dt, 30, |_, _, _| Ok(()));
    let (summary, _) = ran.unwrap();
    assert_eq!(summary.energy_excess, 0.0);
    assert_eq!(summary.intersections, Some(0));
    assert!(
        summary.kinetic_energy < 1e-9 * summary.energy_given,
        "{summary:?}"
    );
}

#[test]
fn a_free_fall_is_exact_and_costs_one_iteration() {
    // The start of the iteration is the end of the step where no element is strained.
    let settings = Settings::default().with("n", 9);
    let scene = scene::build("drop", None, &settings).unwrap();
    let one = Settings::default().with("iterations", 1);
    let mut vbd = VBD.build(&scene, &one, scene.dt).unwrap();
    let mut state = scene.start.clone();
    for _ in 0..10 {
        let input = StepInput::new(scene.dt).gravity(scene.gravity);
        vbd.step(&mut state, input).unwrap();
    }
    let fall = scene.gravity * (55.0 * scene.dt * scene.dt);
    for (x, start) in state.positions.iter().zip(&scene.start.positions) {
        assert!((x - start - fall).norm() < 1e-13);
    }
}

#[test]
fn settings_out_of_range_are_refused_by_name() {
    let scene = scene::build("hang", None, &Settings::default().with("n", 5)).unwrap();
    let error = |key, value| {
        let settings = Settings::default().with(key, value);
        let built = VBD.build(&scene, &settings, scene.dt);
        built.err().unwrap().to_string()
    };
    assert!(error("chebyshev_radius", 1.0).contains("chebyshev_radius"));
    assert!(error("stiffness_damping", -1.0).contains("stiffness_damping"));
    assert!(error("iterations", 0.0).contains("iterations"));
}

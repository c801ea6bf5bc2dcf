//! Rigid bodies that the cloth pushes and gravity pulls.

use crate::scene_text::{scene, written};
use cloth_bench::method::Method;
use cloth_bench::run::{Moment, Plan, Solver, Summary, run_changing, to_rest};
use cloth_bench::scene::{Scene, file};
use cloth_bench::settings::Settings;
use cloth_collide::obstacle::RigidMotion;
use cloth_core::math::Vec3;
use cloth_core::step::StepInput;

pub(crate) fn watch(
    scene: &Scene,
    method: &str,
    settings: &[&str],
    steps: u32,
    see: impl FnMut(&Moment<'_>),
) -> Summary {
    let settings = Settings::parse(settings).unwrap();
    let method = Method::find(method).unwrap();
    let mut solver = Solver::new(method, &settings, scene, scene.dt).unwrap();
    let mut state = scene.start.clone();
    let plan = Plan {
        forces: true,
        ..Plan::new(scene.dt, steps)
    };
    let mut see = see;
    let see = |moment: &Moment<'_>| {
        see(moment);
        Ok(())
    };
    let (summary, _) = run_changing(scene, &mut solver, &mut state, plan, see).unwrap();
    summary
}

/// The first obstacle, as it is after a step.
pub(crate) fn body(moment: &Moment<'_>) -> RigidMotion {
    let touch = moment.scene.touch.as_ref().unwrap();
    let motion = touch.obstacles().next().unwrap().motion();
    let pose = motion.pose_at(moment.state.time);
    RigidMotion { pose, ..*motion }
}

/// Momentum and angular momentum about the origin, of the cloth and of a ball.
fn momenta(moment: &Moment<'_>) -> [Vec3; 2] {
    let scene = moment.scene;
    let ball = body(moment);
    let (_, rigid) = scene.touch.as_ref().unwrap().free_bodies().next().unwrap();
    let mut linear = ball.velocity * rigid.mass();
    let mut angular = ball.pose.position.cross(&linear);
    angular += rigid.inertia() * ball.angular_velocity;
    let vertices = moment.state.positions.iter().zip(&moment.state.velocities);
    for ((x, v), m) in vertices.zip(scene.model.particles.mass()) {
        linear += v * *m;
        angular += x.cross(&(v * *m));
    }
    [linear, angular]
}

/// A ball flies into a free sheet, off its middle, and takes it along: the two keep their momentum but for gravity, and
/// without gravity their angular momentum.
#[test]
fn cloth_and_ball_keep_their_momentum_in_free_flight() {
    for gravity in [0.0, -9.81] {
        let text = format!(
            "dt = 0.01\ngravity = [0, 0, {gravity:?}]\n[[mesh]]\ngenerator = \"grid:13x13:alternating\"\nscale = 0.4\n\
             translate = [-0.17, -0.23, 0.08]\n[[obstacle]]\nshape = \"sphere\"\nradius = 0.06\ndensity = 40\n\
             velocity = [0, 0, 2]\n"
        );
        let scene = scene(&format!("flight{gravity}"), &text);
        let (_, ball) = scene.touch.as_ref().unwrap().free_bodies().next().unwrap();
        let start = Vec3::z() * (2.0 * ball.mass());
        let cloth: f64 = scene.model.particles.mass().iter().sum();
        let weight = scene.gravity * (cloth + ball.mass());
        for (method, settings, bounds) in [
            ("xpbd", &["substeps=30"][..], [1e-10, 1e-3]),
            ("symplectic-euler", &[], [1e-10, 1e-3]),
            ("implicit-euler", &["tolerance=1e-9"], [1e-6, 5e-3]),
            ("pd", &["velocity_tolerance=1e-3"], [1e-4, 5e-2]),
        ] {
            let (mut off, mut turned, mut slowest): (f64, f64, f64) = (0.0, 0.0, 2.0);
            watch(&scene, method, settings, 20, |moment| {
                let [linear, angular] = momenta(moment);
                let fallen = weight * moment.state.time;
                off = off.max((linear - start - fallen).norm());
                turned = turned.max(angular.norm());
                let own = body(moment).velocity - scene.gravity * moment.state.time;
                slowest = slowest.min(own.z);
            });
            println!(
                "{method} {gravity}: {off:.2e} of {:.2e}, {turned:.2e}, {slowest}",
                start.norm()
            );
            assert!(slowest < 1.9, "{method}: they meet");
            assert!(
                off < bounds[0] * start.norm(),
                "{method}: momentum off by {off}"
            );
            // The most that the ball could bring to the sheet is its momentum at the end of its radius.
            let most = 0.06 * start.norm();
            let is_kept = gravity != 0.0 || turned < bounds[1] * most;
            assert!(is_kept, "{method}: angular momentum {turned} of {most}");
        }
    }
}

const NET: &str = "[[mesh]]\ngenerator = \"grid:13x13:alternating\"\ntranslate = [-0.5, -0.5, 0]\n\
     [cloth]\ndensity = 1\nstiffness = 2e3\n[contact]\nfriction = 0\nthickness = 4e-3\n[air]\ndensity = 3000\n";

/// A ball that has come to rest in a net presses with its weight, and at the same sag a ball that is held presses with
/// that weight too: it is that of the equilibrium.
#[test]
fn ball_comes_to_rest_where_the_net_carries_its_weight() {
    let ball = |[x, y]: [f64; 2]| {
        format!(
            "[[obstacle]]\nshape = \"sphere\"\nradius = 0.1\nposition = [{x:?}, {y:?}, 0.104]\n"
        )
    };
    let free = format!(
        "{NET}[[pins]]\nselect = \"border\"\n{}density = 120\n",
        ball([0.0; 2])
    );
    let falling = scene("net", &free);
    let (_, rigid) = falling
        .touch
        .as_ref()
        .unwrap()
        .free_bodies()
        .next()
        .unwrap();
    let weight = 9.81 * rigid.mass();
    for (method, settings, bound) in [
        ("implicit-euler", &["tolerance=3e-8"][..], [2e-3, 4e-3]),
        // A thousandth of the sag of a net that is nearly taut is a hundredth of its force.
        ("pd", &["velocity_tolerance=3e-3"], [2e-3, 1.2e-2]),
    ] {
        let (mut sag, mut force, mut place) = (0.0, 0.0, [0.0; 2]);
        watch(&falling, method, settings, 420, |moment| {
            if moment.step > 300 {
                let at = body(moment).pose.position;
                sag += (0.104 - at.z) / 120.0;
                // It rolls slowly between two vertices, and sinks as it does: the sag is that of the mean place.
                place = [place[0] + at.x / 120.0, place[1] + at.y / 120.0];
                force -= moment.forces.unwrap().bodies[0].force.z / 120.0;
            }
        });
        // The border is lifted by as much around a ball that stays, until nothing moves.
        let still = NET.replace("[air]\ndensity = 3000\n", "");
        let lifted = format!(
            "{still}[[pins]]\nselect = \"border\"\nmove = [0, 0, {sag:?}]\n{}",
            ball(place)
        );
        let mut held = scene("held", &lifted);
        let exact = Settings::parse(&["tolerance=3e-8"]).unwrap();
        let implicit = Method::find("implicit-euler").unwrap();
        let mut stepper = implicit.build(&held, &exact, held.dt).unwrap();
        let mut state = held.start.clone();
        let rested = to_rest(&held, &mut *stepper, &mut state, held.dt, 3000, 1e-4).unwrap();
        assert!(rested.is_some_and(|steps| steps > 60), "{rested:?}");
        held.start = state;
        let mut at_rest = 0.0;
        watch(&held, "implicit-euler", &["tolerance=3e-8"], 1, |moment| {
            at_rest = -moment.forces.unwrap().bodies[0].force.z;
        });
        println!("{method}: {sag} {place:?} {force} {at_rest} of {weight}");
        let off = [force, at_rest].map(|force| (force / weight).abs() - 1.0);
        assert!(
            off[0].abs() < bound[0] && off[1].abs() < bound[1],
            "{method}: {off:?}"
        );
    }
}

/// A ball drops into a net that hangs from its corners and is thrown back: what a step ends with is what the net does
/// to the ball, wherever the iteration has looked last. Projective dynamics compares its end with the start of the
/// step, and the ball once got the few forces of the start, lost all its speed, and the net stayed stretched around it.
#[test]
fn net_throws_a_ball_back() {
    let mut text = String::from(
        "[[mesh]]\ngenerator = \"grid:25x25:alternating\"\ntranslate = [-0.5, -0.5, 0]\n[cloth]\ndensity = 0.1\n\
         stiffness = 2e3\n[contact]\nthickness = 4e-3\n[[obstacle]]\nshape = \"sphere\"\nradius = 0.1\ndensity = 120\n\
         position = [0.05, 0.02, 0.3]\n",
    );
    for [x, y] in [[-0.5, -0.5], [0.46, -0.5], [-0.5, 0.46], [0.46, 0.46]] {
        let [right, top] = [x, y].map(|least: f64| least + 0.04);
        text += &format!("[[pins]]\nbox = [[{x:?}, {y:?}, 0], [{right:?}, {top:?}, 0]]\n");
    }
    let scene = scene("thrown", &text);
    let back = |method: &str, settings: &[&str]| {
        let mut fastest: f64 = 0.0;
        watch(&scene, method, settings, 30, |moment| {
            fastest = fastest.max(body(moment).velocity.z);
        });
        fastest
    };
    let exact = back("implicit-euler", &["tolerance=1e-6"]);
    assert!(exact > 1.5, "{exact} m/s");
    for (method, settings) in [("implicit-euler", &[][..]), ("pd", &[])] {
        let off = back(method, settings) / exact - 1.0;
        println!("{method}: {off} of {exact} m/s");
        assert!(off.abs() < 0.02, "{method}: {off} of {exact} m/s");
    }
}

/// A stiffer one, which the ball meets off its middle: what a step leaves undone is the speed of the ball. Nothing has
/// energy that it was not given: with the momentum alone for the speed of the ball it had 0.2 J of 14 too much, since
/// each push comes after the step that it is of.
#[test]
fn trampoline_throws_a_ball_no_higher_than_it_fell() {
    let text = "[[mesh]]\ngenerator = \"disk:16\"\nscale = 2\n[cloth]\ndensity = 0.5\nstiffness = 15000\n\
                [[pins]]\nselect = \"border\"\n[[obstacle]]\nshape = \"sphere\"\nradius = 0.1\nmass = 2\n\
                position = [0.2, 0.1, 0.5]\n[contact]\nfriction = 0.4\n";
    let scene = scene("trampoline_ball", text);
    let rebound = |method: &str, settings: &[&str]| {
        let mut heights = Vec::new();
        let summary = watch(&scene, method, settings, 60, |moment| {
            heights.push(body(moment).pose.position.z);
        });
        assert_eq!(summary.energy_excess, 0.0, "{method} {settings:?}");
        let lowest = heights.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1));
        let turn = lowest.map_or(0, |(turn, _)| turn);
        heights[turn..].iter().copied().fold(f64::MIN, f64::max)
    };
    let exact = rebound("implicit-euler", &["tolerance=1e-6"]);
    for (method, most) in [("implicit-euler", 0.01), ("pd", 0.03)] {
        let height = rebound(method, &[]);
        println!("{method}: {height} of {exact} m");
        assert!(
            (height - exact).abs() < most,
            "{method}: {height} of {exact} m"
        );
    }
}

/// A box lies on a sheet on the floor: with the area A below it, it is a mass on two springs κ A in series, and a step
/// Δt is stable below 2 √(2 m/κ A). The parts of a step that runs take are four times shorter.
#[test]
fn box_trembles_only_beyond_the_limit_of_its_contact() {
    let (stiffness, thickness, edge) = (1e6, 2e-3, 0.19);
    let text = |height: f64, floor: f64, velocity: f64| {
        format!(
            "[[mesh]]\ngenerator = \"grid:17x17:alternating\"\nscale = 0.4\ntranslate = [-0.2, -0.2, {floor:?}]\n\
             [[obstacle]]\nshape = \"box\"\nsize = [{edge}, {edge}, {edge}]\ndensity = 100\nposition = [0, 0, {height:?}]\n\
             velocity = [0, 0, {velocity:?}]\n\
             [[obstacle]]\nshape = \"plane\"\n[contact]\nfriction = 0\n"
        )
    };
    let flat = scene("flat", &text(1.0, 0.1, 0.0));
    let mesh = flat.mesh.as_ref().unwrap();
    let is_below = |v: u32| mesh.positions()[v as usize].xy().amax() < 0.08;
    let corners = mesh.triangles().iter().zip(mesh.areas());
    let area: f64 = corners
        .map(|(t, area)| t.iter().filter(|&&v| is_below(v)).count() as f64 * area / 3.0)
        .sum();
    let (_, rigid) = flat.touch.as_ref().unwrap().free_bodies().next().unwrap();
    let limit = 2.0 * (2.0 * rigid.mass() / (stiffness * area)).sqrt();
    assert!(
        flat.parts(limit) >= 4,
        "{} parts of {limit} s",
        flat.parts(limit)
    );
    // 1e-6 m above where it rests.
    let pressed = 9.81 * rigid.mass() / (stiffness * area);
    let height = 0.5 * edge + 2.0 * (thickness - pressed) + 1e-6;
    let floor = thickness - 0.2 * 9.81 / stiffness;
    let swing = |dt: f64| {
        // The force of a step acts at its end, the weight from its start on.
        let resting = scene("resting", &text(height, floor, 9.81 * dt));
        let settings = Settings::parse(&["tolerance=1e-10"]).unwrap();
        let method = Method::find("implicit-euler").unwrap();
        let mut stepper = method.build(&resting, &settings, dt).unwrap();
        let mut contacts = resting.contacts().unwrap().unwrap();
        let mut state = resting.start.clone();
        let mut heights = Vec::new();
        for _ in 0..200 {
            let input = StepInput::new(dt).gravity(resting.gravity);
            // A box that trembles jumps, and may come down where there is no room for the sheet.
            let taken = stepper.step(&mut state, input.contacts(&mut contacts));
            if taken.is_err() {
                return f64::INFINITY;
            }
            let (_, motion) = contacts.contacts.free_motions().next().unwrap();
            heights.push(motion.pose.position.z);
        }
        // From its start on: a box that has jumped may come to rest later.
        let least = heights.iter().copied().fold(f64::INFINITY, f64::min);
        let swing = heights.iter().copied().fold(-f64::INFINITY, f64::max) - least;
        println!("{dt} s: {swing} m");
        swing
    };
    for part in [0.25, 0.95, 1.05] {
        let swing = swing(part * limit);
        // Nearer to the limit a swing is larger, but of the size of the start; one that grows is a thousand times that.
        let (is_stable, bound) = (part < 1.0, 2e-5);
        assert!(
            if is_stable {
                swing < bound
            } else {
                swing > 100.0 * bound
            },
            "{part} of {limit} s: {swing} m"
        );
    }
}

/// What says nothing, or makes no sense, is refused with its line.
#[test]
fn masses_without_meaning_are_refused() {
    let sheet = "[[mesh]]\ngenerator = \"grid:5x5:alternating\"\n";
    let ball = "[[obstacle]]\nshape = \"sphere\"\nradius = 0.1\nposition = [0, 0, 1]\ndensity = ";
    let refused = |name: &str, text: String| {
        let path = written(name, &text);
        let said = file::build(&path, &Settings::default()).unwrap_err();
        said.to_string()
    };
    for (name, text, line, words) in [
        ("zero", format!("{sheet}{ball}0\n"), 7, "density is `0`"),
        (
            "plane",
            format!("{sheet}[[obstacle]]\nshape = \"plane\"\ndensity = 1\n"),
            5,
            "a plane has no end",
        ),
        (
            "none",
            format!("{sheet}{ball}100\n[contact]\ncontact = \"none\"\n"),
            7,
            "density has no meaning",
        ),
    ] {
        let said = refused(name, text);
        let place = format!("{name}.toml: line {line}: ");
        assert!(said.contains(&place) && said.contains(words), "{said}");
    }
}

/// PBD pushes as hard as it has iterations: the net threw the ball back with 40 times the energy that it came with.
#[test]
fn pbd_pushes_no_body() {
    let path = written(
        "pushed",
        "[[mesh]]\ngenerator = \"grid:5x5:alternating\"\n[[obstacle]]\nshape = \"sphere\"\nradius = 0.1\n\
         position = [0, 0, 1]\ndensity = 100\n",
    );
    let scene = file::build(&path, &Settings::default()).unwrap();
    let pbd = Method::find("pbd").unwrap();
    let said = pbd
        .build(&scene, &Settings::default(), scene.dt)
        .err()
        .unwrap();
    let words = "`pbd` cannot push an obstacle that has a mass: ";
    assert!(said.to_string().contains(words), "{said}");
}

/// A box comes down a cell away from the border that holds the cloth. It moves before the cloth, which is then pressed
/// between it and the border: taken in one part, the step leaves implicit Euler 0.66 J from nowhere.
#[test]
fn box_beside_a_held_border_stays_on_the_cloth() {
    let text = "[[mesh]]\ngenerator = \"irregular:N\"\nscale = [0.9, 0.45, 1]\ntranslate = [-0.45, -0.22, 0.25]\n\
        [cloth]\ndensity = 0.35\nmembrane = \"arap\"\nstiffness = 3000\nrigidity = 5e-5\n\
        [[pins]]\nbox = [[-0.46, -1, 0], [-0.44, 1, 1]]\n[[pins]]\nbox = [[0.44, -1, 0], [0.46, 1, 1]]\n\
        [[obstacle]]\nshape = \"box\"\nsize = [0.14, 0.1, 0.08]\ndensity = 150\nrotate = [0.3, 0.4, 0.2]\n\
        position = [-0.36, 0.02, 0.4]\n[contact]\nself = true\nfriction = 0.4\n";
    // The second-order rule is ten times as dear on the finer sheet.
    for (name, side) in [
        ("implicit-euler", "25"),
        ("linear-implicit", "25"),
        ("bdf2", "17"),
        ("pd", "25"),
    ] {
        let scene = scene(&format!("beside-{name}"), &text.replace('N', side));
        let method = Method::find(name).unwrap();
        let settings = Settings::default();
        let mut solver = Solver::new(method, &settings, &scene, scene.dt).unwrap();
        let mut state = scene.start.clone();
        let mut fastest: f64 = 0.0;
        let plan = Plan::new(scene.dt, 18);
        let ran = run_changing(&scene, &mut solver, &mut state, plan, |moment| {
            fastest = fastest.max(body(moment).velocity.norm());
            Ok(())
        });
        let (summary, _) = ran.unwrap();
        assert_eq!(summary.energy_excess, 0.0, "{name}");
        assert_eq!(summary.intersections, Some(0), "{name}");
        assert_eq!(summary.obstacle_intersections, Some(0), "{name}");
        // It falls by 0.13 m.
        assert!((1.2..1.7).contains(&fastest), "{name}: {fastest} m/s");
    }
}

/// A ball slides onto a floor far from any cloth. Without friction it goes on and does not turn. With μ it slows down
/// by μ g until it rolls: a full sphere then has 5/7 of its speed, and keeps that.
#[test]
fn ball_on_a_floor_slides_without_friction_and_rolls_with_it() {
    for (friction, rolls) in [(0.0, 1.0), (0.3, 5.0 / 7.0)] {
        let text = format!(
            "[[mesh]]\ngenerator = \"grid:3x3:alternating\"\ntranslate = [5, 5, 1]\n[[pins]]\nselect = \"border\"\n\
             [contact]\nfriction = {friction:?}\nthickness = 2e-3\n[[obstacle]]\nshape = \"sphere\"\n\
             radius = 0.1\nposition = [0, 0, 0.1021]\nmass = 0.5\nvelocity = [1, 0, 0]\n[[obstacle]]\nshape = \"plane\"\n"
        );
        let scene = scene(&format!("rolls{friction}"), &text);
        for method in ["implicit-euler", "xpbd"] {
            let mut slowest = f64::INFINITY;
            let summary = watch(&scene, method, &[], 60, |moment| {
                let ball = body(moment);
                let (v, w) = (ball.velocity, ball.angular_velocity);
                slowest = slowest.min(v.x);
                let time = moment.state.time;
                let slides = (1.0 - friction * 9.81 * time).max(rolls);
                // The impulses of the floor come some steps apart.
                let bound = if time < 0.15 { 0.02 } else { 1e-3 };
                assert!(
                    (v.x - slides).abs() < bound,
                    "{method} {friction}: {} {slides}",
                    v.x
                );
                if friction == 0.0 {
                    assert!(w.norm() < 1e-9, "{method}: {w}");
                } else if time > 0.15 {
                    assert!((w.y - 10.0 * rolls).abs() < 1e-2, "{method}: {w}");
                }
            });
            assert!(slowest > rolls - 1e-3, "{method} {friction}: {slowest}");
            assert_eq!(summary.energy_excess, 0.0, "{method} {friction}");
        }
    }
}

/// Two balls meet off their line of centres and part along the normal there. Nothing turns, for there is no friction.
#[test]
fn balls_that_meet_without_friction_keep_their_momentum_and_do_not_turn() {
    let text = "gravity = [0, 0, 0]\n[[mesh]]\ngenerator = \"grid:3x3:alternating\"\ntranslate = [5, 5, 1]\n[[pins]]\n\
                select = \"border\"\n[[obstacle]]\nshape = \"sphere\"\nradius = 0.1\nmass = 0.5\nvelocity = [1, 0, 0]\n\
                [[obstacle]]\nshape = \"sphere\"\nradius = 0.1\nposition = [0.4, 0, 0.1]\nmass = 0.25\n[contact]\nfriction = 0\n";
    let scene = scene("balls", text);
    for method in ["implicit-euler", "xpbd"] {
        let mut ends = Vec::new();
        watch(&scene, method, &[], 60, |moment| {
            let touch = moment.scene.touch.as_ref().unwrap();
            ends = touch.obstacles().map(|body| *body.motion()).collect();
        });
        let momentum = ends[0].velocity * 0.5 + ends[1].velocity * 0.25;
        assert!(
            (momentum - Vec3::x() * 0.5).norm() < 1e-12,
            "{method}: {momentum}"
        );
        // Their centres are 2 R and the thickness apart then, less the path of a part of the step, which ends there:
        // sin α = 0.1/0.202 with the line of flight.
        let sine: f64 = 0.1 / 0.202;
        let normal = ends[1].velocity.normalize();
        assert!(
            (normal.z - sine).abs() < 0.03 && normal.x > 0.0,
            "{method}: {normal}"
        );
        for end in &ends {
            assert!(
                end.angular_velocity.norm() < 3e-3,
                "{method}: {}",
                end.angular_velocity
            );
        }
    }
}

/// A table under a cloth of 0.18 N, and a box of 5 kg on it or beside it.
fn box_on_a_table(place: &str) -> Scene {
    let text = format!(
        "[[mesh]]\ngenerator = \"grid:13x13:alternating\"\nscale = 0.3\ntranslate = [-0.15, -0.15, 0.0025]\n\
         [[pins]]\nbox = [[0.149, -1, -1], [0.151, 1, 1]]\nmove = [0.1, 0, 0]\n\
         [[obstacle]]\nshape = \"box\"\nsize = [0.1, 0.1, 0.1]\nposition = {place}\nmass = 5\n\
         [[obstacle]]\nshape = \"box\"\nsize = [2, 2, 0.1]\nposition = [0, 0, -0.05]\n"
    );
    scene(&format!("on-a-table-{}", text.len()), &text)
}

/// A box that presses harder than contact of the usual stiffness can carry lies on the cloth all the same, not on the
/// table below: cloth that is drawn away at 0.1 m/s takes it along, which friction could do thirty times as fast.
#[test]
fn heavy_box_lies_on_cloth_that_lies_on_a_table() {
    let scene = box_on_a_table("[0, 0, 0.0545]");
    for method in ["implicit-euler", "pd", "linear-implicit"] {
        let (mut box_, mut table, mut count) = (0.0, 0.0, 0.0);
        let mut last = Vec3::zeros();
        watch(&scene, method, &[], 45, |moment| {
            last = body(moment).pose.position;
            if moment.step > 15 {
                let bodies = &moment.forces.unwrap().bodies;
                (box_, table, count) = (
                    box_ + bodies[0].force.z,
                    table + bodies[1].force.z,
                    count + 1.0,
                );
            }
        });
        let (box_, table, moved) = (box_ / count, table / count, last.x);
        println!("{method}: {box_} and {table} N, {moved} m");
        assert!((box_ / 49.05 - 1.0).abs() < 0.02, "{method}: {box_} N");
        assert!((moved / 0.075 - 1.0).abs() < 0.05, "{method}: {moved} m");
        // Two thirds of the thickness on either side.
        let under = last.z - 0.05;
        assert!((0.0022..0.0032).contains(&under), "{method}: {under} m");
    }
}

/// What stops a body feels it: a table on which a box stands beside the cloth.
#[test]
fn table_feels_the_box_that_stands_on_it() {
    let scene = box_on_a_table("[0.5, 0, 0.053]");
    for method in ["implicit-euler", "xpbd"] {
        let mut forces = [Vec3::zeros(); 2];
        let mut torque = 0.0;
        watch(
            &scene,
            method,
            &["substeps=40"][..usize::from(method == "xpbd")],
            20,
            |moment| {
                let bodies = &moment.forces.unwrap().bodies;
                forces = [bodies[0].force, bodies[1].force];
                torque = bodies[1].torque.y;
            },
        );
        let [box_, table] = forces.map(|force| force.z);
        assert!((box_ / 49.05 - 1.0).abs() < 1e-6, "{method}: {box_} N");
        // The rest is the cloth: that of its free vertices at most.
        let cloth = -table - box_;
        assert!((0.0..0.2).contains(&cloth), "{method}: {table} N");
        // About the middle of the table.
        assert!(
            (torque / (0.5 * box_) - 1.0).abs() < 1e-2,
            "{method}: {torque} N m"
        );
    }
}

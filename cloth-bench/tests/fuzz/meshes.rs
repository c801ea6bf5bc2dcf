//! Random meshes through build and step of every method.

use crate::{Random, folder, fuzz};
use cloth_bench::method::METHODS;
use cloth_bench::run::run;
use cloth_bench::scene;
use cloth_bench::settings::Settings;
use cloth_core::math::Vec3;
use cloth_core::mesh::generate::{Diagonals, grid};
use cloth_core::mesh::obj;

/// Triangles without order: slivers, seams, doubles, and vertices that none of them has. Or a piece of a grid,
/// crumpled.
fn mesh(random: &mut Random) -> String {
    let grid = grid(3 + random.below(3), 3, 1.0, 1.0, Diagonals::Crossed).unwrap();
    let is_soup = random.one_in(4);
    let crumpled = random.pick(&[0.0, 1e-9, 0.1, 1.0]);
    let scale = random.pick(&[1.0, 1.0, 1.0, 1e-6, 1e6]);
    let is_wild = random.one_in(6);
    let mut places: Vec<Vec3> = Vec::new();
    for &at_rest in grid.positions() {
        let off = Vec3::from_fn(|_, _| match is_wild {
            true => random.number(),
            false => random.0.symmetric(),
        });
        let mut place = (at_rest + off * crumpled) * scale;
        if random.one_in(100) && !places.is_empty() {
            place = places[random.below(places.len())];
        }
        places.push(place);
    }
    let count = places.len();
    let triangles: Vec<[u32; 3]> = if is_soup {
        let corner = |random: &mut Random| random.below(count) as u32;
        let any = |random: &mut Random| [0; 3].map(|_| corner(random));
        (0..=random.below(8)).map(|_| any(random)).collect()
    } else {
        let all = grid.triangles().iter().copied();
        all.filter(|_| !random.one_in(8)).collect()
    };
    obj::format(&places, &triangles)
}

#[test]
fn random_meshes_are_refused_or_stay_finite() {
    let path = folder("meshes").join("mesh.obj");
    fuzz(1200, |random| {
        std::fs::write(&path, mesh(random)).unwrap();
        let pairs = [
            random.pick(&["membrane=springs", "membrane=stvk", "membrane=arap"]),
            random.pick(&[
                "bending=quadratic",
                "bending=dihedral",
                "bending=cubic",
                "bending=none",
            ]),
            random.pick(&["pins=none", "pins=0", "pins=highest"]),
            random.pick(&["stiffness=1e4", "stiffness=0", "stiffness=1e9"]),
            random.pick(&["density=0.2", "density=1e-9"]),
        ];
        let settings = Settings::parse(&pairs).unwrap();
        let Ok(scene) = scene::build("hang", path.to_str(), &settings) else {
            return;
        };
        let method = &METHODS[random.below(METHODS.len())];
        let dt = random.pick(&[1.0 / 60.0, 1e-6, 1.0]);
        let few = match method.name {
            "explicit-euler" | "symplectic-euler" => Settings::default().with("substeps", 20),
            _ => Settings::default(),
        };
        let Ok(mut stepper) = method.build(&scene, &few, dt) else {
            return;
        };
        let mut state = scene.start.clone();
        let before = state.clone();
        if run(&scene, &mut *stepper, &mut state, dt, 3, |_, _, _| Ok(())).is_err() {
            assert!(state.steps < 3 || state != before);
        }
        assert_eq!(state.first_non_finite(), None, "{}", method.name);
    });
}

//! The number of threads changes no bit.

use crate::common::{advance, methods, scene, solver};
use cloth_bench::run::run;
use cloth_collide::potential::PotentialContacts;
use cloth_core::Stepper;
use cloth_core::method::family::Energies;
use cloth_massspring::{Bdf2, ExplicitEuler, ImplicitEuler, ImplicitMidpoint, SymplecticEuler};
use cloth_pbd::{PbdBuilder, PbdSolver, StrainLimiter};
use cloth_pd::{PdBuilder, PdSolver};
use cloth_xpbd::direct::{DirectBuilder, DirectXpbd};
use cloth_xpbd::single::{SingleBuilder, SingleXpbd};
use cloth_xpbd::{XpbdBuilder, XpbdSolver};
use rayon::ThreadPoolBuilder;

#[test]
fn one_and_four_threads_give_the_same_bits() {
    // Large enough for the parallel paths: 150 × 150 vertices have some 7,800 springs in each of the large colours, and
    // 67,000 in one family.
    let large = scene("hang", &["n=150", "stiffness=100"]);
    // The direct solver of XPBD would take minutes there.
    let small = scene("hang", &["n=20", "stiffness=100"]);
    for method in methods() {
        let scene = if method.name == "xpbd-direct" {
            &small
        } else {
            &large
        };
        let run = |threads: usize| {
            let pool = ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            pool.install(|| {
                let mut solver = solver(method, scene);
                let mut state = scene.start.clone();
                advance(&mut *solver, scene, &mut state, 2);
                state
            })
        };
        assert!(run(1) == run(4), "{}", method.name);
    }
}

/// The same where cloth falls on a ball and could touch itself; from 8192 vertices on the search for pairs is split.
#[test]
fn contact_gives_the_same_bits_on_any_number_of_threads() {
    // The direct solver takes long, and the midpoint rule gains energy.
    let slow = ["xpbd-direct", "implicit-midpoint"];
    let others = methods().map(|method| method.name);
    let others: Vec<&str> = others.filter(|name| !slow.contains(name)).collect();
    for (n, steps, names) in [
        ("n=20", 12, &others[..]),
        ("n=9", 12, &slow),
        ("n=96", 4, &["pd"]),
    ] {
        let scene = scene("drape-sphere", &[n, "self=yes"]);
        for method in methods().filter(|m| names.contains(&m.name)) {
            let end = |threads: usize| {
                let pool = ThreadPoolBuilder::new().num_threads(threads).build();
                pool.unwrap().install(|| {
                    let mut solver = solver(method, &scene);
                    let mut state = scene.start.clone();
                    run(
                        &scene,
                        &mut *solver,
                        &mut state,
                        scene.dt,
                        steps,
                        |_, _, _| Ok(()),
                    )
                    .unwrap();
                    state
                })
            };
            assert!(end(1) == end(4), "{}, {n}", method.name);
        }
    }
}

#[test]
fn a_run_repeats_to_the_bit() {
    let scene = scene("hang", &["n=12"]);
    for method in methods() {
        let run = || {
            let mut state = scene.start.clone();
            advance(&mut *solver(method, &scene), &scene, &mut state, 5);
            state
        };
        assert!(run() == run(), "{}", method.name);
    }
}

/// What a program keeps beside others on several threads; that this compiles is the test.
#[test]
fn solvers_and_what_makes_them_go_from_thread_to_thread() {
    fn can<T: Send + Sync>() {}
    can::<Box<dyn Stepper>>();
    can::<(ImplicitEuler, ImplicitMidpoint, Bdf2)>();
    can::<(SymplecticEuler, ExplicitEuler)>();
    can::<(PbdSolver, PdSolver, XpbdSolver, SingleXpbd, DirectXpbd)>();
    can::<(
        PbdBuilder,
        PdBuilder,
        XpbdBuilder,
        SingleBuilder,
        DirectBuilder,
    )>();
    can::<(Energies, PotentialContacts, StrainLimiter)>();
}

//! Colours, blocks and stages of sweeps, and their threads.

use cloth_core::element::Element;
use cloth_core::energy::Spring;
use cloth_core::math::Vec3;
use cloth_core::math::gather;
use cloth_core::method::coloring::Colored;
use std::sync::atomic::{AtomicU32, AtomicUsize, Ordering};

fn star(arms: u32) -> Vec<Spring> {
    (1..=arms)
        .map(|tip| Spring {
            vertices: [0, tip],
            rest_length: 1.0,
            stiffness: 1.0,
        })
        .collect()
}

fn ring(vertex_count: u32) -> Vec<Spring> {
    (0..vertex_count)
        .map(|v| Spring {
            vertices: [v, (v + 1) % vertex_count],
            rest_length: 1.0,
            stiffness: 1.0,
        })
        .collect()
}

/// The stages as lists of parts, each a list of elements.
fn parts(colored: &Colored<2, Spring>) -> Vec<Vec<&[Spring]>> {
    let of = |bounds: &Vec<usize>| -> Vec<&[Spring]> {
        let bounds = bounds.windows(2);
        bounds.map(|b| &colored.elements()[b[0]..b[1]]).collect()
    };
    colored.stages().iter().map(of).collect()
}

/// Asserts that no element is lost, and no vertex is in two parts of a stage.
fn check(colored: &Colored<2, Spring>) {
    let mut seen = vec![0; colored.elements().len()];
    for &index in colored.input_index() {
        seen[index as usize] += 1;
    }
    assert!(seen.iter().all(|&n| n == 1));
    let mut count = 0;
    let vertices = colored.elements().iter().flat_map(|spring| spring.vertices);
    let vertex_count = vertices.max().map_or(0, |last| last as usize + 1);
    for parts in parts(colored) {
        let mut user = vec![None; vertex_count];
        for (part, elements) in parts.iter().enumerate() {
            assert!(!elements.is_empty());
            count += elements.len();
            for v in elements.iter().flat_map(|spring| spring.vertices) {
                let before = user[v as usize].replace(part);
                assert!(before.is_none_or(|before| before == part));
            }
        }
    }
    assert_eq!(count, colored.elements().len());
}

#[test]
fn a_star_needs_as_many_colors_as_arms_even_beyond_a_word() {
    let colored = Colored::new(&star(200), 201);
    assert_eq!(parts(&colored).len(), 200);
    check(&colored);
}

#[test]
fn no_two_elements_of_a_color_share_a_vertex_and_none_is_lost() {
    let colored = Colored::new(&ring(101), 101);
    assert_eq!(parts(&colored).len(), 3, "an odd ring needs three colours");
    check(&colored);
    for parts in parts(&colored) {
        let mut taken = [false; 101];
        for v in parts.concat().iter().flat_map(|spring| spring.vertices) {
            assert!(!std::mem::replace(&mut taken[v as usize], true));
        }
    }
    // A large colour is in several parts.
    let colored = Colored::new(&ring(20_000), 20_000);
    let sizes: Vec<usize> = parts(&colored).iter().map(Vec::len).collect();
    assert_eq!(sizes, [10, 10]);
    check(&colored);
}

#[test]
fn blocks_share_no_vertex_and_leave_little_over() {
    let colored = Colored::in_blocks(&ring(1000), 1000, Some(100));
    let sizes: Vec<usize> = parts(&colored).iter().map(Vec::len).collect();
    // Ten blocks; nine springs between two of them; the one from the end to the beginning.
    assert_eq!(sizes, [10, 9, 1]);
    check(&colored);
    assert!(parts(&Colored::in_blocks(&[], 0, Some(100))).is_empty());
    // Numbers without order: most springs join distant blocks.
    let shuffled: Vec<Spring> = ring(1000)
        .into_iter()
        .map(|spring| Spring {
            vertices: spring.vertices.map(|v| v * 389 % 1000),
            ..spring
        })
        .collect();
    check(&Colored::in_blocks(&shuffled, 1000, Some(100)));
}

/// Names the next two of its vertices every time it is asked.
#[derive(Clone, Copy, Debug)]
struct Fickle {
    first: u32,
    asked: &'static [AtomicU32],
}

impl Element<2> for Fickle {
    fn vertices(&self) -> [u32; 2] {
        let before = self.asked[self.first as usize].fetch_add(1, Ordering::Relaxed);
        // First the ring, where every second spring shares no vertex; afterwards all at the same two vertices.
        match before {
            0 => [self.first, (self.first + 1) % self.asked.len() as u32],
            _ => [0, 1],
        }
    }
}

#[test]
fn an_element_that_changes_its_answer_is_visited_at_its_first_one() {
    let count = 20_000;
    let fickle = || -> Vec<Fickle> {
        let asked = (0..count).map(|_| AtomicU32::new(0)).collect::<Vec<_>>();
        let asked: &[AtomicU32] = asked.leak();
        (0..count).map(|first| Fickle { first, asked }).collect()
    };
    for colored in [
        Colored::new(&fickle(), count as usize),
        Colored::in_blocks(&fickle(), count as usize, Some(1000)),
        Colored::in_input_order(&fickle(), count as usize),
    ] {
        // Every position is the number of its vertex, and every slot becomes what its element sees.
        let mut x: Vec<u32> = (0..count).collect();
        let mut seen = vec![[u32::MAX; 2]; count as usize];
        let look = |_: &Fickle, seen: &mut [u32; 2], x: &mut [u32; 2]| *seen = *x;
        colored.sweep(&mut seen, &mut x, look);
        let asked = colored.elements()[0].asked.iter();
        assert!(asked.map(|n| n.load(Ordering::Relaxed)).all(|n| n == 1));
        for (seen, &index) in seen.iter().zip(colored.input_index()) {
            assert_eq!(*seen, [index, (index + 1) % count]);
        }
    }
}

#[test]
fn input_order_is_kept_where_asked_for() {
    let springs = ring(7);
    let kept = Colored::in_input_order(&springs, 7);
    assert_eq!(kept.elements(), &springs[..]);
    // Each visit sees what the one before it wrote: a running sum round the ring.
    let mut x: Vec<Vec3> = (0..7).map(|_| Vec3::new(1.0, 0.0, 0.0)).collect();
    kept.sweep(&mut [(); 7], &mut x, |_, (), local| local[1] += local[0]);
    assert_eq!(
        x.iter().map(|p| p.x).collect::<Vec<_>>(),
        [8.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]
    );
    // And back: vertex 0 gets the 8 that it gave, then each the sum of the one before it as it is now.
    kept.sweep_back(&mut [(); 7], &mut x, |_, (), local| local[1] += local[0]);
    assert_eq!(
        x.iter().map(|p| p.x).collect::<Vec<_>>(),
        [15.0, 17.0, 5.0, 7.0, 9.0, 11.0, 13.0]
    );
}

#[test]
fn a_coloured_sweep_goes_back_as_it_came() {
    let colored = Colored::new(&ring(9), 9);
    let mut order = vec![0_usize; 9];
    let next = AtomicUsize::new(1);
    let visit = |_: &Spring, slot: &mut usize, _: &mut [Vec3; 2]| {
        *slot = next.fetch_add(1, Ordering::Relaxed);
    };
    let mut x = vec![Vec3::zeros(); 9];
    colored.sweep(&mut order, &mut x, visit);
    assert_eq!(order, [1, 2, 3, 4, 5, 6, 7, 8, 9]);
    colored.sweep_back(&mut order, &mut x, visit);
    assert_eq!(order, [18, 17, 16, 15, 14, 13, 12, 11, 10]);
}

#[test]
fn a_sweep_gives_the_same_bits_at_any_thread_count_there_and_back() {
    let count = 60_001;
    for block in [None, Some(5000)] {
        check_threads(&Colored::in_blocks(&ring(count), count as usize, block));
    }
}

fn check_threads(colored: &Colored<2, Spring>) {
    let count = colored.elements().len(); // a ring has as many vertices
    let visit = |s: &Spring, slot: &mut f64, x: &mut [Vec3; 2]| {
        let pull = (x[1] - x[0]) * 0.3 + Vec3::repeat(*slot);
        x[0] += pull;
        x[1] -= pull;
        *slot += x[0].x * 0.01 + f64::from(s.vertices[0]) * 1e-6;
    };
    let start: Vec<Vec3> = (0..count)
        .map(|i| Vec3::new((i as f64).sin(), (i as f64).cos(), 0.1 * (i % 17) as f64))
        .collect();
    let run = || {
        let mut x = start.clone();
        let mut slots = vec![0.0; count];
        for _ in 0..2 {
            colored.sweep(&mut slots, &mut x, visit);
            colored.sweep_back(&mut slots, &mut x, visit);
        }
        (x, slots)
    };
    let (mut x, mut slots) = (start.clone(), vec![0.0; count]);
    let mut one = |i: usize| {
        let s = colored.elements()[i];
        let mut local = gather(&x, s.vertices);
        visit(&s, &mut slots[i], &mut local);
        for (v, p) in s.vertices.into_iter().zip(local) {
            x[v as usize] = p;
        }
    };
    for _ in 0..2 {
        (0..count).for_each(&mut one);
        (0..count).rev().for_each(&mut one);
    }
    let by_hand = (x, slots);
    assert!(by_hand == run());
    #[cfg(feature = "parallel")]
    for threads in [1, 2, 4] {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        assert!(by_hand == pool.install(run), "{threads} threads");
    }
}

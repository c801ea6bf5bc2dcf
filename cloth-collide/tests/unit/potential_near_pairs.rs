use super::super::near::Own;
use super::*;
use crate::incidence::edge_numbers;
use crate::obstacle::PenaltyLaw;
use crate::pair::Pair;
use crate::random::Random;
use crate::shapes::{deformed, sheet};
use std::collections::HashSet;

/// Whatever paths a folded sheet takes, waved, turned, jerked and back again: every pair that is within its range
/// at the start, halfway or at the end of a path is among the ones that may push there, as a look at all pairs tells.
#[test]
fn no_near_pair_is_missed_on_any_path() {
    let mesh = sheet(9);
    let (edges, _) = edge_numbers(mesh.triangles());
    let law = PenaltyLaw::new(1e6, 0.02).unwrap();
    let own = Own {
        self_collision: true,
        ..Own::default()
    };
    let near = Near::new(&mesh, law, Vec::new(), own);
    let is_near = |kind: QueryKind, vertices: [u32; 4], x: &[Vec3]| {
        let range = near.range_of(Pair { kind, vertices });
        Gap::new(kind, &gather(x, vertices)).distance < range
    };
    let mut random = Random::new(5);
    let mut touching = 0;
    for (_, start) in deformed(&mesh).into_iter().take(5) {
        let patches = Some(Patches::new(&mesh, &near));
        let mut pairs = NearPairs {
            patches,
            ..NearPairs::default()
        };
        pairs.begin(&start, &near.is_resting, false);
        let mut from = start.clone();
        let mut last = vec![Vec3::zeros(); start.len()];
        for round in 0..80 {
            let size = [1e-4, 1e-3, 0.01, 0.05][round % 4];
            let turn = random.point([0.0, 0.3][round / 4 % 2]);
            let (shift, jerk) = (random.point(0.3), round % 7 < 3);
            let noise = |random: &mut Random| random.point(if jerk { size } else { 0.1 * size });
            let wave = random.point(10.0);
            let to: Vec<Vec3> = from
                .iter()
                .zip(start.iter().zip(&last))
                .map(|(x, (rest, last))| {
                    if round % 2 == 1 {
                        return x + last * 1.5 + noise(&mut random);
                    }
                    let bent = Vec3::z() * (size * (wave.x * rest.x + wave.y * rest.y).sin());
                    x + shift + turn.cross(x) * 0.3 + bent + noise(&mut random)
                })
                .collect();
            pairs.prepare(&near, [&from, &to], &[]);
            for part in [0.0, 0.5, 1.0] {
                let x: Vec<Vec3> = from
                    .iter()
                    .zip(&to)
                    .map(|(a, b)| a + (b - a) * part)
                    .collect();
                let kept: HashSet<[u32; 4]> = pairs.iter_at(&x).map(|p| p.pair.vertices).collect();
                for &[a, b, c] in mesh.triangles() {
                    for vertex in (0..x.len() as u32).filter(|v| ![a, b, c].contains(v)) {
                        let vertices = [vertex, a, b, c];
                        if is_near(QueryKind::VertexTriangle, vertices, &x) {
                            touching += 1;
                            assert!(kept.contains(&vertices), "round {round}: {vertices:?}");
                        }
                    }
                }
                for (k, &[a, b]) in edges.iter().enumerate() {
                    for &[c, d] in &edges[k + 1..] {
                        if a == c || a == d || b == c || b == d {
                            continue;
                        }
                        let vertices = [a, b, c, d];
                        if is_near(QueryKind::EdgeEdge, vertices, &x) {
                            let other = [c, d, a, b];
                            let known = kept.contains(&vertices) || kept.contains(&other);
                            assert!(known, "round {round}: {vertices:?}");
                        }
                    }
                }
            }
            last = from.iter().zip(&to).map(|(a, b)| b - a).collect();
            // Not all the way, as a search that is capped.
            let part = if round % 4 == 0 { 0.1 } else { 1.0 };
            from = from
                .iter()
                .zip(&to)
                .map(|(a, b)| a + (b - a) * part)
                .collect();
            if round % 11 == 0 {
                from.clone_from(&start);
            }
        }
        assert!(pairs.choices < 130);
    }
    assert!(touching > 1000, "{touching}");
}

/// Cloth that falls, and turns, without coming near to itself is looked at once.
#[test]
fn cloth_that_flies_is_looked_at_once() {
    let mesh = sheet(33);
    let law = PenaltyLaw::new(1e6, 2e-3).unwrap();
    let own = Own {
        self_collision: true,
        ..Own::default()
    };
    let near = Near::new(&mesh, law, Vec::new(), own);
    let patches = Some(Patches::new(&mesh, &near));
    let mut pairs = NearPairs {
        patches,
        ..NearPairs::default()
    };
    let mut x = mesh.positions().to_vec();
    pairs.begin(&x, &near.is_resting, false);
    for step in 0..100 {
        let fall = Vec3::z() * (-9.81 / 3600.0 * Real::from(step));
        let to: Vec<Vec3> = x.iter().map(|x| x + fall).collect();
        pairs.prepare(&near, [&x, &to], &[]);
        x = to;
        pairs.begin(&x, &near.is_resting, true);
    }
    let patches = pairs.patches.as_ref().unwrap();
    assert_eq!(patches.searches, 1);
    assert_eq!(patches.detections as usize, patches.count());
}

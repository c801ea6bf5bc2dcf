use super::super::near::{Own, Side};
use super::*;
use crate::incidence::edge_numbers;
use crate::obstacle::PenaltyLaw;
use crate::pair::Pair;
use crate::random::Random;
use crate::shapes::{deformed, sheet};
use cloth_core::mesh::TriMesh;
use cloth_core::mesh::generate::{Diagonals, grid};
use nalgebra::Rotation3;
use std::collections::HashSet;

/// Contact of a sheet with itself, from so far on (m).
fn near_itself(mesh: &TriMesh, thickness: Real) -> Near {
    let law = PenaltyLaw::new(1e6, thickness).unwrap();
    let own = Own {
        self_collision: true,
        ..Own::default()
    };
    Near::new(mesh, law, Vec::new(), own)
}

fn pairs_of(mesh: &TriMesh, near: &Near) -> NearPairs {
    NearPairs {
        patches: Some(Patches::new(mesh, near)),
        ..NearPairs::default()
    }
}

/// Counts the pairs that are within their range at the start, halfway or at the end of a path, by a look at all, and
/// checks that each is among those that may push there.
fn count_near(mesh: &TriMesh, near: &Near, pairs: &NearPairs, [from, to]: [&[Vec3]; 2]) -> u32 {
    let (edges, _) = edge_numbers(mesh.triangles());
    let is_near = |kind: QueryKind, vertices: [u32; 4], x: &[Vec3]| {
        let range = near.range_of(Pair { kind, vertices });
        Gap::new(kind, &gather(x, vertices)).distance < range
    };
    let mut count = 0;
    for part in [0.0, 0.5, 1.0] {
        let ends = from.iter().zip(to);
        let x: Vec<Vec3> = ends.map(|(a, b)| a + (b - a) * part).collect();
        let kept: HashSet<[u32; 4]> = pairs.iter_at(&x).map(|p| p.pair.vertices).collect();
        for &[a, b, c] in mesh.triangles() {
            for vertex in (0..x.len() as u32).filter(|v| ![a, b, c].contains(v)) {
                let vertices = [vertex, a, b, c];
                if is_near(QueryKind::VertexTriangle, vertices, &x) {
                    count += 1;
                    assert!(kept.contains(&vertices), "{part}: {vertices:?}");
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
                    count += 1;
                    let known = kept.contains(&vertices) || kept.contains(&[c, d, a, b]);
                    assert!(known, "{part}: {vertices:?}");
                }
            }
        }
    }
    count
}

/// Whatever paths a folded sheet takes, waved, turned, jerked and back again: every pair that is within its range
/// at the start, halfway or at the end of a path is among the ones that may push there, as a look at all pairs tells.
#[test]
fn no_near_pair_is_missed_on_any_path() {
    let mesh = sheet(9);
    let near = near_itself(&mesh, 0.02);
    let mut random = Random::new(5);
    let mut touching = 0;
    for (_, start) in deformed(&mesh).into_iter().take(5) {
        let mut pairs = pairs_of(&mesh, &near);
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
            pairs.prepare(&near, [&from, &to], &[], false);
            touching += count_near(&mesh, &near, &pairs, [&from, &to]);
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

/// A strip that is rolled up and unrolled while all of it turns, by up to a radian in a path: patches turn together,
/// and by themselves, and parts that were far from each other meet.
#[test]
fn no_near_pair_is_missed_where_patches_turn() {
    let mesh = grid(41, 3, 2.0, 0.1, Diagonals::Alternating).unwrap();
    let near = near_itself(&mesh, 0.02);
    let mut pairs = pairs_of(&mesh, &near);
    // On a spiral of winding `turns`, whose radius grows by 0.02 m a turn.
    let rolled = |winding: Real, frame: &Rotation3<Real>| -> Vec<Vec3> {
        let place = |x: &Vec3| {
            let angle = winding * x.x / 2.0;
            let radius = 0.05 + 0.02 * angle / std::f64::consts::TAU + 0.3 / (0.1 + winding);
            frame * Vec3::new(radius * angle.cos(), radius * angle.sin(), x.y)
        };
        mesh.positions().iter().map(place).collect()
    };
    let mut frame = Rotation3::identity();
    let mut x = rolled(0.0, &frame);
    pairs.begin(&x, &near.is_resting, false);
    let mut random = Random::new(8);
    let mut touching = 0;
    for round in 0..40 {
        let winding = 14.0 * (0.15 * Real::from(round)).sin().powi(2);
        frame = Rotation3::new(random.point([0.0, 0.05, 0.3, 1.0][round as usize % 4])) * frame;
        let to = rolled(winding, &frame);
        pairs.prepare(&near, [&x, &to], &[], false);
        touching += count_near(&mesh, &near, &pairs, [&x, &to]);
        // From the middle back to a place near the start, which an old choice may hold for.
        let back: Vec<Vec3> = x.iter().zip(&to).map(|(a, b)| a + (b - a) * 0.1).collect();
        let half: Vec<Vec3> = x.iter().zip(&to).map(|(a, b)| a + (b - a) * 0.5).collect();
        pairs.prepare(&near, [&half, &back], &[], false);
        touching += count_near(&mesh, &near, &pairs, [&half, &back]);
        x = to;
    }
    assert!(touching > 1000, "{touching}");
}

/// Two stiff leaves of a book that closes while it turns: no leaf spreads, and one moves before the other. Long leaves
/// have patches at their ends that are far from each other when patches are searched first.
#[test]
fn no_near_pair_is_missed_where_two_leaves_close() {
    let square = grid(5, 5, 0.2, 0.2, Diagonals::Alternating).unwrap();
    let long = grid(25, 3, 1.2, 0.1, Diagonals::Alternating).unwrap();
    for (leaf, shift) in [(&square, 0.0), (&square, 0.02), (&long, 0.0)] {
        close_leaves(leaf, shift);
    }
}

fn close_leaves(leaf: &TriMesh, shift: Real) {
    let count = leaf.vertex_count();
    let mut triangles = leaf.triangles().to_vec();
    let above = leaf.triangles().iter();
    triangles.extend(above.map(|t| t.map(|v| v + count as u32)));
    let closed_by = |angle: Real, frame: &Rotation3<Real>| -> Vec<Vec3> {
        let other = Rotation3::new(Vec3::y() * -angle);
        let own = leaf.positions().iter().map(|x| frame * x);
        let above = |x: &Vec3| frame * (other * x + Vec3::z() * 0.01);
        own.chain(leaf.positions().iter().map(above)).collect()
    };
    let mut frame = Rotation3::identity();
    let mut x = closed_by(1.5, &frame);
    let mesh = TriMesh::new(x.clone(), triangles).unwrap();
    let near = near_itself(&mesh, 4e-3);
    let mut pairs = pairs_of(&mesh, &near);
    pairs.begin(&x, &near.is_resting, false);
    let mut touching = 0;
    for step in 1..=150 {
        frame = Rotation3::new(Vec3::new(0.03, -0.05, 0.02)) * frame;
        let mut to = closed_by(1.5 - 0.01 * Real::from(step), &frame);
        // It may slide, too.
        let along = frame * Vec3::y() * (shift * (0.2 * Real::from(step)).sin());
        to[count..]
            .iter_mut()
            .for_each(|x| *x += along - frame * Vec3::z() * 8e-3);
        pairs.prepare(&near, [&x, &to], &[], false);
        touching += count_near(&mesh, &near, &pairs, [&x, &to]);
        x = to;
        pairs.begin(&x, &near.is_resting, true);
    }
    assert!(touching > 100, "{touching}");
}

/// A sheet that turns as a whole, by 3 degrees a step, and falls: each two patches are looked into once.
#[test]
fn cloth_that_turns_is_looked_at_once() {
    let mesh = sheet(33);
    let near = near_itself(&mesh, 2e-3);
    let mut pairs = pairs_of(&mesh, &near);
    let at = |step: i32| -> Vec<Vec3> {
        let step = Real::from(step);
        let turn = Rotation3::new(Vec3::new(1.0, 2.0, 0.5).normalize() * (0.0524 * step));
        let fall = Vec3::z() * (-9.81 / 7200.0 * step * step);
        mesh.positions().iter().map(|x| turn * x + fall).collect()
    };
    let mut x = at(0);
    pairs.begin(&x, &near.is_resting, false);
    for step in 1..100 {
        let to = at(step);
        pairs.prepare(&near, [&x, &to], &[], false);
        x = to;
        pairs.begin(&x, &near.is_resting, true);
    }
    let patches = pairs.patches.as_ref().unwrap();
    // Which patches are neighbours by their boxes changes as they turn.
    let detections = patches.detections as usize;
    assert!(
        detections <= 2 * patches.count(),
        "{detections}, {}",
        patches.count()
    );
}

/// Cloth that falls, and turns, without coming near to itself is looked at once.
#[test]
fn cloth_that_flies_is_looked_at_once() {
    let mesh = sheet(33);
    let near = near_itself(&mesh, 2e-3);
    let mut pairs = pairs_of(&mesh, &near);
    let mut x = mesh.positions().to_vec();
    pairs.begin(&x, &near.is_resting, false);
    for step in 0..100 {
        let fall = Vec3::z() * (-9.81 / 3600.0 * Real::from(step));
        let to: Vec<Vec3> = x.iter().map(|x| x + fall).collect();
        pairs.prepare(&near, [&x, &to], &[], false);
        x = to;
        pairs.begin(&x, &near.is_resting, true);
    }
    let patches = pairs.patches.as_ref().unwrap();
    assert_eq!(patches.searches, 1);
    assert_eq!(patches.detections as usize, patches.count());
}

/// A sheet, and a body that is like it and lies at a height of 0: the mesh with the sheet that high (m), and its
/// contact.
fn sheet_and_body(height: Real, thickness: Real, own: Own) -> (TriMesh, TriMesh, Near) {
    let sheet = grid(9, 9, 1.0, 1.0, Diagonals::Alternating).unwrap();
    let count = sheet.vertex_count() as u32;
    let of_body = sheet.triangles().iter().map(|t| t.map(|v| v + count));
    let triangles = sheet.triangles().iter().copied().chain(of_body);
    let mesh = TriMesh::new(above(&sheet, height), triangles.collect()).unwrap();
    let law = PenaltyLaw::new(1e6, thickness).unwrap();
    let side = Side {
        error_bound: Real::INFINITY,
        friction: 0.0,
        body: 0,
    };
    let mut near = Near::new(&mesh, law, vec![side; count as usize], own);
    let free: Vec<Real> = (0..2 * count)
        .map(|v| Real::from(u8::from(v < count)))
        .collect();
    near.begin(&free);
    (sheet, mesh, near)
}

/// The vertices of the sheet at that height (m), and those of the body.
fn above(sheet: &TriMesh, height: Real) -> Vec<Vec3> {
    let at = |z: Real| sheet.positions().iter().map(move |x| x + Vec3::z() * z);
    at(height).chain(at(0.0)).collect()
}

/// A body far below a sheet that falls goes as fast as the sheet, seen from that: it makes no pairs of patches that the
/// sheet alone does not have, and no more than a few searches for them.
#[test]
fn a_body_far_away_is_not_looked_at() {
    let own = Own {
        self_collision: true,
        ..Own::default()
    };
    let (sheet, mesh, near) = sheet_and_body(40.0, 2e-3, own);
    let mut pairs = pairs_of(&mesh, &near);
    let alone = near_itself(&sheet, 2e-3);
    let mut pairs_alone = pairs_of(&sheet, &alone);
    let height = |step: i32| 40.0 - 9.81 / 7200.0 * Real::from(step * step);
    for step in 0..160 {
        let path = [step, step + 1].map(|step| above(&sheet, height(step)));
        pairs.begin(&path[0], &near.is_resting, step > 0);
        pairs.prepare(&near, [&path[0], &path[1]], &[], false);
        let own = path.each_ref().map(|x| &x[..sheet.vertex_count()]);
        pairs_alone.begin(own[0], &alone.is_resting, step > 0);
        pairs_alone.prepare(&alone, own, &[], false);
        let [with, without] = [&pairs, &pairs_alone].map(|pairs| pairs.patches.as_ref().unwrap());
        assert_eq!(with.count(), without.count(), "{step}");
    }
    // Each reaches nine tenths of the way to the body.
    assert!(pairs.patches.unwrap().searches <= 2);
}

/// A sheet comes down on a body in hops: far from it patches are not asked, unless the sheet can touch itself, and no
/// pair is lost where it is near.
#[test]
fn pairs_with_a_body_are_complete_after_a_way_on_which_nothing_was_near() {
    let [far, far_with_itself] = [false, true].map(comes_down);
    assert!(far > 2 && far_with_itself == 0, "{far} {far_with_itself}");
}

fn comes_down(self_collision: bool) -> u32 {
    let own = Own {
        self_collision,
        ..Own::default()
    };
    let (sheet, mesh, near) = sheet_and_body(3.0, 0.05, own);
    let count = sheet.vertex_count() as u32;
    let mut pairs = pairs_of(&mesh, &near);
    let heights = [
        3.0, 2.5, 2.4, 1.0, 0.4, 0.39, 0.2, 0.08, 0.03, 0.02, 0.5, 2.0, 2.0, 0.04, 0.01,
    ];
    let (mut far, mut found) = (0, 0);
    for (step, ends) in heights.windows(2).enumerate() {
        let [from, to] = [ends[0], ends[1]].map(|height| above(&sheet, height));
        // Steps of two paths each.
        if step % 2 == 0 {
            pairs.begin(&from, &near.is_resting, step > 0);
            pairs.prepare(&near, [&from, &from], &[], false);
        }
        pairs.prepare(&near, [&from, &to], &[], true);
        far += u32::from(pairs.far.is_some());
        let kept: HashSet<[u32; 4]> = pairs.iter_at(&to).map(|p| p.pair.vertices).collect();
        for vertex in 0..count {
            for corners in &mesh.triangles()[sheet.triangle_count()..] {
                let vertices = [vertex, corners[0], corners[1], corners[2]];
                let pair = Pair {
                    kind: QueryKind::VertexTriangle,
                    vertices,
                };
                let gap = Gap::new(pair.kind, &gather(&to, vertices));
                if gap.distance < near.range_of(pair) {
                    found += 1;
                    assert!(kept.contains(&vertices), "{step}: {vertices:?}");
                }
            }
        }
    }
    assert!(found > 1000, "{found}");
    far
}

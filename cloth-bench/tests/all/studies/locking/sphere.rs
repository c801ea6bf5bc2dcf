//! What is left of the depth of corners.

use cloth_bench::studies::Scope;
use cloth_bench::studies::locking::sphere::{Case, MODULI, fall_of_corners, kept, list, sizes};
use cloth_core::math::{Real, Vec3};

#[test]
fn stiff_sheets_are_judged_by_what_is_left_of_the_depth_of_their_corners() {
    let rest = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [0.5, 0.5]];
    let rest = rest.map(|[x, y]| Vec3::new(x, y, 0.0));
    let mut lying = rest;
    for (vertex, depth) in [0.1, 0.2, 0.3, 0.4, -0.5].into_iter().enumerate() {
        lying[vertex].z = -depth;
    }
    assert!((fall_of_corners(&rest, &lying) - 0.75).abs() < 1e-15);
    let mut fallen = Vec::new();
    for (pattern, [soft, stiff]) in [("one-way", [0.5, 0.4]), ("crossed", [0.4, 0.1])] {
        let case = Case {
            pattern,
            ..list(Scope::Quick)[0]
        };
        fallen.extend(
            [(MODULI[0], soft), (MODULI[1], stiff)]
                .map(|(modulus, depth)| (Case { modulus, ..case }, depth)),
        );
    }
    let [least, most] = kept(&fallen).unwrap();
    assert_eq!((least.0, most.0), ("crossed", "one-way"));
    assert!((least.1 - 0.25).abs() < 1e-15 && (most.1 - 0.8).abs() < 1e-15);
    assert_eq!(kept(&fallen[..1]), None);
    assert_eq!(sizes(&[]), None);
    let of_size = |cells: usize, modulus: Real, depth: Real| {
        let case = Case {
            cells,
            modulus,
            ..list(Scope::Quick)[0]
        };
        (case, depth)
    };
    let mut made_finer = vec![
        of_size(32, MODULI[0], 0.5),
        of_size(32, MODULI[1], 0.3),
        of_size(16, MODULI[0], 0.6),
        of_size(16, MODULI[1], 0.2),
    ];
    // Another method's drapes are not mixed with them.
    made_finer.insert(
        0,
        (
            Case {
                method: "pd",
                cells: 8,
                ..made_finer[0].0
            },
            9.0,
        ),
    );
    assert_eq!(
        sizes(&made_finer),
        Some([(16, [0.6, 0.2]), (32, [0.5, 0.3])])
    );
}

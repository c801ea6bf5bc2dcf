//! The table of elements in the README says what the code can do.

use cloth_core::element::{Constraint, Energy, Projective, RowArray};
use cloth_core::energy::{
    ArapTriangle, AreaTriangle, Attachment, CubicShell, CurvatureHinge, CurvedHinge, DihedralHinge,
    MidpointHinge, Spring, StrainLimitSpring, StrainLimitTriangle, StvkTriangle, VolumeTetrahedron,
};
use std::marker::PhantomData;

/// Asks the compiler what an element of N vertices with K projected vectors has: its own constants come first, where the element has the view, and those of [`Lacking`] otherwise.
struct View<E, const N: usize, const K: usize>(PhantomData<E>);

trait Lacking {
    const ENERGY: bool = false;
    const ROWS: Option<usize> = None;
    const PROJECTIVE: bool = false;
}

impl<E, const N: usize, const K: usize> Lacking for View<E, N, K> {}

impl<E: Energy<N>, const N: usize, const K: usize> View<E, N, K> {
    const ENERGY: bool = true;
}

impl<E: Constraint<N>, const N: usize, const K: usize> View<E, N, K> {
    const ROWS: Option<usize> = Some(<E::Rows as RowArray<N>>::LEN);
}

impl<E: Projective<N, K>, const N: usize, const K: usize> View<E, N, K> {
    const PROJECTIVE: bool = true;
}

/// The cells of an element's line, from the code.
macro_rules! cells {
    ($element:ident, $n:literal) => {{
        let energy = if View::<$element, $n, 0>::ENERGY {
            "yes".to_owned()
        } else {
            "–".to_owned()
        };
        let rows = match View::<$element, $n, 0>::ROWS {
            Some(1) => "1 row".to_owned(),
            Some(rows) => format!("{rows} rows"),
            None => "–".to_owned(),
        };
        let kinds = [
            View::<$element, $n, 1>::PROJECTIVE,
            View::<$element, $n, 2>::PROJECTIVE,
            View::<$element, $n, 3>::PROJECTIVE,
        ];
        let projective = match kinds.iter().position(|&has| has) {
            Some(place) => format!("K = {}", place + 1),
            None => "–".to_owned(),
        };
        (stringify!($element), [energy, rows, projective])
    }};
}

#[test]
fn the_table_of_elements_is_that_of_the_code() {
    let readme = include_str!("../../README.md");
    let nothing = cells!(String, 1).1;
    assert_eq!(nothing, ["–"; 3], "what has no view is told apart");
    let elements = [
        cells!(Spring, 2),
        cells!(CurvatureHinge, 4),
        cells!(CurvedHinge, 4),
        cells!(DihedralHinge, 4),
        cells!(CubicShell, 4),
        cells!(MidpointHinge, 5),
        cells!(StvkTriangle, 3),
        cells!(ArapTriangle, 3),
        cells!(AreaTriangle, 3),
        cells!(VolumeTetrahedron, 4),
        cells!(StrainLimitSpring, 2),
        cells!(StrainLimitTriangle, 3),
        cells!(Attachment, 1),
    ];
    let mut wrong = Vec::new();
    for (name, cells) in &elements {
        let line = readme
            .lines()
            .find(|line| line.starts_with(&format!("| `{name}` ")));
        let written: Vec<&str> =
            line.map_or(Vec::new(), |line| line.split('|').map(str::trim).collect());
        let expected: Vec<&str> = cells.iter().map(String::as_str).collect();
        if written.get(2..5) != Some(&expected[..]) {
            wrong.push(format!(
                "{name}: {} in the code, {written:?} in the README",
                expected.join(" | ")
            ));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    // And it has no others.
    let rows = readme
        .lines()
        .skip_while(|line| !line.starts_with("| element |"))
        .skip(2);
    let rows = rows.take_while(|line| line.starts_with('|')).count();
    assert_eq!(rows, elements.len());
}

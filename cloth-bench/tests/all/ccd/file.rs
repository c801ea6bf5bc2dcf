//! Files of labelled queries.

use crate::program::folder;
use cloth_bench::ccd::{LabelledQuery, read};
use cloth_collide::QueryKind;
use cloth_core::math::Vec3;

/// What is read from a file of this test's own, or why it is not.
fn parse(name: &str, text: &[u8], kind: QueryKind) -> Result<Vec<LabelledQuery>, String> {
    let path = folder("queries").join(name);
    std::fs::write(&path, text).unwrap();
    read(path.to_str().unwrap(), kind).map_err(|error| error.to_string())
}

const ROW: &str = "1,2,-3,4,5,1,1\n";

#[test]
fn eight_rows_are_a_query() {
    let found = parse("sound", ROW.repeat(16).as_bytes(), QueryKind::EdgeEdge).unwrap();
    assert_eq!(found.len(), 2);
    assert_eq!(found[1].query.to[3], Vec3::new(0.5, -0.75, 5.0));
    assert!(found[0].contact);
    assert_eq!(found[1].line, Some(9));
}

#[test]
fn what_is_wrong_is_told_with_its_line() {
    let refused =
        |text: &str| parse("wrong", text.as_bytes(), QueryKind::VertexTriangle).unwrap_err();
    let at_third = |row: &str| refused(&format!("{ROW}{ROW}{row}\n{}", ROW.repeat(5)));
    for (row, words) in [
        ("1,2,3,4,5,1", "line 3: 6 columns"),
        ("1,2,x,4,5,1,1", "line 3: `x`"),
        ("1,2,nan,4,5,1,1", "line 3: `nan`"),
        ("1,0,3,4,5,1,1", "line 3: 1/0"),
        ("1,2,3,4,5,1,2", "line 3: the truth"),
        ("1,2,3,4,5,1,0", "line 3: its truth"),
    ] {
        assert!(at_third(row).contains(words), "{}", at_third(row));
    }
    assert!(refused(&ROW.repeat(9)).contains("line 9"));
    assert!(refused("").contains("no queries"));
    let broken = parse("bytes", b"1,2,3\n\xff", QueryKind::EdgeEdge).unwrap_err();
    assert!(broken.contains("line 2: it is no text"), "{broken}");
}

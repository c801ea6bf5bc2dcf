//! Reading and writing OBJ: every mistake names its line.

use cloth_core::math::Vec3;
use cloth_core::mesh::generate::{irregular, sphere};
use cloth_core::mesh::io::{MeshFileProblem, Place};
use cloth_core::mesh::vertex_normals;
use cloth_core::mesh::{obj, ply};
use proptest::prelude::*;
use std::path::{Path, PathBuf};

/// A square of two triangles, lines 1 to 6.
const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n";

fn message(text: &str) -> String {
    obj::parse(text).unwrap_err().to_string()
}

fn temporary(name: &str) -> PathBuf {
    std::env::temp_dir().join(format!("cloth-core-{}-{name}", std::process::id()))
}

#[test]
fn every_way_to_write_a_face_reads_the_same() {
    let square = obj::parse(SQUARE).unwrap();
    let vertices = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
    let spellings = [
        "f 1 2 3 4",
        "f -4 -3 -2 -1",
        "f 1/1 2/2 3/3 4/4",
        "f 1//1 2//1 3//1 4//1",
        "f 1/1/1 2/2/1 3/3/1 4/4/1",
        "f 1/ 2// 3/1/ 4",
        "f 1/-1/-1 -3//2 3/7 4",
        "f 1 2 \\\n 3 \\\n 4",
        "\tf   1\t2 3 4   # a comment",
        "# f 9 9 9 \\\nf 1 2 3 4",
    ];
    for face in spellings {
        assert_eq!(
            obj::parse(&format!("{vertices}{face}")).unwrap(),
            square,
            "{face}"
        );
    }
    // Faces may come first, and lines may end as they do on Windows.
    let faces_first = format!("f 1 2 3 4\n{vertices}");
    assert_eq!(obj::parse(&faces_first).unwrap(), square);
    for end in ["\r\n", "\r"] {
        assert_eq!(obj::parse(&SQUARE.replace('\n', end)).unwrap(), square);
    }
    let wrong = SQUARE.replace('\n', "\r").replace("1 3 4", "1 3 x");
    assert!(
        message(&wrong).starts_with("line 6: "),
        "{}",
        message(&wrong)
    );
    assert_eq!(obj::parse(&format!("\u{feff}{SQUARE}")).unwrap(), square);
}

/// A polygon of any shape becomes triangles of its own area, in a plane of any direction; what crosses itself does not.
#[test]
fn concave_polygons_are_cut_within_their_border() {
    let shapes: [(&[[f64; 2]], f64); 5] = [
        (&[[0., 1.], [0., 0.], [1., 0.], [0.2, 0.2]], 0.2),
        // A comb of three teeth, begun at a corner that sees little.
        (
            &[
                [1., 1.],
                [1., 3.],
                [0., 3.],
                [0., 0.],
                [5., 0.],
                [5., 3.],
                [4., 3.],
                [4., 1.],
                [3., 1.],
                [3., 3.],
                [2., 3.],
                [2., 1.],
            ],
            11.0,
        ),
        // A corner in the middle of an edge.
        (&[[0., 0.], [1., 0.], [2., 0.], [2., 2.], [0., 2.]], 4.0),
        // An L, and an arrow head.
        (
            &[[1., 1.], [1., 2.], [0., 2.], [0., 0.], [2., 0.], [2., 1.]],
            3.0,
        ),
        (&[[0., 0.], [3., 1.], [0., 2.], [1., 1.]], 2.0),
    ];
    let axes = [[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0]];
    for (corners, area) in shapes {
        for shift in 0..corners.len() {
            let mut text = String::new();
            for [a, b] in corners {
                let [x, y, z]: [f64; 3] =
                    std::array::from_fn(|k| 5.0 + a * axes[0][k] + b * axes[1][k]);
                text += &format!("v {x} {y} {z}\n");
            }
            let numbers = (0..corners.len()).map(|k| (k + shift) % corners.len() + 1);
            let face: String = numbers.map(|n| format!(" {n}")).collect();
            let mesh = obj::parse(&format!("{text}f{face}\n")).unwrap();
            assert_eq!(mesh.triangle_count(), corners.len() - 2);
            assert!(
                (mesh.area() / area - 1.0).abs() < 1e-12,
                "{corners:?}: {} m²",
                mesh.area()
            );
            let vertices = text.replace("v ", "");
            let header =
                "property float64 x\nproperty float64 y\nproperty float64 z\nelement face 1\n";
            let ply = format!(
                "ply\nformat ascii 1.0\nelement vertex {0}\n{header}property list uchar int vertex_indices\n\
                 end_header\n{vertices}{0}{1}\n",
                corners.len(),
                (0..corners.len())
                    .map(|k| format!(" {}", (k + shift) % corners.len()))
                    .collect::<String>()
            );
            assert_eq!(ply::parse(ply.as_bytes()).unwrap(), mesh);
        }
    }
    let bow = "v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 4\n";
    assert_eq!(
        message(bow),
        "line 5: the face crosses itself, or lies on a line: triangles are needed in its place"
    );
}

#[test]
fn what_a_cloth_does_not_need_is_skipped() {
    let text = format!(
        "# made by hand\nmtllib a.mtl\no thing\ng part 1\nusemtl red\ns off\nvt 0 0\nvn 0 0 1\n\
         vp 1\n\n{SQUARE}l 1 2\np 1\ncstype bezier\ncurv 0 1 1 2\nend\nvendor_extension x y\n"
    );
    assert_eq!(obj::parse(&text).unwrap(), obj::parse(SQUARE).unwrap());
    let coloured = SQUARE.replace("v 1 1 0", "v +1. 1e0 .0 0.5 0.25 0.125");
    assert_eq!(obj::parse(&coloured).unwrap(), obj::parse(SQUARE).unwrap());
}

#[test]
fn every_mistake_names_its_line() {
    let cases = [
        (
            "v 0 0\n",
            "line 7: a vertex needs three coordinates, this one has 2",
        ),
        (
            "v\n",
            "line 7: a vertex needs three coordinates, this one has 0",
        ),
        ("v 0 0 z\n", "line 7: \"z\" is not a number"),
        ("v 0 nan 0\n", "line 7: a coordinate is not a finite number"),
        (
            "v 0 0 -inf\n",
            "line 7: a coordinate is not a finite number",
        ),
        (
            "v 0 0 1e999\n",
            "line 7: a coordinate is not a finite number",
        ),
        (
            "f 1 2\n",
            "line 7: a face needs at least three corners, this one has 2",
        ),
        (
            "f\n",
            "line 7: a face needs at least three corners, this one has 0",
        ),
        (
            "f 1 2 x\n",
            "line 7: \"x\" is not a corner of a face, which reads v, v/vt, v//vn or v/vt/vn",
        ),
        (
            "f 1 2 0\n",
            "line 7: \"0\" is not a corner of a face, which reads v, v/vt, v//vn or v/vt/vn",
        ),
        (
            "f 1 2 3.5\n",
            "line 7: \"3.5\" is not a corner of a face, which reads v, v/vt, v//vn or v/vt/vn",
        ),
        (
            "f 1/x 2 3\n",
            "line 7: \"1/x\" is not a corner of a face, which reads v, v/vt, v//vn or v/vt/vn",
        ),
        (
            "f 1/1/1/1 2 3\n",
            "line 7: \"1/1/1/1\" is not a corner of a face, which reads v, v/vt, v//vn or v/vt/vn",
        ),
        (
            "f 1 2 5\n",
            "line 7: the face names vertex 5, but there are only 4 vertices, counted from 1",
        ),
        (
            "f 1 2 5000000000\n",
            "line 7: the face names vertex 5000000000, but there are only 4 vertices, counted from 1",
        ),
        (
            "f 1 2 -5\n",
            "line 7: the face names vertex -5, counted backwards, but there are only 4 vertices so far",
        ),
        ("f 2 4 2\n", "line 7: the face names a vertex twice"),
        (
            "f 3 1 2\n",
            "line 7: the face has the same three vertices as that of line 5: remove one of the two",
        ),
        (
            "f 2 1 3\n",
            "line 7: the face has the same three vertices as that of line 5: remove one of the two",
        ),
        (
            "v 2 2 0\n",
            "line 7: the vertex belongs to no face: remove it, since nothing would hold it",
        ),
        (
            "v 2 2 0\nf 1 3 5\n",
            "line 8: the face is degenerate: the area of a triangle is 0e0 m²",
        ),
        (
            "v 2 2 1\nf 1 3 5\n",
            "line 8: the edge between vertices 1 and 3, counted from 1, belongs to the faces of lines 5 and 6 already: \
             of the sheets that meet in it, give all but two vertices of their own there",
        ),
        ("<html>\n", "line 7: \"<html>\" is not a keyword of OBJ"),
        ("1 2 3\n", "line 7: \"1\" is not a keyword of OBJ"),
    ];
    for (mistake, expected) in cases {
        assert_eq!(message(&format!("{SQUARE}{mistake}")), expected);
    }
    // A continued line counts as the one where it starts, and those after it are not moved.
    assert!(message("v 0 \\\n0 z\n").starts_with("line 1: "));
    assert!(message("v 0 \\\n0 0\n\nv x\n").starts_with("line 4: "));
}

#[test]
fn files_that_are_missing_or_empty_are_named() {
    let missing = Path::new("no/such/file.obj");
    let error = obj::read(missing).unwrap_err();
    assert!(matches!(error.problem(), MeshFileProblem::Unreadable(_)));
    assert!(
        error
            .to_string()
            .starts_with("no/such/file.obj: the file cannot be read: ")
    );
    assert!(std::error::Error::source(&error).is_some());

    let path = temporary("empty.obj");
    std::fs::write(&path, "").unwrap();
    let error = obj::read(&path).unwrap_err();
    assert_eq!(error.path(), Some(path.as_path()));
    assert!(
        error
            .to_string()
            .ends_with(": there are no faces, so there is no cloth")
    );
    std::fs::write(&path, "# caf\u{e9}\nv 1 2\n").unwrap();
    let error = obj::read(&path).unwrap_err();
    assert_eq!(error.place(), Some(Place::Line(2)));
    assert!(
        error
            .to_string()
            .starts_with(&format!("{}: line 2: ", path.display()))
    );
    // Latin-1 in a comment is no reason to refuse a mesh.
    let latin: Vec<u8> = [b"# caf\xe9\n", SQUARE.as_bytes()].concat();
    std::fs::write(&path, latin).unwrap();
    assert!(obj::read(&path).is_ok());
    std::fs::remove_file(&path).unwrap();
}

#[test]
fn writing_and_reading_gives_the_same_bits() {
    let path = temporary("round.obj");
    for mesh in [sphere(5, 0.3).unwrap(), irregular(15, 1.0, 1.0, 4).unwrap()] {
        obj::write(&path, mesh.positions(), mesh.triangles()).unwrap();
        assert_eq!(obj::read(&path).unwrap(), mesh);
    }
    std::fs::remove_file(&path).unwrap();
    let nowhere = obj::write(Path::new("no/such/folder/a.obj"), &[], &[]).unwrap_err();
    assert!(matches!(nowhere.problem(), MeshFileProblem::Unwritable(_)));
}

/// On a sphere, whatever the triangles, the normals are the radii; a cone's tip has its axis; and what is written with
/// normals is read as the same mesh.
#[test]
fn normals_are_exact_on_a_sphere_and_travel_with_the_mesh() {
    let ball = sphere(9, 0.3).unwrap();
    let normals = vertex_normals(ball.positions(), ball.triangles());
    for (normal, x) in normals.iter().zip(ball.positions()) {
        assert!((normal - x / 0.3).norm() < 1e-14, "{normal} at {x}");
    }
    // Vertices of a sphere in no order at all: a tetrahedron with corners of very different angles.
    let corners = [
        [0.1, 0.2, 3.0],
        [1.0, -0.3, -0.2],
        [-0.7, 1.1, -0.4],
        [-0.2, -0.9, -0.1],
    ];
    let corners = corners.map(|c| Vec3::from(c).normalize());
    let faces = [[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]];
    for (normal, x) in vertex_normals(&corners, &faces).iter().zip(&corners) {
        assert!((normal - x).norm() < 1e-14, "{normal} at {x}");
    }
    let text = obj::format_smooth(ball.positions(), &normals, ball.triangles());
    assert_eq!(obj::parse(&text).unwrap(), ball);
    // No triangle, no area: no normal.
    let folded = [Vec3::zeros(), Vec3::x(), Vec3::x() * 2.0, Vec3::y()];
    assert_eq!(vertex_normals(&folded, &[[0, 1, 2]]), [Vec3::zeros(); 4]);
    assert_eq!(
        vertex_normals(&[Vec3::zeros(); 3], &[[0, 1, 2]]),
        [Vec3::zeros(); 3]
    );
}

/// Lines that are nearly right reach further into the reader than arbitrary text does.
fn nearly_obj() -> impl Strategy<Value = String> {
    let word = "[vfg#\\\\]|-?[0-9]{1,3}|[0-9]/[0-9]?/[0-9]|nan|1e999|-?[0-9]\\.[0-9]|/|\\PC{0,3}";
    let line = prop::collection::vec(word, 0..6).prop_map(|words| words.join(" "));
    prop::collection::vec(line, 0..20).prop_map(|lines| lines.join("\n"))
}

proptest! {
    #[test]
    fn no_text_makes_the_reader_panic(text in "(?s).{0,200}", nearly in nearly_obj()) {
        let _ = obj::parse(&text);
        let _ = obj::parse(&format!("{SQUARE}{nearly}"));
        let _ = obj::parse(&nearly);
    }

    #[test]
    fn every_finite_coordinate_survives(bits in prop::array::uniform3(any::<u64>())) {
        let p = bits.map(f64::from_bits);
        prop_assume!(p.iter().all(|c| c.is_finite()));
        let text = obj::format(&[Vec3::from(p)], &[]);
        let read = text.split_whitespace().skip(1).map(|w| w.parse::<f64>().unwrap().to_bits());
        prop_assert_eq!(read.collect::<Vec<_>>(), bits);
    }
}

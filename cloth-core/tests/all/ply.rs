//! Reading and writing PLY: every mistake names its line or its byte.

use cloth_core::math::Vec3;
use cloth_core::mesh::generate::{irregular, sphere};
use cloth_core::mesh::io::{MeshFileProblem, Place};
use cloth_core::mesh::ply::{self, Encoding};
use cloth_core::mesh::{io, obj};
use proptest::prelude::*;
use std::path::{Path, PathBuf};

const ENCODINGS: [Encoding; 3] = [
    Encoding::Ascii,
    Encoding::BinaryLittleEndian,
    Encoding::BinaryBigEndian,
];

/// Ten lines.
const HEADER: &str = "ply\nformat ascii 1.0\ncomment made by hand\nelement vertex 4\nproperty float x\nproperty float y\n\
                      property float z\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n";
/// Lines 11 to 16.
const BODY: [&str; 6] = ["0 0 0", "1 0 0", "1 1 0", "0 1 0", "3 0 1 2", "3 0 2 3"];

fn square() -> String {
    format!("{HEADER}{}\n", BODY.join("\n"))
}

/// The square with another line in the place of one of its lines (counted from 1).
fn with_line(number: usize, text: &str) -> String {
    let all = square();
    let mut lines: Vec<&str> = all.lines().collect();
    lines[number - 1] = text;
    lines.join("\n") + "\n"
}

fn message(bytes: impl AsRef<[u8]>) -> String {
    ply::parse(bytes.as_ref()).unwrap_err().to_string()
}

fn temporary(name: &str) -> PathBuf {
    std::env::temp_dir().join(format!("cloth-core-{}-{name}", std::process::id()))
}

#[test]
fn every_encoding_keeps_every_bit() {
    let path = temporary("round.ply");
    for mesh in [sphere(5, 0.3).unwrap(), irregular(15, 1.0, 1.0, 4).unwrap()] {
        for encoding in ENCODINGS {
            ply::write(&path, mesh.positions(), mesh.triangles(), encoding).unwrap();
            assert_eq!(ply::read(&path).unwrap(), mesh, "{encoding:?}");
            assert_eq!(io::read(&path).unwrap(), mesh, "{encoding:?}");
        }
    }
    std::fs::remove_file(&path).unwrap();
    let nowhere = Path::new("no/such/folder/a.ply");
    let refused = ply::write(nowhere, &[], &[], Encoding::Ascii).unwrap_err();
    assert!(matches!(refused.problem(), MeshFileProblem::Unwritable(_)));
    assert!(refused.to_string().starts_with("no/such/folder/a.ply: "));
    let missing = io::read(nowhere).unwrap_err().to_string();
    assert!(
        missing.starts_with("no/such/folder/a.ply: the file cannot be read: "),
        "{missing}"
    );
}

#[test]
fn polygons_are_cut_as_those_of_obj() {
    let corners = "0 0 0|2 0 0|3 1 0|1 3 0|-1 1 0".split('|');
    let vertices: Vec<&str> = corners.collect();
    let header = HEADER
        .replace("vertex 4", "vertex 5")
        .replace("face 2", "face 1");
    let polygon = format!("{header}{}\n5 0 1 2 3 4", vertices.join("\n"));
    let same = format!("v {}\nf 1 2 3 4 5\n", vertices.join("\nv "));
    assert_eq!(
        ply::parse(polygon.as_bytes()).unwrap(),
        obj::parse(&same).unwrap()
    );
}

#[test]
fn what_a_cloth_does_not_need_is_skipped() {
    let expected = ply::parse(square().as_bytes()).unwrap();
    let text = "ply\r\nformat ascii 1.0\r\nobj_info scanned\r\nelement material 1\r\nproperty int shininess\r\n\
                element nothing 99999999999\r\nelement face 2\r\nproperty uchar red\r\n\
                property list uint8 uint32 vertex_index\r\nproperty list uchar float texcoord\r\nelement vertex 4\r\n\
                property float nx\r\nproperty double y\r\nproperty int8 x\r\nproperty float32 z\r\nend_header\r\n\
                7\r\n255 3 0 1 2 2 .5 .5\r\n\r\n0 3 0 2 3 0\r\n.5 0 0 0\r\n.5 0 1 0\r\n.5 1 1 0\r\n.5 1e0 0 0\r\n";
    assert_eq!(ply::parse(text.as_bytes()).unwrap(), expected);
}

/// A file in which every type occurs, in both byte orders, put together here by hand.
#[test]
fn every_binary_type_is_read() {
    let expected = ply::parse(square().as_bytes()).unwrap();
    for little in [true, false] {
        let name = if little {
            "binary_little_endian"
        } else {
            "binary_big_endian"
        };
        let mut bytes = format!(
            "ply\nformat {name} 1.0\nelement vertex 4\nproperty char a\nproperty short x\nproperty ushort b\n\
             property float y\nproperty double z\nelement face 2\nproperty uint c\nproperty list int ushort vertex_indices\n\
             property list ushort char d\nend_header\n"
        )
        .into_bytes();
        macro_rules! put {
            ($($value:expr),*) => {
                $(bytes.extend(if little { $value.to_le_bytes() } else { $value.to_be_bytes() });)*
            };
        }
        for (x, y) in [(0i16, 0f32), (1, 0.0), (1, 1.0), (0, 1.0)] {
            put!(-3i8, x, 60_000u16, y, 0f64);
        }
        for face in [[0u16, 1, 2], [0, 2, 3]] {
            put!(
                4_000_000_000u32,
                3i32,
                face[0],
                face[1],
                face[2],
                2u16,
                1i8,
                -1i8
            );
        }
        assert_eq!(ply::parse(&bytes).unwrap(), expected, "{name}");
        let whole = bytes.len();
        bytes.push(0);
        assert_eq!(
            message(&bytes),
            format!("byte {whole}: there is more in the file than the header announces")
        );
        // Cut off anywhere it is refused, and never understood as something else.
        for length in 0..whole {
            assert!(ply::parse(&bytes[..length]).is_err(), "{length} bytes");
        }
        assert_eq!(
            message(&bytes[..whole - 1]),
            format!(
                "byte {}: the file ends within face 1, but the header announces 2 of them",
                whole - 1
            )
        );
    }
    // A negative coordinate in the narrow type keeps its sign.
    let low = with_line(5, "property short x").replace("1 0 0", "-7 0 0");
    assert_eq!(
        ply::parse(low.as_bytes()).unwrap().positions()[1],
        Vec3::new(-7.0, 0.0, 0.0)
    );
}

#[test]
fn every_mistake_names_its_line() {
    let cases = [
        (
            1,
            "plyx",
            "line 1: the first line of a PLY file is \"ply\", this one is not",
        ),
        (
            2,
            "format binary_middle_endian 1.0",
            "line 2: expected \"format ascii 1.0\", \"format binary_little_endian 1.0\" or \"format binary_big_endian 1.0\", \
             but the line says \"format binary_middle_endian 1.0\"",
        ),
        (
            3,
            "format ascii 1.0",
            "line 3: the header describes the format twice",
        ),
        (
            4,
            "element vertex four",
            "line 4: expected \"element NAME COUNT\" with a whole number, but the line says \"element vertex four\"",
        ),
        (
            6,
            "property float x",
            "line 6: the header describes the property \"x\" twice",
        ),
        (
            7,
            "propertie float z",
            "line 7: expected \"comment\", \"element\", \"property\" or \"end_header\", but the line says \"propertie float z\"",
        ),
        (
            7,
            "property float w",
            "the header describes no property \"x\", \"y\" and \"z\" of the vertices",
        ),
        (
            8,
            "element vertex 2",
            "line 8: the header describes the element \"vertex\" twice",
        ),
        (
            8,
            "element faces 2",
            "the header describes no element \"face\"",
        ),
        (
            9,
            "property list float int vertex_indices",
            "line 9: expected \"property TYPE NAME\" or \"property list COUNT_TYPE TYPE NAME\" after an element, with types char, \
             uchar, short, ushort, int, uint, float or double and a whole number as count, but the line says \
             \"property list float int vertex_indices\"",
        ),
        (
            9,
            "property list uchar float vertex_indices",
            "the header describes no list of whole numbers \"vertex_indices\" of the faces",
        ),
        (
            11,
            "0 0",
            "line 11: expected 3 values for this vertex, but the line has 2",
        ),
        (
            11,
            "0 0 0 0",
            "line 11: expected 3 values for this vertex, but the line has 4",
        ),
        (12, "1 0 z", "line 12: expected a number, but found \"z\""),
        (
            12,
            "1 0 nan",
            "line 12: a coordinate is not a finite number",
        ),
        (
            12,
            "1 0 1e999",
            "line 12: a coordinate is not a finite number",
        ),
        (
            15,
            "2 0 1",
            "line 15: a face needs at least three corners, this one has 2",
        ),
        (
            15,
            "-1",
            "line 15: a face needs at least three corners, this one has 0",
        ),
        (
            15,
            "3 0 1 2.5",
            "line 15: expected a whole number, but found \"2.5\"",
        ),
        (
            15,
            "3 0 1",
            "line 15: expected 4 values for this face, but the line has 3",
        ),
        (
            15,
            "3 0 1 4",
            "line 15: the face names vertex 4, but there are only 4 vertices, counted from 0",
        ),
        (
            16,
            "3 0 -2 3",
            "line 16: the face names vertex -2, but there are only 4 vertices, counted from 0",
        ),
        (
            16,
            "3 0 3 3",
            "line 16: face 1: triangle 1 names a vertex twice: [0, 3, 3]",
        ),
        (
            16,
            "3 2 1 0",
            "line 16: face 1 has the same three vertices as face 0 (line 15): remove one of the two",
        ),
        (
            16,
            "4 0 1 2 3",
            "line 16: face 1 has the same three vertices as face 0 (line 15): remove one of the two",
        ),
        (
            16,
            "3 0 2 1\n3 0 2 3",
            "line 17: there is more in the file than the header announces",
        ),
    ];
    for (line, text, expected) in cases {
        let told = message(with_line(line, text));
        assert_eq!(told, expected, "line {line}: {text}");
    }
    assert_eq!(
        message(with_line(14, "2 2 0")),
        "line 16: face 1: triangle 1 is degenerate: its area is 0e0 m²"
    );
    assert_eq!(
        message(
            with_line(16, "3 0 2 1")
                .replace("face 2", "face 1")
                .replace("\n3 0 2 1", "")
        ),
        "line 14: vertex 3 belongs to no triangle"
    );
    let third = format!("{}4 0 2 1 3\n", square().replace("face 2", "face 3"));
    let third = third
        .replace("vertex 4", "vertex 5")
        .replace("0 1 0\n", "0 1 0\n2 2 1\n");
    let third = third.replace("4 0 2 1 3", "3 0 2 4");
    assert_eq!(
        message(third),
        "line 18: the edge between vertices 0 and 2 of face 2 belongs to faces 0 (line 16) and 1 (line 17) already: of \
         the sheets that meet in it, give all but two vertices of their own there"
    );
    assert_eq!(
        message(""),
        "line 1: the first line of a PLY file is \"ply\", this one is not"
    );
    assert_eq!(
        message("ply\nformat ascii 1.0\n"),
        "line 3: the header ends without a line \"end_header\""
    );
    let short = square().replace("\n3 0 2 3", "");
    assert_eq!(
        message(short),
        "line 16: the file ends within face 1, but the header announces 2 of them"
    );
}

#[test]
fn a_count_beyond_the_file_costs_nothing() {
    let many = square().replace("vertex 4", "vertex 18446744073709551615");
    assert!(message(many).starts_with("line 15: expected 3 values for this vertex"));
    let list = "ply\nformat binary_little_endian 1.0\nelement vertex 18446744073709551615\nproperty list uint double l\n\
                property float x\nproperty float y\nproperty float z\nelement face 1\n\
                property list uint int vertex_indices\nend_header\n";
    let bytes = [list.as_bytes(), &[0xff; 64]].concat();
    let error = ply::parse(&bytes).unwrap_err();
    assert_eq!(error.place(), Some(Place::Byte(bytes.len())));
    assert!(error.to_string().contains("within vertex 0"), "{error}");
}

/// Headers that are nearly right reach further into the reader than arbitrary bytes do.
fn nearly_ply() -> impl Strategy<Value = Vec<u8>> {
    let line = "comment|element (vertex|face) [0-9]{1,20}|property (float|uchar|double|int) [xyzw]|\
                property list (uchar|int|char) (int|ushort) vertex_ind(ices|ex)|end_header|[a-z ]{0,9}";
    let format = prop::sample::select(vec!["ascii", "binary_little_endian", "binary_big_endian"]);
    let lines = prop::collection::vec(line, 0..9);
    let body = prop_oneof![
        prop::collection::vec(any::<u8>(), 0..80),
        "([0-9]{1,2}[ \n\r]|-1|nan){0,40}".prop_map(String::into_bytes),
    ];
    (format, lines, body).prop_map(|(format, lines, body)| {
        let head = format!(
            "ply\nformat {format} 1.0\n{}\nend_header\n",
            lines.join("\n")
        );
        [head.into_bytes(), body].concat()
    })
}

/// A header that is right, and a body that is anything.
fn any_body(encoding: Encoding, body: &[u8]) -> Vec<u8> {
    let whole = ply::format(&[Vec3::zeros(); 2], &[[0; 3]], encoding);
    let end = whole
        .windows(11)
        .position(|w| w == b"end_header\n")
        .unwrap()
        + 11;
    [&whole[..end], body].concat()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn no_bytes_make_the_reader_panic(
        bytes in prop::collection::vec(any::<u8>(), 0..200),
        nearly in nearly_ply(),
        encoding in prop::sample::select(ENCODINGS.to_vec()),
    ) {
        let _ = ply::parse(&bytes);
        let _ = ply::parse(&nearly);
        let _ = ply::parse(&any_body(encoding, &bytes));
        let _ = ply::parse(&[b"ply\n", &bytes[..]].concat());
    }

    #[test]
    fn a_changed_byte_does_not_make_the_reader_panic(
        encoding in prop::sample::select(ENCODINGS.to_vec()),
        place in any::<prop::sample::Index>(),
        byte in any::<u8>(),
    ) {
        let mesh = sphere(1, 0.3).unwrap();
        let mut bytes = ply::format(mesh.positions(), mesh.triangles(), encoding);
        let place = place.index(bytes.len());
        bytes[place] = byte;
        let _ = ply::parse(&bytes);
    }

    #[test]
    fn every_finite_coordinate_survives(bits in prop::array::uniform3(any::<u64>())) {
        let p = bits.map(f64::from_bits);
        prop_assume!(p.iter().all(|c| c.is_finite()));
        let text = ply::format(&[Vec3::from(p)], &[], Encoding::Ascii);
        let text = String::from_utf8(text).unwrap();
        let last = text.lines().last().unwrap();
        let read = last.split_whitespace().map(|w| w.parse::<f64>().unwrap().to_bits());
        prop_assert_eq!(read.collect::<Vec<_>>(), bits);
    }
}

#[test]
fn more_vectors_are_columns_that_a_reader_of_meshes_skips() {
    let positions = [[0.0, 0.0, 0.5], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(Vec3::from);
    let force = [[1.5, -2.0, 1e-300], [0.1, 0.2, 0.3], [0.0; 3]].map(Vec3::from);
    let bytes =
        |encoding| ply::format_with(&positions, &[("force", &force)], &[[0, 1, 2]], encoding);
    let text = String::from_utf8(bytes(Encoding::Ascii)).unwrap();
    assert!(
        text.contains(
            "property double z\nproperty double force_x\nproperty double force_y\nproperty double force_z\nelement face 1\n"
        ),
        "{text}"
    );
    assert!(text.contains("end_header\n0.0 0.0 0.5 1.5 -2.0 1e-300\n1.0 0.0 0.0 0.1 0.2 0.3\n"));
    for encoding in [
        Encoding::Ascii,
        Encoding::BinaryLittleEndian,
        Encoding::BinaryBigEndian,
    ] {
        let read = ply::parse(&bytes(encoding)).unwrap();
        assert_eq!(read.positions(), positions);
        assert_eq!(read.triangles(), [[0, 1, 2]]);
    }
}

/// Of a state only the vertices matter: what makes no mesh does not keep them from being read.
#[test]
fn vertices_are_read_whatever_the_faces_are() {
    let flat = [Vec3::zeros(), Vec3::x(), Vec3::x() * 2.0, Vec3::y()];
    for ending in ["obj", "ply"] {
        let path = temporary(&format!("vertices.{ending}"));
        // No area, and a vertex without a face.
        let write = |x: &[Vec3]| match ending {
            "obj" => obj::write(&path, x, &[[0, 1, 2]]).unwrap(),
            _ => ply::write(&path, x, &[[0, 1, 2]], Encoding::Ascii).unwrap(),
        };
        write(&flat);
        assert!(io::read(&path).is_err(), "{ending}");
        assert_eq!(io::read_vertices(&path).unwrap(), flat, "{ending}");
        write(&[flat[0], flat[1], Vec3::new(0.0, f64::NAN, 0.0)]);
        let error = io::read_vertices(&path).unwrap_err();
        assert!(
            matches!(error.problem(), MeshFileProblem::NotFinite) && error.place().is_some(),
            "{error}"
        );
        std::fs::remove_file(&path).unwrap();
        let gone = io::read_vertices(&path).unwrap_err();
        assert_eq!(gone.path(), Some(path.as_path()));
    }
}

//! Meshes by a name.

use cloth_bench::mesh_spec::load;

#[test]
fn every_form_makes_the_mesh_it_names() {
    let counts = |spec: &str| {
        let mesh = load(spec).unwrap();
        (mesh.vertex_count(), mesh.triangle_count())
    };
    assert_eq!(counts("grid:9x5:one-way"), (45, 64));
    assert_eq!(counts("grid:9x5:alternating"), (45, 64));
    assert_eq!(counts("grid:9x5:crossed"), (45 + 32, 128));
    assert_eq!(counts("tube:8x3"), (32, 48));
    assert_eq!(counts("torus:9x6"), (54, 108));
    assert_eq!(counts("sphere:3"), (92, 180));
    assert_eq!(counts("holes:5:2"), (36, 42));
    assert_eq!(counts("tangled:pocket"), (31 * 31 + 13 * 13, 1800 + 288));
    assert_eq!(counts("sphere:3+disk:1+grid:2x2:one-way"), (103, 188));
}

#[test]
fn a_wrong_name_is_answered_with_the_right_form() {
    let message = |spec: &str| load(spec).unwrap_err().to_string();
    assert!(message("grd:9x9:one-way").contains("`grid`"));
    assert!(message("grid:9:one-way").contains("grid:NxM:PATTERN"));
    assert!(message("grid:9x9:oneway").contains("`one-way`"));
    assert!(message("grid:9x9").contains("grid:NxM:PATTERN"));
    assert!(message("disk:0").contains("`disk:0`"));
    assert!(message("holes:4:2").contains("2 K + 1"));
    assert!(message("holes:4").contains("holes:N:K"));
    assert!(message("disk:2+dsk:3").contains("`dsk`"));
    assert!(message("sphere:two").contains("sphere:N"));
    assert!(message("tangled:hat").contains("tangled:GARMENT"));
    assert!(message("no-such-file.obj").contains("no-such-file.obj"));
}

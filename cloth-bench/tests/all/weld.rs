//! Files whose faces do not share their corners: told by a run, and welded where the scene wants that.

use crate::exact_runs::refused;
use crate::program::program;
use crate::scene_text::{scene, written};
use cloth_core::mesh::{TriMesh, generate, obj};

/// A grid in which the triangles of every third column have corners of their own, and the same grid as it should be.
fn torn() -> [TriMesh; 2] {
    let grid = generate::grid(7, 5, 0.6, 0.4, generate::Diagonals::Alternating).unwrap();
    let mut x = grid.positions().to_vec();
    let mut triangles = grid.triangles().to_vec();
    for cut in [2, 4] {
        // Vertices on the column are one for the triangles to its left, and another for those to its right.
        let place = 0.1 * f64::from(cut);
        let mut other = std::collections::HashMap::new();
        for corners in &mut triangles {
            let middle = corners.iter().map(|&v| x[v as usize].x).sum::<f64>() / 3.0;
            for v in corners.iter_mut().filter(|_| middle > place) {
                if (x[*v as usize].x - place).abs() < 1e-9 {
                    *v = *other.entry(*v).or_insert_with(|| {
                        x.push(x[*v as usize]);
                        x.len() as u32 - 1
                    });
                }
            }
        }
    }
    [TriMesh::new(x, triangles).unwrap(), grid]
}

#[test]
fn borders_on_each_other_are_told_with_their_number_and_welded() {
    let [torn, whole] = torn();
    let text = |more: &str| {
        format!(
            "[[mesh]]\nfile = \"unwelded.obj\"\n{more}[[pins]]\nbox = [[-1, -1, -1], [0.01, 1, 1]]\n"
        )
    };
    let path = written("unwelded", &text(""));
    let file = obj::format(torn.positions(), torn.triangles());
    std::fs::write(path.with_extension("obj"), file).unwrap();
    let run = |path: &std::path::Path| {
        let out = program(&[
            "run",
            path.to_str().unwrap(),
            "--method",
            "xpbd",
            "--steps",
            "1",
        ]);
        let said = String::from_utf8(out.stderr).unwrap();
        assert!(out.status.success(), "{said}");
        said
    };
    // Two columns of five vertices are double; the first of them is number 2 in the grid.
    let said = run(&path);
    let expected = "10 border vertices lie on others without being one with them, such as ";
    assert!(
        said.contains(expected) && said.contains("of 3 pieces"),
        "{said}"
    );
    assert!(said.contains("weld = 0"), "{said}");
    let welded = text("weld = 0\n");
    let said = run(&written("welded", &welded));
    assert!(!said.contains("border vertices"), "{said}");
    let scene = scene("welded", &welded);
    let order = scene.order.as_ref().unwrap();
    let mesh = scene.mesh.as_ref().unwrap();
    assert_eq!(order.restore(mesh.positions()), whole.positions());
    let back = |t: &[u32; 3]| t.map(|v| order.old_of_new()[v as usize]);
    let mut triangles: Vec<[u32; 3]> = mesh.triangles().iter().map(back).collect();
    let mut expected = whole.triangles().to_vec();
    triangles.sort_unstable();
    expected.sort_unstable();
    assert_eq!(triangles, expected);
    refused("over-welded", &text("weld = 0.11\n"), 3, "twice");
}

/// What a seam sews is meant to be two, and no reason to warn.
#[test]
fn borders_that_a_seam_joins_are_not_told() {
    let sheet = "[[mesh]]\ngenerator = \"grid:5x5:alternating\"\n";
    let text = format!("{sheet}{sheet}translate = [1, 0, 0]\n[[pins]]\nselect = \"highest\"\n");
    let beside = scene("beside-each-other", &text);
    let warning = beside.border_warning().unwrap();
    assert!(warning.starts_with("5 border vertices"), "{warning}");
    for more in ["", "from = 0.1\nuntil = 0.2\n"] {
        let seam = "[[seam]]\nmeshes = [0, 1]\nfirst_border = [4, 24]\nsecond_border = [0, 20]\n";
        let sewn = scene("sewn-to-each-other", &format!("{text}{seam}{more}"));
        assert_eq!(sewn.border_warning(), None);
    }
}

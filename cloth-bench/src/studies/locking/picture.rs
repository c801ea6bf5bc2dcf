//! What locking looks like: one sheet, folded along the diagonals of its mesh and across them. Beside each fold the
//! flat mesh with the lengths that are held and the line it is folded about.

use super::fold::{self, Axis, Fold};
use super::sheet::{Kind, Sheet};
use crate::report::canvas::{WIDTH, wrap};
use crate::report::html::base64;
use crate::report::render::{Surface, View, render};
use crate::studies::prelude::*;
use cloth_core::topology::EdgeTable;
use std::fmt::Write;

const CELLS: usize = 16;
/// Y (N/m) and D (N·m): a thin cloth that would hang down almost straight.
pub const STIFFNESS: [Real; 2] = [1e6, 2e-4];

/// A picture: its name, its title, and its rows.
type Picture = (&'static str, &'static str, [(&'static str, Axis, Kind); 3]);

const ONE_CLOTH: Picture = (
    "locking-picture",
    "One cloth, one weight, one stiffness: only the direction of the fold differs",
    [
        ("folded along the diagonals", Axis::Along, Kind::Springs),
        ("folded across the diagonals", Axis::Across, Kind::Springs),
        ("across, on edge midpoints", Axis::Across, Kind::Midpoints),
    ],
);

/// The other kinds of membrane, with all sizes only.
const OTHERS: [Picture; 3] = [
    (
        "locking-picture-triangles",
        "Triangles lock like springs; fewer springs do not",
        [
            ("across, StVK triangles", Axis::Across, Kind::Stvk),
            ("across, ARAP triangles", Axis::Across, Kind::Arap),
            ("across, no diagonals", Axis::Across, Kind::Quads),
        ],
    ),
    (
        "locking-picture-laws",
        "Across the diagonals, with springs that give way",
        [
            (
                "a hundredth when pushed",
                Axis::Across,
                Kind::Compression(0.01),
            ),
            ("slack within ±0.5 %", Axis::Across, Kind::DeadZone(0.005)),
            ("soft, stiff beyond 1 %", Axis::Across, Kind::Limited(0.01)),
        ],
    ),
    (
        "locking-picture-levels",
        "Across the diagonals, with fewer conditions",
        [
            ("springs on all edges", Axis::Across, Kind::Springs),
            (
                "a fifth of all motions free",
                Axis::Across,
                Kind::DofFraction(0.2),
            ),
            ("a coarse level holds", Axis::Across, Kind::Level(2)),
        ],
    ),
];

fn pictures(scope: Scope) -> impl Iterator<Item = Picture> {
    let others = scope.pick(&[][..], &OTHERS);
    std::iter::once(ONE_CLOTH).chain(others.iter().copied())
}

/// A fold, turned so that all are seen along their axis.
struct Shape {
    vertices: Vec<Vec3>,
    sheet: Sheet,
    exact: Fold,
    /// [`Fold::angles`] (°).
    angles: [Real; 2],
    /// [`fold::Folded::bending`].
    bending: Real,
}

/// What a fold is called and what is told of it, and its colour; `exact` is the angle (°) of the exact one. A sheet
/// whose corners hang at unlike angles, or that stores twice the bending energy of the fold, has not folded about the
/// line, however far down its corners are in the mean.
pub fn judged(angles: [Real; 2], exact: Real, bending: Real) -> (String, &'static str) {
    let [least, most] = [angles[0].min(angles[1]), angles[0].max(angles[1])];
    let mean = 0.5 * (least + most);
    if most - least > 0.25 * exact {
        let told = format!("crumples: corners at {least:.0}° and {most:.0}°");
        return (told, "#7a3b9d");
    }
    let (word, colour) = match mean / exact {
        _ if bending > 2.0 => ("crumples", "#7a3b9d"),
        share if share > 0.8 => ("folds", "#1b7f3b"),
        share if share > 0.5 => ("bends", "#8a5a00"),
        _ => ("locked", "#b3261e"),
    };
    (format!("{word}: its corners hang {mean:.0}° down"), colour)
}

pub(super) fn run(study: &mut StudyRun<'_>) -> Result<(), BenchError> {
    let scope = study.scope;
    for picture in pictures(scope) {
        let (name, ..) = picture;
        let svg = study.cases.case(name, || draw(&picture));
        if let Some(svg) = study.unless_failed(name, svg) {
            study.section.plots.push((name.into(), svg));
        }
    }
    Ok(())
}

fn draw((_, title, rows): &Picture) -> Result<String, BenchError> {
    let mut shapes = Vec::new();
    for &(_, axis, kind) in rows {
        // A stiff sheet let go on the exact fold, where it does not fit, springs anywhere. One that gets stiffer where
        // it hangs does not.
        let [modulus, rigidity] = STIFFNESS;
        let soft = fold::fold(axis, "one-way", CELLS, kind, [0.01 * modulus, rigidity])?;
        let start = soft.rest.points;
        let folded = fold::fold_from(start, axis, "one-way", CELLS, kind, STIFFNESS)?;
        let away = axis.directions()[1];
        let along = Vec3::z().cross(&away); // the same hand for both
        let turn = |p: &Vec3| Vec3::new(p.dot(&away), p.dot(&along), p.z);
        let vertices: Vec<Vec3> = folded
            .sheet
            .vertices(&folded.rest.points)
            .iter()
            .map(turn)
            .collect();
        let middle = vertices.iter().sum::<Vec3>() / vertices.len() as Real;
        shapes.push(Shape {
            vertices: vertices
                .iter()
                .map(|p| Vec3::new(p.x - middle.x, p.y - middle.y, p.z))
                .collect(),
            angles: folded
                .exact
                .angles(&folded.sheet, &folded.sheet.vertices(&folded.rest.points))?,
            bending: folded.bending,
            exact: folded.exact,
            sheet: folded.sheet,
        });
    }
    compose(title, rows, &shapes)
}

/// Width of the figure (px).
const WIDE: Real = WIDTH as Real;
/// Height of what is shown of one sheet, side of its flat mesh, and where its fold is, and how large (px).
const TALL: Real = 262.0;
const FLAT: Real = 130.0;
const FOLDED: [Real; 4] = [190.0, 46.0, 270.0, 206.0];

const EXPLAINED: &str = "Left: the flat sheet with its triangles (thin), the lengths that its membrane keeps (thick) and the \
    line along which it is held (dashed). Right: the same sheet under its own weight, seen along that line.";

fn compose(
    headline: &str,
    rows: &[(&str, Axis, Kind)],
    shapes: &[Shape],
) -> Result<String, BenchError> {
    let view = View {
        width: 540,
        height: 412,
        direction: Vec3::new(-0.35, 0.85, -0.35),
        wire: 0.5,
        background: None,
        bounds: Some(bounds(shapes.iter().flat_map(|s| &s.vertices).copied())),
        ..View::default()
    };
    let mut body = String::new();
    let mut top = 30.0;
    let mut text = |y: Real, look: &str, words: &str| {
        let _ = write!(body, "<text x=\"20\" y=\"{y}\" {look}>{words}</text>");
    };
    for line in wrap(headline, 16, WIDTH - 80) {
        text(top, "font-size=\"16\" font-weight=\"bold\"", &line);
        top += 22.0;
    }
    let first = top;
    for (shape, (name, ..)) in shapes.iter().zip(rows) {
        let exact = shape.exact.exact_angle();
        let (words, colour) = judged(shape.angles, exact, shape.bending);
        let bold = "font-size=\"14\" font-weight=\"bold\"";
        text(top + 20.0, bold, name);
        text(top + 38.0, &format!("{bold} fill=\"{colour}\""), &words);
        top += TALL;
        text(
            top - 14.0,
            "font-size=\"12\" fill=\"#5a626b\"",
            &format!("unstretchable: {exact:.0}°"),
        );
    }
    for line in wrap(EXPLAINED, 12, WIDTH - 40) {
        top += 17.0;
        text(top, "font-size=\"12\" fill=\"#5a626b\"", &line);
    }
    for (row, (shape, &(_, axis, _))) in shapes.iter().zip(rows).enumerate() {
        let above = first + TALL * row as Real;
        body += &flat_mesh(&shape.sheet, axis, [20.0, above + 70.0])?;
        let cloth = Surface::cloth(&shape.vertices, shape.sheet.mesh.triangles());
        let png = base64(&render(&[cloth], &view)?);
        let [x, y, width, height] = FOLDED;
        let y = above + y;
        let _ = write!(
            body,
            "<image x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" href=\"data:image/png;base64,{png}\"/>"
        );
    }
    let height = top + 16.0;
    Ok(format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDE}\" height=\"{height}\" viewBox=\"0 0 {WIDE} {height}\" role=\"img\" \
         aria-label=\"{headline}\" fill=\"#22262b\" font-family=\"system-ui, 'DejaVu Sans', sans-serif\">\
         <rect width=\"{WIDE}\" height=\"{height}\" fill=\"#fff\"/>{body}</svg>\n"
    ))
}

/// The mesh at rest seen from above, with its lower left corner at the lower left of a square at `corner` (px), the
/// lengths that its membrane holds, and the line of the fold.
pub fn flat_mesh(sheet: &Sheet, axis: Axis, corner: [Real; 2]) -> Result<String, BenchError> {
    let at = |p: &Vec3| [corner[0] + FLAT * p.x, corner[1] + FLAT * (1.0 - p.y)];
    let edges = EdgeTable::build(&sheet.mesh)?;
    let lines = |pairs: &[[u32; 2]], points: &[Vec3]| {
        let mut path = String::new();
        for &[a, b] in pairs {
            let ([x0, y0], [x1, y1]) = (at(&points[a as usize]), at(&points[b as usize]));
            let _ = write!(path, "M{x0:.1} {y0:.1}L{x1:.1} {y1:.1}");
        }
        path
    };
    let thin = lines(edges.ends(), sheet.mesh.positions());
    let thick = lines(&sheet.conditions()?, &sheet.points);
    let middle = Vec3::new(0.5, 0.5, 0.0);
    let reach = axis.directions()[0] * 0.8;
    let ([x0, y0], [x1, y1]) = (at(&(middle - reach)), at(&(middle + reach)));
    Ok(format!(
        "<path d=\"{thin}\" fill=\"none\" stroke=\"#c3cad1\" stroke-width=\"0.5\"/>\
         <path d=\"{thick}\" fill=\"none\" stroke=\"#3d4852\" stroke-width=\"0.9\"/>\
         <path d=\"M{x0:.1} {y0:.1}L{x1:.1} {y1:.1}\" fill=\"none\" stroke=\"#b3261e\" stroke-width=\"3\" stroke-dasharray=\"9 4\"/>"
    ))
}

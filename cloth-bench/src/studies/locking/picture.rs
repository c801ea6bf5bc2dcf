//! What locking looks like: one sheet, folded along the diagonals of its mesh and across them. Above each fold the flat mesh with the line it is folded about.

use super::fold::{self, Axis, Fold};
use super::sheet::{Kind, Sheet};
use crate::error::BenchError;
use crate::report::html::base64;
use crate::report::render::{Surface, View, render_row};
use crate::studies::{Cases, Findings, Scope};
use cloth_core::math::{Real, Vec3};
use cloth_core::topology::EdgeTable;
use std::fmt::Write;

const CELLS: usize = 16;
/// Y (N/m) and D (N·m): a thin cloth that would hang down almost straight.
const STIFFNESS: [Real; 2] = [1e6, 2e-4];

/// A picture: its name, its title, and its columns.
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
            ("slack within ±0.5 %", Axis::Across, Kind::Slack(0.005)),
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
                Kind::Freedom(0.2),
            ),
            ("a coarse level holds", Axis::Across, Kind::Level(2)),
        ],
    ),
];

fn pictures(scope: Scope) -> impl Iterator<Item = Picture> {
    let others = match scope {
        Scope::Quick => &[][..],
        Scope::Full => &OTHERS,
    };
    std::iter::once(ONE_CLOTH).chain(others.iter().copied())
}

pub(super) fn cases(scope: Scope) -> u64 {
    pictures(scope).count() as u64
}

/// A fold, turned so that all are seen along their axis.
struct Shape {
    vertices: Vec<Vec3>,
    sheet: Sheet,
    exact: Fold,
    /// [`Fold::angle`] (°).
    angle: Real,
}

pub(super) fn run(
    scope: Scope,
    findings: &mut Findings,
    cases: &mut Cases<'_>,
) -> Result<(), BenchError> {
    for picture in pictures(scope) {
        let (name, ..) = picture;
        let svg = cases.case(name, || draw(&picture));
        if let Some(svg) = findings.unless_failed(name, svg) {
            findings.section.plots.push(svg.clone());
            findings.plots.push((name.into(), svg));
        }
    }
    Ok(())
}

fn draw((_, title, columns): &Picture) -> Result<String, BenchError> {
    let mut shapes = Vec::new();
    for &(_, axis, kind) in columns {
        // A stiff sheet let go on the exact fold, where it does not fit, springs anywhere. One that gets stiffer where it hangs does not.
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
            angle: folded.angle,
            exact: folded.exact,
            sheet: folded.sheet,
        });
    }
    compose(title, columns, &shapes)
}

/// Width of a column, and where its rows begin (px).
const COLUMN: Real = 300.0;
const FLAT: Real = 130.0;
const ROWS: [Real; 5] = [34.0, 76.0, 92.0, 232.0, 518.0];

fn compose(
    headline: &str,
    columns: &[(&str, Axis, Kind)],
    shapes: &[Shape],
) -> Result<String, BenchError> {
    let surfaces: Vec<[Surface<'_>; 1]> = shapes
        .iter()
        .map(|shape| {
            [Surface::cloth(
                &shape.vertices,
                shape.sheet.mesh.triangles(),
            )]
        })
        .collect();
    let tiles: Vec<&[Surface<'_>]> = surfaces.iter().map(|s| &s[..]).collect();
    let view = View {
        width: 400,
        height: 360,
        direction: Vec3::new(-0.35, 0.85, -0.35),
        wire: 0.5,
        ..View::default()
    };
    let png = render_row(&tiles, &view).map_err(BenchError::failed)?;
    let width = COLUMN * shapes.len() as Real;
    let tall = COLUMN * view.height as Real / view.width as Real;
    let [title, names, flat, folded, told] = ROWS;
    let mut body = String::new();
    let mut text = |x: Real, y: Real, look: &str, text: &str| {
        let _ = write!(body, "<text x=\"{x}\" y=\"{y}\" {look}>{text}</text>");
    };
    text(
        20.0,
        title,
        "font-size=\"18\" font-weight=\"bold\"",
        headline,
    );
    for (column, (shape, (name, ..))) in shapes.iter().zip(columns).enumerate() {
        let middle = COLUMN * (column as Real + 0.5);
        let centred = "text-anchor=\"middle\" font-size=\"14\"";
        text(
            middle,
            names,
            &format!("{centred} font-weight=\"bold\""),
            name,
        );
        let exact = shape.exact.exact_angle();
        let (word, colour) = match shape.angle / exact {
            share if share > 0.8 => ("folds", "#1b7f3b"),
            share if share > 0.5 => ("bends", "#8a5a00"),
            _ => ("locked", "#b3261e"),
        };
        text(
            middle,
            told,
            &format!("{centred} font-weight=\"bold\" fill=\"{colour}\""),
            &format!("{word}: its corners hang {:.0}° down", shape.angle),
        );
        text(
            middle,
            told + 20.0,
            &format!("{centred} fill=\"#5a626b\""),
            &format!("a cloth that cannot stretch: {exact:.0}°"),
        );
    }
    for (column, (shape, &(_, axis, _))) in shapes.iter().zip(columns).enumerate() {
        let left = COLUMN * (column as Real + 0.5) - 0.5 * FLAT;
        body += &flat_mesh(&shape.sheet, axis, [left, flat])?;
    }
    let _ = write!(
        body,
        "<image x=\"0\" y=\"{folded}\" width=\"{width}\" height=\"{tall}\" href=\"data:image/png;base64,{}\"/>",
        base64(&png)
    );
    let height = told + 40.0;
    Ok(format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" role=\"img\" \
         aria-label=\"{headline}\" fill=\"#22262b\" font-family=\"system-ui, 'DejaVu Sans', sans-serif\">\
         <rect width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>{body}</svg>\n"
    ))
}

/// The mesh at rest seen from above, with its lower left corner at the lower left of a square at `corner` (px), and the line of the fold.
fn flat_mesh(sheet: &Sheet, axis: Axis, corner: [Real; 2]) -> Result<String, BenchError> {
    let at = |p: &Vec3| [corner[0] + FLAT * p.x, corner[1] + FLAT * (1.0 - p.y)];
    let edges = EdgeTable::build(&sheet.mesh).map_err(BenchError::failed)?;
    let rest = sheet.mesh.positions();
    let mut path = String::new();
    for &[a, b] in edges.ends() {
        let ([x0, y0], [x1, y1]) = (at(&rest[a as usize]), at(&rest[b as usize]));
        let _ = write!(path, "M{x0:.1} {y0:.1}L{x1:.1} {y1:.1}");
    }
    let middle = Vec3::new(0.5, 0.5, 0.0);
    let reach = axis.directions()[0] * 0.8;
    let ([x0, y0], [x1, y1]) = (at(&(middle - reach)), at(&(middle + reach)));
    Ok(format!(
        "<path d=\"{path}\" fill=\"none\" stroke=\"#7a8794\" stroke-width=\"0.7\"/>\
         <path d=\"M{x0:.1} {y0:.1}L{x1:.1} {y1:.1}\" fill=\"none\" stroke=\"#b3261e\" stroke-width=\"3\" stroke-dasharray=\"9 4\"/>"
    ))
}

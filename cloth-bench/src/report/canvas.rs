//! A thin layer over plotters: pixels with quarter precision, texts with anchors, markers.
//!
//! plotters places shapes on whole pixels, which makes smooth curves wobble. We draw on a canvas
//! four times as large and let the `viewBox` scale it down.

use plotters::coord::Shift;
use plotters::element::DashedPathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::html::escape;
use super::palette::{Look, Marker, Rgb};

/// Width of every figure (px): two stand beside each other on a page, and a telephone shows one without shrinking its
/// letters to nothing.
pub const WIDTH: i32 = 480;
/// Distance of two lines of a legend (px).
pub(super) const LINE: i32 = 18;
/// Canvas units in a pixel.
const UNIT: i32 = 4;
const FONT: &str = "system-ui, -apple-system, 'Segoe UI', Roboto, 'DejaVu Sans', sans-serif";

/// What drawing returns.
pub(super) type Drawn = Result<(), Box<dyn std::error::Error>>;

/// Where a text stands relative to its point.
#[derive(Debug, Clone, Copy)]
pub(super) enum Anchor {
    Left,
    Middle,
    Right,
}

pub(super) struct Canvas<'a> {
    area: DrawingArea<SVGBackend<'a>, Shift>,
}

fn solid([r, g, b]: Rgb) -> ShapeStyle {
    RGBColor(r, g, b).filled()
}

fn stroke([r, g, b]: Rgb, width: f64) -> ShapeStyle {
    RGBColor(r, g, b).stroke_width((width * f64::from(UNIT)).round() as u32)
}

impl<'a> Canvas<'a> {
    pub(super) fn new(area: DrawingArea<SVGBackend<'a>, Shift>) -> Self {
        Self { area }
    }

    pub(super) fn area(&self) -> &DrawingArea<SVGBackend<'a>, Shift> {
        &self.area
    }

    /// Size in canvas units of a figure `height` px high.
    pub(super) fn size(height: i32) -> (u32, u32) {
        ((WIDTH * UNIT) as u32, (height.max(1) * UNIT) as u32)
    }

    pub(super) fn units(pixels: i32) -> i32 {
        pixels * UNIT
    }

    pub(super) fn pixels(units: i32) -> i32 {
        (f64::from(units) / f64::from(UNIT)).round() as i32
    }

    /// A filled rectangle (px).
    pub(super) fn rectangle(&self, from: (i32, i32), to: (i32, i32), colour: Rgb) -> Drawn {
        let corner = |(x, y)| (Self::units(x), Self::units(y));
        Ok(self
            .area
            .draw(&Rectangle::new([corner(from), corner(to)], solid(colour)))?)
    }

    /// A path (units), `width` (px) wide.
    pub(super) fn stroke(&self, path: &[(i32, i32)], colour: Rgb, width: f64) -> Drawn {
        if path.len() < 2 {
            return Ok(());
        }
        Ok(self
            .area
            .draw(&PathElement::new(path.to_vec(), stroke(colour, width)))?)
    }

    /// A dashed path (units), `width` (px) wide, in one of four patterns.
    pub(super) fn dashes(
        &self,
        path: &[(i32, i32)],
        colour: Rgb,
        width: f64,
        pattern: usize,
    ) -> Drawn {
        let (dash, gap) = [(7, 4), (2, 4), (14, 5), (4, 9)][pattern % 4];
        let (dash, gap) = (Self::units(dash), Self::units(gap));
        let style = stroke(colour, width);
        Ok(self.area.draw(&DashedPathElement::new(
            path.iter().copied(),
            dash,
            gap,
            style,
        ))?)
    }

    /// A marker around a point (units), `size` times the usual one. A white rim sets it off from lines below.
    pub(super) fn marker(&self, at: (i32, i32), look: Look, size: f64) -> Drawn {
        let radius = 4.4 * size * f64::from(UNIT);
        let corners = |count: usize, turn: f64, radii: [f64; 2]| -> Vec<(i32, i32)> {
            (0..count)
                .map(|i| {
                    let angle = std::f64::consts::TAU * (i as f64 / count as f64 + turn);
                    let r = radius * radii[i % 2];
                    (
                        at.0 + (r * angle.cos()).round() as i32,
                        at.1 + (r * angle.sin()).round() as i32,
                    )
                })
                .collect()
        };
        let outline = match look.marker {
            Marker::Circle => corners(20, 0.0, [1.0; 2]),
            Marker::Square => corners(4, 0.125, [1.2; 2]),
            Marker::Triangle => corners(3, 0.75, [1.3; 2]),
            Marker::TriangleDown => corners(3, 0.25, [1.3; 2]),
            Marker::Diamond => corners(4, 0.0, [1.3; 2]),
            Marker::Star => corners(10, 0.75, [1.5, 0.65]),
            Marker::Cross => return self.strokes(&corners(4, 0.125, [1.2; 2]), look.colour),
            Marker::Plus => return self.strokes(&corners(4, 0.0, [1.3; 2]), look.colour),
        };
        let closed: Vec<_> = outline.iter().chain(&outline[..2]).copied().collect();
        let (fill, rim) = if look.hollow {
            ([255; 3], look.colour)
        } else {
            (look.colour, [255; 3])
        };
        if !look.hollow {
            self.stroke(&closed, rim, 2.0)?;
        }
        self.area.draw(&Polygon::new(outline, solid(fill)))?;
        if look.hollow {
            self.stroke(&closed, rim, 1.75)
        } else {
            Ok(())
        }
    }

    /// The two diagonals of four corners (units).
    fn strokes(&self, corners: &[(i32, i32)], colour: Rgb) -> Drawn {
        for (colour, width) in [([255; 3], 4.5), (colour, 2.25)] {
            self.stroke(&[corners[0], corners[2]], colour, width)?;
            self.stroke(&[corners[1], corners[3]], colour, width)?;
        }
        Ok(())
    }

    /// A line of text, centred vertically on `at` (px).
    pub(super) fn text(
        &self,
        text: &str,
        at: (i32, i32),
        size: i32,
        ink: Rgb,
        anchor: Anchor,
    ) -> Drawn {
        self.write(text, at, size, ink, anchor, FontStyle::Normal)
    }

    /// A bold line of text, beginning at `at` (px).
    pub(super) fn bold(&self, text: &str, at: (i32, i32), size: i32, ink: Rgb) -> Drawn {
        self.write(text, at, size, ink, Anchor::Left, FontStyle::Bold)
    }

    fn write(
        &self,
        text: &str,
        at: (i32, i32),
        size: i32,
        [r, g, b]: Rgb,
        anchor: Anchor,
        weight: FontStyle,
    ) -> Drawn {
        let horizontal = match anchor {
            Anchor::Left => HPos::Left,
            Anchor::Middle => HPos::Center,
            Anchor::Right => HPos::Right,
        };
        let ink = RGBColor(r, g, b);
        // plotters divides font sizes by 1.24.
        let font = FontDesc::new(
            FontFamily::Name(FONT),
            f64::from(size * UNIT) * 1.24,
            weight,
        );
        let style = TextStyle::from(font)
            .color(&ink)
            .pos(Pos::new(horizontal, VPos::Center));
        let at = (Self::units(at.0), Self::units(at.1));
        Ok(self.area.draw(&Text::new(printable(text), at, style))?)
    }

    /// The `<svg>` element that plotters wrote, with our own opening tag: scalable, named for
    /// screen readers, round line ends.
    pub(super) fn finish(svg: &str, height: i32, title: &str) -> String {
        let body = svg.split_once('>').map_or("", |(_, body)| body);
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"{height}\" \
             viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\" stroke-linejoin=\"round\" \
             stroke-linecap=\"round\">{body}",
            WIDTH * UNIT,
            height * UNIT,
            escape(title),
        )
    }
}

/// Without control characters, which XML forbids; plotters escapes the rest.
fn printable(text: &str) -> String {
    text.chars()
        .map(|letter| {
            if letter.is_control() {
                '\u{fffd}'
            } else {
                letter
            }
        })
        .collect()
}

/// About how wide (px) `text` is in a sans-serif font of `size` (px), rather too wide than too
/// narrow: fonts differ.
pub fn text_width(text: &str, size: i32) -> i32 {
    let em: f64 = text
        .chars()
        .map(|letter| match letter {
            'i' | 'l' | 'j' | 't' | 'f' | '.' | ',' | ':' | ';' | '\'' | '|' | '!' | ' ' | '('
            | ')' => 0.38,
            'm' | 'w' | 'M' | 'W' | '@' | '%' | '→' => 0.95,
            'A'..='Z' | '0'..='9' | '=' | '+' | '<' | '>' | '−' => 0.66,
            _ => 0.61,
        })
        .sum();
    (em * f64::from(size)).ceil() as i32
}

/// `text` in lines at most about `width` px wide, broken at blanks, and inside words only where a
/// single word is longer.
pub fn wrap(text: &str, size: i32, width: i32) -> Vec<String> {
    let mut lines = Vec::new();
    let mut line = String::new();
    for word in text.split_whitespace() {
        let blank = if line.is_empty() { "" } else { " " };
        if !line.is_empty() && text_width(&format!("{line} {word}"), size) > width {
            lines.push(std::mem::take(&mut line));
        } else {
            line += blank;
        }
        let too_long = text_width(word, size) > width;
        for letter in word.chars() {
            if too_long && text_width(&line, size) + size > width {
                lines.push(std::mem::take(&mut line));
            }
            line.push(letter);
        }
    }
    if !line.is_empty() {
        lines.push(line);
    }
    lines
}

//! The shapes of a plot as SVG: lines, markers, texts with anchors.

use super::html::escape;
use super::palette::{Look, Marker, Rgb};
use std::fmt::Write;

/// Width of every figure (px): two stand beside each other on a page, and a telephone shows one without shrinking its
/// letters to nothing.
pub const WIDTH: i32 = 480;
/// Distance of two lines of a legend (px).
pub(super) const LINE: i32 = 18;
const FONT: &str = "system-ui, -apple-system, 'Segoe UI', Roboto, 'DejaVu Sans', sans-serif";
const WHITE: Rgb = [255; 3];

/// A place on the canvas (px), from the left and from the top.
pub(super) type Point = (f64, f64);

/// An SVG element that is being written.
pub(super) struct Canvas(String);

fn hex([r, g, b]: Rgb) -> String {
    format!("#{r:02X}{g:02X}{b:02X}")
}

/// To hundredths of a pixel.
fn listed(path: &[Point]) -> String {
    let near = |x: f64| (100.0 * x).round() / 100.0;
    let points = path
        .iter()
        .map(|&(x, y)| format!("{},{} ", near(x), near(y)));
    points.collect()
}

impl Canvas {
    /// A white canvas of a height (px), scalable and named for screen readers, with round line ends.
    pub(super) fn new(height: i32, title: &str) -> Self {
        Self(format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"{height}\" \
             viewBox=\"0 0 {WIDTH} {height}\" role=\"img\" aria-label=\"{}\" stroke-linejoin=\"round\" \
             stroke-linecap=\"round\" font-family=\"{}\">\n\
             <rect width=\"{WIDTH}\" height=\"{height}\" fill=\"#FFFFFF\"/>\n",
            escape(title),
            escape(FONT),
        ))
    }

    pub(super) fn finish(self) -> String {
        self.0 + "</svg>\n"
    }

    /// A path, `width` (px) wide.
    pub(super) fn stroke(&mut self, path: &[Point], colour: Rgb, width: f64) {
        self.polyline(path, colour, width, "");
    }

    /// A dashed path, `width` (px) wide, in one of four patterns.
    pub(super) fn dashes(&mut self, path: &[Point], colour: Rgb, width: f64, pattern: usize) {
        let (dash, gap) = [(7, 4), (2, 4), (14, 5), (4, 9)][pattern % 4];
        let dashes = format!(" stroke-dasharray=\"{dash} {gap}\"");
        self.polyline(path, colour, width, &dashes);
    }

    fn polyline(&mut self, path: &[Point], colour: Rgb, width: f64, dashes: &str) {
        if path.len() > 1 {
            let (colour, points) = (hex(colour), listed(path));
            // Writing to a string cannot fail.
            let _ = writeln!(
                self.0,
                "<polyline fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\"{dashes} points=\"{points}\"/>"
            );
        }
    }

    /// A marker around a point, `size` times the usual one. A white rim sets it off from lines below.
    pub(super) fn marker(&mut self, (x, y): Point, look: Look, size: f64) {
        let radius = 4.4 * size;
        let corners = |count: usize, turn: f64, radii: [f64; 2]| -> Vec<Point> {
            let corner = |i| {
                let angle = std::f64::consts::TAU * (i as f64 / count as f64 + turn);
                let r = radius * radii[i % 2];
                (x + r * angle.cos(), y + r * angle.sin())
            };
            (0..count).map(corner).collect()
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
        let (fill, rim, width) = match look.hollow {
            true => (WHITE, look.colour, "1.75"),
            // The rim below what is filled.
            false => (look.colour, WHITE, "2\" paint-order=\"stroke"),
        };
        let (fill, rim, points) = (hex(fill), hex(rim), listed(&outline));
        let _ = writeln!(
            self.0,
            "<polygon fill=\"{fill}\" stroke=\"{rim}\" stroke-width=\"{width}\" points=\"{points}\"/>"
        );
    }

    /// The two diagonals of four corners.
    fn strokes(&mut self, corners: &[Point], colour: Rgb) {
        for (colour, width) in [(WHITE, 4.5), (colour, 2.25)] {
            self.stroke(&[corners[0], corners[2]], colour, width);
            self.stroke(&[corners[1], corners[3]], colour, width);
        }
    }

    /// A line of text, centred vertically on `at` (px), which is its `start`, `middle` or `end`.
    pub(super) fn text(&mut self, text: &str, at: (i32, i32), size: i32, ink: Rgb, anchor: &str) {
        self.write(text, at, size, ink, &format!("text-anchor=\"{anchor}\""));
    }

    /// A bold line of text, beginning at `at` (px).
    pub(super) fn bold(&mut self, text: &str, at: (i32, i32), size: i32, ink: Rgb) {
        self.write(text, at, size, ink, "font-weight=\"bold\"");
    }

    fn write(&mut self, text: &str, (x, y): (i32, i32), size: i32, ink: Rgb, look: &str) {
        let (ink, text) = (hex(ink), escape(text));
        let _ = writeln!(
            self.0,
            "<text x=\"{x}\" y=\"{y}\" dy=\"0.5ex\" font-size=\"{size}\" fill=\"{ink}\" {look}>{text}</text>"
        );
    }
}

/// About how wide (px) `text` is in a sans-serif font of `size` (px), rather too wide than too
/// narrow: fonts differ.
pub fn text_width(text: &str, size: i32) -> i32 {
    let em = |letter| match letter {
        'i' | 'l' | 'j' | 't' | 'f' | '.' | ',' | ':' | ';' | '\'' | '|' | '!' | ' ' | '('
        | ')' => 0.38,
        'm' | 'w' | 'M' | 'W' | '@' | '%' | '→' => 0.95,
        'A'..='Z' | '0'..='9' | '=' | '+' | '<' | '>' | '−' => 0.66,
        _ => 0.61,
    };
    (text.chars().map(em).sum::<f64>() * f64::from(size)).ceil() as i32
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

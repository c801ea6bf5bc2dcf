//! Where everything in a plot stands: title, axes, data, legend in two columns below the data, note below that.

use super::canvas::{Canvas, LINE, Point, WIDTH, text_width, wrap};
use super::palette::{GRID, INK, Look, Marker, SOFT_INK, mix};
use super::plot::{Plot, Series, Style};
use super::scale::{Ticks, ticks};

/// Height of the data area (px).
const PLOT_HEIGHT: i32 = 300;
/// Length of the line sample in the legend (px).
const SAMPLE: i32 = 30;
/// Distance of the two columns of the legend (px).
const COLUMN: i32 = (WIDTH - 40) / 2;

/// Distance of two lines of a title (px).
const TITLE_LINE: i32 = 22;

/// A curve reduced to what can be shown.
pub(super) struct Curve<'a> {
    series: &'a Series,
    look: Look,
    /// Which dashes a closed form has.
    pattern: usize,
    /// Runs of points between points that cannot be shown, as places.
    runs: Vec<Vec<(f64, f64)>>,
}

impl<'a> Curve<'a> {
    /// A curve with the given look, or else in ink; the `pattern`-th closed form of its plot,
    /// counted from one.
    pub(super) fn new(
        series: &'a Series,
        look: Option<Look>,
        pattern: usize,
        runs: Vec<Vec<(f64, f64)>>,
    ) -> Self {
        let ink = Look {
            colour: INK,
            marker: Marker::Circle,
            hollow: true,
        };
        Self {
            series,
            look: look.unwrap_or(ink),
            pattern: pattern.saturating_sub(1),
            runs,
        }
    }
}

/// Where everything stands (px).
pub(super) struct Layout<'a> {
    plot: &'a Plot,
    title: Vec<String>,
    x_label: Vec<String>,
    y_label: Vec<String>,
    note: Vec<String>,
    legend: Vec<Vec<String>>,
    /// For each curve, the later ones that lie on it.
    covers: Vec<Vec<usize>>,
    x_range: (f64, f64),
    y_range: (f64, f64),
    x_ticks: Ticks,
    y_ticks: Ticks,
    left: i32,
    right: i32,
    top: i32,
    bottom: i32,
    /// Where the legend begins.
    below: i32,
    height: i32,
}

impl<'a> Layout<'a> {
    pub(super) fn new(plot: &'a Plot, curves: &[Curve<'_>], note: &str) -> Self {
        let points = || curves.iter().flat_map(|c| c.runs.iter().flatten());
        let x_range = plot.x.places(points().map(|p| p.0));
        let y_range = plot.y.places(points().map(|p| p.1));
        let widest = |texts: &mut dyn Iterator<Item = &String>, size| {
            texts.map(|t| text_width(t, size)).max().unwrap_or(0)
        };
        let y_ticks = ticks(plot.y.scale, y_range, 8);
        let left = 26 + widest(&mut y_ticks.labelled.iter().map(|(_, text)| text), 13).max(24);
        let labels = curves.iter().map(|c| &c.series.label);
        let legend = labels.map(|label| wrap(label, 13, COLUMN - SAMPLE - 20));
        let legend: Vec<_> = legend.collect();
        let right = WIDTH - 24;
        let x_ticks = ticks(plot.x.scale, x_range, 5);
        // Bold letters are wider.
        let title = wrap(&plot.title, 16, WIDTH - 80);
        let pixels = [
            f64::from(right - left) / (x_range.1 - x_range.0),
            f64::from(PLOT_HEIGHT) / (y_range.1 - y_range.0),
        ];
        let covers = covers(curves, pixels);
        let note = [note, &say_covers(curves, &covers)].join("\n");
        let note = note
            .trim()
            .lines()
            .flat_map(|line| wrap(line, 12, WIDTH - 40));
        let note: Vec<String> = note.collect();
        let [x_label, y_label] = [&plot.x, &plot.y].map(|axis| wrap(&axis.label, 13, WIDTH - 40));
        let top = 32 + TITLE_LINE * title.len() as i32 + LINE * y_label.len() as i32;
        let bottom = top + PLOT_HEIGHT;
        let legend_height: i32 = legend.chunks(2).map(row_height).sum();
        let note_height = if note.is_empty() {
            0
        } else {
            10 + 17 * note.len() as i32
        };
        let below = bottom + 44 + LINE * x_label.len() as i32;
        let height = below + legend_height + note_height;
        Self {
            plot,
            title,
            x_label,
            y_label,
            note,
            legend,
            covers,
            x_range,
            y_range,
            x_ticks,
            y_ticks,
            left,
            right,
            top,
            bottom,
            below,
            height,
        }
    }

    /// Where a place stands (px), to a quarter of a pixel: what is nearer together is one point.
    fn at(&self, x: f64, y: f64) -> Point {
        let quarter = |x: f64| (4.0 * x).round() / 4.0;
        let share = |value: f64, (low, high): (f64, f64)| (value - low) / (high - low);
        let (left, right) = (f64::from(self.left), f64::from(self.right));
        let (top, bottom) = (f64::from(self.top), f64::from(self.bottom));
        let (right, up) = (
            share(x, self.x_range) * (right - left),
            share(y, self.y_range) * (bottom - top),
        );
        (quarter(left + right), quarter(bottom - up))
    }

    pub(super) fn draw(&self, curves: &[Curve<'_>]) -> String {
        let mut canvas = Canvas::new(self.height, &self.plot.title);
        self.frame(&mut canvas);
        self.axes(&mut canvas);
        // Closed forms over the lines, where a line on the same path would hide them, and below the markers.
        let both = curves.iter().zip(&self.covers);
        let (exact, measured): (Vec<_>, Vec<_>) =
            both.partition(|(c, _)| c.series.style == Style::ExactCurve);
        let path = |run: &Vec<(f64, f64)>| {
            let mut path: Vec<Point> = run.iter().map(|&(x, y)| self.at(x, y)).collect();
            path.dedup();
            path
        };
        for (curve, _) in measured.iter().chain(&exact) {
            for run in &curve.runs {
                draw_line(&mut canvas, curve, &path(run));
            }
        }
        for (curve, covers) in exact.iter().chain(&measured) {
            for run in &curve.runs {
                draw_markers(&mut canvas, curve, &path(run), covers.len());
            }
        }
        if curves.iter().all(|c| c.runs.is_empty()) {
            let middle = ((self.left + self.right) / 2, (self.top + self.bottom) / 2);
            canvas.text("no data", middle, 15, SOFT_INK, "middle");
        }
        self.legend(&mut canvas, curves);
        canvas.finish()
    }

    /// Title, axis labels and note.
    fn frame(&self, canvas: &mut Canvas) {
        for (i, line) in self.title.iter().enumerate() {
            canvas.bold(line, (20, 26 + TITLE_LINE * i as i32), 16, INK);
        }
        for (i, line) in self.y_label.iter().rev().enumerate() {
            let y = self.top - 19 - LINE * i as i32;
            canvas.text(line, (20, y), 13, INK, "start");
        }
        for (i, line) in self.x_label.iter().enumerate() {
            // In the middle of the data, unless it is too long for that.
            let half = text_width(line, 13) / 2;
            let middle = ((self.left + self.right) / 2).min(WIDTH - 10 - half);
            let at = (middle, self.bottom + 43 + LINE * i as i32);
            canvas.text(line, at, 13, INK, "middle");
        }
        for (i, line) in self.note.iter().enumerate() {
            let y = self.height - 17 * (self.note.len() - i) as i32;
            canvas.text(line, (20, y), 12, SOFT_INK, "start");
        }
    }

    /// Grid, border and ticks.
    fn axes(&self, canvas: &mut Canvas) {
        let at = |x: f64, y: f64| self.at(x, y);
        let ((x0, x1), (y0, y1)) = (self.x_range, self.y_range);
        let faint = mix(GRID, [255; 3], 0.6);
        for &x in &self.x_ticks.minor {
            canvas.stroke(&[at(x, y0), at(x, y1)], faint, 1.0);
        }
        for &y in &self.y_ticks.minor {
            canvas.stroke(&[at(x0, y), at(x1, y)], faint, 1.0);
        }
        let mut last = i32::MIN;
        for (x, text) in &self.x_ticks.labelled {
            canvas.stroke(&[at(*x, y0), at(*x, y1)], GRID, 1.0);
            let (centre, half) = (at(*x, y0).0.round() as i32, text_width(text, 13) / 2);
            // Neighbours of a logarithmic axis may stand too close for their texts.
            if centre - half > last {
                let at = (centre, self.bottom + 17);
                canvas.text(text, at, 13, SOFT_INK, "middle");
                last = centre + half + 6;
            }
        }
        let mut last = i32::MAX;
        for (y, text) in &self.y_ticks.labelled {
            canvas.stroke(&[at(x0, *y), at(x1, *y)], GRID, 1.0);
            let centre = at(x0, *y).1.round() as i32;
            if centre + 15 < last {
                canvas.text(text, (self.left - 9, centre), 13, SOFT_INK, "end");
                last = centre;
            }
        }
        let border = [at(x0, y1), at(x0, y0), at(x1, y0)];
        canvas.stroke(&border, mix(SOFT_INK, [255; 3], 0.3), 1.25);
    }

    fn legend(&self, canvas: &mut Canvas, curves: &[Curve<'_>]) {
        let mut y = self.below + 8;
        for (curves, texts) in curves.chunks(2).zip(self.legend.chunks(2)) {
            for (column, (curve, lines)) in curves.iter().zip(texts).enumerate() {
                let left = 20 + COLUMN * column as i32;
                let end = |x: i32| (f64::from(x), f64::from(y));
                draw_line(canvas, curve, &[end(left), end(left + SAMPLE)]);
                if matches!(curve.series.style, Style::Points | Style::LinePoints) {
                    canvas.marker(end(left + SAMPLE / 2), curve.look, 1.0);
                }
                let ink = mix(INK, [255; 3], if curve.runs.is_empty() { 0.5 } else { 0.0 });
                for (i, line) in lines.iter().enumerate() {
                    let at = (left + SAMPLE + 8, y + LINE * i as i32);
                    canvas.text(line, at, 13, ink, "start");
                }
            }
            y += row_height(texts);
        }
    }
}

/// Height of a row of the legend (px), with the lines of its labels.
fn row_height(labels: &[Vec<String>]) -> i32 {
    let lines = labels.iter().map(Vec::len).max().unwrap_or(0);
    lines as i32 * LINE + 4
}

/// For each measured curve, the later measured curves that hide all of it: that have a point
/// within 1.5 px of each of its points. `pixels` are those per place, across and up.
fn covers(curves: &[Curve<'_>], pixels: [f64; 2]) -> Vec<Vec<usize>> {
    let measured = |c: &Curve<'_>| c.series.style != Style::ExactCurve && !c.runs.is_empty();
    let hides = |below: &Curve<'_>, above: &Curve<'_>| {
        let mut others = above.runs.iter().flatten();
        measured(below)
            && measured(above)
            && below.runs.iter().flatten().all(|p| {
                others.next().is_some_and(|q| {
                    let (x, y) = (pixels[0] * (p.0 - q.0), pixels[1] * (p.1 - q.1));
                    x.hypot(y) < 1.5
                })
            })
    };
    (0..curves.len())
        .map(|i| {
            let later = i + 1..curves.len();
            later.filter(|&j| hides(&curves[i], &curves[j])).collect()
        })
        .collect()
}

/// `On one another: pbd, xpbd under pd.`
fn say_covers(curves: &[Curve<'_>], covers: &[Vec<usize>]) -> String {
    let label = |i: usize| curves[i].series.label.as_str();
    let below = |top: usize| {
        let hidden = (0..top).filter(|&i| covers[i].last() == Some(&top));
        hidden.map(label).collect::<Vec<_>>()
    };
    let groups: Vec<_> = (0..curves.len())
        .filter(|&top| !below(top).is_empty())
        .map(|top| format!("{} under {}", below(top).join(", "), label(top)))
        .collect();
    if groups.is_empty() {
        String::new()
    } else {
        format!("On one another: {}.", groups.join("; "))
    }
}

fn draw_line(canvas: &mut Canvas, curve: &Curve<'_>, path: &[Point]) {
    let colour = curve.look.colour;
    match curve.series.style {
        Style::Points => {}
        Style::Line | Style::LinePoints => canvas.stroke(path, colour, 2.0),
        Style::ExactCurve => canvas.dashes(path, mix(colour, [0; 3], 0.25), 1.75, curve.pattern),
    }
}

/// Markers along a path, larger where later curves cover this one, so that all show.
fn draw_markers(canvas: &mut Canvas, curve: &Curve<'_>, path: &[Point], covers: usize) {
    let size = 1.0 + 0.45 * covers.min(4) as f64;
    // A run of one point has no line.
    let lonely = path.len() == 1;
    let stride = match curve.series.style {
        Style::Points => 1,
        // First and last point always carry a marker.
        Style::LinePoints => path.len().div_ceil(24).max(1),
        _ if lonely => 1,
        _ => return,
    };
    for (i, &point) in path.iter().enumerate() {
        if i.is_multiple_of(stride) || i + 1 == path.len() {
            canvas.marker(point, curve.look, size);
        }
    }
}

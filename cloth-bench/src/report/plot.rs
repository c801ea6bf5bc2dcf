//! Plots: curves over linear or logarithmic axes, as SVG.
//!
//! plotters maps data to the canvas and writes the shapes; the layout around them is ours. The
//! legend stands beside the data, never on it. What an axis cannot show (a zero on a logarithmic
//! axis, a `NaN` anywhere) is left out, counted, and said below the plot.

use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

use super::canvas::{Anchor, Canvas, LINE, WIDTH, text_width, wrap};
use super::palette::{GRID, INK, Look, SOFT_INK, looks, mix};
use super::scale::{Scale, Ticks, range, ticks};

/// What an axis measures.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Axis {
    /// The quantity with its unit in round brackets: `time (s)`.
    pub label: String,
    /// How values are laid out.
    pub scale: Scale,
    /// Shows only this range, in the unit of the axis; `None` shows every point.
    pub range: Option<(f64, f64)>,
}

impl Axis {
    /// An axis with evenly spaced values.
    #[must_use]
    pub fn linear(label: &str) -> Self {
        Self {
            label: label.to_owned(),
            scale: Scale::Linear,
            range: None,
        }
    }

    /// An axis by decimal logarithm.
    #[must_use]
    pub fn log(label: &str) -> Self {
        Self {
            label: label.to_owned(),
            scale: Scale::Log,
            range: None,
        }
    }

    /// Shows only `low` to `high` (in the unit of the axis). Points outside are counted in the
    /// note, not drawn at the border.
    #[must_use]
    pub fn within(mut self, low: f64, high: f64) -> Self {
        self.range = Some((low, high));
        self
    }

    /// Why `value` cannot be shown, if it cannot.
    fn refuses(&self, value: f64) -> Option<Absence> {
        if !value.is_finite() || value.abs() > 1e290 {
            Some(Absence::NotFinite)
        } else if self.scale == Scale::Log && value == 0.0 {
            Some(Absence::Zero)
        } else if self.scale == Scale::Log && value < 0.0 {
            Some(Absence::Negative)
        } else {
            let outside = |(low, high)| value < low || value > high;
            self.range.is_some_and(outside).then_some(Absence::Outside)
        }
    }

    /// The range of places to show, given the places of the points.
    fn places(&self, of_points: impl Iterator<Item = f64>) -> (f64, f64) {
        let given = self
            .range
            .map(|(low, high)| (self.scale.place(low), self.scale.place(high)));
        let usable = |&(low, high): &(f64, f64)| low.is_finite() && high.is_finite() && low < high;
        given
            .filter(usable)
            .unwrap_or_else(|| range(self.scale, of_points))
    }
}

/// Why a point is not in the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Absence {
    Zero,
    Negative,
    NotFinite,
    Outside,
}

impl Absence {
    const ALL: [(Self, &'static str); 4] = [
        (Self::Zero, "at zero"),
        (Self::Negative, "below zero"),
        (Self::NotFinite, "not finite"),
        (Self::Outside, "outside the range shown"),
    ];
}

/// How a series is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Style {
    /// A line through the points, without markers.
    Line,
    /// Markers only.
    Points,
    /// A line with markers; of many points only some are marked.
    #[default]
    LinePoints,
    /// A dashed line through the points, below all data: a closed form, a reference, a guide.
    ExactCurve,
}

/// One curve.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Series {
    /// Its name in the legend. The leading method name (`xpbd` in `xpbd, 4 substeps`) chooses the
    /// colour.
    pub label: String,
    /// Points (x, y) in the units of the axes, in the order in which the line connects them.
    pub points: Vec<(f64, f64)>,
    /// How it is drawn.
    pub style: Style,
}

impl Series {
    /// A line with markers.
    #[must_use]
    pub fn new(label: &str, points: Vec<(f64, f64)>) -> Self {
        Self {
            label: label.to_owned(),
            points,
            style: Style::LinePoints,
        }
    }

    /// The same series in another style.
    #[must_use]
    pub fn styled(mut self, style: Style) -> Self {
        self.style = style;
        self
    }
}

/// A figure: axes, curves, a title and a remark.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Plot {
    /// What the figure shows.
    pub title: String,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// The curves, in the order of the legend.
    pub series: Vec<Series>,
    /// A remark below the figure; may be empty.
    pub note: String,
}

/// A drawn [`Plot`].
#[derive(Debug, Clone, PartialEq)]
pub struct Drawing {
    /// A self-contained `<svg>` element that scales with its container.
    pub svg: String,
    /// How many points could not be shown; the figure says so as well.
    pub dropped: usize,
}

/// Height of the data area (px).
const PLOT_HEIGHT: i32 = 340;
/// Length of the line sample in the legend (px).
const SAMPLE: i32 = 34;

/// A curve reduced to what can be shown.
struct Curve<'a> {
    series: &'a Series,
    look: Look,
    /// Runs of points between points that cannot be shown, as places.
    runs: Vec<Vec<(f64, f64)>>,
}

impl Plot {
    /// Draws the figure.
    ///
    /// # Panics
    /// Never in practice: it writes to a string, which cannot fail.
    #[must_use]
    pub fn draw(&self) -> Drawing {
        let labels: Vec<&str> = self.series.iter().map(|s| s.label.as_str()).collect();
        let mut absent = Vec::new();
        let mut curves = Vec::new();
        for ((index, series), look) in self.series.iter().enumerate().zip(looks(&labels)) {
            let mut runs = vec![Vec::new()];
            for &(x, y) in &series.points {
                match self.x.refuses(x).or_else(|| self.y.refuses(y)) {
                    Some(absence) => {
                        absent.push((absence, index));
                        runs.push(Vec::new());
                    }
                    None => {
                        let place = (self.x.scale.place(x), self.y.scale.place(y));
                        runs.last_mut().expect("one run at least").push(place);
                    }
                }
            }
            runs.retain(|run| !run.is_empty());
            curves.push(Curve { series, look, runs });
        }
        let note = [self.note.clone(), self.say_absent(&absent)].join("\n");
        let svg = Layout::new(self, &curves, note.trim())
            .draw(&curves)
            .expect("writing to a string cannot fail");
        Drawing {
            svg,
            dropped: absent.len(),
        }
    }

    /// `Not shown: 3 points at zero (xpbd 2, pd 1), 1 point not finite (pbd).`
    fn say_absent(&self, absent: &[(Absence, usize)]) -> String {
        let mut parts = Vec::new();
        for (kind, words) in Absence::ALL {
            let count_in = |series| absent.iter().filter(|&&a| a == (kind, series)).count();
            let counts: Vec<_> = (0..self.series.len()).map(count_in).collect();
            let total: usize = counts.iter().sum();
            let named = self
                .series
                .iter()
                .zip(&counts)
                .filter(|(_, count)| **count > 0);
            let named: Vec<_> = named
                .map(|(s, count)| format!("{} {count}", s.label))
                .collect();
            if total > 0 {
                let points = if total == 1 { "point" } else { "points" };
                parts.push(format!("{total} {points} {words} ({})", named.join(", ")));
            }
        }
        if parts.is_empty() {
            String::new()
        } else {
            format!("Not shown: {}.", parts.join("; "))
        }
    }
}

/// Where everything stands (px).
struct Layout<'a> {
    plot: &'a Plot,
    title: Vec<String>,
    note: Vec<String>,
    legend: Vec<Vec<String>>,
    x_range: (f64, f64),
    y_range: (f64, f64),
    x_ticks: Ticks,
    y_ticks: Ticks,
    left: i32,
    right: i32,
    top: i32,
    bottom: i32,
    height: i32,
}

impl<'a> Layout<'a> {
    fn new(plot: &'a Plot, curves: &[Curve<'_>], note: &str) -> Self {
        let points = || curves.iter().flat_map(|c| c.runs.iter().flatten());
        let x_range = plot.x.places(points().map(|p| p.0));
        let y_range = plot.y.places(points().map(|p| p.1));
        let widest = |texts: &mut dyn Iterator<Item = &String>, size| {
            texts.map(|t| text_width(t, size)).max().unwrap_or(0)
        };
        let y_ticks = ticks(plot.y.scale, y_range, 8);
        let left = 26 + widest(&mut y_ticks.labelled.iter().map(|(_, text)| text), 13).max(24);
        let legend: Vec<_> = curves
            .iter()
            .map(|c| wrap(&c.series.label, 13, 190))
            .collect();
        let column = widest(&mut legend.iter().flatten(), 13);
        let right = WIDTH
            - if legend.is_empty() {
                24
            } else {
                24 + SAMPLE + 10 + column + 14
            };
        let x_ticks = ticks(plot.x.scale, x_range, 8);
        let title = wrap(&plot.title, 18, WIDTH - 40);
        let note: Vec<_> = note.lines().flat_map(|l| wrap(l, 12, WIDTH - 40)).collect();
        let top = 20 + 24 * title.len() as i32 + 30;
        let legend_height = legend
            .iter()
            .map(|l| l.len() as i32 * LINE + 5)
            .sum::<i32>();
        let bottom = top + PLOT_HEIGHT.max(legend_height);
        let note_height = if note.is_empty() {
            0
        } else {
            10 + note.len() as i32 * 17
        };
        let height = bottom + 62 + note_height;
        Self {
            plot,
            title,
            note,
            legend,
            x_range,
            y_range,
            x_ticks,
            y_ticks,
            left,
            right,
            top,
            bottom,
            height,
        }
    }

    fn draw(&self, curves: &[Curve<'_>]) -> Result<String, Box<dyn std::error::Error>> {
        let mut svg = String::new();
        {
            let backend = SVGBackend::with_string(&mut svg, Canvas::size(self.height));
            let area = backend.into_drawing_area();
            let canvas = Canvas::new(area);
            self.frame(&canvas)?;
            let pixels = |a: i32, b: i32| Canvas::units(a)..Canvas::units(b);
            let data = canvas.area().clone().apply_coord_spec(Cartesian2d::<
                RangedCoordf64,
                RangedCoordf64,
            >::new(
                self.x_range.0..self.x_range.1,
                self.y_range.0..self.y_range.1,
                (pixels(self.left, self.right), pixels(self.bottom, self.top)),
            ));
            let to_canvas = |place: &(f64, f64)| data.map_coordinate(place);
            self.axes(&canvas, &|x, y| to_canvas(&(x, y)))?;
            // Closed forms below, data above.
            let (exact, measured): (Vec<_>, Vec<_>) = curves
                .iter()
                .partition(|c| c.series.style == Style::ExactCurve);
            for curve in exact.into_iter().chain(measured) {
                for run in &curve.runs {
                    let mut path: Vec<_> = run.iter().map(to_canvas).collect();
                    path.dedup();
                    draw_curve(&canvas, curve, &path)?;
                }
            }
            if curves.iter().all(|c| c.runs.is_empty()) {
                let middle = ((self.left + self.right) / 2, (self.top + self.bottom) / 2);
                canvas.text("no data", middle, 15, SOFT_INK, Anchor::Middle)?;
            }
            self.legend(&canvas, curves)?;
            canvas.area().present()?;
        }
        Ok(Canvas::finish(&svg, self.height, &self.plot.title))
    }

    /// Background, title, axis labels and note.
    fn frame(&self, canvas: &Canvas<'_>) -> super::canvas::Drawn {
        canvas.rectangle((0, 0), (WIDTH, self.height), [255; 3])?;
        for (i, line) in self.title.iter().enumerate() {
            canvas.bold(line, (20, 26 + 24 * i as i32), 18, INK)?;
        }
        canvas.text(
            &self.plot.y.label,
            (20, self.top - 19),
            13,
            INK,
            Anchor::Left,
        )?;
        let below = ((self.left + self.right) / 2, self.bottom + 43);
        canvas.text(&self.plot.x.label, below, 13, INK, Anchor::Middle)?;
        for (i, line) in self.note.iter().enumerate() {
            let y = self.bottom + 72 + 17 * i as i32;
            canvas.text(line, (20, y), 12, SOFT_INK, Anchor::Left)?;
        }
        Ok(())
    }

    /// Grid, border and ticks.
    fn axes(
        &self,
        canvas: &Canvas<'_>,
        at: &dyn Fn(f64, f64) -> (i32, i32),
    ) -> super::canvas::Drawn {
        let ((x0, x1), (y0, y1)) = (self.x_range, self.y_range);
        let faint = mix(GRID, [255; 3], 0.6);
        for &x in &self.x_ticks.minor {
            canvas.stroke(&[at(x, y0), at(x, y1)], faint, 1.0)?;
        }
        for &y in &self.y_ticks.minor {
            canvas.stroke(&[at(x0, y), at(x1, y)], faint, 1.0)?;
        }
        let mut last = i32::MIN;
        for (x, text) in &self.x_ticks.labelled {
            canvas.stroke(&[at(*x, y0), at(*x, y1)], GRID, 1.0)?;
            let (centre, half) = (Canvas::pixels(at(*x, y0).0), text_width(text, 13) / 2);
            // Neighbours of a logarithmic axis may stand too close for their texts.
            if centre - half > last {
                canvas.text(
                    text,
                    (centre, self.bottom + 17),
                    13,
                    SOFT_INK,
                    Anchor::Middle,
                )?;
                last = centre + half + 6;
            }
        }
        let mut last = i32::MAX;
        for (y, text) in &self.y_ticks.labelled {
            canvas.stroke(&[at(x0, *y), at(x1, *y)], GRID, 1.0)?;
            let centre = Canvas::pixels(at(x0, *y).1);
            if centre + 15 < last {
                canvas.text(text, (self.left - 9, centre), 13, SOFT_INK, Anchor::Right)?;
                last = centre;
            }
        }
        canvas.stroke(
            &[at(x0, y1), at(x0, y0), at(x1, y0)],
            mix(SOFT_INK, [255; 3], 0.3),
            1.25,
        )
    }

    fn legend(&self, canvas: &Canvas<'_>, curves: &[Curve<'_>]) -> super::canvas::Drawn {
        let left = self.right + 24;
        let mut y = self.top + 8;
        for (curve, lines) in curves.iter().zip(&self.legend) {
            let end = |x: i32| (Canvas::units(x), Canvas::units(y));
            let sample = Curve {
                series: curve.series,
                look: curve.look,
                runs: Vec::new(),
            };
            draw_line(canvas, &sample, &[end(left), end(left + SAMPLE)])?;
            if matches!(curve.series.style, Style::Points | Style::LinePoints) {
                canvas.marker(end(left + SAMPLE / 2), curve.look)?;
            }
            let ink = if curve.runs.is_empty() {
                mix(INK, [255; 3], 0.5)
            } else {
                INK
            };
            for line in lines {
                canvas.text(line, (left + SAMPLE + 10, y), 13, ink, Anchor::Left)?;
                y += LINE;
            }
            y += 5;
        }
        Ok(())
    }
}

fn draw_line(canvas: &Canvas<'_>, curve: &Curve<'_>, path: &[(i32, i32)]) -> super::canvas::Drawn {
    match curve.series.style {
        Style::Points => Ok(()),
        Style::Line | Style::LinePoints => canvas.stroke(path, curve.look.colour, 2.0),
        Style::ExactCurve => canvas.dashes(path, mix(curve.look.colour, [0; 3], 0.25), 1.75),
    }
}

fn draw_curve(canvas: &Canvas<'_>, curve: &Curve<'_>, path: &[(i32, i32)]) -> super::canvas::Drawn {
    draw_line(canvas, curve, path)?;
    let lonely = path.len() == 1 && curve.series.style != Style::ExactCurve;
    let stride = match curve.series.style {
        Style::Points => 1,
        // First and last point always carry a marker.
        Style::LinePoints => path.len().div_ceil(24).max(1),
        _ if lonely => 1,
        _ => return Ok(()),
    };
    for (i, &point) in path.iter().enumerate() {
        if i.is_multiple_of(stride) || i + 1 == path.len() {
            canvas.marker(point, curve.look)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::html::assert_well_formed;

    fn plot(scale: Scale, series: Vec<Series>) -> Plot {
        let axis = |label: &str| Axis {
            label: label.into(),
            scale,
            range: None,
        };
        Plot {
            title: "A & B <test>".into(),
            x: axis("x (s)"),
            y: axis("y \"(m)\""),
            series,
            note: String::new(),
        }
    }

    #[test]
    fn svg_is_well_formed_and_scales() {
        let points: Vec<_> = (1..200)
            .map(|i| (f64::from(i), 1.0 / f64::from(i)))
            .collect();
        for scale in [Scale::Linear, Scale::Log] {
            for style in [
                Style::Line,
                Style::Points,
                Style::LinePoints,
                Style::ExactCurve,
            ] {
                let series = ["pd", "xpbd <4>", "exact & more"];
                let series = series.map(|label| Series::new(label, points.clone()).styled(style));
                let drawing = plot(scale, series.into()).draw();
                assert_well_formed(&drawing.svg);
                assert!(drawing.svg.starts_with("<svg ") && drawing.svg.contains("viewBox=\"0 0 "));
                assert!(drawing.svg.contains("A &amp; B &lt;test&gt;"));
                assert_eq!(drawing.dropped, 0);
            }
        }
    }

    #[test]
    fn what_cannot_be_shown_is_counted_and_said() {
        let a = vec![
            (1.0, 1.0),
            (2.0, 0.0),
            (3.0, 0.0),
            (4.0, -1.0),
            (5.0, f64::NAN),
            (0.0, 1.0),
        ];
        let b = vec![(1.0, f64::INFINITY), (2.0, 1.0)];
        let drawing = plot(
            Scale::Log,
            vec![Series::new("pd", a.clone()), Series::new("pbd", b)],
        )
        .draw();
        assert_eq!(drawing.dropped, 6);
        assert!(drawing.svg.contains(
            "3 points at zero (pd 3); 1 point below zero (pd 1); 2 points not finite (pd 1, pbd 1)"
        ));
        let linear = plot(Scale::Linear, vec![Series::new("pd", a.clone())]).draw();
        assert_eq!(linear.dropped, 1);
        let mut cut = plot(Scale::Linear, vec![Series::new("pd", a)]);
        cut.x = cut.x.within(0.0, 2.5);
        assert_eq!(cut.draw().dropped, 3);
    }

    #[test]
    fn a_gap_breaks_the_line() {
        let points = vec![
            (1.0, 1.0),
            (2.0, 2.0),
            (3.0, f64::NAN),
            (4.0, 2.0),
            (5.0, 3.0),
        ];
        let broken = plot(
            Scale::Linear,
            vec![Series::new("pd", points.clone()).styled(Style::Line)],
        )
        .draw()
        .svg;
        let whole = points.into_iter().filter(|p| !p.1.is_nan()).collect();
        let whole = plot(
            Scale::Linear,
            vec![Series::new("pd", whole).styled(Style::Line)],
        )
        .draw()
        .svg;
        assert_eq!(
            broken.matches("<polyline").count(),
            whole.matches("<polyline").count() + 1
        );
    }

    #[test]
    fn nothing_to_show_is_still_a_figure() {
        for scale in [Scale::Linear, Scale::Log] {
            for series in [
                vec![],
                vec![Series::default()],
                vec![Series::new("pd", vec![(0.0, f64::NAN)])],
            ] {
                let drawing = plot(scale, series).draw();
                assert_well_formed(&drawing.svg);
                assert!(drawing.svg.contains("no data"));
            }
        }
    }

    #[test]
    fn degenerate_values_are_drawn() {
        for values in [
            vec![0.0],
            vec![5.0; 4],
            vec![1e-300, 1e300],
            vec![f64::MAX, 5e-324],
            vec![1.0, 1.0 + f64::EPSILON],
        ] {
            for scale in [Scale::Linear, Scale::Log] {
                let points = values.iter().map(|&v| (v, v)).collect();
                assert_well_formed(&plot(scale, vec![Series::new("pd", points)]).draw().svg);
            }
        }
    }

    #[test]
    fn every_label_and_marker_stays_on_the_canvas() {
        let long =
            "xpbd with a very long label that goes on and on and has to be wrapped somewhere";
        let series =
            (0..30).map(|i| Series::new(&format!("{long} {i}"), vec![(1.0, 1.0), (10.0, 1e-9)]));
        let svg = plot(Scale::Log, series.collect()).draw().svg;
        let height: f64 = svg
            .split("height=\"")
            .nth(1)
            .unwrap()
            .split('"')
            .next()
            .unwrap()
            .parse()
            .unwrap();
        for text in svg.split("<text ").skip(1) {
            let value = |name: &str| -> f64 {
                text.split(&format!(" {name}=\""))
                    .nth(1)
                    .or_else(|| text.strip_prefix(&format!("{name}=\"")))
                    .unwrap()
                    .split('"')
                    .next()
                    .unwrap()
                    .parse()
                    .unwrap()
            };
            assert!(
                value("y") / 4.0 < height,
                "{} of {height}",
                value("y") / 4.0
            );
            assert!(value("x") / 4.0 < f64::from(WIDTH));
        }
    }
}

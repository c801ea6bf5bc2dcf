//! Plots: curves over linear or logarithmic axes, as SVG.
//!
//! The legend stands below the data, never on it. What an axis cannot show (a zero on a logarithmic
//! axis, a `NaN` anywhere) is left out, counted, and said below the plot. Curves that lie on one
//! another are named there too, and their markers grow downwards so that each can be seen.

use super::layout::{Curve, Layout};
use super::palette::{Look, exact_look, looks};
use super::scale::{Scale, range};
use itertools::Itertools;

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
    pub fn linear(label: &str) -> Self {
        Self {
            label: label.to_owned(),
            ..Self::default()
        }
    }

    /// An axis by decimal logarithm.
    pub fn log(label: &str) -> Self {
        Self {
            scale: Scale::Log,
            ..Self::linear(label)
        }
    }

    /// Shows only `low` to `high` (in the unit of the axis). Points outside are counted in the
    /// note, not drawn at the border.
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
    pub(super) fn places(&self, of_points: impl Iterator<Item = f64>) -> (f64, f64) {
        let place = |(low, high)| (self.scale.place(low), self.scale.place(high));
        let usable = |&(low, high): &(f64, f64)| low.is_finite() && high.is_finite() && low < high;
        let given = self.range.map(place).filter(usable);
        given.unwrap_or_else(|| range(self.scale, of_points))
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
    /// A dashed line through the points, below the markers: a closed form, a reference, a guide.
    ///
    /// It is black, unless its label begins with the label of a measured series or of a method;
    /// then it has that colour.
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
    pub fn new(label: &str, points: Vec<(f64, f64)>) -> Self {
        Self {
            label: label.to_owned(),
            points,
            style: Style::LinePoints,
        }
    }

    /// The same series in another style.
    pub fn styled(mut self, style: Style) -> Self {
        self.style = style;
        self
    }
}

/// One curve per label, in the order in which the labels come up first, through the points of all rows with that label.
pub fn curves<R, L: Into<String>>(
    rows: impl IntoIterator<Item = R>,
    label_and_point: impl Fn(R) -> (L, (f64, f64)),
) -> Vec<Series> {
    let mut curves: Vec<Series> = Vec::new();
    for row in rows {
        let (label, point) = label_and_point(row);
        let label = label.into();
        match curves.iter_mut().find(|curve| curve.label == label) {
            Some(curve) => curve.points.push(point),
            None => curves.push(Series::new(&label, vec![point])),
        }
    }
    curves
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

impl Plot {
    /// A figure without curves.
    pub fn new(title: impl Into<String>, x: Axis, y: Axis) -> Self {
        Self {
            title: title.into(),
            x,
            y,
            ..Self::default()
        }
    }

    /// With more curves.
    pub fn with(mut self, series: impl IntoIterator<Item = Series>) -> Self {
        self.series.extend(series);
        self
    }

    /// With more curves, drawn as measured points.
    pub fn points(self, series: impl IntoIterator<Item = Series>) -> Self {
        let points = series.into_iter().map(|curve| curve.styled(Style::Points));
        self.with(points)
    }

    /// With a closed form, a reference or a guide.
    pub fn exact(self, label: &str, points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        self.exact_curves([Series::new(label, points.into_iter().collect())])
    }

    /// With several of them.
    pub fn exact_curves(self, series: impl IntoIterator<Item = Series>) -> Self {
        let dashed = series
            .into_iter()
            .map(|curve| curve.styled(Style::ExactCurve));
        self.with(dashed)
    }

    /// With a remark below.
    pub fn note(mut self, note: &str) -> Self {
        note.clone_into(&mut self.note);
        self
    }

    /// Draws the figure.
    pub fn draw(&self) -> Drawing {
        let mut absent = Vec::new();
        let mut curves = Vec::new();
        let measured = self.measured_looks();
        let (mut next, mut pattern) = (measured.iter(), 0);
        for (index, series) in self.series.iter().enumerate() {
            let look = if series.style == Style::ExactCurve {
                pattern += 1;
                exact_look(&series.label, &measured)
            } else {
                next.next().map(|(_, look)| *look)
            };
            let (mut runs, mut run) = (Vec::new(), Vec::new());
            for &(x, y) in &series.points {
                match self.x.refuses(x).or_else(|| self.y.refuses(y)) {
                    Some(absence) => {
                        absent.push((absence, index));
                        runs.push(std::mem::take(&mut run));
                    }
                    None => run.push((self.x.scale.place(x), self.y.scale.place(y))),
                }
            }
            runs.push(run);
            runs.retain(|run| !run.is_empty());
            curves.push(Curve::new(series, look, pattern, runs));
        }
        let note = [self.note.clone(), self.say_absent(&absent)].join("\n");
        Drawing {
            svg: Layout::new(self, &curves, note.trim()).draw(&curves),
            dropped: absent.len(),
        }
    }

    /// Label and look of every series that is not a closed form.
    fn measured_looks(&self) -> Vec<(&str, Look)> {
        let measured = self.series.iter().filter(|s| s.style != Style::ExactCurve);
        let labels: Vec<&str> = measured.map(|s| s.label.as_str()).collect();
        let looks = looks(&labels);
        labels.into_iter().zip(looks).collect()
    }

    /// `Not shown: 3 points at zero (2 of xpbd; 1 of pd), 1 point not finite (1 of pbd).`
    fn say_absent(&self, absent: &[(Absence, usize)]) -> String {
        let mut parts = Vec::new();
        for (kind, words) in Absence::ALL {
            let of = |series| absent.iter().filter(|&&a| a == (kind, series)).count();
            let counts = self
                .series
                .iter()
                .enumerate()
                .map(|(index, s)| (of(index), s));
            let counts: Vec<_> = counts.filter(|(count, _)| *count > 0).collect();
            let points = match counts.iter().map(|(count, _)| count).sum::<usize>() {
                0 => continue,
                1 => "1 point".to_owned(),
                total => format!("{total} points"),
            };
            let mut named = counts
                .iter()
                .map(|(count, s)| format!("{count} of {}", s.label));
            parts.push(format!("{points} {words} ({})", named.join("; ")));
        }
        match parts.is_empty() {
            true => String::new(),
            false => format!("Not shown: {}.", parts.join(", ")),
        }
    }
}

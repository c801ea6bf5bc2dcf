//! Colours and markers, the same for a method in every plot.
//!
//! The colours come from the palettes of Okabe and Ito (<https://jfly.uni-koeln.de/color/>) and
//! of Paul Tol (<https://personal.sron.nl/~pault/>), darkened where a thin line on white would be
//! too faint. They stay apart under the two common colour vision deficiencies (a test simulates
//! both), and markers say the same thing once more.

use crate::method::{self, Method};
use std::sync::LazyLock;

/// Red, green and blue, sRGB, 0 to 255.
pub type Rgb = [u8; 3];

/// Text and axes.
pub const INK: Rgb = [0x22, 0x26, 0x2b];
/// Secondary text: labels of ticks, notes.
pub const SOFT_INK: Rgb = [0x5a, 0x62, 0x6b];
/// Grid lines.
pub const GRID: Rgb = [0xe3, 0xe6, 0xe9];

/// The shape that marks a data point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Marker {
    /// A disk.
    Circle,
    /// A square.
    Square,
    /// A triangle, point up.
    Triangle,
    /// A square on its corner.
    Diamond,
    /// A triangle, point down.
    TriangleDown,
    /// Two crossed strokes, ×.
    Cross,
    /// Two crossed strokes, +.
    Plus,
    /// A five-pointed star.
    Star,
}

/// The markers that have an inside, and so can be filled or hollow.
const MARKERS: [Marker; 6] = [
    Marker::Circle,
    Marker::Square,
    Marker::Triangle,
    Marker::Diamond,
    Marker::TriangleDown,
    Marker::Star,
];

/// A reference that several plots have, beside the methods.
const NEWTON: (&str, Rgb, Marker) = ("newton", [0x33, 0x33, 0x33], Marker::Circle);

/// The methods and the reference with colour and marker.
static KNOWN: LazyLock<Vec<(&str, Rgb, Marker)>> = LazyLock::new(|| {
    let look = |method: &'static Method| {
        let (rgb, marker) = method.look();
        (method.name, rgb, marker)
    };
    method::all().map(look).chain([NEWTON]).collect()
});

/// For labels that do not begin with the name of a method, in order of appearance.
const OTHERS: [(Rgb, Marker); 8] = [
    ([0x00, 0x5f, 0x9e], Marker::Circle),
    ([0xda, 0x61, 0x02], Marker::Square),
    ([0x6f, 0xad, 0x3b], Marker::Triangle),
    ([0x82, 0x23, 0x6e], Marker::Diamond),
    ([0x15, 0xad, 0x99], Marker::TriangleDown),
    ([0x8a, 0x1c, 0x3c], Marker::Cross),
    ([0x63, 0x73, 0x7e], Marker::Plus),
    ([0x65, 0x3d, 0x17], Marker::Star),
];

/// Colour and marker of one series.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Look {
    /// Of line and marker.
    pub colour: Rgb,
    /// At the data points.
    pub marker: Marker,
    /// Whether the marker is drawn as an outline: the second, fourth, … series of one method.
    pub hollow: bool,
}

/// The method that `label` begins with: `xpbd` in `xpbd`, `xpbd, 4 substeps` and `xpbd (exact)`.
fn method(label: &str) -> Option<usize> {
    KNOWN.iter().position(|(name, ..)| {
        label
            .strip_prefix(name)
            .is_some_and(|rest| !rest.starts_with(|c: char| c.is_alphanumeric() || c == '-'))
    })
}

/// The look of each measured series of one plot, from the labels alone.
///
/// A method has its fixed colour. Several series of one method have the same hue, lighter and
/// darker in turn, and differ in marker. Other labels take, in order of appearance, colours that
/// do not resemble those of the methods in the same plot.
pub fn looks(labels: &[&str]) -> Vec<Look> {
    let present: Vec<Rgb> = labels
        .iter()
        .filter_map(|label| method(label))
        .map(|index| KNOWN[index].1)
        .collect();
    let resembles = |other: &Rgb| present.iter().any(|colour| gap(*other, *colour) < 70.0);
    // Those that resemble come last: with many labels it is better to repeat than to run out.
    let (last, first): (Vec<_>, Vec<_>) = OTHERS.iter().partition(|(colour, _)| resembles(colour));
    let others: Vec<_> = first.into_iter().chain(last).collect();
    let mut seen = vec![0; KNOWN.len()];
    let mut other = 0;
    labels
        .iter()
        .map(|label| match method(label) {
            Some(index) => {
                seen[index] += 1;
                variant(index, seen[index] - 1)
            }
            None => {
                let &(colour, marker) = others[other % others.len()];
                let hollow = other >= others.len();
                other += 1;
                Look {
                    colour,
                    marker,
                    hollow,
                }
            }
        })
        .collect()
}

/// The look of a curve in closed form: that of the measured series whose whole label it begins
/// with (`xpbd, 4 substeps, exact`), else that of its method, else `None`, which means ink.
pub fn exact_look(label: &str, measured: &[(&str, Look)]) -> Option<Look> {
    let longest = measured
        .iter()
        .filter(|(other, _)| !other.is_empty() && label.starts_with(other))
        .max_by_key(|(other, _)| other.len());
    let of_method = || method(label).map(|index| variant(index, 0));
    longest.map(|(_, look)| *look).or_else(of_method)
}

/// The look of the `nth` series of one method in one plot.
fn variant(index: usize, nth: u32) -> Look {
    let (_, colour, marker) = KNOWN[index];
    // Every second variant is lighter than the first of its method, the others darker.
    let (towards, share) = match nth {
        0 => (255, 0.0),
        n if n % 2 == 1 => (255, 0.22 + 0.08 * f64::from(n.min(5))),
        n => (0, 0.25 + 0.1 * f64::from(n.min(4))),
    };
    // The first two have the marker of the method, later ones move on in pairs.
    let shape = MARKERS.iter().position(|m| *m == marker).unwrap_or(0);
    let moved = MARKERS[(shape + nth as usize / 2) % MARKERS.len()];
    Look {
        colour: mix(colour, [towards; 3], share),
        marker: if nth < 2 { marker } else { moved },
        hollow: nth % 2 == 1,
    }
}

/// How far apart two colours are in sRGB (0 to 442), weighted as the eye weights them.
pub fn gap(a: Rgb, b: Rgb) -> f64 {
    let square = |i: usize| (f64::from(a[i]) - f64::from(b[i])).powi(2);
    (2.0 * square(0) + 4.0 * square(1) + 3.0 * square(2)).sqrt() / 1.7
}

/// `share` (0 to 1) of `to` in `from`.
pub fn mix(from: Rgb, to: Rgb, share: f64) -> Rgb {
    std::array::from_fn(|i| {
        (f64::from(from[i]) * (1.0 - share) + f64::from(to[i]) * share).round() as u8
    })
}

/// An sRGB channel (0 to 255) as linear light (0 to 1).
pub fn to_linear(channel: u8) -> f64 {
    let value = f64::from(channel) / 255.0;
    if value <= 0.040_45 {
        value / 12.92
    } else {
        ((value + 0.055) / 1.055).powf(2.4)
    }
}

/// Linear light (0 to 1, clamped) as an sRGB channel (0 to 255).
pub fn from_linear(light: f64) -> u8 {
    let light = light.clamp(0.0, 1.0);
    let value = if light <= 0.003_130_8 {
        light * 12.92
    } else {
        1.055 * light.powf(1.0 / 2.4) - 0.055
    };
    (value * 255.0).round() as u8
}

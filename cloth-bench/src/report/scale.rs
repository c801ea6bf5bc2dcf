//! Axes: which range to show, where ticks stand and what they say.

/// How values are laid out along an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Scale {
    /// Evenly.
    #[default]
    Linear,
    /// By decimal logarithm. Only positive values can be shown.
    Log,
}

impl Scale {
    /// Where `value` stands: the value itself, or its decimal logarithm.
    pub(super) fn place(self, value: f64) -> f64 {
        match self {
            Self::Linear => value,
            Self::Log => value.log10(),
        }
    }

    fn value(self, place: f64) -> f64 {
        match self {
            Self::Linear => place,
            Self::Log => 10_f64.powf(place),
        }
    }
}

/// A range that holds all `places`, with a margin. Any number of places will do, none and all
/// equal included.
pub fn range(scale: Scale, places: impl Iterator<Item = f64>) -> (f64, f64) {
    let (low, high) = places.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), place| {
        (low.min(place), high.max(place))
    });
    if low > high {
        return (0.0, 1.0);
    }
    let (middle, span) = (0.5 * (low + high), high - low);
    // Rounding noise on a constant is not worth a magnified picture.
    let least = match scale {
        Scale::Linear => (1e-9 * middle.abs()).max(1e-290),
        Scale::Log => 1e-9,
    };
    if span < least {
        let half = match scale {
            Scale::Linear if middle == 0.0 => 1.0,
            Scale::Linear => 0.5 * middle.abs(),
            Scale::Log => 1.0,
        };
        return (middle - half, middle + half);
    }
    // A linear axis that nearly starts at zero starts at zero.
    let margin = 0.04 * span;
    let touches_zero = scale == Scale::Linear && low >= 0.0 && low < 0.15 * high;
    (if touches_zero { 0.0 } else { low - margin }, high + margin)
}

/// The ticks of one axis.
#[derive(Debug, Default)]
pub struct Ticks {
    /// Place and text of each labelled tick.
    pub labelled: Vec<(f64, String)>,
    /// Places of the ticks without text.
    pub(super) minor: Vec<f64>,
}

/// Ticks for the range `low` to `high` of places, at most about `most` of them labelled.
pub fn ticks(scale: Scale, (low, high): (f64, f64), most: usize) -> Ticks {
    match scale {
        Scale::Linear => linear_ticks(low, high, most),
        Scale::Log => log_ticks(low, high, most),
    }
}

fn linear_ticks(low: f64, high: f64, most: usize) -> Ticks {
    let rough = (high - low) / most.max(2) as f64;
    let decade = 10_f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 2.5, 5.0, 10.0]
        .map(|m| m * decade)
        .into_iter()
        .find(|&s| s >= rough);
    let step = step.unwrap_or(10.0 * decade);
    let (first, last) = ((low / step).ceil(), (high / step).floor());
    let places = (0..=(last - first) as usize).map(|i| (first + i as f64) * step);
    let largest = low.abs().max(high.abs());
    Ticks {
        labelled: places
            .map(|place| (place, decimal(place, step, largest)))
            .collect(),
        minor: Vec::new(),
    }
}

/// `value` with as many decimals as ticks `step` apart need, or with an exponent where that would
/// be long.
fn decimal(value: f64, step: f64, largest: f64) -> String {
    let decimals = |step: f64| {
        let digits = (-step.log10()).ceil().max(0.0) as usize;
        // A step of 0.25 needs one decimal more than its decade says.
        let scaled = step * 10_f64.powi(digits as i32);
        if (scaled - scaled.round()).abs() > 1e-6 {
            digits + 1
        } else {
            digits
        }
    };
    let zero_or = |text: String| if value == 0.0 { "0".to_owned() } else { text };
    if (1e-3..1e5).contains(&largest) {
        return zero_or(format!("{value:.*}", decimals(step)).replace('-', "−"));
    }
    let exponent = largest.log10().floor() as i32;
    let unit = 10_f64.powi(exponent);
    zero_or(
        format!("{:.*}e{exponent}", decimals(step / unit), value / unit).replacen(
            '-',
            if value < 0.0 { "−" } else { "-" },
            1,
        ),
    )
}

fn log_ticks(low: f64, high: f64, most: usize) -> Ticks {
    let (first, last) = (low.ceil() as i32, high.floor() as i32);
    let decades = usize::try_from(last - first + 1).unwrap_or(0);
    let inside = |&place: &f64| place >= low && place <= high;
    let within = |multiples: &'static [f64]| {
        (first - 1..=last)
            .flat_map(move |e| multiples.iter().map(move |m| m.log10() + f64::from(e)))
            .filter(inside)
            .collect::<Vec<_>>()
    };
    if decades >= 3 {
        let stride = [1, 2, 3, 5, 10, 20, 50, 100]
            .into_iter()
            .find(|s| decades.div_ceil(*s) <= most);
        let stride = stride.unwrap_or(200) as i32;
        let all = (first..=last)
            .filter(|e| e % stride == 0)
            .collect::<Vec<_>>();
        let plain = first >= -2 && last <= 4;
        return Ticks {
            labelled: all
                .iter()
                .map(|&e| (f64::from(e), power(e, plain)))
                .collect(),
            minor: match stride {
                1 if decades <= 8 => within(&[2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0]),
                1 => Vec::new(),
                _ => (first..=last)
                    .filter(|e| e % stride != 0)
                    .map(f64::from)
                    .collect(),
            },
        };
    }
    let steps = within(&[1.0, 2.0, 5.0]);
    if steps.len() >= 3 {
        return Ticks {
            labelled: steps
                .into_iter()
                .map(|p| (p, super::table::significant(10_f64.powf(p), 3)))
                .collect(),
            minor: within(&[3.0, 4.0, 6.0, 7.0, 8.0, 9.0]),
        };
    }
    // Less than a decade: round values, evenly apart, at their logarithms.
    let values = linear_ticks(Scale::Log.value(low), Scale::Log.value(high), most.min(5));
    let labelled = values.labelled.into_iter().filter(|(v, _)| *v > 0.0);
    Ticks {
        labelled: labelled.map(|(v, text)| (v.log10(), text)).collect(),
        minor: Vec::new(),
    }
}

/// 10 to the power `exponent`: `1e-3`, or `0.001` if `plain`.
fn power(exponent: i32, plain: bool) -> String {
    if plain {
        super::table::significant(10_f64.powi(exponent), 1).replace("1e4", "10000")
    } else {
        format!("1e{exponent}")
    }
}

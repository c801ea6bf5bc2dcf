//! The types that a setting can have, and how each of them is read.

use cloth_core::math::{Real, Vec3};
use std::fmt;
use toml::de::DeValue;

/// Which numbers a setting takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Range {
    /// All that are finite.
    Any,
    /// Those above a bound.
    Above(Real),
    /// Those not below a bound.
    AtLeast(Real),
    /// Those from a bound to another one, both included.
    Within(Real, Real),
    /// The same without the bounds.
    Between(Real, Real),
}

impl Range {
    /// Whether a number is in it.
    pub fn contains(self, number: Real) -> bool {
        match self {
            Self::Any => true,
            Self::Above(bound) => number > bound,
            Self::AtLeast(bound) => number >= bound,
            Self::Within(least, most) => (least..=most).contains(&number),
            Self::Between(low, high) => low < number && number < high,
        }
    }
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Beyond these, zeros are not counted by eye.
        let shown = |bound: Real| match bound == 0.0 || (1e-6..1e6).contains(&bound.abs()) {
            true => bound.to_string(),
            false => format!("{bound:e}"),
        };
        match *self {
            Self::Any => Ok(()),
            Self::Above(bound) => write!(f, "above {}", shown(bound)),
            Self::AtLeast(bound) => write!(f, "at least {}", shown(bound)),
            Self::Within(least, most) => write!(f, "from {} to {}", shown(least), shown(most)),
            Self::Between(low, high) => write!(f, "above {} and below {}", shown(low), shown(high)),
        }
    }
}

/// A type that a setting can have. What follows `--set key=` comes as a TOML string, whatever it is.
pub trait Value: Sized {
    /// What it has to be, for errors: `a finite number`; empty if it is one of a few names.
    const KIND: &'static str = "";

    /// The same where its range is all that there are.
    const OF_ANY_SIZE: &'static str = Self::KIND;
    /// Whether it can be left out by `none`.
    const CAN_BE_NONE: bool = false;

    /// Reads a value.
    fn read(value: &DeValue<'_>) -> Option<Self>;

    /// The value where nothing is given, from the default of the setting.
    fn by_default(default: &str) -> Option<Self> {
        Self::read(&DeValue::String(default.into()))
    }

    /// Whether all its numbers are in a range.
    fn is_within(&self, _: Range) -> bool {
        true
    }

    /// The names that it can have.
    fn names() -> Vec<&'static str> {
        Vec::new()
    }
}

impl Value for Real {
    const KIND: &'static str = "a finite number";

    fn read(value: &DeValue<'_>) -> Option<Self> {
        let number: Self = match value {
            DeValue::String(text) => text.parse().ok()?,
            DeValue::Float(float) => float.as_str().parse().ok()?,
            DeValue::Integer(whole) => {
                i64::from_str_radix(whole.as_str(), whole.radix()).ok()? as Self
            }
            _ => return None,
        };
        number.is_finite().then_some(number)
    }

    fn is_within(&self, range: Range) -> bool {
        range.contains(*self)
    }
}

impl Value for u32 {
    const KIND: &'static str = "a whole number";
    const OF_ANY_SIZE: &'static str = "a whole number from 0 to 4294967295";

    fn read(value: &DeValue<'_>) -> Option<Self> {
        match value {
            DeValue::String(text) => text.parse().ok(),
            DeValue::Integer(whole) => Self::from_str_radix(whole.as_str(), whole.radix()).ok(),
            _ => None,
        }
    }

    fn is_within(&self, range: Range) -> bool {
        range.contains(Real::from(*self))
    }
}

impl Value for String {
    const KIND: &'static str = "a text in quotes";

    fn read(value: &DeValue<'_>) -> Option<Self> {
        value.as_str().map(Self::from)
    }
}

/// The values of a list; in a text with commas in between.
fn list<T: Value>(value: &DeValue<'_>) -> Option<Vec<T>> {
    match value {
        DeValue::Array(array) => array.iter().map(|value| T::read(value.get_ref())).collect(),
        DeValue::String(text) => {
            let values = text
                .split(',')
                .map(|text| DeValue::String(text.trim().into()));
            values.map(|value| T::read(&value)).collect()
        }
        _ => None,
    }
}

impl Value for Vec<u32> {
    const KIND: &'static str = "a list of whole numbers from 0 on such as [0, 32]";

    fn read(value: &DeValue<'_>) -> Option<Self> {
        list(value)
    }
}

impl Value for [Real; 2] {
    const KIND: &'static str = "two numbers such as 0.98,1.02";

    fn read(value: &DeValue<'_>) -> Option<Self> {
        list(value)?.try_into().ok()
    }
}

impl Value for Vec3 {
    const KIND: &'static str = "three finite numbers such as [1, 2, 3]";

    fn read(value: &DeValue<'_>) -> Option<Self> {
        <[Real; 3]>::try_from(list(value)?).ok().map(Self::from)
    }

    fn is_within(&self, range: Range) -> bool {
        self.iter().all(|&number| range.contains(number))
    }
}

impl Value for [Vec3; 2] {
    const KIND: &'static str = "two points such as [[0, 0, 0], [1, 1, 1]]";

    fn read(value: &DeValue<'_>) -> Option<Self> {
        list(value)?.try_into().ok()
    }
}

/// A vector that may be written as one number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Factors(pub Vec3);

impl Value for Factors {
    const KIND: &'static str = "one or three finite numbers";

    fn read(value: &DeValue<'_>) -> Option<Self> {
        let same = Real::read(value).map(|number| Vec3::new(number, number, number));
        same.or_else(|| Vec3::read(value)).map(Self)
    }

    fn is_within(&self, range: Range) -> bool {
        self.0.is_within(range)
    }
}

/// `none`, or a value. Where nothing is given it is none too, whatever the default says: that is for readers then.
impl<T: Value> Value for Option<T> {
    const KIND: &'static str = T::KIND;
    const OF_ANY_SIZE: &'static str = T::OF_ANY_SIZE;
    const CAN_BE_NONE: bool = true;

    fn read(value: &DeValue<'_>) -> Option<Self> {
        match value.as_str() {
            Some("none") => Some(None),
            _ => T::read(value).map(Some),
        }
    }

    fn by_default(_: &str) -> Option<Self> {
        Some(None)
    }

    fn is_within(&self, range: Range) -> bool {
        self.as_ref().is_none_or(|value| value.is_within(range))
    }

    fn names() -> Vec<&'static str> {
        T::names()
    }
}

/// One of a few words, or a value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Or<W, T> {
    /// A word.
    Word(W),
    /// A value.
    Value(T),
}

impl<W: Choice, T: Value> Value for Or<W, T> {
    const KIND: &'static str = T::KIND;
    const OF_ANY_SIZE: &'static str = T::OF_ANY_SIZE;

    fn read(value: &DeValue<'_>) -> Option<Self> {
        let word = W::read(value).map(Self::Word);
        word.or_else(|| T::read(value).map(Self::Value))
    }

    fn is_within(&self, range: Range) -> bool {
        match self {
            Self::Word(_) => true,
            Self::Value(value) => value.is_within(range),
        }
    }

    fn names() -> Vec<&'static str> {
        let none = ["none"].into_iter().filter(|_| T::CAN_BE_NONE);
        let own = T::names().into_iter().chain(none);
        own.chain(<W as Value>::names()).collect()
    }
}

/// A type whose values have names.
pub trait Choice: Copy + 'static {
    /// Every name with its value.
    const NAMES: &'static [(&'static str, Self)];
}

impl<T: Choice> Value for T {
    fn read(value: &DeValue<'_>) -> Option<Self> {
        let text = match value {
            DeValue::String(text) => text,
            DeValue::Float(float) => float.as_str().trim_start_matches('+'),
            DeValue::Boolean(yes) => ["no", "yes"][usize::from(*yes)],
            _ => return None,
        };
        let found = T::NAMES.iter().find(|(name, _)| *name == text);
        found.map(|&(_, value)| value)
    }

    fn names() -> Vec<&'static str> {
        T::NAMES.iter().map(|&(name, _)| name).collect()
    }
}

impl Choice for bool {
    const NAMES: &'static [(&'static str, Self)] = &[("yes", true), ("no", false)];
}

/// Declares enums and the names of their values.
///
/// ```
/// cloth_bench::choices! {
///     /// What a ball falls on.
///     #[derive(PartialEq)]
///     enum Ground { Floor = "floor", Slope = "slope" }
/// }
/// ```
#[macro_export]
macro_rules! choices {
    ($($(#[$attribute:meta])* $visible:vis enum $name:ident { $($value:ident = $text:literal),+ $(,)? })+) => { $(
        $(#[$attribute])*
        #[derive(Clone, Copy, Debug)]
        $visible enum $name {
            $(#[doc = concat!("`", $text, "`.")] $value),+
        }
        impl $crate::settings::Choice for $name {
            const NAMES: &'static [(&'static str, Self)] = &[$(($text, Self::$value)),+];
        }
    )+ };
}

choices! {
    /// Chosen by the program.
    #[derive(PartialEq)]
    pub enum Auto { Auto = "auto" }

    /// Without bound.
    #[derive(PartialEq)]
    pub enum Infinite { Infinite = "inf" }
}

impl Or<Infinite, Real> {
    /// The number, which may be infinite.
    pub fn number(self) -> Real {
        match self {
            Self::Word(Infinite::Infinite) => Real::INFINITY,
            Self::Value(number) => number,
        }
    }
}

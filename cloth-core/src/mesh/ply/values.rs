//! The values of the body, one after the other, whatever their encoding.

use super::header::{Element, Kind, Start};
use super::{Encoding, MeshFileError, Place, PlyProblem};
use crate::math::Real;

/// A value of any type.
#[derive(Clone, Copy)]
pub(super) enum Number {
    Whole(i64),
    Broken(Real),
}

impl Number {
    pub(super) fn real(self) -> Real {
        match self {
            Self::Whole(number) => number as Real,
            Self::Broken(number) => number,
        }
    }
}

/// Reads rows of a body: first [`Values::row`], then as many values as the row has.
pub(super) struct Values<'a> {
    bytes: &'a [u8],
    encoding: Encoding,
    at: Start,
    /// In a body of text: what is left of the line, how many values it had, and where it stands.
    words: std::str::SplitWhitespace<'a>,
    taken: usize,
    row: Place,
}

impl<'a> Values<'a> {
    pub(super) fn new(bytes: &'a [u8], encoding: Encoding, at: Start) -> Self {
        Self {
            bytes,
            encoding,
            at,
            words: "".split_whitespace(),
            taken: 0,
            row: Place::Byte(at.byte),
        }
    }

    /// Goes to the next row, number `index` of `element`, and says where it begins.
    pub(super) fn row(&mut self, element: &Element, index: u64) -> Result<Place, MeshFileError> {
        self.taken = 0;
        self.row = match self.encoding {
            Encoding::Ascii => {
                let (line, text) = self.line().ok_or_else(|| self.ended(element, index))?;
                let place = Place::Line(line);
                let text = text.map_err(|found| {
                    let expected = "numbers in text";
                    MeshFileError::new(Some(place), PlyProblem::NotANumber { found, expected })
                })?;
                self.words = text.split_whitespace();
                place
            }
            _ => Place::Byte(self.at.byte),
        };
        Ok(self.row)
    }

    /// The next line that is not blank.
    fn line(&mut self) -> Option<(usize, Result<&'a str, String>)> {
        loop {
            let rest = self.bytes.get(self.at.byte..).filter(|r| !r.is_empty())?;
            let end = rest.iter().position(|b| matches!(b, b'\n' | b'\r'));
            let text = &rest[..end.unwrap_or(rest.len())];
            let ending = if rest[text.len()..].starts_with(b"\r\n") {
                2
            } else {
                1
            };
            let line = self.at.line;
            self.at.byte += text.len() + ending;
            self.at.line += 1;
            if !text.trim_ascii().is_empty() {
                let shown = || String::from_utf8_lossy(text).chars().take(20).collect();
                return Some((line, std::str::from_utf8(text).map_err(|_| shown())));
            }
        }
    }

    /// The next value of the row.
    pub(super) fn value(
        &mut self,
        kind: Kind,
        element: &Element,
        index: u64,
    ) -> Result<Number, MeshFileError> {
        let little = match self.encoding {
            Encoding::Ascii => return self.word(kind, element),
            Encoding::BinaryLittleEndian => true,
            Encoding::BinaryBigEndian => false,
        };
        let rest = self.bytes.get(self.at.byte..).unwrap_or_default();
        let Some(bytes) = rest.get(..kind.size()) else {
            return Err(self.ended(element, index));
        };
        self.at.byte += bytes.len();
        // As if every type had eight bytes: the least significant ones are in front.
        let mut wide = [0; 8];
        wide[..bytes.len()].copy_from_slice(bytes);
        if !little {
            wide[..bytes.len()].reverse();
        }
        let bits = u64::from_le_bytes(wide);
        Ok(match kind {
            Kind::I8 => Number::Whole(i64::from(bits as u8 as i8)),
            Kind::I16 => Number::Whole(i64::from(bits as u16 as i16)),
            Kind::I32 => Number::Whole(i64::from(bits as u32 as i32)),
            Kind::U8 | Kind::U16 | Kind::U32 => Number::Whole(bits as i64),
            Kind::F32 => Number::Broken(Real::from(f32::from_bits(bits as u32))),
            Kind::F64 => Number::Broken(f64::from_bits(bits)),
        })
    }

    fn word(&mut self, kind: Kind, element: &Element) -> Result<Number, MeshFileError> {
        let Some(word) = self.words.next() else {
            return Err(self.wrong_length(element, self.taken + 1, self.taken));
        };
        self.taken += 1;
        let (number, expected) = if kind.is_integer() {
            (word.parse().ok().map(Number::Whole), "a whole number")
        } else {
            (word.parse().ok().map(Number::Broken), "a number")
        };
        number.ok_or_else(|| {
            let found = word.chars().take(20).collect();
            MeshFileError::new(Some(self.row), PlyProblem::NotANumber { found, expected })
        })
    }

    /// Refuses values that are left in the line.
    pub(super) fn end_row(&mut self, element: &Element) -> Result<(), MeshFileError> {
        match self.words.by_ref().count() {
            0 => Ok(()),
            more => Err(self.wrong_length(element, self.taken, self.taken + more)),
        }
    }

    /// Refuses what is left in the file.
    pub(super) fn end(&mut self) -> Result<(), MeshFileError> {
        let place = match self.encoding {
            Encoding::Ascii => self.line().map(|(line, _)| Place::Line(line)),
            _ if self.at.byte < self.bytes.len() => Some(Place::Byte(self.at.byte)),
            _ => None,
        };
        match place {
            None => Ok(()),
            place => Err(MeshFileError::new(place, PlyProblem::TooLong)),
        }
    }

    fn wrong_length(&self, element: &Element, expected: usize, found: usize) -> MeshFileError {
        let problem = PlyProblem::WrongLength {
            element: element.name.clone(),
            expected,
            found,
        };
        MeshFileError::new(Some(self.row), problem)
    }

    fn ended(&self, element: &Element, index: u64) -> MeshFileError {
        let problem = PlyProblem::Truncated {
            element: element.name.clone(),
            index,
            count: element.count,
        };
        let place = match self.encoding {
            Encoding::Ascii => Place::Line(self.at.line),
            _ => Place::Byte(self.bytes.len()),
        };
        MeshFileError::new(Some(place), problem)
    }
}

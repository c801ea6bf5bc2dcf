//! The header: which elements follow, and of what each is made.

use super::{Encoding, MeshFileError, Place, PlyProblem};

/// What the body holds.
pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
    /// Where the body begins.
    pub(super) body: Start,
}

/// A place in a file, in bytes from 0 and lines from 1.
#[derive(Clone, Copy)]
pub(super) struct Start {
    pub(super) byte: usize,
    pub(super) line: usize,
}

/// A table of the body, such as that of the vertices.
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
}

/// A column of a table.
pub(super) struct Property {
    pub(super) name: String,
    /// Type of the length before a list; none for a single value.
    pub(super) length: Option<Kind>,
    pub(super) kind: Kind,
}

/// Types of values.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Kind {
    /// Both families of names are in use.
    fn named(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return None,
        })
    }

    pub(super) fn is_integer(self) -> bool {
        !matches!(self, Self::F32 | Self::F64)
    }

    /// Size in a binary body (bytes).
    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }
}

const FORMATS: &str =
    "\"format ascii 1.0\", \"format binary_little_endian 1.0\" or \"format binary_big_endian 1.0\"";
const PROPERTY: &str = "\"property TYPE NAME\" or \"property list COUNT_TYPE TYPE NAME\" after an element, \
                        with types char, uchar, short, ushort, int, uint, float or double and a whole number as count";

impl Header {
    pub(super) fn parse(bytes: &[u8]) -> Result<Self, MeshFileError> {
        let mut lines = Lines {
            bytes,
            at: Start { byte: 0, line: 1 },
        };
        let refused = |line, problem| MeshFileError::new(Some(Place::Line(line)), problem);
        if lines.next().is_none_or(|(_, text)| text != "ply") {
            return Err(refused(1, PlyProblem::NotPly));
        }
        let mut encoding = None;
        let mut elements: Vec<Element> = Vec::new();
        while let Some((line, text)) = lines.next() {
            let wrong = |expected| {
                let found = text.chars().take(80).collect();
                refused(line, PlyProblem::Header { found, expected })
            };
            let twice = |what| refused(line, PlyProblem::Twice { what });
            let words: Vec<&str> = text.split_whitespace().collect();
            match words[..] {
                [] | ["comment" | "obj_info", ..] => {}
                ["format", ..] if encoding.is_some() => return Err(twice("the format".into())),
                ["format", name, "1.0"] => {
                    let found = Encoding::ALL.into_iter().find(|e| e.name() == name);
                    encoding = Some(found.ok_or_else(|| wrong(FORMATS))?);
                }
                ["format", ..] => return Err(wrong(FORMATS)),
                _ if encoding.is_none() => return Err(wrong(FORMATS)),
                ["element", name, count] => {
                    if elements.iter().any(|e| e.name == name) {
                        return Err(twice(format!("the element {name:?}")));
                    }
                    elements.push(Element {
                        name: name.to_owned(),
                        count: count
                            .parse()
                            .map_err(|_| wrong("\"element NAME COUNT\" with a whole number"))?,
                        properties: Vec::new(),
                    });
                }
                ["element", ..] => return Err(wrong("\"element NAME COUNT\"")),
                ["property", ref rest @ ..] => {
                    let property = property(rest).ok_or_else(|| wrong(PROPERTY))?;
                    let element = elements.last_mut().ok_or_else(|| wrong(PROPERTY))?;
                    if element.properties.iter().any(|p| p.name == property.name) {
                        return Err(twice(format!("the property {:?}", property.name)));
                    }
                    element.properties.push(property);
                }
                ["end_header"] => {
                    let Some(encoding) = encoding else {
                        return Err(wrong(FORMATS));
                    };
                    return Ok(Self {
                        encoding,
                        elements,
                        body: lines.at,
                    });
                }
                _ => {
                    return Err(wrong(
                        "\"comment\", \"element\", \"property\" or \"end_header\"",
                    ));
                }
            }
        }
        Err(refused(lines.at.line, PlyProblem::NoEndOfHeader))
    }
}

fn property(words: &[&str]) -> Option<Property> {
    let (length, kind, name) = match *words {
        ["list", length, kind, name] => {
            let length = Kind::named(length).filter(|kind| kind.is_integer())?;
            (Some(length), kind, name)
        }
        [kind, name] => (None, kind, name),
        _ => return None,
    };
    Some(Property {
        name: name.to_owned(),
        length,
        kind: Kind::named(kind)?,
    })
}

/// Lines of the header, which may end in `\n`, `\r\n` or, on old machines, `\r`.
struct Lines<'a> {
    bytes: &'a [u8],
    at: Start,
}

impl<'a> Iterator for Lines<'a> {
    type Item = (usize, std::borrow::Cow<'a, str>);

    fn next(&mut self) -> Option<Self::Item> {
        let rest = self.bytes.get(self.at.byte..).filter(|r| !r.is_empty())?;
        let end = rest.iter().position(|b| matches!(b, b'\n' | b'\r'))?;
        let ending = if rest[end..].starts_with(b"\r\n") {
            2
        } else {
            1
        };
        let line = self.at.line;
        self.at = Start {
            byte: self.at.byte + end + ending,
            line: line + 1,
        };
        // Comments may be in any encoding.
        Some((line, String::from_utf8_lossy(&rest[..end])))
    }
}

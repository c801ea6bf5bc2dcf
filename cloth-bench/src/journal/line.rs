//! A line of the journal: one JSON object, whose last field is a checksum of all that stands before it.

use crate::hash::fnv1a;
use serde::Serialize;
use serde::de::DeserializeOwned;

const BEFORE: &str = ",\"checksum\":\"";
const DIGITS: usize = 16;
const AFTER: &str = "\"}";

/// The line, with its end.
pub fn write(value: &impl Serialize) -> serde_json::Result<String> {
    let json = serde_json::to_string(value)?;
    let object = json.strip_suffix('}').unwrap_or(&json);
    let checksum = fnv1a(object.bytes());
    Ok(format!("{object}{BEFORE}{checksum:016x}{AFTER}\n"))
}

/// What a line (without its end) says, or why it is not as it was written.
pub fn read<T: DeserializeOwned>(line: &[u8]) -> Result<T, String> {
    let end = line
        .len()
        .checked_sub(BEFORE.len() + DIGITS + AFTER.len())
        .ok_or("it is cut off")?;
    let (object, seal) = line.split_at(end);
    let checksum = format!("{BEFORE}{:016x}{AFTER}", fnv1a(object.iter().copied()));
    if seal != checksum.as_bytes() {
        return Err("its checksum is another".into());
    }
    serde_json::from_slice(&[object, b"}"].concat()).map_err(|error| error.to_string())
}

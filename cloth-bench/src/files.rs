//! Files that are there whole or not at all.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Writes a file of several parts, replacing it: beside it first, then under its name, so that a full disk or a kill
/// leaves no part of it and an earlier one as it was. What is no plain file, such as a pipe, is written to.
pub(crate) fn write(path: &Path, parts: &[&[u8]]) -> io::Result<()> {
    let fill = |mut file: File| parts.iter().try_for_each(|part| file.write_all(part));
    let path = match fs::metadata(path) {
        Ok(known) if !known.is_file() => return File::create(path).and_then(fill),
        // A link stays one.
        Ok(_) => &fs::canonicalize(path)?,
        Err(_) => path,
    };
    let beside = beside(path);
    let written = File::create(&beside).and_then(fill);
    let written = written.and_then(|()| fs::rename(&beside, path));
    if written.is_err() {
        // It may not even be there.
        let _ = fs::remove_file(&beside);
    }
    written
}

/// Makes sure that a file can be written there, before a long run that ends with it.
pub(crate) fn probe(path: &Path) -> io::Result<()> {
    if path.is_dir() {
        return Err(io::ErrorKind::IsADirectory.into());
    }
    if fs::metadata(path).is_ok_and(|known| !known.is_file()) {
        return Ok(());
    }
    let beside = beside(path);
    File::create(&beside)?;
    fs::remove_file(beside)
}

/// Where a file is written before it has its name.
fn beside(path: &Path) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(format!(".{}.part", std::process::id()));
    path.with_file_name(name)
}

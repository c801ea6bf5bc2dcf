//! Files of labelled queries: eight rows a query, `x_num,x_den,y_num,y_den,z_num,z_den,truth`.
//!
//! The format is that of the *Sample Queries* of Wang, Ferguson, Schneider, Jiang, Attene and Panozzo, A large-scale
//! benchmark and an inclusion-based algorithm for continuous collision detection, *ACM Trans. Graph.* 40(5), 2021, DOI
//! 10.1145/3460775. The four vertices at the start come first, then at the end: the vertex and the corners, or the ends
//! of the one edge and of the other.

use super::LabelledQuery;
use crate::error::BenchError;
use cloth_collide::{Query, QueryKind};
use cloth_core::math::{Real, Vec3};
use std::fmt::Display;

const ROWS: usize = 8;

/// All queries of a file. A coordinate is the `f64` nearest to its fraction; if the denominator is a power of two and
/// the numerator short enough, it is the fraction.
pub fn read(path: &str, kind: QueryKind) -> Result<Vec<LabelledQuery>, BenchError> {
    let refuse = |message: &dyn Display| BenchError::Usage(format!("{path}: {message}"));
    let bytes = std::fs::read(path).map_err(|error| refuse(&error))?;
    parse(&bytes, kind).map_err(|message| refuse(&message))
}

fn parse(bytes: &[u8], kind: QueryKind) -> Result<Vec<LabelledQuery>, String> {
    let text = str::from_utf8(bytes).map_err(|error| {
        let before = &bytes[..error.valid_up_to()];
        let line = 1 + before.iter().filter(|&&byte| byte == b'\n').count();
        format!("line {line}: it is no text")
    })?;
    let mut rows = Vec::new();
    for (number, line) in text.lines().enumerate() {
        if line.trim().is_empty() {
            continue;
        }
        let (point, truth) =
            row(line).map_err(|message| format!("line {}: {message}", number + 1))?;
        rows.push((number + 1, point, truth));
    }
    let (queries, rest) = rows.as_chunks::<ROWS>();
    if !rest.is_empty() {
        let line = rest[rest.len() - 1].0;
        return Err(format!(
            "line {line}: the last query has {} rows instead of {ROWS}",
            rest.len()
        ));
    }
    if queries.is_empty() {
        return Err("no queries in it".to_owned());
    }
    queries.iter().map(|rows| query(rows, kind)).collect()
}

fn query(rows: &[(usize, Vec3, bool); ROWS], kind: QueryKind) -> Result<LabelledQuery, String> {
    let contact = rows[0].2;
    if let Some((line, ..)) = rows.iter().find(|row| row.2 != contact) {
        return Err(format!(
            "line {line}: its truth is not that of the other rows of the query"
        ));
    }
    let point = |k: usize| rows[k].1;
    Ok(LabelledQuery {
        query: Query {
            kind,
            from: std::array::from_fn(point),
            to: std::array::from_fn(|k| point(4 + k)),
        },
        contact,
        contact_time: None,
        line: Some(rows[0].0),
    })
}

fn row(line: &str) -> Result<(Vec3, bool), String> {
    let columns: Vec<&str> = line.split(',').map(str::trim).collect();
    let [xn, xd, yn, yd, zn, zd, truth] = columns[..] else {
        return Err(format!("{} columns instead of 7", columns.len()));
    };
    let point = Vec3::new(fraction(xn, xd)?, fraction(yn, yd)?, fraction(zn, zd)?);
    match truth {
        "0" => Ok((point, false)),
        "1" => Ok((point, true)),
        other => Err(format!("the truth is `{other}`, not 0 or 1")),
    }
}

fn fraction(numerator: &str, denominator: &str) -> Result<Real, String> {
    let quotient = whole(numerator)? / whole(denominator)?;
    if quotient.is_finite() {
        Ok(quotient)
    } else {
        Err(format!("{numerator}/{denominator} is not a finite number"))
    }
}

fn whole(text: &str) -> Result<Real, String> {
    let digits = text.strip_prefix(['-', '+']).unwrap_or(text);
    let is_whole = !digits.is_empty() && digits.bytes().all(|b| b.is_ascii_digit());
    match text.parse() {
        Ok(number) if is_whole => Ok(number),
        _ => Err(format!("`{text}` is not a whole number")),
    }
}

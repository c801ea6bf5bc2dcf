//! A typed row as cells of a table: serde says the names of its fields and their values.

use super::table::Cell;
use serde::ser::{Error, Impossible, Serialize, SerializeStruct, SerializeTuple, Serializer};
use std::fmt;

/// The columns that a row has, and what stands in them. Values that are no field of a struct have `names`.
///
/// # Panics
/// If the row holds what is no cell.
pub(super) fn columns_and_cells<R: Serialize>(names: &[&str], row: &R) -> (Vec<String>, Vec<Cell>) {
    let mut cells = RowCells {
        names: names.iter(),
        ..RowCells::default()
    };
    if let Err(NoCell(reason)) = row.serialize(&mut cells) {
        panic!("a row of a table: {reason}");
    }
    (cells.columns, cells.cells)
}

/// Takes a row apart.
#[derive(Default)]
struct RowCells<'a> {
    /// Those of values outside of structs.
    names: std::slice::Iter<'a, &'a str>,
    /// The field that is being read; empty outside of structs.
    field: &'static str,
    columns: Vec<String>,
    cells: Vec<Cell>,
}

impl RowCells<'_> {
    fn push(&mut self, cell: impl Into<Cell>) -> Result<(), NoCell> {
        let name = match self.field {
            "" => *self.names.next().ok_or(NoCell("a nameless value".into()))?,
            field => field,
        };
        // What has a blank is written as it is to be read: `3χ + E_b`.
        self.columns.push(match name.contains(' ') {
            true => name.to_owned(),
            false => name.replace('_', " "),
        });
        self.cells.push(cell.into());
        Ok(())
    }
}

/// Why a value cannot stand in a table.
#[derive(Debug)]
struct NoCell(String);

impl fmt::Display for NoCell {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl std::error::Error for NoCell {}

impl Error for NoCell {
    fn custom<T: fmt::Display>(reason: T) -> Self {
        Self(reason.to_string())
    }
}

impl SerializeStruct for &mut RowCells<'_> {
    type Ok = ();
    type Error = NoCell;

    fn serialize_field<T: Serialize + ?Sized>(
        &mut self,
        name: &'static str,
        value: &T,
    ) -> Result<(), NoCell> {
        let around = std::mem::replace(&mut self.field, name);
        value.serialize(&mut **self)?;
        self.field = around;
        Ok(())
    }

    fn end(self) -> Result<(), NoCell> {
        Ok(())
    }
}

impl SerializeTuple for &mut RowCells<'_> {
    type Ok = ();
    type Error = NoCell;

    fn serialize_element<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), NoCell> {
        value.serialize(&mut **self)
    }

    fn end(self) -> Result<(), NoCell> {
        Ok(())
    }
}

/// Counts above `i64::MAX`, which no table here can hold, become `i64::MAX`.
macro_rules! whole_numbers {
    ($($name:ident: $type:ty),+) => { $(
        fn $name(self, v: $type) -> Cells {
            self.push(i64::try_from(v).unwrap_or(i64::MAX))
        }
    )+ };
}

type Never = Impossible<(), NoCell>;
type Cells = Result<(), NoCell>;

fn no<T>(what: &str) -> Result<T, NoCell> {
    Err(NoCell(format!("{what} is no cell")))
}

impl Serializer for &mut RowCells<'_> {
    type Ok = ();
    type Error = NoCell;
    type SerializeSeq = Never;
    type SerializeTuple = Self;
    type SerializeTupleStruct = Never;
    type SerializeTupleVariant = Never;
    type SerializeMap = Never;
    type SerializeStruct = Self;
    type SerializeStructVariant = Never;

    /// Numbers keep what is infinite or none as it is.
    fn is_human_readable(&self) -> bool {
        false
    }

    fn serialize_bool(self, v: bool) -> Cells {
        self.push(if v { "yes" } else { "no" })
    }

    whole_numbers! { serialize_i8: i8, serialize_i16: i16, serialize_i32: i32, serialize_i64: i64 }
    whole_numbers! { serialize_u8: u8, serialize_u16: u16, serialize_u32: u32, serialize_u64: u64 }

    fn serialize_f32(self, v: f32) -> Cells {
        self.push(f64::from(v))
    }

    fn serialize_f64(self, v: f64) -> Cells {
        self.push(v)
    }

    fn serialize_char(self, v: char) -> Cells {
        self.push(v.to_string())
    }

    fn serialize_str(self, v: &str) -> Cells {
        self.push(v)
    }

    fn serialize_none(self) -> Cells {
        self.push(Cell::Missing)
    }

    fn serialize_some<T: Serialize + ?Sized>(self, value: &T) -> Cells {
        value.serialize(self)
    }

    /// The name of a variant, but for the cell that has no value.
    fn serialize_unit_variant(self, of: &str, _: u32, variant: &str) -> Cells {
        match (of, variant) {
            ("Cell", "Missing") => self.push(Cell::Missing),
            _ => self.push(variant),
        }
    }

    fn serialize_newtype_struct<T: Serialize + ?Sized>(self, _: &str, value: &T) -> Cells {
        value.serialize(self)
    }

    fn serialize_struct(self, _: &str, _: usize) -> Result<Self, NoCell> {
        Ok(self)
    }

    fn serialize_tuple(self, _: usize) -> Result<Self, NoCell> {
        Ok(self)
    }

    fn serialize_unit(self) -> Cells {
        Ok(())
    }

    fn serialize_unit_struct(self, _: &str) -> Cells {
        Ok(())
    }

    fn serialize_bytes(self, _: &[u8]) -> Cells {
        no("a run of bytes")
    }

    /// An enum is what it holds, a cell for instance.
    fn serialize_newtype_variant<T>(self, _: &str, _: u32, _: &str, value: &T) -> Cells
    where
        T: Serialize + ?Sized,
    {
        value.serialize(self)
    }

    fn serialize_seq(self, _: Option<usize>) -> Result<Never, NoCell> {
        no("a list")
    }

    fn serialize_map(self, _: Option<usize>) -> Result<Never, NoCell> {
        no("a map")
    }

    fn serialize_tuple_struct(self, name: &str, _: usize) -> Result<Never, NoCell> {
        no(name)
    }

    fn serialize_tuple_variant(self, _: &str, _: u32, v: &str, _: usize) -> Result<Never, NoCell> {
        no(v)
    }

    fn serialize_struct_variant(self, _: &str, _: u32, v: &str, _: usize) -> Result<Never, NoCell> {
        no(v)
    }
}

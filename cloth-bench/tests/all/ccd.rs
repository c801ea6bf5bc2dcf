//! Continuous collision detection, held against queries of known answer.

mod coplanarity;
mod file;

//! What is known of each method, whatever the scene: its look in plots, closed forms, and what no measurement says.

use super::{Kind, Method};
use crate::report::palette::{Marker, Rgb};
use crate::studies::variants::Variant;
use cloth_core::math::Real;
use serde::Serialize;

/// What no measurement says of a method at its default settings, as the documentation of the crates has it.
#[derive(Debug, Default, Serialize)]
pub(crate) struct Qualities {
    method: &'static str,
    physical_parameters: &'static str,
    #[serde(rename = "this implementation holds and lets go without a new solver")]
    holds_and_lets_go: &'static str,
    in_parallel: &'static str,
    factorises: &'static str,
    #[serde(rename = "patent reported, not checked")]
    patent: &'static str,
}

impl Method {
    /// Colour and marker in every plot.
    pub fn look(&self) -> (Rgb, Marker) {
        match self.kind {
            Kind::Explicit => ([0x4a, 0xad, 0xeb], Marker::Plus),
            Kind::Symplectic => ([0x3a, 0x2a, 0x8c], Marker::Star),
            Kind::Implicit => ([0xc4, 0x3e, 0x00], Marker::Diamond),
            Kind::LinearImplicit => ([0x90, 0x84, 0x3c], Marker::Square),
            Kind::Midpoint => ([0xc9, 0x6f, 0xa5], Marker::Cross),
            Kind::Bdf2 => ([0x72, 0x12, 0x61], Marker::TriangleDown),
            Kind::Pbd => ([0xdd, 0x8a, 0x00], Marker::Square),
            Kind::Xpbd => ([0x07, 0x66, 0xb9], Marker::Circle),
            Kind::XpbdDirect => ([0x90, 0x48, 0x3c], Marker::Triangle),
            Kind::Pd => ([0x00, 0x8f, 0x6a], Marker::Triangle),
            Kind::Own(own) => own.look,
        }
    }

    /// What studies compare of a method of one's own beside its default.
    pub(crate) fn variants(&self) -> Vec<Variant> {
        match self.kind {
            Kind::Own(own) => Variant::list(own.variants),
            _ => Vec::new(),
        }
    }

    /// What no measurement says.
    #[rustfmt::skip] // a table is read by rows
    pub(crate) fn qualities(&self) -> Qualities {
        let [physical_parameters, holds, in_parallel, factorises, patent] = match self.kind {
            Kind::Explicit | Kind::Symplectic => ["yes", "no", "gradients", "nothing", "none reported"],
            Kind::Implicit | Kind::LinearImplicit | Kind::Midpoint | Kind::Bdf2 =>
                ["yes", "no", "gradients, matrices, multigrid", "nothing (multigrid)", "none reported"],
            Kind::Pbd => ["with one iteration a substep as xpbd; else no: depends on iterations and step", "no", "constraints of a colour", "nothing", "none reported"],
            Kind::Xpbd => ["yes, once it has converged", "no", "constraints of a colour", "nothing", "US 11,270,041"],
            Kind::XpbdDirect => ["yes", "no", "no", "its system", "as xpbd"],
            Kind::Pd => ["yes", "yes", "blocks of vertices, subtrees of the factor", "its matrix, anew for another step size", "none reported"],
            Kind::Own(own) => own.qualities,
        };
        Qualities {
            method: self.name,
            physical_parameters,
            holds_and_lets_go: holds,
            in_parallel,
            factorises,
            patent,
        }
    }

    /// Whether the method, solved exactly, takes the step of implicit Euler, so that its error can be measured against
    /// the minimiser of `G`. The second-order rules take another step.
    pub fn aims_at_implicit_euler(&self) -> bool {
        match self.kind {
            Kind::Midpoint | Kind::Bdf2 => false,
            Kind::Own(own) => own.aims_at_implicit_euler,
            _ => true,
        }
    }

    /// Whether it may tell the forces at held vertices; a method of one's own says so with each step.
    pub(crate) fn tells_pin_forces(&self) -> bool {
        !matches!(self.kind, Kind::LinearImplicit)
    }

    /// Whether no step is stable, however short: forward Euler, whose oscillators grow by √(1 + z²) a step.
    pub fn is_never_stable(&self) -> bool {
        matches!(self.kind, Kind::Explicit)
    }

    /// Whether only short steps are stable, so that it cuts them finely by default.
    pub(crate) fn is_explicit(&self) -> bool {
        matches!(self.kind, Kind::Explicit | Kind::Symplectic)
    }

    /// How far free fall leads in `n` equal (sub)steps of size h, in units of `½ g h²`.
    pub fn free_fall(&self, n: u32) -> Real {
        let count = Real::from(n);
        match self.kind {
            // The velocity of a step is that at its start, in its middle or at its end.
            Kind::Explicit => count * (count - 1.0),
            Kind::Midpoint => count * count,
            // Exact but for what the first step, of implicit Euler, leaves: errors stay or shrink to a third.
            Kind::Bdf2 => count * count + 1.5 * (1.0 - (1.0 / 3.0 as Real).powf(count)),
            _ => count * (count + 1.0),
        }
    }

    /// What one mass on one spring keeps of its energy in so many (sub)steps of h, with z = ωh (dimensionless), where a
    /// closed form says so. One spring is solved exactly by one iteration of anything that aims at implicit Euler.
    pub(crate) fn kept_by_an_oscillator(&self, z: Real, count: Real) -> Option<Real> {
        match self.kind {
            Kind::Implicit | Kind::LinearImplicit | Kind::Pd | Kind::Xpbd | Kind::XpbdDirect => {
                Some((1.0 + z * z).powf(-count))
            }
            Kind::Own(own) if own.aims_at_implicit_euler => Some((1.0 + z * z).powf(-count)),
            Kind::Midpoint => Some(1.0),
            _ => None,
        }
    }
}

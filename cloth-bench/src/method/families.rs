//! Handing the elements of a cloth to the builder of a method.
//!
//! Every builder takes elements by one generic call, which asks for the view that the method needs. A list of families
//! of several kinds therefore has to be taken apart once, here: each macro names the kinds that have the view, the
//! compiler holds it to that, and all others are refused by name.

use crate::error::BenchError;
use cloth_core::cloth::Elements;
use cloth_core::particles::Particles;
use cloth_massspring::{ImplicitConfig, ImplicitEuler};

/// The builder with each family added by `$add`, if it is one of the kinds listed; returns from the caller with
/// [`refused`] otherwise.
macro_rules! add_families {
    ($builder:expr, $families:expr, $method:expr, [$($kind:ident),+], $view:expr, |$b:ident, $elements:ident| $add:expr) => {{
        let mut builder = $builder;
        for family in $families {
            builder = match family {
                $(Elements::$kind($elements) => {
                    let $b = builder;
                    $add
                })+
                #[allow(unreachable_patterns)] // some lists are complete today
                other => return Err(refused($method, &other, $view)),
            };
        }
        builder
    }};
}

/// For methods that ask for energies: every element has one.
macro_rules! add_energies {
    ($builder:expr, $families:expr, $method:expr) => {
        add_families!(
            $builder,
            $families,
            $method,
            [
                Springs, Limited, Stvk, Arap, Quadratic, Curved, Dihedral, Cubic, Midpoint,
                Stitches
            ],
            "has a gradient and a Hessian",
            |b, elements| b.energy(elements).map_err(BenchError::usage)?
        )
    };
}

/// For position-based methods.
macro_rules! add_constraints {
    ($builder:expr, $families:expr, $method:expr) => {
        add_families!(
            $builder,
            $families,
            $method,
            [
                Springs, Limited, Stvk, Arap, Quadratic, Curved, Dihedral, Midpoint, Stitches
            ],
            "is a sum of squares ½ k C²",
            |b, elements| b.energy(elements)
        )
    };
}

/// For projective dynamics.
macro_rules! add_projections {
    ($builder:expr, $families:expr, $method:expr) => {
        add_families!(
            $builder,
            $families,
            $method,
            [
                Springs, Limited, Arap, Quadratic, Curved, Midpoint, Stitches
            ],
            "is a squared distance ½ w ‖Sx − p‖² to a set",
            |b, elements| b.energy(elements)
        )
    };
}

pub(super) use {add_constraints, add_energies, add_families, add_projections};

/// Why a method cannot take a family: it needs something that `view` says.
pub(super) fn refused(method: &str, family: &Elements, view: &str) -> BenchError {
    BenchError::Usage(format!(
        "`{method}` cannot take {}: it needs an energy that {view}",
        family.name()
    ))
}

/// Implicit Euler for some families.
///
/// # Errors
/// [`BenchError::Usage`] for a setting out of range or an element of a vertex that does not exist.
pub(crate) fn implicit_euler(
    particles: &Particles,
    families: Vec<Elements>,
    config: ImplicitConfig,
) -> Result<ImplicitEuler, BenchError> {
    let builder = add_energies!(
        ImplicitEuler::builder(particles),
        families,
        "implicit-euler"
    );
    builder.config(config).build().map_err(BenchError::usage)
}

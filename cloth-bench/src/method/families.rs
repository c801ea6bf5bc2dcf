//! Handing the elements of a cloth to the builder of a method.
//!
//! Every builder takes elements by one generic call, which asks for the view that the method needs. A list of families of several kinds
//! therefore has to be taken apart once, here: each function names the kinds that its builder can take, the compiler holds it to that, and all
//! others are refused by name.

use crate::error::BenchError;
use cloth_core::cloth::Elements;
use cloth_core::particles::Particles;
use cloth_massspring::{ImplicitConfig, ImplicitEuler};

/// Adds each family to a builder by `$add`, if it is one of the kinds listed.
macro_rules! add_families {
    ($builder:expr, $families:expr, $method:expr, [$($kind:ident),+], |$b:ident, $elements:ident| $add:expr) => {{
        let mut builder = $builder;
        for family in $families {
            builder = match family {
                $(Elements::$kind($elements) => {
                    let $b = builder;
                    $add
                })+
                other => return Err(refused($method, &other)),
            };
        }
        builder
    }};
}

fn refused(method: &str, family: &Elements) -> BenchError {
    BenchError::Usage(format!("{method} cannot take {}", family.name()))
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
    let builder = add_families!(
        ImplicitEuler::builder(particles),
        families,
        "implicit-euler",
        [Springs, Stvk, Arap, Quadratic, Curved, Dihedral, Cubic],
        |b, elements| b.energy(elements).map_err(BenchError::usage)?
    );
    builder.config(config).build().map_err(BenchError::usage)
}

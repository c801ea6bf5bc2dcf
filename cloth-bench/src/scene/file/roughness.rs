//! `[mesh.contact]`: pieces that are not equally thick or rough.

use super::document::Section;
use super::keys;
use crate::error::BenchError;
use crate::names;
use crate::scene::contact::{PieceContact, Surface};
use crate::settings::{Settings, Table};
use cloth_core::mesh::TriMesh;
use cloth_core::method::ordering::Order;

/// Thickness and friction of every vertex, if a piece has its own; `common` is what `[contact]` says, `counts` are the
/// numbers of vertices of the pieces of `mesh`.
pub(super) fn of_pieces(
    common: &Settings,
    own: &[Option<Section<'_>>],
    (mesh, counts): (&TriMesh, &[usize]),
    order: Option<&Order>,
) -> Result<Option<PieceContact>, BenchError> {
    if own.iter().all(Option::is_none) {
        return Ok(None);
    }
    let (mut thickness, mut friction) = (Vec::new(), Vec::new());
    let (mut piece, mut excluded) = (Vec::new(), Vec::new());
    for ((number, section), count) in (0..).zip(own).zip(counts) {
        if let Some(section) = section {
            excluded.extend(others(section, own.len())?.map(|other| [number, other]));
        }
        piece.extend(std::iter::repeat_n(number, *count));
        let settings = section.map(|section| section.settings(common.clone()));
        let surface = Surface::read(settings.as_ref().unwrap_or(common))?;
        surface.check(mesh)?;
        thickness.extend(std::iter::repeat_n(surface.thickness_of(mesh), *count));
        friction.extend(std::iter::repeat_n(*surface.friction, *count));
    }
    Ok(Some(PieceContact {
        thickness: ordered(thickness, order),
        friction: ordered(friction, order),
        piece: ordered(piece, order),
        excluded,
    }))
}

fn ordered<T: Copy>(values: Vec<T>, order: Option<&Order>) -> Vec<T> {
    match order {
        Some(order) => order.apply(&values),
        None => values,
    }
}

/// The pieces that one passes through.
fn others(section: &Section<'_>, count: usize) -> Result<impl Iterator<Item = u32>, BenchError> {
    let own = section.read::<keys::PieceContact>()?;
    let numbers = (*own.exclude).clone().unwrap_or_default();
    match numbers.iter().find(|&&number| number as usize >= count) {
        Some(&number) => Err(own.exclude.refuse(names::beyond("mesh", number, count))),
        None => Ok(numbers.into_iter()),
    }
}

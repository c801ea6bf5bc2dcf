//! `[mesh.contact]`: pieces that are not equally thick or rough.

use super::document::Section;
use crate::error::BenchError;
use crate::scene::contact::{EXCLUDE, FRICTION, PieceContact, THICKNESS};
use crate::settings::Settings;
use cloth_core::math::Real;
use cloth_core::method::ordering::Order;

/// Thickness and friction of every vertex, if a piece has its own; `common` is what `[contact]` says, `counts` are the
/// numbers of vertices of the pieces.
pub(super) fn of_pieces(
    common: &Settings,
    own: &[Option<Section<'_>>],
    counts: &[usize],
    order: Option<&Order>,
) -> Result<Option<PieceContact>, BenchError> {
    if own.iter().all(Option::is_none) {
        return Ok(None);
    }
    let (mut thickness, mut friction) = (Vec::new(), Vec::new());
    let (mut piece, mut excluded) = (Vec::new(), Vec::new());
    for ((number, section), count) in (0..).zip(own).zip(counts) {
        for other in section
            .iter()
            .flat_map(|section| others(section, own.len()))
        {
            excluded.push([number, other?]);
        }
        piece.extend(std::iter::repeat_n(number, *count));
        let [h, mu]: [Real; 2] = match section {
            None => [common.positive(&THICKNESS)?, common.number(&FRICTION)?],
            Some(section) => {
                let settings = section.settings(common.clone())?;
                let blame = |error| section.blame(error, &Settings::default());
                let mu = section.not_negative(&FRICTION)?;
                let h = settings.positive(&THICKNESS).map_err(blame)?;
                [h, mu.map_or_else(|| settings.number(&FRICTION), Ok)?]
            }
        };
        thickness.extend(std::iter::repeat_n(h, *count));
        friction.extend(std::iter::repeat_n(mu, *count));
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
fn others(section: &Section<'_>, count: usize) -> Vec<Result<u32, BenchError>> {
    let numbers = match section.counts(&EXCLUDE) {
        Ok(numbers) => numbers.unwrap_or_default(),
        Err(error) => return vec![Err(error)],
    };
    let checked = |number: u64| match u32::try_from(number) {
        Ok(number) if (number as usize) < count => Ok(number),
        _ => {
            let message = format!("there is no mesh {number}, only 0 to {}", count - 1);
            Err(section.refuse(&EXCLUDE, message))
        }
    };
    numbers.into_iter().map(checked).collect()
}

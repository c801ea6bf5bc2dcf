//! `[mesh.contact]`: pieces that are not equally thick or rough.

use super::document::Section;
use crate::error::BenchError;
use crate::scene::contact::{FRICTION, PieceContact, THICKNESS};
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
    for (section, count) in own.iter().zip(counts) {
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
    let ordered = |values: Vec<Real>| match order {
        Some(order) => order.apply(&values),
        None => values,
    };
    Ok(Some(PieceContact {
        thickness: ordered(thickness),
        friction: ordered(friction),
    }))
}

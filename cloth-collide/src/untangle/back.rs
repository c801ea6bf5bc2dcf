//! The way back: no vertex stays farther from where it was than contact asks for.

use crate::bounds::farthest;
use crate::potential::PotentialContacts;
use cloth_core::contact::{ContactError, ContactStep, Projection};
use cloth_core::math::{Real, Vec3};

/// Substeps back, at most, and sweeps in each.
const MOST_RETURNS: u32 = 100;
const SWEEPS: u32 = 30;
/// The longest path (in thicknesses) of a substep. All paths are shortened alike, so that what meets halfway goes
/// halfway.
const LONGEST: Real = 5.0;
/// The last substep moves nothing by more than this fraction of the thickness.
const AT_REST: Real = 1e-3;
/// Size (s) of a substep so long that contact does not give way.
const LONG: Real = 1e3;

/// Moves the `positions` (m) of an untangled cloth as near to its tangled `start` (m) as `contacts` let it come without
/// passing through itself again. For layers that are a thickness apart these have to push from the
/// [full thickness](crate::potential::PotentialBuilder::full_thickness) on: those of one piece no farther apart than at
/// rest, unless they touch there.
///
/// Each substep wants all vertices back at the start, and projects that onto the contact constraints (the nearest place
/// in the metric of the masses), until nothing moves any more. Every straight path in between is free of crossings.
/// Vertices with an `inverse_mass` (1/kg) of 0 stay.
///
/// # Errors
/// [`ContactError`]: positions that are tangled or not finite.
///
/// # Panics
/// If there is not one start, one inverse mass and one position per vertex.
pub fn project_back(
    contacts: &mut PotentialContacts,
    inverse_mass: &[Real],
    start: &[Vec3],
    positions: &mut [Vec3],
) -> Result<(), ContactError> {
    let (count, thickness) = (contacts.near().cloth, contacts.near().law.range());
    assert_eq!(start.len(), count, "one start a vertex");
    assert_eq!(inverse_mass.len(), count, "one mass a vertex");
    assert_eq!(positions.len(), count, "one position a vertex");
    let mut projection = Projection::default();
    let (mut from, mut velocities) = (positions.to_vec(), vec![Vec3::zeros(); count]);
    for _ in 0..MOST_RETURNS {
        from.copy_from_slice(positions);
        let farthest_back = farthest(start, &from, Vec3::zeros());
        let fraction = (LONGEST * thickness / farthest_back).min(1.0);
        for ((x, start), w) in positions.iter_mut().zip(start).zip(inverse_mass) {
            if *w > 0.0 {
                *x += (start - *x) * fraction;
            }
        }
        let step = ContactStep {
            from: &from,
            inverse_mass,
            dt: LONG,
        };
        projection.step(contacts, &step, SWEEPS, positions, &mut velocities)?;
        if farthest(&from, positions, Vec3::zeros()) < AT_REST * thickness {
            break;
        }
    }
    Ok(())
}

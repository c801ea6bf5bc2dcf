//! `[start]`: how the cloth differs from rest when the run begins.

use super::document::Section;
use super::keys::Start;
use crate::error::BenchError;
use crate::scene::Scene;
use std::f64::consts::TAU;

pub(super) fn apply(section: &Section<'_>, scene: &mut Scene) -> Result<(), BenchError> {
    let own = section.read::<Start>()?;
    if let Some(velocity) = *own.velocity {
        let inverse_mass = scene.model.particles.inverse_mass();
        for (v, w) in scene.start.velocities.iter_mut().zip(inverse_mass) {
            if *w > 0.0 {
                *v = velocity;
            }
        }
    }
    match (*own.wave, *own.wave_number) {
        (None, None) => {}
        (Some(wave), Some(number)) => {
            let number = number * TAU;
            for x in &mut scene.start.positions {
                *x += wave * number.dot(x).sin();
            }
        }
        _ => return Err(section.refuse_table("wave and wave_number go together")),
    }
    Ok(())
}

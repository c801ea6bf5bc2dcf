//! Cloth that is stretched farther than cloth can be.

use crate::error::BenchError;
use crate::scene::Scene;
use cloth_core::cloth::Elements;
use cloth_core::energy::Spring;
use cloth_core::math::{Real, Vec3, gather};
use cloth_core::method::family::Energies;
use cloth_core::particles::State;

/// Strain from which on it is worth a warning: woven cloth tears at a third of it, and a balloon of linear cloth that
/// has passed it has no equilibrium any more.
const WORTH_A_WARNING: Real = 1.0;
/// Strain and coordinate (m) from which on numbers are nonsense.
const NONSENSE: [Real; 2] = [1e6, 1e9];

/// The largest strain after any step.
#[derive(Debug, Default)]
pub(super) struct StretchWatch {
    gauges: Vec<Spring>,
    /// After how many changes of the scene these are.
    changes: Option<usize>,
    /// Dimensionless.
    pub(super) strain: Real,
    /// The edge, in the caller's numbers, and the step.
    place: ([u32; 2], u32),
}

impl StretchWatch {
    /// Looks at the state after a step of a scene that has changed so many times.
    pub(super) fn look(
        &mut self,
        (scene, changes): (&Scene, usize),
        state: &State,
        step: u32,
    ) -> Result<(), BenchError> {
        if self.changes != Some(changes) {
            self.gauges = scene.gauges()?;
            self.changes = Some(changes);
        }
        let [most, farthest] = NONSENSE;
        let x = &state.positions;
        if let Some((v, x)) = (0..).zip(x).find(|(_, x)| x.amax() > farthest) {
            let v = scene.named(v);
            return Err(BenchError::Failed(format!(
                "step {step} took vertex {v} {:.1e} m away: forces without an equilibrium, or too large a step",
                x.amax()
            )));
        }
        for spring in self.gauges.iter().filter(|s| s.rest_length > 0.0) {
            let [a, b] = gather(x, spring.vertices);
            let strain = (a - b).norm() / spring.rest_length - 1.0;
            if strain > self.strain {
                self.strain = strain;
                self.place = (spring.vertices.map(|v| scene.named(v)), step);
            }
        }
        if self.strain > most {
            let [a, b] = self.place.0;
            return Err(BenchError::Failed(format!(
                "step {step} stretched the edge between vertices {a} and {b} to {:.1e} times its length: forces without \
                 an equilibrium, or too large a step{}",
                1.0 + self.strain,
                pressure(scene)
            )));
        }
        Ok(())
    }

    /// A sentence about it, if it is worth one.
    pub(super) fn warning(&self, scene: &Scene) -> Option<String> {
        let ([a, b], step) = self.place;
        (self.strain > WORTH_A_WARNING).then(|| {
            format!(
                "the cloth was stretched farther than cloth can be: after step {step} the edge between vertices {a} and \
                 {b} was {:.3} times as long as at rest{}",
                1.0 + self.strain,
                pressure(scene)
            )
        })
    }
}

/// Of a gas inside that the membrane cannot hold, as the end of a sentence.
///
/// A sphere of radius R whose membrane is stretched by s has the tension `B s` (N/m) per length at rest, and a pressure
/// p pulls with `½ p R (1 + s)²`. The two can be equal where `½ p R ≤ B/4`, and at the end of that range s is 1.
fn pressure(scene: &Scene) -> String {
    /// The strain by which B is measured.
    const SMALL: Real = 1e-6;
    let Some(mesh) = &scene.mesh else {
        return String::new();
    };
    let x = mesh.positions();
    let gases = scene.gases.iter().map(|gas| gas.tension(x));
    let tensions = gases.chain(scene.volumes.iter().map(|volume| volume.tension(x)));
    let tension = tensions.fold(0.0, Real::max);
    let is_membrane = |family: &Elements| {
        matches!(
            family,
            Elements::Springs(_) | Elements::Stvk(_) | Elements::Arap(_)
        )
    };
    let membrane = scene.model.families().into_iter().filter(is_membrane);
    let energies = Energies::new(x.len()).with_elements(membrane.collect());
    let stretched: Vec<Vec3> = x.iter().map(|x| x * (1.0 + SMALL)).collect();
    let stored = energies.map_or(Real::INFINITY, |energies| energies.value(&stretched));
    let most = 0.25 * stored / (mesh.area() * SMALL * SMALL);
    if tension > most {
        format!(
            "; the pressure inside pulls at it with p R/2 = {tension:.3e} N/m at rest, and a sphere of this cloth can \
             hold no more than {most:.3e} N/m"
        )
    } else {
        String::new()
    }
}

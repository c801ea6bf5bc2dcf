//! What takes the steps of a run, and is made anew where the cloth changes.

use crate::error::BenchError;
use crate::method::Method;
use crate::scene::{Change, ChangeKind, Scene};
use crate::settings::Settings;
use cloth_core::cloth::Elements;
use cloth_core::math::Real;
use cloth_core::step::Stepper;

/// Who takes the steps of a run.
pub struct Solver<'a> {
    stepper: Taken<'a>,
    /// What makes it anew where the cloth changes.
    from: Option<(&'a Method, &'a Settings)>,
    /// Of a scene that is torn.
    torn: Option<Torn>,
}

/// The elements that it was built with, and what it has lost of them since then.
struct Torn {
    families: Vec<Elements>,
    lost: Vec<[usize; 2]>,
}

impl Torn {
    fn of(scene: &Scene) -> Option<Self> {
        let is_tear = |change: &Change| matches!(change.kind, ChangeKind::Tear { .. });
        scene.changes.iter().any(is_tear).then(|| Self {
            families: scene.model.families(),
            lost: Vec::new(),
        })
    }
}

enum Taken<'a> {
    Owned(Box<dyn Stepper>),
    Lent(&'a mut dyn Stepper),
}

impl std::fmt::Debug for Solver<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Solver")
            .field("from", &self.from)
            .finish_non_exhaustive()
    }
}

impl<'a> Solver<'a> {
    /// A method with these settings, for a scene at its start and steps of `dt` (s).
    pub fn new(
        method: &'a Method,
        settings: &'a Settings,
        scene: &Scene,
        dt: Real,
    ) -> Result<Self, BenchError> {
        Ok(Self {
            stepper: Taken::Owned(method.build(scene, settings, dt)?),
            from: Some((method, settings)),
            torn: Torn::of(scene),
        })
    }

    /// One that cannot be made anew.
    pub(super) fn lent(stepper: &'a mut dyn Stepper) -> Self {
        Self {
            stepper: Taken::Lent(stepper),
            from: None,
            torn: None,
        }
    }

    /// What takes the steps.
    pub fn stepper(&mut self) -> &mut dyn Stepper {
        match &mut self.stepper {
            Taken::Owned(stepper) => &mut **stepper,
            Taken::Lent(stepper) => *stepper,
        }
    }

    /// Whether it could take notice of a change as it is, after which the scene is this.
    pub(super) fn takes(&mut self, change: &Change, after: &Scene) -> bool {
        match &change.kind {
            ChangeKind::Hold { vertices, .. } => self.stepper().set_prescribed(vertices, true),
            ChangeKind::Release { vertices } => self.stepper().set_prescribed(vertices, false),
            ChangeKind::Push { .. } | ChangeKind::Drive { .. } | ChangeKind::LetGo { .. } => true,
            ChangeKind::Tear { .. } => self.loses(&after.model.families()),
            ChangeKind::Tie { .. } | ChangeKind::Untie { .. } | ChangeKind::Sew { .. } => false,
        }
    }

    /// Whether it could lose all elements that are not among `left`.
    fn loses(&mut self, left: &[Elements]) -> bool {
        let Some(torn) = &mut self.torn else {
            return false;
        };
        let Some(lost) = Elements::lost(&torn.families, left) else {
            return false;
        };
        let is_new = |element: &&[usize; 2]| torn.lost.binary_search(element).is_err();
        let new: Vec<[usize; 2]> = lost.iter().filter(is_new).copied().collect();
        torn.lost = lost;
        self.stepper().remove_elements(&new)
    }

    pub(super) fn build(&mut self, scene: &Scene, dt: Real) -> Result<(), BenchError> {
        let Some((method, settings)) = self.from else {
            return Err(BenchError::Usage(format!(
                "the cloth of scene `{}` changes on the way, and this solver cannot be made anew",
                scene.name
            )));
        };
        self.stepper = Taken::Owned(method.build(scene, settings, dt)?);
        self.torn = Torn::of(scene);
        Ok(())
    }
}

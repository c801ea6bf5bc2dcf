//! What may change between two steps: pins, attachments, elements.

use crate::global::Term;
use crate::solver::PdSolver;
use cloth_core::energy::Attachment;
use cloth_core::math::{Real, Vec3, is_finite};
use std::fmt;

/// The stiffest attachment (N/m): of one that is 10⁸ times as stiff as cloth of 10⁴ N/m, half of the digits are left
/// when it goes.
const STIFFEST: Real = 1e12;

/// Names an attachment that was made with [`PdSolver::attach`], and no other one, also once it has been taken away.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AttachmentId {
    /// Its place, which a later one may take.
    place: u32,
    /// How many there have been in that place before it.
    number: u32,
}

/// Changes of the cloth between two steps.
///
/// The next step applies them all at once: by a correction of the factor in every solve as long as that is
/// cheaper, else by a factorisation, which it reports. It may allocate. A coarse grid is made anew whatever the factor
/// does, if a pin or an element has changed: it is reported too (`coarse_builds`), and takes no part in the choice
/// between correction and factorisation. To move what is prescribed or attached already changes no matrix and costs
/// nothing.
///
/// What makes the factor of `A = M/Δt² + Σ w SᵀS` stale:
///
/// | change | the next step |
/// |---|---|
/// | state, gravity, load, a rest length in time, the target of an attachment | solves with the factor |
/// | the path of a prescribed vertex | the same: its velocity is data of the step |
/// | contacts, friction | keeps the factor: no contact is in A (below) |
/// | [`prescribe`](PdSolver::prescribe), [`attach`](PdSolver::attach) | corrects by rank 1 |
/// | [`detach`](PdSolver::detach) | the same |
/// | [`release`](PdSolver::release) | corrects by rank 2 |
/// | [`remove`](PdSolver::remove) | corrects by a rank for each row of S |
/// | so many of these that a correction is dearer; another Δt | factorises, in the same pattern |
/// | another mass, weight or stiffness; a new element or vertex | cannot: build another solver |
///
/// With active contacts directions do without the factor (`hessian.rs`). Without pairs, and where such a direction
/// fails, it preconditions conjugate gradients (`contact.rs`).
impl PdSolver {
    /// Grabs a vertex: from now on it moves with its own velocity whatever the forces.
    ///
    /// # Errors
    /// [`ChangeError::NoSuchVertex`].
    pub fn prescribe(&mut self, vertex: usize) -> Result<(), ChangeError> {
        self.require(vertex)?;
        if !self.objective.particles.is_prescribed(vertex) {
            self.objective
                .particles
                .prescribe(vertex)
                .map_err(|_| ChangeError::NoSuchVertex { vertex })?;
            self.global.set_mass(vertex, None);
            self.is_stale = true;
        }
        Ok(())
    }

    /// Lets a prescribed vertex go.
    ///
    /// # Errors
    /// [`ChangeError::NoSuchVertex`].
    pub fn release(&mut self, vertex: usize) -> Result<(), ChangeError> {
        self.require(vertex)?;
        let particles = &mut self.objective.particles;
        if particles.is_prescribed(vertex) {
            particles
                .release(vertex)
                .map_err(|_| ChangeError::NoSuchVertex { vertex })?;
            self.global.set_mass(vertex, Some(particles.mass()[vertex]));
            self.is_stale = true;
        }
        Ok(())
    }

    /// Attaches a vertex to a point by a spring without length: a hand, a hook, a contact.
    ///
    /// The vertex stays off its target by load over stiffness. With n springs of k (N/m) at each vertex of mass m the
    /// eigenvalues of A are between `m/Δt²` and `m/Δt² + 2 n k` (Gershgorin), and an attachment of stiffness K makes
    /// the upper bound at most `m/Δt² + 2 n k + K`: for K = 100 k and n = 8 seven times as large. Cholesky's
    /// factorisation loses nothing by that: its error follows the condition of the matrix scaled to a unit diagonal
    /// (N. J. Higham, *Accuracy and Stability of Numerical Algorithms*, 2002, section 10.1), in which a large diagonal
    /// entry only uncouples its row. [`detach`](PdSolver::detach), as a correction of a factor that has K in it,
    /// subtracts nearly equal numbers, and loses as many digits as K/(n k) has.
    ///
    /// # Errors
    /// [`ChangeError::NoSuchVertex`]; [`ChangeError::InvalidAttachment`] for a stiffness that is not positive or above
    /// 10¹² N/m, or a target that is not finite. (A vertex that is to yield even less is better
    /// [prescribed](Self::prescribe).)
    pub fn attach(&mut self, attachment: Attachment) -> Result<AttachmentId, ChangeError> {
        self.require(attachment.vertex as usize)?;
        let stiffness = attachment.stiffness;
        if !(stiffness > 0.0 && stiffness <= STIFFEST && is_finite(&attachment.target)) {
            return Err(ChangeError::InvalidAttachment { attachment });
        }
        self.add_attachment_term(attachment.vertex, stiffness);
        let attachments = &mut self.objective.attachments;
        let free = attachments.iter().position(|other| other.stiffness == 0.0);
        let index = free.unwrap_or(attachments.len());
        if free.is_none() {
            attachments.push(attachment);
            self.objective.attachment_numbers.push(0);
        }
        attachments[index] = attachment;
        let (place, number) = (index as u32, self.objective.attachment_numbers[index]);
        Ok(AttachmentId { place, number })
    }

    /// Moves the target (m) of an attachment.
    ///
    /// # Errors
    /// [`ChangeError::NoSuchAttachment`]; [`ChangeError::InvalidAttachment`] for a target that is not finite.
    pub fn move_attachment(&mut self, id: AttachmentId, target: Vec3) -> Result<(), ChangeError> {
        let index = self.index_of(id)?;
        let moved = Attachment {
            target,
            ..self.objective.attachments[index]
        };
        if !is_finite(&target) {
            return Err(ChangeError::InvalidAttachment { attachment: moved });
        }
        self.objective.attachments[index] = moved;
        Ok(())
    }

    /// Takes an attachment away.
    ///
    /// # Errors
    /// [`ChangeError::NoSuchAttachment`].
    pub fn detach(&mut self, id: AttachmentId) -> Result<(), ChangeError> {
        let index = self.index_of(id)?;
        let gone = &mut self.objective.attachments[index];
        let (vertex, stiffness) = (gone.vertex, gone.stiffness);
        gone.stiffness = 0.0;
        self.objective.attachment_numbers[index] += 1;
        self.add_attachment_term(vertex, -stiffness);
        Ok(())
    }

    /// Takes an element away: a thread that tears. `family` counts the calls of
    /// [`PdBuilder::energy`](crate::PdBuilder::energy), `element` the elements that were given there, both from 0.
    ///
    /// # Errors
    /// [`ChangeError::NoSuchElement`], also if it has been taken away before.
    pub fn remove(&mut self, family: usize, element: usize) -> Result<(), ChangeError> {
        let mut terms = Vec::new();
        let families = &mut self.objective.families;
        families
            .get_mut(family)
            .and_then(|family| family.remove(element, &mut terms))
            .ok_or(ChangeError::NoSuchElement { family, element })?;
        self.global.remove(family, terms);
        self.is_stale = true;
        Ok(())
    }

    fn require(&self, vertex: usize) -> Result<(), ChangeError> {
        if vertex < self.objective.particles.len() {
            Ok(())
        } else {
            Err(ChangeError::NoSuchVertex { vertex })
        }
    }

    fn index_of(&self, id: AttachmentId) -> Result<usize, ChangeError> {
        let index = id.place as usize;
        match self.objective.attachment_numbers.get(index) {
            Some(number) if *number == id.number => Ok(index),
            _ => Err(ChangeError::NoSuchAttachment),
        }
    }

    fn add_attachment_term(&mut self, vertex: u32, weight: Real) {
        self.global.add(Term {
            column: vec![(vertex, 1.0)],
            weight,
        });
        self.are_attachments_stale = true;
    }
}

/// Why a change was refused.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum ChangeError {
    /// A vertex was named that does not exist.
    NoSuchVertex {
        /// The vertex.
        vertex: usize,
    },
    /// An element was named that does not exist, or no longer.
    NoSuchElement {
        /// The family.
        family: usize,
        /// The element.
        element: usize,
    },
    /// An attachment was named that has been taken away.
    NoSuchAttachment,
    /// The stiffness is not above 0 and at most 10¹² N/m, or the target is not finite.
    InvalidAttachment {
        /// What was given.
        attachment: Attachment,
    },
}

impl fmt::Display for ChangeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoSuchVertex { vertex } => write!(f, "there is no vertex {vertex}"),
            Self::NoSuchElement { family, element } => {
                write!(f, "there is no element {element} in family {family}")
            }
            Self::NoSuchAttachment => write!(f, "that attachment has been taken away"),
            Self::InvalidAttachment { attachment } => write!(
                f,
                "an attachment has to have a stiffness above 0 and of {STIFFEST:.0e} N/m at most, and a finite target, but this \
                 one is {attachment:?}"
            ),
        }
    }
}

impl std::error::Error for ChangeError {}

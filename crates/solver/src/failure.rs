//! What a system answers when it cannot evaluate itself at a state.
//!
//! A failure is data, not control flow: line searches react to [`FailureKind::Inadmissible`] by shortening the step,
//! integrators hand any failure back with the state untouched.
//! `place` lets the caller of this crate say *which* of its parts refused; the solvers only carry it along.

/// Why a system could not be evaluated, or why a step was given up.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{message}")]
pub struct Failure {
    /// What kind of refusal it is; decides how a solver reacts.
    pub kind: FailureKind,
    /// Index of the culprit in a numbering that belongs to the system (for values found here: the unknown's index).
    pub place: Option<usize>,
    /// What happened, in words for a person.
    pub message: String,
}

/// How a solver should understand a [`Failure`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FailureKind {
    /// The state lies outside the domain of the system; a shorter step towards it may be fine.
    Inadmissible,
    /// A value is infinite or not a number; a shorter step may be fine.
    NotFinite,
    /// A linear solve gave no usable answer.
    LinearSolve,
    /// Nonlinear iterations gave no usable answer.
    Nonlinear,
    /// Something that no shorter step will cure.
    Other,
}

impl Failure {
    /// A state outside the domain of the system.
    pub fn inadmissible(place: Option<usize>, message: impl Into<String>) -> Self {
        Self { kind: FailureKind::Inadmissible, place, message: message.into() }
    }

    /// A failure that a shorter step cannot cure.
    pub fn other(message: impl Into<String>) -> Self {
        Self { kind: FailureKind::Other, place: None, message: message.into() }
    }

    /// Whether trying a state nearer to the last good one makes sense.
    pub fn shorter_may_help(&self) -> bool {
        matches!(self.kind, FailureKind::Inadmissible | FailureKind::NotFinite)
    }
}

/// Refuses a vector that holds an infinity or a NaN, naming the vector and the first such unknown.
///
/// # Errors
/// [`FailureKind::NotFinite`] with the index of the unknown as `place`.
pub fn check_finite(name: &str, values: &[f64]) -> Result<(), Failure> {
    match values.iter().position(|value| !value.is_finite()) {
        None => Ok(()),
        Some(index) => Err(Failure {
            kind: FailureKind::NotFinite,
            place: Some(index),
            message: format!("{name} of unknown {index} is {}", values[index]),
        }),
    }
}

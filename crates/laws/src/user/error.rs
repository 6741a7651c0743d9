//! What may be wrong with the text of a user law, and where.

use super::formula::Shape;
use std::fmt;

/// A text that is no energy: the place and the reason.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub struct UserLawError {
    /// The text of the energy.
    pub text: String,
    /// Where in it, in characters from 1; none when a parameter is at fault.
    pub column: Option<usize>,
    /// What is wrong, and what was expected.
    pub problem: Problem,
}

impl fmt::Display for UserLawError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.column {
            Some(column) => write!(f, "energy, column {column}: {}", self.problem),
            None => write!(f, "energy: {}", self.problem),
        }
    }
}

impl UserLawError {
    /// The text with a caret below the place, in two lines; empty when a parameter is at fault.
    ///
    /// Long texts are cut to the neighbourhood of the place.
    pub fn excerpt(&self) -> String {
        const AROUND: usize = 36;
        let Some(column) = self.column else { return String::new() };
        let first = column.saturating_sub(1 + AROUND);
        let shown: String = self.text.chars().skip(first).take(2 * AROUND).collect();
        // Line breaks inside the text would part the caret from its place.
        let shown: String = shown.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
        format!("{shown}\n{}^", " ".repeat(column - 1 - first))
    }
}

/// What is wrong with the text of a user law.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Problem {
    /// Nothing but space.
    #[error("the energy is empty; expected an expression such as `mu/2*(I1 - 3) - mu*ln(J)`")]
    Empty,
    /// More characters than anyone writes.
    #[error("the energy has more than {limit} characters")]
    TooLong {
        /// Most characters.
        limit: usize,
    },
    /// Parentheses, signs or powers inside each other.
    #[error("the expression is nested more than {limit} deep")]
    TooDeep {
        /// Deepest nesting.
        limit: usize,
    },
    /// A character that means nothing here.
    #[error("unexpected character `{found}`{hint}")]
    Character {
        /// The character.
        found: char,
        /// What to write instead, or nothing.
        hint: &'static str,
    },
    /// A number that is none.
    #[error("`{found}` is not a finite number")]
    Number {
        /// The digits as written.
        found: String,
    },
    /// Something else than what may follow here.
    #[error("expected {expected}, found {found}")]
    Expected {
        /// What may stand here.
        expected: String,
        /// What stands here.
        found: String,
    },
    /// A name that is neither a measure of deformation, nor a parameter.
    #[error("there is no name `{found}`{}; {known}", suggested(.nearest))]
    UnknownName {
        /// The name.
        found: String,
        /// A name much like it.
        nearest: Option<String>,
        /// The names that there are, as a sentence.
        known: String,
    },
    /// A call of something that is no function.
    #[error("there is no function `{found}`{}; functions are {known}", suggested(.nearest))]
    UnknownFunction {
        /// Its name.
        found: String,
        /// A function with a similar name.
        nearest: Option<String>,
        /// All functions.
        known: String,
    },
    /// A function without its arguments.
    #[error("`{name}` is a function; write {usage}")]
    FunctionAlone {
        /// Its name.
        name: String,
        /// How it is called.
        usage: String,
    },
    /// Too few or too many arguments, or arguments of the wrong shape.
    #[error("{usage}; found {found}")]
    Arguments {
        /// What the function takes, as a sentence.
        usage: String,
        /// Shapes of the arguments.
        found: String,
    },
    /// An operation between things that do not fit.
    #[error("{operation} of {left} and {right} is not defined{hint}")]
    Operation {
        /// Such as "the product".
        operation: &'static str,
        /// Shape of the first.
        left: Shape,
        /// Shape of the second.
        right: Shape,
        /// What to write instead, or nothing.
        hint: &'static str,
    },
    /// The whole is no number.
    #[error("an energy is a number, this is {found}; `tr`, `det`, `dot` and indices such as `[1, 1]` give numbers")]
    NotScalar {
        /// What it is.
        found: Shape,
    },
    /// An index of something without indices, too few or too many of them, or one out of 1 to 3.
    #[error("{expected}, found {found}")]
    Index {
        /// What may be written.
        expected: &'static str,
        /// What is written.
        found: String,
    },
    /// Powers of powers of powers.
    #[error("powers inside each other make an exponent above {limit}")]
    Exponent {
        /// Largest exponent.
        limit: u32,
    },
    /// A parameter whose name is no name, or taken.
    #[error("a parameter cannot be called `{name}`: {reason}")]
    ParameterName {
        /// The name.
        name: String,
        /// Why not.
        reason: &'static str,
    },
    /// A parameter with an impossible value.
    #[error("parameter `{name}` must be {expected}, found {found}")]
    ParameterValue {
        /// Its name.
        name: String,
        /// What it may be.
        expected: &'static str,
        /// What it is.
        found: String,
    },
    /// A parameter that has no effect.
    #[error("the energy does not use the parameter `{name}`")]
    UnusedParameter {
        /// Its name.
        name: String,
    },
}

fn suggested(nearest: &Option<String>) -> String {
    nearest.as_ref().map(|name| format!(", did you mean `{name}`?")).unwrap_or_default()
}

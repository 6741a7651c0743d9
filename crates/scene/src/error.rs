//! What can be wrong with a scene, always with the place, what was expected and what to do about it.
//!
//! One line per error, all of them at once: `scene.toml:12:9: unknown key `regoin` in [[body.fix]]; did you mean
//! `region`?`

use std::fmt;

use crate::location::Location;
use crate::units::UnitError;

/// One thing that is wrong.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Problem {
    /// The text is not TOML.
    #[error("not valid TOML: {0}")]
    Syntax(String),
    /// A key that its table does not have.
    #[error("unknown key `{key}` in {section}{}", unknown_hint(.nearest, .elsewhere, .known))]
    UnknownKey {
        /// The key.
        key: String,
        /// The table: `[[body.fix]]`.
        section: &'static str,
        /// The most similar key of that table.
        nearest: Option<String>,
        /// Another table that has this very key.
        elsewhere: Option<&'static str>,
        /// All keys of the table.
        known: Vec<&'static str>,
    },
    /// A name that is none of those that exist: of a law, an element, a method, ….
    #[error("unknown {what} `{found}`{}; known: {}", did_you_mean(.nearest.as_deref()), .known.join(", "))]
    UnknownName {
        /// What it should name: "law".
        what: String,
        /// The name.
        found: String,
        /// The most similar name.
        nearest: Option<String>,
        /// The names that exist.
        known: Vec<String>,
    },
    /// A parameter that the law does not have.
    #[error("law `{law}` has no parameter `{found}`{}; its parameters: {}", did_you_mean(.nearest.as_deref()), .known.join(", "))]
    UnknownParameter {
        /// The law.
        law: String,
        /// The key.
        found: String,
        /// The most similar parameter.
        nearest: Option<String>,
        /// Parameters of the law.
        known: Vec<String>,
    },
    /// A parameter without a default that was not given.
    #[error("law `{law}` needs {needed}{}", found_instead(.given))]
    MissingParameter {
        /// The law.
        law: String,
        /// What is needed, with units: "`young`, Young's modulus".
        needed: String,
        /// Related parameters that were given.
        given: Vec<String>,
    },
    /// A value of another type.
    #[error("`{key}` must be {expected}, found {found}")]
    WrongType {
        /// The key.
        key: String,
        /// "a whole number".
        expected: String,
        /// "the text \"abc\"".
        found: String,
    },
    /// A quantity in a text that cannot be read.
    #[error("`{key}`: {source}")]
    Unit {
        /// The key.
        key: String,
        /// Why.
        source: UnitError,
    },
    /// A value outside its range.
    #[error("`{key}` must be {expected}, found {found}{}", hint_text(.hint.as_deref()))]
    OutOfRange {
        /// The key.
        key: String,
        /// "greater than 0 Pa".
        expected: String,
        /// The value.
        found: String,
        /// What to do.
        hint: Option<String>,
    },
    /// A key that must be given.
    #[error("{section} needs `{key}`: {about}")]
    Missing {
        /// The table.
        section: &'static str,
        /// The key.
        key: String,
        /// What it is for.
        about: String,
    },
    /// The same name twice.
    #[error("there is already a {what} named \"{name}\" ({first}); give this one another name")]
    Duplicate {
        /// "body", "probe", "region".
        what: &'static str,
        /// The name.
        name: String,
        /// Where it was used first.
        first: Location,
    },
    /// Values that are fine alone but not together.
    #[error("{0}")]
    Conflict(String),
    /// A law refused its parameters or its energy.
    #[error("{0}")]
    Law(String),
    /// An override that cannot be applied.
    #[error("{0}")]
    Override(String),
}

/// A [`Problem`] with its place.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneError {
    /// Where.
    pub location: Location,
    /// What.
    pub problem: Problem,
}

impl SceneError {
    /// `scene.toml:12:9: message`.
    pub fn in_file(&self, file_name: &str) -> String {
        format!("{}: {}", self.location.in_file(file_name), self.problem)
    }
}

/// Everything that is wrong with a scene, in the order of the text; overrides come last.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneErrors {
    /// The file name given to `parse`.
    pub file_name: String,
    /// At least one.
    pub errors: Vec<SceneError>,
}

impl fmt::Display for SceneErrors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let lines: Vec<String> = self.errors.iter().map(|e| e.in_file(&self.file_name)).collect();
        f.write_str(&lines.join("\n"))
    }
}

impl std::error::Error for SceneErrors {}

/// Something that is allowed but probably not meant.
#[derive(Clone, Debug, PartialEq)]
pub struct Warning {
    /// Where.
    pub location: Location,
    /// What, and what to do.
    pub message: String,
}

impl Warning {
    /// `scene.toml:12:9: warning: message`.
    pub fn in_file(&self, file_name: &str) -> String {
        format!("{}: warning: {}", self.location.in_file(file_name), self.message)
    }
}

/// `; did you mean …?`, or nothing.
pub(crate) fn did_you_mean(nearest: Option<&str>) -> String {
    nearest.map(|name| format!("; did you mean `{name}`?")).unwrap_or_default()
}

fn unknown_hint(nearest: &Option<String>, elsewhere: &Option<&'static str>, known: &[&str]) -> String {
    match (nearest, elsewhere) {
        (Some(nearest), _) => did_you_mean(Some(nearest)),
        (None, Some(section)) => format!("; it belongs to {section}"),
        (None, None) => format!("; its keys: {}", known.join(", ")),
    }
}

fn found_instead(given: &[String]) -> String {
    if given.is_empty() { String::new() } else { format!("; only {} is given", given.join(", ")) }
}

fn hint_text(hint: Option<&str>) -> String {
    hint.map(|text| format!("; {text}")).unwrap_or_default()
}

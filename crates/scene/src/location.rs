//! Where a value was written, and values that remember it.
//!
//! A later stage that finds fault with a value (`region "x_mx" selects nothing`) points at the place in the scene with
//! the [`Location`] that the value carries.
//! Places never take part in comparison, serialisation or hashing: moving a line does not change a simulation.

use std::fmt;
use std::ops::Deref;
use std::sync::Arc;

use serde::{Serialize, Serializer};

/// Where a value of the scene comes from.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Location {
    /// Not written anywhere: a default.
    Default,
    /// In the text of the scene.
    File {
        /// Line, from 1.
        line: u32,
        /// Column in characters, from 1.
        column: u32,
    },
    /// In an override of the form `key=value`, which is the payload.
    Override(Arc<str>),
}

impl Location {
    /// The prefix of a message: `scene.toml:41:10`, or `--set time.end=0.5`, or `scene.toml` for a default.
    pub fn in_file(&self, file_name: &str) -> String {
        match self {
            Location::Default => file_name.to_owned(),
            Location::File { line, column } => format!("{file_name}:{line}:{column}"),
            Location::Override(text) => format!("--set {text}"),
        }
    }

    /// The line in the scene, where there is one.
    pub fn line(&self) -> Option<u32> {
        match self {
            Location::File { line, .. } => Some(*line),
            _ => None,
        }
    }
}

/// Without the file's name: `line 41`, `--set time.end=0.5`, `a default`.
impl fmt::Display for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Location::Default => write!(f, "a default"),
            Location::File { line, .. } => write!(f, "line {line}"),
            Location::Override(text) => write!(f, "--set {text}"),
        }
    }
}

/// A value and the place where it was written.
///
/// Two of them are equal when their values are; serialised, it is the value alone.
#[derive(Clone, Debug)]
pub struct Spanned<T> {
    /// The value.
    pub value: T,
    /// Where it was written.
    pub at: Location,
}

impl<T> Spanned<T> {
    /// A value written at a place.
    pub fn new(value: T, at: Location) -> Self {
        Spanned { value, at }
    }

    /// A value that nobody wrote: a default.
    pub fn default_value(value: T) -> Self {
        Spanned { value, at: Location::Default }
    }

    /// Another value at the same place.
    pub fn map<U>(self, change: impl FnOnce(T) -> U) -> Spanned<U> {
        Spanned { value: change(self.value), at: self.at }
    }
}

impl<T> Deref for Spanned<T> {
    type Target = T;
    fn deref(&self) -> &T {
        &self.value
    }
}

impl<T: PartialEq> PartialEq for Spanned<T> {
    fn eq(&self, other: &Self) -> bool {
        self.value == other.value
    }
}

impl<T: Serialize> Serialize for Spanned<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.value.serialize(serializer)
    }
}

/// Turns byte offsets of a text into lines and columns.
pub(crate) struct Lines<'t> {
    text: &'t str,
    starts: Vec<usize>,
}

impl<'t> Lines<'t> {
    pub(crate) fn new(text: &'t str) -> Self {
        let starts = std::iter::once(0).chain(text.match_indices('\n').map(|(i, _)| i + 1)).collect();
        Lines { text, starts }
    }

    pub(crate) fn location(&self, offset: usize) -> Location {
        let offset = offset.min(self.text.len());
        let line = self.starts.partition_point(|&start| start <= offset).max(1);
        let start = self.starts[line - 1];
        // An offset inside a character (none is known, but the parser is not ours) counts as that character.
        let column = self.text[start..].char_indices().take_while(|(i, _)| start + i < offset).count() + 1;
        Location::File { line: line as u32, column: column as u32 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn offsets_become_lines_and_columns_in_characters() {
        let lines = Lines::new("é = 1\n\nab = 2");
        assert_eq!(lines.location(0), Location::File { line: 1, column: 1 });
        assert_eq!(lines.location(5), Location::File { line: 1, column: 5 });
        assert_eq!(lines.location(7), Location::File { line: 2, column: 1 });
        assert_eq!(lines.location(13), Location::File { line: 3, column: 6 });
        assert_eq!(lines.location(99), Location::File { line: 3, column: 7 });
    }

    #[test]
    fn places_do_not_count_in_comparison_but_values_do() {
        let here = Spanned::new(1, Location::File { line: 1, column: 1 });
        assert_eq!(here, Spanned::default_value(1));
        assert_ne!(here, Spanned::default_value(2));
    }
}

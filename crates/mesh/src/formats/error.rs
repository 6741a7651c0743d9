//! What can be wrong with a mesh file: where, what was expected, and what to do about it.

use std::fmt;

/// Where in a file something was found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// Line of a text file, from 1.
    Line(usize),
    /// Line of another file that the first one includes.
    IncludedLine {
        /// Name as the including file writes it.
        file: String,
        /// Line, from 1.
        line: usize,
    },
    /// Offset in a binary file.
    Byte(usize),
    /// Nowhere in particular.
    File,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Place::Line(line) => write!(f, "line {line}"),
            Place::IncludedLine { file, line } => write!(f, "{file}, line {line}"),
            Place::Byte(byte) => write!(f, "byte {byte}"),
            Place::File => write!(f, "file"),
        }
    }
}

/// Why a mesh file was not read or not written.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FormatError {
    /// The file stops in the middle of something.
    #[error("{place}: the file ends where {expected} should be; it is truncated: copy or export it again")]
    Truncated {
        /// Where the reader stood.
        place: Place,
        /// What should follow.
        expected: String,
    },
    /// A count that the file states is not what the file holds.
    #[error("{place}: the file says {said} {what}, but {found}; correct the count or export the file again")]
    Count {
        /// Where the count is used.
        place: Place,
        /// What is counted.
        what: String,
        /// The stated count.
        said: u64,
        /// What there is instead.
        found: String,
    },
    /// A coordinate that is no number.
    #[error(
        "{place}: coordinate {axis} of node {node} is {value}; every coordinate must be finite: export the mesh again"
    )]
    NotFinite {
        /// Where the node is.
        place: Place,
        /// The node as the file calls it.
        node: String,
        /// x, y or z.
        axis: char,
        /// The value.
        value: f64,
    },
    /// An element or a set names a node (or an element) that the file does not define.
    #[error("{place}: {who} refers to {what}, but the file defines {defined}; the mesh is incomplete: export it again")]
    OutOfRange {
        /// Where the reference is.
        place: Place,
        /// The element or set.
        who: String,
        /// What it names.
        what: String,
        /// What there is.
        defined: String,
    },
    /// An element type that the format itself does not define.
    #[error("{place}: {format} knows no element type {element}; {advice}")]
    UnknownElement {
        /// Where the element is.
        place: Place,
        /// The format.
        format: &'static str,
        /// The type as the file gives it.
        element: String,
        /// What to do.
        advice: String,
    },
    /// An id is defined twice.
    #[error(
        "{place}: {what} {id} is defined twice; ids must be unique: renumber, or flatten an assembly into one part"
    )]
    Repeated {
        /// Where the second definition is.
        place: Place,
        /// "node" or "element".
        what: &'static str,
        /// The id.
        id: i64,
    },
    /// Something else was expected here.
    #[error("{place}: expected {expected}, found {found}")]
    Syntax {
        /// Where.
        place: Place,
        /// What should be there.
        expected: String,
        /// What is there.
        found: String,
    },
    /// The file is well formed as far as can be told, but uses what is not read here.
    #[error("{place}: {what} is not supported; {advice}")]
    Unsupported {
        /// Where.
        place: Place,
        /// What.
        what: String,
        /// What to do.
        advice: String,
    },
    /// The file defines no node at all.
    #[error("the file holds no node; check that it is a mesh and not a geometry or a result without mesh ({format})")]
    Empty {
        /// The format that was read.
        format: String,
    },
    /// Neither name nor content tell the format.
    #[error("\"{name}\" is in no mesh format that is known here; {advice}")]
    UnknownFormat {
        /// The given name.
        name: String,
        /// What to do.
        advice: String,
    },
    /// A file that the mesh file includes cannot be had.
    #[error("{place}: cannot include \"{name}\": {why}")]
    Include {
        /// Where the inclusion is.
        place: Place,
        /// The included name.
        name: String,
        /// Why not.
        why: String,
    },
    /// The mesh, or a field, cannot be expressed in the format to write.
    #[error("cannot write {what} as {format}: {why}")]
    NotWritable {
        /// Element, region or field.
        what: String,
        /// The format.
        format: &'static str,
        /// Why, and what to do.
        why: String,
    },
}

//! The three files of a mixed model in the first thesis: particles, elements, associations.
//!
//! | file | content | per line |
//! |---|---|---|
//! | `.obj` | particles | `v x y z` |
//! | `.element` | `nbElement N`, then elements | `count i1 i2 …`, indices from 0 |
//! | `.info` | `nbDim d`, `$ELEM`, N, associations, `$ENDELM` | `index Loi Element Decoupage` |
//!
//! An association is a law, an element and a way of cutting generated formulas into pieces. The last one means nothing
//! here (nothing needs cutting) and is kept for writing back. Lines that begin with `#` are comments.
//! The configuration of the thesis' bar generator is read by [`bar_config`].
//!
//! Node order: the shape functions printed in the thesis (tables 3.1 to 3.3: triangles with 3 and 6 nodes, quadrangle,
//! tetrahedron, hexahedron, prism, pyramid) list their nodes in the order used here. Elements that it does not print
//! are taken in the order used here too.
//! Source: X. Faure, "Approche formelle pour la simulation interactive de modèles mixtes", 2014, sections 5.2.2.1 and
//! 5.3, codes 15, 16 and 19.

pub mod bar_config;
mod names;
mod read;
mod write;

pub use names::element_name;
pub use read::read;
pub use write::{TripleText, associate, write};

use crate::mesh::{ElementId, Mesh};

/// A mixed model: a mesh and what each element is associated with.
#[derive(Clone, Debug, Default)]
pub struct Triple {
    /// The mesh; it has one region per law, of the law's name.
    pub mesh: Mesh,
    /// Where each element of the files is in the mesh, in the order of the files.
    pub order: Vec<ElementId>,
    /// What each element is associated with, in the order of the files.
    pub associations: Vec<Association>,
}

/// Law, element and cutting of one element or section.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Association {
    /// The law as spelled in the file: `Hooke`, `SaintVenant`, …
    pub law: String,
    /// The element as spelled in the file: `Triangle`, `Prism6I`, …
    pub element: String,
    /// The cutting of formulas as spelled in the file: `DecoupageNon`, …
    pub cutting: String,
    /// Number of integration points if the element's name states it (the 6 of `Prism6I`).
    pub integration_points: Option<usize>,
}

/// Something wrong in one of the files.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{file} line {line}: {problem}")]
pub struct TripleError {
    /// Which file: `.obj`, `.element`, `.info` or `bar configuration`.
    pub file: &'static str,
    /// Line number from 1; the last line when something is missing at the end.
    pub line: usize,
    /// What is wrong.
    pub problem: Problem,
}

/// What can be wrong in a line.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Problem {
    /// The line does not start with anything known.
    #[error("`{word}` is not known here; expected {expected}")]
    UnknownWord {
        /// The first word of the line.
        word: String,
        /// What may stand here.
        expected: &'static str,
    },
    /// A word that should be a number.
    #[error("`{word}` is not {expected}")]
    Number {
        /// The word.
        word: String,
        /// What it should be.
        expected: &'static str,
    },
    /// Too few or too many words.
    #[error("{found} words; expected {expected}")]
    Words {
        /// Number of words.
        found: usize,
        /// The form of the line.
        expected: &'static str,
    },
    /// The file stops before something that must be there.
    #[error("the file ends without {expected}")]
    Missing {
        /// What must be there.
        expected: String,
    },
    /// The same thing twice.
    #[error("{what} is given again; expected it once")]
    Repeated {
        /// What.
        what: String,
    },
    /// A count that does not agree with the lines.
    #[error("{stated} elements are announced, but there are {found}")]
    Count {
        /// The announced number.
        stated: usize,
        /// The number of lines.
        found: usize,
    },
    /// An index beyond the end.
    #[error("there is no {what} {index}: there are {count}, numbered from 0")]
    Index {
        /// Node or element.
        what: &'static str,
        /// The index.
        index: usize,
        /// How many there are.
        count: usize,
    },
    /// A name of an element that is not in the table.
    #[error(
        "no element is called `{name}`; known are {known}, optionally followed by a number of integration points and `I` (`Prism6I`)"
    )]
    UnknownElement {
        /// The name.
        name: String,
        /// The known names.
        known: String,
    },
    /// No element of this family has that many nodes.
    #[error("no {family} has {count} nodes (`{name}`); known are {known}")]
    NodeCount {
        /// The name.
        name: String,
        /// Its family.
        family: &'static str,
        /// Number of nodes in the `.element` file.
        count: usize,
        /// The numbers of nodes that exist.
        known: String,
    },
    /// A solid in a flat model.
    #[error("`{name}` has dimension {dimension}, but the file says nbDim {stated}")]
    Dimension {
        /// The element.
        name: String,
        /// Its dimension.
        dimension: usize,
        /// The model's.
        stated: usize,
    },
}

/// Lines with content: numbered from 1, comments and blank lines left out, split into words.
fn lines(text: &str) -> impl Iterator<Item = (usize, Vec<&str>)> {
    text.lines()
        .enumerate()
        .map(|(at, line)| (at + 1, line.split_whitespace().collect::<Vec<_>>()))
        .filter(|(_, words)| words.first().is_some_and(|word| !word.starts_with('#')))
}

fn parse<T: std::str::FromStr>(word: &str, expected: &'static str) -> Result<T, Problem> {
    word.parse().map_err(|_| Problem::Number { word: word.to_owned(), expected })
}

fn finite(word: &str) -> Result<f64, Problem> {
    let expected = "a finite number";
    let value: f64 = parse(word, expected)?;
    if value.is_finite() { Ok(value) } else { Err(Problem::Number { word: word.to_owned(), expected }) }
}
